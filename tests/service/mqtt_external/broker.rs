//! Brokers by other authors, each with its own folder and port: started, killed and restarted. The tests choose the
//! messages.

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

/// Longest time until a broker opens its port. It is far longer than needed.
const PATIENCE: Duration = Duration::from_secs(60);

/// Interval between two checks of that port or of the log.
const GLANCE: Duration = Duration::from_millis(5);

/// First port for brokers. It is below the range that the system uses for outgoing connections, so that none of them
/// takes the port of a broker that is down.
const PORTS: u16 = 20_000;

/// Login of a broker that asks for one.
pub(crate) const LOGIN: (&str, &str) = ("robot", "a-test-only-password");

/// Certificate of the broker with TLS.
pub(crate) const CERTIFICATE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls/test-only-certificate.pem");

/// Key of that certificate.
const KEY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls/test-only-key.pem");

/// A broker and its kind of access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Debian's mosquitto, open to everybody.
    Mosquitto,
    /// Debian's mosquitto, used with MQTT 5.
    MosquittoFive,
    /// Debian's mosquitto, with a name and a password.
    MosquittoWithLogin,
    /// Debian's mosquitto, over TLS.
    MosquittoByTls,
    /// Debian's nats-server with JetStream, which it needs for MQTT.
    Nats,
}

pub(crate) struct Broker {
    kind: Kind,
    port: u16,
    folder: Folder,
    child: Option<Child>,
}

impl Kind {
    /// Whether the broker is installed. If it is missing, a message says what to install, or the test fails under
    /// `HALLSWEEP_REQUIRE_CLIENTS=1`.
    pub(crate) fn is_here(self) -> bool {
        let (program, package) = (self.program(), if self == Kind::Nats { "nats-server" } else { "mosquitto" });
        let runs = Command::new(program).arg("-h").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
        runs || left_out(&format!("{program} (apt-get install {package})"))
    }

    /// Path of the program. Debian installs servers in a folder that is not on every user's `PATH`.
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
    /// Starts a broker. `name` is the name of the test.
    pub(crate) fn start(kind: Kind, name: &str) -> Broker {
        let mut broker = Broker { kind, port: free_port(), folder: Folder::new(&format!("mqtt-{name}")), child: None };
        let path = broker.folder.path().join("broker.conf");
        std::fs::write(path, broker.settings()).expect("the folder can be written");
        broker.start_again();
        broker
    }

    /// Kills the broker, so that it disconnects no client in order.
    pub(crate) fn kill(&mut self) {
        if let Some(mut child) = self.child.take() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }

    /// Starts the broker again on the same port, and waits until the port is open.
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

    pub(crate) fn kind(&self) -> Kind {
        self.kind
    }

    /// Port on loopback.
    pub(crate) fn port(&self) -> u16 {
        self.port
    }

    /// URL of the broker, in the form of `mqtt.broker`.
    pub(crate) fn url(&self) -> String {
        let scheme = if self.kind == Kind::MosquittoByTls { "mqtts" } else { "mqtt" };
        format!("{scheme}://127.0.0.1:{}", self.port)
    }

    /// Waits until the log contains these words.
    pub(crate) fn until_it_says(&self, words: &str) {
        let deadline = Deadline::within(PATIENCE);
        while !self.log().contains(words) {
            assert!(!deadline.has_passed(), "{:?} never wrote: {words}", self.kind);
            sleep(GLANCE);
        }
    }

    pub(crate) fn log(&self) -> String {
        std::fs::read_to_string(self.folder.path().join("broker.log")).unwrap_or_default()
    }

    fn settings(&self) -> String {
        let (port, folder) = (self.port, self.folder.text());
        // If root starts mosquitto, it changes to a user who may not read the folder.
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

/// Reports that a test is skipped and why. Fails instead if `HALLSWEEP_REQUIRE_CLIENTS=1`.
fn left_out(missing: &str) -> bool {
    let required = std::env::var("HALLSWEEP_REQUIRE_CLIENTS").is_ok_and(|value| value == "1");
    assert!(!required, "the tests of the MQTT door need {missing}");
    // Written to standard error directly, because the test harness would capture a print.
    writeln!(std::io::stderr(), "a test of the MQTT door is left out: it needs {missing}").expect("standard error is open");
    false
}

/// Port on which nothing listens and that no other test of this run has received.
fn free_port() -> u16 {
    static NEXT: AtomicU16 = AtomicU16::new(0);
    // The process id separates test runs that happen at the same time.
    let first = PORTS + u16::try_from(std::process::id() % 1000).expect("it is below 1000") * 10;
    loop {
        let port = first + NEXT.fetch_add(1, Ordering::Relaxed);
        if TcpListener::bind((Ipv4Addr::LOCALHOST, port)).is_ok() {
            return port;
        }
    }
}
