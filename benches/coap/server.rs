//! The measured servers, each a separate process on a free local port: how to start it, its CPU and memory, and its
//! end with the benchmark.

use std::io::{BufRead, BufReader};
use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;

use crate::client::Client;
use crate::goals;

/// Prefix of the address that the servers written in Rust print.
const ANNOUNCED: &str = "coap://";

/// Number of attempts, and the pause between them, until a server answers.
const LOOKS: u32 = 100;
const LOOK: Duration = Duration::from_millis(50);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The CoAP door of hallsweep.
    Hallsweep,
    /// libcoap's example server from Debian's package.
    Libcoap,
    /// The same server with non-confirmable notifications.
    LibcoapNon,
    /// coap-rs as its examples use it.
    CoapRs,
    /// A bound of one socket and the codec.
    Bare,
}

impl Kind {
    /// Name in the figures.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Kind::Hallsweep => "hallsweep",
            Kind::Libcoap => "libcoap",
            Kind::LibcoapNon => "libcoap -N",
            Kind::CoapRs => "coap-rs 0.29",
            Kind::Bare => "bare bound",
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

    /// Reads the address that the server prints; libcoap gets its port as an argument instead.
    fn announced(&mut self) -> bool {
        if matches!(self.kind, Kind::Libcoap | Kind::LibcoapNon) {
            return true;
        }
        let output = BufReader::new(self.child.stdout.take().expect("its output is piped"));
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

    fn answers(&self) -> bool {
        let mut client = Client::new(self.address);
        (0..LOOKS).any(|_| {
            std::thread::sleep(LOOK);
            client.get("/.well-known/core").is_some()
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

    /// Resident memory in KiB.
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
            // Several servers run at once, so each door gets a free port.
            let free = "127.0.0.1:0";
            command.args(["serve", "--http", free, "--coap", free, "--mqtt", free, "--speed", "max", "--data"]).arg(folder);
        }
        Kind::Libcoap => drop(command.args(["-A", "127.0.0.1", "-d", "10", "-p", &port.to_string()])),
        Kind::LibcoapNon => drop(command.args(["-N", "-A", "127.0.0.1", "-d", "10", "-p", &port.to_string()])),
        Kind::CoapRs | Kind::Bare => {}
    }
    command
}

/// Port that is free for both UDP and TCP, because libcoap binds both.
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
