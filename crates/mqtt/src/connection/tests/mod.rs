//! Tests of a whole connection: what a client sends, what others receive of it, and what comes back.

mod chunks;
mod ends;
mod five;
mod five_sessions;
mod flooding;
mod kept;
mod model;
mod publishing;
mod routed_deliveries;
mod scene;
mod sessions;
mod subscribing;
