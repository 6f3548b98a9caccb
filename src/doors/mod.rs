//! The doors: how operators and programs reach hallsweep. No door knows another, and none knows an adapter. What doors with
//! connections have in common lies beside them: the ports they listen to, where connections wait that have no place, how many places
//! there are where the system gives few, of which a key has its share, how long a reader may stall, how soon what is large is said again,
//! and what is said where something is not done.

pub mod coap;
pub mod http;
pub mod listeners;
pub mod mqtt;
mod pace;
mod problem;
pub mod room;
mod seldom;
mod shares;
mod vestibule;
mod write_timeout;
