//! Rules about words: the header of every file, the one clock, no unfinished work, and unambiguous type names.

use std::collections::BTreeMap;

use super::reading::Source;

/// Maximum number of types with the same name; a more frequent name says little.
const TYPES_OF_ONE_NAME: usize = 4;

/// Violation if the file does not begin with a header.
pub(crate) fn header(source: &Source) -> Vec<String> {
    let first = source.text.lines().next().unwrap_or_default();
    if first.starts_with("//! ") && first.len() > 20 {
        return Vec::new();
    }
    vec![source.at(1, "it must open with `//!`: a sentence on its job, then what is deliberately not here")]
}

/// Violations: readings of the clock outside `runtime/clock.rs`. Examples, benchmarks and binaries of crates are
/// separate programs and may read it; all other code gets the time as an argument.
pub(crate) fn clock(source: &Source) -> Vec<String> {
    let is_a_program = ["/examples/", "/benches/", "/src/bin/"].iter().any(|folder| source.path.contains(folder));
    if source.path == "src/runtime/clock.rs" || is_a_program {
        return Vec::new();
    }
    let clocks = ["Instant::now", "SystemTime::now", "Zoned::now", "Timestamp::now"];
    lines_with(source, &clocks, "take the time as an argument; only runtime::clock reads the clock")
}

/// Violations: unfinished work, and tests that do not run.
pub(crate) fn undone(source: &Source) -> Vec<String> {
    let mut findings = lines_with(source, &["todo!", "unimplemented!", concat!("#[ig", "nore")], "nothing is left undone here");
    for (number, line) in source.text.lines().enumerate() {
        let comment = line.split_once("//").map_or("", |(_, comment)| comment);
        if [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("XX", "X")].iter().any(|word| comment.contains(word)) {
            findings.push(source.at(number + 1, "a note for later: do it, or write an issue"));
        }
    }
    findings
}

/// Violations: names of too many types, with the places of their declarations.
pub(crate) fn repeated_types(sources: &[Source]) -> Vec<String> {
    let mut declarations: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for source in sources {
        for (number, line) in source.code_without_tests().lines().enumerate() {
            if let Some(name) = declared_type(line) {
                declarations.entry(name.to_owned()).or_default().push(source.at(number + 1, "here"));
            }
        }
    }
    declarations.retain(|_, places| places.len() > TYPES_OF_ONE_NAME);
    let words = |(name, places): (&String, &Vec<String>)| {
        format!("{} types are called `{name}`, {TYPES_OF_ONE_NAME} are allowed: {}", places.len(), places.join(", "))
    };
    declarations.iter().map(words).collect()
}

/// Type that a line declares. An indented `type` is an associated type, whose name comes from its trait.
fn declared_type(line: &str) -> Option<&str> {
    let code = line.trim_start();
    let code = match code.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(')')?.1,
        Some(rest) => rest,
        None => code,
    };
    let (keyword, rest) = code.trim_start().split_once(' ')?;
    let declares = ["struct", "enum", "trait", "union"].contains(&keyword) || keyword == "type" && !line.starts_with(' ');
    let name = rest.split(|letter: char| !letter.is_alphanumeric() && letter != '_').next()?;
    Some(name).filter(|name| declares && !name.is_empty())
}

fn lines_with(source: &Source, needles: &[&str], what: &str) -> Vec<String> {
    let lines = source.code.lines().enumerate();
    let hits = lines.filter(|(_, line)| needles.iter().any(|needle| line.contains(needle)));
    hits.map(|(number, _)| source.at(number + 1, what)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Source {
        Source::new("src/a.rs", text)
    }

    #[test]
    fn a_missing_header_is_found() {
        assert_eq!(header(&of("use std::fmt;\n")).len(), 1);
        assert_eq!(header(&of("//! A.\n")).len(), 1, "that says nothing");
        assert_eq!(header(&of("//! The words that a door says to a robot.\n")).len(), 0);
    }

    #[test]
    fn a_second_clock_is_found_with_its_line() {
        assert_eq!(
            clock(&of("//! A.\nlet t = std::time::Instant::now();")),
            ["src/a.rs:2: take the time as an argument; only runtime::clock reads the clock"]
        );
        assert_eq!(clock(&of("let t = jiff::Timestamp::now();")).len(), 1);
        assert_eq!(clock(&of("// Instant::now is not for us\n")).len(), 0);
    }

    #[test]
    fn work_left_for_later_is_found() {
        assert_eq!(undone(&of("fn a() { todo!() }")).len(), 1);
        assert_eq!(undone(&of(concat!("#[ig", "nore = \"slow\"]\nfn a() {}"))).len(), 1);
        assert_eq!(undone(&of(concat!("// TO", "DO: later"))).len(), 1);
        assert_eq!(undone(&of("let a = \"todo!\";")).len(), 0);
    }

    #[test]
    fn a_name_that_too_many_types_have_is_found() {
        let text = "//! A.\npub(super) struct Row {\n    type Row = u8;\nenum Row<'a> {\ntype Row = u8;\npub struct Other;\n";
        let sources = ["src/a.rs", "src/b.rs"].map(|path| Source::new(path, text));
        let at = |path| [2, 4, 5].map(|line| format!("{path}:{line}: here")).join(", ");
        let all = format!("6 types are called `Row`, 4 are allowed: {}, {}", at("src/a.rs"), at("src/b.rs"));
        assert_eq!(repeated_types(&sources), [all]);
        assert_eq!(repeated_types(&sources[..1]), Vec::<String>::new());
    }
}
