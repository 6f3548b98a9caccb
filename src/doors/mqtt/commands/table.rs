//! The table of commands as texts: a list of names for error messages, and the table in `docs/mqtt.md`.

use crate::api::commands::COMMANDS;

pub(super) fn names(bare: bool) -> String {
    let names: Vec<&str> = COMMANDS.iter().filter(|row| row.is_word() || !bare).map(|row| row.name).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::commands::{CommandKind, CommandRow};

    fn markdown() -> String {
        let lines: Vec<String> = COMMANDS.iter().map(|row| format!("{}\n", line(row))).collect();
        format!("| name | what | payload | bare word | for |\n|---|---|---|---|---|\n{}", lines.concat())
    }

    fn line(row: &CommandRow) -> String {
        let bodies: Vec<String> = row.body.iter().map(|body| format!("`{body}`")).collect();
        let payload = match (row.kind, row.is_word()) {
            (CommandKind::Stop, _) => "not read".to_owned(),
            (_, true) => [vec!["none".to_owned(), "`{}`".to_owned()], bodies].concat().join(", "),
            (_, false) => bodies.join(", "),
        };
        let bare = if row.is_word() { "yes" } else { "" };
        let whom = if row.kind == CommandKind::Move { "operator; `h` anyone signed in" } else { row.need.in_words() };
        format!("| `{}` | {} | {payload} | {bare} | {whom} |", row.name, row.title)
    }

    #[test]
    fn the_bare_words_are_those_of_the_buttons() {
        assert_eq!(names(true), "start, stop, backHome, goOn, retrieve, reset");
    }

    #[test]
    fn the_documentation_shows_the_table_as_it_is() {
        crate::api::tests::documented::shows("mqtt.md", "the table of commands", &markdown());
    }
}
