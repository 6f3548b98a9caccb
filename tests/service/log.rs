//! Safety S11: whatever happens to the log, standard output or the terminal, the program works, ends in order and
//! loses no robot.

use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, PipeReader, PipeWriter, Write, pipe};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::mpsc;
use std::thread::sleep;
use std::time::Duration;

use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
use serde_json::Value;

use crate::access::Folder;
use crate::journal::holds;
use crate::line_robots::Emulator;
use crate::program::{Answer, Deadline, PATIENCE, Program, hallsweep};

/// Longest time for an orderly end on an overloaded machine.
const PROMISED: Duration = Duration::from_secs(15);

/// Interval between two checks of an awaited condition.
const GLANCE: Duration = Duration::from_millis(5);

/// State of the reading end of a stream.
#[derive(Clone, Copy, Debug)]
enum Fate {
    Read,
    ReaderGone,
    DiskFull,
    ReaderHangs,
}

impl Fate {
    const TROUBLE: [Fate; 3] = [Fate::ReaderGone, Fate::DiskFull, Fate::ReaderHangs];

    /// A stream in this state, and the reader that must be kept while the stream is in use.
    fn stream(self) -> (Stdio, Option<PipeReader>) {
        let (reader, writer) = pipe().expect("the system gives pipes");
        match self {
            Fate::Read => (Stdio::null(), None),
            Fate::ReaderGone => (writer.into(), None),
            Fate::DiskFull => (File::options().write(true).open("/dev/full").expect("Linux has it").into(), None),
            Fate::ReaderHangs => (filled(writer).into(), Some(reader)),
        }
    }
}

/// Fills a pipe, so that the next write blocks.
fn filled(mut pipe: PipeWriter) -> PipeWriter {
    let flags = fcntl_getfl(&pipe).expect("it is open");
    fcntl_setfl(&pipe, flags | OFlags::NONBLOCK).expect("it is ours");
    for size in [4096, 1] {
        while pipe.write(&vec![b'.'; size]).is_ok() {}
    }
    assert_eq!(pipe.write(b".").expect_err("it is full").kind(), ErrorKind::WouldBlock);
    fcntl_setfl(&pipe, flags).expect("it is ours");
    pipe
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([format!("-{name}"), child.id().to_string()]).status();
    assert!(sent.expect("kill is there").success());
}

fn ended(child: &mut Child) -> Option<ExitStatus> {
    let deadline = Deadline::within(PROMISED);
    while !deadline.has_passed() {
        if let Some(status) = child.try_wait().expect("the child is ours") {
            return Some(status);
        }
        sleep(GLANCE);
    }
    None
}

/// A program and its robot, whose logs are in the same state, and the keys of two operators.
struct Site {
    fate: Fate,
    folder: Folder,
    robot: Emulator,
    program: Program,
    operator: String,
    lobby: String,
    /// Kept open, so that a hanging reader is not a closed one.
    readers: Vec<Option<PipeReader>>,
}

impl Site {
    fn new(fate: Fate) -> Site {
        let folder = Folder::new(&format!("log-{fate:?}"));
        folder.token(&["add", "lobby", "--role", "operator"]);
        let [operator, lobby] = ["operator", "lobby"].map(|name| folder.token_of(name));
        let (robot, robots) = robot(fate, "127.0.0.1:0");
        let mut command = folder.command(&["serve", "--http", "127.0.0.1:0", "--robot", &format!("line={}", robot.place)]);
        let (log, programs) = fate.stream();
        command.env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true").env("HALLSWEEP__LOG__FILTER", "trace").stderr(log);
        let program = Program::started(&mut command);
        Site { fate, folder, robot, program, operator, lobby, readers: vec![robots, programs] }
    }

    fn asks(&self, token: &str, path: &str) -> Answer {
        self.program.read(path, &[("authorization", &format!("Bearer {token}"))])
    }

    fn commands(&self, token: &str, command: &str) -> Answer {
        self.program.post_with(&format!("/api/v1/commands/{command}"), &[("authorization", &format!("Bearer {token}"))], "")
    }

    fn until(&self, wanted: &str, is_so: impl Fn(&Value) -> bool) {
        let deadline = Deadline::within(PATIENCE);
        loop {
            let state = self.asks(&self.operator, "/api/v1/state").json();
            if is_so(&state) {
                return;
            }
            assert!(!deadline.has_passed(), "{:?}: never came to be: {wanted}; the state is\n{state:#}", self.fate);
            sleep(GLANCE);
        }
    }

    fn start(&self) {
        self.until("the robot is linked", |state| !holds(state, "robotLink"));
        self.commands(&self.operator, "start").accepted();
        self.until("the robot is on its way", |state| state["robot"]["state"] != "stopped");
    }

    fn stop(&self) {
        self.commands(&self.operator, "stop").accepted();
        self.until("the robot stands", |state| state["robot"]["state"] == "stopped");
    }

    /// Requests without a key and with a wrong key are refused, more than once.
    fn refuse_strangers(&self) {
        for _ in 0..2 {
            self.program.command("start").problem(401);
            self.commands("no-such-token", "start").problem(401);
        }
    }

    /// After its removal a key no longer works.
    fn remove_key(&self) {
        assert_eq!(self.asks(&self.lobby, "/api/v1/state").status, 200);
        self.folder.token(&["remove", "lobby"]);
        let deadline = Deadline::within(PATIENCE);
        while self.asks(&self.lobby, "/api/v1/state").status != 401 {
            assert!(!deadline.has_passed(), "{:?}: the removed key is good for ever", self.fate);
        }
        self.commands(&self.lobby, "start").problem(401);
        self.until("the robot stands still", |state| state["robot"]["state"] == "stopped");
    }

    fn lose_link_and_find_it(&mut self) {
        let place = self.robot.place.clone();
        signal(&self.robot.child, "TERM");
        assert_eq!(ended(&mut self.robot.child).and_then(|status| status.code()), Some(0), "{:?}: the robot's end", self.fate);
        self.until("the robot is gone", |state| holds(state, "robotLink"));
        let (robot, reader) = robot(self.fate, &place);
        self.robot = robot;
        self.readers.push(reader);
        self.until("the robot is back", |state| !holds(state, "robotLink"));
    }

    /// Another process locks the journal for a while.
    fn lock_store(&self) {
        let journal = self.folder.path().join("journal.db");
        let other = rusqlite::Connection::open(journal).expect("it is a database");
        other.execute_batch("BEGIN IMMEDIATE").expect("nobody else writes for long");
        assert_ne!(self.commands(&self.operator, "start").status, 200, "{:?}: it is not on record", self.fate);
        self.until("the store holds the robot", |state| holds(state, "store"));
        other.execute_batch("ROLLBACK").expect("it is still there");
        self.until("the store writes again", |state| !holds(state, "store"));
    }

    /// Number of lost log lines, read from `/metrics`.
    fn lost(&self) -> u64 {
        let figures = self.asks(&self.operator, "/metrics").text();
        let line = figures.lines().find_map(|line| line.strip_prefix("hallsweep_log_lines_lost_total "));
        line.expect("it is always there").parse().expect("a number")
    }
}

/// Starts a robot whose log is in this state.
fn robot(fate: Fate, place: &str) -> (Emulator, Option<PipeReader>) {
    let (log, reader) = fate.stream();
    let mut command = hallsweep(&["robot-emulator", "--listen", place, "--hall", "airport", "--speed", "2"]);
    (Emulator::started(command.env("HALLSWEEP__LOG__FILTER", "trace").stderr(log)), reader)
}

/// Runs everything that writes a log line, with the log in this state, while a client requests `/metrics` and never
/// reads the answers. The results must be the same as with a working log.
fn all_goes_on(fate: Fate) {
    let mut site = Site::new(fate);
    let mut figures = TcpStream::connect(site.program.address()).expect("the program listens");
    let asks = format!("GET /metrics HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {}\r\n\r\n", site.operator);
    figures.write_all(asks.repeat(200).as_bytes()).expect("it is heard");
    site.start();
    site.stop();
    site.refuse_strangers();
    site.remove_key();
    site.lose_link_and_find_it();
    site.lock_store();
    site.start();
    let fails = matches!(fate, Fate::ReaderGone | Fate::DiskFull);
    assert_eq!(site.lost() > 0, fails, "{fate:?}: lines that wait are not lost yet");
    site.program.signal("TERM");
    let status = site.program.ended_within(PROMISED);
    assert_eq!(status.and_then(|status| status.code()), Some(0), "{fate:?}: {status:?}");
}

/// Safety S11.
#[test]
fn all_goes_on_where_the_log_is_read() {
    all_goes_on(Fate::Read);
}

/// Safety S11.
#[test]
fn all_goes_on_where_the_reader_of_the_log_is_gone() {
    all_goes_on(Fate::ReaderGone);
}

/// Safety S11.
#[test]
fn all_goes_on_where_the_disk_of_the_log_is_full() {
    all_goes_on(Fate::DiskFull);
}

/// Safety S11.
#[test]
fn all_goes_on_where_the_reader_of_the_log_hangs() {
    all_goes_on(Fate::ReaderHangs);
}

/// Safety S11: if standard output accepts nothing, the program serves, reports this in the log without the key, and
/// ends in order. A late reader finds the link.
#[test]
fn standard_output_that_takes_nothing_keeps_the_program_from_nothing() {
    for fate in Fate::TROUBLE {
        let folder = Folder::new(&format!("output-{fate:?}"));
        let (output, reader) = fate.stream();
        let port = free_port();
        let mut command = folder.command(&["serve", "--http", &port.to_string(), "--hall", "empty-8x8"]);
        command.env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true").env("HALLSWEEP__LOG__FILTER", "info");
        let mut child = command.stdout(output).stderr(Stdio::piped()).spawn().expect("the program starts");
        let log = BufReader::new(child.stderr.take().expect("standard error is a pipe")).lines();
        let mut program = Program::found(child, port, log);
        let (mut is_serving, mut unannounced) = (false, String::new());
        while !is_serving || (reader.is_none() && unannounced.is_empty()) {
            let line = program.says();
            is_serving |= line.contains("serving http=");
            if line.contains("could not be printed") {
                unannounced = line;
            }
        }
        let operator = folder.token_of("operator");
        let start = program.post_with("/api/v1/commands/start", &[("authorization", &format!("Bearer {operator}"))], "");
        start.accepted();
        assert!(!unannounced.contains(&operator), "{unannounced}");
        if let Some(reader) = reader {
            let (say, said) = mpsc::channel();
            let lines = BufReader::new(reader).lines().map_while(Result::ok);
            std::thread::spawn(move || lines.for_each(|line| drop(say.send(line))));
            let link = format!("/sign-in?token={operator}");
            while !said.recv_timeout(PATIENCE).expect("the link comes").contains(&link) {}
        }
        program.signal("TERM");
        let status = program.ended_within(PROMISED);
        assert_eq!(status.and_then(|status| status.code()), Some(0), "{fate:?}: {status:?}");
    }
}

/// Safety S11: nothing reads standard output or the log, not even at the end.
#[test]
fn it_ends_although_nobody_reads_what_it_writes() {
    let (output, _reader) = Fate::ReaderHangs.stream();
    let (log, _log_reader) = Fate::ReaderHangs.stream();
    let port = free_port();
    let mut command = hallsweep(&["serve", "--http", &port.to_string(), "--hall", "empty-8x8"]);
    let command = command.env("HALLSWEEP__LOG__FILTER", "trace").stdout(output).stderr(log);
    let mut program = Program::found(command.spawn().expect("the program starts"), port, std::iter::empty());
    let deadline = Deadline::within(PATIENCE);
    while program.try_ask("GET", "/healthz", "", "").is_none() {
        assert!(!deadline.has_passed(), "it never serves");
        sleep(GLANCE);
    }
    program.command("start").accepted();
    program.signal("TERM");
    assert_eq!(program.ended_within(PROMISED).and_then(|status| status.code()), Some(0));
}

/// Local address on which nothing listens.
fn free_port() -> SocketAddr {
    TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).expect("a free port")
}

/// The same command as arguments of a shell script.
fn under(shell: &str, command: &Command) -> Command {
    let mut under = Command::new("bash");
    under.args(["-c", shell]).arg(command.get_program()).args(command.get_args()).stdin(Stdio::null());
    under.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    under
}

/// Safety S11 and R3: by default the system kills a process that writes beyond its file size limit. The program must
/// prevent that.
#[test]
fn a_limit_for_files_stops_lines_and_records_and_not_the_program() {
    let folder = Folder::new("log-limit");
    let log = std::env::temp_dir().join(format!("hallsweep-log-limit-{}", std::process::id()));
    std::fs::write(&log, vec![b'.'; 300 * 1024]).expect("there is room");
    let serve = folder.command(&["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", "max"]);
    let mut limited = under("ulimit -f 200; exec \"$0\" \"$@\"", &serve);
    let program = Program::started(limited.stderr(File::options().append(true).open(&log).expect("it is there")));
    program.command("start").accepted();
    for id in 1.. {
        let state =
            program.until("the hold store, or a question", |state| holds(state, "store") || state["mission"]["inspected"] == id);
        if holds(&state, "store") {
            break;
        }
        program.verdict(id, "safe");
    }
    program.command("stop").accepted();
    let is_counted = |line: &str| line.starts_with("hallsweep_log_lines_lost_total") && !line.ends_with(" 0");
    let deadline = Deadline::within(PATIENCE);
    while !program.read("/metrics", &[]).text().lines().any(is_counted) {
        assert!(!deadline.has_passed(), "lost lines are never counted");
        sleep(GLANCE);
    }
    std::fs::remove_file(log).expect("it is there");
}

/// Safety S11: by default the system stops a background process that writes to such a terminal. The program must
/// prevent that.
#[test]
fn a_terminal_that_takes_nothing_from_the_background_stops_nothing() {
    let folder = Folder::new("log-terminal");
    folder.token(&["add", "lobby", "--role", "operator"]);
    let serve = folder.command(&["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8"]);
    let shell = "stty tostop -onlcr; trap '' HUP; set -m; \"$@\" & while [ -d \"$HALLSWEEP__STORE__FOLDER\" ]; do sleep 0.1; done; kill -KILL $!";
    let words = serve.get_args().map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ");
    let line = format!("{} {words}", serve.get_program().display());
    let mut terminal = Command::new("script");
    terminal.args(["-qc", &format!("bash -c '{}' - {line}", shell.replace('\'', "'\\''")), "/dev/null"]).stdin(Stdio::null());
    terminal
        .envs(serve.get_envs().filter_map(|(name, value)| Some((name, value?))))
        .env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true");
    let program = Program::started(&mut terminal);
    let operator = folder.token_of("lobby");
    for key in ["wrong", "wrong too"] {
        program.read("/api/v1/state", &[("authorization", &format!("Bearer {key}"))]).problem(401);
    }
    let key = [("authorization", &*format!("Bearer {operator}"))];
    program.post_with("/api/v1/commands/start", &key, "").accepted();
    program.post_with("/api/v1/commands/stop", &key, "").accepted();
}

/// A command may wait for a slow reader of its output, but a failing stream must lead to an exit code and not to a
/// panic.
#[test]
fn a_command_whose_output_fails_ends_with_an_exit_code() {
    let folder = Folder::new("log-commands");
    std::fs::create_dir_all(folder.path()).expect("a folder for the map");
    let map = folder.path().join("map.toml").display().to_string();
    let commands: [(&[&str], i32, i32); 6] = [
        (&["table"], 0, 1),
        (&["explore", "--hall", "empty-8x8", "--json", "--map", &map, "--force"], 0, 1),
        (&["explore", "--hall", "no-such-hall"], 2, 2),
        (&["tree", "check", "no-such-tree.xml"], 1, 1),
        (&["token"], 1, 1),
        (&["serve", "--speed", "fast"], 2, 2),
    ];
    for (arguments, code, without_output) in commands {
        let run = |output: Stdio, log: Stdio| -> Output {
            let command = &mut folder.command(arguments);
            let command = command.env("HALLSWEEP__LOG__FILTER", "trace").env("HALLSWEEP_UNKNOWN", "1");
            command.stdout(output).stderr(log).output().expect("the program starts")
        };
        for fate in [Fate::ReaderGone, Fate::DiskFull] {
            let silent = run(Stdio::null(), fate.stream().0);
            assert_eq!(silent.status.code(), Some(code), "{arguments:?} with a log of the fate {fate:?}");
            let unheard = run(fate.stream().0, Stdio::piped());
            let said = String::from_utf8_lossy(&unheard.stderr);
            assert_eq!(unheard.status.code(), Some(without_output), "{arguments:?}, output {fate:?}: {said}");
            assert!(!said.contains("panicked"), "{said}");
        }
    }
}

/// The emulator also ends when its terminal closes.
#[test]
fn each_signal_that_asks_for_an_end_ends_the_robot_emulator_well() {
    for name in ["INT", "TERM", "HUP"] {
        let (mut robot, _) = robot(Fate::Read, "127.0.0.1:0");
        signal(&robot.child, name);
        assert_eq!(ended(&mut robot.child).and_then(|status| status.code()), Some(0), "SIG{name}");
    }
}
