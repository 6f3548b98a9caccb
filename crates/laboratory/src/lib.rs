//! Two experiments in simulated time, beside the hall and its mission: the Roomba of seed 001 (`roomba`) and the pallet scenario
//! (`pallet`). Each is run from a seed and shown as JSON, as an SVG drawing and in English; pages, languages and the command line are
//! the program's.

pub mod pallet;
pub mod roomba;
