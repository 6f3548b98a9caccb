//! Exercises at the public doors: nothing tells which pieces are test pieces before their verdicts, everything says that
//! it is an exercise, and an exercise never mixes with a mission.

use std::time::Duration;

use serde_json::Value;

use crate::access::Folder;
use crate::coap::client::Coap;
use crate::coap_clients::ask::Ask;
use crate::coap_clients::client::Client::Libcoap;
use crate::mqtt_clients::client::Client;
use crate::mqtt_clients::running::RunningClient;
use crate::mqtt_clients::told::Hello;
use crate::program::{Program, hallsweep, run};

/// A seed that nothing else contains by chance.
const SEED: &str = "7261548390127456";

/// What can be read over CoAP, and what cannot.
const COAP: [&str; 15] = [
    ".well-known/core",
    "resourcemodel",
    "state",
    "strategy",
    "mission",
    "robot",
    "map",
    "luggage",
    "luggage/1",
    "temperature",
    "alarms",
    "retrieval",
    "log",
    "simulator",
    "simulator/hall",
];

fn text(folder: &Folder) -> &str {
    folder.path().to_str().expect("the path is text")
}

fn serve(folder: &Folder, more: &[&str]) -> Program {
    let mqtt = ["--mqtt", "127.0.0.1:0", "--coap", "127.0.0.1:0"];
    let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", "max", "--data", text(folder)];
    Program::started(&mut hallsweep(&[&arguments[..], &mqtt, more].concat()))
}

/// A data folder in which an exercise was started.
pub(crate) fn begun(name: &str) -> Folder {
    let folder = Folder::new(&format!("exercise-{name}"));
    drop(serve(&folder, &["--exercise", "3"]));
    folder
}

/// Starts the program, which must refuse to start, and returns why.
fn refusal(folder: &Folder, more: &[&str]) -> String {
    let arguments = ["serve", "--http", "127.0.0.1:0", "--coap", "none", "--mqtt", "none", "--data", text(folder)];
    let ended = run(&[&arguments[..], more].concat());
    assert_eq!(ended.status.code(), Some(2), "{more:?}");
    String::from_utf8_lossy(&ended.stderr).into_owned()
}

/// Everything that can be read over HTTP, each with its path.
fn all_routes(program: &Program) -> Vec<(String, String)> {
    let described = program.json("openapi.json");
    let paths = described["paths"].as_object().expect("the description has paths");
    let read = |(path, operations): (&String, &Value)| {
        // A stream has no end. The laboratory has a seed of its own.
        let is_left_out = operations.get("get").is_none() || path.contains("events") || path.contains("laboratory");
        (!is_left_out).then(|| {
            let path = path.replace("{id}", "1").replace("{name}", "airport");
            let answer = program.read(&path, &[]);
            let headers: String = answer.headers.values().map(|value| String::from_utf8_lossy(value.as_bytes())).collect();
            (path, format!("{headers} {}", answer.text()))
        })
    };
    let pages =
        ["/", "/missions", "/missions/1", "/missions/1/moment", "/luggage/1", "/simulator", "/simulator/editor", "/metrics"];
    let pages = pages.map(|path| (path.to_owned(), program.read(path, &[("accept", "text/html")]).text()));
    let events = ["/api/v1/missions/1/events", "/api/v1/missions/1/timeline?after=0"];
    let events = events.map(|path| (path.to_owned(), program.read(path, &[]).text()));
    paths.iter().filter_map(read).chain(pages).chain(events).collect()
}

/// The parts of a text that tell the truth about a piece, or from which it could be computed.
fn tells(path: &str, text: &str) -> Vec<&'static str> {
    let words = ["\"test\"", "\"truth\"", "dangerous = ", "\"revealed\"", "test piece\"", SEED];
    // The description names the field of pieces with a verdict.
    let is_description = path.contains("openapi");
    words.into_iter().filter(|word| text.contains(word) && !(is_description && *word == "\"test\"")).collect()
}

#[test]
fn no_door_tells_which_pieces_are_test_pieces_before_their_verdicts() {
    let folder = Folder::new("exercise-hidden");
    let program = serve(&folder, &["--exercise", "5", "--seed", SEED]);
    let mqtt =
        Client::Mosquitto.is_here().then(|| RunningClient::begin(Client::Mosquitto, &program, Hello::following(&["#"], 0)));
    program.command("start").accepted();
    let first = program.until_asked();
    for (path, text) in all_routes(&program) {
        assert_eq!(tells(&path, &text), [""; 0], "{path}: {text}");
        if path.contains("simulator") {
            assert!(text.contains("an exercise runs"), "{path}: {text}");
        }
    }
    for (method, path) in [("PUT", "/api/v1/simulator"), ("PUT", "/api/v1/simulator/hall"), ("POST", "/api/v1/simulator/step")] {
        assert_eq!(
            program.send(method, path, "application/json", r#"{"name":"seed"}"#).json()["code"],
            "exerciseRunning",
            "{path}"
        );
    }
    let mut coap = Coap::at(program.coap());
    let at = format!("coap://{}/", program.coap());
    for path in COAP {
        let mut text = coap.ask("GET", path, "").map(|reply| reply.text).unwrap_or_default();
        if Libcoap.is_here() {
            // This client reads all blocks of an answer.
            text += &Libcoap.ask(&at, &Ask::get(path)).all;
        }
        assert_eq!(tells(path, &text), [""; 0], "coap {path}: {text}");
    }
    let journal = run(&["journal", "export", "--data", text(&folder)]);
    assert!(journal.status.success(), "{journal:?}");
    let journal = String::from_utf8_lossy(&journal.stdout).into_owned();
    assert!(journal.contains("\"exercise\":true") && journal.contains("missionBegan"), "{journal}");
    assert_eq!(tells("journal", &journal), [""; 0]);
    if let Some(mqtt) = mqtt {
        mqtt.until("the piece", |heard| heard.iter().any(|message| message.topic.ends_with("state/luggage")).then_some(()));
        for message in mqtt.heard() {
            assert_eq!(tells(&message.topic, &message.payload), [""; 0], "{}: {}", message.topic, message.payload);
        }
        let luggage =
            mqtt.until_newest("hallsweep/discovery/state/luggage", "the piece", |message| message.payload.contains("\"id\""));
        assert!(luggage.payload.contains("\"exercise\":true"), "{}", luggage.payload);
    }

    // A verdict tells nothing either: whoever knows one piece and their number judges the others differently.
    program.verdict(first, "safe").accepted();
    program.until("another piece", |state| state["luggage"].as_array().is_some_and(|all| all.len() > 1));
    for (path, text) in all_routes(&program) {
        assert_eq!(tells(&path, &text), [""; 0], "{path}: {text}");
    }
}

#[test]
fn an_exercise_is_judged_by_key_and_marked_everywhere() {
    let folder = Folder::new("exercise-results");
    let program = serve(&folder, &["--exercise", "4", "--seed", SEED]);
    program.command("start").accepted();
    let mut judged = 0;
    loop {
        let state = program.until("a piece or the end", |state| {
            let is_asked = state["luggage"].as_array().is_some_and(|all| all.iter().any(|piece| piece["verdict"] == "pending"));
            is_asked && state["robot"]["state"] == "stopped"
                || ["explored", "bombLocated"].iter().any(|phase| state["mission"]["phase"] == *phase)
        });
        let pending = state["luggage"].as_array().and_then(|all| all.iter().find(|piece| piece["verdict"] == "pending"));
        let Some(piece) = pending else { break };
        assert_eq!(program.read("/api/v1/simulator", &[]).status, 409, "a piece waits: {judged} judged");
        let id = piece["id"].as_u64().expect("a number");
        program.verdict(id, if judged % 2 == 0 { "danger" } else { "safe" }).accepted();
        judged += 1;
    }
    let mission = program.json("missions/1");
    let pieces = mission["luggage"].as_array().expect("a list");
    let count = |is_test: bool, verdict: &str| {
        pieces.iter().filter(|piece| piece["test"] == is_test && piece["verdict"] == verdict).count()
    };
    assert_eq!(pieces.iter().filter(|piece| piece["test"] == true).count(), 4);
    let operator = &mission["exerciseResults"]["keys"][0];
    assert_eq!(operator["answers"], judged, "{mission}");
    for (field, is_test, verdict) in
        [("hits", true, "danger"), ("misses", true, "safe"), ("falseAlarms", false, "danger"), ("correctSafe", false, "safe")]
    {
        assert_eq!(operator[field], count(is_test, verdict), "{field}: {operator}");
    }
    assert!(operator["hitRate"].is_null() && operator["longestSeconds"].is_f64(), "four test pieces are too few: {operator}");

    assert_eq!(program.json("simulator")["seed"], SEED, "every piece has its verdict");
    assert_eq!(program.put("/api/v1/simulator", r#"{"paused":true}"#).json()["code"], "exerciseRunning");
    assert_eq!(program.json("mission")["exercise"], true);
    assert_eq!(program.json("missions")["missions"][0]["exercise"], true);
    for path in ["/", "/missions", "/missions/1", "/sign-in", "/api/v1/", "/nowhere"] {
        for (language, word) in [("en", ">EXERCISE<"), ("it", ">ESERCITAZIONE<")] {
            let page = program.read(path, &[("accept", "text/html"), ("accept-language", language)]).text();
            assert!(page.contains(word) || !page.contains("<html"), "{path}: {page}");
        }
    }
    for (language, word) in [("en", "<h1>EXERCISE · "), ("it", "<h1>ESERCITAZIONE · ")] {
        let report = program.read(&format!("/missions/1/report?language={language}"), &[]).text();
        assert!(report.contains(word), "{language}");
    }
}

#[test]
fn a_restart_continues_the_same_exercise_and_nothing_else() {
    let folder = Folder::new("exercise-again");
    let cells = |program: &Program| program.json("state")["luggage"].clone();
    let program = serve(&folder, &["--exercise", "6"]);
    program.command("start").accepted();
    let id = program.until_asked();
    program.command("stop").accepted();
    let before = cells(&program);
    program.killer()();
    drop(program);

    let robot = || std::fs::read(folder.path().join("simulated-robot.txt")).expect("it is there");
    let stands = robot();
    for (more, words) in [
        (&[][..], "--exercise 6 and without --seed"),
        (&["--exercise", "5"], "--exercise 6 and without --seed"),
        (&["--exercise", "6", "--seed", "1"], "--exercise 6 and without --seed"),
    ] {
        let why = refusal(&folder, more);
        assert!(why.contains("mission 1") && why.contains("is an exercise that is under way") && why.contains(words), "{why}");
        assert_eq!(robot(), stands, "a start that is refused moves no robot");
    }
    let program = serve(&folder, &["--exercise", "6"]);
    assert_eq!(cells(&program), before);
    program.verdict(id, "safe").accepted();
    program.command("reset").accepted();
    let judged = program.json("missions/1")["luggage"][0].clone();
    assert!(judged["test"].is_boolean(), "{judged}");
    assert_eq!(program.command("start").json()["code"], "exerciseOver");
    drop(program);

    let program = serve(&folder, &[]);
    assert_eq!(program.read("/api/v1/simulator", &[]).status, 200);
    assert_eq!(program.json("mission")["exercise"], Value::Null);
    assert_eq!(program.json("missions")["missions"][0]["exercise"], true, "the mission before stays an exercise");
    program.command("start").accepted();
    program.until_asked();
    drop(program);
    let why = refusal(&folder, &["--exercise", "6"]);
    assert!(why.contains("mission 2") && why.contains("it is no exercise: start hallsweep without --exercise"), "{why}");
}

#[test]
fn without_a_seed_every_exercise_is_another() {
    let seeds = ["one", "two"].map(|name| {
        let folder = begun(name);
        std::fs::read_to_string(folder.path().join("exercise.txt")).expect("it is kept")
    });
    assert_ne!(seeds[0], seeds[1]);
    assert!(seeds[0].starts_with("pieces 3\nseed "), "{seeds:?}");
}

#[test]
fn an_exercise_that_cannot_be_is_refused_in_words() {
    let folder = Folder::new("exercise-wrong");
    for (more, words) in [
        (&["--exercise", "101"][..], "from 0 to 100"),
        (
            &["--exercise", "3", "--robot", "line=localhost:9"],
            "an exercise is simulated, but the searching robot is of the kind line",
        ),
        (&["--exercise", "9", "--hall", "empty-8x8", "--start", "99,99"], "hall.start"),
    ] {
        let why = refusal(&folder, more);
        assert!(why.contains(words), "{why}");
    }
    let arguments = ["serve", "--http", "127.0.0.1:0", "--exercise", "3", "--data", text(&folder)];
    for (variable, value, key) in [
        ("HALLSWEEP__MISSION__AFTER_DANGER", "return", "mission.after_danger"),
        ("HALLSWEEP__MISSION__KEEP_OUT_M", "1", "mission.keep_out_m"),
        ("HALLSWEEP__MISSION__INSPECT_EVERYTHING", "true", "mission.inspect_everything"),
    ] {
        let ended = hallsweep(&arguments).env(variable, value).output().expect("it starts");
        let why = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.code() == Some(2) && why.contains(key) && why.contains("in an exercise"), "{why}");
    }
}

/// Whether a mission is an exercise is decided from the recalled state, also where another reader cannot open the journal.
#[test]
fn a_mission_of_an_old_journal_does_not_become_an_exercise() {
    let folder = crate::earlier::copy("exercise-old");
    let data = folder.text();
    std::fs::remove_file(folder.path().join("simulated-robot.txt")).expect("it was there");
    let ended = run(&["serve", "--http", "127.0.0.1:0", "--coap", "none", "--mqtt", "none", "--data", data, "--exercise", "3"]);
    let why = String::from_utf8_lossy(&ended.stderr);
    assert!(ended.status.code() == Some(2) && why.contains("is under way, and it is no exercise"), "{why}");
    assert!(!folder.path().join("exercise.txt").exists());
}

/// A journal that cannot be read now may be put back, so its exercise stays the same.
#[test]
fn an_exercise_survives_a_damaged_journal_and_ends_without_its_seed() {
    let folder = Folder::new("exercise-damaged");
    let mut program = serve(&folder, &["--exercise", "3"]);
    program.command("start").accepted();
    let id = program.until_asked();
    program.command("stop").accepted();
    program.signal("TERM");
    assert!(program.ended_within(Duration::from_secs(20)).is_some());
    let (journal, seed) = (folder.path().join("journal.db"), folder.path().join("exercise.txt"));
    let (sound, kept) = (std::fs::read(&journal).expect("it is there"), std::fs::read_to_string(&seed).expect("it is kept"));
    std::fs::write(&journal, b"no database").expect("it can be written");
    for more in [["--exercise", "3"], ["--exercise", "4"]] {
        drop(serve(&folder, &more));
        assert_eq!(std::fs::read_to_string(&seed).expect("it is kept"), kept, "{more:?}");
    }
    std::fs::write(&journal, sound).expect("it can be written");
    let program = serve(&folder, &["--exercise", "3"]);
    assert_eq!(program.json("luggage")[0]["id"], id);
    drop(program);

    std::fs::remove_file(&seed).expect("it was there");
    let why = refusal(&folder, &["--exercise", "3"]);
    assert!(why.contains("exercise.txt") && why.contains("--seed 1") && why.contains("simulated-robot.txt"), "{why}");
    std::fs::remove_file(folder.path().join("simulated-robot.txt")).expect("it was there");
    let program = serve(&folder, &["--exercise", "3", "--seed", "1"]);
    program.verdict(id, "danger").accepted();
    program.post("/api/v1/alarms/1/acknowledge", "").accepted();
    program.command("reset").accepted();
    let results = program.json("missions/1")["exerciseResults"]["keys"].clone();
    assert_eq!(results, serde_json::json!([]), "another seed tells nothing true");
}
