//! The transition table and its documentation agree: `docs/mission-table.md` is the output of `hallsweep table`.

use hallsweep_core::mission::table_markdown;

#[test]
fn the_documentation_prints_the_table_as_it_is() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/mission-table.md");
    let printed = table_markdown();
    if std::env::var_os("HALLSWEEP_UPDATE_DOCS").is_some() {
        std::fs::write(path, &printed).expect("docs/ can be written");
    }
    let documented = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        documented == printed,
        "{path} is out of date: HALLSWEEP_UPDATE_DOCS=1 cargo test -p hallsweep-sim --test simulation table"
    );
}
