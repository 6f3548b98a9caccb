//! `hallsweep report`: writes the report of a mission, for people and for programs. This file also checks whether a
//! report agrees with the journal. The contents of reports are in `crate::report`.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, ValueEnum};

use super::map_file::unwritable;
use super::output_file::{OutputFile, STANDARD_OUTPUT, distinct, is_standard_output};
use super::{Failure, Folder};
use crate::phrases::Language;
use crate::report::{self, Claim, Comparison, EDITION, Report, list};
use crate::runtime::archive::Archive;
use crate::storage::files;
use crate::storage::sqlite::{self, ReadOnlyJournal};
use hallsweep_core::units::MissionId;

/// The arguments of `hallsweep report`.
#[derive(Args, Clone, Debug)]
pub struct Reported {
    /// The number of the mission.
    #[arg(value_name = "MISSION")]
    mission: u64,
    /// Write the report to this file; "-" is standard output.
    #[arg(short, long, value_name = "FILE", default_value = STANDARD_OUTPUT)]
    output: PathBuf,
    /// Format of the report: a page (html), one JSON object per entry (jsonl), or a table in words for spreadsheets
    /// (csv).
    #[arg(long, value_name = "FORMAT", default_value = "html")]
    format: Format,
    /// Language of the report: en, it.
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

pub(super) fn language(tag: &str) -> Result<Language, String> {
    let known = || Language::ALL.map(Language::tag).join(" or ");
    Language::ALL.into_iter().find(|language| language.tag() == tag).ok_or_else(|| format!("write {}", known()))
}

pub fn run(asked: &Reported) -> Result<(), Failure> {
    let path = &*asked.output;
    let archive = opened(&asked.folder, MissionId(asked.mission), path)?;
    OutputFile::open(path)?.fill(|file| written(asked, &*archive, &mut BufWriter::new(file), path))
}

/// Opens the journal. Fails if it does not have the mission, or if the file must not be written where it would be.
pub(super) fn opened(folder: &Folder, mission: MissionId, path: &Path) -> Result<Arc<dyn Archive>, Failure> {
    let data = folder.path()?;
    let archive = ReadOnlyJournal::open(&data)?.archive();
    if archive.mission(mission)?.is_none() {
        return Err(Failure::Run(format!(
            "there is no mission {mission} in the journal: `hallsweep journal` lists the entries; for a mission in an archive, \
             add --data ARCHIVE"
        )));
    }
    if !is_standard_output(path) {
        distinct([&*data], [path])?;
        if sqlite::is_within(&data, path) {
            let words = "is inside a data folder: choose a file in another folder";
            return Err(Failure::Usage(format!("{} {words}", path.display())));
        }
    }
    Ok(archive)
}

fn written(asked: &Reported, archive: &dyn Archive, out: &mut dyn Write, path: &Path) -> Result<(), Failure> {
    let mission = MissionId(asked.mission);
    let written = match asked.format {
        Format::Jsonl => list::write_lines(archive, mission, out),
        Format::Csv => list::write_table(archive, mission, asked.language, out),
        Format::Html => match Report::new(archive, mission, asked.language)? {
            Some(report) => report.write(out),
            None => return Err(Failure::Run(format!("the journal has no entries of mission {mission}"))),
        },
    };
    outcome(written.and_then(|()| out.flush().map_err(report::Failure::from)), path)
}

/// A reader such as `head` may take only a part of the output. This is no failure.
pub(super) fn outcome(written: Result<(), report::Failure>, path: &Path) -> Result<(), Failure> {
    match written {
        Ok(()) => Ok(()),
        Err(report::Failure::Unwritable(error)) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        Err(report::Failure::Unwritable(error)) => Err(unwritable(path, &error)),
        Err(report::Failure::Unreadable(unreadable)) => Err(unreadable.into()),
    }
}

pub(super) fn confirm(journal: &ReadOnlyJournal, path: &Path) -> Result<(), Failure> {
    let shown = path.display();
    let unreadable = |error: io::Error| Failure::Run(format!("{shown} cannot be read: {error}"));
    // Reading a pipe would block for ever, so a pipe is refused.
    files::check_plain(path).map_err(unreadable)?;
    let mut file = BufReader::new(File::open(path).map_err(unreadable)?);
    let mut beginning = Vec::new();
    file.by_ref().take(Claim::WITHIN as u64).read_to_end(&mut beginning).map_err(unreadable)?;
    let refused = |why: &dyn std::fmt::Display| Failure::Run(format!("{shown} is not confirmed: {why}"));
    let claim = Claim::read(&beginning).map_err(|why| refused(&why))?;
    if !(1..=EDITION).contains(&claim.edition) {
        return Err(refused(&format!(
            "the report has edition {}, which this hallsweep does not know: use a newer hallsweep",
            claim.edition
        )));
    }
    let archive = journal.archive();
    let Some(report) = Report::again(&*archive, claim)? else {
        let Claim { mission, until, .. } = claim;
        let why = match journal.archive_with(mission)? {
            Some((file, digest)) => format!(
                "mission {mission} is in the archive {file} (SHA-256 {digest}) and no longer in the journal; `hallsweep journal \
                 check --data FILE --report {shown}`, with the path of the archive as FILE, compares the report with the archive"
            ),
            None => format!("the journal has no mission {mission} up to entry {until}; this may be the wrong journal"),
        };
        return Err(refused(&why));
    };
    let mut comparison = Comparison::new(Cursor::new(beginning).chain(file));
    report.write(&mut comparison).map_err(|failure| refused(&failure))?;
    comparison.finish().map_err(unreadable)?.map_err(|difference| refused(&difference))?;
    let digest = report.head().map(|head| head.hex()).unwrap_or_default();
    let Claim { mission, until, .. } = claim;
    super::print(&format!(
        "{shown} is confirmed: the report agrees with the journal for mission {mission} up to entry {until}, head {digest}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::storage::tests::scratch::Scratch;
    use hallsweep_core::asked::Asked;
    use hallsweep_core::command::{Command, Door, Issuer, LuggageRef, Strategy, Verdict};
    use hallsweep_core::effect::Page;
    use hallsweep_core::state::fact::{Entry, Fact};
    use hallsweep_core::units::{Cell, LuggageId, Pose, Seq, WallTime};
    use hallsweep_core::world::luggage::{Luggage, PhotoState};

    fn said(verdict: Verdict) -> Fact {
        let (issuer, luggage) = (Issuer::operator(Door("http")), LuggageId(1));
        let asked =
            Asked::Command(Command::Verdict { luggage: LuggageRef::Id(luggage), verdict, note: None, hot: Default::default() });
        Fact::Command { issuer, id: None, asked, epoch: None, luggage: Some(luggage), refused: None }
    }

    fn verdict(verdict: Verdict) -> Fact {
        Fact::Verdict { luggage: LuggageId(1), verdict, who: "anna".into(), note: None, hot: Default::default() }
    }

    fn page_of(report: &Report<'_>) -> String {
        let mut page = Vec::new();
        report.write(&mut page).unwrap();
        String::from_utf8(page).unwrap()
    }

    /// A report names its last entry. Later entries do not change the report when it is made again.
    #[test]
    fn a_report_of_before_a_danger_is_made_again_behind_it_as_it_was() {
        let scratch = Scratch::new();
        let mut opened = sqlite::open(&scratch.0.join("data"), None).unwrap();
        let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
        let mut keep = |first, facts: Vec<Fact>| {
            let entries = facts.into_iter().map(|fact| Entry { wall: WallTime::default(), fact }).collect();
            let page = Page { first: Seq(first), entries, kept_back: None };
            let last = page.last();
            opened.store.record(page, 0);
            runtime.block_on(opened.store.word().wait_for(|word| word.kept >= last)).map(drop).unwrap();
            last.0 + 1
        };
        let record = Luggage {
            id: LuggageId(1),
            cell: Cell::new(0, 1),
            pose: Pose::START,
            taken: WallTime::default(),
            first_taken: WallTime::default(),
            photo: PhotoState::Failed("dark".to_owned()),
            verdict: None,
            seen_from: Vec::new(),
            unsure: Vec::new(),
            judged: Vec::new(),
            truth: None,
            piece: None,
            secured: None,
            clock_set_ms: 0,
        };
        let piece = Fact::Luggage { record: record.into(), photo: None };
        let next =
            keep(1, vec![Fact::MissionBegan(MissionId(1), Strategy::Snail), piece, said(Verdict::Safe), verdict(Verdict::Safe)]);
        let archive = ReadOnlyJournal::open(&scratch.0.join("data")).unwrap().archive();
        let report = || Report::new(&*archive, MissionId(1), Language::English).unwrap().expect("it is there");
        let before = page_of(&report());
        assert!(before.contains("<dt>Commands refused</dt><dd>0</dd>"), "{before}");
        keep(next, vec![said(Verdict::Danger), verdict(Verdict::Danger)]);
        let claim = Claim::read(before.as_bytes()).unwrap();
        let again = Report::again(&*archive, claim).unwrap().expect("the journal holds it");
        assert_eq!(page_of(&again), before);
        let after = page_of(&report());
        assert!(after.contains("<dt>Commands refused</dt><dd>1</dd>"), "{after}");
    }
}
