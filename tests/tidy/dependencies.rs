//! The dependency rule: which module may name which, and which crates each may use.
//!
//! ```text
//!   main → cli, app → { inbound, outbound, runtime, config, telemetry, headless }
//!   inbound → runtime, wire, core      outbound → runtime, core      one door ↛ another
//!   runtime → core                     wire → core                   core → itself
//! ```

use super::reading::{Source, root};

/// A module at the top of the crate, whom it may name, and which crates it may use beside the standard library.
struct Rule {
    module: &'static str,
    modules: &'static [&'static str],
    crates: &'static [&'static str],
}

/// One line a module; a module without a line here is a finding.
const RULES: [Rule; 11] = [
    Rule { module: "core", modules: &[], crates: &["rand_chacha", "rand_core", "thiserror"] },
    Rule { module: "runtime", modules: &["core"], crates: &["futures_util", "jiff", "thiserror", "tokio", "tracing"] },
    Rule { module: "wire", modules: &["core"], crates: &["jiff", "serde", "serde_json", "thiserror"] },
    Rule {
        module: "inbound",
        modules: &["runtime", "wire", "core"],
        crates: &[
            "askama",
            "axum",
            "futures_util",
            "hyper",
            "hyper_util",
            "jiff",
            "serde",
            "serde_json",
            "thiserror",
            "tokio",
            "tower_http",
            "tracing",
        ],
    },
    Rule {
        module: "outbound",
        modules: &["runtime", "core"],
        crates: &["jiff", "png", "serde", "thiserror", "tokio", "toml", "tracing"],
    },
    Rule {
        module: "config",
        modules: &["core"],
        crates: &["figment", "serde", "serde_json", "thiserror", "toml", "tracing_subscriber"],
    },
    Rule { module: "telemetry", modules: &["config"], crates: &["tracing", "tracing_subscriber"] },
    Rule { module: "headless", modules: &["config", "core", "runtime", "wire", "outbound"], crates: &["jiff", "thiserror"] },
    Rule {
        module: "app",
        modules: &["config", "core", "inbound", "outbound", "runtime", "wire"],
        crates: &["thiserror", "tokio", "tracing"],
    },
    Rule {
        module: "cli",
        modules: &["app", "config", "core", "headless", "inbound", "outbound", "runtime", "telemetry", "wire"],
        crates: &["clap", "indicatif", "serde", "serde_json", "thiserror"],
    },
    Rule { module: "main", modules: &["app", "cli", "config", "telemetry"], crates: &["clap"] },
];

/// The one file of `runtime` that may use `jiff`, because it reads the clock.
const CLOCK: &str = "src/runtime/clock.rs";

/// Findings of modules named against the rule.
pub(crate) fn modules(source: &Source) -> Vec<String> {
    let Some(rule) = rule_for(source) else { return missing(source) };
    let mut findings = Vec::new();
    for (line, path) in named_paths(source) {
        let top = path[0].as_str();
        if top == rule.module && door(source).is_none_or(|door| path.get(1).is_none_or(|named| *named == door)) {
            continue;
        }
        if top == rule.module {
            findings.push(source.at(line, &format!("one door names another, `{}`", path.join("::"))));
        } else if is_module(top) && !rule.modules.contains(&top) {
            findings.push(source.at(line, &format!("`{}` must not name `{top}`", rule.module)));
        }
    }
    findings
}

/// Findings of crates used against the rule; unit tests may use what they like.
pub(crate) fn crates(source: &Source) -> Vec<String> {
    let Some(rule) = rule_for(source) else { return missing(source) };
    let mut findings = Vec::new();
    for (number, line) in source.code_without_tests().lines().enumerate() {
        for name in dependencies().iter().filter(|name| uses(line, name)) {
            let of_the_clock = name == "jiff" && rule.module == "runtime" && source.path != CLOCK;
            if !rule.crates.contains(&name.as_str()) || of_the_clock {
                findings.push(source.at(number + 1, &format!("`{}` must not use the crate `{name}`", rule.module)));
            }
        }
    }
    findings
}

fn missing(source: &Source) -> Vec<String> {
    if source.path == "src/lib.rs" { Vec::new() } else { vec![source.at(1, "tests/tidy/dependencies.rs has no rule for it")] }
}

fn rule_for(source: &Source) -> Option<&'static Rule> {
    let module = module_path(source).into_iter().next()?;
    RULES.iter().find(|rule| rule.module == module)
}

fn is_module(name: &str) -> bool {
    RULES.iter().any(|rule| rule.module == name)
}

/// The door or adapter family a file of `inbound` belongs to.
fn door(source: &Source) -> Option<String> {
    let path = module_path(source);
    (path.first().is_some_and(|top| top == "inbound") && path.len() > 1).then(|| path[1].clone())
}

/// The modules from the top of the crate down to the file: `src/a/b.rs` and `src/a/b/mod.rs` are both `a`, `b`.
fn module_path(source: &Source) -> Vec<String> {
    let path = source.path.trim_start_matches("src/").trim_end_matches(".rs").trim_end_matches("/mod");
    path.split('/').map(str::to_owned).collect()
}

/// Every path of the crate that the code names, from the top of the crate, two names deep, with its line.
fn named_paths(source: &Source) -> Vec<(usize, Vec<String>)> {
    let mut paths = Vec::new();
    let file = module_path(source);
    let unit_tests = [file.as_slice(), &["tests".to_owned()]].concat();
    for (number, line) in joined_uses(&source.code) {
        for (start, _) in line.match_indices("crate::").chain(line.match_indices("hallsweep::")) {
            let begins = line[..start].chars().next_back().is_none_or(|letter| !is_word(letter));
            let after = line[start..].split_once("::").map_or("", |(_, after)| after);
            paths.extend(heads(after).into_iter().filter(|_| begins).map(|path| (number, path)));
        }
        let own = if number > source.lines_without_tests { &unit_tests } else { &file };
        for (start, _) in line.match_indices("super::").filter(|(start, _)| !line[..*start].ends_with("super::")) {
            let supers = line[start..].split("super::").skip(1).take_while(|part| part.is_empty()).count() + 1;
            let after = line[start..].trim_start_matches("super::");
            if let Some(base) = own.len().checked_sub(supers) {
                paths.extend(heads(after).into_iter().map(|path| (number, [&own[..base], path.as_slice()].concat())));
            }
        }
    }
    paths.retain(|(_, path)| !path.is_empty() && !path[0].is_empty());
    paths
}

/// The lines of code, with a `use` that spans several joined into its first.
fn joined_uses(code: &str) -> Vec<(usize, String)> {
    let mut lines: Vec<(usize, String)> = Vec::new();
    let mut open = false;
    for (number, line) in code.lines().enumerate() {
        match lines.last_mut().filter(|_| open) {
            Some((_, joined)) => joined.push_str(line.trim()),
            None => lines.push((number + 1, line.to_owned())),
        }
        let begins = line.trim_start().trim_start_matches("pub ").starts_with("use ");
        open = (open || begins) && !line.contains(';');
    }
    lines
}

/// The first two names of a path, or of each path in a group: `a::{b, c::d}` gives `a, b` and `a, c`.
fn heads(path: &str) -> Vec<Vec<String>> {
    if let Some(group) = path.strip_prefix('{') {
        return members(group).iter().flat_map(|member| heads(member.trim())).collect();
    }
    let first: String = path.chars().take_while(|letter| is_word(*letter)).collect();
    let after = path[first.len()..].strip_prefix("::").unwrap_or_default();
    if let Some(group) = after.strip_prefix('{') {
        return members(group).iter().map(|member| vec![first.clone(), word(member.trim())]).collect();
    }
    let second = word(after);
    if second.is_empty() { vec![vec![first]] } else { vec![vec![first, second]] }
}

/// The members of a group after its opening brace, those of inner groups not set apart.
fn members(group: &str) -> Vec<String> {
    let mut members = vec![String::new()];
    let mut depth = 1;
    for letter in group.chars() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        match (letter, depth) {
            (_, 0) => break,
            (',', 1) => members.push(String::new()),
            _ => members.last_mut().expect("there is always one member").push(letter),
        }
    }
    members
}

fn word(text: &str) -> String {
    text.chars().take_while(|letter| is_word(*letter)).collect()
}

fn is_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// Whether a line of code names the crate: a path that begins with it, or a `use` of it.
fn uses(line: &str, name: &str) -> bool {
    line.match_indices(name).any(|(start, _)| {
        let before = line[..start].chars().next_back().is_none_or(|letter| !is_word(letter) && letter != ':' && letter != '.');
        let after = &line[start + name.len()..];
        before && (after.starts_with("::") || (line.trim_start().starts_with("use ") && after.starts_with([';', ' '])))
    })
}

/// The crates of `[dependencies]`, as code names them.
fn dependencies() -> Vec<String> {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("the manifest is there");
    let section = manifest.split("[dependencies]").nth(1).and_then(|rest| rest.split("\n[").next()).unwrap_or_default();
    let names = section.lines().filter_map(|line| line.split_once(" = ")).map(|(name, _)| name.replace('-', "_"));
    names.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> usize {
        let source = Source::new(path, text);
        modules(&source).len() + crates(&source).len()
    }

    #[test]
    fn a_core_that_knows_the_world_is_found() {
        assert_eq!(found("src/core/a.rs", "use crate::core::units::Cell;\nuse std::fmt;"), 0);
        assert_eq!(found("src/core/a.rs", "use crate::runtime::handle::Handle;"), 1);
        assert_eq!(found("src/core/a/b.rs", "fn f() { super::super::super::wire::map::text() }"), 1);
        assert_eq!(found("src/core/a.rs", "use serde::Serialize;"), 1);
        assert_eq!(found("src/core/a.rs", "fn f() { tokio::spawn(g()) }"), 1);
        assert_eq!(found("src/core/a.rs", "// tokio::spawn, crate::inbound\nlet a = \"tokio::spawn\";"), 0);
    }

    #[test]
    fn a_door_that_knows_an_adapter_or_another_door_is_found() {
        assert_eq!(found("src/inbound/http/a.rs", "use crate::outbound::store::memory::Memory;"), 1);
        assert_eq!(found("src/outbound/store/a.rs", "use crate::inbound::http;"), 1);
        assert_eq!(found("src/inbound/coap/a.rs", "use crate::inbound::http::errors;"), 1);
        assert_eq!(found("src/inbound/coap/a.rs", "use super::super::http::errors;"), 1);
        assert_eq!(found("src/inbound/http/a.rs", "use super::super::http::errors;\nuse super::pages;"), 0);
        assert_eq!(found("src/outbound/a.rs", "use crate::wire::map;"), 1);
    }

    #[test]
    fn unit_tests_are_a_module_deeper() {
        let tests = "//! A.\n#[cfg(test)]\nmod tests {\n    use super::super::testing::house;\n}";
        assert_eq!(found("src/inbound/http/a.rs", tests), 0);
        assert_eq!(found("src/inbound/http/a.rs", "use super::super::testing::house;"), 1);
    }

    #[test]
    fn a_group_over_several_lines_hides_nothing() {
        assert_eq!(found("src/wire/a.rs", "use crate::{\n    core::{units::Cell, event},\n    app,\n};"), 1);
        assert_eq!(found("src/inbound/http/a.rs", "use crate::inbound::{http::pages, mqtt};"), 1);
    }

    #[test]
    fn only_the_command_line_names_the_app() {
        assert_eq!(found("src/config/a.rs", "use crate::app;"), 1);
        assert_eq!(found("src/headless.rs", "use crate::cli::Failure;"), 1);
        assert_eq!(found("src/main.rs", "use hallsweep::{cli, app};"), 0);
        assert_eq!(found("src/main.rs", "use hallsweep::core::units::Cell;"), 1);
    }

    #[test]
    fn only_the_clock_of_the_runtime_uses_jiff() {
        assert_eq!(found("src/runtime/task.rs", "let now = jiff::Zoned::default();"), 1);
        assert_eq!(found(CLOCK, "let now = jiff::Zoned::default();"), 0);
    }

    #[test]
    fn a_module_without_a_rule_is_found() {
        assert_eq!(found("src/utils.rs", "fn a() {}"), 2);
    }
}
