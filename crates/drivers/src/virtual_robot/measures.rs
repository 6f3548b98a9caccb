//! Measures of the robot's motion that several modules use.

use std::time::Duration;

/// Assumed delay of the report of a contact, before it was measured: a frame of the page, and the way.
pub(super) const LATENCY: Duration = Duration::from_millis(30);

/// Distance to the centre, in cells, at which the robot counts as centred: a frame of the page brings it no nearer.
pub(super) const CENTRED: f64 = 0.04;

/// How far ahead it feels whether a step is complete, in cells.
pub(super) const FEELS: f64 = 0.3;

/// Longest delay that is taken for a latency: beyond it the page has hung.
pub(super) const SLOWEST: Duration = Duration::from_millis(500);

pub(super) const LATE_WORD: &str = "the word that it had met something came too late";

/// Shortest and longest step that are believed.
pub(super) const STEPS: [Duration; 2] = [Duration::from_millis(20), Duration::from_secs(10)];
