//! Whole missions in simulated time: seeded, without doors and without waiting. A failure prints its seed and hall.

mod halls;
mod random_halls;
