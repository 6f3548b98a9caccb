//! Two experiments in simulated time, beside the hall and its mission: the Roomba of seed 001 (`roomba`) and the pallet scenario
//! (`pallet`). Each runs from a seed, and is shown as JSON, as an SVG drawing and in English. Pages, languages and the command
//! line belong to the program.

pub mod pallet;
pub mod roomba;
