//! The command line: the commands and flags of `hallsweep`, and the settings that follow from them. The commands are in
//! `crate::app` and in the files beside this one; only the command line writes to standard output.

use std::io::Write;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use crate::config::{self, Flag, Settings, Sources, from_here, sources};
use crate::telemetry;
use hallsweep_core::mission::table_markdown;

pub mod explore;
pub mod export;
mod failure;
pub mod hall;
pub mod healthcheck;
pub mod journal;
mod link;
mod map_file;
mod output_file;
pub mod pallet;
pub mod report;
pub mod robot_emulator;
pub mod roomba;
pub mod serve;
pub mod token;
pub mod tree;

pub use failure::Failure;

/// Search an evacuated hall for dangerous luggage: a robot drives, an operator decides.
#[derive(Debug, Parser)]
#[command(name = "hallsweep", version, args_conflicts_with_subcommands = true)]
#[command(after_help = "Without a command, hallsweep runs `serve`: open the address that hallsweep prints.\n\
    config/default.toml lists every setting with its default; docs/settings.md explains how to change a setting.")]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Subcommands>,
    #[command(flatten)]
    serve: Serve,
}

/// The subcommands of `hallsweep`.
#[derive(Debug, Subcommand)]
pub enum Subcommands {
    /// Run the robot, the console, the API, the CoAP resources and the MQTT topics until SIGINT, SIGTERM or SIGHUP (the default).
    Serve(Serve),
    /// Run one simulated mission at full speed, without network ports, and print the map and the result.
    Explore(explore::Explore),
    /// Prints which command of another program replaces this command.
    #[command(hide = true, disable_help_flag = true)]
    Evaluate(Moved),
    /// Let two mobile manipulators carry parcels from a pallet to a target area, and print the phases and the result.
    Pallet(pallet::Pallet),
    /// Check whether a running hallsweep is healthy: exit code 0 if healthy, 1 if not.
    Healthcheck(Healthcheck),
    /// Convert halls to other formats, and import halls from scene files of the virtual robot's page.
    Hall(hall::Halls),
    /// Show, add, replace and remove the keys with which people and programs sign in.
    Token(token::Keyrings),
    /// Print, check and export the journal, and rebuild its tables.
    Journal(journal::Journal),
    /// Write the report of a mission: one page with the hall, photos, verdicts and all other records, or a list of the
    /// records.
    Report(report::Reported),
    /// Write recorded missions as files for other people, such as the police.
    Export(export::Exports),
    /// Check, format and run behaviour tree files; mocks replace the leaves.
    Tree(tree::Trees),
    /// Simulate the Roomba of the laboratory, as state machine and as behaviour tree, and print the result.
    Roomba(roomba::Roomba),
    /// Simulate a robot that speaks the line protocol, over TCP or a serial device, until SIGINT, SIGTERM or SIGHUP.
    RobotEmulator(robot_emulator::RobotEmulator),
    /// Prints which command of another program replaces this command.
    #[command(hide = true, disable_help_flag = true)]
    Tune(Moved),
    /// Print the table of the mission, phase by phase, as markdown.
    Table,
}

/// The flags of `serve`. Each flag overrides the environment and the settings file.
#[derive(Args, Clone, Debug, Default)]
pub struct Serve {
    /// Name of a built-in hall, or a hall file (.toml, MovingAI .map, ROS .yaml, or the .txt map of old clients).
    /// If given several times, the program has several halls; each has the name of its file, and the first is the default
    /// hall.
    #[arg(long, value_name = "HALL")]
    hall: Vec<String>,
    /// Start cell of the simulated robot: column and row, counted from 0 in the north-west corner; only with one hall.
    #[arg(long, value_name = "COLUMN,ROW", allow_hyphen_values = true)]
    start: Option<String>,
    /// Run an exercise with this many test pieces in the simulated hall, from 1 to 100; only with one hall; see
    /// docs/exercise.md.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    exercise: Option<String>,
    /// Address of the console and the API; port 0 chooses a free port.
    #[arg(long, value_name = "ADDRESS:PORT")]
    http: Option<String>,
    /// Address of the CoAP resources, over UDP; port 0 chooses a free port, "none" turns CoAP off.
    #[arg(long, value_name = "ADDRESS:PORT")]
    coap: Option<String>,
    /// Address of hallsweep's own MQTT broker, over TCP; port 0 chooses a free port, "none" turns the broker off.
    #[arg(long, value_name = "ADDRESS:PORT")]
    mqtt: Option<String>,
    /// Kind of the searching robot (sim, virtual-tcp, virtual-ws or line) and its address, such as line=/dev/ttyUSB0.
    #[arg(long, value_name = "KIND[=ADDRESS]")]
    robot: Option<String>,
    /// Speed of the simulated robot: 1 is normal, 10 is ten times faster, "max" is without waiting.
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true)]
    speed: Option<String>,
    /// Seed of all random numbers in the simulation.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    seed: Option<String>,
    #[command(flatten)]
    search: Search,
    /// Settings file that overrides the defaults.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Folder for all stored data; "none" stores nothing.
    #[arg(long, value_name = "DIR")]
    data: Option<String>,
}

/// The flags that say how to search.
#[derive(Args, Clone, Debug, Default)]
pub struct Search {
    /// The order of the search: auto, scored, frontier, columns, spiral, snail.
    #[arg(long, value_name = "NAME")]
    strategy: Option<String>,
    /// Goal of the search: find (find luggage soon) or cover (cover the whole hall in few moves).
    #[arg(long, value_name = "NAME")]
    goal: Option<String>,
    /// How the robot checks that a cell is free: bump (drive into the cell) or sonar.
    #[arg(long, value_name = "NAME")]
    sensing: Option<String>,
    /// Costs of a step, a turn and a bump, such as 1,1,1; "robot" uses the time that each takes the robot.
    #[arg(long, value_name = "STEP,TURN,BUMP", allow_hyphen_values = true)]
    costs: Option<String>,
}

impl Search {
    fn flags(&self) -> impl Iterator<Item = (&'static str, &Option<String>)> {
        [("--strategy", &self.strategy), ("--goal", &self.goal), ("--sensing", &self.sensing), ("--costs", &self.costs)]
            .into_iter()
    }
}

/// The arguments of a command that was moved to `hallsweep-evaluation`.
#[derive(Args, Clone, Debug)]
pub struct Moved {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    flags: Vec<String>,
}

impl Moved {
    pub fn refuse(self, name: &str) -> Result<(), Failure> {
        let flags: String = self.flags.iter().map(|flag| format!(" {flag}")).collect();
        Err(Failure::Usage(format!(
            "`{name}` is now a command of another program; in the source folder of hallsweep, run:\n\
             cargo run --release -p hallsweep-evaluation -- {name}{flags}"
        )))
    }
}

#[derive(Args, Clone, Debug)]
pub struct Healthcheck {
    /// Address of the running hallsweep; by default the address in its settings, on this machine.
    #[arg(long, value_name = "ADDRESS:PORT")]
    http: Option<String>,
    /// Settings file of the running hallsweep.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Accepted without effect, so that healthcheck can have the same flags as the running hallsweep.
    #[arg(long, value_name = "DIR")]
    data: Option<String>,
}

impl Healthcheck {
    /// Address of the running program, as seen from this machine.
    pub fn address(&self) -> Result<SocketAddr, Failure> {
        let http = self.http.clone().map(|value| Flag::given("--http", value));
        // A health check stores nothing, so that a user without a home directory can run it too.
        let nothing = Flag { flag: "of healthcheck", key: "store.folder", value: "none".to_owned() };
        let settings = config::load(&sources(self.config.clone(), http.into_iter().chain([nothing]).collect()))?;
        Ok(from_here(settings.http.bind.at.first()))
    }
}

impl Cli {
    pub fn task(self) -> Subcommands {
        self.command.unwrap_or(Subcommands::Serve(self.serve))
    }
}

impl Serve {
    pub fn sources(&self) -> Sources {
        sources(self.config.clone(), self.flags())
    }

    fn flags(&self) -> Vec<Flag> {
        let given = [
            ("--start", &self.start),
            ("--exercise", &self.exercise),
            ("--http", &self.http),
            ("--coap", &self.coap),
            ("--mqtt", &self.mqtt),
            ("--speed", &self.speed),
            ("--seed", &self.seed),
            ("--data", &self.data),
        ];
        let given = given.into_iter().chain(self.search.flags());
        let single = given.filter_map(|(flag, value)| Some(Flag::given(flag, value.clone()?)));
        let halls = self.hall.iter().map(|hall| Flag::given("--hall", hall.clone()));
        halls.chain(single).chain(self.robot.as_deref().map(Flag::robot).into_iter().flatten()).collect()
    }
}

/// The flags that name a data folder, for commands that use stored data.
#[derive(Args, Clone, Debug)]
struct Folder {
    /// The data folder.
    #[arg(long, value_name = "DIR", global = true)]
    data: Option<String>,
    /// Settings file that overrides the defaults.
    #[arg(long, value_name = "FILE", global = true)]
    config: Option<PathBuf>,
}

impl Folder {
    fn sources(&self, more: Option<Flag>) -> Sources {
        let data = self.data.clone().map(|value| Flag::given("--data", value));
        sources(self.config.clone(), data.into_iter().chain(more).collect())
    }

    fn path(&self) -> Result<PathBuf, Failure> {
        let folder = settings(&self.sources(None))?.store;
        folder.ok_or_else(|| {
            Failure::Run("the setting store.folder is none, so nothing is stored: name a folder with --data".to_owned())
        })
    }
}

/// Loads the settings of this start, and starts the log. The first lines of the log name settings without effect.
fn settings(sources: &Sources) -> Result<Settings, Failure> {
    let settings = config::load(sources)?;
    telemetry::start(&settings.log);
    telemetry::warn_of_ignored(&sources.ignored());
    Ok(settings)
}

/// `hallsweep table`: prints the mission table of this program as markdown for the documentation.
pub fn print_table() -> Result<(), Failure> {
    print(table_markdown().trim_end())
}

pub fn end(ended: Result<(), Failure>) -> ExitCode {
    let code = ended.map_or_else(
        |failure| {
            telemetry::say(format_args!("hallsweep: {failure}"));
            failure.exit_code()
        },
        |()| ExitCode::SUCCESS,
    );
    telemetry::end();
    code
}

/// Prints the addresses of a program that continues to run. Uses a separate thread, because standard output may be a
/// full pipe that nobody reads.
fn announce(text: String) {
    let printing = std::thread::Builder::new().name("announcement".to_owned()).spawn(move || {
        if let Err(failure) = print(&text) {
            telemetry::warn_of_unannounced(&failure);
        }
    });
    if let Err(error) = printing {
        telemetry::warn_of_unannounced(&error);
    }
}

/// Prints a text and a line break. No other function writes to standard output.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let printed = writeln!(out, "{text}").and_then(|()| out.flush());
    printed.map_err(|error| Failure::Run(format!("standard output cannot be written: {error}")))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    fn flags(arguments: &str) -> Vec<(&'static str, String)> {
        let cli = Cli::try_parse_from(arguments.split_whitespace()).expect("these arguments are good");
        match cli.task() {
            Subcommands::Serve(serve) => serve.flags().into_iter().map(|flag| (flag.key, flag.value)).collect(),
            other @ (Subcommands::Evaluate(_)
            | Subcommands::Explore(_)
            | Subcommands::Export(_)
            | Subcommands::Pallet(_)
            | Subcommands::Hall(_)
            | Subcommands::Healthcheck(_)
            | Subcommands::Journal(_)
            | Subcommands::Report(_)
            | Subcommands::RobotEmulator(_)
            | Subcommands::Roomba(_)
            | Subcommands::Token(_)
            | Subcommands::Tree(_)
            | Subcommands::Tune(_)
            | Subcommands::Table) => {
                panic!("{other:?} is not serve")
            }
        }
    }

    #[test]
    fn the_definition_holds_together() {
        Cli::command().debug_assert();
    }

    #[test]
    fn nothing_said_means_serve() {
        assert_eq!(flags("hallsweep"), []);
        assert_eq!(flags("hallsweep --speed max"), flags("hallsweep serve --speed max"));
    }

    #[test]
    fn every_flag_is_a_setting() {
        let given = flags(
            "hallsweep --hall h --start -1 --exercise -1 --http a --coap c --mqtt m --speed -1 --seed -2 --strategy s --goal g --sensing n --costs -1 --data d --robot line=x",
        );
        assert_eq!(given.len(), 15);
        for (key, _) in given {
            assert!(crate::config::Key::named(key).is_some(), "{key} is no setting");
        }
    }

    #[test]
    fn serve_takes_several_halls_and_explore_takes_one() {
        let halls = flags("hallsweep serve --hall a.toml --seed 1 --hall b.yaml");
        assert_eq!(halls[..2], [("hall.file", "a.toml".to_owned()), ("hall.file", "b.yaml".to_owned())]);
        let two = ["hallsweep", "explore", "--hall", "a", "--hall", "b"];
        assert_eq!(Cli::try_parse_from(two).expect_err("one hall").kind(), clap::error::ErrorKind::ArgumentConflict);
    }

    #[test]
    fn only_serve_takes_another_robot() {
        for arguments in ["hallsweep explore --robot sim", "hallsweep pallet --robot sim"] {
            let refused = Cli::try_parse_from(arguments.split_whitespace()).expect_err(arguments);
            assert_eq!(refused.kind(), clap::error::ErrorKind::UnknownArgument, "{arguments}");
        }
    }

    #[test]
    fn every_flag_of_the_table_of_settings_is_one_of_serve() {
        let command = Cli::command();
        let serve: Vec<String> = command.get_arguments().filter_map(|flag| Some(format!("--{}", flag.get_long()?))).collect();
        for flag in crate::config::KEYS.iter().filter_map(|key| key.flag) {
            assert!(serve.iter().any(|known| known == flag), "{flag}");
        }
    }
}
