//! The program: comparisons in tables, JSON, CSV and pictures, the same halls for all, and weights in files.

use std::path::Path;
use std::process::{Command, Output};

use hallsweep_core::command::Strategy;
use hallsweep_core::search::Objective;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::settings::Settings;
use hallsweep_sim::headless::{Verdicts, explore};
use hallsweep_sim::{Hall, SimSettings};
use serde_json::Value;

/// A hall of two pieces, as a map of MovingAI.
const HALL: &str = "type octile\nheight 4\nwidth 6\nmap\n......\n.T....\n......\n....T.\n";

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hallsweep-evaluation")).args(arguments).output().expect("it was built")
}

fn evaluate(arguments: &[&str]) -> String {
    let output = run(&[&["evaluate", "--count", "4"], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// What is the same every time: decisions take as long as they take.
fn without_times(json: &str) -> Value {
    let mut value: Value = serde_json::from_str(json).expect("exactly one JSON object");
    for comparison in value["comparisons"].as_array_mut().expect("a list") {
        for strategy in comparison["strategies"].as_array_mut().expect("a list") {
            strategy.as_object_mut().expect("an object").remove("decision_us");
        }
    }
    value
}

#[test]
fn the_same_flags_walk_through_the_same_halls_by_the_same_moves() {
    let flags = ["--halls", "walls:12x9,airport", "--strategies", "auto,snail", "--goal", "cover", "--against", "auto", "--json"];
    let figures = without_times(&evaluate(&flags));
    assert_eq!(figures, without_times(&evaluate(&flags)));
    let [walls, airport] = figures["comparisons"].as_array().expect("a list").as_slice() else { panic!("two kinds of halls") };
    assert_eq!((&walls["count"], &airport["count"], &airport["seed"]), (&4.into(), &1.into(), &Value::Null));
    let snail = &walls["strategies"][1];
    assert_eq!((&snail["strategy"], &snail["complete"]), (&"snail".into(), &true.into()));
    let more = &snail["more_than"]["moves_per_cell"];
    assert!(more["mean"].as_f64() > more["interval"].as_f64(), "it goes home after every square: {more}");
}

#[test]
fn without_halls_it_is_the_table_of_the_documentation() {
    let table = evaluate(&["--strategies", "columns,frontier,auto"]);
    let rows: Vec<&str> = table.lines().collect();
    let page = include_str!("../../../docs/search.md");
    let documented = page
        .lines()
        .skip_while(|line| !line.ends_with("| auto minus frontier |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    assert_eq!(rows.len(), 1 + documented.count() + 2, "{table}");
    assert!(rows[0].starts_with("halls") && rows[0].ends_with("auto minus frontier"), "{table}");
    let figures = |row: &str| -> Vec<f64> { row.split_whitespace().filter_map(|word| word.parse().ok()).collect() };
    let [.., frontier, _, auto, _, less, _] = figures(rows[2])[..] else { panic!("means and intervals: {table}") };
    assert!(rows[2].starts_with("luggage-10:20x20") && (auto - frontier - less).abs() < 0.001_1, "hall by hall: {table}");
}

#[test]
#[expect(clippy::cast_precision_loss, reason = "no mission makes 2^53 moves")]
fn a_walk_makes_the_moves_that_a_mission_makes() {
    let hall = Hall::named_or_file("airport").expect("it is built in");
    let settings = Settings { objective: Objective::Cover, costs: Costs::read("1,1,1"), ..Settings::default() };
    let mission = explore(&hall.into(), SimSettings::default(), settings, Strategy::Auto, Verdicts::AllSafe, |_| {});
    let walks = without_times(&evaluate(&["--halls", "airport", "--strategies", "auto", "--goal", "cover", "--json"]));
    let moves = mission.moves.total() as f64 / mission.cells as f64;
    assert_eq!(walks["comparisons"][0]["strategies"][0]["moves_per_cell"]["mean"], moves);
}

#[test]
fn every_search_is_a_line_of_csv_and_every_tour_a_picture() {
    let folder = tempdir("evaluate");
    let file = |name: &str| folder.join(name).display().to_string();
    let flags = ["--halls", "empty:6x5,maze:9x9", "--strategies", "columns,spiral"];
    let (csv, plot, tours) = (file("figures.csv"), file("plot.svg"), folder.display().to_string());
    let table = evaluate(&[&flags[..], &["--csv", &csv, "--plot", &plot, "--tours", &tours]].concat());
    assert!(
        table.starts_with(
            "empty:6x5 · 4 halls · goal find · bump · costs 1,1,1\n120 of 120 free cells can be reached from the start\nstrategy"
        ),
        "{table}"
    );
    let lines = std::fs::read_to_string(&csv).expect("it was written");
    let columns: Vec<usize> = lines.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(columns, vec![23; 1 + 2 * 2 * 4]);
    for picture in ["plot.svg", "columns-empty-6x5.svg", "spiral-maze-9x9.svg"] {
        let svg = std::fs::read_to_string(folder.join(picture)).expect("it was written");
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"), "{picture}");
    }
}

#[test]
fn what_cannot_be_compared_is_said_with_what_can() {
    let check = |arguments: &[&str], expect: &str| {
        let output = run(&[&["evaluate"], arguments].concat());
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && error.contains(expect), "{arguments:?}: {error}");
    };
    check(&["--halls", "walls:5"], "--halls walls:5: \"5\" is no size: write columns and lines, as 50x50, each from 1 to 2048");
    check(&["--halls", "nowhere"], "--halls nowhere: cannot read this file");
    check(&["--strategies", "best"], "write one of: auto, scored, frontier, columns, spiral, snail");
    check(
        &["--halls", "airport", "--strategies", "auto", "--against", "snail"],
        "the strategy snail is not compared; add snail to --strategies",
    );
    // The table says by itself what is asked.
    for flag in [["--goal", "cover"], ["--sonar", "1"], ["--costs", "1,0,0"], ["--against", "auto"], ["--tours", "x"]] {
        check(&flag, "--halls <HALLS>");
    }
    check(&["--count", "0"], "0 is not in 1..=100000");
}

/// The walks would take hours.
#[test]
fn a_file_that_cannot_be_written_is_refused_before_the_walks_and_older_ones_stay_as_they_are() {
    let folder = tempdir("evaluate-unwritable");
    let older = folder.join("older.csv");
    std::fs::write(&older, "of yesterday").expect("the folder of tests can be written");
    let older = older.display().to_string();
    let fresh = folder.join("fresh.csv").display().to_string();
    let walks = ["evaluate", "--halls", "luggage-10:200x200", "--count", "100000"];
    for (flags, path) in [
        (["--plot", &older, "--csv", "/nowhere/x.csv"], "/nowhere/x.csv"),
        (["--csv", &older, "--plot", "/nowhere/x.svg"], "/nowhere/x.svg"),
        (["--csv", &older, "--tours", "/dev/null/tours"], "/dev/null/tours"),
        (["--csv", &fresh, "--plot", "/nowhere/x.svg"], "/nowhere/x.svg"),
    ] {
        let output = run(&[&walks[..], &flags].concat());
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && error.contains(&format!("{path} cannot be written: ")), "{error}");
        assert_eq!(std::fs::read_to_string(&older).expect("it is there"), "of yesterday");
        assert!(!Path::new(&fresh).exists(), "an empty file is no result");
    }
}

#[test]
fn a_file_that_is_read_or_named_twice_is_not_written() {
    let folder = tempdir("evaluate-twice");
    let hall = folder.join("hall.map").display().to_string();
    std::fs::write(&hall, HALL).expect("the folder of tests can be written");
    let figures = folder.join("figures").display().to_string();
    for flags in [["evaluate", "--halls", &hall, "--csv", &hall], ["evaluate", "--csv", &figures, "--plot", &figures]] {
        let output = run(&flags);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains("is given twice"), "{error}");
    }
    assert_eq!(std::fs::read_to_string(&hall).expect("it is there"), HALL);
}

#[test]
fn tours_of_two_halls_of_one_name_are_two_pictures_in_a_folder_that_is_made() {
    let folder = tempdir("evaluate-tours");
    let hall = folder.join("seed.map").display().to_string();
    std::fs::write(&hall, HALL).expect("the folder of tests can be written");
    let tours = folder.join("tours/of/two");
    let halls = format!("seed,{hall}");
    evaluate(&["--halls", &halls, "--strategies", "auto", "--tours", &tours.display().to_string()]);
    let mut names: Vec<String> = std::fs::read_dir(&tours)
        .expect("it was made")
        .map(|entry| entry.expect("it can be read").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort_unstable();
    assert_eq!(names, ["auto-seed-2.svg", "auto-seed.svg"]);
}

/// A folder of this test's own.
fn tempdir(name: &str) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the folder of tests can be written");
    folder
}

#[test]
fn how_often_the_time_left_holds_is_told_for_each_family() {
    let table = evaluate(&["--time-left"]);
    assert_eq!(table.lines().filter(|line| line.contains(" %")).count(), 9, "{table}");
    let refused = run(&["evaluate", "--time-left", "--halls", "airport"]);
    assert_eq!(refused.status.code(), Some(2), "it has halls of its own");
}

/// As short as can be: what it writes can be read, names its flags, and is the same again.
#[test]
fn tune_writes_weights_that_are_the_same_again_and_says_at_once_where_it_cannot() {
    let folder = tempdir("tune");
    let tune = |name: &str, more: &[&str]| {
        let out = folder.join(name);
        let out = out.to_str().expect("a printable path");
        run(&[&["tune", "--generations", "1", "--rounds", "1", "--halls", "2", "--horizon", "20", "--out", out], more].concat())
    };
    for name in ["one", "two"] {
        assert!(tune(name, &["--goal", "find"]).status.success());
    }
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect("it was written");
    assert_eq!(read("one"), read("two"));
    assert!(
        read("one").starts_with("# What an unknown cell is worth to a search: hallsweep-evaluation tune --goal find --sonar 0")
    );
    let from = folder.join("one");
    assert!(tune("three", &["--from", from.to_str().expect("a printable path")]).status.success());
    assert_eq!(tune("no/such/folder", &[]).status.code(), Some(1));
    assert_eq!(tune("four", &["--goal", "win"]).status.code(), Some(2));
    assert_eq!(tune("four", &["--halls", "0"]).status.code(), Some(2));
}

#[test]
fn the_gain_by_areas_is_printed_with_its_halls_and_both_seeds() {
    let table = evaluate(&["--areas", "--seed", "7"]);
    for expect in
        ["luggage-10:50x50", "islands:50x50", "means of 4 halls each", "halls have seed 7", "tuned with halls of seed 1"]
    {
        assert!(table.contains(expect), "{expect}: {table}");
    }
    let refused = run(&["evaluate", "--areas", "--halls", "airport"]);
    assert_eq!(refused.status.code(), Some(2));
}
