//! Old missions in archives: written out by a command or at a start, held against the journal, reported, and served again.

use std::path::{Path, PathBuf};

use crate::journal::{journal, serve};
use crate::kill::Folder;
use crate::program::{Program, hallsweep};
use crate::third_party::{left_out, python, runs};

/// A mission that finds one bomb, and is put away.
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
        (["archive", "--before", "yesterday", "-o", text(&archive)], "a day belongs there, as 2026-01-31"),
        (["archive", "--before", "2999-01-01", "-o", text(beside.path())], "cannot be used"),
        (["archive", "--before", "2999-01-01", "-o", text(&folder.path().join("stops-2"))], "name one elsewhere"),
        (["archive", "--before", "2999-01-01", "-o", text(&folder.path().join("journal.db-journal"))], "name one elsewhere"),
    ] {
        let (well, said) = journal(&folder, &words);
        assert!(!well && said.contains(reason), "{said}");
    }
    let (well, said) = journal(&folder, &["archive", "--before", "2999-01-01", "-o", text(&archive)]);
    assert!(well && said.contains("missions 1 to 2, ") && said.contains("and were read again"), "{said}");
    let (well, said) = journal(&folder, &["check", "--archive", text(&archive)]);
    assert!(well && said.contains("old.hallsweep") && said.contains("held against the journal: 1: all is well"), "{said}");

    assert!(report(text(&archive), "1") == kept, "the report is the same from the archive");
    if runs(python().arg("--version")) || left_out("journal", "python3") {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/examples/chain.py");
        for journal in [folder.path().join("journal.db"), archive.clone()] {
            let output = python().arg(script).arg(&journal).output().expect("it runs");
            assert!(String::from_utf8_lossy(&output.stdout).starts_with("entry "), "{output:?}");
        }
    }
    for (data, output) in [(text(&archive), text(&archive)), (folder.text(), text(&folder.path().join("journal.db")))] {
        let before = std::fs::read(output).expect("it is there");
        let output_is = hallsweep(&["report", "3", "--data", data, "-o", output]).output().expect("the program starts");
        assert!(!output_is.status.success() && std::fs::read(output).expect("it is there") == before, "{output_is:?}");
    }
    let path = beside.path().join("report.html");
    std::fs::write(&path, &kept).expect("it can be written");
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

/// The journal of an earlier version, whose first mission was put away years before anybody reads this.
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
