//! The layers of the core: which of its modules may name which. Cargo enforces the rule between the crates, and
//! `dependencies` within the program.

use super::dependencies::named_paths;
use super::reading::{Source, root, sources};

/// Modules at the top of the core, from the lowest layer up. A module may name its own layer and those below.
const LAYERS: [&[&str]; 10] = [
    &["rng"],
    // Its modules are re-exported at the top of the crate.
    &["vocabulary"],
    &["world"],
    &["search"],
    &["settings"],
    &["effect", "state"],
    &["mission"],
    &["retrieval"],
    &["snapshot"],
    &["engine"],
];

/// Layer of a module at the top of the core.
fn layer(module: &str) -> Option<usize> {
    let is_word = || root().join(format!("crates/core/src/vocabulary/{module}.rs")).exists();
    let named = |name: &str| LAYERS.iter().position(|modules| modules.contains(&name));
    named(module).or_else(|| is_word().then(|| named("vocabulary")).flatten())
}

/// Violations: modules of a higher layer that a file of the core names. Unit tests may name any module.
fn above(source: &Source) -> Vec<String> {
    let path = source.path.trim_start_matches("crates/core/");
    let own = path.trim_start_matches("src/").split(['/', '.']).next().unwrap_or_default();
    if own == "lib" {
        return Vec::new();
    }
    let Some(own_layer) = layer(own) else { return vec![source.at(1, "tests/tidy/layers.rs has no layer for it")] };
    let code = Source { path: path.to_owned(), ..Source::new(&source.path, &source.code_without_tests()) };
    let named = named_paths(&code);
    let higher = named.iter().filter(|(_, path)| layer(&path[0]).is_some_and(|named| named > own_layer));
    higher.map(|(line, path)| source.at(*line, &format!("`{own}` names `{}`, which lies above it", path.join("::")))).collect()
}

#[test]
fn no_layer_of_the_core_names_one_above_it() {
    let findings: Vec<String> = sources("crates/core/src").iter().flat_map(above).collect();
    assert!(findings.is_empty(), "{}", findings.join("\n"));
}

#[test]
fn what_lies_above_is_found_however_it_is_named() {
    let found = |path: &str, text: &str| above(&Source::new(&format!("crates/core/src/{path}"), text)).len();
    assert_eq!(found("world/alarm.rs", "use crate::units::Cell;\nuse crate::pair::Saying;\nuse super::log;"), 0);
    assert_eq!(found("world/alarm.rs", "use crate::effect::Effect;"), 1);
    assert_eq!(found("vocabulary/hold.rs", "use super::units::Cell;\nfn f() { crate::world::a() }"), 1);
    assert_eq!(found("vocabulary/hold.rs", "use super::super::world::hall_map::Mark;"), 1);
    assert_eq!(found("effect.rs", "use crate::{state::Phase, mission::Input};"), 1);
    assert_eq!(found("engine/view.rs", "use crate::snapshot::Snapshot;"), 0);
    assert_eq!(found("rng.rs", "fn a() {}\n#[cfg(test)]\nmod tests {\n    use crate::engine::Engine;\n}"), 0);
    assert_eq!(found("other.rs", "fn a() {}"), 1);
}
