//! CoAP clients by other authors, as users install them: libcoap's command from Debian, aiocoap from PyPI, and
//! coap-cli from npm. This file finds, runs and reads each client; the tests choose the requests.

use std::process::{Command, Output, Stdio};

use super::ask::{Ask, Reply};
use crate::third_party::{PATIENCE_S, folder, left_out, patiently, python, runs, was_ended};

/// Three clients, because each interprets the RFCs in its own way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Client {
    /// `coap-client-notls` from Debian's libcoap3-bin.
    Libcoap,
    /// `aiocoap-client`, or the aiocoap library for requests that this command cannot send.
    Aiocoap,
    /// `coap` from npm's coap-cli, which uses node-coap.
    CoapCli,
}

impl Client {
    pub(crate) const ALL: [Client; 3] = [Client::Libcoap, Client::Aiocoap, Client::CoapCli];

    /// Whether the client is installed. If it is missing, a message says what to install, or the test fails under
    /// `HALLSWEEP_REQUIRE_CLIENTS=1`.
    pub(crate) fn is_here(self) -> bool {
        let (here, missing) = match self {
            // The command has no `--version`. Without arguments it prints its usage.
            Client::Libcoap => (
                Command::new(LIBCOAP).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok(),
                "coap-client-notls (apt-get install libcoap3-bin)",
            ),
            Client::Aiocoap => (
                runs(python().args(["-c", "import aiocoap"])),
                "aiocoap (python3 -m pip install --target tests/clients/python_modules -r tests/clients/requirements.txt)",
            ),
            Client::CoapCli => (
                folder().join(COAP_CLI).exists() && runs(Command::new("node").arg("--version")),
                "coap-cli (apt-get install nodejs npm; npm --prefix tests/clients ci)",
            ),
        };
        here || left_out("CoAP", missing)
    }

    /// Sends one request and reads the reply from the client's output.
    pub(crate) fn ask(self, url: &str, ask: &Ask) -> Reply {
        let output = self.run(url, ask);
        self.reply(&output)
    }

    /// Sends one request and returns everything that the client printed. Fails if the client does not end by itself.
    pub(crate) fn run(self, url: &str, ask: &Ask) -> Output {
        self.finish(&self.command(url, ask))
    }

    /// Runs a command of this client to its end and returns its output.
    pub(super) fn finish(self, command: &Command) -> Output {
        let output = patiently(command).stdin(Stdio::null()).output();
        let output = output.unwrap_or_else(|error| panic!("{self:?}: {error}"));
        let said = [&output.stdout, &output.stderr].map(|said| String::from_utf8_lossy(said));
        assert!(!was_ended(output.status), "{self:?} did not end by itself: {command:?} said {said:?}");
        output
    }

    /// Command line that sends this request.
    pub(crate) fn command(self, url: &str, ask: &Ask) -> Command {
        let url = format!("{url}{}", ask.path);
        match self {
            Client::Libcoap => libcoap(&url, ask),
            Client::Aiocoap if ask.block.is_some() || ask.observe || !ask.options.is_empty() => aiocoap_library(&url, ask),
            Client::Aiocoap => aiocoap_client(&url, ask),
            Client::CoapCli => coap_cli(&url, ask),
        }
    }

    /// Reads the reply from the client's output. Each client prints the code in its own place.
    fn reply(self, output: &Output) -> Reply {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let all = format!("{}\n{said}", String::from_utf8_lossy(&output.stdout));
        let code = match self {
            // libcoap prints nothing on success. On an error it prints a line with the code, followed by the payload.
            Client::Libcoap => said.lines().rev().find_map(first_code),
            Client::Aiocoap => said.lines().rev().find_map(|line| first_code(line.rsplit("client:").next()?)),
            Client::CoapCli => said.split('(').rev().find_map(first_code),
        };
        let mut printed = output.stdout.clone();
        // libcoap ends its output with a newline that does not belong to the payload.
        if self == Client::Libcoap && printed.last() == Some(&b'\n') {
            printed.pop();
        }
        let refused = code.as_ref().is_some_and(|code| !code.starts_with('2'));
        let body = if refused && printed.is_empty() { said.clone().into_bytes() } else { printed };
        Reply { code: code.unwrap_or_else(|| "2.xx".to_owned()), body, all }
    }
}

/// Debian has no plain `coap-client` command. This variant has no DTLS, which the tests do not need.
const LIBCOAP: &str = "coap-client-notls";

/// Path at which npm installs coap-cli.
const COAP_CLI: &str = "node_modules/coap-cli/index.js";

fn libcoap(url: &str, ask: &Ask) -> Command {
    let mut command = Command::new(LIBCOAP);
    command.args(["-m", ask.method, "-B", PATIENCE_S]);
    if ask.observe {
        command.args(["-s", PATIENCE_S]);
    }
    if ask.non {
        command.arg("-N");
    }
    let numbers = [("-t", ask.format), ("-A", ask.accept), ("-b", ask.block)];
    for (flag, value) in numbers.into_iter().filter_map(|(flag, number)| Some((flag, number?.to_string()))) {
        command.args([flag, &value]);
    }
    if let Some(payload) = ask.payload {
        command.args(["-e", payload]);
    }
    for (number, value) in &ask.options {
        command.args(["-O", &format!("{number},0x{}", hex(value))]);
    }
    if let Some(token) = ask.token {
        command.args(["-T", token]);
    }
    command.arg(url);
    command
}

fn aiocoap_client(url: &str, ask: &Ask) -> Command {
    let mut command = python();
    command.args(["-m", "aiocoap.cli.client", "-v", "-m", ask.method]);
    if ask.non {
        command.arg("--non");
    }
    let numbers = [("--content-format", ask.format), ("--accept", ask.accept)];
    for (flag, value) in numbers.into_iter().filter_map(|(flag, number)| Some((flag, number?.to_string()))) {
        command.args([flag, &value]);
    }
    if let Some(payload) = ask.payload {
        command.args(["--payload", payload]);
    }
    if let Some(size) = ask.upload_block {
        command.args(["--payload-initial-szx", &exponent(size)]);
    }
    command.arg(url);
    command
}

fn aiocoap_library(url: &str, ask: &Ask) -> Command {
    let mut command = python();
    command.arg(folder().join("ask.py")).arg("--method").arg(ask.method.to_uppercase());
    if ask.observe {
        command.arg("--observe");
    }
    if let Some(accept) = ask.accept {
        command.args(["--accept", &accept.to_string()]);
    }
    if let Some(size) = ask.block {
        command.args(["--block", &exponent(size)]);
    }
    if let Some(payload) = ask.payload {
        command.args(["--payload", payload]);
    }
    for (number, value) in &ask.options {
        command.args(["--option", &format!("{number},{}", hex(value))]);
    }
    command.arg(url);
    command
}

fn coap_cli(url: &str, ask: &Ask) -> Command {
    let mut command = Command::new("node");
    // Without `-n` coap-cli adds a newline, and changes bytes that are not text.
    command.arg(folder().join(COAP_CLI)).arg(ask.method).arg("-n");
    if ask.observe {
        command.arg("-o");
    }
    if ask.non {
        command.arg("-c");
    }
    if let Some(size) = ask.block {
        command.args(["-b", &exponent(size)]);
    }
    let numbers = [(12, ask.format), (17, ask.accept)];
    let numbers = numbers.into_iter().filter_map(|(option, number)| Some((option, number?.to_be_bytes().to_vec())));
    // coap-cli drops the query of a URL, so the query is sent as options.
    let (url, query) = url.split_once('?').unwrap_or((url, ""));
    let query = query.split('&').filter(|part| !part.is_empty()).map(|part| (15, part.as_bytes().to_vec()));
    for (number, value) in numbers.chain(query).chain(ask.options.iter().cloned()) {
        command.args(["-O", &format!("{number},0x{}", hex(&value))]);
    }
    if let Some(payload) = ask.payload {
        command.args(["-p", payload]);
    }
    command.arg(url);
    command
}

/// Exponent that encodes a block size: 0 for 16 bytes, 6 for 1024 (RFC 7959).
fn exponent(size: u16) -> String {
    (size.ilog2() - 4).to_string()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Response code at the beginning of a text, such as `4.09`.
fn first_code(text: &str) -> Option<String> {
    let code = text.trim_start().get(..4)?;
    let digits = code.chars().enumerate().all(|(place, letter)| if place == 1 { letter == '.' } else { letter.is_ascii_digit() });
    digits.then(|| code.to_owned())
}
