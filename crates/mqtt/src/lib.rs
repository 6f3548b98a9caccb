//! An MQTT 3.1.1 and 5 broker without sockets, clocks and tasks: received bytes go in, and bytes to send come out.
//! The program authenticates the clients and moves the bytes.
//!
//! ```text
//!   client ──► frame ──► packet ──► ClientConnection ──► Listener: commands, and what is urgent
//!                                    │
//!                                    │  Broker: rights, retained messages, who reads what
//!                                    ▼
//!   others ◄── Outbox ◄── ClientConnection ◄── Subscriber: what waits for a client, and how far it is behind
//! ```
//!
//! Begin with [`ClientConnection`]. The program owns the sockets. It hands in the received bytes with the time
//! ([`ClientConnection::handle_client`]) and sends what is in [`ClientConnection::to_client`]. It waits for messages
//! of other clients with [`Subscriber::poll_come`].

#![warn(missing_docs)]

mod broker;
mod connection;
pub mod filter;
mod frame;
mod grant;
pub mod limits;
mod message;
mod outbox;
pub mod packet;
mod readers;
mod retained;
mod rights;
mod routed_delivery;
mod subscriber;
mod subscription;
mod urgent_search;

pub use broker::{Announcement, Broker, OwnSubscription};
pub use connection::{AnswerTo, ClientConnection, CommandDecision, Ended, Epoch, LateWill, Listener, Mark, Said, Session, Terms};
pub use frame::{Frame, Malformed, PacketKind, frame};
pub use message::Message;
pub use outbox::Outbox;
pub use rights::{Rights, Scope, Tier};
pub use routed_delivery::{RoutedDelivery, Router};
pub use subscriber::Subscriber;
pub use urgent_search::UrgentSearch;
