//! Reading what a command carries: JSON, also where no format is named, or CBOR. What the fields mean stands in
//! `crate::api::command`; how large a body may be is the endpoint's business.

use super::problem::Problem;
use crate::api::cbor;
use crate::api::fields::{self, Body};
use coap_endpoint::{Format, Request};

/// The body of a command that needs one.
pub(super) fn body<T: Body>(request: &Request) -> Result<T, Problem> {
    if request.payload.is_empty() {
        return Err(Problem::malformed("the body is empty: this command needs JSON or CBOR, see docs/coap.md".to_owned()));
    }
    match request.format {
        None | Some(Format::JSON) => fields::body(&request.payload).map_err(Problem::from),
        Some(Format::CBOR) => cbor::body(&request.payload).map_err(Problem::from),
        Some(other) => Err(Problem::wrong_format(format!("the body is in {other}: send {} or {}", Format::JSON, Format::CBOR))),
    }
}

/// The body of a command that can do without; an empty one is the default.
pub(super) fn optional<T: Body + Default>(request: &Request) -> Result<T, Problem> {
    if request.payload.is_empty() { Ok(T::default()) } else { body(request) }
}
