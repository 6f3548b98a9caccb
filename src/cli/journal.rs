//! `hallsweep journal`: the record for people and for programs, with or without a running hallsweep. Storage is in
//! `crate::storage::sqlite`.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::{Failure, Folder};
use crate::api::journal::{self, Line};
use crate::api::journal_words;
use crate::api::time::midnight;
use crate::runtime::archive::Unreadable;
use crate::runtime::clock::Clock;
use crate::storage::sqlite::{self, ArchiveCheck, Archived, Findings, ReadOnlyJournal};
use hallsweep_core::units::{MissionId, Seq, WallTime};

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
        /// Hold this archive against the journal as well; may be given several times.
        #[arg(long, value_name = "FILE")]
        archive: Vec<PathBuf>,
    },
    /// Write the missions that were put away before a day into an archive, check it, and take them out of the journal. No hallsweep may be running in
    /// the folder.
    Archive {
        /// The day, as 2026-01-01, at the beginning of which a mission had been put away.
        #[arg(long, value_name = "DATE", value_parser = day)]
        before: WallTime,
        /// The file to be written, which must not be there yet, but for a whole one of a run that was killed.
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
    },
    /// Make a data folder of an archive, which can then be served: name the folder with --data.
    Unpack {
        /// The archive.
        #[arg(value_name = "FILE")]
        archive: PathBuf,
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
    let folder = asked.folder.path()?;
    if matches!(asked.what, Some(What::Rebuild)) {
        let entries = sqlite::rebuild(&folder)?;
        return super::print(&format!("the tables are made anew, from the {entries} entries that they follow from"));
    }
    if let Some(What::Archive { before, output }) = &asked.what {
        return write_out(&folder, *before, output);
    }
    if let Some(What::Unpack { archive }) = &asked.what {
        let entries = sqlite::unpack(archive, &folder, Clock::default().now().wall)?;
        return super::print(&format!("{} has {entries} entries: `hallsweep serve --data` shows them", folder.display()));
    }
    let reading = ReadOnlyJournal::open(&folder)?;
    match asked.what.clone().unwrap_or(What::Print(Which::default())) {
        What::Print(which) => {
            let write = |line: &Line| {
                let mission = line.mission.map_or_else(|| "-".to_owned(), |mission| mission.to_string());
                format!("{:>8} {mission:>4} {}", line.seq, journal_words::line(&line.entry))
            };
            list(&reading, which, write, |seq, why| format!("{seq:>8}    - {why}"))
        }
        What::Export(which) => list(&reading, which, journal::line, journal::unreadable),
        What::Check { report, archive } => {
            tell(&reading.check()?)?;
            if !archive.is_empty() {
                hold_together(&reading, &archive)?;
            }
            report.map_or(Ok(()), |report| super::report::confirm(&reading, &report))
        }
        What::Rebuild | What::Archive { .. } | What::Unpack { .. } => Ok(()),
    }
}

impl From<Unreadable> for Failure {
    fn from(Unreadable(words): Unreadable) -> Failure {
        Failure::Run(words)
    }
}

/// Writes the entries, with a line in place of each that cannot be read, and reports the number of such lines at the end.
fn list(
    reading: &ReadOnlyJournal,
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
        // A reader that takes only the first lines, such as `head`, has read all it needs.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(()),
        written => written.map_err(|error| Failure::Run(format!("standard output cannot be written: {error}")))?,
    }
    if unclear == 0 {
        return Ok(());
    }
    Err(Failure::Run(format!("entries that cannot be understood: {unclear}; each stands in its place, with the reason")))
}

fn day(text: &str) -> Result<WallTime, String> {
    midnight(text).ok_or_else(|| "a day belongs there, as 2026-01-31".to_owned())
}

fn write_out(folder: &Path, before: WallTime, file: &Path) -> Result<(), Failure> {
    // Fails where there is no journal, so that none is created.
    drop(ReadOnlyJournal::open(folder)?);
    let now = Clock::default().now().wall;
    let Some(archived) = sqlite::write_out(folder, before, now, file)? else {
        return Err(Failure::Run("no mission was put away before that day: nothing is changed".to_owned()));
    };
    let Archived { what, last, photos, .. } = archived;
    let (first, latest) = what.missions;
    super::print(&format!(
        "missions {first} to {latest}, {photos} photos and the entries up to {}, are in {} and were read again; the journal begins with entry {} now\n\
         head {} · file SHA-256 {}",
        last.seq,
        file.display(),
        what.until.next(),
        last.hex(),
        what.digest
    ))
}

/// Whether the archives and the journal follow each other, and whether both are unchanged since they were written.
fn hold_together(reading: &ReadOnlyJournal, archives: &[PathBuf]) -> Result<(), Failure> {
    let ArchiveCheck { archives, faults } = reading.check_archives(archives)?;
    faults.iter().try_for_each(|fault| super::print(fault))?;
    let looked_at = format!("archives that were held against the journal: {archives}");
    if faults.is_empty() {
        return super::print(&format!("{looked_at}: all is well"));
    }
    Err(Failure::Run(format!("{looked_at}; faults found: {}", faults.len())))
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
