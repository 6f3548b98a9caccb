//! The sweep widths of calibrated sensors, in metres, for views from 1 cell on. Views from farther away do not count.

/// The camera of the simulated robot: printed by `hallsweep-evaluation evaluate --calibrate`, from 1000 searches with
/// seed 1. Each line names the looks at pieces that were not found before, and how many of them missed the piece.
pub(super) const SIM_CAMERA: [f64; 7] = [
    1.199, // 1 cells: 23800 looks, 2164 misses
    0.893, // 2 cells: 12264 looks, 2054 misses
    0.589, // 3 cells: 8330 looks, 2565 misses
    0.380, // 4 cells: 5671 looks, 2653 misses
    0.237, // 5 cells: 3531 looks, 2197 misses
    0.166, // 6 cells: 1931 looks, 1385 misses
    0.112, // 7 cells: 831 looks, 665 misses
];
