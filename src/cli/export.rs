//! `hallsweep export`: writes what was recorded for other people. `crate::report::bundle` has the contents.

use std::io::BufWriter;
use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::output_file::OutputFile;
use super::report::{language, opened, outcome};
use super::{Failure, Folder};
use crate::api::time::rfc3339;
use crate::phrases::Language;
use crate::report::bundle;
use crate::telemetry;
use hallsweep_core::units::MissionId;

/// The subcommands of `hallsweep export`.
#[derive(Args, Clone, Debug)]
pub struct Exports {
    #[command(subcommand)]
    what: Exported,
}

#[derive(Clone, Debug, Subcommand)]
enum Exported {
    /// Write a mission for others as one ZIP file: the report, all entries and photos, their digests, and how to check
    /// them without hallsweep.
    Bundle(Bundle),
}

#[derive(Args, Clone, Debug)]
struct Bundle {
    /// The number of the mission.
    #[arg(value_name = "MISSION")]
    mission: u64,
    /// Write the bundle to this file; "-" is standard output.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Language of the report and of the instructions: en, it.
    #[arg(long, value_name = "LANGUAGE", default_value = "en", value_parser = language)]
    language: Language,
    #[command(flatten)]
    folder: Folder,
}

pub fn run(Exports { what: Exported::Bundle(asked) }: &Exports) -> Result<(), Failure> {
    let (mission, path) = (MissionId(asked.mission), &*asked.output);
    let archive = opened(&asked.folder, mission, path)?;
    let mut digest = String::new();
    OutputFile::open(path)?.fill(|file| {
        let written = bundle::write(&*archive, mission, asked.language, &mut BufWriter::new(file));
        outcome(written.map(|of_sums| digest = of_sums), path)
    })?;
    if digest.is_empty() {
        return Ok(()); // The reader of standard output wanted only a part.
    }
    let began = archive.mission(mission)?.map(|record| rfc3339(record.began)).unwrap_or_default();
    let (file, data) = (path.display(), asked.folder.path()?);
    telemetry::say(format_args!(
        "{file} is written: mission {mission} of {}, begun {began}; write down the SHA-256 of its list SHA256SUMS, {digest}",
        data.display()
    ));
    Ok(())
}
