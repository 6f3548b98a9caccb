//! Why a connection ends. Those that only whoever moves the bytes can know are here, too, so that there is one list of them.

use crate::frame::{Malformed, PacketKind};
use crate::limits::UNRELEASED;
use crate::packet::reason::Reason;

/// Why a connection ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Ended {
    /// The client took its leave: it leaves no will.
    #[error("the client took its leave")]
    Left,
    /// The client went, and wants its will to be published.
    #[error("the client went, and left its will")]
    LeftWithWill,
    /// The connection is closed or broken.
    #[error("the connection is gone")]
    Gone,
    /// A packet was wrong.
    #[error("the client sent nonsense: {0}")]
    Malformed(#[from] Malformed),
    /// A packet that no client sends, or a second CONNECT.
    #[error("the client sent a {0:?}, which is not for it to send")]
    Unexpected(PacketKind),
    /// Nothing was heard for too long.
    #[error("the client was silent for too long")]
    Idle,
    /// It sends more messages of QoS 2 than it may, and releases none.
    #[error("the client has more than {UNRELEASED} messages of QoS 2 that it has not released")]
    Unreleased,
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

impl Ended {
    /// What one of MQTT 5 is told of it; `None`: it is the one who has gone.
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
