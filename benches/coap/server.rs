//! The servers that are measured, each a process of its own on a free port of this machine: how each is started, what it has used,
//! and that it ends with the benchmark.

use std::io::{BufRead, BufReader};
use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;

use crate::client::Client;
use crate::goals;

/// How a server of Rust says where it is.
const ANNOUNCED: &str = "coap://";

/// A server may take so many looks, a moment apart, until it answers.
const LOOKS: u32 = 100;
const LOOK: Duration = Duration::from_millis(50);

/// Who is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// hallsweep's door.
    Hallsweep,
    /// libcoap's example server, as Debian has it.
    Libcoap,
    /// The same, told to notify by NON.
    LibcoapNon,
    /// coap-rs, as its examples use it.
    CoapRs,
    /// A bound: one socket and the codec.
    Bare,
}

impl Kind {
    /// As figures name it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Kind::Hallsweep => "hallsweep",
            Kind::Libcoap => "libcoap",
            Kind::LibcoapNon => "libcoap -N",
            Kind::CoapRs => "coap-rs 0.29",
            Kind::Bare => "bare bound",
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
        let folder = std::env::temp_dir().join(format!("hallsweep-bench-coap-{}-{number}", std::process::id()));
        let port = free_port();
        let mut command = command(kind, port, &folder);
        let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let child = child.inspect_err(|error| kind.left_out(&format!("{:?}: {error}", command.get_program())));
        let address = SocketAddr::from(([127, 0, 0, 1], port));
        let mut server = Server { kind, address, child: child.ok()?, folder };
        let is_there = server.announced() && server.answers();
        if !is_there {
            kind.left_out("it started and does not answer");
        }
        is_there.then_some(server)
    }

    /// Reads where it is, unless it was told.
    fn announced(&mut self) -> bool {
        if matches!(self.kind, Kind::Libcoap | Kind::LibcoapNon) {
            return true;
        }
        let output = BufReader::new(self.child.stdout.take().expect("its output is piped"));
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

    fn answers(&self) -> bool {
        let mut client = Client::new(self.address);
        (0..LOOKS).any(|_| {
            std::thread::sleep(LOOK);
            client.get("/.well-known/core").is_some()
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

    /// Its memory in KiB.
    pub(crate) fn memory(&self) -> u64 {
        let status = std::fs::read_to_string(self.proc("status")).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or_default();
        line.trim().trim_end_matches(" kB").parse().unwrap_or(0)
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
    let mut command = match kind {
        Kind::Hallsweep => Command::new(env!("CARGO_BIN_EXE_hallsweep")),
        Kind::Libcoap | Kind::LibcoapNon => Command::new("coap-server-notls"),
        Kind::CoapRs => Command::new(crate::rivals::program("coap_rs")),
        Kind::Bare => Command::new(crate::rivals::program("bare")),
    };
    match kind {
        Kind::Hallsweep => {
            for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("HALLSWEEP_")) {
                command.env_remove(name);
            }
            // Several of them run at once: each has ports of its own at every door.
            let free = "127.0.0.1:0";
            command.args(["serve", "--http", free, "--coap", free, "--mqtt", free, "--speed", "max", "--data"]).arg(folder);
        }
        Kind::Libcoap => drop(command.args(["-A", "127.0.0.1", "-d", "10", "-p", &port.to_string()])),
        Kind::LibcoapNon => drop(command.args(["-N", "-A", "127.0.0.1", "-d", "10", "-p", &port.to_string()])),
        Kind::CoapRs | Kind::Bare => {}
    }
    command
}

/// libcoap wants a port of both UDP and TCP.
fn free_port() -> u16 {
    let free = |_| {
        let port = UdpSocket::bind("127.0.0.1:0").ok()?.local_addr().ok()?.port();
        TcpListener::bind(("127.0.0.1", port)).ok().map(|_| port)
    };
    (0..LOOKS).find_map(free).expect("the system has free ports")
}

fn address(line: &str) -> Option<SocketAddr> {
    let (_, rest) = line.split_once(ANNOUNCED)?;
    rest.split(['/', ' ', '\u{1b}']).next()?.parse().ok()
}
