//! For tests: a table in a page of `docs/`, held against the one in the program.

use std::fs;
use std::path::Path;

/// Fails unless the page shows this between `<!-- PLACE begins -->` and `<!-- PLACE ends -->`; with `HALLSWEEP_UPDATE_DOCS` set it is
/// written there.
pub(crate) fn shows(page: &str, place: &str, shown: &str) {
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
