//! `hallsweep-evaluation tune`: finds weights for the score of unknown cells, and writes them to a file. The weights
//! are found by `hallsweep_evaluation::tune`. This file reads the flags and shows the progress.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::Failure;
use super::output_file::{OutputFile, is_standard_output};
use hallsweep_core::search::Objective;
use hallsweep_core::search::Terms;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::weights::Weights;
use hallsweep_evaluation::family::Family;
use hallsweep_evaluation::tune::{Lessons, Round, Task, cross_entropy};

/// The flags of `tune`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "The same flags give the same weights. A weights file names the flags that produced the file.")]
pub(crate) struct Tune {
    /// Goal of the search: find (find luggage soon) or cover (cover the whole hall in few moves).
    #[arg(long, value_name = "NAME", default_value = "cover", value_parser = objective)]
    goal: Objective,
    /// Range of the sonar in cells, 1 to 7; 0 means that the robot detects obstacles by driving into them.
    #[arg(long, value_name = "CELLS", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=7))]
    sonar: u8,
    /// Costs of a step, a turn and a bump.
    #[arg(long, value_name = "STEP,TURN,BUMP", default_value = "1,1,1", value_parser = costs)]
    costs: Costs,
    /// Families of halls to learn from, in equal shares: empty, luggage-PERCENT, walls, islands, pockets, corridors,
    /// maze.
    #[arg(long, value_name = "FAMILIES", default_value = "luggage-10", value_delimiter = ',', value_parser = family)]
    halls_of: Vec<Family>,
    /// Shortest and longest side of the halls, in cells.
    #[arg(long, value_name = "LEAST,MOST", default_value = "20,30", value_parser = sides)]
    sides: (usize, usize),
    /// Seed of all random numbers.
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    seed: u64,
    /// Number of generations of the cross-entropy search for the linear weights.
    #[arg(long, value_name = "NUMBER", default_value_t = 30, value_parser = clap::value_parser!(u64).range(0..=10_000))]
    generations: u64,
    /// Number of rounds that learn the tables from counterfactual decisions.
    #[arg(long, value_name = "NUMBER", default_value_t = 4, value_parser = clap::value_parser!(u64).range(0..=1000))]
    rounds: u64,
    /// Number of halls per round.
    #[arg(long, value_name = "NUMBER", default_value_t = 6000, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    halls: u32,
    /// Number of steps for which each counterfactual decision is simulated.
    #[arg(long, value_name = "STEPS", default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..))]
    horizon: u32,
    /// Begin with the weights in this file, and skip the cross-entropy search.
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// File to which the weights are written.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Strength of the ridge regression's penalty. Of the values that were tried, this one is the best.
const RIDGE: f64 = 1500.0;
/// Share of the decisions at which a trial makes another choice. Of all shares that were tested, this one gave the
/// best weights.
const TRIED: f64 = 0.4;

/// Maximum size of a weights file, in bytes.
const MOST_BYTES: u64 = 4 * 1024 * 1024;

/// Smallest weight that is written to the file, in thousandths of a step.
const SMALLEST: i16 = 20;

pub(crate) fn run(flags: &Tune) -> Result<(), Failure> {
    let terms = Terms { objective: flags.goal, sonar_cells: flags.sonar, costs: flags.costs };
    let task = Task { terms, sides: flags.sides, families: flags.halls_of.clone(), seed: flags.seed };
    // The progress bar is on standard error, and is shown only on a terminal.
    let style = ProgressStyle::with_template("tuning {wide_bar} {pos} of {len} · {elapsed} · {msg}")
        .expect("the template is a constant and names only existing fields");
    let parts = if flags.from.is_some() { 0 } else { flags.generations } + flags.rounds;
    let bar = ProgressBar::new(parts).with_style(style);
    let halls = flags.halls as usize;
    let mut origin = flags.origin();
    let from = flags.from.as_deref().map(read_weights).transpose()?;
    let file = OutputFile::open(&flags.out)?;
    let mut weights = match from {
        Some(weights) => weights,
        None => cross_entropy(&task, &task.first_weights(), flags.generations, |generation, price| {
            bar.inc(1);
            bar.set_message(format!("generation {generation}: {price:.4} a cell"));
        }),
    };
    let mut lessons = Lessons::new(&task, &weights, halls);
    for number in 0..flags.rounds {
        // The first round applies more of the computed change, because it must move far from the initial weights.
        // Later rounds only correct the weights a little.
        let taken = if number == 0 { 0.9 } else { 0.7 };
        let round = Round { number, halls, horizon: f64::from(flags.horizon), tried: TRIED, ridge: RIDGE, taken };
        let learnt = lessons.learn(&weights, &round);
        weights = learnt.weights;
        let (before, after) = learnt.missed;
        let _ = write!(origin, "\nround {number}: {} counterfactuals; missed by {before:.2}, then {after:.2}", learnt.tried);
        bar.inc(1);
        bar.set_message(format!("round {number}: {} counterfactuals", learnt.tried));
    }
    bar.finish_and_clear();
    file.write(&weights.write(&origin, SMALLEST))?;
    if is_standard_output(&flags.out) {
        return Ok(());
    }
    super::print(&format!("the weights are in {}", flags.out.display()))
}

impl Tune {
    fn origin(&self) -> String {
        let from = self.from.as_ref().map_or_else(String::new, |path| format!(" --from {}", path.display()));
        let families: Vec<String> = self.halls_of.iter().map(Family::to_string).collect();
        format!(
            "What an unknown cell is worth to a search: hallsweep-evaluation tune --goal {} --sonar {} --costs {} --halls-of {} \
             --sides {},{} --seed {} \
             --generations {} --rounds {} --halls {} --horizon {}{from}",
            self.goal.name(),
            self.sonar,
            self.costs,
            families.join(","),
            self.sides.0,
            self.sides.1,
            self.seed,
            self.generations,
            self.rounds,
            self.halls,
            self.horizon
        )
    }
}

pub(super) fn read_weights(path: &Path) -> Result<Weights, Failure> {
    let unusable = |error: String| Failure::Usage(format!("{}: {error}", path.display()));
    let file = File::open(path).map_err(|error| unusable(error.to_string()))?;
    let mut text = String::new();
    file.take(MOST_BYTES).read_to_string(&mut text).map_err(|error| unusable(error.to_string()))?;
    Weights::read(&text).map_err(|error| unusable(error.to_string()))
}

fn family(written: &str) -> Result<Family, String> {
    written
        .parse()
        .map_err(|()| "write one of: empty, luggage-1 to luggage-30, walls, islands, pockets, corridors, maze".to_owned())
}

/// Reads two side lengths from 5 to 200. The first must not be larger than the second.
fn sides(written: &str) -> Result<(usize, usize), String> {
    let read = || {
        let (least, most) = written.split_once(',')?;
        let (least, most) = (least.parse().ok()?, most.parse().ok()?);
        (5 <= least && least <= most && most <= 200).then_some((least, most))
    };
    read().ok_or_else(|| "write the shortest and the longest side, as 20,30, from 5 to 200".to_owned())
}

pub(super) fn objective(written: &str) -> Result<Objective, String> {
    let known = Objective::ALL.into_iter().find(|objective| objective.name() == written);
    known.ok_or_else(|| format!("write one of: {}", Objective::ALL.map(Objective::name).join(", ")))
}

pub(super) fn costs(written: &str) -> Result<Costs, String> {
    Costs::read(written).ok_or_else(|| "write what a step, a turn and a bump cost, as 1,1,1".to_owned())
}
