//! Limits of connections, sessions and requests, so that no crowd at one door keeps anybody else out (safety S9).
//!
//! | limit | of what | beyond it |
//! |---|---|---|
//! | `connection_budget` | all descriptors of all doors | every other limit is smaller |
//! | `pending_connections` | connections that have not authenticated, or are closing | the oldest of the largest crowd is evicted |
//! | `connection_slots` | HTTP connections that have sent a request | the one with the least progress is evicted |
//! | `session_limits` | MQTT sessions, and the bytes that their clients leave unread | a session of the largest owner is evicted |
//! | `request_quota` | open requests, open streams, and results of MQTT commands | the request is refused, or has no result |
//! | `command_rate` | MQTT commands per second of one sender | the command is refused |

mod command_rate;
mod connection_budget;
mod connection_slots;
mod pending_connections;
mod request_quota;
mod session_limits;

pub(super) use command_rate::CommandRate;
pub use connection_budget::ConnectionBudget;
pub(super) use connection_slots::{ConnectionSlot, ConnectionSlots, SLOTS, SlotClaim};
pub(super) use pending_connections::{PendingConnection, PendingConnections};
pub(super) use request_quota::{OpenStream, Permit, QuotaLimits, RequestQuota, ResultQuota, StreamQuota};
#[cfg(any(test, feature = "rumqttd-router"))]
pub(super) use session_limits::CONNECTIONS;
pub(super) use session_limits::{SessionLimits, SessionOwner, SessionPermit, UnreadBytes};
