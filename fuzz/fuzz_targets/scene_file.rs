//! Scene files of the virtual robot's page: any bytes parse as a scene that makes a hall, or are refused with a
//! sentence and a line.
#![no_main]

mod halls;

use hallsweep_fuzz::sim::Scene;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match Scene::parse("fuzzed.js", bytes) {
        Ok(scene) => {
            halls::check(&["fuzzed.js"], scene.hall("fuzzed").map(|made| made.hall).map_err(|fault| fault.of("fuzzed.js")))
        }
        Err(error) => assert!(error.line.is_some_and(|line| line > 0) && !error.to_string().is_empty(), "{error}"),
    }
});
