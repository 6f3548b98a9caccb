//! The rules of safety and of the mission: every cited rule is in `docs/safety.md` or `docs/mission.md`, and the
//! tests that the page of safety names exist.

use super::reading::Source;

/// Rows of the page's tables that are rules, as number and text.
fn rows(page: &str) -> Vec<(&str, &str)> {
    let rows = page.lines().filter_map(|line| line.strip_prefix("| ")?.split_once(" | "));
    rows.filter(|(number, _)| is_number(number)).collect()
}

/// Whether a word is the number of a rule, such as `S8`.
fn is_number(word: &str) -> bool {
    let digits = word.strip_prefix(['S', 'V', 'R', 'D', 'A']).unwrap_or_default();
    !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// Citations of safety rules that the page does not contain.
pub(crate) fn unknown(source: &Source, page: &str) -> Vec<String> {
    let known: Vec<&str> = rows(page).into_iter().map(|(number, _)| number).collect();
    let cited = |line: &str| -> Vec<String> {
        let Some((_, rest)) = line.split_once("afety ") else { return Vec::new() };
        let words = rest.split(|c: char| !c.is_ascii_alphanumeric()).take_while(|word| word.is_empty() || is_number(word));
        words.filter(|word| !word.is_empty() && !known.contains(word)).map(ToOwned::to_owned).collect()
    };
    let lines = source.text.lines().enumerate();
    lines
        .flat_map(|(n, line)| cited(line).into_iter().map(move |rule| (n + 1, rule)))
        .map(|(line, rule)| source.at(line, &format!("safety {rule} is not in docs/safety.md")))
        .collect()
}

/// Citations of mission sections that the page does not contain.
pub(crate) fn unknown_sections(source: &Source, page: &str) -> Vec<String> {
    let is_there = |number: &str| page.lines().any(|line| line.starts_with(&format!("## §{number} ")));
    let cited = |line: &'_ str| -> Vec<String> {
        let after = line.split("ission §").skip(1);
        let numbers = after.map(|rest| rest.chars().take_while(char::is_ascii_digit).collect::<String>());
        numbers.filter(|number| !is_there(number)).collect()
    };
    let lines = source.text.lines().enumerate();
    lines
        .flat_map(|(n, line)| cited(line).into_iter().map(move |number| (n + 1, number)))
        .map(|(line, number)| source.at(line, &format!("mission §{number} is not in docs/mission.md")))
        .collect()
}

/// Rules of the page without a test, and named tests that do not exist.
pub(crate) fn untried(page: &str, sources: &[Source]) -> Vec<String> {
    let is_there = |test: &str| sources.iter().any(|source| source.text.contains(&format!("fn {test}(")));
    let of = |(number, row): (&str, &str)| -> Vec<String> {
        let tests: Vec<&str> = row.rsplit_once(" | ").map_or("", |(_, tests)| tests).split('`').skip(1).step_by(2).collect();
        if tests.is_empty() {
            return vec![format!("docs/safety.md: no test tries {number}")];
        }
        let absent = tests.into_iter().filter(|test| !is_there(test));
        absent.map(|test| format!("docs/safety.md: {number} is tried by {test}, which is not there")).collect()
    };
    rows(page).into_iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "| rule | what | tried by |\n|---|---|---|\n| S1 | It stops. | `it_stops` |\n| S2 | First. | nothing |\n";

    #[test]
    fn a_rule_that_is_not_there_is_found() {
        let source = Source::new("src/a.rs", "//! A.\n/// Safety S1, S3: both.\nfn a() {}");
        assert_eq!(unknown(&source, PAGE), ["src/a.rs:2: safety S3 is not in docs/safety.md"]);
    }

    #[test]
    fn a_section_that_is_not_there_is_found() {
        let source = Source::new("src/a.rs", "//! A (mission §1).\n/// Mission §2, and mission §12.\nfn a() {}");
        let page = "# What it does\n\n## §1 The hall\n\n## §2 Moves\n";
        assert_eq!(unknown_sections(&source, page), ["src/a.rs:2: mission §12 is not in docs/mission.md"]);
    }

    #[test]
    fn a_test_that_is_not_there_is_found_and_a_rule_without_one() {
        let none = "docs/safety.md: no test tries S2";
        let gone = "docs/safety.md: S1 is tried by it_stops, which is not there";
        assert_eq!(untried(PAGE, &[]), [gone, none]);
        assert_eq!(untried(PAGE, &[Source::new("tests/a.rs", "fn it_stops() {}")]), [none]);
    }
}
