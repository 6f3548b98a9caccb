//! What can be told of requests from their bytes alone.

#[path = "../../../src/doors/http/scanning/mod.rs"]
pub mod scanning;
