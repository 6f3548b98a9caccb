//! A client that has come to our own broker and has said nothing yet.

use std::fmt;
use std::net::IpAddr;

use tokio::io::{AsyncRead, AsyncWrite};

use crate::access::{Access, Caller};

/// What a client says, and what it is told.
pub trait Stream: AsyncRead + AsyncWrite + Send + Unpin {}

impl<S: AsyncRead + AsyncWrite + Send + Unpin> Stream for S {}

/// A client that has come.
pub struct Visitor {
    /// What it says, and what it is told.
    pub stream: Box<dyn Stream>,
    /// How it came.
    pub origin: Origin,
}

/// How a client came, and what is known of it without its saying anything.
#[derive(Clone, Debug)]
pub struct Origin {
    /// Where it comes from.
    pub from: IpAddr,
    /// Who it is, if that is known without its saying so.
    pub caller: Option<Caller>,
    /// Who is let in by the way it came.
    pub access: Access,
}

impl fmt::Debug for Visitor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Visitor").field("origin", &self.origin).finish_non_exhaustive()
    }
}
