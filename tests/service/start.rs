//! Starting: settings that are refused, a port that is taken, the health check.

use std::net::TcpListener;

use crate::program::{Program, hallsweep, run};

fn refused(arguments: &[&str], code: i32) -> String {
    let output = run(arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(output.stdout.is_empty(), "nothing was started");
    said
}

#[test]
fn a_wrong_setting_stops_the_start_with_key_value_origin_and_what_to_do() {
    let said = refused(&["serve", "--speed", "fast"], 2);
    assert_eq!(
        said,
        "hallsweep: setting robot.speed = \"fast\" (from flag --speed): this word is no speed; \
         write a factor from 0.1 to 1000 (1 = as a person would watch it), or max for no waiting\n"
    );
    let output = hallsweep(&[]).env("HALLSWEEP__ROBOT__SPED", "1").output().expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("`robot.sped` (from environment variable HALLSWEEP__ROBOT__SPED)"), "{said}");
    assert!(refused(&["--config", "no-such-file.toml"], 2).contains("no-such-file.toml"));
}

#[test]
fn a_mistyped_flag_is_refused_with_the_same_code() {
    assert!(refused(&["serve", "--sped", "1"], 2).contains("--speed"));
}

#[test]
fn other_machines_are_let_in_only_when_told_so() {
    assert!(refused(&["--http", "0.0.0.0:0"], 2).contains("--insecure"));
    let program = Program::with(&["--http", "0.0.0.0:0", "--insecure", "--hall", "empty-8x8"]);
    assert_ne!(program.address().port(), 0);
}

#[test]
fn a_hall_that_is_not_there_is_refused_with_those_that_are() {
    let said = refused(&["serve", "--http", "127.0.0.1:0", "--hall", "no-such-hall"], 2);
    assert!(said.contains("no-such-hall") && said.contains("airport"), "{said}");
}

#[test]
fn a_port_that_is_taken_is_named_with_what_to_do() {
    let taken = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = taken.local_addr().expect("a bound port").to_string();
    let said = refused(&["serve", "--http", &address], 1);
    assert!(said.contains(&address) && said.contains("--http 127.0.0.1:0"), "{said}");
}

#[test]
fn the_health_check_knows_whether_somebody_is_there() {
    let program = Program::serve("empty-8x8", "max");
    let check = |address: &str| run(&["healthcheck", "--http", address]).status.code();
    assert_eq!(program.read("/healthz", &[]).status, 200);
    assert_eq!(check(&program.address().to_string()), Some(0));
    assert_eq!(check("127.0.0.1:1"), Some(1), "nobody listens at port 1");
}

#[test]
fn the_mission_table_of_the_documents_is_the_one_in_the_program() {
    let printed = run(&["table"]);
    assert!(printed.status.success());
    let document = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/mission-table.md");
    let document = std::fs::read_to_string(document).expect("the table is in the documents");
    assert_eq!(String::from_utf8_lossy(&printed.stdout).trim_end(), document.trim_end());
}

#[test]
fn version_and_help_are_there() {
    let version = run(&["--version"]);
    assert_eq!(String::from_utf8_lossy(&version.stdout), format!("hallsweep {}\n", env!("CARGO_PKG_VERSION")));
    let help = String::from_utf8_lossy(&run(&["--help"]).stdout).into_owned();
    for word in ["serve", "explore", "healthcheck", "--hall", "--speed", "config/default.toml"] {
        assert!(help.contains(word), "{word} is not in\n{help}");
    }
}
