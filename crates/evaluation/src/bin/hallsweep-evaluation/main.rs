//! `hallsweep-evaluation`: compares search strategies in many halls, and finds weights for the search. The library
//! makes the searches. This program reads flags, prints results and writes files.

mod evaluate;
mod output_file;
mod tune;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Compares search strategies in many halls, and finds weights for the search.
#[derive(Debug, Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Compare search strategies in the same halls: random halls, built-in halls or hall files.
    Evaluate(evaluate::Evaluate),
    /// Find weights for the search by simulating searches of random halls, and write the weights to a file.
    Tune(tune::Tune),
}

#[derive(Debug, thiserror::Error)]
enum Failure {
    /// Flags that contradict each other. The exit code is 2, as for a mistyped flag.
    #[error("{0}")]
    Usage(String),
    /// Any other failure. The exit code is 1.
    #[error("{0}")]
    Run(String),
}

fn main() -> ExitCode {
    let ended = match Cli::parse().task {
        Task::Evaluate(flags) => evaluate::run(&flags),
        Task::Tune(flags) => tune::run(&flags),
    };
    let Err(failure) = ended else { return ExitCode::SUCCESS };
    // If standard error is closed too, the message cannot be shown anywhere.
    let _told = writeln!(io::stderr(), "hallsweep-evaluation: {failure}");
    ExitCode::from(if matches!(failure, Failure::Usage(_)) { 2 } else { 1 })
}

fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let printed = writeln!(out, "{text}").and_then(|()| out.flush());
    printed.map_err(|error| Failure::Run(format!("standard output cannot be written: {error}")))
}
