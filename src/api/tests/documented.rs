//! For tests: compares a table in a page of `docs/` with the table in the program.

use std::fs;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use crate::api::commands::{CommandKind, CommandRow};

/// Prevents two tests from writing to one page at the same time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

pub(crate) fn bodies(command: &CommandRow) -> String {
    if command.kind == CommandKind::Stop {
        return "not read".to_owned();
    }
    let subjects = [r#""luggage":3,"#, r#""luggage":3"#, r#""alarm":2"#];
    let bare = |body: &&str| subjects.iter().fold((*body).to_owned(), |body, subject| body.replace(subject, ""));
    let written = command.body.iter().map(bare).filter(|body| body != "{}").map(|body| format!("`{body}`"));
    let none = command.is_word() || command.body.iter().all(|body| bare(body) == "{}");
    none.then(|| "none".to_owned()).into_iter().chain(written).collect::<Vec<_>>().join(", ")
}

/// Fails unless the page has this text between `<!-- PLACE begins -->` and `<!-- PLACE ends -->`. If
/// `HALLSWEEP_UPDATE_DOCS` is set, writes the text there instead.
pub(crate) fn shows(page: &str, place: &str, shown: &str) {
    let _turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(page);
    let text = fs::read_to_string(&path).unwrap();
    let (begin, end) = (format!("<!-- {place} begins -->\n"), format!("<!-- {place} ends -->"));
    let (before, rest) = text.split_once(&begin).expect("the page has a place for the table");
    let (written, after) = rest.split_once(&end).expect("the place has an end");
    if std::env::var_os("HALLSWEEP_UPDATE_DOCS").is_some() {
        fs::write(path, format!("{before}{begin}{shown}{end}{after}")).unwrap();
        return;
    }
    assert_eq!(written, shown, "write it anew with HALLSWEEP_UPDATE_DOCS=1 cargo test the_documentation_shows");
}
