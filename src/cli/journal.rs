//! `hallsweep journal`: what is on record, for people and for programs, beside a running hallsweep or without one.
//! How it is kept stands in `crate::storage::sqlite`.

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{Failure, Folder};
use crate::api::journal::{self, Line};
use crate::api::journal_words;
use crate::runtime::archive::Unreadable;
use crate::storage::sqlite::{self, Findings, Reading};
use hallsweep_core::units::{MissionId, Seq};

/// What to do with the journal.
#[derive(Args, Clone, Debug)]
pub struct Journal {
    #[command(subcommand)]
    what: Option<What>,
    #[command(flatten)]
    folder: Folder,
}

#[derive(Clone, Debug, Subcommand)]
enum What {
    /// Print the entries, a line each (the default).
    Print(Which),
    /// Print the entries as JSON, an object a line; all that is in the journal is in them, but for the pixels of photos.
    Export(Which),
    /// Check the file, the entries, the tables and the photos: exit code 0 when all is well, 1 if not.
    Check {
        /// Hold this report against the journal as well.
        #[arg(long, value_name = "FILE")]
        report: Option<PathBuf>,
    },
    /// Make the tables that follow from the entries anew. No hallsweep may be running in the folder.
    Rebuild,
}

/// Which entries are meant.
#[derive(Args, Clone, Copy, Debug, Default)]
struct Which {
    /// Only those of this mission.
    #[arg(long, value_name = "NUMBER")]
    mission: Option<u64>,
    /// Only the last ones, so many.
    #[arg(long, value_name = "COUNT")]
    last: Option<u64>,
}

pub fn run(asked: &Journal) -> Result<(), Failure> {
    let folder = folder(&asked.folder)?;
    if matches!(asked.what, Some(What::Rebuild)) {
        let entries = sqlite::rebuild(&folder)?;
        return super::print(&format!("the tables are made anew, from the {entries} entries that they follow from"));
    }
    let reading = Reading::open(&folder)?;
    match asked.what.clone().unwrap_or(What::Print(Which::default())) {
        What::Print(which) => list(&reading, which, for_people, |seq, why| format!("{seq:>8}    - {why}")),
        What::Export(which) => list(&reading, which, journal::line, journal::unreadable),
        What::Check { report } => {
            tell(&reading.check()?)?;
            report.map_or(Ok(()), |report| super::report::confirm(&reading, &report))
        }
        What::Rebuild => Ok(()),
    }
}

/// The journal in the folder that is meant.
pub(super) fn open(asked: &Folder) -> Result<Reading, Failure> {
    Ok(Reading::open(&folder(asked)?)?)
}

fn folder(asked: &Folder) -> Result<PathBuf, Failure> {
    let folder = super::settings(&asked.sources(None))?.store;
    folder.ok_or_else(|| {
        Failure::Run("the setting store.folder says none, so nothing is kept: name a folder with --data".to_owned())
    })
}

impl From<Unreadable> for Failure {
    fn from(Unreadable(words): Unreadable) -> Failure {
        Failure::Run(words)
    }
}

/// Writes the entries, in their place those that could not be understood, and says at the end how many these are.
fn list(
    reading: &Reading,
    which: Which,
    write: impl Fn(&Line) -> String,
    unreadable: impl Fn(Seq, &str) -> String,
) -> Result<(), Failure> {
    let mut out = BufWriter::new(io::stdout().lock());
    let (mut written, mut unclear) = (Ok(()), 0_u64);
    reading.lines(which.mission.map(MissionId), which.last, |seq, line| {
        unclear += u64::from(line.is_err());
        let text = line.map_or_else(|why| unreadable(seq, &why), |line| write(&line));
        written = writeln!(out, "{text}");
        written.is_ok()
    })?;
    match written.and_then(|()| out.flush()) {
        // Whoever reads the first lines only, as `head` does, has what was wanted.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(()),
        written => written.map_err(|error| Failure::Run(format!("standard output cannot be written: {error}")))?,
    }
    if unclear == 0 {
        return Ok(());
    }
    Err(Failure::Run(format!("entries that cannot be understood: {unclear}; each stands in its place, with the reason")))
}

fn for_people(line: &Line) -> String {
    let mission = line.mission.map_or_else(|| "-".to_owned(), |mission| mission.to_string());
    format!("{:>8} {mission:>4} {}", line.seq, journal_words::line(&line.entry))
}

fn tell(findings: &Findings) -> Result<(), Failure> {
    for words in findings.faults.iter().chain(&findings.notes) {
        super::print(words)?;
    }
    let looked_at = format!("{} entries and {} photos were looked at", findings.entries, findings.photos);
    if findings.faults.is_empty() {
        return super::print(&format!("{looked_at}: all is well"));
    }
    Err(Failure::Run(format!("{looked_at}: faults found: {}", findings.count)))
}
