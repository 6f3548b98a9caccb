//! Brokers that others wrote, each in a folder and on a port of its own: started, killed and started again. What is said on them is
//! the tests' business.

use std::io::Write;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU16, Ordering};
use std::thread::sleep;
use std::time::Duration;

use crate::kill::Folder;
use crate::program::Deadline;
use crate::third_party::runs;

/// How long a broker may take to open its port: far longer than it takes.
const PATIENCE: Duration = Duration::from_secs(60);

/// How often that is looked at.
const GLANCE: Duration = Duration::from_millis(5);

/// Ports are sought from here on, below those that the system gives to connections: a port that is closed for a while must not be
/// taken by one of those.
const PORTS: u16 = 20_000;

/// The login that a broker asks for, where it asks.
pub(crate) const LOGIN: (&str, &str) = ("robot", "a-test-only-password");

/// The certificate of the broker that is reached by TLS.
pub(crate) const CERTIFICATE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls/test-only-certificate.pem");

/// And its key.
const KEY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls/test-only-key.pem");

/// Which broker, and how it lets in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Debian's mosquitto, which lets everybody in.
    Mosquitto,
    /// The same, with which MQTT 5 is spoken.
    MosquittoFive,
    /// The same, which asks for name and password.
    MosquittoWithLogin,
    /// The same, by TLS.
    MosquittoByTls,
    /// Debian's nats-server, with its JetStream, without which it speaks no MQTT.
    Nats,
}

/// A broker.
pub(crate) struct Broker {
    kind: Kind,
    port: u16,
    folder: Folder,
    child: Option<Child>,
}

impl Kind {
    /// Whether it is there. When it is not, a word says what to install, or the test fails under `HALLSWEEP_REQUIRE_CLIENTS=1`.
    pub(crate) fn is_here(self) -> bool {
        let (program, package) = (self.program(), if self == Kind::Nats { "nats-server" } else { "mosquitto" });
        let runs = Command::new(program).arg("-h").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
        runs || left_out(&format!("{program} (apt-get install {package})"))
    }

    /// The command; Debian has servers where not everybody's shell looks.
    fn program(self) -> &'static str {
        let (name, beside) = match self {
            Kind::Nats => ("nats-server", "/usr/sbin/nats-server"),
            Kind::Mosquitto | Kind::MosquittoFive | Kind::MosquittoWithLogin | Kind::MosquittoByTls => {
                ("mosquitto", "/usr/sbin/mosquitto")
            }
        };
        if Path::new(beside).exists() { beside } else { name }
    }
}

impl Broker {
    /// Starts one; the name is that of the test.
    pub(crate) fn start(kind: Kind, name: &str) -> Broker {
        let mut broker = Broker { kind, port: free_port(), folder: Folder::new(&format!("mqtt-{name}")), child: None };
        let path = broker.folder.path().join("broker.conf");
        std::fs::write(path, broker.settings()).expect("the folder can be written");
        broker.start_again();
        broker
    }

    /// Kills it, so that it takes no leave of anybody.
    pub(crate) fn kill(&mut self) {
        if let Some(mut child) = self.child.take() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }

    /// Starts it where it was before, and waits until its port is open.
    pub(crate) fn start_again(&mut self) {
        let settings = self.folder.path().join("broker.conf");
        let log = std::fs::File::create(self.folder.path().join("broker.log")).expect("the folder can be written");
        let mut command = Command::new(self.kind.program());
        command.arg("-c").arg(settings).stdin(Stdio::null()).stdout(log.try_clone().expect("it is open")).stderr(log);
        self.child = Some(command.spawn().expect("the broker starts"));
        let deadline = Deadline::within(PATIENCE);
        while TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).is_err() {
            assert!(!deadline.has_passed(), "{:?} does not open its port: {}", self.kind, self.log());
            sleep(GLANCE);
        }
    }

    /// Which it is.
    pub(crate) fn kind(&self) -> Kind {
        self.kind
    }

    /// Its port, on loopback.
    pub(crate) fn port(&self) -> u16 {
        self.port
    }

    /// As `mqtt.broker` names it.
    pub(crate) fn url(&self) -> String {
        let scheme = if self.kind == Kind::MosquittoByTls { "mqtts" } else { "mqtt" };
        format!("{scheme}://127.0.0.1:{}", self.port)
    }

    /// Waits until it has written this.
    pub(crate) fn until_it_says(&self, words: &str) {
        let deadline = Deadline::within(PATIENCE);
        while !self.log().contains(words) {
            assert!(!deadline.has_passed(), "{:?} never wrote: {words}", self.kind);
            sleep(GLANCE);
        }
    }

    /// What it wrote.
    pub(crate) fn log(&self) -> String {
        std::fs::read_to_string(self.folder.path().join("broker.log")).unwrap_or_default()
    }

    fn settings(&self) -> String {
        let (port, folder) = (self.port, self.folder.text());
        // Started by root, mosquitto becomes somebody who may not read the folder.
        let mosquitto = format!("user root\npersistence false\nlistener {port} 127.0.0.1\n");
        match self.kind {
            Kind::Mosquitto | Kind::MosquittoFive => format!("{mosquitto}allow_anonymous true\n"),
            Kind::MosquittoWithLogin => {
                let mut made = Command::new("mosquitto_passwd");
                made.args(["-b", "-c", &format!("{folder}/logins"), LOGIN.0, LOGIN.1]);
                assert!(runs(&mut made), "mosquitto_passwd comes with mosquitto");
                format!("{mosquitto}allow_anonymous false\npassword_file {folder}/logins\n")
            }
            Kind::MosquittoByTls => {
                format!("{mosquitto}allow_anonymous true\nlog_type all\ncertfile {CERTIFICATE}\nkeyfile {KEY}\n")
            }
            Kind::Nats => format!(
                "server_name: test\nhost: 127.0.0.1\nport: -1\njetstream {{ store_dir: \"{folder}\" }}\n\
                 mqtt {{ host: 127.0.0.1, port: {port} }}\n"
            ),
        }
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        self.kill();
        if std::thread::panicking() {
            eprintln!("{:?} said:\n{}", self.kind, self.log());
        }
    }
}

/// Says that a test is left out, and why; fails instead when everything must be there.
fn left_out(missing: &str) -> bool {
    let required = std::env::var("HALLSWEEP_REQUIRE_CLIENTS").is_ok_and(|value| value == "1");
    assert!(!required, "the tests of the MQTT door need {missing}");
    // Written past the test harness, which would keep it to itself.
    writeln!(std::io::stderr(), "a test of the MQTT door is left out: it needs {missing}").expect("standard error is open");
    false
}

/// A port that nobody listens at, and no other test of this run was given.
fn free_port() -> u16 {
    static NEXT: AtomicU16 = AtomicU16::new(0);
    // Runs beside this one begin elsewhere.
    let first = PORTS + u16::try_from(std::process::id() % 1000).expect("it is below 1000") * 10;
    loop {
        let port = first + NEXT.fetch_add(1, Ordering::Relaxed);
        if TcpListener::bind((Ipv4Addr::LOCALHOST, port)).is_ok() {
            return port;
        }
    }
}
