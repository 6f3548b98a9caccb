//! Safety R1: the data folder of an earlier version opens, shows what that version showed, and can be continued.

use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::journal::journal;
use crate::kill::Folder;
use crate::program::{Program, hallsweep};

/// Path of a stored file of the earlier version.
fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/service/earlier").join(name)
}

/// Copy of the data folder of version 0.1.0.
pub(crate) fn copy(name: &str) -> Folder {
    copy_of("data", name)
}

fn copy_of(data: &str, name: &str) -> Folder {
    let folder = Folder::new(name);
    let copied = Command::new("cp").arg("-r").arg(kept(data).join(".")).arg(folder.path()).status();
    assert!(copied.expect("cp is there").success());
    folder
}

/// Folder of a version in which no judge could be unsure. It has keys, and a piece that waits for its verdict.
fn waiting(name: &str) -> Folder {
    let folder = copy_of("waiting/data", name);
    // The repository keeps no modes, and keys that others may read are refused.
    let private = Permissions::from_mode(0o600);
    std::fs::set_permissions(folder.path().join("access.toml"), private).expect("the file of the keys is there");
    folder
}

fn serve(folder: &Folder) -> Command {
    let serve = ["serve", "--http", "127.0.0.1:0", "--hall", "seed", "--seed", "7", "--speed", "max", "--data", folder.text()];
    let mut command = hallsweep(&serve);
    command.env("TZ", "UTC");
    command
}

/// Output of a command that reads a data folder or an archive.
fn said(data: &Path, arguments: &[&str]) -> String {
    let output = hallsweep(arguments).arg("--data").arg(data).env("TZ", "UTC").output().expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).expect("it speaks UTF-8")
}

/// Fails unless the command prints each line that the earlier version printed. Returns the number of further lines.
fn is_as_before(data: &Path, arguments: &[&str], file: &str) -> usize {
    let then = std::fs::read_to_string(kept(file)).expect("it was kept");
    let now = said(data, arguments);
    let differ = now.lines().zip(then.lines()).find(|(now, then)| now != then);
    assert_eq!(differ, None, "each line of {file} as it was");
    now.lines().count().checked_sub(then.lines().count()).unwrap_or_else(|| panic!("lines of {file} are missing"))
}

/// Fails unless a report of the earlier version agrees with this data folder or archive.
fn is_confirmed(data: &Path, report: &str) {
    let report = kept(report);
    let said = said(data, &["journal", "check", "--report", report.to_str().expect("a plain name")]);
    assert!(said.contains("is confirmed"), "{said}");
}

/// Waits until the state shows everything that the earlier version showed, compares the missions, and returns the state.
fn shows_as_much(program: &Program, file: &str) -> Value {
    let then: Value = serde_json::from_slice(&std::fs::read(kept(file)).expect("it was kept")).expect("it is JSON");
    let state = program.until("what it showed", |state| says_as_much(&without_revisions(state), &then["state"]));
    let missions = program.json("missions");
    assert!(says_as_much(&missions["missions"], &then["missions"]), "{missions:#}");
    state
}

/// Removes the revisions and the run, which differ at each start.
fn without_revisions(value: &Value) -> Value {
    match value {
        Value::Object(fields) => {
            let kept = fields.iter().filter(|(name, _)| !["revision", "run"].contains(&name.as_str()));
            kept.map(|(name, field)| (name.clone(), without_revisions(field))).collect()
        }
        Value::Array(list) => list.iter().map(without_revisions).collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => value.clone(),
    }
}

/// Whether `now` contains everything in `then`. `now` may contain more.
fn says_as_much(now: &Value, then: &Value) -> bool {
    match (now, then) {
        (Value::Object(now), Value::Object(then)) => {
            then.iter().all(|(name, field)| now.get(name).is_some_and(|now| says_as_much(now, field)))
        }
        (Value::Array(now), Value::Array(then)) => {
            now.len() == then.len() && now.iter().zip(then).all(|(now, then)| says_as_much(now, then))
        }
        (now, then) => now == then,
    }
}

#[test]
fn the_journal_of_an_earlier_version_is_sound_and_reads_as_it_did() {
    let folder = copy("earlier-journal");
    let (well, said) = journal(&folder, &["check"]);
    assert!(well, "{said}");
    assert_eq!(is_as_before(folder.path(), &["journal", "export"], "journal.jsonl"), 0, "and nothing more");
}

#[test]
fn a_data_folder_of_an_earlier_version_shows_what_it_showed_and_goes_on() {
    let folder = copy("earlier-data");
    let program = Program::started(serve(&folder).args(["--strategy", "scored"]));
    let state = shows_as_much(&program, "shown.json");
    assert!((1..=4).all(|number| program.read(&format!("/api/v1/luggage/{number}/photo"), &[]).status == 200));

    program.command("start").accepted();
    program.until_phase("bombLocated");
    let alarm = state["alarms"][0]["id"].as_u64().expect("an alarm with a number");
    program.post(&format!("/api/v1/alarms/{alarm}/acknowledge"), "").accepted();
    program.command("reset").accepted();
    assert_eq!(program.json("strategy")["name"], "snail", "as the folder has it, whatever the flag says");
    program.put("/api/v1/strategy", r#"{"name":"auto"}"#).accepted();
    program.command("start").accepted();
    assert_eq!(program.until_asked(), 5, "numbers go on where they were");
    drop(program);
    let (well, said) = journal(&folder, &["check"]);
    assert!(well, "{said}");
}

/// The reader of a report may ask for its confirmation years later.
#[test]
fn reports_of_every_edition_are_confirmed() {
    let folder = copy_of("reported/data", "earlier-reported");
    for report in ["reported/en.html", "reported/it.html"] {
        is_confirmed(folder.path(), report);
    }
}

/// The journal is of the last version that stored requests, refusals and causes as sentences. The sentences stay as
/// they are, and new entries use codes.
#[test]
fn sentences_of_an_earlier_version_say_what_they_said() {
    let folder = copy_of("sentences/data", "earlier-sentences");
    let data = folder.path();
    is_as_before(data, &["journal", "print"], "sentences/journal.txt");
    is_as_before(data, &["journal", "export"], "sentences/journal.jsonl");
    for mission in ["1", "2"] {
        let arguments = ["report", mission, "--format", "csv", "--language", "it"];
        is_as_before(data, &arguments, &format!("sentences/mission-{mission}.it.csv"));
    }

    let program = Program::started(&mut serve(&folder));
    program.until("it is linked", |state| !state["mission"]["holds"].to_string().contains("robotLink"));
    program.command("stop").accepted();
    let torn = program.post_with("/api/v1/commands/goto", &[("content-type", "application/json")], "{");
    assert!(torn.problem(400).contains("the body is not JSON"));
    // The answer is the same as before the restart.
    let again = program.post_with("/api/v1/commands/reset", &[("idempotency-key", "k-1")], "");
    assert!(again.problem(422).contains("the id k-1 was used before"));
    drop(program);
    let (well, checked) = journal(&folder, &["check"]);
    assert!(well, "{checked}");
    is_as_before(data, &["journal", "export"], "sentences/journal.jsonl");
    assert!(said(data, &["journal", "export"]).contains(r#""refused":{"code":"malformed","words":"the body is not JSON"#));
    for report in ["sentences/en.html", "sentences/it.html"] {
        is_confirmed(data, report);
    }
}

/// Today's state and missions have further fields, so both are compared by `says_as_much`. The export of these entries
/// has no further fields.
#[test]
fn keys_archive_reports_and_a_piece_that_waits_are_as_an_earlier_version_left_them() {
    let folder = waiting("earlier-waiting");
    let archive = kept("waiting/archived.hallsweep");
    let (well, checked) = journal(&folder, &["check", "--archive", archive.to_str().expect("a plain name")]);
    assert!(well && checked.contains("archives compared with the journal: 1: all is well"), "{checked}");
    assert_eq!(is_as_before(folder.path(), &["journal", "export"], "waiting/journal.jsonl"), 0);
    is_confirmed(folder.path(), "waiting/2.en.html");
    is_confirmed(&archive, "waiting/1.it.html");

    let program = Program::started(&mut serve(&folder));
    shows_as_much(&program, "waiting/shown.json");
    assert!((1..=3).all(|number| program.read(&format!("/api/v1/luggage/{number}/photo"), &[]).status == 200));
    drop(program);

    let program = Program::started(serve(&folder).env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true"));
    let keys = std::fs::read_to_string(kept("waiting/data/access.toml")).expect("it was kept");
    let tokens = keys.lines().filter_map(|line| line.strip_prefix("token = \"")?.strip_suffix('"'));
    let retrieve = |token| program.post_with("/api/v1/commands/retrieve", &[("authorization", &format!("Bearer {token}"))], "");
    let answers: Vec<u16> = tokens.map(|token| retrieve(token).status).collect();
    assert_eq!(answers, [409, 409, 409, 403], "three operators, who cannot fetch anything now, and a viewer");
}

#[test]
fn a_piece_that_waited_in_an_earlier_version_gets_answers_that_it_lacked() {
    let folder = waiting("earlier-answers");
    let program = Program::started(&mut serve(&folder));
    program.until("it is linked", |state| !state["mission"]["holds"].to_string().contains("robotLink"));
    let say = |piece: u64, answer: &str| program.post(&format!("/api/v1/luggage/{piece}/verdict"), answer).accepted();
    say(3, r#"{"verdict":"unsure","note":"a shadow","hidden":"cannotSay"}"#);
    program.command("start").accepted();
    program.until("photos from two other places", |state| {
        state["luggage"][0]["photo"]["take"] == 3 && state["mission"]["refusals"]["retake"].is_null()
    });
    say(3, r#"{"verdict":"danger","size":"suitcase","hidden":"yes","obvious":"no","typical":"no"}"#);
    program.until_phase("bombLocated");
    program.command("goOn").accepted();
    assert_eq!(program.until_asked(), 4, "the search went on");
    say(4, r#"{"verdict":"safe","hidden":"no","obvious":"no","typical":"yes"}"#);
    program.until_phase("bombLocated");
    let open = program.post("/api/v1/commands/close", r#"{"name":"Anna Rossi"}"#).problem(409);
    let seen = open.split("openPoints ").nth(1).expect("the refusal has the text to send");
    program.post("/api/v1/commands/close", &format!(r#"{{"name":"Anna Rossi","openPoints":{seen}}}"#)).accepted();
    let shown = |program: &Program| ["mission", "luggage"].map(|part| program.json("state")[part].clone());
    let [mission, luggage] = shown(&program);
    drop(program);

    let [after, luggage_after] = shown(&Program::started(&mut serve(&folder)));
    assert_eq!((&after["closed"], &after["closed"]["name"]), (&mission["closed"], &"Anna Rossi".into()));
    assert_eq!(luggage_after, luggage);
    let bomb = &luggage[0];
    assert_eq!((&bomb["decided"]["mandatoryM"], &bomb["unsure"][0]["note"]), (&46.into(), &"a shadow".into()), "{bomb}");
    let (well, checked) = journal(&folder, &["check"]);
    assert!(well, "{checked}");
    is_as_before(folder.path(), &["journal", "export"], "waiting/journal.jsonl");
    is_confirmed(folder.path(), "waiting/2.en.html");
}
