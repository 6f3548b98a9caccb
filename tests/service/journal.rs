//! `hallsweep journal`: the record of a mission is printed, exported, checked and repaired, while the program runs or
//! after it has ended.

use std::path::Path;

use serde_json::Value;

use crate::coap::client::Coap;
use crate::kill::Folder;
use crate::mqtt_attacks::client::Client;
use crate::mqtt_attacks::packets::connect;
use crate::program::{Program, hallsweep};
use crate::third_party::{left_out, python, runs};

/// Runs `hallsweep journal` on a folder. Returns whether the command succeeded, and its output.
pub(crate) fn journal(folder: &Folder, words: &[&str]) -> (bool, String) {
    let output = hallsweep(&[&["journal", "--data", folder.text()], words].concat()).output().expect("the program starts");
    let said = [output.stdout, output.stderr].concat();
    (output.status.success(), String::from_utf8(said).expect("it speaks UTF-8"))
}

/// Entries of the journal, as JSON.
pub(crate) fn exported(folder: &Folder) -> Vec<Value> {
    let (well, text) = journal(folder, &["export"]);
    assert!(well, "{text}");
    text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"))).collect()
}

/// Starts the program in the airport with this folder, and waits until its robot is linked.
pub(crate) fn serve(folder: &Folder) -> Program {
    let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", "max", "--data", folder.text()];
    let program = Program::with(&arguments);
    program.until("the robot is there", |state| !holds(state, "robotLink"));
    program
}

/// Whether this hold is set.
pub(crate) fn holds(state: &Value, hold: &str) -> bool {
    let holds = state["mission"]["holds"].as_array().expect("the holds are a list");
    holds.iter().any(|held| held == hold)
}

pub(crate) fn of_kind<'a>(lines: &'a [Value], kind: &str) -> Vec<&'a Value> {
    lines.iter().filter(|line| line["kind"] == kind).collect()
}

#[test]
fn what_was_noted_with_a_verdict_is_never_markup_and_outlives_the_program() {
    let folder = Folder::new("journal-notes");
    let program = serve(&folder);
    program.command("start").accepted();
    let id = program.until_asked();
    let give = |note: &str| {
        let body = serde_json::json!({"verdict": "safe", "note": note}).to_string();
        program.post(&format!("/api/v1/luggage/{id}/verdict"), &body)
    };
    assert!(give(&"x".repeat(1_000_000)).problem(413).contains("larger"));
    assert!(give(&"x".repeat(501)).problem(422).contains("501 characters: the limit is 500"));
    assert!(give("a\u{0}b").problem(422).contains("invisible"));
    assert!(program.json(&format!("luggage/{id}"))["decided"].is_null(), "nothing of that was a verdict");
    give(" <script>alert(1)</script> ").accepted();
    give("another").accepted();
    drop(program);
    let program = serve(&folder);
    let record = program.json(&format!("luggage/{id}"));
    assert_eq!(record["decided"]["note"], "<script>alert(1)</script>");
    for page in ["/".to_owned(), format!("/luggage/{id}"), "/missions/1".to_owned()] {
        let page = program.read(&page, &[("accept", "text/html")]).text();
        assert!(page.contains("&#60;script&#62;alert(1)") && !page.contains("<script>alert"), "{page}");
    }
    drop(program);
    let lines = exported(&folder);
    let verdicts = of_kind(&lines, "verdict");
    assert_eq!((verdicts.len(), &verdicts[0]["note"]), (1, &"<script>alert(1)</script>".into()));
    let (well, said) = journal(&folder, &["check"]);
    assert!(well, "{said}");
}

/// Safety S1, A6: at every interface that supports command ids, for accepted and refused commands. A malformed
/// command does not use up its id, and a STOP halts each time.
#[test]
fn a_command_that_comes_again_under_its_own_id_makes_no_second_entry() {
    let folder = Folder::new("journal-repeats");
    let program = serve(&folder);
    let commands = [("temperature", "{\"status\":\"ok\"}"), ("retrieve", "{}"), ("temperature", "{\"status\":\"lukewarm\"}")];
    let by_http = |path: &str, id: &str, body: &str| {
        let method = if path.ends_with("temperature") { "PUT" } else { "POST" };
        program.try_ask(method, &format!("/api/v1/{path}"), id, body).expect("it answers").text()
    };
    let mut coap = Coap::at(program.coap());
    let mut by_coap = |path: &str, id: &str, body: &str| {
        let method = if path == "temperature" { "PUT" } else { "POST" };
        coap.ask(method, &format!("{path}?id={id}"), body).expect("it answers").text
    };
    let mut mqtt = Client::try_connect(program.mqtt(), &connect("again", 60)).expect("it is let in");
    mqtt.subscribe("hallsweep/discovery/command/+/result", 1);
    let mut by_mqtt = |name: &str, id: &str, body: &str| {
        let body = body.replacen('{', &format!("{{\"id\":\"{id}\"{}", if body == "{}" { "" } else { "," }), 1);
        mqtt.publish(&format!("hallsweep/discovery/command/{name}"), body.as_bytes());
        String::from_utf8(mqtt.message().payload).expect("JSON is text")
    };
    for (number, (name, body)) in commands.into_iter().enumerate() {
        let path = if name == "temperature" { name.to_owned() } else { format!("commands/{name}") };
        let answers = [(); 2].map(|()| {
            [
                by_http(&path, &format!("http-{number}"), body),
                by_coap(&path, &format!("coap-{number}"), body),
                by_mqtt(name, &format!("mqtt-{number}"), body),
            ]
        });
        assert_eq!(answers[0], answers[1], "it is answered as before");
    }
    for _ in 0..2 {
        by_http("commands/stop", "http-stop", "{}");
        by_coap("commands/stop", "coap-stop", "{}");
        by_mqtt("stop", "mqtt-stop", "{}");
    }
    assert_eq!(program.json("state")["mission"]["epoch"], 6);
    // The answer to this command arrives only after the journal has stored it and all earlier commands.
    program.put("/api/v1/temperature", "{\"celsius\":20}").accepted();
    let lines = exported(&folder);
    let mut entries = of_kind(&lines, "command");
    entries.pop();
    for door in ["http", "coap", "mqtt"] {
        let of_door = entries.iter().filter(|entry| entry["door"] == door).map(|entry| &entry["id"]);
        let named = |name: &str| Value::from(format!("{door}-{name}"));
        let expected = [named("0"), named("1"), Value::Null, Value::Null, named("stop")];
        assert!(of_door.eq(&expected), "{door}: {entries:#?}");
    }
}

#[test]
fn what_happened_is_printed_exported_and_checked_beside_the_running_program() {
    let folder = Folder::new("journal");
    let mut program = serve(&folder);
    program.command("start").accepted();
    let piece = program.until_asked();
    program.verdict(piece, "danger").accepted();
    program.verdict(piece, "safe").problem(409);

    let lines = exported(&folder);
    assert!(lines.iter().zip(1..).all(|(line, place)| line["seq"] == place), "the entries follow one another");
    assert!(lines.iter().all(|line| line["at"].as_str().is_some_and(|at| at.starts_with("20"))), "each says when");
    assert_eq!(of_kind(&lines, "verdict")[0]["verdict"], "danger");
    assert_eq!(of_kind(&lines, "luggage")[0]["picture"]["mediaType"], "image/png");
    let refused: Vec<_> = of_kind(&lines, "command").into_iter().filter(|line| !line["refused"].is_null()).collect();
    assert_eq!((refused.len(), &refused[0]["from"]), (1, &Value::from("127.0.0.1")), "{refused:?}");

    let (_, printed) = journal(&folder, &[]);
    assert!(printed.contains(&format!("verdict on luggage #{piece}: danger, by")), "{printed}");
    let (_, last) = journal(&folder, &["print", "--last", "2"]);
    assert_eq!(last.lines().count(), 2, "{last}");
    let (_, none) = journal(&folder, &["print", "--mission", "7"]);
    assert_eq!(none, "");
    let (well, checked) = journal(&folder, &["check"]);
    assert!(well && checked.contains("all is well"), "{checked}");
    let (well, refused) = journal(&folder, &["rebuild"]);
    assert!(!well && refused.contains("another hallsweep uses the folder"), "{refused}");

    program.signal("TERM");
    assert!(program.ended_within(std::time::Duration::from_secs(20)).is_some_and(|status| status.success()));
    let (well, rebuilt) = journal(&folder, &["rebuild"]);
    assert!(well && rebuilt.contains("were rebuilt"), "{rebuilt}");
    let (well, checked) = journal(&folder, &["check"]);
    assert!(well, "{checked}");
}

#[test]
fn a_check_that_finds_something_says_so_and_fails() {
    let folder = Folder::new("journal-check");
    let (well, said) = journal(&folder, &["check"]);
    assert!(!well && said.contains("there is no journal in"), "{said}");
    let program = serve(&folder);
    program.command("start").accepted();
    program.until_asked();
    drop(program);
    std::fs::remove_dir_all(Path::new(folder.text()).join("photos")).expect("there are photos");
    let (well, said) = journal(&folder, &["check"]);
    assert!(!well && said.contains("is missing") && said.contains("backup"), "{said}");
}

/// The check is a program that shares no code with ours.
#[test]
fn the_chain_of_digests_is_what_the_documentation_says_that_it_is() {
    if !runs(python().arg("--version")) && !left_out("journal", "python3") {
        return;
    }
    let folder = Folder::new("journal-chain");
    let mut program = serve(&folder);
    program.command("start").accepted();
    let piece = program.until_asked();
    let note = serde_json::json!({"verdict": "danger", "note": "wires – \"red\" \\ é 🧳"}).to_string();
    program.post(&format!("/api/v1/luggage/{piece}/verdict"), &note).accepted();
    let head = || {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/examples/chain.py");
        let output = python().arg(script).arg(Path::new(folder.text()).join("journal.db")).output().expect("it runs");
        String::from_utf8([output.stdout, output.stderr].concat()).expect("it speaks UTF-8")
    };
    assert!(head().starts_with("entry "), "beside the running program: {}", head());
    program.signal("TERM");
    assert!(program.ended_within(std::time::Duration::from_secs(20)).is_some_and(|status| status.success()));
    let kept = std::fs::read_to_string(Path::new(folder.text()).join("journal.head")).expect("it is there");
    let (seq, digest) = kept.strip_prefix("entry ").and_then(|kept| kept.split_once(' ')).expect("an entry and its digest");
    assert_eq!(head(), format!("entry {} {digest}", seq.trim_start_matches('0')));
}

#[test]
fn two_programs_never_share_a_folder() {
    let folder = Folder::new("journal-shared");
    let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8", "--data", folder.text()];
    let _first = Program::with(&arguments);
    let second = hallsweep(&arguments).output().expect("the program starts");
    let said = String::from_utf8_lossy(&second.stderr);
    assert!(!second.status.success() && said.contains(folder.text()) && said.contains("--data"), "{said}");
}
