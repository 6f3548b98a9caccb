//! Hall files and MovingAI maps: any text parses as a hall in which a robot can stand, or is refused with a sentence
//! for its author.
//! Finding and reading files is not fuzzed here.
#![no_main]

mod halls;

use hallsweep_fuzz::sim::Hall;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    for file in ["fuzzed.toml", "fuzzed.map"] {
        halls::check(&[file], Hall::parse(file, text));
    }
});
