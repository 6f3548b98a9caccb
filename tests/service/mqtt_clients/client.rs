//! MQTT clients by other authors, as users install them: mosquitto's commands from Debian, paho-mqtt from PyPI, and
//! MQTT.js from npm over TCP and WebSocket. This file finds and starts each client; the tests choose its actions.

use std::net::SocketAddr;
use std::process::{Command, Stdio};

use super::told::{Hello, Say};
use crate::program::Program;
use crate::third_party::{folder, left_out, patiently, python, runs};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Client {
    /// `mosquitto_sub` and `mosquitto_pub` from Debian's mosquitto-clients.
    Mosquitto,
    /// The library paho-mqtt from PyPI.
    Paho,
    /// The library `mqtt` from npm, over TCP.
    MqttJs,
    /// The library `mqtt` from npm, over WebSocket.
    MqttJsWeb,
    /// The same clients in MQTT 5.
    MosquittoFive,
    PahoFive,
    MqttJsFive,
    MqttJsWebFive,
}

/// Software behind a client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Library {
    Mosquitto,
    Paho,
    MqttJs,
}

impl Client {
    pub(crate) const ALL: [Client; 8] = [
        Client::Mosquitto,
        Client::Paho,
        Client::MqttJs,
        Client::MqttJsWeb,
        Client::MosquittoFive,
        Client::PahoFive,
        Client::MqttJsFive,
        Client::MqttJsWebFive,
    ];

    pub(crate) const fn library(self) -> Library {
        match self {
            Client::Mosquitto | Client::MosquittoFive => Library::Mosquitto,
            Client::Paho | Client::PahoFive => Library::Paho,
            Client::MqttJs | Client::MqttJsFive | Client::MqttJsWeb | Client::MqttJsWebFive => Library::MqttJs,
        }
    }

    pub(crate) const fn is_five(self) -> bool {
        matches!(self, Client::MosquittoFive | Client::PahoFive | Client::MqttJsFive | Client::MqttJsWebFive)
    }

    /// Whether the client connects by WebSocket.
    pub(crate) const fn is_web(self) -> bool {
        matches!(self, Client::MqttJsWeb | Client::MqttJsWebFive)
    }

    pub(crate) fn is_mosquitto(self) -> bool {
        self.library() == Library::Mosquitto
    }

    /// Whether the client is installed. If it is missing, a message says what to install, or the test fails under
    /// `HALLSWEEP_REQUIRE_CLIENTS=1`.
    pub(crate) fn is_here(self) -> bool {
        let (here, missing) = match self.library() {
            Library::Mosquitto => (
                // Both commands print their usage and exit with 1.
                [SUB, PUB].iter().all(|name| Command::new(name).arg("--help").stdin(Stdio::null()).output().is_ok()),
                "mosquitto_sub and mosquitto_pub (apt-get install mosquitto-clients)",
            ),
            Library::Paho => (
                runs(python().args(["-c", "import paho.mqtt.client"])),
                "paho-mqtt (python3 -m pip install --target tests/clients/python_modules -r tests/clients/requirements.txt)",
            ),
            Library::MqttJs => (
                folder().join("node_modules/mqtt").exists() && runs(Command::new("node").arg("--version")),
                "MQTT.js (apt-get install nodejs npm; npm --prefix tests/clients ci)",
            ),
        };
        here || left_out("MQTT", missing)
    }

    /// Address for this client: WebSocket clients use the port of the console.
    pub(super) fn door(self, program: &Program) -> SocketAddr {
        if self.is_web() { program.address() } else { program.mqtt() }
    }

    /// Command that connects as `hello` says and prints what it receives.
    pub(super) fn command(self, door: SocketAddr, hello: &Hello) -> Command {
        let (mut command, script) = match self.library() {
            Library::Mosquitto => return mosquitto_sub(door, hello, self.is_five()),
            Library::Paho => (python(), "talk.py"),
            Library::MqttJs => (Command::new("node"), "talk.mjs"),
        };
        let told = hello.json(door, self.is_web(), self.is_five());
        command.arg(folder().join(script)).arg(told.to_string());
        command
    }
}

const SUB: &str = "mosquitto_sub";
const PUB: &str = "mosquitto_pub";

/// Publishes one message with mosquitto's command and returns its output. Fails if the command fails.
pub(super) fn mosquitto_pub(door: SocketAddr, hello: &Hello, say: Say, is_five: bool) -> String {
    let mut command = Command::new(PUB);
    at(&mut command, door, hello, is_five);
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

/// Publishes a command and waits for the answer with `mosquitto_rr`. Returns the answer with its properties.
pub(crate) fn mosquitto_rr(port: u16, command: &str, answer: &str) -> serde_json::Value {
    let mut asked = Command::new("mosquitto_rr");
    asked.args(["-h", "127.0.0.1", "-p", &port.to_string(), "-V", "mqttv5", "-t", command, "-e", answer, "-n", "-F", "%j"]);
    let output = patiently(&asked).output().expect("it comes with the others");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

fn mosquitto_sub(door: SocketAddr, hello: &Hello, is_five: bool) -> Command {
    // `stdbuf` flushes each line; otherwise messages about the connection would stay in the command's buffer.
    let mut command = Command::new("stdbuf");
    command.args(["-oL", SUB]);
    at(&mut command, door, hello, is_five);
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
        if is_five {
            command.args(["-x", "300"]);
        }
    }
    if let Some(will) = hello.will {
        command.args(["--will-topic", will.topic, "--will-payload", will.payload, "--will-qos", &will.qos.to_string()]);
        if will.retain {
            command.arg("--will-retain");
        }
    }
    command
}

fn at(command: &mut Command, door: SocketAddr, hello: &Hello, is_five: bool) {
    command.args(["-V", if is_five { "mqttv5" } else { "mqttv311" }]);
    command.args(["-h", &door.ip().to_string(), "-p", &door.port().to_string()]);
    if let Some((name, password)) = hello.login {
        command.args(["-u", name, "-P", password]);
    }
}
