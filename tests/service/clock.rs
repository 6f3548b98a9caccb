//! Changes of the machine's clock while the program runs: a signed-in user can still stop the robot, and every
//! displayed duration is the real one. `libfaketime` sets the clock under the real program; the monotonic clock is
//! not changed.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::access::{Folder, sign_in};
use crate::journal::holds;
use crate::program::{Answer, Deadline, PATIENCE, Program};
use crate::third_party::left_out;

/// Folder below which Debian installs `libfaketime`, whatever the processor.
const LIBRARIES: &str = "/usr/lib";

/// Clock changes in seconds: back by ten minutes and by an hour, forward by a shift of 13 hours and by 30 days.
const SETS: [i64; 4] = [-600, -3600, 13 * 3600, 30 * 86_400];

/// Time that passes after each clock change, so that a duration that includes this time differs from one that does
/// not.
const A_WHILE: Duration = Duration::from_secs(4);

/// A folder of keys with a journal, and a clock that can be set.
struct Site {
    folder: Folder,
    library: PathBuf,
    clock: PathBuf,
    operator: String,
}

impl Site {
    fn new(name: &str) -> Option<Site> {
        let triplets = std::fs::read_dir(LIBRARIES).into_iter().flatten().flatten();
        let library = triplets.map(|entry| entry.path().join("faketime/libfaketimeMT.so.1")).find(|path| path.exists());
        let Some(library) = library else {
            left_out("HTTP", "libfaketime, of the package faketime");
            return None;
        };
        let folder = Folder::new(name);
        let clock = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("clock-{name}-{}", std::process::id()));
        folder.token(&["add", "lobby", "--role", "viewer"]);
        let site = Site { operator: folder.token_of("operator"), folder, library, clock };
        site.set(0);
        Some(site)
    }

    /// Sets the clock to this many seconds ahead of the real time.
    fn set(&self, seconds: i64) {
        let new = self.clock.with_extension("new");
        std::fs::write(&new, format!("{seconds:+}")).expect("it can be written");
        std::fs::rename(&new, &self.clock).expect("it can be put in place");
    }

    /// Command for a robot that needs longer to search its empty hall than any test takes.
    fn command(&self) -> Command {
        self.command_in("empty-8x8", "0.25")
    }

    fn command_in(&self, hall: &str, speed: &str) -> Command {
        let serve = ["serve", "--http", "127.0.0.1:0", "--hall", hall, "--seed", "1", "--speed", speed];
        let mut command = self.folder.command(&serve);
        command.env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true").env("LD_PRELOAD", &self.library);
        command.env("FAKETIME_TIMESTAMP_FILE", &self.clock).env("FAKETIME_NO_CACHE", "1");
        command.env("DONT_FAKE_MONOTONIC", "1").env("NO_FAKE_STAT", "1");
        command
    }
}

impl Drop for Site {
    fn drop(&mut self) {
        // A leftover file is harmless.
        let _ = std::fs::remove_file(&self.clock);
    }
}

struct Browser<'p> {
    program: &'p Program,
    cookie: String,
}

impl Browser<'_> {
    fn read(&self, path: &str) -> Answer {
        self.program.read(path, &[("cookie", &self.cookie)])
    }

    fn command(&self, name: &str) -> Answer {
        self.program.post_with(&format!("/api/v1/commands/{name}"), &[("cookie", &self.cookie)], "")
    }

    fn until(&self, wanted: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let deadline = Deadline::within(PATIENCE);
        loop {
            let state = self.read("/api/v1/state").json();
            if is_so(&state) {
                return state;
            }
            assert!(!deadline.has_passed(), "never came to be: {wanted}; the state is\n{state:#}");
            sleep(Duration::from_millis(20));
        }
    }

    /// Opens the console's event stream.
    fn watch(&self) -> BufReader<TcpStream> {
        let mut stream = TcpStream::connect(self.program.address()).expect("the program listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a time-out can be set");
        let (at, cookie) = (self.program.address(), &self.cookie);
        write!(stream, "GET /console/live HTTP/1.0\r\nHost: {at}\r\nCookie: {cookie}\r\n\r\n").expect("a question");
        BufReader::new(stream)
    }

    /// Value of the field with this name in the report of the first mission.
    fn report(&self, name: &str) -> Option<String> {
        let page = self.read("/missions/1/report?language=en").text();
        let (_, rest) = page.split_once(&format!("<dt>{name}</dt><dd>"))?;
        Some(rest.split('<').next().expect("there is a part before").to_owned())
    }
}

fn is_held(state: &Value) -> bool {
    holds(state, "operator")
}

/// Converts `1:02:03` or `2:03` to seconds.
fn seconds(shown: &str) -> u64 {
    shown.split(':').fold(0, |seconds, part| 60 * seconds + part.parse::<u64>().expect("a number"))
}

#[expect(clippy::disallowed_methods, reason = "what passed is compared with what is shown")]
fn now() -> Instant {
    Instant::now()
}

/// Whether the displayed number of whole seconds lies between `least` and the time since `since`.
fn has_passed(shown: u64, least: Duration, since: Instant) -> bool {
    (least.as_secs()..=now().duration_since(since).as_secs() + 1).contains(&shown)
}

/// Safety S8, A2, A3.
#[test]
fn whoever_is_signed_in_stops_and_starts_the_robot_and_sees_true_times_however_the_clock_is_set() {
    std::thread::scope(|scope| {
        let rows = SETS.map(|set| scope.spawn(move || under_a_clock_that_is_set_by(set)));
        rows.into_iter().for_each(|row| row.join().expect("the row holds"));
    });
}

fn under_a_clock_that_is_set_by(set: i64) {
    let Some(site) = Site::new(&format!("set{set}")) else { return };
    let program = Program::started(&mut site.command());
    let browser = Browser { program: &program, cookie: sign_in(&program, &site.operator) };
    browser.until("the robot is there", |state| !holds(state, "robotLink"));
    let began = now();
    browser.command("start").accepted();
    browser.until("it drives", |state| state["mission"]["phase"] == "exploring" && !is_held(state));
    let mut live = browser.watch();
    let wrong = || program.read("/api/v1/state", &[("authorization", "Bearer wrong")]).problem(401);
    (0..3).for_each(|_| drop(wrong()));
    site.set(set);
    sleep(A_WHILE);

    let stopped = browser.command("stop");
    assert_eq!(stopped.status, 200, "{set}: {}", stopped.text());
    browser.until("it is held", is_held);
    browser.command("start").accepted();
    browser.until("it goes on", |state| state["mission"]["phase"] == "exploring" && !is_held(state));
    let by_key = program.read("/api/v1/state", &[("authorization", &format!("Bearer {}", site.operator))]);
    assert_eq!(by_key.status, 200, "{set}");
    let refused = now();
    wrong();
    // The fourth wrong key is delayed by two seconds, unless the first three were forgotten.
    assert!(refused.elapsed() >= Duration::from_secs(2), "{set}: wrong keys were forgotten");
    // Events after the clock change arrive on the stream that was opened before the change.
    let mut line = String::new();
    while !line.contains("STOP, by operator") {
        line.clear();
        assert!(live.read_line(&mut line).expect("the stream lives") > 0, "{set}: the stream has ended");
    }
    let took = browser.report("Took (h:mm:ss)").expect("it says how long it took");
    assert!(has_passed(seconds(&took), A_WHILE, began), "{set}: took {took}");
    let clock = browser.report("The clock was changed").expect("it says that the clock was set");
    assert!(clock.starts_with("1 ×"), "{set}: {clock}");
}

/// Safety S8, V1.
#[test]
fn how_long_a_piece_waits_and_a_mission_lasts_is_what_passed_however_the_clock_is_set() {
    let Some(site) = Site::new("waits") else { return };
    let program = Program::started(&mut site.command_in("airport", "max"));
    let browser = Browser { program: &program, cookie: sign_in(&program, &site.operator) };
    browser.until("the robot is there", |state| !holds(state, "robotLink"));
    let began = now();
    browser.command("start").accepted();
    let pending =
        |state: &Value| state["luggage"].as_array().expect("a list").iter().find(|piece| piece["verdict"] == "pending").cloned();
    let id = pending(&browser.until("a piece waits", |state| pending(state).is_some())).expect("it was there")["id"].clone();
    for set in SETS {
        site.set(set);
        sleep(A_WHILE);
        // Both durations are updated even if the clock change is the only event.
        let page = browser.read("/").text();
        let shown = |before: &str, after: &str| {
            let (_, rest) = page.split_once(before).unwrap_or_else(|| panic!("{before} in {page}"));
            let (age, _) = rest.split_once(after).unwrap_or_else(|| panic!("{after} in {page}"));
            seconds(age.rsplit('>').next().expect("there is a part"))
        };
        let (waits, gone) = (shown("waiting for <b", "</b>"), shown("id=\"progress\"", "</b> elapsed"));
        assert!(has_passed(waits, A_WHILE, began), "{set}: waits {waits} s");
        assert!(has_passed(gone, A_WHILE, began), "{set}: {gone} s gone");
    }
    let headers = [("cookie", &*browser.cookie), ("content-type", "application/json")];
    program.post_with(&format!("/api/v1/luggage/{id}/verdict"), &headers, r#"{"verdict":"safe"}"#).accepted();
    let waited = browser.report("Decided after (h:mm:ss)").expect("it says how long that took");
    assert!(has_passed(seconds(&waited), 4 * A_WHILE, began), "decided after {waited}");
    assert!(browser.report("The clock was changed").is_some_and(|clock| clock.starts_with("4 ×")));
}

/// Safety A2.
#[test]
fn in_a_later_run_the_clock_says_whether_a_session_is_over_and_a_clock_set_back_meanwhile_is_on_record() {
    let Some(site) = Site::new("later") else { return };
    let program = Program::started(&mut site.command());
    let cookie = sign_in(&program, &site.operator);
    let (_, session) = cookie.split_once('=').expect("a name and a value");
    let browser = Browser { program: &program, cookie: cookie.clone() };
    browser.until("the robot is there", |state| !holds(state, "robotLink"));
    let began = now();
    browser.command("start").accepted();
    sleep(A_WHILE);
    // The answer to this command arrives only after the journal has stored the command.
    browser.command("start").accepted();
    drop(program);
    for (set, status) in [(11 * 3600, 200), (13 * 3600, 401), (-3600, 401), (0, 200)] {
        site.set(set);
        let again = Program::started(&mut site.command());
        let cookie = format!("hallsweep-{}={session}", again.address().port());
        let browser = Browser { program: &again, cookie };
        assert_eq!((browser.read("/api/v1/state").status, browser.command("stop").status), (status, status), "{set}");
        if set == 0 {
            let took = browser.report("Took (h:mm:ss)").expect("it says how long it took");
            assert!(has_passed(seconds(&took), A_WHILE, began), "what each run measured, and not what the clock says: {took}");
        }
    }
}

#[test]
fn two_runs_that_begin_in_the_same_millisecond_have_revisions_of_their_own() {
    let Some(site) = Site::new("twice") else { return };
    // In this format `libfaketime` stops the clock.
    std::fs::write(&site.clock, "2026-01-01 00:00:00").expect("it can be written");
    let run = || {
        let program = Program::started(&mut site.command());
        let state = program.read("/api/v1/state", &[("authorization", &format!("Bearer {}", site.operator))]);
        (state.json()["run"].clone(), state.header("etag").to_owned())
    };
    let (before, again) = (run(), run());
    assert!(before.0 != again.0 && before.1 != again.1, "{before:?} {again:?}");
}
