//! The program: arguments → settings → telemetry → app → exit code.

use std::process::ExitCode;

use clap::Parser;
use hallsweep::cli::{Cli, Failure, Task, healthcheck};
use hallsweep::{config, telemetry};

fn main() -> ExitCode {
    match run(Cli::parse().task()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("hallsweep: {failure}");
            failure.exit_code()
        }
    }
}

fn run(task: Task) -> Result<(), Failure> {
    match task {
        Task::Serve(serve) => {
            let settings = config::load(&serve.sources())?;
            telemetry::start(&settings.log);
            Ok(())
        }
        Task::Healthcheck(check) => healthcheck::run(check.http),
    }
}
