//! Disk faults under the running program (safety R3): `strace` makes every flush fail or hang while it is
//! attached, and lists the flushes with their order. Without `strace` these tests are skipped with a message, unless
//! `HALLSWEEP_REQUIRE_CLIENTS` is set.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use serde_json::Value;

use crate::journal::{exported, holds, journal, of_kind, serve};
use crate::kill::Folder;
use crate::program::Program;

/// `strace` attached to a running program.
struct Strace(Child);

impl Strace {
    /// Injects a fault, such as `error=EIO`, into every flush of the program.
    fn inject(program: &Program, what: &str) -> Option<Strace> {
        Strace::attach(program, &["-e", "trace=fsync,fdatasync", "-e", &format!("inject=fsync,fdatasync:{what}")])
    }

    /// Attaches `strace` with these arguments.
    fn attach(program: &Program, arguments: &[&str]) -> Option<Strace> {
        let mut strace = Command::new("strace");
        strace.arg("-f").args(arguments).args(["-p", &program.id().to_string()]);
        let child = strace.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
        let attached = child.ok().and_then(|mut child| {
            let mut lines = BufReader::new(child.stderr.take().expect("it is a pipe")).lines();
            let attached = lines.by_ref().map_while(Result::ok).any(|line| line.contains("attached"));
            // The pipe stays open until the end, so that the writes of `strace` never fail.
            std::thread::spawn(move || lines.count());
            if attached {
                return Some(Strace(child));
            }
            let _ = child.wait();
            None
        });
        let required = std::env::var_os("HALLSWEEP_REQUIRE_CLIENTS").is_some();
        assert!(attached.is_some() || !required, "strace cannot be used, and HALLSWEEP_REQUIRE_CLIENTS says that it must");
        if attached.is_none() {
            eprintln!("left out: this test needs strace, and the right to attach it");
        }
        attached
    }

    /// Detaches from the program.
    fn end(mut self) {
        let told = Command::new("kill").args(["-INT", &self.0.id().to_string()]).status();
        assert!(told.expect("kill is there").success());
        self.0.wait().expect("strace ends");
    }
}

/// Kills `strace` if it is still attached.
impl Drop for Strace {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Sends a verdict during a disk fault: the verdict is not accepted and not shown, reads work, and nothing moves.
/// After the fault everything works again without a restart.
fn a_failing_disk(name: &str, what: &str, words: &str) {
    let folder = Folder::new(name);
    let program = serve(&folder);
    program.command("start").accepted();
    let piece = program.until_asked();
    let Some(fault) = Strace::inject(&program, what) else { return };
    program.verdict(piece, "safe").problem(503);
    let state = program.until("the store holds the robot", |state| holds(state, "store"));
    assert!(state.to_string().contains(words), "{state:#}");
    assert_eq!(program.read(&format!("/api/v1/luggage/{piece}/photo"), &[]).status, 200, "reading goes on");
    program.command("start").problem(409);
    program.command("stop").accepted();
    fault.end();
    let state = program.until("the store writes again", |state| !holds(state, "store"));
    assert!(holds(&state, "awaitingStart"), "the end of the fault alone moves nothing: {state:#}");
    let lines = exported(&folder);
    assert_eq!(of_kind(&lines, "verdict").len(), 0, "what was refused does not stand");

    program.verdict(piece, "safe").accepted();
    program.command("start").accepted();
    program.until_asked();
    let lines = exported(&folder);
    let verdicts = of_kind(&lines, "verdict");
    assert_eq!((verdicts.len(), &verdicts[0]["luggage"]), (1, &Value::from(piece)));
    drop(program);
    let (well, checked) = journal(&folder, &["check"]);
    assert!(well && checked.contains("were lost while the store could not write"), "{checked}");
}

/// Safety R3, V3.
#[test]
fn an_io_error_on_flush_holds_the_robot_and_loses_nothing_that_was_acknowledged() {
    a_failing_disk("store-eio", "error=EIO", "the disk reports an error");
}

/// Safety R3, V3: the disk hangs for a minute. The fault is reported after five seconds, and the entry that the disk
/// finally writes is withdrawn.
#[test]
fn a_disk_that_hangs_is_not_waited_for() {
    a_failing_disk("store-hang", "delay_enter=60000000", "the disk does not answer");
}

/// Safety V3: the program is killed while the flush of a verdict hangs, after the answer that the verdict was not
/// stored. After the restart the verdict is not there, although the system has written it, and another one can be
/// given.
#[test]
fn a_verdict_that_was_not_kept_does_not_stand_after_a_kill_while_the_disk_hangs() {
    let folder = Folder::new("store-hang-kill");
    let program = serve(&folder);
    program.command("start").accepted();
    let piece = program.until_asked();
    let Some(fault) = Strace::inject(&program, "delay_enter=60000000") else { return };
    program.verdict(piece, "safe").problem(503);
    program.verdict(piece, "danger").problem(503);
    program.until("the store holds the robot", |state| holds(state, "store"));
    program.killer()();
    // A killed process remains until its tracer has gone, and `strace` would wait for the end of the delayed flush.
    drop(fault);
    drop(program);

    let program = serve(&folder);
    assert_eq!(program.json(&format!("luggage/{piece}"))["verdict"], "pending");
    assert_eq!(program.until_asked(), piece);
    assert_eq!(of_kind(&exported(&folder), "verdict").len(), 0, "what was refused does not stand");
    program.verdict(piece, "danger").accepted();
    program.killer()();
    drop(program);
    let program = serve(&folder);
    assert_eq!(program.json(&format!("luggage/{piece}"))["verdict"], "danger");
    drop(program);
    let (well, checked) = journal(&folder, &["check"]);
    assert!(well, "{checked}");
}

/// Safety D3, V3: the file and the directory entries of a photo are flushed, in this order, before the entry that
/// names the photo.
#[test]
fn a_photo_is_whole_on_the_disk_before_an_entry_names_it() {
    let folder = Folder::new("photo-flushed");
    let program = serve(&folder);
    let log = std::path::Path::new(folder.text()).join("calls.txt");
    let calls = ["-y", "-e", "trace=fsync,fdatasync,rename,renameat,renameat2", "-o", &log.display().to_string()];
    let Some(strace) = Strace::attach(&program, &calls) else { return };
    program.command("start").accepted();
    program.until_asked();
    strace.end();
    let lines = exported(&folder);
    let digest = of_kind(&lines, "luggage")[0]["picture"]["digest"].as_str().expect("a photo was taken").to_owned();
    let (shelf, name) = digest.split_at(2);
    let log = std::fs::read_to_string(&log).expect("strace has written it");
    let mut calls = log.lines();
    for (call, of) in [
        ("sync(", format!("/photos/{shelf}/{name}.unfinished>")),
        ("rename", format!("/photos/{shelf}/{name}.png\"")),
        ("sync(", format!("/photos/{shelf}>")),
        ("sync(", "/photos>".to_owned()),
        ("sync(", format!("{}>", folder.text())),
        ("sync(", "/journal.db-wal>".to_owned()),
    ] {
        assert!(calls.any(|line| line.contains(call) && line.contains(&of)), "no {call} of {of} in its turn:\n{log}");
    }
}

/// Safety V3: the end of a loss is flushed before it is reported. Otherwise, after a power cut, the next start would
/// withdraw entries that were stored since. One flush fails in this test.
#[test]
fn the_end_of_a_loss_is_flushed() {
    let folder = Folder::new("loss-flushed");
    let program = serve(&folder);
    program.command("start").accepted();
    let piece = program.until_asked();
    let log = std::path::Path::new(folder.text()).join("calls.txt");
    let fails_once = ["-y", "-e", "trace=fsync,fdatasync", "-e", "inject=fsync,fdatasync:error=EIO:when=1"];
    let Some(strace) = Strace::attach(&program, &[&fails_once[..], &["-o", &log.display().to_string()]].concat()) else { return };
    program.verdict(piece, "safe").problem(503);
    program.until("the store writes again", |state| !holds(state, "store"));
    strace.end();
    let log = std::fs::read_to_string(&log).expect("strace has written it");
    assert!(log.lines().any(|line| line.contains("sync(") && line.contains("/journal.lost>")), "{log}");
}

/// Safety S1, R3: a separate thread writes `journal.head`, and nothing waits for it. An outdated `journal.head` does
/// not prevent a start.
#[test]
fn a_disk_that_hangs_at_the_head_of_the_journal_holds_nobody_up() {
    let folder = Folder::new("head-hang");
    let program = serve(&folder);
    let head = folder.path().join("journal.head");
    let path = head.to_str().expect("a plain name");
    let Some(fault) = Strace::attach(&program, &["-P", path, "-e", "trace=write", "-e", "inject=write:delay_enter=60000000"])
    else {
        return;
    };
    let before = std::fs::read(&head).expect("it was written");
    program.command("start").accepted();
    let piece = program.until_asked();
    program.verdict(piece, "safe").accepted();
    program.command("stop").accepted();
    let state = program.until("it stands", |state| state["robot"]["state"] == "stopped");
    assert!(!holds(&state, "store"), "{state:#}");
    assert!(std::fs::read(&head).expect("it is there") == before, "it is behind: the disk hangs there");
    program.killer()();
    drop(fault);
    drop(program);
    let program = serve(&folder);
    assert_eq!(program.json(&format!("luggage/{piece}"))["verdict"], "safe");
    drop(program);
    assert!(std::fs::read(&head).expect("it is there") != before, "it is written again");
    let (well, checked) = journal(&folder, &["check"]);
    assert!(well, "{checked}");
}
