//! Sources as the rules see them: the text, and the code without comments, strings and tests. The parser understands
//! only as much of Rust as this needs.

use std::path::{Path, PathBuf};

pub(crate) struct Source {
    /// Path from the top of the project, with `/`.
    pub(crate) path: String,
    pub(crate) text: String,
    /// The text with comments and the contents of strings blanked; its lines are the same.
    pub(crate) code: String,
    /// Number of lines before the unit tests.
    pub(crate) lines_without_tests: usize,
}

impl Source {
    /// Creates a source with this text, which need not exist on disk.
    pub(crate) fn new(path: &str, text: &str) -> Source {
        let code = code_of(text);
        let lines: Vec<&str> = code.lines().map(str::trim).collect();
        let tests =
            lines.windows(2).position(|pair| pair[0] == "#[cfg(test)]" && pair[1].starts_with("mod ") && pair[1].contains('{'));
        let lines_without_tests = tests.unwrap_or(lines.len());
        Source { path: path.to_owned(), text: text.to_owned(), code, lines_without_tests }
    }

    /// Code before the unit tests; empty when the whole file is tests.
    pub(crate) fn code_without_tests(&self) -> String {
        if self.is_all_tests() {
            return String::new();
        }
        self.code.lines().take(self.lines_without_tests).collect::<Vec<_>>().join("\n")
    }

    /// Whether the file contains only tests.
    pub(crate) fn is_all_tests(&self) -> bool {
        self.path.ends_with("tests.rs") || self.path.contains("/tests/")
    }

    /// Formats a violation; the line is counted from 1.
    pub(crate) fn at(&self, line: usize, what: &str) -> String {
        format!("{}:{line}: {what}", self.path)
    }
}

pub(crate) fn sources(directory: &str) -> Vec<Source> {
    let files = files(&root().join(directory));
    let rust = files.iter().filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    rust.map(|path| Source::new(&name(path), &std::fs::read_to_string(path).expect("a source is UTF-8"))).collect()
}

/// Folders with third-party files or output of tests.
const NOT_OURS: [&str; 3] = ["node_modules", "python_modules", "shots"];

/// Every file under a folder in sorted order, without the folders of `NOT_OURS`.
pub(crate) fn files(directory: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(directory) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a directory that can be read").path()).collect();
    paths.sort();
    let ours = paths.into_iter().filter(|path| !NOT_OURS.iter().any(|folder| path.ends_with(folder)));
    ours.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Path relative to the project, with `/`.
pub(crate) fn name(path: &Path) -> String {
    path.strip_prefix(root()).expect("a file of the project").to_string_lossy().replace('\\', "/")
}

/// Blanks comments and the contents of string and character literals, and keeps the newlines.
fn code_of(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = comment(rest).or_else(|| literal(rest, &code));
        let length = length.unwrap_or_else(|| {
            code.push(first);
            0
        });
        code.extend(rest[..length].chars().map(|letter| if letter == '\n' { '\n' } else { ' ' }));
        rest = &rest[length.max(if length == 0 { first.len_utf8() } else { 0 })..];
    }
    code
}

/// Length of the comment that begins here.
fn comment(rest: &str) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    rest.starts_with("/*").then(|| rest.find("*/").map_or(rest.len(), |end| end + 2))
}

/// Length of the string or character literal that begins here.
fn literal(rest: &str, before: &str) -> Option<usize> {
    let in_word = before.chars().last().is_some_and(|letter| letter.is_alphanumeric() || letter == '_');
    if rest.starts_with('r') && !in_word {
        let hashes = rest[1..].chars().take_while(|letter| *letter == '#').count();
        if rest[1 + hashes..].starts_with('"') {
            let close = format!("\"{}", "#".repeat(hashes));
            let body = &rest[hashes + 2..];
            return Some(body.find(&close).map_or(rest.len(), |end| hashes + 2 + end + close.len()));
        }
    }
    match rest.chars().next()? {
        '"' => Some(quoted(rest, '"')),
        '\'' if is_character(rest) => Some(quoted(rest, '\'')),
        _ => None,
    }
}

/// Length of a literal in these quotes, with escapes.
fn quoted(rest: &str, quote: char) -> usize {
    let mut escaped = false;
    for (place, letter) in rest.char_indices().skip(1) {
        if letter == quote && !escaped {
            return place + 1;
        }
        escaped = letter == '\\' && !escaped;
    }
    rest.len()
}

/// Whether a quote begins a character literal and not a lifetime.
fn is_character(rest: &str) -> bool {
    let mut letters = rest.chars().skip(1);
    let first = letters.next();
    first == Some('\\') || letters.next() == Some('\'')
}

#[test]
fn comments_and_literals_are_no_code() {
    let text = "let a = \"// no \\\" comment\"; // b\nlet c = '\"'; /* d\ne */ fn f<'g>() { r#\"h\"i\"# }\n";
    let code = code_of(text);
    assert_eq!(code.split_whitespace().collect::<Vec<_>>().join(" "), "let a = ; let c = ; fn f<'g>() { }");
    assert_eq!(code.lines().count(), text.lines().count());
}

#[test]
fn unit_tests_do_not_count() {
    let source = Source::new("src/a.rs", "//! A.\nfn a() {}\n#[cfg(test)]\nmod tests {}\n");
    assert_eq!((source.lines_without_tests, source.code_without_tests().contains("mod tests")), (2, false));
    let source = Source::new("src/a.rs", "//! A.\n#[cfg(test)]\nmod testing;\nfn a() {}\n");
    assert_eq!(source.lines_without_tests, 4, "a module of its own for tests does not end the code");
}
