//! Strategies of search compared over many halls, and tuned: random halls by family, bare walks without a mission round them, figures
//! with their intervals. Nothing here is needed to run a mission.

pub mod family;
pub mod tune;
pub mod walk;
