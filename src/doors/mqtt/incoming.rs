//! A client that has connected to our own broker, but has not sent anything yet.

use std::fmt;
use std::net::IpAddr;

use tokio::io::{AsyncRead, AsyncWrite};

use crate::access::{Access, Caller};

/// The client's input, read on the hearing thread.
pub type ClientReader = Box<dyn AsyncRead + Send + Unpin>;

/// The client's output, written on the other threads.
pub type Writer = Box<dyn AsyncWrite + Send + Unpin>;

pub struct IncomingConnection {
    pub reader: ClientReader,
    pub writer: Writer,
    pub origin: Origin,
}

#[derive(Clone, Debug)]
pub struct Origin {
    pub from: IpAddr,
    /// The sender, if the connection itself proves who it is. Then the CONNECT needs no credentials.
    pub caller: Option<Caller>,
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
