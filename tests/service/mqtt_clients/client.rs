//! MQTT clients that others wrote, as users have them: mosquitto's commands from Debian, paho-mqtt from PyPI, MQTT.js from npm over
//! TCP and over WebSocket. How each is found and started; what they are told is the tests' business.

use std::net::SocketAddr;
use std::process::{Command, Stdio};

use super::told::{Hello, Say};
use crate::program::Program;
use crate::third_party::{folder, left_out, patiently, python, runs};

/// A client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Client {
    /// `mosquitto_sub` and `mosquitto_pub` (Debian's mosquitto-clients).
    Mosquitto,
    /// The library paho-mqtt of PyPI.
    Paho,
    /// The library `mqtt` of npm, over TCP.
    MqttJs,
    /// The same over WebSocket.
    MqttJsWeb,
}

impl Client {
    /// All of them.
    pub(crate) const ALL: [Client; 4] = [Client::Mosquitto, Client::Paho, Client::MqttJs, Client::MqttJsWeb];

    /// Whether it is there. When it is not, a word says what to install, or the test fails under `HALLSWEEP_REQUIRE_CLIENTS=1`.
    pub(crate) fn is_here(self) -> bool {
        let (here, missing) = match self {
            Client::Mosquitto => (
                // Both commands end with 1 after they have shown how they are used.
                [SUB, PUB].iter().all(|name| Command::new(name).arg("--help").stdin(Stdio::null()).output().is_ok()),
                "mosquitto_sub and mosquitto_pub (apt-get install mosquitto-clients)",
            ),
            Client::Paho => (
                runs(python().args(["-c", "import paho.mqtt.client"])),
                "paho-mqtt (python3 -m pip install --target tests/clients/python_modules -r tests/clients/requirements.txt)",
            ),
            Client::MqttJs | Client::MqttJsWeb => (
                folder().join("node_modules/mqtt").exists() && runs(Command::new("node").arg("--version")),
                "MQTT.js (apt-get install nodejs npm; npm --prefix tests/clients ci)",
            ),
        };
        here || left_out("MQTT", missing)
    }

    /// Where it comes to: by WebSocket on the port of the console.
    pub(super) fn door(self, program: &Program) -> SocketAddr {
        if self == Client::MqttJsWeb { program.address() } else { program.mqtt() }
    }

    /// What starts it, so that it comes in as told and prints what it hears.
    pub(super) fn command(self, door: SocketAddr, hello: &Hello) -> Command {
        let mut command = match self {
            Client::Mosquitto => return mosquitto_sub(door, hello),
            Client::Paho => python(),
            Client::MqttJs | Client::MqttJsWeb => Command::new("node"),
        };
        let script = if self == Client::Paho { "talk.py" } else { "talk.mjs" };
        command.arg(folder().join(script)).arg(hello.json(door, self == Client::MqttJsWeb).to_string());
        command
    }
}

const SUB: &str = "mosquitto_sub";
const PUB: &str = "mosquitto_pub";

/// Publishes one message with mosquitto's command, and returns what that printed; fails when it does.
pub(super) fn mosquitto_pub(door: SocketAddr, hello: &Hello, say: Say) -> String {
    let mut command = Command::new(PUB);
    at(&mut command, door, hello);
    command.args(["-d", "-t", say.topic, "-q", &say.qos.to_string()]);
    if say.retain {
        command.arg("-r");
    }
    if say.payload.is_empty() {
        command.arg("-n");
    } else {
        command.args(["-m", say.payload]);
    }
    let output = patiently(&command).output().expect("it was there just now");
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{say:?}: {said}");
    said
}

fn mosquitto_sub(door: SocketAddr, hello: &Hello) -> Command {
    // Its words about the connection would wait in the pipe otherwise.
    let mut command = Command::new("stdbuf");
    command.args(["-oL", SUB]);
    at(&mut command, door, hello);
    command.args(["-d", "-F", "%j", "-k", &hello.keepalive_s.to_string()]);
    let qos = hello.follow.iter().map(|(_, qos)| *qos).max().unwrap_or_default();
    command.args(["-q", &qos.to_string()]);
    for (filter, _) in &hello.follow {
        command.args(["-t", filter]);
    }
    if !hello.id.is_empty() {
        command.args(["-i", hello.id]);
    }
    if hello.remembered {
        command.arg("-c");
    }
    if let Some(will) = hello.will {
        command.args(["--will-topic", will.topic, "--will-payload", will.payload, "--will-qos", &will.qos.to_string()]);
        if will.retain {
            command.arg("--will-retain");
        }
    }
    command
}

fn at(command: &mut Command, door: SocketAddr, hello: &Hello) {
    command.args(["-h", &door.ip().to_string(), "-p", &door.port().to_string()]);
    if let Some((name, password)) = hello.login {
        command.args(["-u", name, "-P", password]);
    }
}
