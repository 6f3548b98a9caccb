//! Measures of the robot's motion that several of its parts go by.

use std::time::Duration;

/// What the word of a contact takes, before it was measured: a frame of the page, and the way.
pub(super) const LATENCY: Duration = Duration::from_millis(30);

/// Nearer to the centre than a frame of the page brings it, it is centred.
pub(super) const CENTRED: f64 = 0.04;

/// How far ahead it feels whether a step is complete.
pub(super) const FEELS: f64 = 0.3;

/// A latency beyond this is none: the page has hung.
pub(super) const SLOWEST: Duration = Duration::from_millis(500);

pub(super) const LATE_WORD: &str = "the word that it had met something came too late";

/// Steps quicker or slower than these are none.
pub(super) const STEPS: [Duration; 2] = [Duration::from_millis(20), Duration::from_secs(10)];
