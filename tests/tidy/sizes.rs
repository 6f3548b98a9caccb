//! Rules about size: maximum lengths of files and functions, without tests.

use super::reading::Source;

/// Maximum number of lines of a file.
const FILE: usize = 700;

/// Maximum number of lines of a function, from `fn` to its closing brace.
const FUNCTION: usize = 90;

/// Violation if the file is too long.
pub(crate) fn file(source: &Source) -> Vec<String> {
    let lines = source.lines_without_tests;
    if lines <= FILE || source.is_all_tests() {
        return Vec::new();
    }
    vec![source.at(1, &format!("{lines} lines without tests, {FILE} are allowed: divide it"))]
}

/// Violations: functions that are too long.
pub(crate) fn functions(source: &Source) -> Vec<String> {
    let long = lengths(source).into_iter().filter(|(_, length)| *length > FUNCTION);
    long.map(|(line, length)| source.at(line, &format!("a function of {length} lines, {FUNCTION} are allowed"))).collect()
}

/// First line and number of lines of every function with a body, without tests.
fn lengths(source: &Source) -> Vec<(usize, usize)> {
    let code = source.code_without_tests();
    let starts = code.match_indices("fn ").filter(|(start, _)| {
        let alone = code[..*start].chars().next_back().is_none_or(char::is_whitespace);
        alone && code[start + 3..].chars().next().is_some_and(|letter| letter.is_alphabetic() || letter == '_')
    });
    let lines = |text: &str| text.matches('\n').count();
    starts.filter_map(|(start, _)| Some((lines(&code[..start]) + 1, lines(body(&code[start..])?) + 1))).collect()
}

/// Text from `fn` to the brace that closes the body; `None` for a signature without a body.
fn body(code: &str) -> Option<&str> {
    let (mut depth, mut groups) = (0_usize, 0_i32);
    for (place, letter) in code.char_indices() {
        match letter {
            '(' | '[' => groups += 1,
            ')' | ']' => groups -= 1,
            ';' if depth == 0 && groups == 0 => return None,
            '{' => depth += 1,
            '}' if depth == 1 => return Some(&code[..=place]),
            '}' => depth = depth.checked_sub(1)?,
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Source {
        Source::new("src/a.rs", text)
    }

    #[test]
    fn a_long_file_is_found_whatever_its_tests_are() {
        let lines = "const A: u8 = 1;\n".repeat(FILE);
        assert_eq!(file(&of(&format!("//! A.\n{lines}"))).len(), 1);
        assert_eq!(file(&of(&format!("//! A.\n#[cfg(test)]\nmod tests {{\n{lines}}}"))).len(), 0);
    }

    #[test]
    fn a_long_function_is_found_with_its_line() {
        let long = format!("//! A.\nfn short() {{}}\nfn long() {{\n{}}}\n", "    a();\n".repeat(FUNCTION));
        assert_eq!(functions(&of(&long)), ["src/a.rs:3: a function of 92 lines, 90 are allowed"]);
    }

    #[test]
    fn a_function_is_measured_to_its_closing_brace() {
        let text = "fn a(x: [u8; 2]) -> u8 {\n    if x { 1 } else { 2 }\n}\ntrait T {\n    fn b(&self);\n    fn c() {}\n}\nlet f: fn (u8);\n";
        assert_eq!(lengths(&of(text)), [(1, 3), (6, 1)]);
    }
}
