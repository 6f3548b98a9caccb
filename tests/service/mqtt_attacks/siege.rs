//! A program under attack, with a screen that was there before: whatever is done to the broker, the screen is served as before,
//! others get in, and the program did not have to begin anew.

use std::fs::File;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::client::Client;
use super::packets::{connect, connect_as};
use crate::access::Folder;
use crate::program::{Program, hallsweep};

/// The program.
const SERVE: [&str; 9] = ["serve", "--http", "127.0.0.1:0", "--seed", "1", "--hall", "empty-8x8", "--speed", "4"];

/// Where the state is.
const STATE: &str = "hallsweep/discovery/state/temperature";

/// Every siege has a file of its own for what its program says.
static SIEGES: AtomicUsize = AtomicUsize::new(0);

/// A program under attack.
pub(crate) struct Siege {
    pub(crate) program: Program,
    pub(crate) broker: SocketAddr,
    screen: Client,
    said: PathBuf,
    /// Whether those who come speak MQTT 5.
    pub(crate) is_five: bool,
    /// The key of the screen and of newcomers, where one is asked for.
    key: Option<(String, String)>,
    /// Degrees that were reported, each time others.
    celsius: u32,
}

impl Siege {
    /// Starts the program, and lets the screen come in.
    pub(crate) fn begin() -> Siege {
        Siege::of(&mut hallsweep(&SERVE), None)
    }

    /// One after the other in both versions of the protocol.
    pub(crate) fn in_both(test: impl Fn(Siege)) {
        for is_five in [false, true] {
            // Seen when it fails.
            eprintln!("in MQTT {}", if is_five { "5" } else { "3.1.1" });
            let mut siege = Siege::begin();
            siege.is_five = is_five;
            test(siege);
        }
    }

    /// Somebody who has said nothing.
    pub(crate) fn stranger(&self) -> Client {
        Client::speaking(self.broker, self.is_five)
    }

    /// The same with this router.
    pub(crate) fn routed_by(router: &str) -> Siege {
        Siege::of(hallsweep(&SERVE).env("HALLSWEEP__MQTT__ROUTER", router), None)
    }

    /// The same where keys are asked for, which are in this folder; the screen has that of the operator.
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

    /// A client that was let in, with this id.
    pub(crate) fn client(&self, client_id: &str) -> Client {
        come(self.broker, client_id, self.key.as_ref(), self.is_five).expect("a client is let in")
    }

    /// The screen gets the next change of the state.
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

    /// Nothing was lost: the screen is served still, a newcomer gets in and finds the state, and nothing broke.
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

    /// The memory that the program has in use, in MiB.
    pub(crate) fn memory_mib(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.program.id())).expect("it runs");
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("the system says so");
        line.split_whitespace().next().and_then(|kib| kib.parse::<u64>().ok()).expect("a number of KiB") / 1024
    }

    /// How many descriptors the program has in use.
    pub(crate) fn descriptors(&self) -> usize {
        std::fs::read_dir(format!("/proc/{}/fd", self.program.id())).expect("it runs").count()
    }

    /// What the program has said on standard error.
    pub(crate) fn said(&self) -> String {
        std::fs::read_to_string(&self.said).expect("the file is there")
    }
}

/// A client that was let in, with this key where one is asked for.
fn come(broker: SocketAddr, client_id: &str, key: Option<&(String, String)>, is_five: bool) -> Option<Client> {
    let connect = key.map_or_else(|| connect(client_id, 60), |(name, token)| connect_as(client_id, (name, token)));
    Client::try_speaking(broker, &connect, is_five)
}

impl Drop for Siege {
    fn drop(&mut self) {
        // Left behind it harms nobody; a failed test leaves it to be read.
        if !std::thread::panicking() {
            let _ = std::fs::remove_file(&self.said);
        }
    }
}
