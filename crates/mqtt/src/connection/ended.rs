//! Why a connection ends. Those that only whoever moves the bytes can know are here, too, so that there is one list of them.

use crate::frame::{Kind, Malformed};

/// Why a connection ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Ended {
    /// The client took its leave: it leaves no will.
    #[error("the client took its leave")]
    Left,
    /// The connection is closed or broken.
    #[error("the connection is gone")]
    Gone,
    /// A packet was wrong.
    #[error("the client sent nonsense: {0}")]
    Malformed(#[from] Malformed),
    /// A packet that no client sends, or a second CONNECT.
    #[error("the client sent a {0:?}, which is not for it to send")]
    Unexpected(Kind),
    /// Nothing was heard for too long.
    #[error("the client was silent for too long")]
    Idle,
    /// It asks for more than there is room for.
    #[error("the client has more than {most} {what}")]
    TooMuch {
        /// Of what.
        what: &'static str,
        /// The most.
        most: usize,
    },
    /// Another connection has the same client id.
    #[error("another connection came with the same client id")]
    TakenOver,
    /// Its place is somebody else's.
    #[error("there were too many connections, or too much waited to be read, and it gave way to others")]
    GaveWay,
    /// Its key is not known any more.
    #[error("its key is not known any more")]
    NotKnown,
    /// The program ends: wills are not published.
    #[error("the program ends")]
    Closing,
}
