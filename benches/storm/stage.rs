//! The processes of a storm: the program, the floods and the honest clients. This process starts all of them, and
//! they end with it.

use std::io::{BufRead, BufReader, Read};
use std::os::unix::fs::DirBuilderExt;
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use hallsweep::access::{Key, KeyFile, Keys, Role, Token};
use hallsweep::app::raise_descriptors;

use crate::course::{Course, Doors, OPERATOR, SECOND, VIEWER};
use crate::wire;
use crate::{floods, honest, test_app};

/// Environment variable that makes a sender use MQTT 5.
const FIVE: &str = "HALLSWEEP_STORM_MQTT";

/// Arguments with which the benchmark starts itself as a flood, and as the honest clients.
pub(crate) const FLOOD: &str = "flood";
pub(crate) const HONEST: &str = "honest";

/// Niceness of the senders, which lowers their priority.
const NICE: &str = "10";

/// Time limit for a process to start.
const BEGINNING: Duration = Duration::from_secs(60);

/// Time after which a flood ends by itself, even when the benchmark is gone.
const LONGEST: Duration = Duration::from_secs(180);

pub(crate) struct TestApp {
    child: Child,
    folder: PathBuf,
    pub(crate) doors: Doors,
    said: Receiver<Said>,
}

/// Messages of the test application.
pub(crate) enum Said {
    Doors(String),
    Moves,
    /// Epoch of a STOP, and the time when its halt reached the robot's port, in nanoseconds since boot.
    Halt(u64, u64),
}

impl TestApp {
    /// Starts the program with keys of both roles and every door open.
    ///
    /// # Errors
    /// Why the program does not serve.
    pub(crate) fn start() -> Result<TestApp, String> {
        static STARTED: AtomicU32 = AtomicU32::new(0);
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("hallsweep-storm-{}-{number}", std::process::id()));
        let [operator, second, viewer] = keys(&folder)?;
        let mut command = own(test_app::WORD);
        for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("HALLSWEEP_")) {
            command.env_remove(name);
        }
        for door in ["HTTP", "COAP", "MQTT"] {
            command.env(format!("HALLSWEEP__{door}__BIND"), "127.0.0.1:0");
        }
        command.env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true").env("HALLSWEEP__MQTT__REQUIRE_PASSWORD", "true");
        command.env("HALLSWEEP__STORE__FOLDER", &folder).env("HALLSWEEP__LOG__FILTER", "info");
        let log = std::fs::File::create(folder.join("storm.log")).map_err(|error| error.to_string())?;
        let mut child = command.stderr(log).spawn().map_err(|error| error.to_string())?;
        let said = listen(child.stdout.take().expect("its output is piped"));
        let Ok(Said::Doors(doors)) = said.recv_timeout(BEGINNING) else {
            let log = std::fs::read_to_string(folder.join("storm.log")).unwrap_or_default();
            let _ = child.kill();
            return Err(format!("the program does not serve: {log}"));
        };
        let mut words: Vec<String> = doors.split(' ').map(str::to_owned).collect();
        words.extend([operator, second, viewer]);
        Ok(TestApp { child, folder, doors: Doors::read(&words), said })
    }

    /// Waits until `until` for the next message.
    pub(crate) fn next(&self, until: Instant) -> Result<Said, RecvTimeoutError> {
        self.said.recv_timeout(until.saturating_duration_since(Instant::now()))
    }

    /// Peak resident memory in MiB.
    pub(crate) fn memory_mib(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or_default();
        line.trim().trim_end_matches(" kB").parse::<u64>().unwrap_or(0) / 1024
    }

    /// Log lines that no storm may cause.
    pub(crate) fn broke(&self) -> Vec<String> {
        let log = std::fs::read_to_string(self.folder.join("storm.log")).unwrap_or_default();
        let broken = |line: &&str| {
            ["panicked", "anew", "begins a new file", "an internal error", "has ended", "stopped working"]
                .iter()
                .any(|word| line.contains(word))
        };
        log.lines().filter(broken).map(str::to_owned).collect()
    }
}

impl Drop for TestApp {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// A running flood, or the honest clients.
pub(crate) struct Sender {
    child: Child,
    /// Standard input of the sender, which ends when this is closed.
    _leash: Option<ChildStdin>,
    lines: Receiver<String>,
}

impl Sender {
    /// Starts a flood and waits until it is prepared.
    pub(crate) fn flood(name: &str, doors: &Doors, is_nice: bool) -> Result<Sender, String> {
        let mut command = if is_nice { nice(FLOOD) } else { own(FLOOD) };
        command.arg(name);
        Sender::start(command, doors)
    }

    /// Starts the honest clients.
    pub(crate) fn honest(doors: &Doors) -> Result<Sender, String> {
        Sender::start(own(HONEST), doors)
    }

    fn start(mut command: Command, doors: &Doors) -> Result<Sender, String> {
        if wire::is_five() {
            command.env(FIVE, "5");
        }
        let mut child = command.args(doors.words()).spawn().map_err(|error| format!("{command:?}: {error}"))?;
        let (say, lines) = channel();
        let output = BufReader::new(child.stdout.take().expect("its output is piped"));
        std::thread::spawn(move || output.lines().map_while(Result::ok).for_each(|line| drop(say.send(line))));
        let sender = Sender { _leash: child.stdin.take(), child, lines };
        sender.lines.recv_timeout(BEGINNING).map_err(|_| format!("{command:?} does not begin"))?;
        Ok(sender)
    }

    /// Ends the sender; returns the number of its actions and of its refusals.
    pub(crate) fn end(mut self) -> (u64, u64) {
        self._leash = None;
        let tally = self.lines.recv_timeout(Duration::from_secs(10)).unwrap_or_default();
        let mut counts = tally.split(' ').filter_map(|count| count.parse().ok());
        (counts.next().unwrap_or(0), counts.next().unwrap_or(0))
    }
}

impl Drop for Sender {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs a flood in this process: prints a line when it has begun, and its tally at the end.
pub(crate) fn flood(name: &str, doors: Doors) {
    wire::speak_five(std::env::var_os(FIVE).is_some());
    let _ = raise_descriptors(8192);
    let course = Course::new(doors);
    (floods::named(name).expect("the benchmark knows its floods").begin)(&course);
    let since = Instant::now();
    while !course.is_prepared() && since.elapsed() < BEGINNING {
        std::thread::sleep(Duration::from_millis(5));
    }
    until_told(&course);
}

/// Runs the honest clients in this process.
pub(crate) fn look_on(doors: Doors) {
    wire::speak_five(std::env::var_os(FIVE).is_some());
    let course = Course::new(doors);
    honest::look_on(&course);
    until_told(&course);
}

#[expect(clippy::print_stdout, reason = "that is how it tells")]
fn until_told(course: &Arc<Course>) {
    println!("begun");
    let (told, tells) = channel::<()>();
    std::thread::spawn(move || {
        let _ = std::io::stdin().read_to_end(&mut Vec::new());
        drop(told);
    });
    let _ = tells.recv_timeout(LONGEST);
    course.end();
    let (done, away) = course.tally();
    println!("{done} {away}");
    std::process::exit(0);
}

/// Command that starts this program again in another role.
fn own(word: &str) -> Command {
    let mut command = Command::new(std::env::current_exe().expect("the system knows which program this is"));
    command.arg(word).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    command
}

/// The same command with a lower priority.
fn nice(word: &str) -> Command {
    let mut command = Command::new("nice");
    command.args(["-n", NICE]).arg(std::env::current_exe().expect("the system knows which program this is")).arg(word);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    command
}

/// Creates a data folder with keys of both roles.
fn keys(folder: &PathBuf) -> Result<[String; 3], String> {
    std::fs::DirBuilder::new().recursive(true).mode(0o700).create(folder).map_err(|error| error.to_string())?;
    let mut tokens = Vec::new();
    let mut keys = Vec::new();
    for (name, role) in [(OPERATOR, Role::Operator), (SECOND, Role::Operator), (VIEWER, Role::Viewer)] {
        let token = Token::draw().map_err(|error| error.to_string())?;
        tokens.push(token.reveal().to_owned());
        keys.push(Key::new(name, role, token).map_err(|error| error.to_string())?);
    }
    let keys = Keys::new(keys).map_err(|error| error.to_string())?;
    KeyFile::within(folder).write(&keys).map_err(|error| error.to_string())?;
    tokens.try_into().map_err(|_| "three keys".to_owned())
}

fn listen(output: impl Read + Send + 'static) -> Receiver<Said> {
    let (say, said) = channel();
    std::thread::spawn(move || {
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            let heard = match line.split_once(' ') {
                Some(("doors", doors)) => Said::Doors(doors.to_owned()),
                Some(("halt", halt)) => {
                    let (epoch, at) = halt.split_once(' ').expect("an epoch and a time");
                    Said::Halt(epoch.parse().expect("a number"), at.parse().expect("a number"))
                }
                Some(_) | None => Said::Moves,
            };
            if say.send(heard).is_err() {
                break;
            }
        }
    });
    said
}
