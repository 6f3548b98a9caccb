//! The description for programs, seen by programs that others wrote: schemathesis asks every operation what is right and what is wrong, as
//! operator, as viewer and as nobody, and a client that openapi-python-client makes of it runs a whole mission.

use std::process::Command;

use crate::access::Site;
use crate::program::Program;
use crate::third_party::{folder, left_out, python, runs, within};

/// Asking every operation everything takes a while, on a busy machine above all.
const ASKING_S: &str = "900";

fn are_here() -> bool {
    let all = runs(python().args(["-c", "import schemathesis, openapi_python_client"]));
    all || left_out("HTTP", "schemathesis and openapi-python-client (.ci/run installs what tests/clients/openapi.txt lists)")
}

/// A program that asks for keys.
fn site(name: &str) -> Site {
    Site::in_hall(name, &["HTTP__REQUIRE_TOKEN"], "airport", "max")
}

fn description(program: &Program) -> String {
    format!("http://{}/api/v1/openapi.json", program.address())
}

/// Fails with what a client said unless it ends well; gives that back if it does.
fn said(command: &Command) -> String {
    let ended = within(ASKING_S, command).output().expect("it starts");
    let said = [&*ended.stdout, &*ended.stderr].map(String::from_utf8_lossy).concat();
    assert!(ended.status.success(), "{said}");
    said
}

/// Asks every operation what is right and what is wrong, as whoever has this token.
fn is_as_described(program: &Program, token: Option<&str>) {
    let mut command = python();
    command.args(["-m", "schemathesis.cli", "--config-file"]).arg(folder().join("schemathesis.toml"));
    command.args([
        "run",
        &description(program),
        "--url",
        &format!("http://{}", program.address()),
        "--checks",
        "all",
        "--no-color",
        "--continue-on-failure",
    ]);
    if let Some(token) = token {
        command.args(["--header", &format!("Authorization: Bearer {token}")]);
    }
    let hooks = std::env::join_paths([folder(), folder().join("python_modules")]).expect("no path of this machine has a colon");
    command.env("SCHEMATHESIS_HOOKS", "schemathesis_hooks").env("PYTHONPATH", hooks).current_dir(env!("CARGO_TARGET_TMPDIR"));
    let said = said(&command);
    let tested = |line: &str| said.lines().find_map(|said| said.trim().strip_prefix(line).map(str::to_owned));
    assert_eq!(
        tested("Selected: "),
        Some(tested("Tested: ").expect("it says how many")).map(|all| format!("{all}/{all}")),
        "{said}"
    );
}

/// Side by side, since each is kept waiting for long by the wrong keys that it shows.
#[test]
fn every_operation_is_as_described_for_operator_viewer_and_nobody_and_where_no_key_is_asked_for() {
    if !are_here() {
        return;
    }
    std::thread::scope(|all| {
        all.spawn(|| is_as_described(&Program::serve("airport", "max"), None));
        for who in ["operator", "viewer", "nobody"] {
            all.spawn(move || {
                let site = site(&format!("described-{who}"));
                let token = [("operator", &site.operator), ("viewer", &site.viewer)].into_iter().find(|(role, _)| *role == who);
                is_as_described(&site.program, token.map(|(_, token)| token.as_str()));
            });
        }
    });
}

#[test]
fn a_client_made_of_the_description_runs_a_whole_mission() {
    if !are_here() {
        return;
    }
    let site = site("described-mission");
    let made = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("made-client");
    let mut generator = python();
    generator.args(["-m", "openapi_python_client", "generate", "--overwrite", "--meta", "none"]);
    generator.args(["--url", &description(&site.program), "--output-path"]).arg(made.join("hallsweep_client"));
    generator.arg("--config").arg(folder().join("openapi_python_client.yml"));
    std::fs::create_dir_all(&made).expect("a folder");
    said(&generator);
    let mut mission = python();
    mission.arg(folder().join("mission.py")).arg(&made).arg(format!("http://{}", site.program.address())).arg(&site.operator);
    assert!(said(&mission).contains("explored, 7 safe"));
}
