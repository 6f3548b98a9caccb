//! The answers of the application, before they are cut into blocks and put into messages. Bodies are immutable and
//! shared: all blocks, retransmissions and observers use the same body.

use std::sync::Arc;

use super::code::Code;
use super::format::Format;

/// An entity tag: 1 to 8 bytes that name one state of a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ETag {
    bytes: [u8; 8],
    length: u8,
}

impl ETag {
    /// These bytes as a tag; `None` unless there are 1 to 8 bytes.
    #[must_use]
    pub fn new(given: &[u8]) -> Option<ETag> {
        let mut bytes = [0; 8];
        bytes.get_mut(..given.len()).filter(|room| !room.is_empty())?.copy_from_slice(given);
        Some(ETag { bytes, length: u8::try_from(given.len()).ok()? })
    }

    /// The tag's 1 to 8 bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..usize::from(self.length)]
    }
}

/// The application's answer to one request. Blocks, tokens and message ids are handled by the endpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Response {
    /// The response code (RFC 7252, section 12.1.2).
    pub code: Code,
    /// The format of the body; `None` for a diagnostic text (RFC 7252, section 5.5.2).
    pub format: Option<Format>,
    /// The tag of the resource's state. Clients send it to ask whether the state is still current (RFC 7252, section
    /// 5.10.6).
    pub tag: Option<ETag>,
    /// How long the response counts as current, in seconds; `None` means 60.
    pub max_age: Option<u32>,
    /// Location-Path: the path of a created resource (RFC 7252, section 5.10.7).
    pub location: Vec<String>,
    /// Location-Query: the query of a created resource (RFC 7252, section 5.10.7).
    pub location_query: Vec<String>,
    /// The whole body, which the endpoint cuts into blocks.
    pub body: Arc<[u8]>,
}

impl Response {
    /// A response with only a code. It has no body and no options, so it counts as current for 60 seconds.
    #[must_use]
    pub fn new(code: Code) -> Response {
        Response {
            code,
            format: None,
            tag: None,
            max_age: None,
            location: Vec::new(),
            location_query: Vec::new(),
            body: Arc::from([]),
        }
    }

    /// 2.05 with a body in a format.
    #[must_use]
    pub fn content(format: Format, body: impl Into<Arc<[u8]>>) -> Response {
        Response { format: Some(format), body: body.into(), ..Response::new(Code::CONTENT) }
    }

    /// A refusal or an error, with a sentence for people (RFC 7252, section 5.5.2).
    #[must_use]
    pub fn refusal(code: Code, words: impl Into<String>) -> Response {
        Response { body: words.into().into_bytes().into(), ..Response::new(code) }
    }
}

/// The application's answer to a request, and what observers of the resource see.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The response to the sender of the request.
    pub response: Arc<Response>,
    /// What observers of the resource see, usually the response itself. Observers are told whenever one of these
    /// things changes. Empty if the resource cannot be observed.
    pub observed: Vec<Arc<Response>>,
}

impl Answer {
    /// An answer that cannot be observed. It is sent without an Observe option, even if the request has one.
    #[must_use]
    pub fn once(response: Response) -> Answer {
        Answer { response: Arc::new(response), observed: Vec::new() }
    }

    /// An answer that can be observed: observers are told of its changes.
    #[must_use]
    pub fn observable(response: Response) -> Answer {
        let response = Arc::new(response);
        Answer { observed: vec![Arc::clone(&response)], response }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tag_has_one_to_eight_bytes() {
        assert_eq!(ETag::new(b""), None);
        assert_eq!(ETag::new(b"123456789"), None);
        assert_eq!(ETag::new(b"12345678").unwrap().bytes(), b"12345678");
        assert_ne!(ETag::new(b"1"), ETag::new(b"1\0"));
    }
}
