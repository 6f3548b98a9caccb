//! Attacks on our own broker: everything that is known to end or stop brokers, and then everything at once.
//! Whatever is done, a screen that was there before is served still. Which client sees what, is tested elsewhere.

mod churn;
pub(crate) mod client;
mod crowds;
mod deaf;
pub(crate) mod five;
mod floods;
mod kill_list;
mod malformed;
pub(crate) mod packets;
mod shares;
mod siege;
mod stalled;
mod stops;
mod viewers;

pub(crate) use crowds::{framed, web_client};
