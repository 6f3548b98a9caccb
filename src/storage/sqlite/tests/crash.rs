//! Kills a program while its store writes, and checks that everything reported as stored is there (safety V3, D1,
//! D2). The child process runs this test program.

use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};

use super::super::{ReadOnlyJournal, open};
use super::testing::*;
use hallsweep_core::command::Verdict;
use hallsweep_core::units::Seq;

/// Environment variable with the child's folder. Without it, the test does nothing.
const FOLDER: &str = "HALLSWEEP_CRASH_FOLDER";

/// The child prints this before the number of each stored page.
const KEPT: &str = "kept ";

const KILLS: usize = 12;

/// Writes until it is killed, some pages with a photo, and reports what is stored.
#[test]
fn writes_until_it_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let mut scribe = Scribe::new(open(folder.as_ref(), None).expect("nobody else uses it"));
    let mut said = scribe.opened.store.word();
    let mut out = std::io::stderr();
    for number in scribe.until(|_| true).kept.0 + 1.. {
        let picture = (number % 5 == 0).then(|| photo(&format!("bag {number}").repeat(4000)));
        let last = scribe.hand(vec![found(number, picture), verdict(number, Verdict::Danger), wall(1, 1)]);
        // For every third page the child waits until the page is stored. The other pages are gathered into one
        // transaction.
        if number % 3 == 0 {
            scribe.until(|word| word.kept >= last);
        }
        if said.has_changed().unwrap_or(false) {
            let kept = said.borrow_and_update().kept;
            writeln!(out, "{KEPT}{kept}").expect("somebody listens");
        }
    }
}

#[test]
fn what_was_said_to_be_kept_outlives_a_kill() {
    let scratch = Scratch::new();
    let mut acknowledged = 0;
    for kill in 1..=KILLS {
        let mut child = Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "storage::sqlite::tests::crash::writes_until_it_is_killed", "--nocapture"])
            .env(FOLDER, scratch.data())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("this program starts again");
        let lines = BufReader::new(child.stderr.take().expect("it is a pipe")).lines();
        let said = lines.map_while(Result::ok).filter_map(|line| line.strip_prefix(KEPT)?.parse::<u64>().ok());
        acknowledged = said.take(7 * kill).last().expect("it keeps something");
        child.kill().expect("it is ours");
        child.wait().expect("it ends");

        let opened = scratch.open();
        let recalled = opened.recalled.expect("something was kept");
        assert!(recalled.written >= Seq(acknowledged), "{acknowledged} was said to be kept, {} is there", recalled.written);
        assert_eq!(recalled.written.0 % 3, 0, "a page is kept whole or not at all");
        drop((opened.store, opened.archive));
        let findings = ReadOnlyJournal::open(&scratch.data()).unwrap().check().unwrap();
        assert_eq!((findings.faults, findings.notes), (Vec::new(), Vec::new()), "after {kill} kills");
    }
    assert!(acknowledged > 0);
}
