//! The same seed gives the same run, byte for byte in the journal; another seed gives another run.

use std::sync::Arc;

use hallsweep_core::settings::Settings;
use hallsweep_sim::headless::{Verdicts, explore};
use hallsweep_sim::{Camera, Hall, SimSettings};

fn journal(seed: u64) -> String {
    let hall = Arc::new(Hall::named_or_file("airport").unwrap());
    let sim = SimSettings { unknown_rate: 0.2, photo_failure_rate: 0.2, ..SimSettings::new(seed, Camera::Stub) };
    let figures = explore(&hall, sim, Settings::default(), Default::default(), Verdicts::AllSafe, |_| {});
    figures.journal.iter().map(|entry| format!("{entry:?}\n")).collect()
}

#[test]
fn the_same_seed_gives_the_same_journal() {
    assert_eq!(journal(5), journal(5));
    assert_ne!(journal(5), journal(6), "noise, failures and the clock come from the seed");
}
