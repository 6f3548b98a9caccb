//! Methods and response codes (RFC 7252, section 12.1) as numbers with names. What a code means to a client is not
//! described here.

use std::fmt;

/// The code of a message: three bits of class and five of detail, written `2.05`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Code(pub u8);

macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $written:literal;)*) => {
        impl Code {
            $(#[doc = $written] #[doc = ""] $(#[$doc])* pub const $name: Code = Code::written($written);)*
        }
    };
}

codes! {
    /// Neither a request nor a response (RFC 7252, section 4.1).
    EMPTY = "0.00";
    CREATED = "2.01";
    DELETED = "2.02";
    /// The client's stored representation is still valid.
    VALID = "2.03";
    CHANGED = "2.04";
    CONTENT = "2.05";
    /// The server asks for the next block of the request's body (RFC 7959, section 2.9.1).
    CONTINUE = "2.31";
    BAD_REQUEST = "4.00";
    UNAUTHORIZED = "4.01";
    /// A critical option was not understood.
    BAD_OPTION = "4.02";
    FORBIDDEN = "4.03";
    NOT_FOUND = "4.04";
    METHOD_NOT_ALLOWED = "4.05";
    NOT_ACCEPTABLE = "4.06";
    /// Blocks of the request's body are missing (RFC 7959, section 2.9.2).
    INCOMPLETE = "4.08";
    /// Defined in RFC 8132.
    CONFLICT = "4.09";
    PRECONDITION_FAILED = "4.12";
    TOO_LARGE = "4.13";
    UNSUPPORTED_FORMAT = "4.15";
    /// Defined in RFC 8132.
    UNPROCESSABLE = "4.22";
    /// Defined in RFC 8516.
    TOO_MANY_REQUESTS = "4.29";
    INTERNAL = "5.00";
    UNAVAILABLE = "5.03";
    NO_PROXY = "5.05";
}

impl Code {
    const fn written(text: &str) -> Code {
        let [class, b'.', tens, ones] = *text.as_bytes() else { panic!("a code is written as `2.05`") };
        Code((class - b'0') << 5 | ((tens - b'0') * 10 + (ones - b'0')))
    }

    /// The class: 0 for requests, 2 for success, 4 for errors of the client, 5 for errors of the server.
    #[must_use]
    pub const fn class(self) -> u8 {
        self.0 >> 5
    }

    /// The detail: the number within the class, 0 to 31.
    #[must_use]
    pub const fn detail(self) -> u8 {
        self.0 & 0x1F
    }

    /// Whether the code is of class 2, success (RFC 7252, section 5.9.1).
    #[must_use]
    pub const fn is_success(self) -> bool {
        self.class() == 2
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{:02}", self.class(), self.detail())
    }
}

/// The method of a request (RFC 7252, section 5.8, and RFC 8132).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are those of the RFCs")]
pub enum Method {
    Get = 1,
    Post,
    Put,
    Delete,
    Fetch,
    Patch,
    IPatch,
}

impl Method {
    /// The method of a request's code; `None` for other codes.
    #[must_use]
    pub fn of(code: Code) -> Option<Method> {
        use Method::{Delete, Fetch, Get, IPatch, Patch, Post, Put};
        [Get, Post, Put, Delete, Fetch, Patch, IPatch].into_iter().find(|method| method.code() == code)
    }

    /// Whether the method changes nothing on the server, so that the request may be repeated (RFC 7252, section 5.1).
    #[must_use]
    pub const fn is_safe(self) -> bool {
        matches!(self, Method::Get | Method::Fetch)
    }

    /// The code of the method on the wire (RFC 7252, section 12.1.1).
    #[must_use]
    pub const fn code(self) -> Code {
        Code(self as u8)
    }

    /// The name of the method in logs, such as `PUT`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Method::Get => "GET",
            Method::Post => "POST",
            Method::Put => "PUT",
            Method::Delete => "DELETE",
            Method::Fetch => "FETCH",
            Method::Patch => "PATCH",
            Method::IPatch => "iPATCH",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_written_as_the_rfc_writes_it() {
        assert_eq!(Code::CONTENT.to_string(), "2.05");
        assert_eq!(Code::TOO_MANY_REQUESTS.to_string(), "4.29");
        assert_eq!((Code::CONTENT.0, Code::NO_PROXY.0), (0x45, 0xA5));
        assert!(Code::VALID.is_success() && !Code::NOT_FOUND.is_success() && !Code::EMPTY.is_success());
    }

    #[test]
    fn every_method_has_its_code_and_no_other_code_is_one() {
        for number in 0..=255 {
            let method = Method::of(Code(number));
            assert_eq!(method.is_some(), (1..=7).contains(&number), "{number}");
            assert!(method.is_none_or(|method| method.code() == Code(number)));
        }
    }
}
