//! What the runtime's ports lead to: robots and the store. Doors are in `crate::inbound`, and neither knows the other.

pub mod store;
