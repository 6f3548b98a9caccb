//! The program: arguments → task → exit code. Each task loads the settings, the log and the app that it needs.

use std::process::ExitCode;

use clap::Parser;
use hallsweep::cli::{
    Cli, Failure, Task, end, explore, hall, healthcheck, journal, pallet, print_table, report, robot_emulator, roomba, serve,
    token, tree,
};

fn main() -> ExitCode {
    end(run(Cli::parse().task()))
}

fn run(task: Task) -> Result<(), Failure> {
    match task {
        Task::Serve(flags) => serve::run(&flags),
        Task::Explore(flags) => explore::run(&flags),
        Task::Hall(asked) => hall::run(&asked),
        Task::Pallet(flags) => pallet::run(&flags),
        Task::Healthcheck(flags) => flags.address().and_then(healthcheck::run),
        Task::Journal(asked) => journal::run(&asked),
        Task::Report(asked) => report::run(&asked),
        Task::Token(asked) => token::run(&asked),
        Task::Tree(asked) => tree::run(&asked),
        Task::RobotEmulator(flags) => robot_emulator::run(&flags),
        Task::Roomba(flags) => roomba::run(&flags),
        Task::Evaluate(asked) => asked.refuse("evaluate"),
        Task::Tune(asked) => asked.refuse("tune"),
        Task::Table => print_table(),
    }
}
