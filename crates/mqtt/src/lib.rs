//! MQTT 3.1.1 and 5 on the server's side, as arithmetic on bytes: a whole broker without sockets, clocks and tasks.
//! Authentication and moving the bytes are left to the program.
//!
//! ```text
//!   client ──► frame ──► packet ──► ClientConnection ──► Listener: commands, and what is urgent
//!                                    │
//!                                    │  Broker: rights, retained messages, who reads what
//!                                    ▼
//!   others ◄── Outbox ◄── ClientConnection ◄── Subscriber: what waits for a client, and how far it is behind
//! ```
//!
//! Begin with [`ClientConnection`]. The program owns the sockets: it hands in the received bytes with the time
//! ([`ClientConnection::handle_client`]), sends what is in [`ClientConnection::to_client`], and waits for what others
//! publish ([`Subscriber::poll_come`]).

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
pub use rights::{Rights, Tier};
pub use routed_delivery::{RoutedDelivery, Router};
pub use subscriber::Subscriber;
pub use urgent_search::UrgentSearch;
