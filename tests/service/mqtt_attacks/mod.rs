//! Attacks on our own broker: every known way to crash or block a broker, and finally all of them at once. A screen
//! that was connected before is still served. Access to topics is tested elsewhere.

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
