//! `hallsweep explore`: runs one mission at full speed and without doors. The mission runs in
//! `hallsweep_sim::headless`; this file shows the progress and prints the result.

use std::fs::File;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::Failure;
use super::map_file::MapFile;
use super::output_file::distinct;
use crate::api::{journal_words, map_text};
use crate::app::AppError;
use crate::config::{self, Flag, Sources};
use crate::robots::{Unusable, sim};
use crate::telemetry;
use hallsweep_core::settings::{HotRule, Rules, SafeBy};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::fact::Entry;
use hallsweep_sim::headless::{self, Verdicts};
use hallsweep_sim::{Camera, Export};

mod figures;

/// The flags of `explore`. Each flag overrides the environment and the settings file.
#[derive(Args, Clone, Debug)]
pub struct Explore {
    /// Name of a built-in hall, or a hall file (.toml, MovingAI .map, ROS .yaml, or the .txt map of old clients).
    #[arg(long, value_name = "HALL")]
    hall: Option<String>,
    /// Start cell of the robot: column and row, counted from 0 in the north-west corner.
    #[arg(long, value_name = "COLUMN,ROW", allow_hyphen_values = true)]
    start: Option<String>,
    #[command(flatten)]
    search: super::Search,
    /// Seed of all random numbers: the same number gives the same run.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    seed: Option<String>,
    /// Settings file that overrides the defaults.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// How each piece of luggage is judged.
    #[arg(long, value_enum, default_value_t)]
    verdicts: Answers,
    /// Print one JSON object instead of the map and the figures.
    #[arg(long)]
    json: bool,
    /// Write every journal entry to this file, one line per entry.
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Write the explored map to this file, whose name ends in .toml, .map, .yaml (adds a .pgm file) or .txt.
    #[arg(long, value_name = "FILE")]
    map: Option<String>,
    /// Overwrite an existing map.
    #[arg(long, requires = "map")]
    force: bool,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Answers {
    /// Judge the luggage as the hall file says.
    #[default]
    Hall,
    /// Judge every piece as safe.
    AllSafe,
}

pub fn run(flags: &Explore) -> Result<(), Failure> {
    let mut settings = super::settings(&flags.sources())?;
    // One simulated operator judges by the hall file, and answers no questions.
    settings.hall.core.rules = Rules { safe_by: SafeBy::One, hot: HotRule::Optional, ..settings.hall.core.rules };
    let hall = sim::hall(&settings.hall).map_err(|unusable| AppError::from(Unusable::from(unusable)))?;
    distinct(flags.hall.as_deref().map(Path::new), flags.map.as_deref().map(Path::new).into_iter().chain(flags.log.as_deref()))?;
    let map = flags.map.as_deref().map(|path| MapFile::at(path, flags.force)).transpose()?;
    let sim = sim::sim_settings(&settings.hall.robot, Camera::Stub);
    let mut progress = Progress { cells: hall.reachable().len(), percent: 0, is_shown: io::stderr().is_terminal() };
    let mut log = flags.log.as_deref().map(Log::create).transpose()?;
    let watch = |state: &Snapshot, entries: &[Entry]| {
        progress.show(state.mission.progress.visited);
        if let Some(log) = &mut log {
            log.write(entries);
        }
    };
    let figures =
        headless::explore_and_tell(&hall, sim, settings.hall.core, settings.hall.strategy, flags.verdicts.into(), watch);
    progress.clear();
    if let Some(Log { path, file }) = log {
        file.and_then(|mut file| file.flush()).map_err(|error| unwritable(path, &error))?;
    }
    let text = if flags.json {
        figures::json(&figures)
    } else {
        format!("{}\n{}", map_text::lines(&*figures.state), figures::table(&figures))
    };
    super::print(&text)?;
    if let Some(map) = map {
        let line = map.write(&Export::explored(hall.name(), hall.cell_m(), &figures.state))?;
        // With `--json`, standard output must have one JSON object and nothing else.
        if flags.json { telemetry::say(line) } else { super::print(&line)? }
    }
    figures.stuck.map_or(Ok(()), |why| Err(Failure::Run(format!("the mission could not end: {why}"))))
}

impl Explore {
    fn sources(&self) -> Sources {
        let given = [("--hall", &self.hall), ("--start", &self.start), ("--seed", &self.seed)];
        let flags =
            given.into_iter().chain(self.search.flags()).filter_map(|(flag, value)| Some(Flag::given(flag, value.clone()?)));
        // The run stores nothing, so that a user without a home directory can run it too.
        let nothing = Flag { flag: "of explore", key: "store.folder", value: "none".to_owned() };
        config::sources(self.config.clone(), flags.chain([nothing]).collect())
    }
}

impl From<Answers> for Verdicts {
    fn from(answers: Answers) -> Verdicts {
        match answers {
            Answers::Hall => Verdicts::Hall,
            Answers::AllSafe => Verdicts::AllSafe,
        }
    }
}

/// The progress line on standard error, shown only in a terminal.
struct Progress {
    cells: usize,
    /// The percentage in the line. The line is written again only when the percentage changes, so that a terminal
    /// does not slow the mission.
    percent: usize,
    is_shown: bool,
}

impl Progress {
    fn show(&mut self, visited: usize) {
        let percent = visited * 100 / self.cells.max(1);
        if self.is_shown && percent != self.percent {
            self.percent = percent;
            // The mission goes on even if this line cannot be shown.
            let _ = write!(io::stderr(), "\rexploring: {visited} of {} cells", self.cells);
        }
    }

    fn clear(&self) {
        if self.is_shown {
            let _ = write!(io::stderr(), "\r\x1b[K");
        }
    }
}

struct Log<'a> {
    path: &'a Path,
    /// The open file, or the error of the first failed write.
    file: io::Result<BufWriter<File>>,
}

impl<'a> Log<'a> {
    fn create(path: &'a Path) -> Result<Log<'a>, Failure> {
        match File::create(path) {
            Ok(file) => Ok(Log { path, file: Ok(BufWriter::new(file)) }),
            Err(error) => Err(unwritable(path, &error)),
        }
    }

    fn write(&mut self, entries: &[Entry]) {
        let Ok(file) = &mut self.file else { return };
        let written = entries.iter().try_for_each(|entry| writeln!(file, "{}", journal_words::line(entry)));
        if let Err(error) = written {
            self.file = Err(error);
        }
    }
}

fn unwritable(path: &Path, error: &io::Error) -> Failure {
    Failure::Run(format!("the log {} cannot be written: {error}", path.display()))
}
