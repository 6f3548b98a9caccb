//! MQTT 3.1.1 on the server's side, as arithmetic on bytes: no socket, no clock, no task is here. It stands as a gate before a router
//! of messages that is fast and trusts everybody, and decides what of a client's bytes reaches the router, and what of the router's
//! bytes the client.
//!
//! ```text
//!   client ──► frame ──► packet ──► ClientConnection ──► router       QoS 0 PUBLISH, SUBSCRIBE, UNSUBSCRIBE, PUBACK in order, PINGREQ
//!   client ◄──────────────────────  ClientConnection ◄── router       PUBLISH, SUBACK, UNSUBACK
//!                                    │  Broker: rights, budget, kept messages, who reads what and who lags
//!                                    └► Listener: commands, and what is urgent
//! ```
//!
//! What the router never sees, because there are routers that each of it ends or stops for everybody: a client's own id, a will, a
//! retained message, a DISCONNECT (the connection is simply closed), QoS 1 and 2 of clients (acknowledged here), `$…` and `$share`,
//! topics that do not begin with an ASCII character, acknowledgements it does not wait for, and more filters and topics than it can
//! remember.
//!
//! Begin with [`ClientConnection`]. The program owns the sockets: it hands in what came ([`ClientConnection::handle_client`],
//! [`ClientConnection::handle_router`]) with the time, and sends what is in [`ClientConnection::outgoing`].

mod broker;
mod budget;
mod connection;
pub mod filter;
mod frame;
pub mod limits;
mod outbox;
pub mod packet;
mod parcels;
mod readers;
mod retained;
mod rights;
mod subscriber_lag;
mod urgent_search;

pub use broker::Broker;
pub use connection::{ClientConnection, CommandDecision, Ended, Epoch, Listener, Mark, Session, Terms};
pub use frame::{Frame, Kind, Malformed, frame};
pub use outbox::{Outbox, give_back};
pub use rights::{Principal, Rights, Tier};
pub use subscriber_lag::SubscriberLag;
pub use urgent_search::{PartialPublish, UrgentSearch};
