//! Why a connection ends. The list includes the reasons that only the owner of the socket can know.

use crate::frame::{Malformed, PacketKind};
use crate::limits::UNRELEASED;
use crate::packet::reason::Reason;

/// Why a connection ends. The text is for the log, and for clients of MQTT 5 that want reasons in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Ended {
    /// The client sent a DISCONNECT that discards its will.
    #[error("the client disconnected")]
    Left,
    /// The client sent a DISCONNECT that asks for its will to be published.
    #[error("the client disconnected and asked for its will")]
    LeftWithWill,
    /// The socket was closed or broke without a DISCONNECT, so the will is published.
    #[error("the connection was lost")]
    Gone,
    /// A packet breaks the rules of MQTT; the packets before it were handled.
    #[error("the client sent an invalid packet: {0}")]
    Malformed(#[from] Malformed),
    /// The client sent a packet that no client sends, or a second CONNECT.
    #[error("the client sent a {0:?}, which a client may not send")]
    Unexpected(PacketKind),
    /// No packet came for one and a half times the keep alive (section 3.1.2.10), or for a day.
    #[error("the client was silent for too long")]
    Idle,
    /// More than `limits::UNRELEASED` messages of QoS 2 wait for the client's PUBREL.
    #[error("the client has more than {UNRELEASED} messages of QoS 2 that it has not released")]
    Unreleased,
    /// The client used more than its share of something, such as the room for unread answers.
    #[error("the client has more than {most} {what}")]
    TooMuch {
        /// The thing that the client has too much of, in the plural.
        what: &'static str,
        /// The largest number that the client may have.
        most: usize,
    },
    /// Another connection came with the same client id, so the older one ends (section 3.1.4).
    #[error("another connection came with the same client id")]
    TakenOver,
    /// The connection was closed to make room for other connections. Data that waited to be sent is dropped.
    #[error("the connection was closed because there were too many connections or too much unread data")]
    GaveWay,
    /// The client's key was removed or is no longer valid, so the client's session ends as well.
    #[error("the key of the client is not valid any more")]
    NotKnown,
    /// The program ends; wills are not published.
    #[error("the program is ending")]
    Closing,
}

impl Ended {
    /// The reason code for a client of MQTT 5; `None` if the client itself has ended the connection.
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
