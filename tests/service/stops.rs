//! Safety S4: an answered STOP survives the program, even if the journal cannot store it. The data folder is on a
//! small file system in memory that the test mounts and fills, which needs root. Without root these tests are skipped
//! with a message.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::journal::{holds, serve};
use crate::kill::Folder;
use crate::program::Program;

/// File system in memory of one MiB, mounted over a folder and unmounted when the test ends.
struct Disk<'a>(&'a Folder);

impl Disk<'_> {
    fn mount(folder: &Folder) -> Option<Disk<'_>> {
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", "size=1024k,mode=700", "tmpfs", folder.text()]);
        if mount.stderr(Stdio::null()).status().is_ok_and(|status| status.success()) {
            return Some(Disk(folder));
        }
        let required = std::env::var_os("HALLSWEEP_REQUIRE_CLIENTS").is_some();
        assert!(!required, "nothing can be mounted, and HALLSWEEP_REQUIRE_CLIENTS says that it must");
        eprintln!("left out: this test mounts a disk in memory, for which it must be root");
        None
    }

    fn fill(&self) {
        // The write fails in the end, which is the purpose.
        let _ = std::fs::write(self.filler(), vec![0; 2 * 1024 * 1024]);
    }

    fn make_room(&self) {
        std::fs::remove_file(self.filler()).expect("it was filled");
    }

    fn filler(&self) -> std::path::PathBuf {
        Path::new(self.0.text()).join("filler")
    }
}

impl Drop for Disk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").args(["--lazy", self.0.text()]).status();
    }
}

/// Sends STOP and returns the new epoch.
fn stop(program: &Program) -> u64 {
    let answer = program.command("stop");
    answer.accepted();
    answer.json()["epoch"].as_u64().expect("an answer names the epoch")
}

/// Fails unless this STOP holds the robot, and a START from before it is refused as outdated.
fn check_stands(program: &Program, epoch: u64) {
    let state = program.json("state");
    assert!(state["mission"]["epoch"].as_u64() >= Some(epoch), "epoch {epoch} was answered: {state:#}");
    assert!(holds(&state, "operator"), "{state:#}");
    let late = program.post("/api/v1/commands/start", &format!("{{\"epoch\":{}}}", epoch - 1));
    late.problem(409);
    assert_eq!(late.json()["code"], "outdated");
}

#[test]
fn a_stop_that_a_full_disk_kept_from_the_journal_stands_after_a_kill() {
    let folder = Folder::new("stops-full");
    let Some(disk) = Disk::mount(&folder) else { return };
    let program = serve(&folder);
    program.command("start").accepted();
    stop(&program);
    disk.fill();
    let mut epoch = stop(&program);
    program.until("the journal cannot be written", |state| holds(state, "store"));
    let kept = program.send("PUT", "/api/v1/simulator/halls/mine", "application/toml", "width = 2\nheight = 2\n");
    assert_eq!(kept.json()["code"], "storeDown", "no hall changes without a word on record");
    assert_eq!(program.delete("/api/v1/simulator/halls/mine").json()["code"], "storeDown");
    epoch = stop(&program).max(epoch);
    program.killer()();
    drop(program);

    let program = serve(&folder);
    check_stands(&program, epoch);
    program.killer()();
    drop(program);
    disk.make_room();

    let program = serve(&folder);
    check_stands(&program, epoch);
    program.until("the journal is written", |state| !holds(state, "store"));
    program.post("/api/v1/commands/start", &format!("{{\"epoch\":{epoch}}}")).accepted();
    program.killer()();
    drop(program);
    let state = serve(&folder).json("state");
    assert!(!holds(&state, "operator"), "what a START has cleared does not come back: {state:#}");
    assert_eq!(state["mission"]["epoch"], epoch);
}

#[test]
fn a_stop_stands_although_the_journal_was_taken_away() {
    let folder = Folder::new("stops-alone");
    let program = serve(&folder);
    let epoch = stop(&program);
    program.killer()();
    drop(program);
    for name in ["journal.db", "journal.db-wal", "journal.db-shm"] {
        let _ = std::fs::remove_file(Path::new(folder.text()).join(name));
    }
    check_stands(&serve(&folder), epoch);
}
