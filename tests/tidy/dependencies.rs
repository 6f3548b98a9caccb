//! The dependency rule within the program: which module may name which, and which crates each module may use. Cargo
//! enforces the rule between the crates.
//!
//! ```text
//!   main → cli                           cli → everything but main, doors
//!   app → { access, doors, robots, storage, runtime, config }
//!   doors → access, runtime, api, phrases, report          one door ↛ another
//!   report → api, phrases, runtime       storage → runtime, api
//!   robots → config, runtime, storage    access → storage
//!   api → access, runtime                telemetry → api, runtime
//!   runtime, config → themselves
//! ```
//! Only `robots` builds a robot from its settings; `app` knows no kind of robot. `access` names `storage` only to
//! write a small file, because the keys are stored in the data folder.

use super::reading::{Source, root};

/// Module at the top of the crate, the modules that it may name, and the crates that it may use besides the standard
/// library.
struct Rule {
    module: &'static str,
    modules: &'static [&'static str],
    crates: &'static [&'static str],
}

/// Rules of all modules; a module without a rule is a violation.
const RULES: [Rule; 13] = [
    Rule {
        module: "access",
        modules: &["storage"],
        // `hallsweep_core` for the names of halls.
        crates: &["getrandom", "hallsweep_core", "hmac", "serde", "sha2", "subtle", "thiserror", "toml", "tracing"],
    },
    Rule {
        module: "runtime",
        modules: &[],
        crates: &["hallsweep_core", "jiff", "prometheus_client", "thiserror", "tokio", "tracing"],
    },
    Rule {
        module: "api",
        // The table of commands contains the required role of each command, and `runtime` defines how the simulator
        // is shown.
        modules: &["access", "runtime"],
        // `hallsweep_sim` for the file formats of halls.
        crates: &[
            "behaviour_trees",
            "hallsweep_core",
            "hallsweep_sim",
            "jiff",
            "minicbor",
            "minicbor_serde",
            "schemars",
            "serde",
            "serde_json",
            "thiserror",
        ],
    },
    Rule { module: "phrases", modules: &[], crates: &["askama", "fluent_bundle", "hallsweep_core", "serde_json", "unic_langid"] },
    Rule {
        module: "report",
        modules: &["api", "phrases", "runtime"],
        crates: &["askama", "base64", "csv", "hallsweep_core", "jpeg_encoder", "png", "sha2", "thiserror", "zip", "zune_jpeg"],
    },
    Rule {
        module: "doors",
        modules: &["access", "runtime", "api", "phrases", "report"],
        crates: &[
            "behaviour_trees",
            "askama",
            "axum",
            "bytes",
            "coap_endpoint",
            "flate2",
            "hallsweep_core",
            "hallsweep_laboratory",
            "hashlink",
            "futures_util",
            "hyper",
            "hyper_util",
            "jiff",
            "mqtt_gate",
            "prometheus_client",
            "rumqttc",
            "rumqttd",
            "rustls",
            "rustls_native_certs",
            "serde",
            "serde_json",
            "socket2",
            "thiserror",
            "tokio",
            "tokio_rustls",
            "tower_http",
            "tracing",
        ],
    },
    Rule {
        module: "robots",
        modules: &["config", "runtime", "storage"],
        crates: &[
            "futures_util",
            "hallsweep_core",
            "hallsweep_drivers",
            "hallsweep_sim",
            "serial2_tokio",
            "thiserror",
            "tokio",
            "tokio_tungstenite",
            "tracing",
        ],
    },
    Rule {
        module: "storage",
        modules: &["runtime", "api"],
        crates: &["hallsweep_core", "rusqlite", "rustix", "serde_json", "sha2", "thiserror", "tokio", "tracing"],
    },
    Rule {
        module: "config",
        modules: &[],
        crates: &["figment", "hallsweep_core", "serde", "serde_json", "thiserror", "toml", "tracing_subscriber"],
    },
    // `api` for the format of the time at the beginning of a log line.
    Rule { module: "telemetry", modules: &["api", "runtime"], crates: &["nix", "tracing", "tracing_subscriber"] },
    Rule {
        module: "app",
        modules: &["access", "config", "doors", "robots", "storage", "runtime"],
        crates: &["hallsweep_core", "mqtt_gate", "rustix", "socket2", "thiserror", "tokio", "tracing"],
    },
    Rule {
        module: "cli",
        modules: &["access", "api", "app", "config", "phrases", "report", "robots", "storage", "runtime", "telemetry"],
        crates: &[
            "behaviour_trees",
            "clap",
            "hallsweep_core",
            "hallsweep_laboratory",
            "hallsweep_sim",
            "indicatif",
            "rustls",
            "serde",
            "serde_json",
            "thiserror",
        ],
    },
    Rule { module: "main", modules: &["cli"], crates: &["clap"] },
];

/// Modules of `doors` that are no doors; every door may use them.
const SHARED: [&str; 6] = ["connection_limits", "listeners", "log_throttle", "problem", "update_interval", "write_timeout"];

/// Only file of `runtime` that may use `jiff`, because it reads the clock.
const CLOCK: &str = "src/runtime/clock.rs";

/// Violations: modules that a file names against the rule.
pub(crate) fn modules(source: &Source) -> Vec<String> {
    let Some(rule) = rule_for(source) else { return missing(source) };
    let mut findings = Vec::new();
    for (line, path) in named_paths(source) {
        let top = path[0].as_str();
        let is_shared = |named: &String| SHARED.contains(&named.as_str());
        if top == rule.module
            && door(source).is_none_or(|door| path.get(1).is_none_or(|named| *named == door || is_shared(named)))
        {
            continue;
        }
        if top == rule.module {
            findings.push(source.at(line, &format!("one door names another, `{}`", path.join("::"))));
        } else if top == "*" && !is_root(source) {
            findings.push(source.at(line, "it names everything at the top of the crate: name what is meant"));
        } else if is_module(top) && !rule.modules.contains(&top) {
            findings.push(source.at(line, &format!("`{}` must not name `{top}`", rule.module)));
        }
    }
    findings
}

/// Violations: crates that a file uses against the rule. Unit tests may use any crate.
pub(crate) fn crates(source: &Source) -> Vec<String> {
    let Some(rule) = rule_for(source) else { return missing(source) };
    let mut findings = Vec::new();
    let dependencies = dependencies();
    for (number, line) in joined_uses(&source.code_without_tests()) {
        for name in dependencies.iter().filter(|name| uses(&line, name)) {
            let of_the_clock = name == "jiff" && rule.module == "runtime" && source.path != CLOCK;
            if !rule.crates.contains(&name.as_str()) || of_the_clock {
                findings.push(source.at(number, &format!("`{}` must not use the crate `{name}`", rule.module)));
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

/// Whether a file is the root of a crate.
fn is_root(source: &Source) -> bool {
    ["src/main.rs", "src/lib.rs"].contains(&source.path.as_str())
}

fn is_module(name: &str) -> bool {
    RULES.iter().any(|rule| rule.module == name)
}

/// Door that a file of `doors` belongs to.
fn door(source: &Source) -> Option<String> {
    let path = module_path(source);
    (path.first().is_some_and(|top| top == "doors") && path.len() > 1).then(|| path[1].clone())
}

/// Modules from the top of the crate down to the file; `src/a/b.rs` and `src/a/b/mod.rs` both give `a`, `b`.
pub(crate) fn module_path(source: &Source) -> Vec<String> {
    let path = source.path.trim_start_matches("src/").trim_end_matches(".rs").trim_end_matches("/mod");
    path.split('/').map(str::to_owned).collect()
}

/// Every path of the crate that the code names, in `use` lines or elsewhere, from the top of the crate, with its
/// line.
pub(crate) fn named_paths(source: &Source) -> Vec<(usize, Vec<String>)> {
    let file = module_path(source);
    let unit_tests = [file.as_slice(), &["tests".to_owned()]].concat();
    let mut paths = Vec::new();
    for (number, line) in joined_uses(&source.code) {
        let own = if number > source.lines_without_tests { &unit_tests } else { &file };
        let roots = ["crate::", "hallsweep::", "self::", "super::"].into_iter().flat_map(|root| line.match_indices(root));
        for (start, _) in roots.filter(|(start, _)| begins_path(&line[..*start])) {
            paths.extend(expanded(&line[start..]).iter().filter_map(|path| from_the_top(own, path)).map(|path| (number, path)));
        }
    }
    paths.retain(|(_, path)| path.first().is_some_and(|top| !top.is_empty()));
    paths
}

/// Whether a path can begin after this text, which must not end within a longer name or path.
fn begins_path(before: &str) -> bool {
    let mut letters = before.chars().rev();
    match letters.next() {
        None => true,
        Some(':') => letters.nth(1).is_none_or(|letter| !is_word(letter) && letter != '>'),
        Some(letter) => !is_word(letter),
    }
}

/// Target of a path that the module `own` names; `None` when the path leaves the crate.
pub(crate) fn from_the_top(own: &[String], path: &[String]) -> Option<Vec<String>> {
    let mut place = own.to_vec();
    for name in path {
        match name.as_str() {
            "crate" | "hallsweep" => place.clear(),
            "super" => drop(place.pop()?),
            "self" => {}
            _ => place.push(name.clone()),
        }
    }
    Some(place)
}

/// Lines of code; a `use` over several lines is joined into its first line.
pub(crate) fn joined_uses(code: &str) -> Vec<(usize, String)> {
    let mut lines: Vec<(usize, String)> = Vec::new();
    let mut open = false;
    for (number, line) in code.lines().enumerate() {
        match lines.last_mut().filter(|_| open) {
            Some((_, joined)) => joined.push_str(line.trim()),
            None => lines.push((number + 1, line.to_owned())),
        }
        open = (open || is_use(line)) && !line.contains(';');
    }
    lines
}

/// Whether a line begins a `use` with any visibility, or an `extern crate`.
pub(crate) fn is_use(line: &str) -> bool {
    let line = line.trim_start();
    let seen_by = line.strip_prefix("pub").map_or(line, |rest| match rest.strip_prefix('(') {
        Some(inner) => inner.split_once(')').map_or("", |(_, rest)| rest),
        None => rest,
    });
    ["use ", "extern crate "].iter().any(|word| seen_by.trim_start().starts_with(word))
}

/// All paths of a group: `a::{b, c::d}` gives `a, b` and `a, c, d`.
pub(crate) fn expanded(path: &str) -> Vec<Vec<String>> {
    let path = path.trim_start();
    if let Some(group) = path.strip_prefix('{') {
        return members(group).iter().filter(|member| !member.trim().is_empty()).flat_map(|member| expanded(member)).collect();
    }
    let first = if path.starts_with('*') { "*".to_owned() } else { word(path) };
    if first.is_empty() {
        return vec![Vec::new()];
    }
    match path[first.len()..].strip_prefix("::") {
        Some(after) => expanded(after).into_iter().map(|rest| [vec![first.clone()], rest].concat()).collect(),
        None => vec![vec![first]],
    }
}

/// Members of a group after its opening brace; inner groups are not divided.
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

/// Whether a line of code names the crate: in a path that begins with the crate, or in a `use`.
fn uses(line: &str, name: &str) -> bool {
    line.match_indices(name).any(|(start, _)| {
        let before = begins_path(&line[..start]) && !line[..start].ends_with('.');
        let after = &line[start + name.len()..];
        before && (after.starts_with("::") || (is_use(line) && after.starts_with([';', ' ', ',', '}'])))
    })
}

/// Crates of `[dependencies]`, spelled as in code.
fn dependencies() -> Vec<String> {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("the manifest is there");
    let section = manifest.split("[dependencies]").nth(1).and_then(|rest| rest.split("\n[").next()).unwrap_or_default();
    let names = section.lines().filter_map(|line| line.split_once([' ', '.'])).map(|(name, _)| name.replace('-', "_"));
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
    fn a_room_that_knows_the_world_is_found() {
        assert_eq!(found("src/access/a.rs", "use crate::access::units::Cell;\nuse std::fmt;"), 0);
        assert_eq!(found("src/access/a.rs", "use crate::runtime::handle::Handle;"), 1);
        assert_eq!(found("src/access/a/b.rs", "fn f() { super::super::super::api::map::text() }"), 1);
        assert_eq!(found("src/access/a.rs", "use hallsweep_sim::Hall;"), 1);
        assert_eq!(found("src/access/a.rs", "fn f() { tokio::spawn(g()) }"), 1);
        assert_eq!(found("src/access/a.rs", "// tokio::spawn, crate::doors\nlet a = \"tokio::spawn\";"), 0);
    }

    #[test]
    fn a_door_that_knows_an_adapter_or_another_door_is_found() {
        assert_eq!(found("src/doors/http/a.rs", "use crate::storage::sqlite::MemoryStore;"), 1);
        assert_eq!(found("src/storage/a.rs", "use crate::doors::http;"), 1);
        assert_eq!(found("src/doors/coap/a.rs", "use crate::doors::http::errors;"), 1);
        assert_eq!(found("src/app/a.rs", "use hallsweep_sim::Hall;"), 1, "which robots there are is not its business");
        assert_eq!(found("src/doors/coap/a.rs", "use super::super::http::errors;"), 1);
        assert_eq!(found("src/doors/http/a.rs", "use super::super::http::errors;\nuse super::pages;"), 0);
        assert_eq!(found("src/storage/a.rs", "use crate::api::journal;\nuse crate::config;"), 1);
    }

    #[test]
    fn unit_tests_are_a_module_deeper() {
        let tests = "//! A.\n#[cfg(test)]\nmod tests {\n    use super::super::testing::app;\n}";
        assert_eq!(found("src/doors/http/a.rs", tests), 0);
        assert_eq!(found("src/doors/http/a.rs", "use super::super::testing::app;"), 1);
    }

    #[test]
    fn a_group_over_several_lines_hides_nothing() {
        assert_eq!(found("src/api/a.rs", "use crate::{\n    api::{map, event},\n    app,\n};"), 1);
        assert_eq!(found("src/doors/http/a.rs", "use crate::doors::{http::pages, mqtt};"), 1);
    }

    #[test]
    fn a_group_hides_nothing_however_it_is_written() {
        assert_eq!(found("src/access/a.rs", "use crate::runtime::{handle, task};"), 2);
        assert_eq!(found("src/access/a.rs", "use crate::{access::{units::Cell, event}, api::{map, time}};"), 2);
        assert_eq!(found("src/access/a.rs", "use {crate::app, std::fmt};"), 1);
        assert_eq!(found("src/access/a.rs", "use crate::{\n    access::units,\n    api::{\n        map,\n    },\n};"), 1);
        assert_eq!(found("src/access/a.rs", "use crate::access::{units::{Cell, Celsius}, event};"), 0);
        assert_eq!(found("src/access/a.rs", "use crate::*;"), 1);
    }

    #[test]
    fn a_climb_leads_where_it_leads() {
        assert_eq!(found("src/access/a/b.rs", "use super::super::super::api::map;"), 1);
        assert_eq!(found("src/access/a/b.rs", "use super::super::api::map;"), 0, "that is access::api, whatever its name");
        assert_eq!(found("src/access/a.rs", "use super::{super::api::map, units};"), 1);
        assert_eq!(found("src/access/a.rs", "use self::super::super::app::serve;"), 1);
        assert_eq!(found("src/access/mod.rs", "use super::*;"), 1);
        assert_eq!(found("src/access/a.rs", "use super::*;"), 0);
    }

    #[test]
    fn to_pass_on_is_to_name() {
        for seen_by in ["pub", "pub(crate)", "pub(super)", "pub(in crate::access)"] {
            assert_eq!(found("src/access/a.rs", &format!("{seen_by} use crate::api::map;")), 1, "{seen_by}");
            assert_eq!(
                found("src/access/a.rs", &format!("{seen_by} use crate::{{\n    access::units,\n    api,\n}};")),
                1,
                "{seen_by}"
            );
            assert_eq!(found("src/access/a.rs", &format!("{seen_by} use tokio;")), 1, "{seen_by}");
            assert_eq!(found("src/access/a.rs", &format!("{seen_by} use axum as s;")), 1, "{seen_by}");
        }
    }

    #[test]
    fn a_full_path_in_code_is_found_like_a_use() {
        assert_eq!(found("src/access/a.rs", "fn f(a: &crate::api::map::Map) -> Option<crate::app::AppError> { None }"), 2);
        assert_eq!(found("src/access/a.rs", "impl From<super::super::api::A> for B {}"), 1);
        assert_eq!(found("src/access/a.rs", "let a = <crate::runtime::A as B>::c();"), 1);
        assert_eq!(found("src/access/a.rs", "vec![crate::config::load(), crate::access::a()]"), 1);
        assert_eq!(found("src/access/a.rs", "let a = my_crate::app::b();"), 0);
    }

    #[test]
    fn every_crate_of_another_room_is_found() {
        for name in ["tokio", "rusqlite", "jiff", "axum"] {
            for text in
                ["use NAME::a;", "use NAME;", "use ::NAME::a;", "use {NAME, std::fmt};", "use {\n    std::fmt,\n    NAME,\n};"]
            {
                assert_eq!(found("src/access/a.rs", &text.replace("NAME", name)), 1, "{text} {name}");
            }
            for text in
                ["extern crate NAME;", "let a = ::NAME::b();", "#[derive(NAME::A)]", "fn f(a: Box<NAME::A>) {}", "NAME::a!()"]
            {
                assert_eq!(found("src/access/a.rs", &text.replace("NAME", name)), 1, "{text} {name}");
            }
            for text in ["let NAME = 1;", "fn f() { a::NAME::b() }", "my_NAME::a()", "a.NAME", "// NAME::a", "mod NAMEs;"] {
                assert_eq!(found("src/access/a.rs", &text.replace("NAME", name)), 0, "{text} {name}");
            }
        }
    }

    #[test]
    fn only_the_command_line_names_the_app() {
        assert_eq!(found("src/config/a.rs", "use crate::app;"), 1);
        assert_eq!(found("src/robots/a.rs", "use crate::cli::Failure;"), 1);
        assert_eq!(found("src/main.rs", "use hallsweep::cli;"), 0);
        assert_eq!(found("src/main.rs", "use hallsweep::{cli, app};"), 1);
        assert_eq!(found("src/main.rs", "use hallsweep::runtime::task;"), 1);
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
