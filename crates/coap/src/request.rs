//! A request as the application sees it, with its blocks put together and its options read. The answer is defined in
//! `response`. Messages, tokens and retransmissions are not visible here.

use std::net::SocketAddr;

use super::code::{Code, Method};
use super::format::Format;
use super::response::{ETag, Response};

/// One request, with its body put together from its blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// Address and port of its sender.
    pub peer: SocketAddr,
    /// Its method (RFC 7252, section 5.8, and RFC 8132).
    pub method: Method,
    /// The segments of its path; empty for `/`.
    pub path: Vec<String>,
    /// The parts of the query, such as `rt=map`.
    pub queries: Vec<String>,
    /// The format of the payload, if the request names one.
    pub format: Option<Format>,
    /// The only format that the sender accepts, if the request names one.
    pub accept: Option<Format>,
    /// The conditions of the request (RFC 7252, section 5.10.8).
    pub conditions: Conditions,
    /// The body; empty if there is none.
    pub payload: Vec<u8>,
}

/// `If-Match` and `If-None-Match` (RFC 7252, section 5.10.8).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Conditions {
    /// The request is carried out only if the resource has one of these tags. `None` among them stands for any
    /// existing resource.
    pub if_match: Vec<Option<ETag>>,
    /// The request is carried out only if the resource does not exist.
    pub if_none_match: bool,
}

impl Request {
    /// The path as text, such as `/lamps/3`.
    #[must_use]
    pub fn path_text(&self) -> String {
        if self.path.is_empty() { "/".to_owned() } else { self.path.iter().map(|segment| format!("/{segment}")).collect() }
    }

    /// The path's segments as `&str`, for a `match` on them.
    #[must_use]
    pub fn segments(&self) -> Vec<&str> {
        self.path.iter().map(String::as_str).collect()
    }

    /// The format of the answer: the accepted one, or the first one offered if the request accepts any.
    ///
    /// # Errors
    /// 4.06 when the accepted format is not offered.
    pub fn negotiated(&self, offers: &[Format]) -> Result<Format, Response> {
        let wanted = self.accept.map_or(offers.first(), |accept| offers.iter().find(|offer| **offer == accept));
        wanted.copied().ok_or_else(|| {
            let offers: Vec<String> = offers.iter().map(ToString::to_string).collect();
            let words = format!("{} is available as {}, but not in the requested format", self.path_text(), offers.join(", "));
            Response::refusal(Code::NOT_ACCEPTABLE, words)
        })
    }
}

impl Conditions {
    /// Checks the conditions of the request. `exists` says whether the resource exists, and `tag` is its tag.
    ///
    /// # Errors
    /// 4.12 when a condition is not met.
    pub fn met(&self, exists: bool, tag: Option<ETag>) -> Result<(), Response> {
        if self.if_none_match && exists {
            return Err(Response::refusal(Code::PRECONDITION_FAILED, "If-None-Match: the resource exists already"));
        }
        let matches = |wanted: &Option<ETag>| wanted.map_or(exists, |wanted| tag == Some(wanted));
        if self.if_match.is_empty() || self.if_match.iter().any(matches) {
            return Ok(());
        }
        Err(Response::refusal(
            Code::PRECONDITION_FAILED,
            "If-Match: the resource has changed; read the resource again, then repeat the request",
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tag(text: &str) -> ETag {
        ETag::new(text.as_bytes()).expect("a short tag")
    }

    #[test]
    fn a_condition_is_held_against_what_is_there() {
        let any = Conditions { if_match: vec![None], if_none_match: false };
        assert!(any.met(true, Some(tag("a"))).is_ok() && any.met(false, None).is_err());
        let this = Conditions { if_match: vec![Some(tag("a")), Some(tag("b"))], if_none_match: false };
        assert!(this.met(true, Some(tag("b"))).is_ok() && this.met(true, Some(tag("c"))).is_err());
        let none = Conditions { if_match: Vec::new(), if_none_match: true };
        assert!(none.met(false, None).is_ok());
        assert_eq!(none.met(true, Some(tag("a"))).unwrap_err().code, Code::PRECONDITION_FAILED);
        assert!(Conditions::default().met(false, None).is_ok());
    }
}
