//! YAML files that describe an image: any text gives a hall, or is refused with a sentence for its author.
#![no_main]

mod halls;

use hallsweep_fuzz::sim::Hall;
use libfuzzer_sys::fuzz_target;

/// Pixels for free, luggage as in our own files, unknown, and occupied.
const IMAGE: &[u8] = b"P5\n4 2\n255\n\xfe\x32\xcd\x00\xfe\xfe\xfe\xfe";

fuzz_target!(|bytes: &[u8]| {
    let Ok(yaml) = std::str::from_utf8(bytes) else { return };
    halls::check(&["fuzzed.yaml", "fuzzed.pgm"], Hall::parse_occupancy("fuzzed.yaml", yaml, "fuzzed.pgm", IMAGE, None));
});
