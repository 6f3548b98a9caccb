//! The rules of the source code as tests: dependencies, headers, sizes, the one clock. The tests read the sources and
//! report file and line of every violation. Each rule has its own file, with a test that the rule finds violations.

#[path = "tidy/circles.rs"]
mod circles;
#[path = "tidy/crates.rs"]
mod crates;
#[path = "tidy/dependencies.rs"]
mod dependencies;
#[path = "tidy/layers.rs"]
mod layers;
#[path = "tidy/phrases.rs"]
mod phrases;
#[path = "tidy/reading.rs"]
mod reading;
#[path = "tidy/routes.rs"]
mod routes;
#[path = "tidy/rules.rs"]
mod rules;
#[path = "tidy/sizes.rs"]
mod sizes;
#[path = "tidy/whole.rs"]
mod whole;
#[path = "tidy/words.rs"]
mod words;

use reading::{Source, sources};

/// Panics with all violations of a rule in the sources of the program and the crates.
fn check(rule: impl Fn(&Source) -> Vec<String>) {
    check_in(&["src", "crates"], rule);
}

fn check_in(folders: &[&str], rule: impl Fn(&Source) -> Vec<String>) {
    let sources: Vec<Source> = folders.iter().flat_map(|folder| sources(folder)).collect();
    assert!(sources.len() > 30, "only {} sources were found: the test looks in the wrong place", sources.len());
    let findings: Vec<String> = sources.iter().flat_map(rule).collect();
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

#[test]
fn nobody_names_a_module_that_is_not_his_to_name() {
    check_in(&["src"], dependencies::modules);
}

#[test]
fn everybody_uses_only_the_crates_that_are_his() {
    check_in(&["src"], dependencies::crates);
}

#[test]
fn the_crates_are_as_the_picture_shows_them() {
    let findings = crates::differ_from_picture(&crates::manifests(), &whole::text("docs/architecture.md"));
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

#[test]
fn the_crates_for_others_have_no_word_of_this_program() {
    let findings = crates::our_words();
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

#[test]
fn every_file_says_what_it_is_for() {
    check(words::header);
}

/// Safety A1.
#[test]
fn every_route_is_in_the_one_table() {
    check(routes::beside_the_table);
}

#[test]
fn the_clock_is_read_in_one_place() {
    check(words::clock);
}

#[test]
fn no_name_is_that_of_many_types() {
    let sources: Vec<Source> = ["src", "crates"].iter().flat_map(|folder| sources(folder)).collect();
    let findings = words::repeated_types(&sources);
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

#[test]
fn nothing_is_left_undone() {
    check(words::undone);
    sources("tests").iter().for_each(|source| assert_eq!(words::undone(source), Vec::<String>::new()));
}

#[test]
fn every_phrase_is_there_in_every_language_and_said_somewhere() {
    let findings = phrases::findings();
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

#[test]
fn no_file_is_too_long() {
    check(sizes::file);
}

#[test]
fn no_function_is_too_long() {
    check(sizes::functions);
}

#[test]
fn no_path_of_a_machine_is_written_anywhere() {
    let findings = whole::machine_paths();
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

#[test]
fn everything_the_container_copies_is_there() {
    let recipe = whole::text("Dockerfile");
    let mut findings = whole::container_paths(&recipe);
    findings.extend(whole::container_manifests(&recipe));
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

#[test]
fn every_link_in_the_documents_leads_somewhere() {
    let findings = whole::dead_links();
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

#[test]
fn no_page_and_no_script_has_an_address_from_the_root() {
    let findings = whole::absolute_addresses();
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

#[test]
fn no_lock_file_names_a_download_address() {
    for folder in ["browser", "clients"] {
        assert_eq!(whole::download_addresses(&whole::text(&format!("tests/{folder}/package-lock.json"))), Vec::<String>::new());
    }
}

#[test]
fn every_rule_that_is_cited_has_its_page_and_those_of_safety_have_tests_that_try_to_break_them() {
    let page = whole::text("docs/safety.md");
    let sources: Vec<Source> = ["src", "crates", "tests", "benches"].iter().flat_map(|folder| sources(folder)).collect();
    let mut findings = rules::untried(&page, &sources);
    let citing = sources.iter().filter(|source| source.path != "tests/tidy/rules.rs");
    let mission = whole::text("docs/mission.md");
    findings
        .extend(citing.flat_map(|source| [rules::unknown(source, &page), rules::unknown_sections(source, &mission)].concat()));
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}
