//! Archives of old missions: written by a command or at a start, checked against the journal, reported, and served
//! again.

use std::io::Read;
use std::net::TcpListener;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::journal::{journal, serve};
use crate::kill::Folder;
use crate::program::{Program, hallsweep};
use crate::third_party::{left_out, patiently, python, runs};

/// Runs a mission that finds one bomb, and puts the mission away.
fn a_mission(program: &Program) {
    program.command("start").accepted();
    let piece = program.until_asked();
    program.verdict(piece, "danger").accepted();
    let state = program.until_phase("bombLocated");
    for alarm in state["alarms"].as_array().expect("a list") {
        program.press(&format!("/api/v1/alarms/{}/acknowledge", alarm["id"])).accepted();
    }
    program.command("reset").accepted();
}

fn end(mut program: Program) {
    program.signal("TERM");
    assert!(program.ended_within(std::time::Duration::from_secs(20)).is_some_and(|status| status.success()));
}

fn report(data: &str, mission: &str) -> Vec<u8> {
    let output = hallsweep(&["report", "--data", data, mission]).output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// Checks the chain of digests with `chain.py`, which shares no code with the program.
fn chain_holds(journals: &[&Path]) {
    if !runs(python().arg("--version")) && !left_out("journal", "python3") {
        return;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/examples/chain.py");
    for journal in journals {
        let output = python().arg(script).arg(journal).output().expect("it runs");
        assert!(String::from_utf8_lossy(&output.stdout).starts_with("entry "), "{output:?}");
    }
}

/// Runs `hallsweep journal` on an archive or a folder. Returns whether the command succeeded, and its output.
fn journal_of(data: &Path, words: &[&str]) -> (bool, String) {
    let output = hallsweep(&[&["journal", "--data", text(data)], words].concat()).output().expect("the program starts");
    (output.status.success(), String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned())
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a plain name")
}

#[test]
fn a_mission_that_was_archived_is_reported_held_against_the_journal_and_served_again() {
    let (folder, unpacked) = (Folder::new("archives"), Folder::new("archives-unpacked"));
    let program = serve(&folder);
    a_mission(&program);
    a_mission(&program);
    let beside = Folder::new("archives-beside");
    let archive = beside.path().join("old.hallsweep");
    let (well, said) = journal(&folder, &["archive", "--before", "2999-01-01", "-o", text(&archive)]);
    assert!(!well && said.contains("another hallsweep uses the folder"), "{said}");
    program.command("start").accepted();
    program.until_asked();
    let page = program.read("/missions/1", &[]).text();
    end(program);
    let kept = report(folder.text(), "1");

    for (words, reason) in [
        (["archive", "--before", "2000-01-01", "-o", text(&archive)], "no mission was put away before that day"),
        (["archive", "--before", "yesterday", "-o", text(&archive)], "write a day, such as 2026-01-31"),
        (["archive", "--before", "2999-01-01", "-o", text(beside.path())], "exists with other contents"),
        (["archive", "--before", "2999-01-01", "-o", text(&folder.path().join("stops-2"))], "choose a file in another folder"),
        (
            ["archive", "--before", "2999-01-01", "-o", text(&folder.path().join("journal.db-journal"))],
            "choose a file in another folder",
        ),
    ] {
        let (well, said) = journal(&folder, &words);
        assert!(!well && said.contains(reason), "{said}");
    }
    let (well, said) = journal(&folder, &["archive", "--before", "2999-01-01", "-o", text(&archive)]);
    assert!(well && said.contains("missions 1 to 2, ") && said.contains("and verified"), "{said}");
    let (well, said) = journal(&folder, &["check", "--archive", text(&archive)]);
    assert!(well && said.contains("old.hallsweep") && said.contains("compared with the journal: 1: all is well"), "{said}");

    assert!(report(text(&archive), "1") == kept, "the report is the same from the archive");
    chain_holds(&[&folder.path().join("journal.db"), &archive]);
    let (well, said) = journal_of(&archive, &["archive", "--before", "2999-01-01", "-o", text(&beside.path().join("new"))]);
    assert!(!well && said.contains("is an archive already: name the folder of a journal"), "{said}");
    for (data, output) in [(text(&archive), text(&archive)), (folder.text(), text(&folder.path().join("journal.db")))] {
        let before = std::fs::read(output).expect("it is there");
        let output_is = hallsweep(&["report", "3", "--data", data, "-o", output]).output().expect("the program starts");
        assert!(!output_is.status.success() && std::fs::read(output).expect("it is there") == before, "{output_is:?}");
    }
    let path = beside.path().join("report.html");
    std::fs::write(&path, &kept).expect("it can be written");
    let output = hallsweep(&["journal", "check", "--data", folder.text(), "--report", text(&path)]).output().expect("it starts");
    let said = String::from_utf8_lossy(&output.stderr);
    let advice = format!("mission 1 is in the archive {}", archive.file_name().expect("a file").to_string_lossy());
    assert!(!output.status.success() && said.contains(&advice) && said.contains("--data FILE --report"), "{said}");
    let output = hallsweep(&["journal", "check", "--data", text(&archive), "--report", text(&path)]).output().expect("it starts");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && said.contains("is confirmed"), "{said}");

    let program = serve(&folder);
    assert!(program.read("/missions/1/report", &[]).problem(404).contains("no mission 1"));
    assert_eq!(program.json("missions")["missions"].as_array().map(Vec::len), Some(1), "the one that goes on");
    let piece = program.until_asked();
    assert_eq!(piece, 3, "numbers go on");
    program.verdict(piece, "safe").accepted();
    drop(program);
    let (well, said) = journal(&folder, &["check"]);
    assert!(well, "{said}");

    let served = hallsweep(&["serve", "--data", text(&archive)]).output().expect("it starts");
    let said = String::from_utf8_lossy(&served.stderr);
    assert!(!served.status.success() && said.contains("hallsweep journal unpack"), "{said}");
    let (well, said) = journal(&unpacked, &["unpack", text(&archive)]);
    assert!(well, "{said}");
    let program = serve(&unpacked);
    assert!(program.read("/missions/1/report?language=en", &[]).body == kept);
    assert!(program.read("/missions/1", &[]).text() == page, "the page is as it was");
    assert_eq!(program.read("/missions/1/moment?at=20", &[]).status, 200, "and is played again");
}

/// The second archive, and the folder unpacked from it, do not contain the first mission.
#[test]
fn of_two_archives_in_a_row_both_become_folders_that_are_sound_and_served() {
    let (folder, beside) = (Folder::new("archives-row"), Folder::new("archives-row-beside"));
    let mut archives = Vec::new();
    for number in ["1", "2"] {
        let program = serve(&folder);
        a_mission(&program);
        end(program);
        let kept = report(folder.text(), number);
        let archive = beside.path().join(format!("{number}.hallsweep"));
        let (well, said) = journal(&folder, &["archive", "--before", "2999-01-01", "-o", text(&archive)]);
        assert!(well, "{said}");
        archives.push((number, archive, kept));
    }
    for (number, archive, kept) in &archives {
        let (unpacked, elsewhere) = (beside.path().join(number), Folder::new("archives-row-killed"));
        let (well, said) = journal_of(&unpacked, &["unpack", text(archive)]);
        assert!(well, "{said}");
        let (well, said) = journal_of(&unpacked, &["check", "--archive", text(archive)]);
        assert!(well && said.contains("compared with the journal: 1: all is well"), "{said}");
        assert_eq!(said.contains(&format!("unpacked from the archive {number}.hallsweep")), *number == "2", "{said}");
        chain_holds(&[&unpacked.join("journal.db")]);
        assert!(report(text(&unpacked), number) == *kept);
        let serve = ["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", "max", "--data", text(&unpacked)];
        let program = Program::with(&serve);
        assert!(program.read(&format!("/missions/{number}/report?language=en"), &[]).body == *kept);
        let (_, last) = journal_of(&unpacked, &["export", "--mission", number, "--last", "1"]);
        let last: serde_json::Value = serde_json::from_str(&last).expect("one line of JSON");
        let moment = format!("/missions/{number}/moment?at={}", last["seq"]);
        assert_eq!(program.read(&moment, &[]).status, 200, "it is played again");
        end(program);
        let (well, said) = journal_of(&unpacked, &["check", "--archive", text(archive)]);
        assert!(well, "{said}");
        unpack_killed_on_its_way(archive, &elsewhere.path().join("data"));
    }
}

/// Kills `journal unpack` at each of its renames. A killed run must leave nothing under the final name, and must be
/// repeatable.
fn unpack_killed_on_its_way(archive: &Path, data: &Path) {
    for rename in 1..10 {
        let inject = format!("inject=rename,renameat,renameat2:signal=SIGKILL:when={rename}");
        let unpack = hallsweep(&["journal", "unpack", text(archive), "--data", text(data)]);
        let Some(died) = killed_at(&unpack, &["-e", "trace=rename,renameat,renameat2", "-e", &inject]) else { return };
        if !died {
            assert!(rename > 2, "a photo and the folder are given their names");
            let (well, said) = journal_of(data, &["check", "--archive", text(archive)]);
            assert!(well, "{said}");
            return;
        }
        assert!(!data.exists(), "at {rename}");
    }
    panic!("it never came to its end");
}

/// Runs a command under `strace` with these arguments. Returns whether the command was killed, or `None` if `strace`
/// is missing.
fn killed_at(command: &Command, arguments: &[&str]) -> Option<bool> {
    let mut strace = Command::new("strace");
    if !runs(strace.args(["-f", "true"])) && !left_out("journal", "strace") {
        return None;
    }
    let mut strace = Command::new("strace");
    strace.args(["-f", "-o", "/dev/null"]).args(arguments).arg(command.get_program()).args(command.get_args());
    strace.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    let status = patiently(&strace).status().expect("it runs");
    assert!(status.success() || status.signal() == Some(9) || status.code() == Some(137), "{status:?}");
    Some(!status.success())
}

/// Uses the journal of an earlier version, whose first mission was put away long before any run of this test.
#[test]
fn at_a_start_missions_that_have_been_kept_long_enough_go_into_an_archive() {
    let folder = crate::earlier::copy("archives-keep");
    let serve = |days: &str| {
        let serve =
            ["serve", "--http", "127.0.0.1:0", "--hall", "seed", "--seed", "7", "--speed", "max", "--data", folder.text()];
        Program::started(hallsweep(&serve).env("HALLSWEEP__STORE__KEEP_DAYS", days))
    };
    let missions = |program: &Program| program.json("missions")["missions"].as_array().map(Vec::len);
    let program = serve("36500");
    assert_eq!(missions(&program), Some(2), "they are not so old");
    end(program);
    let program = serve("1");
    assert_eq!(missions(&program), Some(1));
    end(program);
    let archives: Vec<PathBuf> = std::fs::read_dir(folder.path().join("archives"))
        .expect("it was made")
        .map(|entry| entry.expect("it can be read").path())
        .collect();
    assert_eq!(archives.len(), 1);
    assert!(text(&archives[0]).contains("missions-1-to-1-"), "{archives:?}");
    let (well, said) = journal(&folder, &["check", "--archive", text(&archives[0])]);
    assert!(well, "{said}");
    assert!(!report(text(&archives[0]), "1").is_empty());
}

/// A folder with two missions, the first of which was put away long ago.
fn with_an_old_mission(name: &str) -> (Folder, impl Fn(&str, &str) -> Command) {
    let folder = crate::earlier::copy(name);
    let data = folder.text().to_owned();
    let serve = move |days: &str, http: &str| {
        let serve = ["serve", "--http", http, "--hall", "seed", "--seed", "7", "--speed", "max", "--data", &data];
        let mut serve = hallsweep(&serve);
        serve.env("HALLSWEEP__STORE__KEEP_DAYS", days);
        serve
    };
    end(Program::started(&mut serve("0", "127.0.0.1:0")));
    (folder, serve)
}

fn archives(folder: &Folder) -> Vec<(PathBuf, Vec<u8>)> {
    let there = std::fs::read_dir(folder.path().join("archives")).expect("it was made");
    let path = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("it can be read").path();
    there.map(path).map(|path| (path.clone(), std::fs::read(path).expect("it can be read"))).collect()
}

/// Safety S1: a program that has not opened its ports yet has promised nothing, so no STOP waits for an archive.
#[test]
fn old_missions_are_written_out_before_a_door_is_open() {
    let (folder, serve) = with_an_old_mission("archives-first");
    let taken = TcpListener::bind("127.0.0.1:0").expect("there is a port");
    let at = taken.local_addr().expect("it is bound").to_string();
    let output = patiently(&serve("1", &at)).output().expect("it runs");
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains(&at), "{output:?}");
    let archives = archives(&folder);
    assert_eq!(archives.len(), 1);
    let (well, said) = journal(&folder, &["check", "--archive", text(&archives[0].0)]);
    assert!(well, "{said}");
}

/// Kills the program after the archive is written, at the first write of the matching journal entry.
#[test]
fn killed_between_the_archive_and_the_journal_a_start_takes_the_archive_that_is_there() {
    let (folder, serve) = with_an_old_mission("archives-killed");
    let log = folder.path().join("journal.db-wal");
    let at = ["-P", text(&log), "-e", "trace=pwrite64", "-e", "inject=pwrite64:signal=SIGKILL:when=1"];
    for _ in 0..2 {
        let Some(died) = killed_at(&serve("1", "127.0.0.1:0"), &at) else { return };
        assert!(died);
        assert_eq!(archives(&folder).len(), 1, "one, however often");
        let (well, said) = journal(&folder, &["print", "--mission", "1", "--last", "1"]);
        assert!(well && !said.is_empty(), "all is still in the journal: {said}");
    }
    let written = archives(&folder);
    let program = Program::started(&mut serve("1", "127.0.0.1:0"));
    assert_eq!(program.json("missions")["missions"].as_array().map(Vec::len), Some(1));
    end(program);
    assert!(archives(&folder) == written);
    let (well, said) = journal(&folder, &["check", "--archive", text(&written[0].0)]);
    assert!(well, "{said}");
}

/// A slow reader allows an archiving run to happen between two parts of a report.
#[test]
fn a_report_whose_mission_is_written_out_meanwhile_does_not_end_as_if_it_were_whole() {
    let (folder, beside) = (Folder::new("archives-meanwhile"), Folder::new("archives-meanwhile-beside"));
    let program = serve(&folder);
    a_mission(&program);
    end(program);
    let mut command = hallsweep(&["report", "--data", folder.text(), "1", "-o", "-"]);
    let mut writing = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let mut page = writing.stdout.take().expect("it is a pipe");
    page.read_exact(&mut [0]).expect("it has begun");
    let archive = beside.path().join("a.hallsweep");
    std::fs::create_dir_all(beside.path()).expect("a folder");
    let (well, said) = journal(&folder, &["archive", "--before", "2999-01-01", "-o", text(&archive)]);
    assert!(well, "{said}");
    let mut rest = Vec::new();
    page.read_to_end(&mut rest).expect("it ends");
    let ended = writing.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&ended.stderr);
    assert!(!ended.status.success() && said.contains("was moved to an archive meanwhile"), "{said}");
}
