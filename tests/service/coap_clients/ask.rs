//! A request in the terms of the tests, and the reply of a client. How each client sends the request is in `client`.

use serde_json::Value;

/// A request that any client can send.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ask<'a> {
    /// `get`, `put`, `post` or `delete`.
    pub(crate) method: &'static str,
    /// Path and query.
    pub(crate) path: &'a str,
    pub(crate) payload: Option<&'a str>,
    /// Content-Format of the payload. `None` omits the option.
    pub(crate) format: Option<u16>,
    /// Content-Format that the request accepts.
    pub(crate) accept: Option<u16>,
    /// Whether the request is non-confirmable (NON).
    pub(crate) non: bool,
    /// Whether the request registers an observation.
    pub(crate) observe: bool,
    /// Requested block size of the answer, in bytes.
    pub(crate) block: Option<u16>,
    /// Block size of the payload in bytes, for the client that has a separate setting for it.
    pub(crate) upload_block: Option<u16>,
    /// Further options, by number.
    pub(crate) options: Vec<(u16, Vec<u8>)>,
    /// First token, for a client whose token can be set.
    pub(crate) token: Option<&'a str>,
}

#[derive(Debug)]
pub(crate) struct Reply {
    /// Response code, such as `4.09`. A client that prints no code on success yields `2.xx`.
    pub(crate) code: String,
    /// Payload. For a refusal, everything that the client printed about the refusal.
    pub(crate) body: Vec<u8>,
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
    /// Payload of a successful reply. Fails if the reply is not a success.
    pub(crate) fn content(&self) -> &[u8] {
        assert!(self.code.starts_with('2'), "{self:?}");
        &self.body
    }

    pub(crate) fn text(&self) -> &str {
        std::str::from_utf8(self.content()).expect("text is UTF-8")
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(self.content()).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// Fails unless the reply says that the command was accepted.
    pub(crate) fn accepted(&self) {
        let text = self.text();
        let json: Option<Value> = serde_json::from_str(text).ok();
        assert!(json.map_or(text == "accepted", |json| json["accepted"] == true), "{self:?}");
    }

    /// Fails unless the reply is a refusal with this code whose reason contains these words.
    pub(crate) fn refused(&self, code: &str, words: &str) {
        assert_eq!(self.code, code, "{self:?}");
        assert!(self.all.contains(words), "no `{words}` in what the client printed: {self:?}");
    }
}
