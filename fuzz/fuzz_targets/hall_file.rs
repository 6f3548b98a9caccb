//! Hall files of both formats: any text gives a hall in which a robot can stand, or a sentence for its author.
//! How a file is found and read from disk is not fuzzed here.
#![no_main]

use hallsweep_fuzz::core::units::Cell;
use hallsweep_fuzz::sim::{Hall, Truth};
use libfuzzer_sys::fuzz_target;

/// The longest sentence: it repeats a line of the file at most, never the file.
const SENTENCE: usize = 8192;

/// Larger halls are parsed, but not walked: that takes longer than it tells.
const WALKED: i64 = 128 * 128;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    for file in ["fuzzed.toml", "fuzzed.map"] {
        match Hall::parse(file, text) {
            Ok(hall) => check(&hall),
            Err(error) => {
                let said = error.to_string();
                assert!(said.starts_with(file) && (file.len() + 10..SENTENCE).contains(&said.len()), "{said}");
            }
        }
    }
});

fn check(hall: &Hall) {
    let bounds = hall.bounds();
    let side = |least: i32, most: i32| i64::from(most) - i64::from(least) + 1;
    let cells = side(bounds.least.x, bounds.most.x) * side(bounds.least.y, bounds.most.y);
    assert_eq!(hall.truth(Cell::HOME), Truth::Free, "the robot stands on the floor");
    if cells <= WALKED {
        let reachable = hall.reachable();
        assert!(reachable.contains(&Cell::HOME));
        assert!(reachable.iter().all(|cell| hall.truth(*cell) == Truth::Free));
    }
}
