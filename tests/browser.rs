//! The operator's console in a real browser: headless Chromium presses the buttons of the real program. The scripts
//! in `browser/` check what a person sees; this file starts the program, and stops it when a script asks.
//!
//! Without Chromium, node or playwright-core the tests print a note and pass; with `HALLSWEEP_REQUIRE_CLIENTS=1` they
//! fail.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread::sleep;
use std::time::Duration;

#[path = "../benches/common/coap.rs"]
#[expect(dead_code, reason = "a browser test observes nothing over CoAP")]
mod coap;
#[path = "browser/nginx.rs"]
mod nginx;
#[path = "service/program.rs"]
#[expect(dead_code, reason = "the service tests ask the program more than a browser test does")]
mod program;

use coap::Coap;
use nginx::{NGINX, Nginx};
use program::{Deadline, Program, hallsweep};

/// Limits the tests to one browser at a time, because two would slow each other down on a small machine.
static BROWSER: Mutex<()> = Mutex::new(());

/// Silence after which a script counts as hung. A script prints each of its steps, and each wait in a step ends after
/// a minute.
const SILENCE: Duration = Duration::from_secs(300);

/// Time for a script to close its browser after it was told to end.
const GRACE: Duration = Duration::from_secs(10);

/// Interval between checks whether a script has ended.
const GLANCE: Duration = Duration::from_millis(5);

/// Path of Debian's package.
const CHROMIUM: &str = "/usr/bin/chromium";

/// Lines with which a script asks this test to kill, start, freeze or thaw the program.
const KILL: &str = "please kill the program";
const START: &str = "please start the program";
const FREEZE: &str = "please freeze the program";
const THAW: &str = "please thaw the program";

/// Prefix of a script's request over CoAP, such as `PUT resourcemodel h`.
const COAP: &str = "over CoAP: ";

#[test]
fn the_components_of_the_pages_are_seen_side_by_side() {
    play("components", &["--hall", "empty-8x8"]);
}

#[test]
fn a_person_searches_the_airport() {
    play("mission", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn a_person_searches_the_airport_on_a_phone() {
    play("phone", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn a_person_searches_the_airport_in_italian_and_reads_no_english() {
    play("italian", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn a_person_searches_the_airport_without_scripts() {
    play("plain", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn a_person_watches_the_laboratory_and_halts_the_hall_from_there() {
    for scenario in ["laboratory", "laboratoryOnPhone", "laboratoryPlain", "laboratoryCalm"] {
        play(scenario, &["--hall", "empty-8x8"]);
    }
}

#[test]
fn a_person_looks_closely_and_gives_verdicts_with_notes_by_keys_and_without_scripts() {
    for scenario in ["verdictKeys", "verdictOnPhone", "notePlain"] {
        play(scenario, &["--hall", "airport", "--speed", "max"]);
    }
}

#[test]
fn a_question_that_somebody_else_overtakes_closes_and_the_page_says_who_judged_how_and_when() {
    play("overtaken", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn nothing_is_pressed_through_what_lies_over_the_page_and_escape_takes_it_away() {
    play("covers", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn a_person_draws_a_hall_by_pointer_or_by_keys_and_has_it_searched() {
    for scenario in ["hallByPointer", "hallByKeys", "hallsOpened", "hallsJudged"] {
        play(scenario, &["--hall", "empty-8x8", "--speed", "max"]);
    }
}

#[test]
fn a_person_keeps_halls_under_names_and_loses_none_by_one_press() {
    for scenario in ["hallsKept", "hallsKeptPlain", "hallAreas"] {
        let data = Data::new(scenario);
        play(scenario, &["--hall", "empty-8x8", "--data", &data.0]);
    }
}

#[test]
fn a_person_who_looks_elsewhere_is_called_only_when_it_was_switched_on() {
    play("called", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn a_bomb_makes_the_page_the_incident_with_its_circle_of_evacuation() {
    for scenario in ["incident", "incidentOnPhone"] {
        play_with(scenario, &["--hall", "airport", "--speed", "max"], &[("HALLSWEEP__CONSOLE__EVACUATION_M", "3")]);
    }
}

#[test]
fn a_person_stops_the_time_of_the_simulator_and_lets_things_fail() {
    for scenario in ["simulatorControls", "simulatorOnPhone", "simulatorPlain"] {
        play(scenario, &["--hall", "empty-8x8", "--speed", "max"]);
    }
}

/// Requirements R-reachBag and R-bagAtHome, with one STOP and one lost parcel on the way.
#[test]
fn a_person_has_the_dangerous_bag_fetched_and_looks_at_it_again() {
    for scenario in ["retrieval", "retrievalOnPhone", "retrievalPlain"] {
        play_with(scenario, &["--hall", "seed", "--speed", "6"], &[("HALLSWEEP__PAIR__SLIPS", "1")]);
    }
}

#[test]
fn a_person_watches_a_pair_carry_parcels_in_the_laboratory() {
    for scenario in ["pallets", "palletsOnPhone", "palletsPlain"] {
        play(scenario, &["--hall", "empty-8x8"]);
    }
}

#[test]
fn stop_halts_the_robot_at_once_and_start_goes_on() {
    play("stop", &["--hall", "empty-8x8", "--speed", "4"]);
}

/// Sprint 3 of the original: START and STOP on the page change the CoAP resource, and the page shows the same state.
#[test]
fn the_page_and_coap_show_the_same_and_take_the_same_commands() {
    play("besideCoap", &["--hall", "empty-8x8", "--speed", "1"]);
}

#[test]
fn a_lost_connection_is_said_and_the_page_catches_up() {
    play("lost", &["--hall", "empty-8x8", "--speed", "1"]);
}

#[test]
fn every_other_page_has_the_bar_which_follows_and_says_when_nothing_answers() {
    play("elsewhere", &["--hall", "empty-8x8", "--speed", "1"]);
}

#[test]
fn the_controls_stay_where_they_are_whatever_arrives() {
    play("steady", &["--hall", "airport", "--speed", "20"]);
}

#[test]
fn stop_is_one_press_away_while_a_question_is_open() {
    play("question", &["--hall", "airport", "--speed", "3"]);
}

#[test]
fn stop_is_one_press_away_while_a_question_is_open_on_a_phone() {
    play("questionOnPhone", &["--hall", "airport", "--speed", "3"]);
}

#[test]
fn a_stop_that_is_not_confirmed_is_said_to_be_so() {
    play("hung", &["--hall", "empty-8x8", "--speed", "1"]);
}

/// Safety S10.
#[test]
fn what_is_said_when_nothing_answers_covers_neither_stop_nor_photo_nor_question() {
    play("said", &["--hall", "airport", "--speed", "max"]);
}

/// Safety S10.
#[test]
fn a_stop_that_is_not_confirmed_stays_so_until_the_connection_stands_and_is_sent_then() {
    play("unconfirmed", &["--hall", "empty-8x8", "--speed", "1"]);
}

/// Safety S1.
#[test]
fn stop_halts_where_its_script_did_not_arrive() {
    play("halfLoaded", &["--hall", "airport", "--speed", "1"]);
}

#[test]
fn nothing_on_the_console_moves_away_from_under_a_pointer() {
    play("unmoved", &["--hall", "airport", "--speed", "10"]);
}

/// Safety S1, S10.
#[test]
fn stop_is_on_every_page_on_every_screen_at_any_scroll() {
    play("reach", &["--hall", "airport", "--speed", "max"]);
}

/// Safety S1.
#[test]
fn stop_is_on_every_page_without_scripts_and_halts() {
    play("reachPlain", &["--hall", "airport", "--speed", "max"]);
}

/// Safety S1.
#[test]
fn stop_is_on_the_part_of_a_page_that_two_fingers_have_made_larger() {
    play("magnified", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn the_robot_is_drawn_where_it_is() {
    play("drawn", &["--hall", "empty-8x8", "--speed", "10"]);
}

#[test]
fn the_keyboard_is_where_the_next_act_is() {
    play("keyboard", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn any_moment_of_a_mission_is_shown_again_as_it_was_shown_then() {
    play("replayed", &["--hall", "airport", "--speed", "20"]);
}

#[test]
fn the_past_is_dragged_stepped_and_played_and_only_stop_can_be_pressed_there() {
    play("past", &["--hall", "airport", "--speed", "20"]);
}

#[test]
fn without_scripts_a_mission_is_looked_at_again_entry_by_entry() {
    play("pastPlain", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn the_report_of_a_mission_is_saved_from_its_page_and_prints_by_itself() {
    play("report", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn the_hall_is_looked_at_from_near_and_a_free_cell_offers_the_way_there() {
    play("lens", &["--hall", "airport", "--speed", "20"]);
}

#[test]
fn of_hundreds_of_pieces_none_is_drawn_over_another_on_any_screen() {
    let row = |shelves: bool| if shelves { format!(".{}", ("T".repeat(11) + "...").repeat(10)) } else { ".".repeat(141) };
    play_in("warehouse", &octile((0..51).map(|y| row(y % 7 == 3))));
}

#[test]
fn in_a_hall_of_a_thousand_cells_a_side_only_what_changed_is_sent() {
    // One corridor that goes back and forth, so that the robot has seen all of it within seconds.
    let row = |y: usize| match (y % 20, y / 20 % 2) {
        (0, _) => ".".repeat(1000),
        (_, 0) => "@".repeat(999) + ".",
        (_, _) => ".".to_owned() + &"@".repeat(999),
    };
    play_in("thousand", &octile((0..1000).map(row)));
}

#[test]
fn two_fingers_lead_closer_to_the_hall() {
    play("pinched", &["--hall", "airport"]);
}

/// Map file in the format of public grid maps.
fn octile(rows: impl Iterator<Item = String>) -> String {
    let rows: Vec<String> = rows.collect();
    format!("type octile\nheight {}\nwidth {}\nmap\n{}\n", rows.len(), rows[0].len(), rows.join("\n"))
}

/// Plays a scenario in this hall at full speed.
fn play_in(scenario: &str, map: &str) {
    let Data(folder) = &Data::new(scenario);
    std::fs::create_dir_all(folder).expect("a folder of ours");
    let hall = format!("{folder}/{scenario}.map");
    std::fs::write(&hall, map).expect("it can be written");
    play(scenario, &["--hall", &hall, "--speed", "max"]);
}

#[test]
fn every_page_in_every_state_is_for_everybody() {
    play("accessible", &["--hall", "airport", "--speed", "max"]);
}

#[test]
fn people_sign_in_and_a_viewer_can_only_stop() {
    play_with_keys("signedIn", play_with, &[]);
}

#[test]
fn nothing_in_the_bar_is_cut_or_lies_over_anything_in_any_language_at_any_width() {
    play_with_keys("barWhole", play_with, &[]);
}

#[test]
fn people_sign_in_on_a_phone_and_a_viewer_can_only_stop() {
    play_with_keys("signedInOnPhone", play_with, &[]);
}

#[test]
fn a_person_orders_areas_and_closes_one_by_keys_by_dragging_and_without_scripts() {
    let areas = [("hall", "0.1", "[0, 0], [4, 9]"), ("gate 2", "0.5", "[9, 0], [15, 5]")];
    let polygon = ("bar & <b>", "0.05", "[7, 7], [12, 7], [12, 9], [8, 9]");
    let area = |(name, probability, corners)| {
        format!("[[area]]\nname = \"{name}\"\nprobability = {probability}\ncorners = [{corners}]\n")
    };
    let areas: String = areas.into_iter().chain([polygon]).map(area).collect();
    for scenario in ["areasByKeys", "areasOnPhone", "areasPlain", "coverageLayer"] {
        let Data(folder) = &Data::new(scenario);
        std::fs::create_dir_all(folder).expect("a folder of ours");
        let hall = format!("{folder}/areas.toml");
        std::fs::write(&hall, format!("width = 16\nheight = 10\n{areas}")).expect("it can be written");
        play(scenario, &["--hall", &hall, "--speed", "2"]);
    }
}

#[test]
fn two_people_judge_apart_and_two_bombs_are_found_and_fetched() {
    let settings = [
        ("HALLSWEEP__MISSION__SAFE_BY", "2"),
        ("HALLSWEEP__MISSION__KEEP_OUT_M", "1.5"),
        ("HALLSWEEP__MQTT__REQUIRE_PASSWORD", "true"),
    ];
    play_with_keys("judges", play_with, &settings);
}

/// Safety S1: under a prefix STOP is posted to the program, with scripts and without.
#[test]
fn under_a_prefix_stop_halts_from_every_page() {
    play_under_a_prefix("stop", &["--hall", "empty-8x8", "--speed", "4"], &[]);
    play_under_a_prefix("reachPlain", &["--hall", "airport", "--speed", "max"], &[]);
    play_under_a_prefix("unconfirmed", &["--hall", "empty-8x8", "--speed", "1"], &[]);
}

#[test]
fn under_a_prefix_missions_are_searched_looked_at_again_and_reported() {
    for (scenario, speed) in [("mission", "max"), ("plain", "max"), ("past", "20"), ("pastPlain", "max"), ("report", "max")] {
        play_under_a_prefix(scenario, &["--hall", "airport", "--speed", speed], &[]);
    }
}

#[test]
fn under_a_prefix_simulator_editor_and_laboratory_are_at_hand() {
    for scenario in ["simulatorControls", "simulatorPlain", "hallByPointer", "laboratory", "laboratoryPlain"] {
        play_under_a_prefix(scenario, &["--hall", "empty-8x8", "--speed", "max"], &[]);
    }
}

#[test]
fn under_a_prefix_people_sign_in_and_out() {
    play_with_keys("signedIn", play_under_a_prefix, &[]);
}

/// Function that plays a scenario: its name, and the arguments and the environment of the program.
type Play = fn(&str, &[&str], &[(&str, &str)]);

/// Plays a scenario against a program that requires keys; the script gets the keys of two operators and of a viewer.
fn play_with_keys(scenario: &str, play: Play, settings: &[(&str, &str)]) {
    let Data(data) = &Data::new(scenario);
    let add = |name: &str, role: &str| {
        let added = hallsweep(&["token", "--data", data, "add", name, "--role", role]).output().expect("the program starts");
        String::from_utf8(added.stdout).expect("text")
    };
    let shown = add("lobby", "viewer") + &add("second", "operator");
    let key = |name: &str| {
        let (_, its) = shown.split_once(name).expect("a key of this name");
        its.split_once("?token=").and_then(|(_, rest)| rest.lines().next()).expect("a link").to_owned()
    };
    let (operator, second, viewer) = (key("operator ("), key("second ("), key("lobby ("));
    let environment = [
        ("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true"),
        ("OPERATOR", operator.as_str()),
        ("SECOND", &second),
        ("VIEWER", &viewer),
        ("DATA", data),
        ("PROGRAM", env!("CARGO_BIN_EXE_hallsweep")),
    ];
    let environment = [&environment, settings].concat();
    play(scenario, &["--hall", "airport", "--speed", "max", "--data", data], &environment);
}

struct Data(String);

impl Data {
    fn new(scenario: &str) -> Data {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("browser-{scenario}-{}", std::process::id()));
        Data(folder.display().to_string())
    }
}

impl Drop for Data {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Plays a scenario of `browser/` against a program with these arguments.
fn play(scenario: &str, arguments: &[&str]) {
    play_with(scenario, arguments, &[]);
}

/// Plays a scenario with this environment for the program and the script.
fn play_with(scenario: &str, arguments: &[&str], environment: &[(&str, &str)]) {
    play_at(scenario, arguments, environment, false);
}

/// Plays a scenario behind a proxy that serves the program under a prefix.
fn play_under_a_prefix(scenario: &str, arguments: &[&str], environment: &[(&str, &str)]) {
    play_at(scenario, arguments, environment, true);
}

fn play_at(scenario: &str, arguments: &[&str], environment: &[(&str, &str)], is_under_a_prefix: bool) {
    let Some(scripts) = clients(is_under_a_prefix) else { return };
    let _alone = BROWSER.lock().unwrap_or_else(PoisonError::into_inner);
    let start = |http: &str| {
        let arguments = [&["serve", "--http", http, "--seed", "1"], arguments].concat();
        Program::started(hallsweep(&arguments).envs(environment.iter().copied()))
    };
    let mut program = Some(start("127.0.0.1:0"));
    let address = program.as_ref().map(Program::address).expect("it was just started").to_string();
    let nginx = is_under_a_prefix.then(|| Nginx::before(&address, scenario));
    let url = nginx.as_ref().map_or_else(|| format!("http://{address}"), Nginx::url);
    let script = Command::new("node")
        .arg(scripts.join("play.mjs"))
        .args([scenario, &url, CHROMIUM])
        .envs(environment.iter().copied())
        .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("node starts");
    let mut script = Script(script);
    let mut told = script.0.stdin.take().expect("standard input is a pipe");
    let said = script.said();
    let mut last = String::from("nothing");
    loop {
        let line = match said.recv_timeout(SILENCE) {
            Ok(line) => line,
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
            Err(mpsc::RecvTimeoutError::Timeout) => panic!("the scenario `{scenario}` hangs; the last it said is: {last}"),
        };
        last.clone_from(&line);
        match line.as_str() {
            KILL => program = None,
            START => program = Some(start(&address)),
            FREEZE => program.iter().for_each(|program| program.signal("STOP")),
            THAW => program.iter().for_each(|program| program.signal("CONT")),
            other => match other.strip_prefix(COAP) {
                Some(request) => {
                    writeln!(told, "{}", over_coap(program.as_ref().expect("it runs"), request)).expect("the script listens");
                    continue;
                }
                None => {
                    eprintln!("{other}");
                    continue;
                }
            },
        }
        writeln!(told, "done").expect("the script listens");
    }
    let ended = script.ended_within(SILENCE);
    assert!(ended.is_some(), "the scenario `{scenario}` does not end; the last it said is: {last}");
    assert!(ended == Some(true), "the scenario `{scenario}` failed; screenshots are in target/tmp/browser");
    assert!(program.is_some(), "the program was there to the end");
    if let Some(nginx) = nginx {
        nginx.carries_mqtt();
        nginx.was_asked_within_its_prefix();
    }
}

/// A running script, which is ended with its browser when this value is dropped.
struct Script(Child);

impl Script {
    /// Lines that the script prints.
    fn said(&mut self) -> mpsc::Receiver<String> {
        let pipe = BufReader::new(self.0.stdout.take().expect("standard output is a pipe"));
        let (say, said) = mpsc::channel();
        std::thread::spawn(move || pipe.lines().map_while(Result::ok).all(|line| say.send(line).is_ok()));
        said
    }

    /// Whether the script succeeded; `None` if it has not ended in time.
    fn ended_within(&mut self, patience: Duration) -> Option<bool> {
        let deadline = Deadline::within(patience);
        loop {
            if let Some(status) = self.0.try_wait().expect("the script is ours") {
                return Some(status.success());
            }
            if deadline.has_passed() {
                return None;
            }
            sleep(GLANCE);
        }
    }
}

impl Drop for Script {
    fn drop(&mut self) {
        if matches!(self.0.try_wait(), Ok(Some(_))) {
            return;
        }
        // The script closes its browser when it gets SIGTERM.
        let _ = Command::new("kill").arg(self.0.id().to_string()).status();
        if self.ended_within(GRACE).is_none() {
            let _ = self.0.kill();
            let _ = self.0.wait();
        }
    }
}

/// Sends a request such as `PUT resourcemodel h`; returns the answer as `2.05 TEXT` in one line.
fn over_coap(program: &Program, request: &str) -> String {
    let mut words = request.splitn(3, ' ');
    let mut next = || words.next().unwrap_or_default();
    let (method, path, payload) = (next(), next(), next());
    let reply = Coap::at(program.coap()).ask(method, path, payload).expect("the door answers");
    format!("{} {}", reply.code, reply.text.replace('\n', " "))
}

/// Folder of the scripts; `None` after a printed note when something that they need is missing.
fn clients(with_nginx: bool) -> Option<PathBuf> {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser");
    let node = Command::new("node").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    let missing = if !Path::new(CHROMIUM).exists() {
        "Chromium (apt-get install chromium)"
    } else if !node.is_ok_and(|status| status.success()) {
        "node (apt-get install nodejs npm)"
    } else if !scripts.join("node_modules/playwright-core").exists() {
        "playwright-core (npm --prefix tests/browser ci)"
    } else if with_nginx && !Path::new(NGINX).exists() {
        "nginx (apt-get install nginx)"
    } else {
        return Some(scripts);
    };
    let required = std::env::var("HALLSWEEP_REQUIRE_CLIENTS").is_ok_and(|value| value == "1");
    assert!(!required, "the browser tests need {missing}");
    // Written directly, because the test harness would capture the output.
    writeln!(std::io::stderr(), "the browser test is left out: it needs {missing}").expect("standard error is open");
    None
}
