//! The measured servers, each a separate process on a free local port: how to start it, its CPU and memory, and its
//! end with the benchmark.

use std::io::{BufRead, BufReader};
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;

use crate::{goals, paced};

/// Prefix of the address that hallsweep prints.
const ANNOUNCED: &str = "mqtt://";

/// Number of attempts, and the pause between them, until a server answers.
const LOOKS: u32 = 100;
const LOOK: Duration = Duration::from_millis(50);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// hallsweep's public port.
    Hallsweep,
    /// hallsweep's public port in the mode where rumqttd routes.
    Linked,
    /// rumqttd alone.
    Bare,
    /// Two bare sockets with one thread between them.
    Bound,
    /// mosquitto from Debian's package.
    Mosquitto,
}

impl Kind {
    /// Name in the figures.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Kind::Hallsweep => "hallsweep",
            Kind::Linked => "by rumqttd",
            Kind::Bare => "rumqttd",
            Kind::Bound => "bound",
            Kind::Mosquitto => "mosquitto",
        }
    }

    /// Prints the reason why the server is not measured.
    pub(crate) fn left_out(self, why: &str) {
        goals::left_out(self.name(), self == Kind::Hallsweep, why);
    }
}

pub(crate) struct Server {
    pub(crate) kind: Kind,
    pub(crate) address: SocketAddr,
    child: Child,
    folder: PathBuf,
}

impl Server {
    /// Starts a server. `None` after a printed reason when the server is not available, which is a failure for
    /// hallsweep alone.
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

    /// Reads the address that the server prints; the rivals get their port as an argument instead.
    fn announced(&mut self) -> bool {
        let output = BufReader::new(self.child.stdout.take().expect("its output is piped"));
        if !matches!(self.kind, Kind::Hallsweep | Kind::Linked) {
            return true;
        }
        let (say, said) = channel();
        // The thread reads all output, because a server whose output pipe is full might stop.
        std::thread::spawn(move || {
            for at in output.lines().map_while(Result::ok).filter_map(|line| address(&line)) {
                let _ = say.send(at);
            }
        });
        let announced = said.recv_timeout(LOOK * LOOKS);
        self.address = announced.unwrap_or(self.address);
        announced.is_ok()
    }

    /// Whether a message passes through the server.
    fn serves(&self) -> bool {
        (0..LOOKS).any(|_| {
            std::thread::sleep(LOOK);
            paced::run(self.address, 1, 1).is_ok_and(|took| took.len() == 1)
        })
    }

    /// CPU time used so far by all threads.
    pub(crate) fn cpu(&self) -> Duration {
        let tasks = std::fs::read_dir(self.proc("task")).expect("the system tells of a process that runs");
        let used = tasks.flatten().map(|task| {
            let text = std::fs::read_to_string(task.path().join("schedstat")).unwrap_or_default();
            text.split(' ').next().and_then(|ns| ns.parse().ok()).unwrap_or(0)
        });
        Duration::from_nanos(used.sum())
    }

    /// Resident memory in MB (10⁶ bytes): now, and its maximum.
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

/// mosquitto with its default limits: 1,000 queued and 20 unacknowledged messages per client.
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
