//! Of access, the roles: the gate of the MQTT door asks who may publish where.

#[path = "../../src/access/role.rs"]
mod role;

pub use role::{Need, Role};
