//! Disks that fail under the running program (safety R3): `strace` makes every flush fail, or hang, from the moment it attaches to
//! the moment it lets go. Without `strace` these tests are left out with a word, unless `HALLSWEEP_REQUIRE_CLIENTS` is set.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use serde_json::Value;

use crate::journal::{exported, holds, journal, of_kind, serve};
use crate::kill::Folder;
use crate::program::Program;

/// `strace` on a running program.
struct Fault(Child);

impl Fault {
    /// Lets every flush of the program meet with this, as `error=EIO`.
    fn inject(program: &Program, what: &str) -> Option<Fault> {
        let mut strace = Command::new("strace");
        let inject = format!("inject=fsync,fdatasync:{what}");
        strace.args(["-f", "-e", "trace=fsync,fdatasync", "-e", &inject, "-p", &program.id().to_string()]);
        let child = strace.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
        let attached = child.ok().and_then(|mut child| {
            let mut lines = BufReader::new(child.stderr.take().expect("it is a pipe")).lines();
            let attached = lines.by_ref().map_while(Result::ok).any(|line| line.contains("attached"));
            // The pipe stays open until the end, so that writing to it never fails.
            std::thread::spawn(move || lines.count());
            if attached {
                return Some(Fault(child));
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

    /// Lets go of the program.
    fn end(mut self) {
        let told = Command::new("kill").args(["-INT", &self.0.id().to_string()]).status();
        assert!(told.expect("kill is there").success());
        self.0.wait().expect("strace ends");
    }
}

/// When the program is gone `strace` is, too.
impl Drop for Fault {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A verdict meets with a disk that fails: it is not accepted and does not stand, reading goes on, nothing moves; once the disk is
/// well again everything goes on without a restart.
fn a_failing_disk(name: &str, what: &str, words: &str) {
    let folder = Folder::new(name);
    let program = serve(&folder);
    program.command("start").accepted();
    let piece = program.until_asked();
    let Some(fault) = Fault::inject(&program, what) else { return };
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

/// Safety R3, V3: the disk hangs for a minute; it is said after five seconds, and what the disk takes in the end is taken back.
#[test]
fn a_disk_that_hangs_is_not_waited_for() {
    a_failing_disk("store-hang", "delay_enter=60000000", "the disk does not answer");
}

/// Safety V3: killed while the flush of a verdict hangs, which was answered as not kept. The verdict does not stand after the
/// restart, although the system has written it, and another one can be given.
#[test]
fn a_verdict_that_was_not_kept_does_not_stand_after_a_kill_while_the_disk_hangs() {
    let folder = Folder::new("store-hang-kill");
    let program = serve(&folder);
    program.command("start").accepted();
    let piece = program.until_asked();
    let Some(fault) = Fault::inject(&program, "delay_enter=60000000") else { return };
    program.verdict(piece, "safe").problem(503);
    program.verdict(piece, "danger").problem(503);
    program.until("the store holds the robot", |state| holds(state, "store"));
    program.killer()();
    // Whoever is killed while it is traced is gone when its tracer is, which would wait until its minute is over.
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
