//! Content formats by their numbers (IANA, CoAP Content-Formats). The formats of each resource are not listed here.

use std::fmt;

/// The number of a content format (RFC 7252, section 12.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Format(pub u16);

impl Format {
    /// `text/plain; charset=utf-8`
    pub const TEXT: Format = Format(0);
    /// `application/link-format`
    pub const LINKS: Format = Format(40);
    /// `application/octet-stream`
    pub const BYTES: Format = Format(42);
    /// `image/png`
    pub const PNG: Format = Format(23);
    /// `application/json`
    pub const JSON: Format = Format(50);
    /// `application/cbor`
    pub const CBOR: Format = Format(60);
    /// `application/senml+json` (RFC 8428)
    pub const SENML_JSON: Format = Format(110);
    /// `application/concise-problem-details+cbor` (RFC 9290)
    pub const PROBLEM: Format = Format(257);
}

impl fmt::Display for Format {
    /// Writes the name and the number, such as `application/json (50)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match *self {
            Format::TEXT => "text/plain",
            Format::LINKS => "application/link-format",
            Format::BYTES => "application/octet-stream",
            Format::PNG => "image/png",
            Format::JSON => "application/json",
            Format::CBOR => "application/cbor",
            Format::SENML_JSON => "application/senml+json",
            Format::PROBLEM => "application/concise-problem-details+cbor",
            Format(other) => return write!(f, "format {other}"),
        };
        write!(f, "{name} ({})", self.0)
    }
}
