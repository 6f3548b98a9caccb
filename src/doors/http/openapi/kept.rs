//! What is the same for everybody, written and packed once: whoever asks for it over and over costs no more than what is sent.

use std::io::Write;

use axum::body::Bytes;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;

/// A text, as it is and packed.
pub(super) struct Kept {
    media_type: &'static str,
    plain: Bytes,
    packed: Bytes,
}

impl Kept {
    pub(super) fn new(media_type: &'static str, text: String) -> Kept {
        let mut packed = GzEncoder::new(Vec::new(), Compression::default());
        let written = packed.write_all(text.as_bytes()).and_then(|()| packed.finish());
        Kept { media_type, packed: written.expect("a list takes all that is written").into(), plain: text.into() }
    }

    pub(super) fn plain(&self) -> &[u8] {
        &self.plain
    }

    /// The answer to whoever accepts this.
    pub(super) fn sent(&self, accepted: &HeaderMap) -> Response {
        let head = [(header::CONTENT_TYPE, self.media_type), (header::VARY, "accept-encoding")];
        if accepts_gzip(accepted) {
            (head, [(header::CONTENT_ENCODING, "gzip")], self.packed.clone()).into_response()
        } else {
            (head, self.plain.clone()).into_response()
        }
    }
}

fn accepts_gzip(headers: &HeaderMap) -> bool {
    let is_it = |range: &str| {
        let mut parts = range.split(';').map(str::trim);
        let is_named = parts.next().is_some_and(|name| name.eq_ignore_ascii_case("gzip"));
        is_named && !parts.any(|part| part.strip_prefix("q=").is_some_and(|weight| weight.trim().parse() == Ok(0.0)))
    };
    let accepted = headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|value| value.to_str().ok());
    accepted.flat_map(|value| value.split(',')).any(is_it)
}
