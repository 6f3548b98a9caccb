//! Why the program ends with an error, and its exit code.

use std::process::ExitCode;

use crate::access::AccessError;
use crate::app::AppError;
use crate::config::SettingsError;

/// `Display` is the message for the person who started the program.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The settings cannot be used: exit code 2, as for a mistyped flag.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The program could not start or could not continue. Exit code 2 when the cause is the hall, the scene file, the
    /// TLS files, the access to the data folder, the keys of the judges or an exercise; otherwise 1.
    #[error(transparent)]
    App(#[from] AppError),
    /// The keys cannot be read, stored or changed: exit code 1.
    #[error(transparent)]
    Access(#[from] AccessError),
    /// The flags do not fit together: exit code 2.
    #[error("{0}")]
    Usage(String),
    /// The command failed: exit code 1.
    #[error("{0}")]
    Run(String),
    /// A behaviour tree did not reach SUCCESS. The number is the exit code, which tells the tree's result.
    #[error("{0}")]
    Tree(String, u8),
}

impl Failure {
    /// 2 if the command cannot be used as it was given, 1 if it failed later. A behaviour tree has its own exit
    /// codes.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Failure::Settings(_)
            | Failure::Usage(_)
            | Failure::App(
                AppError::Unusable(_)
                | AppError::Tls(_)
                | AppError::ClosedFolder(_)
                | AppError::NoKeysForJudges(..)
                | AppError::TooFewJudges(_)
                | AppError::TooFewJudgesOfHall(..)
                | AppError::MissionNoExercise(..)
                | AppError::MissionExercise(..)
                | AppError::ExerciseLost(..),
            ) => ExitCode::from(2),
            Failure::Tree(_, code) => ExitCode::from(*code),
            Failure::App(_) | Failure::Access(_) | Failure::Run(_) => ExitCode::from(1),
        }
    }
}
