//! `hallsweep-evaluation evaluate`: compares strategies on the same halls. The searches are made by
//! `hallsweep_evaluation::compare`. This file reads the flags, shows the progress and writes the results.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::Failure;
use super::output_file::{OutputFile, distinct, unwritable};
use super::tune::{costs, objective, read_weights};
use hallsweep_core::command::Strategy;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::{Objective, Terms};
use hallsweep_evaluation::areas::{ROWS, gain};
use hallsweep_evaluation::calibrate::{bins, passes, widths};
use hallsweep_evaluation::compare::{Contest, Entrant, Halls, Kind, KindError, Measure, Timings, Trial, rows, tour};
use hallsweep_evaluation::family::Family;
use hallsweep_evaluation::time_left::{Held, held};
use hallsweep_evaluation::{Ground, drawing};
use hallsweep_sim::{Hall, SimSettings};

mod report;
mod written;

/// The flags of `evaluate`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Without --halls, the program prints the table of docs/search.md; this takes less than a minute.\n\
    Families of random halls: empty, luggage-PERCENT, walls, islands, pockets, corridors, maze. Add the size, such as \
    luggage-10:50x50.\n\
    The same flags give the same halls and the same moves; only the decision times differ.")]
pub(crate) struct Evaluate {
    /// Halls, separated by commas: a family of random halls with its size, the name of a built-in hall, or a hall
    /// file. Default: the comparisons of the table in docs/search.md.
    #[arg(long, value_name = "HALLS", value_delimiter = ',')]
    halls: Vec<String>,
    /// Number of halls of each family.
    #[arg(long, value_name = "NUMBER", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    count: u32,
    /// Seed of the random halls.
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    seed: u64,
    /// Strategies to compare, separated by commas; by default all.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = strategy)]
    strategies: Vec<Strategy>,
    /// Also compare the search that uses the weights in this file.
    #[arg(long, value_name = "FILE")]
    weights: Vec<PathBuf>,
    /// Compare each strategy with this one, hall by hall.
    #[arg(long, value_name = "NAME", value_parser = strategy, requires = "halls")]
    against: Option<Strategy>,
    /// Goal of the searches: find (find luggage soon) or cover (cover the whole hall in few moves).
    #[arg(long, value_name = "NAME", default_value = "find", value_parser = objective, requires = "halls")]
    goal: Objective,
    /// Range of the sonar in cells, 1 to 7; 0 means that the robot detects obstacles by driving into them.
    #[arg(long, value_name = "CELLS", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=7), requires = "halls")]
    sonar: u8,
    /// Costs of a step, a turn and a bump.
    #[arg(long, value_name = "STEP,TURN,BUMP", default_value = "1,1,1", value_parser = costs, requires = "halls")]
    costs: Costs,
    /// Instead of comparing, measure how often the console's estimate of the remaining time is correct. The
    /// measurement covers each family of halls and the whole of each search.
    #[arg(long, conflicts_with_all = ["halls", "strategies", "weights", "json", "csv", "plot"])]
    time_left: bool,
    /// Instead of comparing, calibrate the simulated camera that can miss luggage: print its sweep widths from 1000
    /// searches, and how well they predict 1000 others.
    #[arg(long, conflicts_with_all = ["halls", "strategies", "weights", "time_left", "areas", "count", "json", "csv", "plot"])]
    calibrate: bool,
    /// Instead of comparing, measure how much sooner the bomb is found in halls whose areas have known probabilities.
    #[arg(long, conflicts_with_all = ["halls", "strategies", "weights", "json", "csv", "plot", "time_left"])]
    areas: bool,
    /// Print one JSON object instead of the tables.
    #[arg(long)]
    json: bool,
    /// Write one CSV line per search to this file.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a chart that compares the strategies to this file, as SVG.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Write each strategy's path through the first hall to this folder, as SVG files.
    #[arg(long, value_name = "DIR", requires = "halls")]
    tours: Option<PathBuf>,
}

struct Question {
    contest: Contest,
    measure: Measure,
}

struct Answer {
    question: Question,
    trials: Vec<Vec<Trial>>,
}

impl Answer {
    /// Total number of reachable cells in all halls, and total number of free cells.
    fn reach(&self) -> [usize; 2] {
        let mine = self.trials.first().into_iter().flatten();
        mine.fold([0, 0], |[cells, free], trial| [cells + trial.cells, free + trial.free_cells])
    }
}

pub(crate) fn run(flags: &Evaluate) -> Result<(), Failure> {
    if flags.time_left {
        return super::print(&time_left(flags));
    }
    if flags.calibrate {
        return super::print(&calibrate(flags));
    }
    if flags.areas {
        return super::print(&areas(flags));
    }
    let entrants = flags.entrants()?;
    let against = flags.against.map(|other| {
        entrants.iter().position(|entrant| *entrant == Entrant::Strategy(other)).ok_or_else(|| {
            Failure::Usage(format!("--against {0}: the strategy {0} is not compared; add {0} to --strategies", other.name()))
        })
    });
    let against = against.transpose()?;
    let questions = flags.questions()?;
    distinct(flags.halls.iter().map(Path::new), flags.csv.as_deref().into_iter().chain(flags.plot.as_deref()))?;
    let (csv, plot) = (open(flags.csv.as_deref())?, open(flags.plot.as_deref())?);
    for (file, question, entrant) in flags.tours(&questions, &entrants)? {
        file.write(&picture(question, entrant))?;
    }
    let answers = compare(questions, &entrants);
    if let Some(file) = csv {
        file.write(&written::csv(&answers, &entrants))?;
    }
    if let Some(file) = plot {
        file.write(&report::plot(&answers, &entrants))?;
    }
    let text = if flags.json {
        written::json(&answers, &entrants, against)
    } else if flags.halls.is_empty() {
        report::rows(&answers, &entrants)
    } else {
        report::blocks(&answers, &entrants, against)
    };
    super::print(text.trim_end())?;
    let missed = answers.iter().flat_map(|answer| answer.trials.iter().flatten()).filter(|trial| !trial.complete).count();
    if missed > 0 {
        Err(Failure::Run(format!("{missed} searches were not complete: this is a bug in hallsweep")))
    } else {
        Ok(())
    }
}

fn time_left(flags: &Evaluate) -> String {
    let bar = progress_bar(Family::ALL.len() as u64);
    let held = |family: Family| {
        bar.set_message(family.to_string());
        let held = held(family, flags.count as usize, flags.seed);
        bar.inc(1);
        (family, held)
    };
    let held: Vec<(Family, Held)> = Family::ALL.into_iter().map(held).collect();
    bar.finish_and_clear();
    report::time_left(&held)
}

/// Number of searches for a calibration, and for its judgement.
const SEARCHES: usize = 1000;

fn calibrate(flags: &Evaluate) -> String {
    let (tuned, judged) = (flags.seed, flags.seed.wrapping_add(1));
    let (widths, bins) = (widths(&passes(SEARCHES, tuned)), report::bins(&bins(&passes(SEARCHES, judged))));
    format!(
        "{widths}\nSweep widths in metres, from {SEARCHES} searches with seed {tuned}.\n\n{bins}\n\n\
         The probabilities that this build states, in {SEARCHES} searches with seed {judged}."
    )
}

fn areas(flags: &Evaluate) -> String {
    let bar = progress_bar(ROWS.len() as u64);
    let gains = ROWS.map(|row @ (kind, sonar_cells)| {
        bar.set_message(kind);
        let gain = gain(kind.parse().expect("a test measures all rows"), sonar_cells, flags.count as usize, flags.seed);
        bar.inc(1);
        (row, gain.expect("there is at least one hall"))
    });
    bar.finish_and_clear();
    report::areas(&gains, flags.count, flags.seed)
}

#[expect(clippy::disallowed_methods, reason = "how long a decision takes is one of the figures")]
fn compare(questions: Vec<Question>, entrants: &[Entrant]) -> Vec<Answer> {
    let searches: usize = questions.iter().map(|question| question.contest.halls.count() * entrants.len()).sum();
    let (bar, start) = (progress_bar(searches as u64), Instant::now());
    let answer = |question: Question| {
        bar.set_message(question.contest.halls.to_string());
        let trials = question.contest.run(entrants, || start.elapsed(), || bar.inc(1));
        Answer { question, trials }
    };
    let answers = questions.into_iter().map(answer).collect();
    bar.finish_and_clear();
    answers
}

impl Evaluate {
    fn entrants(&self) -> Result<Vec<Entrant>, Failure> {
        let named = if self.strategies.is_empty() { Strategy::ALL.to_vec() } else { self.strategies.clone() };
        let mut entrants: Vec<Entrant> = Vec::new();
        for strategy in named.into_iter().map(Entrant::Strategy) {
            if !entrants.contains(&strategy) {
                entrants.push(strategy);
            }
        }
        for path in &self.weights {
            let weights = Box::new(read_weights(path)?);
            entrants.push(Entrant::Weights { name: path.display().to_string(), weights });
        }
        Ok(entrants)
    }

    fn questions(&self) -> Result<Vec<Question>, Failure> {
        let (count, timings) = (self.count as usize, timings());
        if self.halls.is_empty() {
            let rows = rows::rows(count, self.seed, timings).into_iter();
            return Ok(rows.map(|rows::Row { contest, measure }| Question { contest, measure }).collect());
        }
        let terms = Terms { objective: self.goal, sonar_cells: self.sonar, costs: self.costs };
        let measure = match self.goal {
            Objective::Cover => Measure::MovesPerCell,
            Objective::Find => Measure::ToAPiece,
        };
        let asked = |written: &String| {
            let contest = Contest { halls: self.halls(written)?, terms, timings };
            Ok(Question { contest, measure })
        };
        self.halls.iter().map(asked).collect()
    }

    fn tours<'a>(
        &self,
        questions: &'a [Question],
        entrants: &'a [Entrant],
    ) -> Result<Vec<(OutputFile, &'a Question, &'a Entrant)>, Failure> {
        let Some(folder) = &self.tours else { return Ok(Vec::new()) };
        std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
        let mut taken = BTreeSet::new();
        let all = questions.iter().flat_map(|question| entrants.iter().map(move |entrant| (question, entrant)));
        let opened = |(question, entrant): (&'a Question, &'a Entrant)| {
            let name = format!("{}-{}", entrant.name(), question.contest.halls);
            // Other characters are not allowed in file names on every system.
            let plain = name.replace(|letter: char| !letter.is_ascii_alphanumeric() && letter != '.', "-");
            let named = |n: usize| if n == 1 { format!("{plain}.svg") } else { format!("{plain}-{n}.svg") };
            // Two halls may have the same name, so the file names are numbered.
            let name = (1..).map(named).find(|name| taken.insert(name.clone())).expect("there is always another number");
            Ok((OutputFile::open(&folder.join(name))?, question, entrant))
        };
        all.map(opened).collect()
    }

    /// Reads one value of `--halls`. If it begins with the name of a family, it is never taken for the name or the
    /// file of a hall.
    fn halls(&self, written: &str) -> Result<Halls, Failure> {
        match written.parse::<Kind>() {
            Ok(kind) => Ok(Halls::Random { kind, count: self.count as usize, seed: self.seed }),
            Err(error @ (KindError::Size(_) | KindError::Share | KindError::TooMuch(_))) => {
                Err(Failure::Usage(format!("--halls {written}: {error}")))
            }
            Err(KindError::NoFamily) => {
                let hall = Hall::named_or_file(written).map_err(|error| Failure::Usage(format!("--halls {error}")))?;
                Ok(Halls::Drawn(Box::new(hall)))
            }
        }
    }
}

fn timings() -> Timings {
    let SimSettings { step, turn, .. } = SimSettings::default();
    Timings { step_s: step.as_secs_f64(), turn_s: turn.as_secs_f64(), bump_s: step.as_secs_f64() }
}

fn picture(question: &Question, entrant: &Entrant) -> String {
    let Contest { halls, terms, .. } = &question.contest;
    let hall = halls.hall(0);
    let way = tour(&Ground::of(&hall), *terms, entrant, &mut Ways::default());
    drawing::tour(&hall, &way, &format!("{} · {halls} · {}", entrant.name(), report::asked(*terms)))
}

fn open(path: Option<&Path>) -> Result<Option<OutputFile>, Failure> {
    path.map(OutputFile::open).transpose()
}

fn strategy(written: &str) -> Result<Strategy, String> {
    Strategy::named(written).ok_or_else(|| format!("write one of: {}", Strategy::ALL.map(Strategy::name).join(", ")))
}

/// Makes a progress bar on standard error. It is shown only on a terminal.
fn progress_bar(searches: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("evaluating {wide_bar} {pos} of {len} searches · {elapsed} · {msg}");
    ProgressBar::new(searches).with_style(style.expect("the template is a constant and names only existing fields"))
}
