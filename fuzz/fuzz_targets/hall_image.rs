//! Images of halls in PGM and PNG, with pixels larger and smaller than a cell: any bytes parse as a hall, or are
//! refused with a sentence for their author.
#![no_main]

mod halls;

use hallsweep_fuzz::sim::Hall;
use libfuzzer_sys::fuzz_target;

const REST: &str = "image: fuzzed.pgm\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

fuzz_target!(|bytes: &[u8]| {
    for (resolution, mode) in [("0.5", "trinary"), ("0.07", "scale"), ("1.5", "raw")] {
        let yaml = format!("{REST}resolution: {resolution}\nmode: {mode}\n");
        halls::check(&["fuzzed.yaml", "fuzzed.pgm"], Hall::parse_occupancy("fuzzed.yaml", &yaml, "fuzzed.pgm", bytes, None));
    }
});
