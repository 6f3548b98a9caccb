//! A request as the tests mean it, and what a client said to it. How a client is told is in `client`.

use serde_json::Value;

/// One request, for any client.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ask<'a> {
    /// `get`, `put`, `post` or `delete`.
    pub(crate) method: &'static str,
    /// Path and query.
    pub(crate) path: &'a str,
    /// What is sent.
    pub(crate) payload: Option<&'a str>,
    /// The format of what is sent; none is said otherwise.
    pub(crate) format: Option<u16>,
    /// The format that is wanted.
    pub(crate) accept: Option<u16>,
    /// Whether it is sent as NON.
    pub(crate) non: bool,
    /// Whether it goes on observing.
    pub(crate) observe: bool,
    /// The size of blocks, bytes, in which the answer is wanted.
    pub(crate) block: Option<u16>,
    /// The size of blocks, bytes, in which the payload is sent by a client that is told this apart.
    pub(crate) upload_block: Option<u16>,
    /// Further options by number.
    pub(crate) options: Vec<(u16, Vec<u8>)>,
    /// The first token, where a client can be told one.
    pub(crate) token: Option<&'a str>,
}

/// What came back.
#[derive(Debug)]
pub(crate) struct Reply {
    /// The code, as `4.09`; `2.xx` from a client that says nothing about success.
    pub(crate) code: String,
    /// What it carried; of a refusal, everything the client printed about it.
    pub(crate) body: Vec<u8>,
    /// Everything the client printed.
    pub(crate) all: String,
}

impl<'a> Ask<'a> {
    pub(crate) fn get(path: &'a str) -> Ask<'a> {
        Ask { method: "get", path, ..Ask::default() }
    }

    pub(crate) fn put(path: &'a str, payload: &'a str) -> Ask<'a> {
        Ask { method: "put", path, payload: Some(payload), ..Ask::default() }
    }

    pub(crate) fn post(path: &'a str, payload: &'a str) -> Ask<'a> {
        Ask { method: "post", path, payload: Some(payload), ..Ask::default() }
    }

    pub(crate) fn accept(self, format: u16) -> Ask<'a> {
        Ask { accept: Some(format), ..self }
    }

    pub(crate) fn labelled(self, format: u16) -> Ask<'a> {
        Ask { format: Some(format), ..self }
    }

    pub(crate) fn in_blocks_of(self, bytes: u16) -> Ask<'a> {
        Ask { block: Some(bytes), ..self }
    }

    pub(crate) fn with(mut self, option: u16, value: &[u8]) -> Ask<'a> {
        self.options.push((option, value.to_vec()));
        self
    }

    pub(crate) fn non(self) -> Ask<'a> {
        Ask { non: true, ..self }
    }
}

impl Reply {
    /// Fails unless it is a success; what it carried.
    pub(crate) fn content(&self) -> &[u8] {
        assert!(self.code.starts_with('2'), "{self:?}");
        &self.body
    }

    /// The same as text.
    pub(crate) fn text(&self) -> &str {
        std::str::from_utf8(self.content()).expect("text is UTF-8")
    }

    /// The same as JSON.
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(self.content()).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// Fails unless it says that the command was accepted.
    pub(crate) fn accepted(&self) {
        let text = self.text();
        let json: Option<Value> = serde_json::from_str(text).ok();
        assert!(json.map_or(text == "accepted", |json| json["accepted"] == true), "{self:?}");
    }

    /// Fails unless it is a refusal of this code that says why in these words.
    pub(crate) fn refused(&self, code: &str, words: &str) {
        assert_eq!(self.code, code, "{self:?}");
        assert!(self.all.contains(words), "no `{words}` in what the client printed: {self:?}");
    }
}
