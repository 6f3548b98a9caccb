//! The one list of commands in JSON: what each is called, what it asks of its sender, and what it carries. How a payload is read
//! stands in `read`; the messages of the original system are in `qak`.

use crate::access::Need;

/// Something that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// Begin, or go on.
    Start,
    /// Halt.
    Stop,
    /// Go home and wait.
    BackHome,
    /// Fetch the dangerous piece.
    Retrieve,
    /// Put the mission away.
    Reset,
    /// One move by hand; `h` is STOP.
    Move,
    /// Drive to a cell.
    Goto,
    /// Safe or danger.
    Verdict,
    /// Take a photo again.
    Retake,
    /// An alarm was seen.
    Acknowledge,
    /// Choose the order of the search.
    Strategy,
    /// What is known of the temperature.
    Temperature,
}

/// A command, as topics and documentation know it.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The last word of its topic.
    pub name: &'static str,
    /// What it does, in a few words.
    pub title: &'static str,
    /// Which it is.
    pub kind: CommandKind,
    /// What its sender must be allowed at least. A move may turn out to be a STOP, and asks for more when it is none.
    pub need: Need,
    /// What it carries, beside its own name.
    pub body: &'static [&'static str],
    /// Whether it can do without a payload, and so come as a bare word.
    pub is_word: bool,
}

/// What a movement command may carry.
const EPOCH: &[&str] = &[r#"{"epoch":4}"#];

/// All of them.
pub const ROWS: [Row; 12] = [
    word("start", "begin, or go on", CommandKind::Start, EPOCH),
    Row { need: Need::Stop, ..word("stop", "halt the robot", CommandKind::Stop, &[]) },
    word("backHome", "go home and wait", CommandKind::BackHome, EPOCH),
    word("retrieve", "fetch the dangerous piece", CommandKind::Retrieve, EPOCH),
    word("reset", "put the mission away", CommandKind::Reset, &[]),
    Row { need: Need::Stop, ..with("move", "one move by hand", CommandKind::Move, &[r#"{"move":"w"}"#, r#"{"move":"h"}"#]) },
    with("goto", "drive to a cell", CommandKind::Goto, &[r#"{"x":1,"y":1}"#]),
    with(
        "verdict",
        "safe or danger",
        CommandKind::Verdict,
        &[r#"{"luggage":3,"verdict":"safe"}"#, r#"{"luggage":3,"verdict":"danger"}"#],
    ),
    with("retake", "take the photo again", CommandKind::Retake, &[r#"{"luggage":3}"#]),
    with("acknowledge", "the alarm was seen", CommandKind::Acknowledge, &[r#"{"alarm":2}"#]),
    with("strategy", "choose the order of the search", CommandKind::Strategy, &[r#"{"name":"snail"}"#]),
    with(
        "temperature",
        "what is known of the temperature",
        CommandKind::Temperature,
        &[r#"{"celsius":21.5}"#, r#"{"celsius":21.5,"sensor":"roof"}"#, r#"{"status":"ok"}"#, r#"{"status":"tooHigh"}"#],
    ),
];

/// The command of this name.
#[must_use]
pub fn named(name: &str) -> Option<&'static Row> {
    ROWS.iter().find(|row| row.name == name)
}

/// The names of all commands, or of those that can come as a bare word, for sentences.
pub(super) fn names(bare: bool) -> String {
    let names: Vec<&str> = ROWS.iter().filter(|row| row.is_word || !bare).map(|row| row.name).collect();
    names.join(", ")
}

/// The table as the documentation shows it, in lines of markdown.
#[must_use]
pub fn markdown() -> String {
    let lines: Vec<String> = ROWS.iter().map(|row| format!("{}\n", line(row))).collect();
    format!("| name | what | payload | bare word | for |\n|---|---|---|---|---|\n{}", lines.concat())
}

fn line(row: &Row) -> String {
    let bodies: Vec<String> = row.body.iter().map(|body| format!("`{body}`")).collect();
    let payload = match (row.kind, row.is_word) {
        (CommandKind::Stop, _) => "not read".to_owned(),
        (_, true) => [vec!["none".to_owned(), "`{}`".to_owned()], bodies].concat().join(", "),
        (_, false) => bodies.join(", "),
    };
    let bare = if row.is_word { "yes" } else { "" };
    let whom = if row.kind == CommandKind::Move { "operator; `h` anyone signed in" } else { row.need.in_words() };
    format!("| `{}` | {} | {payload} | {bare} | {whom} |", row.name, row.title)
}

/// A command for operators that can do without a payload.
const fn word(name: &'static str, title: &'static str, kind: CommandKind, body: &'static [&'static str]) -> Row {
    Row { name, title, kind, need: Need::Act, body, is_word: true }
}

/// A command for operators that needs a payload.
const fn with(name: &'static str, title: &'static str, kind: CommandKind, body: &'static [&'static str]) -> Row {
    Row { name, title, kind, need: Need::Act, body, is_word: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_is_there_twice_and_every_name_is_a_part_of_a_topic() {
        let mut names: Vec<&str> = ROWS.iter().map(|row| row.name).collect();
        assert!(names.iter().all(|name| name.bytes().all(|byte| byte.is_ascii_alphabetic())));
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), ROWS.len());
        assert!(ROWS.iter().all(|row| named(row.name).is_some_and(|found| found.kind == row.kind)));
    }

    #[test]
    fn the_bare_words_are_those_of_the_buttons() {
        assert_eq!(names(true), "start, stop, backHome, retrieve, reset");
    }

    /// Safety S1.
    #[test]
    fn only_what_may_be_a_stop_asks_for_no_operator() {
        let open: Vec<CommandKind> = ROWS.iter().filter(|row| row.need != Need::Act).map(|row| row.kind).collect();
        assert_eq!(open, [CommandKind::Stop, CommandKind::Move]);
    }

    /// Where the documentation shows the table.
    const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/mqtt.md");

    #[test]
    fn the_documentation_shows_the_table_as_it_is() {
        let document = std::fs::read_to_string(DOCUMENT).unwrap();
        let (begin, end) = ("<!-- the table of commands begins -->\n", "<!-- the table of commands ends -->");
        let (before, rest) = document.split_once(begin).expect("the document has a place for the table");
        let (written, after) = rest.split_once(end).expect("the place has an end");
        let shown = markdown();
        if std::env::var_os("HALLSWEEP_UPDATE_DOCS").is_some() {
            std::fs::write(DOCUMENT, format!("{before}{begin}{shown}{end}{after}")).unwrap();
            return;
        }
        assert_eq!(written, shown, "write it anew with HALLSWEEP_UPDATE_DOCS=1 cargo test the_documentation_shows");
    }
}
