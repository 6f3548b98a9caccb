//! The CoAP endpoint on a test bench, without sockets and in simulated time: the plug-test cases of the ETSI by their names, what
//! else conforms, and every bound. Real sockets and real clients are not here.
#![expect(
    clippy::unwrap_used,
    clippy::wildcard_enum_match_arm,
    reason = "all of this is test; clippy only sees it in functions marked so"
)]

#[path = "coap/rig/mod.rs"]
mod rig;

#[path = "coap/blocks.rs"]
mod blocks;
#[path = "coap/blocks_bounds.rs"]
mod blocks_bounds;
#[path = "coap/core_methods.rs"]
mod core_methods;
#[path = "coap/core_options.rs"]
mod core_options;
#[path = "coap/core_separate.rs"]
mod core_separate;
#[path = "coap/flood.rs"]
mod flood;
#[path = "coap/limits.rs"]
mod limits;
#[path = "coap/links.rs"]
mod links;
#[path = "coap/messages.rs"]
mod messages;
#[path = "coap/observe.rs"]
mod observe;
#[path = "coap/observe_ends.rs"]
mod observe_ends;
#[path = "coap/observe_large.rs"]
mod observe_large;
#[path = "coap/observe_long.rs"]
mod observe_long;
#[path = "coap/observe_lossy.rs"]
mod observe_lossy;
#[path = "coap/observe_many.rs"]
mod observe_many;
#[path = "coap/observe_rules.rs"]
mod observe_rules;
#[path = "coap/refusals.rs"]
mod refusals;
#[path = "coap/reliability.rs"]
mod reliability;
#[path = "coap/repeats.rs"]
mod repeats;
#[path = "coap/soup.rs"]
mod soup;
#[path = "coap/strangers.rs"]
mod strangers;
