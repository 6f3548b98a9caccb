//! What the search costs, printed beside the crate `pathfinding`, measured in this run on the same halls: ways over what is known, and
//! what to do next; then what a move costs in halls of every size, the memory a cell, and foreign maps of large size searched whole.
//! `cargo bench --bench search -- replan` does that part alone; the others are `decision`, `growth` and `maps`. `--plot FILE` draws
//! the growth as SVG.
#![expect(clippy::print_stdout, reason = "a benchmark prints")]

#[path = "search/cpu.rs"]
mod cpu;
#[path = "search/decision.rs"]
mod decision;
#[path = "search/explored.rs"]
mod explored;
#[path = "search/foreign.rs"]
mod foreign;
#[path = "common/goals.rs"]
#[expect(dead_code, reason = "no rival can be absent")]
mod goals;
#[path = "search/growth.rs"]
mod growth;
#[path = "search/maps.rs"]
mod maps;
#[path = "search/replan.rs"]
mod replan;
#[path = "search/rivals.rs"]
mod rivals;

use std::process::ExitCode;

fn main() -> ExitCode {
    let (words, plot) = asked(std::env::args().skip(1));
    // Memory is measured first, while nothing has been freed that it could be taken from.
    let parts: [(&str, &dyn Fn()); 4] = [
        ("growth", &|| growth::run(plot.as_deref())),
        ("replan", &replan::run),
        ("decision", &decision::run),
        ("maps", &maps::run),
    ];
    for (name, part) in parts {
        if words.is_empty() || words.iter().any(|word| word == name) {
            part();
        }
    }
    if let Some(unknown) = words.iter().find(|word| parts.iter().all(|(name, _)| word != name)) {
        goals::left_out(unknown, true, "no part is called so");
    }
    goals::exit()
}

/// The parts that are wanted, and where the plot goes. What cargo says to every benchmark begins with a dash and means nothing here.
fn asked(mut arguments: impl Iterator<Item = String>) -> (Vec<String>, Option<String>) {
    let (mut words, mut plot) = (Vec::new(), None);
    while let Some(word) = arguments.next() {
        if word == "--plot" {
            plot = arguments.next();
        } else if !word.starts_with('-') {
            words.push(word);
        }
    }
    (words, plot)
}
