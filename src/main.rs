//! The program: arguments → task → exit code. Each task loads the settings, the log and the app that it needs.

use std::process::ExitCode;

use clap::Parser;
use hallsweep::cli::{
    Cli, Failure, Subcommands, end, explore, export, hall, healthcheck, journal, pallet, print_table, report, robot_emulator,
    roomba, serve, token, tree,
};

fn main() -> ExitCode {
    end(run(Cli::parse().task()))
}

fn run(task: Subcommands) -> Result<(), Failure> {
    match task {
        Subcommands::Serve(flags) => serve::run(&flags),
        Subcommands::Explore(flags) => explore::run(&flags),
        Subcommands::Hall(asked) => hall::run(&asked),
        Subcommands::Pallet(flags) => pallet::run(&flags),
        Subcommands::Healthcheck(flags) => flags.address().and_then(healthcheck::run),
        Subcommands::Journal(asked) => journal::run(&asked),
        Subcommands::Report(asked) => report::run(&asked),
        Subcommands::Export(asked) => export::run(&asked),
        Subcommands::Token(asked) => token::run(&asked),
        Subcommands::Tree(asked) => tree::run(&asked),
        Subcommands::RobotEmulator(flags) => robot_emulator::run(&flags),
        Subcommands::Roomba(flags) => roomba::run(&flags),
        Subcommands::Evaluate(asked) => asked.refuse("evaluate"),
        Subcommands::Tune(asked) => asked.refuse("tune"),
        Subcommands::Table => print_table(),
    }
}
