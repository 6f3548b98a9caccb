//! Tests of a whole connection: what a client sends, what other clients receive, and what the client gets back.

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
mod scopes;
mod sessions;
mod subscribing;
