//! Methods and response codes (RFC 7252, section 12.1) as numbers with names. What a code means to a client is not here.

use std::fmt;

/// The code of a message: three bits of class and five of detail, written `2.05`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Code(pub u8);

/// Declares the codes that are sent.
macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $class:literal . $detail:literal;)*) => {
        impl Code {
            $($(#[$doc])* pub const $name: Code = Code(($class << 5) | $detail);)*
        }
    };
}

codes! {
    /// 0.00: no request and no response.
    EMPTY = 0 . 0;
    /// 2.01
    CREATED = 2 . 1;
    /// 2.02
    DELETED = 2 . 2;
    /// 2.03: what the client has is still so.
    VALID = 2 . 3;
    /// 2.04
    CHANGED = 2 . 4;
    /// 2.05
    CONTENT = 2 . 5;
    /// 2.31: the next block, please.
    CONTINUE = 2 . 31;
    /// 4.00
    BAD_REQUEST = 4 . 0;
    /// 4.01
    UNAUTHORIZED = 4 . 1;
    /// 4.02: a critical option that is not understood.
    BAD_OPTION = 4 . 2;
    /// 4.03
    FORBIDDEN = 4 . 3;
    /// 4.04
    NOT_FOUND = 4 . 4;
    /// 4.05
    METHOD_NOT_ALLOWED = 4 . 5;
    /// 4.06
    NOT_ACCEPTABLE = 4 . 6;
    /// 4.08: blocks are missing.
    INCOMPLETE = 4 . 8;
    /// 4.09 (RFC 8132)
    CONFLICT = 4 . 9;
    /// 4.12
    PRECONDITION_FAILED = 4 . 12;
    /// 4.13
    TOO_LARGE = 4 . 13;
    /// 4.15
    UNSUPPORTED_FORMAT = 4 . 15;
    /// 4.22 (RFC 8132)
    UNPROCESSABLE = 4 . 22;
    /// 4.29 (RFC 8516)
    TOO_MANY_REQUESTS = 4 . 29;
    /// 5.00
    INTERNAL = 5 . 0;
    /// 5.03
    UNAVAILABLE = 5 . 3;
    /// 5.05
    NO_PROXY = 5 . 5;
}

impl Code {
    /// The class: 0 request, 2 success, 4 the client's mistake, 5 the server's.
    #[must_use]
    pub const fn class(self) -> u8 {
        self.0 >> 5
    }

    /// The detail within its class.
    #[must_use]
    pub const fn detail(self) -> u8 {
        self.0 & 0x1F
    }

    /// Whether it says that something went well.
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

/// What a request asks to be done (RFC 7252, section 5.8, and RFC 8132).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// 0.01
    Get,
    /// 0.02
    Post,
    /// 0.03
    Put,
    /// 0.04
    Delete,
    /// 0.05
    Fetch,
    /// 0.06
    Patch,
    /// 0.07
    IPatch,
}

impl Method {
    /// The method of a request's code; `None` when there is none.
    #[must_use]
    pub const fn of(code: Code) -> Option<Method> {
        Some(match code.0 {
            1 => Method::Get,
            2 => Method::Post,
            3 => Method::Put,
            4 => Method::Delete,
            5 => Method::Fetch,
            6 => Method::Patch,
            7 => Method::IPatch,
            _ => return None,
        })
    }

    /// Whether it changes nothing, so that it may be done again (RFC 7252, section 5.1).
    #[must_use]
    pub const fn is_safe(self) -> bool {
        matches!(self, Method::Get | Method::Fetch)
    }

    /// Its code on the wire.
    #[must_use]
    pub const fn code(self) -> Code {
        Code(match self {
            Method::Get => 1,
            Method::Post => 2,
            Method::Put => 3,
            Method::Delete => 4,
            Method::Fetch => 5,
            Method::Patch => 6,
            Method::IPatch => 7,
        })
    }

    /// The word for records, as `PUT`.
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
