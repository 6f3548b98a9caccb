//! The program under test: started on a free port, asked over HTTP, ended when the test ends.

use std::io::{BufRead, BufReader};
use std::net::{Ipv4Addr, SocketAddr};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::{Mutex, OnceLock, mpsc};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

/// How long anything is waited for: far longer than it takes, even on a busy machine.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// How often a state that is waited for is looked at.
const GLANCE: Duration = Duration::from_millis(5);

/// How the address is announced on standard output.
const ANNOUNCED: [&str; 2] = ["hallsweep is at http://", "hallsweep is at https://"];

/// A running program.
pub(crate) struct Program {
    child: Child,
    address: SocketAddr,
    coap: OnceLock<SocketAddr>,
    mqtt: OnceLock<SocketAddr>,
    said: Mutex<mpsc::Receiver<String>>,
    agent: ureq::Agent,
}

/// What a route answered.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) headers: ureq::http::HeaderMap,
    pub(crate) body: Vec<u8>,
}

/// How long something may still take.
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

/// The program with these arguments and none of the surroundings' settings.
pub(crate) fn hallsweep(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hallsweep"));
    command.args(arguments).stdin(Stdio::null());
    for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("HALLSWEEP_")) {
        command.env_remove(name);
    }
    command.env("HALLSWEEP__LOG__FILTER", "warn");
    // Every program has ports of its own for CoAP and MQTT too.
    command.env("HALLSWEEP__COAP__BIND", "127.0.0.1:0");
    command.env("HALLSWEEP__MQTT__BIND", "127.0.0.1:0");
    // Nothing is left on the machine that runs the tests; those about what is kept name a folder of their own.
    command.env("HALLSWEEP__STORE__FOLDER", "none");
    command
}

/// Runs the program to its end.
pub(crate) fn run(arguments: &[&str]) -> Output {
    hallsweep(arguments).output().expect("the program starts")
}

impl Program {
    /// Serves this hall at this speed on a free port.
    pub(crate) fn serve(hall: &str, speed: &str) -> Program {
        Program::with(&["serve", "--http", "127.0.0.1:0", "--seed", "1", "--hall", hall, "--speed", speed])
    }

    /// Starts with these arguments, and waits until it says where it is.
    pub(crate) fn with(arguments: &[&str]) -> Program {
        Program::started(&mut hallsweep(arguments))
    }

    /// Starts this command, and waits until it says where it is.
    pub(crate) fn started(command: &mut Command) -> Program {
        let mut child = command.stdout(Stdio::piped()).spawn().expect("the program starts");
        let mut lines = BufReader::new(child.stdout.take().expect("standard output is a pipe")).lines();
        let announced = lines.find_map(|line| {
            let line = line.ok()?;
            ANNOUNCED.iter().find_map(|words| line.strip_prefix(words))?.split(' ').next()?.parse().ok()
        });
        Program::found(child, announced.expect("the program says where it is"), lines)
    }

    /// A program that was started and listens here, and the lines that it prints from now on.
    pub(crate) fn found(
        child: Child,
        bound: SocketAddr,
        lines: impl Iterator<Item = std::io::Result<String>> + Send + 'static,
    ) -> Program {
        let address = reached(bound);
        // The pipe stays open until the program ends, so that writing to it never fails.
        let (say, said) = mpsc::channel();
        std::thread::spawn(move || lines.map_while(Result::ok).for_each(|line| drop(say.send(line))));
        let config = ureq::Agent::config_builder().http_status_as_error(false).proxy(None).max_redirects(0);
        let config = config.timeout_global(Some(PATIENCE)).build();
        Program { child, address, coap: OnceLock::new(), mqtt: OnceLock::new(), said: Mutex::new(said), agent: config.into() }
    }

    /// Where it listens.
    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Where its CoAP resources are, as it says after everything else.
    pub(crate) fn coap(&self) -> SocketAddr {
        self.announced(&self.coap)
    }

    /// Where its MQTT topics are, as it says after that.
    pub(crate) fn mqtt(&self) -> SocketAddr {
        self.announced(&self.mqtt)
    }

    /// The next line it prints after it has said where it is.
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

    /// What it has printed since, up to its end; it must have ended.
    pub(crate) fn last_words(&self) -> Vec<String> {
        self.said.lock().expect("nobody panics while listening").iter().collect()
    }

    /// Asks for a path, with headers.
    pub(crate) fn read(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        let request = headers.iter().fold(self.agent.get(self.url(path)), |request, (name, value)| request.header(*name, *value));
        Answer::of(request.call())
    }

    /// Asks for JSON under `/api/v1`.
    pub(crate) fn json(&self, resource: &str) -> Value {
        let answer = self.read(&format!("/api/v1/{resource}"), &[]);
        assert_eq!(answer.status, 200, "{resource}: {answer:?}");
        answer.json()
    }

    /// Posts to a path without a body.
    pub(crate) fn press(&self, path: &str) -> Answer {
        Answer::of(self.agent.post(self.url(path)).send_empty())
    }

    /// Posts a body with headers.
    pub(crate) fn post_with(&self, path: &str, headers: &[(&str, &str)], body: &str) -> Answer {
        let request = self.agent.post(self.url(path));
        Answer::of(headers.iter().fold(request, |request, (name, value)| request.header(*name, *value)).send(body))
    }

    /// Gives a command of the API without a body, as `start`.
    pub(crate) fn command(&self, name: &str) -> Answer {
        self.press(&format!("/api/v1/commands/{name}"))
    }

    /// Posts JSON to a path.
    pub(crate) fn post(&self, path: &str, body: &str) -> Answer {
        self.send("POST", path, "application/json", body)
    }

    /// Puts JSON to a path.
    pub(crate) fn put(&self, path: &str, body: &str) -> Answer {
        self.send("PUT", path, "application/json", body)
    }

    /// Sends a body of any type.
    pub(crate) fn send(&self, method: &str, path: &str, content_type: &str, body: &str) -> Answer {
        let request = if method == "PUT" { self.agent.put(self.url(path)) } else { self.agent.post(self.url(path)) };
        Answer::of(request.header("content-type", content_type).send(body))
    }

    pub(crate) fn delete(&self, path: &str) -> Answer {
        Answer::of(self.agent.delete(self.url(path)).call())
    }

    /// Says of a piece what it is.
    pub(crate) fn verdict(&self, luggage: u64, verdict: &str) -> Answer {
        self.post(&format!("/api/v1/luggage/{luggage}/verdict"), &format!("{{\"verdict\":\"{verdict}\"}}"))
    }

    /// Asks a program that may be gone: `None` then. `key` is the command's own name, if it has one.
    pub(crate) fn try_ask(&self, method: &str, path: &str, key: &str, body: &str) -> Option<Answer> {
        let request = ureq::http::Request::builder().method(method).uri(self.url(path));
        let request = if key.is_empty() { request } else { request.header("idempotency-key", key) };
        let request = if body.is_empty() { request } else { request.header("content-type", "application/json") };
        let (parts, mut body) = self.agent.run(request.body(body.to_owned()).ok()?).ok()?.into_parts();
        Some(Answer { status: parts.status.as_u16(), headers: parts.headers, body: body.read_to_vec().ok()? })
    }

    /// Waits until the state is as wanted, and returns it.
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

    /// Waits until a piece waits for its verdict, and returns its number.
    pub(crate) fn until_asked(&self) -> u64 {
        let state = self.until("a verdict is asked for", |state| pending(state).is_some());
        pending(&state).expect("it was there just now")
    }

    /// What kills it −9, from another thread.
    pub(crate) fn killer(&self) -> impl FnOnce() + Send + use<> {
        let id = self.child.id().to_string();
        move || assert!(Command::new("kill").args(["-KILL", &id]).status().expect("kill is there").success())
    }

    /// Sends a signal, as `TERM`.
    pub(crate) fn signal(&self, name: &str) {
        let sent = Command::new("kill").args([format!("-{name}"), self.child.id().to_string()]).status();
        assert!(sent.expect("kill is there").success());
    }

    /// The number of its process.
    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Waits for its end; `None` when it is still running after so long.
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

    /// Where a door is; its line is waited for.
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
        // It may have ended already, which is as good.
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

    /// The body as JSON.
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }

    /// The body as text.
    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// A header, empty when it is not there.
    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", |value| value.to_str().expect("a printable header"))
    }

    /// Fails unless it is an acceptance; returns its revision.
    pub(crate) fn accepted(&self) -> u64 {
        assert_eq!(self.status, 200, "{}", self.text());
        let json = self.json();
        assert_eq!(json["accepted"], true, "{json}");
        json["revision"].as_u64().expect("an acceptance names its revision")
    }

    /// Fails unless it is a problem with this status and a reason a person understands; returns the reason.
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

/// Where a door is reached that is at this address: one that listens everywhere is reached here.
fn reached(bound: SocketAddr) -> SocketAddr {
    let host = if bound.ip().is_unspecified() { Ipv4Addr::LOCALHOST.into() } else { bound.ip() };
    SocketAddr::new(host, bound.port())
}

/// The piece that waits for its verdict in a phase in which the operator is asked.
fn pending(state: &Value) -> Option<u64> {
    let pieces = state["luggage"].as_array()?.iter();
    pieces.filter(|piece| piece["verdict"] == "pending").find_map(|piece| piece["id"].as_u64())
}
