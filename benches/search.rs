//! Cost of the search, printed beside the crate `pathfinding`, measured in this run on the same halls: ways over
//! known cells, and the next decision. Further parts measure the cost of a move in halls of every size, the memory
//! per cell, and large foreign maps searched completely.
//! `cargo bench --bench search -- replan` runs that part alone; the other parts are `decision`, `growth` and `maps`.
//! `--plot FILE` draws the growth as SVG.
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
    // Memory is measured first, before any freed memory exists that the allocator could reuse.
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

/// Names of the requested parts, and the path of the plot. Arguments of cargo begin with a dash and are ignored.
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
