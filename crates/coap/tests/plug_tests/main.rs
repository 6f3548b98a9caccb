//! The CoAP endpoint on a test bench, without sockets and in simulated time: the plug-test cases of the ETSI by their
//! names, further rules, and every bound. Real sockets and real clients are not here.
#![expect(
    clippy::unwrap_used,
    clippy::wildcard_enum_match_arm,
    reason = "all of this is test; clippy only sees it in functions marked so"
)]

mod rig;

mod blocks;
mod blocks_bounds;
mod core_methods;
mod core_options;
mod core_separate;
mod flood;
mod limits;
mod links;
mod messages;
mod observe;
mod observe_ends;
mod observe_large;
mod observe_long;
mod observe_lossy;
mod observe_many;
mod observe_rules;
mod refusals;
mod reliability;
mod repeats;
mod soup;
mod strangers;
