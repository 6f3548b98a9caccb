//! Two experiments in simulated time, independent of the hall and its mission. `roomba` is the Roomba of the original
//! specification (seed 001), and `pallet` is the pallet scenario. Each runs from a random seed and is shown as JSON,
//! as an SVG drawing and in English. Pages, languages and the command line belong to the main program.

pub mod pallet;
pub mod roomba;
