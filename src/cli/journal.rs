//! `hallsweep journal`: commands that print, export, check and archive the journal. Some of them also work while
//! hallsweep runs. The journal is stored by `crate::storage::sqlite`.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::{Failure, Folder};
use crate::api::journal::{self, Line};
use crate::api::journal_words;
use crate::api::time::{midnight, rfc3339};
use crate::report::receipt::Receipt;
use crate::runtime::archive::Unreadable;
use crate::runtime::clock::Clock;
use crate::storage::sqlite::{self, ArchiveCheck, Archived, Findings, ReadOnlyJournal};
use hallsweep_core::units::{MissionId, Seq, WallTime};

/// The subcommands of `hallsweep journal`, and the folder that they use.
#[derive(Args, Clone, Debug)]
pub struct Journal {
    #[command(subcommand)]
    what: Option<What>,
    #[command(flatten)]
    folder: Folder,
}

#[derive(Clone, Debug, Subcommand)]
enum What {
    /// Print the entries, one per line (the default).
    Print(Which),
    /// Print the entries as JSON, one object per line, with everything in the journal except the pixels of photos.
    Export(Which),
    /// Check the file, the entries, the tables and the photos: exit code 0 without faults, 1 with faults.
    Check {
        /// Also compare this report with the journal.
        #[arg(long, value_name = "FILE")]
        report: Option<PathBuf>,
        /// Also compare this archive with the journal; may be given several times.
        #[arg(long, value_name = "FILE")]
        archive: Vec<PathBuf>,
        /// Also confirm this receipt for a hand-over, by its code, such as 2-1041-9f86d081884c7d65; may be given several
        /// times. The archives of --archive are searched, too.
        #[arg(long, value_name = "CODE", value_parser = receipt_code)]
        receipt: Vec<(String, MissionId, Seq)>,
    },
    /// Move old missions to an archive, and check the archive. Old missions are those that were put away (by RESET or
    /// the next START) before a given day. No hallsweep may be using the data folder.
    Archive {
        /// The day, such as 2026-01-01: missions that were put away before its beginning are moved.
        #[arg(long, value_name = "DATE", value_parser = day)]
        before: WallTime,
        /// The archive file to write; it must not exist, except as the complete file of a run that was killed.
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
    },
    /// Make a data folder from an archive, for `hallsweep serve`: name the folder with --data.
    Unpack {
        /// The archive.
        #[arg(value_name = "FILE")]
        archive: PathBuf,
    },
    /// Rebuild the tables of the journal from its entries. No hallsweep may be using the data folder.
    Rebuild,
}

/// Selects entries of the journal.
#[derive(Args, Clone, Copy, Debug, Default)]
struct Which {
    /// Only the entries of this mission.
    #[arg(long, value_name = "NUMBER")]
    mission: Option<u64>,
    /// Only this number of last entries.
    #[arg(long, value_name = "COUNT")]
    last: Option<u64>,
}

pub fn run(asked: &Journal) -> Result<(), Failure> {
    let folder = asked.folder.path()?;
    if matches!(asked.what, Some(What::Rebuild)) {
        let entries = sqlite::rebuild(&folder)?;
        return super::print(&format!("the tables were rebuilt from {entries} entries"));
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
        What::Check { report, archive, receipt } => {
            // A digest says nothing while the entries under it do not agree with it, so a fault ends the check.
            tell(&reading.check()?)?;
            if !archive.is_empty() {
                hold_together(&reading, &archive)?;
            }
            receipt.iter().try_for_each(|code| confirm_receipt(&reading, &archive, code))?;
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

/// Writes the entries. A line with the reason replaces each entry that cannot be read. In this case the command fails
/// at the end, with the number of these entries.
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
        // A reader such as `head` takes only the first lines and then closes the pipe. This is no error.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(()),
        written => written.map_err(|error| Failure::Run(format!("standard output cannot be written: {error}")))?,
    }
    if unclear == 0 {
        return Ok(());
    }
    Err(Failure::Run(format!("entries that cannot be understood: {unclear}; the reason is printed in place of each")))
}

fn day(text: &str) -> Result<WallTime, String> {
    midnight(text).ok_or_else(|| "write a day, such as 2026-01-31".to_owned())
}

fn write_out(folder: &Path, before: WallTime, file: &Path) -> Result<(), Failure> {
    // Fails if there is no journal, so that archiving does not create one.
    drop(ReadOnlyJournal::open(folder)?);
    let now = Clock::default().now().wall;
    let Some(archived) = sqlite::write_out(folder, before, now, file)? else {
        return Err(Failure::Run("no mission was put away before that day: nothing was changed".to_owned()));
    };
    let Archived { what, last, photos, .. } = archived;
    let (first, latest) = what.missions;
    super::print(&format!(
        "missions {first} to {latest}, {photos} photos and the entries up to {}, were moved to {} and verified; the journal now \
         begins with entry {}\n\
         head {} · file SHA-256 {}",
        last.seq,
        file.display(),
        what.until.next(),
        last.hex(),
        what.digest
    ))
}

/// Checks that each archive or the journal continues the archive before it, and that no archive was changed.
fn hold_together(reading: &ReadOnlyJournal, archives: &[PathBuf]) -> Result<(), Failure> {
    let ArchiveCheck { archives, faults } = reading.check_archives(archives)?;
    faults.iter().try_for_each(|fault| super::print(fault))?;
    let looked_at = format!("archives compared with the journal: {archives}");
    if faults.is_empty() {
        return super::print(&format!("{looked_at}: all is well"));
    }
    Err(Failure::Run(format!("{looked_at}; faults found: {}", faults.len())))
}

/// Reads the code of a receipt, with its mission and its entry.
fn receipt_code(text: &str) -> Result<(String, MissionId, Seq), String> {
    let wrong = || "write mission, entry and 16 digits, as on the receipt, such as 2-1041-9f86d081884c7d65".to_owned();
    let code = text.trim().to_ascii_lowercase();
    let (mission, seq) = Receipt::parse_code(&code).ok_or_else(wrong)?;
    Ok((code, mission, seq))
}

/// Looks for the hand-over in the journal, and in the given archives.
fn confirm_receipt(
    journal: &ReadOnlyJournal,
    archives: &[PathBuf],
    (code, mission, seq): &(String, MissionId, Seq),
) -> Result<(), Failure> {
    let (mission, seq) = (*mission, *seq);
    let refused = |why: String| Failure::Run(format!("the receipt {code} is not confirmed: {why}"));
    let mut receipt = Receipt::of(&*journal.archive(), mission, seq)?;
    for file in archives {
        if receipt.is_none() {
            receipt = Receipt::of(&*ReadOnlyJournal::open(file)?.archive(), mission, seq)?;
        }
    }
    let Some(Receipt { wall, who, to, note, code: own }) = receipt else {
        let lost_after = journal.archive().lost_after()?.filter(|kept| seq > *kept);
        return Err(refused(match (lost_after, journal.archive_with(mission)?) {
            (Some(kept), _) => format!("the entries after {kept} were reported as lost, and the next start withdraws them"),
            (None, Some((file, digest))) => format!(
                "mission {mission} is in the archive {file} (SHA-256 {digest}) and no longer in the journal: add --archive with \
                 its path"
            ),
            (None, None) => format!(
                "entry {seq} is no hand-over of mission {mission}: the code may be copied wrongly, or this may be the wrong journal"
            ),
        }));
    };
    if own.as_ref() != Some(code) {
        let why =
            "the digest differs: the code is not copied rightly, this is another journal, or it was changed after the hand-over";
        return Err(refused(format!("entry {seq} is a hand-over, but {why}")));
    }
    let mut first = seq;
    journal.lines(None, None, |oldest, _| {
        first = oldest;
        false
    })?;
    let compared = match first {
        Seq(1) => format!("entries 1 to {seq} are as they were then"),
        _ => format!("the entries up to {seq} that are here are as they were then; --archive compares those before {first}"),
    };
    let note = note.map(|note| format!("\n  note: {note}")).unwrap_or_default();
    super::print(&format!(
        "the receipt {code} is confirmed: {compared}\n  mission {mission}, handed over at {}\n  by: {who}\n  to: {to}{note}",
        rfc3339(wall)
    ))
}

fn tell(findings: &Findings) -> Result<(), Failure> {
    for words in findings.faults.iter().chain(&findings.notes) {
        super::print(words)?;
    }
    let looked_at = format!("{} entries and {} photos were checked", findings.entries, findings.photos);
    if findings.faults.is_empty() {
        return super::print(&format!("{looked_at}: all is well"));
    }
    Err(Failure::Run(format!("{looked_at}: faults found: {}", findings.count)))
}
