//! The client's address, and the sender of a request.

use std::net::IpAddr;
use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, header};

use super::problem::Problem;
use crate::access::Caller;

/// The client at the other end of a connection. `hearing::connection_task` stores it in every request.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peer {
    /// The client's address as the operating system reports it. Headers that a proxy adds are not trusted.
    pub(super) address: IpAddr,
    pub(super) is_encrypted: bool,
}

/// The sender of a request that has passed the gate.
pub(super) struct LetIn(pub(super) Caller);

impl Peer {
    pub(super) fn name(self) -> Arc<str> {
        Arc::from(self.address.to_canonical().to_string())
    }
}

/// Reads the sender that the gate has stored. On a route without a gate no sender is stored, and the request is
/// refused.
impl<S: Send + Sync> FromRequestParts<S> for LetIn {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<LetIn, Problem> {
        parts.extensions.get().cloned().map(LetIn).ok_or_else(Problem::not_signed_in)
    }
}

impl<S: Send + Sync> FromRequestParts<S> for Peer {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Peer, Problem> {
        parts.extensions.get().copied().ok_or_else(Problem::internal)
    }
}

pub(super) fn cookies<'a>(headers: &'a HeaderMap, cookie: &'a str) -> impl Iterator<Item = &'a str> {
    let cookies = headers.get_all(header::COOKIE).iter().filter_map(|value| value.to_str().ok());
    let pairs = cookies.flat_map(|value| value.split(';')).filter_map(|pair| pair.trim().split_once('='));
    pairs.filter(move |(name, _)| *name == cookie).map(|(_, value)| value)
}
