//! `hallsweep explore`: one mission without doors at full speed, and its result. The mission runs in `hallsweep_sim::headless`;
//! this file shows the progress and prints the result.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use super::Failure;
use super::map_file::MapFile;
use super::output_file::distinct;
use crate::api::{journal_words, map_text};
use crate::app::AppError;
use crate::config::{self, Flag, Sources};
use crate::robots::{Unusable, sim};
use crate::telemetry;
use hallsweep_core::effect::Entry;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_sim::headless::{self, Verdicts};
use hallsweep_sim::{Camera, Export};

mod figures;

/// The flags of `explore`; each wins over the environment and the settings file.
#[derive(Args, Clone, Debug)]
pub struct Explore {
    /// The hall: the name of a built-in one, or a file (.toml, MovingAI .map, ROS .yaml, or the text of old clients, .txt).
    #[arg(long, value_name = "HALL")]
    hall: Option<String>,
    /// Where the robot starts: column and row, counted from 0 in the north-west corner.
    #[arg(long, value_name = "COLUMN,ROW", allow_hyphen_values = true)]
    start: Option<String>,
    #[command(flatten)]
    search: super::Search,
    /// Where all chance comes from: the same number gives the same run.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    seed: Option<String>,
    /// A settings file, laid over the defaults.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Who answers at the luggage.
    #[arg(long, value_enum, default_value_t)]
    verdicts: Answers,
    /// Print one JSON object instead of the map and the figures.
    #[arg(long)]
    json: bool,
    /// Write everything that was put on record to this file, a line each.
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Write the map as far as it was explored to this file, which ends in .toml, .map, .yaml (with a .pgm beside it) or .txt.
    #[arg(long, value_name = "FILE")]
    map: Option<String>,
    /// Replace a map that is there.
    #[arg(long, requires = "map")]
    force: bool,
}

/// How the luggage is answered for.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Answers {
    /// Danger for what the hall file says is dangerous, safe for the rest.
    #[default]
    Hall,
    /// Safe for every piece.
    AllSafe,
}

pub fn run(flags: &Explore) -> Result<(), Failure> {
    let settings = super::settings(&flags.sources())?;
    let hall = sim::hall(&settings).map_err(|unusable| AppError::from(Unusable::from(unusable)))?;
    distinct(flags.hall.as_deref().map(Path::new), flags.map.as_deref().map(Path::new).into_iter().chain(flags.log.as_deref()))?;
    let map = flags.map.as_deref().map(|path| MapFile::at(path, flags.force)).transpose()?;
    let sim = sim::sim_settings(&settings.robot, Camera::Stub);
    // The bar is on standard error, and shown only on a terminal.
    let style = ProgressStyle::with_template("exploring {wide_bar} {pos} of {len} cells");
    let style = style.expect("the template is a constant and names only existing fields");
    let bar = ProgressBar::new(hall.reachable().len() as u64).with_style(style);
    let mut log = flags.log.as_deref().map(Log::create).transpose()?;
    let watch = |state: &Snapshot, entries: &[Entry]| {
        bar.set_position(state.mission.progress.visited as u64);
        if let Some(log) = &mut log {
            log.write(entries);
        }
    };
    let figures = headless::explore_and_tell(&hall, sim, settings.core, settings.strategy, flags.verdicts.into(), watch);
    bar.finish_and_clear();
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
        // With `--json` standard output has a single object and nothing else.
        if flags.json { telemetry::say(line) } else { super::print(&line)? }
    }
    figures.stuck.map_or(Ok(()), |why| Err(Failure::Run(format!("the mission could not end: {why}"))))
}

impl Explore {
    fn sources(&self) -> Sources {
        let given = [("--hall", &self.hall), ("--start", &self.start), ("--seed", &self.seed)];
        let flags =
            given.into_iter().chain(self.search.flags()).filter_map(|(flag, value)| Some(Flag::given(flag, value.clone()?)));
        // Nothing is stored, so that a user without a home directory can run it too.
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

struct Log<'a> {
    path: &'a Path,
    /// An error after the first failed write.
    file: std::io::Result<BufWriter<File>>,
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

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Run(format!("the log {} cannot be written: {error}", path.display()))
}
