//! The table of commands as this door shows it: in sentences, and in its page.

use crate::api::commands::{COMMANDS, CommandKind, Row};

/// The names of all commands, or of those that can come as a bare word, for sentences.
pub(super) fn names(bare: bool) -> String {
    let names: Vec<&str> = COMMANDS.iter().filter(|row| row.is_word || !bare).map(|row| row.name).collect();
    names.join(", ")
}

/// The table as the documentation shows it, in lines of markdown.
#[must_use]
pub fn markdown() -> String {
    let lines: Vec<String> = COMMANDS.iter().map(|row| format!("{}\n", line(row))).collect();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bare_words_are_those_of_the_buttons() {
        assert_eq!(names(true), "start, stop, backHome, retrieve, reset");
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
