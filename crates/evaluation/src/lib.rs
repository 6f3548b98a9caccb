//! Strategies of search, measured and tuned: random halls by family, bare walks through them without a mission, and the
//! tuning of weights. Nothing here is needed to run a mission, and no file is written.
//!
//! ```text
//!   family ─► hall ─► ground ─► walk: strategy and floor, move by move, as a mission makes them
//!                                ├─► compare: strategies on the same halls ─► figures, drawing
//!                                ├─► time_left: how often a forecast of the time left holds
//!                                └─► tune: cross-entropy ─► counterfactuals ─► weights
//! ```

pub mod compare;
pub mod drawing;
pub mod family;
mod ground;
mod parallel;
pub mod time_left;
pub mod tune;
pub mod walk;

pub use ground::Ground;
