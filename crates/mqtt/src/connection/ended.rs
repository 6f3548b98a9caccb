//! Why a connection ends. Reasons that only the owner of the socket can know are here too, so that there is one list of
//! them.

use crate::frame::{Malformed, PacketKind};
use crate::limits::UNRELEASED;
use crate::packet::reason::Reason;

/// Why a connection ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Ended {
    /// The client sent a DISCONNECT that discards its will.
    #[error("the client took its leave")]
    Left,
    /// The client sent a DISCONNECT that asks for its will to be published.
    #[error("the client went, and left its will")]
    LeftWithWill,
    /// The connection is closed or broken.
    #[error("the connection is gone")]
    Gone,
    /// A packet was malformed.
    #[error("the client sent nonsense: {0}")]
    Malformed(#[from] Malformed),
    /// The client sent a packet that no client sends, or a second CONNECT.
    #[error("the client sent a {0:?}, which is not for it to send")]
    Unexpected(PacketKind),
    /// The client was silent for too long.
    #[error("the client was silent for too long")]
    Idle,
    /// The client has more messages of QoS 2 unreleased than are allowed.
    #[error("the client has more than {UNRELEASED} messages of QoS 2 that it has not released")]
    Unreleased,
    /// The client asked for more than there is room for.
    #[error("the client has more than {most} {what}")]
    TooMuch {
        /// What it asked for.
        what: &'static str,
        /// The limit that it exceeded.
        most: usize,
    },
    /// Another connection has the same client id.
    #[error("another connection came with the same client id")]
    TakenOver,
    /// The connection had to make room for another one.
    #[error("there were too many connections, or too much waited to be read, and it gave way to others")]
    GaveWay,
    /// Its key was removed or is no longer valid.
    #[error("its key is not known any more")]
    NotKnown,
    /// The program ends; wills are not published.
    #[error("the program ends")]
    Closing,
}

impl Ended {
    /// The reason code for a client of MQTT 5; `None` when the client itself has gone.
    #[must_use]
    pub const fn reason(self) -> Option<Reason> {
        match self {
            Ended::Left | Ended::LeftWithWill | Ended::Gone => None,
            Ended::Malformed(wrong) => Some(wrong.reason()),
            Ended::Unexpected(_) => Some(Reason::Protocol),
            Ended::Idle => Some(Reason::KeepAlive),
            Ended::Unreleased => Some(Reason::ReceiveMaximum),
            Ended::TooMuch { .. } => Some(Reason::Quota),
            Ended::TakenOver => Some(Reason::TakenOver),
            Ended::GaveWay => Some(Reason::Busy),
            Ended::NotKnown => Some(Reason::NotAuthorized),
            Ended::Closing => Some(Reason::ShuttingDown),
        }
    }
}
