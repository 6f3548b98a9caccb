//! The servers that are measured, each a process of its own on a free port of this machine: how each is started, what it has used,
//! and that it ends with the benchmark.

use std::io::{BufRead, BufReader};
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;

use crate::{goals, paced};

/// How hallsweep says where its topics are.
const ANNOUNCED: &str = "mqtt://";

/// A server may take so many looks, a moment apart, until it serves.
const LOOKS: u32 = 100;
const LOOK: Duration = Duration::from_millis(50);

/// Who is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// hallsweep's public port.
    Hallsweep,
    /// The same where rumqttd routes.
    Linked,
    /// rumqttd alone.
    Bare,
    /// Two bare sockets with one thread between them.
    Bound,
    /// mosquitto, as Debian has it.
    Mosquitto,
}

impl Kind {
    /// As figures name it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Kind::Hallsweep => "hallsweep",
            Kind::Linked => "by rumqttd",
            Kind::Bare => "rumqttd",
            Kind::Bound => "bound",
            Kind::Mosquitto => "mosquitto",
        }
    }

    /// Says why it is not measured.
    pub(crate) fn left_out(self, why: &str) {
        goals::left_out(self.name(), self == Kind::Hallsweep, why);
    }
}

/// A running server.
pub(crate) struct Server {
    pub(crate) kind: Kind,
    pub(crate) address: SocketAddr,
    child: Child,
    folder: PathBuf,
}

impl Server {
    /// Starts it; `None`, with a printed word, when it is not to be had: for hallsweep that is a failure.
    pub(crate) fn start(kind: Kind) -> Option<Server> {
        static STARTED: AtomicU32 = AtomicU32::new(0);
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("hallsweep-bench-mqtt-{}-{number}", std::process::id()));
        std::fs::create_dir(&folder).expect("the folder for temporary files can be written");
        let port = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a free port").port();
        let mut command = command(kind, port, &folder);
        let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let child = child.inspect_err(|error| kind.left_out(&format!("{:?}: {error}", command.get_program())));
        let address = SocketAddr::from(([127, 0, 0, 1], port));
        let mut server = Server { kind, address, child: child.ok()?, folder };
        let is_there = server.announced() && server.serves();
        if !is_there {
            kind.left_out("it started and does not serve");
        }
        is_there.then_some(server)
    }

    /// Reads where it is, unless it was told.
    fn announced(&mut self) -> bool {
        let output = BufReader::new(self.child.stdout.take().expect("its output is piped"));
        if !matches!(self.kind, Kind::Hallsweep | Kind::Linked) {
            return true;
        }
        let (say, said) = channel();
        // It reads on to the end: a server that cannot print might stop.
        std::thread::spawn(move || {
            for at in output.lines().map_while(Result::ok).filter_map(|line| address(&line)) {
                let _ = say.send(at);
            }
        });
        let announced = said.recv_timeout(LOOK * LOOKS);
        self.address = announced.unwrap_or(self.address);
        announced.is_ok()
    }

    /// Whether messages come through it.
    fn serves(&self) -> bool {
        (0..LOOKS).any(|_| {
            std::thread::sleep(LOOK);
            paced::run(self.address, 1, 1).is_ok_and(|took| took.len() == 1)
        })
    }

    /// The CPU it has used, all threads together.
    pub(crate) fn cpu(&self) -> Duration {
        let tasks = std::fs::read_dir(self.proc("task")).expect("the system tells of a process that runs");
        let used = tasks.flatten().map(|task| {
            let text = std::fs::read_to_string(task.path().join("schedstat")).unwrap_or_default();
            text.split(' ').next().and_then(|ns| ns.parse().ok()).unwrap_or(0)
        });
        Duration::from_nanos(used.sum())
    }

    /// Its memory in MB, a million bytes each: now, and at the worst moment.
    pub(crate) fn memory(&self) -> (f64, f64) {
        let status = std::fs::read_to_string(self.proc("status")).unwrap_or_default();
        let kib = |name| {
            let value = status.lines().find_map(|line: &str| line.strip_prefix(name)?.split_whitespace().next()?.parse().ok());
            value.unwrap_or(f64::NAN)
        };
        (kib("VmRSS:") * 1024e-6, kib("VmHWM:") * 1024e-6)
    }

    fn proc(&self, name: &str) -> PathBuf {
        format!("/proc/{}/{name}", self.child.id()).into()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

fn command(kind: Kind, port: u16, folder: &Path) -> Command {
    match kind {
        Kind::Hallsweep => hallsweep(folder, "own"),
        Kind::Linked => hallsweep(folder, "rumqttd"),
        Kind::Bare | Kind::Bound => {
            let mut command = Command::new(std::env::current_exe().expect("the system knows which program this is"));
            command.args([kind.name(), &port.to_string()]);
            command
        }
        Kind::Mosquitto => mosquitto(port, folder),
    }
}

fn hallsweep(folder: &Path, router: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hallsweep"));
    for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("HALLSWEEP_")) {
        command.env_remove(name);
    }
    command.env("HALLSWEEP__MQTT__ROUTER", router);
    let free = "127.0.0.1:0";
    command.args(["serve", "--http", free, "--coap", free, "--mqtt", free, "--data"]).arg(folder.join("data"));
    command
}

/// With the limits it comes with: 1,000 messages wait for a slow subscriber and 20 are not acknowledged, at most.
fn mosquitto(port: u16, folder: &Path) -> Command {
    let settings = folder.join("mosquitto.conf");
    let text = format!("listener {port} 127.0.0.1\nallow_anonymous true\npersistence false\n");
    std::fs::write(&settings, text).expect("the folder was just made");
    let mut command = Command::new("mosquitto");
    command.arg("-c").arg(settings);
    command
}

fn address(line: &str) -> Option<SocketAddr> {
    let (_, rest) = line.split_once(ANNOUNCED)?;
    rest.split(['/', ' ', '\u{1b}']).next()?.parse().ok()
}
