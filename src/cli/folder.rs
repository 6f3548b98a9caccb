//! Which data folder a command is about that works on what is kept: by a flag, or by the settings the program was started with.

use std::path::PathBuf;

use clap::Args;

use crate::config::{self, Flag, Sources};

/// The flags that name a data folder.
#[derive(Args, Clone, Debug)]
pub(super) struct Folder {
    /// The data folder.
    #[arg(long, value_name = "DIR", global = true)]
    data: Option<String>,
    /// A settings file, laid over the defaults.
    #[arg(long, value_name = "FILE", global = true)]
    config: Option<PathBuf>,
}

impl Folder {
    /// Where the settings are to be read, with one more flag if there is one.
    pub(super) fn sources(&self, more: Option<Flag>) -> Sources {
        let data = self.data.clone().map(|value| Flag::given("--data", value));
        config::sources(self.config.clone(), data.into_iter().chain(more).collect())
    }
}
