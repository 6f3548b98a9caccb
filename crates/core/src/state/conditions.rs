//! What a record of a mission means beside itself, and what may be other at another time: in which hall it was, and what counted as too hot.

use std::sync::Arc;

use crate::units::Celsius;

/// The circumstances of what happens.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// The name of the hall.
    pub hall: Arc<str>,
    /// The side of a cell, in metres, where it is known.
    pub cell_m: Option<f64>,
    /// Above this nothing moves.
    pub threshold: Celsius,
}
