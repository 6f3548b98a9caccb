//! `hallsweep report`: what is on record of a mission, for paper, for whoever was not there and for programs; and whether a report that was handed
//! over and the journal agree. What stands in it is `crate::report`'s business.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Cursor, Read, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::output_file::{OutputFile, distinct, unwritable};
use super::{Failure, Folder};
use crate::phrases::Language;
use crate::report::{self, Claim, Comparison, EDITION, Report, list};
use crate::runtime::archive::Archive;
use crate::storage::sqlite::{self, Reading};
use hallsweep_core::units::{MissionId, Seq};

/// Which report, and where it goes.
#[derive(Args, Clone, Debug)]
pub struct Reported {
    /// The number of the mission.
    #[arg(value_name = "MISSION")]
    mission: u64,
    /// Write it to this file instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The page (html), every entry as JSON, a line each (jsonl), or as a table of words for spreadsheets (csv).
    #[arg(long, value_name = "FORMAT", default_value = "html")]
    format: Format,
    /// The language of its words: en, it.
    #[arg(long, value_name = "LANGUAGE", default_value = "en", value_parser = language)]
    language: Language,
    #[command(flatten)]
    folder: Folder,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    Html,
    Jsonl,
    Csv,
}

fn language(tag: &str) -> Result<Language, String> {
    let known = || Language::ALL.map(Language::tag).join(" or ");
    Language::ALL.into_iter().find(|language| language.tag() == tag).ok_or_else(|| format!("{} belongs there", known()))
}

/// Writes it.
pub fn run(asked: &Reported) -> Result<(), Failure> {
    let (archive, lost_after) = super::journal::open(&asked.folder)?.archive()?;
    let mission = MissionId(asked.mission);
    if archive.mission(mission)?.is_none() {
        return Err(Failure::Run(format!(
            "there is no mission {mission} on record: `hallsweep journal` lists what is; one that is in an archive is there with --data ARCHIVE"
        )));
    }
    let until = lost_after.unwrap_or(Seq(u64::MAX));
    let Some(path) = &asked.output else {
        return written(asked, &*archive, until, &mut BufWriter::new(io::stdout().lock()), Path::new("standard output"));
    };
    let data = super::journal::folder(&asked.folder)?;
    distinct([&*data], [&**path])?;
    if sqlite::is_within(&data, path) {
        let words = "would lie among the files of the data folder: name one elsewhere";
        return Err(Failure::Usage(format!("{} {words}", path.display())));
    }
    OutputFile::open(path)?.fill(|file| written(asked, &*archive, until, &mut BufWriter::new(file), path))
}

fn written(asked: &Reported, archive: &dyn Archive, until: Seq, out: &mut dyn Write, path: &Path) -> Result<(), Failure> {
    let mission = MissionId(asked.mission);
    let written = match asked.format {
        Format::Jsonl => list::write_lines(archive, mission, out),
        Format::Csv => list::write_table(archive, mission, asked.language, out),
        Format::Html => match Report::new(archive, mission, until, asked.language)? {
            Some(report) => report.write(out),
            None => return Err(Failure::Run(format!("nothing is on record of mission {mission}"))),
        },
    };
    match written.and_then(|()| out.flush().map_err(report::Failure::from)) {
        Ok(()) => Ok(()),
        Err(report::Failure::Unwritable(error)) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        Err(report::Failure::Unwritable(error)) => Err(unwritable(path, &error)),
        Err(report::Failure::Unreadable(unreadable)) => Err(unreadable.into()),
    }
}

/// Says whether a report and the journal agree, which has been found sound.
pub(super) fn confirm(journal: &Reading, path: &Path) -> Result<(), Failure> {
    let shown = path.display();
    let unreadable = |error: io::Error| Failure::Run(format!("{shown} cannot be read: {error}"));
    let mut file = BufReader::new(File::open(path).map_err(unreadable)?);
    let mut beginning = Vec::new();
    file.by_ref().take(Claim::WITHIN as u64).read_to_end(&mut beginning).map_err(unreadable)?;
    let refused = |why: &dyn std::fmt::Display| Failure::Run(format!("{shown} is not confirmed: {why}"));
    let claim = Claim::read(&beginning).map_err(|why| refused(&why))?;
    if claim.edition != EDITION {
        return Err(refused(&format!("it is of edition {}, which this hallsweep does not know: ask a newer one", claim.edition)));
    }
    let (archive, _) = journal.archive()?;
    let Some(report) = Report::again(&*archive, claim)? else {
        let Claim { mission, until, .. } = claim;
        return Err(refused(&format!("the journal holds no mission {mission} up to entry {until}, or is another one")));
    };
    let mut comparison = Comparison::new(Cursor::new(beginning).chain(file));
    report.write(&mut comparison).map_err(|failure| refused(&failure))?;
    comparison.finish().map_err(unreadable)?.map_err(|difference| refused(&difference))?;
    let digest = report.head().map(|head| head.hex()).unwrap_or_default();
    let Claim { mission, until, .. } = claim;
    super::print(&format!(
        "{shown} is confirmed: it is what the journal has of mission {mission} up to entry {until}, head {digest}"
    ))
}
