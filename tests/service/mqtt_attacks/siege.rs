//! A program under attack, and a screen that was connected before. During and after the attack the screen is served,
//! new clients are accepted, and the broker is not restarted.

use std::fs::File;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::client::Client;
use super::packets::{connect, connect_as};
use crate::access::Folder;
use crate::program::{Program, hallsweep};

/// Arguments of the program.
const SERVE: [&str; 9] = ["serve", "--http", "127.0.0.1:0", "--seed", "1", "--hall", "empty-8x8", "--speed", "4"];

/// Topic of the state that the screen follows.
const STATE: &str = "hallsweep/discovery/state/temperature";

/// Number of the next siege, for a separate log file of each program.
static SIEGES: AtomicUsize = AtomicUsize::new(0);

pub(crate) struct Siege {
    pub(crate) program: Program,
    pub(crate) broker: SocketAddr,
    screen: Client,
    said: PathBuf,
    /// Whether new clients use MQTT 5.
    pub(crate) is_five: bool,
    /// Key of the screen and of new clients, if the broker asks for one.
    key: Option<(String, String)>,
    /// Last reported temperature in degrees; each report is a different one.
    celsius: u32,
}

impl Siege {
    /// Starts the program and connects the screen.
    pub(crate) fn begin() -> Siege {
        Siege::of(&mut hallsweep(&SERVE), None)
    }

    /// Runs a test in MQTT 3.1.1 and then in MQTT 5.
    pub(crate) fn in_both(test: impl Fn(Siege)) {
        for is_five in [false, true] {
            // The test harness prints this when the test fails.
            eprintln!("in MQTT {}", if is_five { "5" } else { "3.1.1" });
            let mut siege = Siege::begin();
            siege.is_five = is_five;
            test(siege);
        }
    }

    /// A connection that has sent nothing.
    pub(crate) fn stranger(&self) -> Client {
        Client::speaking(self.broker, self.is_five)
    }

    /// Like `begin`, with this router.
    pub(crate) fn routed_by(router: &str) -> Siege {
        Siege::of(hallsweep(&SERVE).env("HALLSWEEP__MQTT__ROUTER", router), None)
    }

    /// Like `begin`, but the program asks for the keys of this folder. The screen has the operator's key.
    pub(crate) fn with_keys(folder: &Folder) -> Siege {
        let mut command = folder.command(&SERVE);
        let key = ("operator".to_owned(), folder.token_of("operator"));
        Siege::of(command.env("HALLSWEEP__MQTT__REQUIRE_PASSWORD", "true"), Some(key))
    }

    fn of(command: &mut Command, key: Option<(String, String)>) -> Siege {
        let number = SIEGES.fetch_add(1, Ordering::Relaxed);
        let said = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("siege-{}-{number}.log", std::process::id()));
        let file = File::create(&said).expect("a file can be made");
        let program = Program::started(command.stderr(file));
        let broker = program.mqtt();
        let mut screen = come(broker, "screen", key.as_ref(), false).expect("the screen is let in");
        assert_eq!(screen.subscribe(STATE, 1), 1);
        let mut siege = Siege { program, broker, screen, said, is_five: false, key, celsius: 10 };
        siege.is_served();
        siege
    }

    /// Connects a client with this id.
    pub(crate) fn client(&self, client_id: &str) -> Client {
        come(self.broker, client_id, self.key.as_ref(), self.is_five).expect("a client is let in")
    }

    /// Fails unless the screen receives the next change of the state.
    pub(crate) fn is_served(&mut self) {
        self.celsius = if self.celsius < 20 { self.celsius + 1 } else { 10 };
        let celsius = f64::from(self.celsius) + 0.25;
        self.program.put("/api/v1/temperature", &format!("{{\"celsius\":{celsius}}}")).accepted();
        loop {
            let message = self.screen.message();
            let state: serde_json::Value = serde_json::from_slice(&message.payload).expect("the state is JSON");
            if state["celsius"] == celsius {
                break;
            }
        }
    }

    /// Fails unless the screen is served, a new client connects and finds the state, and the log shows no failure.
    pub(crate) fn stands(&mut self) {
        self.is_served();
        let mut newcomer = self.client("newcomer");
        assert_eq!(newcomer.subscribe("hallsweep/discovery/#", 0), 0);
        while newcomer.message().topic != STATE {}
        let said = self.said();
        for word in ["a new rumqttd replaces it", "panicked", "has ended"] {
            assert!(!said.contains(word), "{said}");
        }
    }

    /// Resident memory of the program, in MiB.
    pub(crate) fn memory_mib(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.program.id())).expect("it runs");
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("the system says so");
        line.split_whitespace().next().and_then(|kib| kib.parse::<u64>().ok()).expect("a number of KiB") / 1024
    }

    /// Number of open descriptors of the program.
    pub(crate) fn descriptors(&self) -> usize {
        std::fs::read_dir(format!("/proc/{}/fd", self.program.id())).expect("it runs").count()
    }

    /// Standard error of the program so far.
    pub(crate) fn said(&self) -> String {
        std::fs::read_to_string(&self.said).expect("the file is there")
    }
}

/// Connects a client, with the key if there is one.
fn come(broker: SocketAddr, client_id: &str, key: Option<&(String, String)>, is_five: bool) -> Option<Client> {
    let connect = key.map_or_else(|| connect(client_id, 60), |(name, token)| connect_as(client_id, (name, token)));
    Client::try_speaking(broker, &connect, is_five)
}

impl Drop for Siege {
    fn drop(&mut self) {
        // A leftover file is harmless. After a failed test it is kept for reading.
        if !std::thread::panicking() {
            let _ = std::fs::remove_file(&self.said);
        }
    }
}
