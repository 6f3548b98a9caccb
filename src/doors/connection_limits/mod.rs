//! Limits of connections, sessions and requests at the HTTP and MQTT doors, so that no crowd keeps anybody else out
//! (safety S9). CoAP has no connections. Its limits are in `crates/coap` and in `coap::flood_filter`.
//!
//! | limit | of what | beyond it |
//! |---|---|---|
//! | `connection_budget` | all descriptors of all doors | pending connections, slots, sessions and streams are scaled down |
//! | `pending_connections` | those without a slot or session yet, or closing | the oldest of the largest crowd is evicted |
//! | `connection_slots` | HTTP connections with a whole head | a stranger's, then a viewer's, then an operator's is evicted |
//! | `session_limits` | MQTT sessions, and the unread bytes of their clients | a session of the largest owner is evicted |
//! | `request_quota` | streams, results of MQTT commands, reports, laboratory runs | refused, or without a result |
//! | `command_rate` | MQTT commands of one sender per second, except STOP | the command is refused |

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
