//! The program under test: started on a free port, driven over HTTP, and ended with the test.

use std::io::{BufRead, BufReader};
use std::net::{Ipv4Addr, SocketAddr};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::{Mutex, OnceLock, mpsc};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

/// Longest wait for anything. It is far longer than needed, even on a busy machine.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// Interval between two checks of an awaited state.
const GLANCE: Duration = Duration::from_millis(5);

/// Beginning of the line on standard output that announces the address.
const ANNOUNCED: [&str; 2] = ["hallsweep is at http://", "hallsweep is at https://"];

pub(crate) struct Program {
    child: Child,
    address: SocketAddr,
    coap: OnceLock<SocketAddr>,
    mqtt: OnceLock<SocketAddr>,
    said: Mutex<mpsc::Receiver<String>>,
    agent: ureq::Agent,
}

#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) headers: ureq::http::HeaderMap,
    pub(crate) body: Vec<u8>,
}

pub(crate) struct Deadline(Instant);

impl Deadline {
    #[expect(clippy::disallowed_methods, reason = "a test bounds its own patience by the real clock")]
    pub(crate) fn within(patience: Duration) -> Deadline {
        Deadline(Instant::now() + patience)
    }

    #[expect(clippy::disallowed_methods, reason = "a test bounds its own patience by the real clock")]
    pub(crate) fn has_passed(&self) -> bool {
        Instant::now() > self.0
    }
}

/// Command for the program with these arguments, without any setting from the environment.
pub(crate) fn hallsweep(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hallsweep"));
    command.args(arguments).stdin(Stdio::null());
    for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("HALLSWEEP_")) {
        command.env_remove(name);
    }
    command.env("HALLSWEEP__LOG__FILTER", "warn");
    // Each program also has its own ports for CoAP and MQTT.
    command.env("HALLSWEEP__COAP__BIND", "127.0.0.1:0");
    command.env("HALLSWEEP__MQTT__BIND", "127.0.0.1:0");
    // The tests leave no data on the machine. Tests of stored data name their own folder.
    command.env("HALLSWEEP__STORE__FOLDER", "none");
    command
}

pub(crate) fn run(arguments: &[&str]) -> Output {
    hallsweep(arguments).output().expect("the program starts")
}

impl Program {
    /// Starts the program with this hall and speed on a free port.
    pub(crate) fn serve(hall: &str, speed: &str) -> Program {
        Program::with(&["serve", "--http", "127.0.0.1:0", "--seed", "1", "--hall", hall, "--speed", speed])
    }

    /// Starts the program with these arguments and waits until it prints its address.
    pub(crate) fn with(arguments: &[&str]) -> Program {
        Program::started(&mut hallsweep(arguments))
    }

    /// Starts this command and waits until it prints its address.
    pub(crate) fn started(command: &mut Command) -> Program {
        let mut child = command.stdout(Stdio::piped()).spawn().expect("the program starts");
        let mut lines = BufReader::new(child.stdout.take().expect("standard output is a pipe")).lines();
        let announced = lines.find_map(|line| {
            let line = line.ok()?;
            ANNOUNCED.iter().find_map(|words| line.strip_prefix(words))?.split(' ').next()?.parse().ok()
        });
        Program::found(child, announced.expect("the program says where it is"), lines)
    }

    /// Wraps a running program that listens at `bound`. `lines` are its further lines of output.
    pub(crate) fn found(
        child: Child,
        bound: SocketAddr,
        lines: impl Iterator<Item = std::io::Result<String>> + Send + 'static,
    ) -> Program {
        let address = reached(bound);
        // The pipe stays open until the program ends, so that the program's writes never fail.
        let (say, said) = mpsc::channel();
        std::thread::spawn(move || lines.map_while(Result::ok).for_each(|line| drop(say.send(line))));
        let config = ureq::Agent::config_builder().http_status_as_error(false).proxy(None).max_redirects(0);
        let config = config.timeout_global(Some(PATIENCE)).build();
        Program { child, address, coap: OnceLock::new(), mqtt: OnceLock::new(), said: Mutex::new(said), agent: config.into() }
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Address of the CoAP interface, which the program prints after the HTTP address.
    pub(crate) fn coap(&self) -> SocketAddr {
        self.announced(&self.coap)
    }

    /// Address of the MQTT interface, which the program prints after the CoAP address.
    pub(crate) fn mqtt(&self) -> SocketAddr {
        self.announced(&self.mqtt)
    }

    /// Next line of output after the HTTP address.
    pub(crate) fn says(&self) -> String {
        let said = self.said.lock().expect("nobody panics while listening");
        let line = said.recv_timeout(PATIENCE).expect("the program says something more");
        for (scheme, door) in [("coap://", &self.coap), ("mqtt://", &self.mqtt)] {
            if let Some((_, at)) = line.split_once(scheme) {
                let at = at.split(' ').next().and_then(|at| at.parse().ok());
                door.get_or_init(|| reached(at.expect("an address with a port")));
            }
        }
        line
    }

    /// Remaining lines of output, up to the end of the program. The program must have ended.
    pub(crate) fn last_words(&self) -> Vec<String> {
        self.said.lock().expect("nobody panics while listening").iter().collect()
    }

    /// Sends a GET with headers.
    pub(crate) fn read(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        let request = headers.iter().fold(self.agent.get(self.url(path)), |request, (name, value)| request.header(*name, *value));
        Answer::of(request.call())
    }

    /// Reads JSON under `/api/v1`.
    pub(crate) fn json(&self, resource: &str) -> Value {
        let answer = self.read(&format!("/api/v1/{resource}"), &[]);
        assert_eq!(answer.status, 200, "{resource}: {answer:?}");
        answer.json()
    }

    /// Sends a POST without a body.
    pub(crate) fn press(&self, path: &str) -> Answer {
        Answer::of(self.agent.post(self.url(path)).send_empty())
    }

    /// Sends a POST with a body and headers.
    pub(crate) fn post_with(&self, path: &str, headers: &[(&str, &str)], body: &str) -> Answer {
        let request = self.agent.post(self.url(path));
        Answer::of(headers.iter().fold(request, |request, (name, value)| request.header(*name, *value)).send(body))
    }

    /// Sends a command of the API without a body, such as `start`.
    pub(crate) fn command(&self, name: &str) -> Answer {
        self.press(&format!("/api/v1/commands/{name}"))
    }

    /// Sends a POST with a JSON body.
    pub(crate) fn post(&self, path: &str, body: &str) -> Answer {
        self.send("POST", path, "application/json", body)
    }

    /// Sends a PUT with a JSON body.
    pub(crate) fn put(&self, path: &str, body: &str) -> Answer {
        self.send("PUT", path, "application/json", body)
    }

    /// Sends a POST or PUT with a body of this type.
    pub(crate) fn send(&self, method: &str, path: &str, content_type: &str, body: &str) -> Answer {
        let request = if method == "PUT" { self.agent.put(self.url(path)) } else { self.agent.post(self.url(path)) };
        Answer::of(request.header("content-type", content_type).send(body))
    }

    pub(crate) fn delete(&self, path: &str) -> Answer {
        Answer::of(self.agent.delete(self.url(path)).call())
    }

    /// Sends a verdict about a piece.
    pub(crate) fn verdict(&self, luggage: u64, verdict: &str) -> Answer {
        self.post(&format!("/api/v1/luggage/{luggage}/verdict"), &format!("{{\"verdict\":\"{verdict}\"}}"))
    }

    /// Sends a request, and returns `None` if the program is gone. `key` is the idempotency key; empty for none.
    pub(crate) fn try_ask(&self, method: &str, path: &str, key: &str, body: &str) -> Option<Answer> {
        let request = ureq::http::Request::builder().method(method).uri(self.url(path));
        let request = if key.is_empty() { request } else { request.header("idempotency-key", key) };
        let request = if body.is_empty() { request } else { request.header("content-type", "application/json") };
        let (parts, mut body) = self.agent.run(request.body(body.to_owned()).ok()?).ok()?.into_parts();
        Some(Answer { status: parts.status.as_u16(), headers: parts.headers, body: body.read_to_vec().ok()? })
    }

    /// Waits until the state matches, and returns it.
    pub(crate) fn until(&self, wanted: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let deadline = Deadline::within(PATIENCE);
        loop {
            let state = self.json("state");
            if is_so(&state) {
                return state;
            }
            assert!(!deadline.has_passed(), "never came to be: {wanted}; the state is\n{state:#}");
            sleep(GLANCE);
        }
    }

    /// Waits for a phase.
    pub(crate) fn until_phase(&self, phase: &str) -> Value {
        self.until(phase, |state| state["mission"]["phase"] == phase)
    }

    /// Waits until a piece is pending, and returns its number.
    pub(crate) fn until_asked(&self) -> u64 {
        let state = self.until("a verdict is asked for", |state| pending(state).is_some());
        pending(&state).expect("it was there just now")
    }

    /// Closure that kills the program with SIGKILL, for use in another thread.
    pub(crate) fn killer(&self) -> impl FnOnce() + Send + use<> {
        let id = self.child.id().to_string();
        move || assert!(Command::new("kill").args(["-KILL", &id]).status().expect("kill is there").success())
    }

    /// Sends a signal, such as `TERM`.
    pub(crate) fn signal(&self, name: &str) {
        let sent = Command::new("kill").args([format!("-{name}"), self.child.id().to_string()]).status();
        assert!(sent.expect("kill is there").success());
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Waits for the end of the program. Returns `None` if it is still running after `patience`.
    pub(crate) fn ended_within(&mut self, patience: Duration) -> Option<ExitStatus> {
        let deadline = Deadline::within(patience);
        while !deadline.has_passed() {
            if let Some(status) = self.child.try_wait().expect("the child is ours") {
                return Some(status);
            }
            sleep(GLANCE);
        }
        None
    }

    /// Address of an interface, read from the output of the program.
    fn announced(&self, door: &OnceLock<SocketAddr>) -> SocketAddr {
        loop {
            if let Some(at) = door.get() {
                return *at;
            }
            self.says();
        }
    }

    fn url(&self, path: &str) -> String {
        format!("http://{}{path}", self.address)
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // The process may have ended already, which is fine.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Answer {
    fn of(response: Result<ureq::http::Response<ureq::Body>, ureq::Error>) -> Answer {
        let (parts, mut body) = response.expect("the program answers").into_parts();
        let body = body.read_to_vec().expect("the answer is whole");
        Answer { status: parts.status.as_u16(), headers: parts.headers, body }
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// Value of a header. Empty if it is missing.
    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", |value| value.to_str().expect("a printable header"))
    }

    /// Fails unless the answer is an acceptance. Returns its revision.
    pub(crate) fn accepted(&self) -> u64 {
        assert_eq!(self.status, 200, "{}", self.text());
        let json = self.json();
        assert_eq!(json["accepted"], true, "{json}");
        json["revision"].as_u64().expect("an acceptance names its revision")
    }

    /// Fails unless the answer is a problem with this status and an understandable reason. Returns the reason.
    pub(crate) fn problem(&self, status: u16) -> String {
        assert_eq!(self.status, status, "{}", self.text());
        assert!(self.header("content-type").starts_with("application/problem+json"), "{:?}", self.headers);
        let json = self.json();
        assert_eq!(json["status"], status, "{json}");
        let detail = json["detail"].as_str().unwrap_or_default().to_owned();
        assert!(detail.split_whitespace().count() >= 3, "`{detail}` explains nothing");
        detail
    }
}

/// Address for a connection to a bound socket: loopback if the socket is bound to every address.
fn reached(bound: SocketAddr) -> SocketAddr {
    let host = if bound.ip().is_unspecified() { Ipv4Addr::LOCALHOST.into() } else { bound.ip() };
    SocketAddr::new(host, bound.port())
}

/// Number of a piece without a verdict.
fn pending(state: &Value) -> Option<u64> {
    let pieces = state["luggage"].as_array()?.iter();
    pieces.filter(|piece| piece["verdict"] == "pending").find_map(|piece| piece["id"].as_u64())
}
