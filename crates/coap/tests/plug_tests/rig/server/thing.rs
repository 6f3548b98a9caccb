//! One resource of the test application: a body in a format, with a version as its tag. Its path and its other
//! properties are not here.

use std::sync::Arc;

use coap_endpoint::{ETag, Format, Request, Response};

#[derive(Clone, Debug)]
pub(crate) struct Thing {
    pub(crate) body: Arc<[u8]>,
    pub(crate) format: Format,
    pub(crate) version: u32,
    pub(crate) max_age: Option<u32>,
    pub(crate) is_observable: bool,
}

impl Thing {
    pub(crate) fn text(body: &str) -> Thing {
        Thing::bytes(body.as_bytes(), Format::TEXT)
    }

    pub(crate) fn bytes(body: &[u8], format: Format) -> Thing {
        Thing { body: Arc::from(body), format, version: 1, max_age: None, is_observable: false }
    }

    /// An observable resource, whose Max-Age is given in seconds.
    pub(crate) fn observable(self, max_age: u32) -> Thing {
        Thing { is_observable: true, max_age: Some(max_age), ..self }
    }

    pub(crate) fn set(&mut self, body: &[u8]) {
        self.body = Arc::from(body);
        self.version += 1;
    }

    pub(crate) fn tag(&self) -> ETag {
        ETag::new(&self.version.to_be_bytes()).expect("four bytes")
    }

    pub(crate) fn response(&self, request: &Request) -> Response {
        match request.negotiated(&[self.format]) {
            Err(refused) => refused,
            Ok(format) => {
                Response { tag: Some(self.tag()), max_age: self.max_age, ..Response::content(format, Arc::clone(&self.body)) }
            }
        }
    }
}

/// A body of this length in which no two blocks are equal.
pub(crate) fn long_body(length: usize) -> Vec<u8> {
    (0..length).map(|at| b"0123456789abcdefghijklmnopqrstuvwxyz"[(at + at / 36 + at / 1000) % 36]).collect()
}
