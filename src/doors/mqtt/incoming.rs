//! A client that has come to our own broker and has said nothing yet.

use std::fmt;
use std::net::IpAddr;

use tokio::io::{AsyncRead, AsyncWrite};

use crate::access::{Access, Caller};

/// What a client says. It is read on the thread that hears.
pub type ClientReader = Box<dyn AsyncRead + Send + Unpin>;

/// What it is told. It is written where all else is done.
pub type Writer = Box<dyn AsyncWrite + Send + Unpin>;

pub struct IncomingConnection {
    pub reader: ClientReader,
    pub writer: Writer,
    pub origin: Origin,
}

/// How a client came, and what is known of it without its saying anything.
#[derive(Clone, Debug)]
pub struct Origin {
    pub from: IpAddr,
    /// Who it is, if that is known without its saying so.
    pub caller: Option<Caller>,
    /// Who is let in by the way it came.
    pub access: Access,
}

impl IncomingConnection {
    pub fn over(stream: impl AsyncRead + AsyncWrite + Send + 'static, origin: Origin) -> IncomingConnection {
        let (reader, writer) = tokio::io::split(stream);
        IncomingConnection { reader: Box::new(reader), writer: Box::new(writer), origin }
    }
}

impl fmt::Debug for IncomingConnection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("IncomingConnection").field("origin", &self.origin).finish_non_exhaustive()
    }
}
