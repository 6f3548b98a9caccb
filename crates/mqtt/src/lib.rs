//! The gate before the engine: everything that decides what of a client's bytes reaches the engine, and what of the engine's bytes
//! the client. All of it is arithmetic on bytes: no socket, no clock, no task is here.
//!
//! ```text
//!   client ──► frame ──► packet ──► turnstile ──► engine       QoS 0 PUBLISH, SUBSCRIBE, UNSUBSCRIBE, PUBACK in order, PINGREQ
//!   client ◄──────────────────────  turnstile ◄── engine       PUBLISH, SUBACK, UNSUBACK
//!                                    │  rights, budget, kept messages, commands heard
//! ```
//!
//! What the engine never sees, because each of it ends or stops it for everybody: a client's own id, a will, a retained message, a
//! DISCONNECT (the connection is simply closed), QoS 1 and 2 of clients (acknowledged here), `$…` and `$share`, topics that do not
//! begin with an ASCII character, acknowledgements it does not wait for, and more filters and topics than it can remember.

pub mod budget;
pub mod filter;
pub mod frame;
pub mod ledger;
pub mod limits;
pub mod outbox;
pub mod packet;
pub mod parcels;
pub mod readers;
pub mod retained;
pub mod rights;
pub mod stop_search;
pub mod turnstile;
