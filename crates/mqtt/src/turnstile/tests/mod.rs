//! Tests of a whole turnstile: what a client says, what reaches the engine, and what comes back.

mod chunks;
mod ends;
mod engine_side;
mod flooding;
mod kept;
mod publishing;
mod scene;
mod subscribing;
