//! Halls in the text format of old clients: any text parses as a hall, or is refused with a sentence for its author.
#![no_main]

mod halls;

use hallsweep_fuzz::sim::Hall;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    halls::check(&["fuzzed.txt"], Hall::parse("fuzzed.txt", text));
});
