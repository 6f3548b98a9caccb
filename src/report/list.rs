//! The record of a mission as a list. In JSON, each entry is a line in the form of the journal's export. In CSV, for
//! spreadsheets, each entry is a row of words.

use std::io::Write;

use super::{BATCH, Failure, end, first, in_batches, still_there};
use crate::api::journal;
use crate::api::time::rfc3339;
use crate::phrases::Language;
use crate::runtime::archive::{Archive, Span, Unreadable};
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{MissionId, Seq};

const COLUMNS: [&str; 8] = ["entry", "time", "kind", "what", "who", "from", "door", "outcome"];

/// If a cell begins with one of these characters, a spreadsheet treats the cell as a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

pub fn write_lines(archive: &dyn Archive, mission: MissionId, out: &mut dyn Write) -> Result<(), Failure> {
    write_lines_until(archive, mission, end(archive)?, out)
}

pub(super) fn write_lines_until(
    archive: &dyn Archive,
    mission: MissionId,
    until: Seq,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let began = first(archive, mission)?;
    let batch = |after| archive.lines(mission, Span { after, until }, BATCH);
    in_batches(batch, |_, line| Ok(out.write_all(line.as_bytes()).and_then(|()| out.write_all(b"\n"))?))?;
    still_there(archive, mission, began)
}

/// Writes every entry as a row of a table, in the words of a language. The names of columns and kinds are the same in
/// all languages.
pub fn write_table(archive: &dyn Archive, mission: MissionId, language: Language, out: &mut dyn Write) -> Result<(), Failure> {
    let (until, began) = (end(archive)?, first(archive, mission)?);
    let mut table = csv::WriterBuilder::new().terminator(csv::Terminator::CRLF).from_writer(out);
    table.write_record(COLUMNS).map_err(io_error)?;
    let batch = |after| archive.entries(mission, Span { after, until }, BATCH);
    in_batches(batch, |seq, entry| table.write_record(row(language, seq, entry.as_ref())).map_err(io_error))?;
    table.flush()?;
    still_there(archive, mission, began)
}

fn row(language: Language, seq: Seq, entry: Result<&Entry, &Unreadable>) -> [String; 8] {
    let none = String::new;
    let cells = match entry {
        Err(Unreadable(why)) => [none(), "unreadable".to_owned(), why.clone(), none(), none(), none(), none()],
        Ok(Entry { wall, fact }) => {
            let (time, kind) = (rfc3339(*wall), journal::kind(fact).to_owned());
            if let Fact::Command { issuer, asked, luggage, refused, .. } = fact {
                let what = language.asked(asked, *luggage);
                let outcome = language.outcome(refused.as_ref());
                [time, kind, what, issuer.who.to_string(), issuer.from.to_string(), issuer.door.0.to_owned(), outcome]
            } else {
                [time, kind, language.fact(fact), who(fact), none(), none(), none()]
            }
        }
    };
    // The apostrophe keeps a spreadsheet from treating the cell as a formula, whoever wrote the text in the cell.
    let [time, kind, what, who, from, door, outcome] =
        cells.map(|cell| if cell.starts_with(FORMULA) { format!("'{cell}") } else { cell });
    [seq.to_string(), time, kind, what, who, from, door, outcome]
}

fn who(fact: &Fact) -> String {
    if let Fact::Verdict { who, .. } | Fact::Unsure { who, .. } | Fact::AlarmAcknowledged(_, who) = fact {
        who.to_string()
    } else if let Fact::Judged(judgement) = fact {
        judgement.issuer.who.to_string()
    } else {
        String::new()
    }
}

fn io_error(error: csv::Error) -> Failure {
    let words = error.to_string();
    Failure::Unwritable(if let csv::ErrorKind::Io(error) = error.into_kind() { error } else { std::io::Error::other(words) })
}
