//! Content that is the same for all readers. It is created and compressed once, so a repeated request costs only the
//! sending.

use std::io::Write;

use axum::body::Bytes;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;

use super::super::accept::codings;

pub(super) struct Kept {
    media_type: &'static str,
    plain: Bytes,
    packed: Bytes,
}

impl Kept {
    pub(super) fn new(media_type: &'static str, text: String) -> Kept {
        let mut packed = GzEncoder::new(Vec::new(), Compression::default());
        let written = packed.write_all(text.as_bytes()).and_then(|()| packed.finish());
        Kept { media_type, packed: written.expect("writing to a list of bytes does not fail").into(), plain: text.into() }
    }

    pub(super) fn sent(&self, accepted: &HeaderMap) -> Response {
        let head = [(header::CONTENT_TYPE, self.media_type), (header::VARY, "accept-encoding")];
        if codings(accepted).any(|(name, quality)| quality > 0.0 && name.eq_ignore_ascii_case("gzip")) {
            (head, [(header::CONTENT_ENCODING, "gzip")], self.packed.clone()).into_response()
        } else {
            (head, self.plain.clone()).into_response()
        }
    }
}
