//! Tests of a whole connection: what a client says, what reaches the router, and what comes back.

mod chunks;
mod ends;
mod flooding;
mod kept;
mod publishing;
mod router_side;
mod scene;
mod subscribing;
