//! `hallsweep explore`: the figures of a run, and equal runs for equal seeds.

use serde_json::Value;

use crate::program::{hallsweep, run};

fn explore(arguments: &[&str]) -> Value {
    let arguments = [&["explore", "--json"], arguments].concat();
    let output = run(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("exactly one JSON object")
}

#[test]
fn the_figures_are_one_json_object_of_this_shape() {
    let figures = explore(&["--hall", "empty-8x8", "--strategy", "snail", "--seed", "3"]);
    let mut keys: Vec<&str> = figures.as_object().expect("an object").keys().map(String::as_str).collect();
    keys.sort_unstable();
    let mut expected = [
        "hall",
        "strategy",
        "seed",
        "cells",
        "free_cells",
        "pieces",
        "reachable_pieces",
        "steps",
        "turns",
        "bumps",
        "moves_per_cell",
        "complete",
        "home",
        "luggage",
        "bomb_found_at_moves",
    ];
    expected.sort_unstable();
    assert_eq!(keys, expected);
    assert_eq!((&figures["hall"], &figures["strategy"], &figures["seed"]), (&"empty-8x8".into(), &"snail".into(), &3.into()));
    assert_eq!((&figures["cells"], &figures["complete"], &figures["home"]), (&64.into(), &true.into(), &true.into()));
    assert_eq!((&figures["luggage"], &figures["bomb_found_at_moves"]), (&serde_json::json!([]), &Value::Null));
    assert!(figures["steps"].as_u64() >= Some(63) && figures["moves_per_cell"].as_f64() >= Some(1.0), "{figures}");
}

#[test]
fn the_verdicts_come_from_the_hall_file_unless_all_are_safe() {
    let hall = explore(&["--hall", "airport", "--seed", "1"]);
    assert!(hall["bomb_found_at_moves"].as_u64().is_some_and(|moves| moves > 0), "{hall}");
    assert_eq!((&hall["home"], &hall["complete"]), (&true.into(), &false.into()));
    let safe = explore(&["--hall", "airport", "--seed", "1", "--verdicts", "all-safe"]);
    assert_eq!((&safe["home"], &safe["complete"]), (&true.into(), &true.into()));
    assert_eq!(safe["bomb_found_at_moves"], hall["bomb_found_at_moves"], "it was met all the same, and let pass");
    let verdicts = |run: &Value| -> Vec<String> {
        run["luggage"].as_array().expect("a list").iter().map(|piece| piece["verdict"].to_string()).collect()
    };
    assert_eq!(verdicts(&hall).iter().filter(|verdict| *verdict == "\"danger\"").count(), 1);
    assert!(verdicts(&safe).len() >= 6 && verdicts(&safe).iter().all(|verdict| verdict == "\"safe\""));
}

#[test]
fn the_same_seed_is_the_same_run_byte_for_byte() {
    let log = |name: &str, seed: &str| {
        let path = std::env::temp_dir().join(format!("hallsweep-{}-{name}.log", std::process::id()));
        explore(&["--hall", "airport", "--seed", seed, "--log", path.to_str().expect("a printable path")]);
        let bytes = std::fs::read(&path).expect("the log was written");
        std::fs::remove_file(&path).expect("the log is ours");
        bytes
    };
    let first = log("first", "7");
    assert!(first.iter().filter(|byte| **byte == b'\n').count() > 100, "a whole mission has many lines");
    assert!(first == log("second", "7"), "the same seed gave another run");
    assert!(first != log("third", "8"), "another seed gave the same run");
}

#[test]
fn for_people_it_prints_the_map_and_the_figures() {
    let output = run(&["explore", "--hall", "empty-8x8"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && text.contains("|r, 1, 1, 1, 1, 1, 1, 1, X, \n"), "{text}");
    assert!(text.contains("64"), "{text}");
}

#[test]
fn a_hall_that_cannot_be_read_is_refused_with_its_line() {
    let path = std::env::temp_dir().join(format!("hallsweep-{}-broken.toml", std::process::id()));
    std::fs::write(&path, "drawing = \"\"\"\nS..\n.?.\n\"\"\"\n").expect("the temporary directory can be written");
    let output = run(&["explore", "--hall", path.to_str().expect("a printable path")]);
    std::fs::remove_file(&path).expect("the file is ours");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains(":3:") && said.contains('?'), "{said}");
    assert_eq!(run(&["explore", "--strategy", "zigzag"]).status.code(), Some(2));
}

/// The simulated operator is one judge, who answers no questions.
#[test]
fn rules_for_judges_do_not_stop_a_run() {
    let mut command = hallsweep(&["explore", "--json", "--hall", "seed"]);
    let ruled = command.env("HALLSWEEP__MISSION__SAFE_BY", "2").env("HALLSWEEP__MISSION__HOT", "required").output().unwrap();
    assert!(ruled.status.success(), "{}", String::from_utf8_lossy(&ruled.stderr));
    assert_eq!(serde_json::from_slice::<Value>(&ruled.stdout).unwrap(), explore(&["--hall", "seed"]));
}

#[test]
fn every_strategy_goal_and_sensing_searches_the_whole_hall() {
    for strategy in ["auto", "scored", "frontier", "columns", "spiral", "snail"] {
        for (goal, sensing) in [("find", "bump"), ("cover", "sonar")] {
            let asked = ["--hall", "airport", "--verdicts", "all-safe", "--strategy", strategy];
            let run = explore(&[&asked[..], &["--goal", goal, "--sensing", sensing]].concat());
            assert_eq!((&run["complete"], &run["home"]), (&true.into(), &true.into()), "{strategy} {goal} {sensing}: {run}");
            assert_eq!(run["strategy"], strategy);
            // With sonar a robot bumps at most into the cell that it faces before its first move.
            assert!(sensing == "bump" || run["bumps"].as_u64() <= Some(1), "{strategy}: {run}");
        }
    }
}

#[test]
fn what_a_search_cannot_be_asked_for_is_said_with_what_it_can() {
    let check = |arguments: &[&str], expect: &str| {
        let output = run(&[&["explore"], arguments].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(expect), "{arguments:?}: {said}");
    };
    check(&["--strategy", "zigzag"], "write one of: auto, scored, frontier, columns, spiral, snail");
    check(&["--goal", "win"], "write one of: find, cover");
    check(&["--sensing", "smell"], "write one of: bump, sonar");
    for costs in ["1,1", "0,1,1", "-1,1,1", "1,26,1", "much"] {
        check(&["--costs", costs], "write robot, or what a step, a turn and a bump cost, such as 1,1,1");
    }
}

#[test]
fn a_hall_that_is_read_is_not_written_over_by_the_log() {
    let hall = std::env::temp_dir().join(format!("hallsweep-{}-read.toml", std::process::id()));
    let hall = hall.to_str().expect("a printable path");
    assert!(run(&["hall", "convert", "seed", hall, "--force"]).status.success());
    let before = std::fs::read(hall).expect("it was written");
    let output = run(&["explore", "--hall", hall, "--log", hall]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && error.contains("is given twice"), "{error}");
    assert_eq!(std::fs::read(hall).expect("it is there"), before);
    std::fs::remove_file(hall).expect("it is ours");
}

/// Both old names stay for one release.
#[test]
fn evaluate_and_tune_answer_with_the_command_of_the_program_that_they_belong_to_now() {
    for (typed, command) in [
        (&["evaluate", "--halls", "airport", "--json"][..], "evaluate --halls airport --json"),
        (&["tune", "--help"], "tune --help"),
        (&["tune"], "tune"),
    ] {
        let output = run(typed);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.ends_with(&format!("\ncargo run --release -p hallsweep-evaluation -- {command}\n")), "{said}");
    }
}

/// A pocket in the north-west corner, a hall with a piece, and a closed room with another piece.
const POCKETS: &str = "type octile\nheight 4\nwidth 8\nmap\n.@.....@\n@@..T..@\n@@@@@@@@\n.T@@@@@@\n";

#[test]
fn a_search_that_cannot_come_everywhere_says_how_much_of_the_hall_it_could_come_to() {
    let map = std::env::temp_dir().join(format!("hallsweep-{}-pockets.map", std::process::id()));
    std::fs::write(&map, POCKETS).expect("the map can be written");
    let map = map.to_str().expect("a printable path");
    for (start, cells, pieces) in [(None, 9, 1), (Some("0,0"), 1, 0), (Some("0,3"), 1, 1), (Some("6, 1"), 9, 1)] {
        let flags: Vec<&str> = ["--hall", map].into_iter().chain(start.iter().flat_map(|start| ["--start", *start])).collect();
        let figures = explore(&flags);
        assert_eq!((&figures["cells"], &figures["free_cells"]), (&cells.into(), &11.into()), "{start:?}: {figures}");
        assert_eq!((&figures["reachable_pieces"], &figures["pieces"]), (&pieces.into(), &2.into()), "{start:?}: {figures}");
        let output = run(&[&["explore"], &flags[..]].concat());
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        for line in [
            format!("cells           {cells} of 11 free cells can be reached from the start"),
            format!("pieces          {pieces} of 2 pieces of luggage can be reached from the start"),
            "complete        yes, as far as can be reached from the start".to_owned(),
        ] {
            assert!(said.lines().any(|said| said == line), "{line} in {said}");
        }
    }
    let whole = String::from_utf8(run(&["explore", "--hall", "empty-8x8"]).stdout).expect("text");
    assert!(whole.lines().any(|line| line == "complete        yes"), "{whole}");
    for (start, why) in [
        (
            "1,0",
            "setting hall.start: the start 1,0 is not a free cell of this hall of 8 × 4 cells: give column and row of a \
             free cell, counted",
        ),
        ("8,0", "setting hall.start: the start 8,0 is not a free cell"),
        ("0,4294967295", "setting hall.start: the start 0,4294967295 is not a free cell"),
        (
            "-1,0",
            "setting hall.start = \"-1,0\" (from flag --start): it is not a column and a row; write column and row, counted from 0",
        ),
        ("3", "setting hall.start = \"3\" (from flag --start): it is not a column and a row"),
    ] {
        let output = run(&["explore", "--hall", map, "--start", start]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(why), "{start}: {said}");
    }
}
