//! Access control: keys beyond loopback, the key file, `hallsweep token`, sessions, the viewer and operator
//! roles, and host names. The program binds to every address, but the tests reach it over loopback only.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::program::{Answer, Deadline, PATIENCE, Program, hallsweep};

const FORM: (&str, &str) = ("content-type", "application/x-www-form-urlencoded");
const BROWSER: (&str, &str) = ("accept", "text/html,application/xhtml+xml,*/*;q=0.8");

/// Data folder that is removed when the test ends.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Folder {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("access-{name}-{}", std::process::id()));
        // A leftover exists only if an earlier run was interrupted.
        let _ = std::fs::remove_dir_all(&path);
        Folder(path)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    fn file(&self) -> PathBuf {
        self.0.join("access.toml")
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = hallsweep(arguments);
        command.env("HALLSWEEP__STORE__FOLDER", &self.0);
        command
    }

    /// Starts the program on an address that other machines could reach.
    fn serve(&self) -> Program {
        Program::started(&mut self.command(&["serve", "--http", "0.0.0.0:0", "--hall", "empty-8x8", "--speed", "4"]))
    }

    /// Output of `hallsweep token`.
    pub(crate) fn token(&self, arguments: &[&str]) -> String {
        let output = self.command(&[&["token"], arguments].concat()).output().expect("the program starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Token of the named key, read from the output of `hallsweep token`.
    pub(crate) fn token_of(&self, name: &str) -> String {
        let shown = self.token(&[]);
        let key = shown.split(&format!("{name} (")).nth(1).expect("the key is shown");
        key.lines().nth(1).and_then(|line| line.split_whitespace().nth(1)).expect("its token is shown").to_owned()
    }

    /// Error message with which `hallsweep token` refuses these arguments.
    fn refused(&self, arguments: &[&str]) -> String {
        let output = self.command(&[&["token"], arguments].concat()).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A leftover folder is harmless.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A program with a journal and two keys: one of an operator, and one of a viewer named `lobby`.
pub(crate) struct Site {
    pub(crate) program: Program,
    pub(crate) operator: String,
    pub(crate) viewer: String,
    pub(crate) folder: Folder,
}

impl Site {
    /// Enables the named settings, such as `HTTP__REQUIRE_TOKEN`, which make an interface ask for keys. The other
    /// interfaces stay open to this machine.
    pub(crate) fn new(name: &str, asks: &[&str]) -> Site {
        Site::in_hall(name, asks, "empty-8x8", "4")
    }

    /// Like `new`, but with the given hall and speed.
    pub(crate) fn in_hall(name: &str, asks: &[&str], hall: &str, speed: &str) -> Site {
        let folder = Folder::new(name);
        folder.token(&["add", "lobby", "--role", "viewer"]);
        let [operator, viewer] = ["operator", "lobby"].map(|name| folder.token_of(name));
        let mut command = folder.command(&["serve", "--http", "127.0.0.1:0", "--hall", hall, "--speed", speed]);
        command.envs(asks.iter().map(|asks| (format!("HALLSWEEP__{asks}"), "true")));
        Site { program: Program::started(&mut command), operator, viewer, folder }
    }
}

fn bearer(token: &str) -> String {
    format!("Bearer {token}")
}

/// Status of a read of the state with this token.
fn looks(program: &Program, token: &str) -> u16 {
    program.read("/api/v1/state", &[("authorization", &bearer(token))]).status
}

/// Sends a command of the API with this token.
fn commands(program: &Program, token: &str, command: &str) -> Answer {
    program.post_with(&format!("/api/v1/commands/{command}"), &[("authorization", &bearer(token))], "")
}

/// Signs in and returns the session cookie.
pub(crate) fn sign_in(program: &Program, token: &str) -> String {
    let answer = program.post_with("/sign-in", &[FORM, BROWSER], &format!("token={token}&next=/"));
    assert_eq!((answer.status, answer.header("location")), (303, "./"));
    answer.header("set-cookie").split(';').next().expect("a cookie").to_owned()
}

/// Waits until a read of the state has this status, because a changed key takes effect only after a moment.
fn until_looks(program: &Program, token: &str, status: u16) {
    let deadline = crate::program::Deadline::within(Duration::from_secs(60));
    while looks(program, token) != status {
        assert!(!deadline.has_passed(), "a look is never answered with {status}");
    }
}

/// Safety A1.
#[test]
fn the_first_start_shows_a_ready_link_once_and_the_next_does_not() {
    let folder = Folder::new("first");
    let program = folder.serve();
    let said = program.says();
    let (_, token) = said.split_once("/sign-in?token=").expect("a ready link");
    assert!(said.contains(&format!("http://127.0.0.1:{}/sign-in", program.address().port())), "{said}");
    assert_eq!(looks(&program, token), 200);
    assert_eq!(token, folder.token_of("operator"));
    let page = program.read(&format!("/sign-in?token={token}"), &[BROWSER]);
    assert!(page.status == 200 && page.text().contains(token) && page.header("set-cookie").is_empty());
    drop(program);

    let again = folder.serve();
    let said = again.says();
    assert!(!said.contains(token) && said.contains("`hallsweep token`"), "{said}");
    assert_eq!(looks(&again, token), 200, "the key is the same");
}

/// Safety A1.
#[cfg(unix)]
#[test]
fn the_keys_are_private_and_refused_when_they_are_not() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("private");
    drop(folder.serve());
    let mode = |path: &Path| std::fs::metadata(path).expect("it is there").permissions().mode() & 0o777;
    assert_eq!((mode(&folder.file()), mode(&folder.0)), (0o600, 0o700));
    std::fs::set_permissions(folder.file(), std::fs::Permissions::from_mode(0o644)).expect("it is ours");
    let said = folder.serve().says();
    assert!(said.contains("nobody can sign in") && said.contains("chmod 600") && said.contains("644"), "{said}");
    assert!(folder.refused(&[]).contains("chmod 600"));
}

/// Safety A1, A3.
#[test]
fn nobody_gets_in_without_a_key_and_a_key_gets_in_by_token_or_cookie() {
    let folder = Folder::new("in");
    let program = folder.serve();
    let token = folder.token_of("operator");
    for path in ["/api/v1/state", "/api/v1/events", "/console/live", "/"] {
        let answer = program.read(path, &[]);
        assert_eq!((answer.status, answer.header("www-authenticate")), (401, "Bearer"), "{path}");
        answer.problem(401);
    }
    program.command("start").problem(401);
    program.command("stop").problem(401);
    let led = program.read("/", &[BROWSER]);
    assert_eq!((led.status, led.header("location")), (303, "./sign-in"));
    assert_eq!(program.read("/healthz", &[]).status, 200);
    assert_eq!(program.read("/static/console.css", &[]).status, 200);

    commands(&program, &token, "start").accepted();
    let cookie = sign_in(&program, &token);
    let page = program.read("/", &[BROWSER, ("cookie", &cookie)]);
    assert!(page.status == 200 && page.text().contains("Sign out"));
    let stopped = program.post_with("/console/stop", &[FORM, BROWSER, ("cookie", &cookie)], "");
    assert_eq!((stopped.status, stopped.header("location")), (303, "../"));
    let state = program.read("/api/v1/state", &[("cookie", &cookie)]).json();
    assert!(state["mission"]["holds"].as_array().expect("holds").contains(&"operator".into()), "{state}");
    let out = program.post_with("/sign-out", &[FORM, BROWSER, ("cookie", &cookie)], "");
    assert!(out.status == 303 && out.header("set-cookie").contains("Max-Age=0"));
}

#[test]
fn a_session_outlives_the_program() {
    let folder = Folder::new("session");
    let program = folder.serve();
    let cookie = sign_in(&program, &folder.token_of("operator"));
    drop(program);
    let again = folder.serve();
    // Cookies are not separated by port, so the port is part of the cookie's name. The restarted program has another
    // port.
    let (_, session) = cookie.split_once('=').expect("a name and a value");
    let cookie = format!("hallsweep-{}={session}", again.address().port());
    assert_eq!(again.read("/api/v1/state", &[("cookie", &cookie)]).status, 200);
    let forged = format!("{}0", &cookie[..cookie.len() - 1]);
    let forged = if forged == cookie { format!("{}1", &cookie[..cookie.len() - 1]) } else { forged };
    assert_eq!(again.read("/api/v1/state", &[("cookie", &forged)]).status, 401);
}

/// Safety A1, S1.
#[test]
fn a_viewer_sees_and_stops_and_does_nothing_else() {
    let folder = Folder::new("viewer");
    assert!(folder.token(&["add", "lobby", "--role", "viewer"]).contains("lobby (viewer)"));
    let program = folder.serve();
    let (viewer, operator) = (folder.token_of("lobby"), folder.token_of("operator"));
    assert_eq!(looks(&program, &viewer), 200);
    let refused = commands(&program, &viewer, "start");
    assert_eq!(refused.json()["code"], "notAllowed");
    assert!(refused.problem(403).contains("operator"));
    for command in ["retrieve", "orderAreas", "closeArea", "searchAgain"] {
        commands(&program, &viewer, command).problem(403);
    }
    commands(&program, &operator, "start").accepted();
    commands(&program, &viewer, "stop").accepted();
    let moved = |word: &str| {
        let headers = [("authorization", bearer(&viewer)), ("content-type", "application/json".to_owned())];
        let headers = headers.each_ref().map(|(name, value)| (*name, value.as_str()));
        program.post_with("/api/v1/commands/move", &headers, &format!("{{\"move\":\"{word}\"}}"))
    };
    moved("w").problem(403);
    moved("h").accepted();
    let page = program.read("/", &[BROWSER, ("cookie", &sign_in(&program, &viewer))]).text();
    assert!(page.contains("you are signed in as a viewer") && page.contains("<b>lobby</b>"));
}

/// Safety A1.
#[test]
fn a_rotated_key_counts_at_once_and_ends_sessions_and_open_streams() {
    let folder = Folder::new("rotated");
    folder.token(&["add", "lobby", "--role", "viewer"]);
    let program = folder.serve();
    let old = folder.token_of("lobby");
    let cookie = sign_in(&program, &old);
    let mut stream = TcpStream::connect(program.address()).expect("the program listens");
    stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a time-out can be set");
    let request =
        format!("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: {}\r\n\r\n", bearer(&old));
    stream.write_all(request.as_bytes()).expect("the program listens");
    let mut first = [0; 12];
    stream.read_exact(&mut first).expect("the stream begins");
    assert_eq!(&first, b"HTTP/1.1 200");
    assert!(!folder.token(&["rotate", "lobby"]).contains(&old));
    until_looks(&program, &old, 401);
    let mut rest = String::new();
    stream.read_to_string(&mut rest).expect("the stream has an end");
    assert!(rest.ends_with("0\r\n\r\n"), "it ended in order: {rest}");
    assert_eq!(program.read("/api/v1/state", &[("cookie", &cookie)]).status, 401);
    let new = folder.token_of("lobby");
    assert_eq!(looks(&program, &new), 200);
    folder.token(&["remove", "lobby"]);
    until_looks(&program, &new, 401);
    assert_eq!(looks(&program, &folder.token_of("operator")), 200, "others are left alone");
}

#[test]
fn the_command_for_keys_says_what_it_cannot_do() {
    let folder = Folder::new("command");
    for looks in [&[][..], &["show"], &["rotate", "operator"], &["remove", "operator"]] {
        let said = folder.refused(looks);
        assert!(
            said.contains("no keys yet") && said.contains("token add") && !folder.0.exists(),
            "looking makes nothing: {said}"
        );
    }
    let made = folder.token(&["add", "lobby", "--role", "viewer", "--http", "192.0.2.7:8088"]);
    assert!(made.contains("operator (operator)") && made.contains("lobby (viewer)"), "an operator comes first: {made}");
    assert!(made.contains("http://192.0.2.7:8088/sign-in?token=") && made.contains("--http"), "{made}");
    assert!(folder.refused(&["remove", "operator"]).contains("last operator"));
    assert!(folder.refused(&["rotate", "loby"]).contains("the existing keys are operator, lobby"));
    assert!(folder.refused(&["add", "operator", "--role", "viewer"]).contains("already"));
    assert!(folder.refused(&["add", "a b", "--role", "viewer"]).contains("1 to 32"));
    let limited = folder.token(&["add", "south-desk", "--role", "operator", "--halls", "south,east"]);
    assert!(limited.starts_with("south-desk (operator of south, east)\n"), "{limited}");
    assert!(folder.refused(&["remove", "operator"]).contains("for all halls"));
    assert!(folder.token(&["rotate", "south-desk"]).starts_with("south-desk (operator of south, east)\n"));
    let output = hallsweep(&["token", "--data", "none"]).output().expect("the program starts");
    assert!(String::from_utf8_lossy(&output.stderr).contains("nothing is stored"), "{output:?}");
    folder.token(&["add", "night-shift", "--role", "operator"]);
    folder.token(&["remove", "operator"]);
    let elsewhere = hallsweep(&["token", "show", "--data", &folder.0.display().to_string()]).output().expect("it starts");
    assert!(String::from_utf8_lossy(&elsewhere.stdout).contains("night-shift (operator)"));
}

#[test]
fn where_nothing_is_kept_the_key_is_shown_at_every_start() {
    let arguments = ["serve", "--http", "0.0.0.0:0", "--data", "none", "--hall", "empty-8x8"];
    let token = |program: &Program| program.says().rsplit("token=").next().expect("a token").to_owned();
    let (one, other) = (Program::with(&arguments), Program::with(&arguments));
    let (first, second) = (token(&one), token(&other));
    assert_ne!(first, second);
    assert_eq!((looks(&one, &first), looks(&one, &second)), (200, 401));
}

#[test]
fn on_loopback_keys_are_asked_for_when_that_is_wanted() {
    let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8"];
    assert_eq!(Program::with(&arguments).read("/api/v1/state", &[]).status, 200, "open to this machine");
    let mut command = hallsweep(&arguments);
    let proxied =
        Program::started(command.env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true").env("HALLSWEEP__HTTP__HOSTS", "hall.example"));
    assert_eq!(proxied.read("/api/v1/state", &[]).status, 401);
    assert_eq!(proxied.read("/api/v1/state", &[("host", "hall.example")]).status, 401);
    assert_eq!(proxied.read("/api/v1/state", &[("host", "other.example")]).status, 421);
}

/// Safety A2.
#[test]
fn beyond_loopback_addresses_and_listed_names_are_known_and_no_others() {
    let folder = Folder::new("hosts");
    let program = folder.serve();
    for own in ["192.0.2.7:8080", "[2001:db8::1]", "localhost", "127.0.0.1:80"] {
        assert_eq!(program.read("/healthz", &[("host", own)]).status, 200, "{own}");
    }
    let refused = program.read("/healthz", &[("host", "rebound.example")]).problem(421);
    assert!(refused.contains("http.hosts"), "{refused}");
    drop(program);
    let arguments = ["serve", "--http", "0.0.0.0:0", "--hall", "empty-8x8"];
    let named = Program::started(folder.command(&arguments).env("HALLSWEEP__HTTP__HOSTS", "[\"hall.example\"]"));
    assert_eq!(named.read("/healthz", &[("host", "hall.example:8080")]).status, 200);
    assert_eq!(named.read("/healthz", &[("host", "rebound.example")]).status, 421);
}

/// Safety A3. `sign_in` has its own tests, on a simulated clock, of the growing delay and of the rule that a holder
/// of a key never waits.
#[test]
fn a_wrong_key_is_refused_in_words_and_locks_nobody_out() {
    let folder = Folder::new("wrong");
    let program = folder.serve();
    let token = folder.token_of("operator");
    for wrong in ["", "wrong", &token[1..], &token.replace('a', "b").replace('1', "2")] {
        assert_eq!(looks(&program, wrong), 401, "{wrong}");
    }
    let refused = program.post_with("/sign-in", &[FORM, BROWSER], "token=wrong");
    assert!(refused.status == 403 && refused.text().contains("not known") && refused.header("set-cookie").is_empty());
    commands(&program, &token, "stop").accepted();
}

/// Safety A6: a request without a key is logged with its address. It is not written to the journal, which strangers
/// must not be able to fill.
#[test]
fn what_strangers_ask_for_is_in_the_log_alone() {
    let folder = crate::kill::Folder::new("strangers");
    let log = std::path::Path::new(folder.text()).join("log.txt");
    let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8", "--data", folder.text()];
    let mut command = crate::program::hallsweep(&arguments);
    command.env("HALLSWEEP__LOG__FILTER", "info").env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true");
    let program = Program::started(command.stderr(std::fs::File::create(&log).expect("a file for the log")));
    assert_eq!(program.command("start").status, 401);
    let written = || std::fs::read_to_string(&log).expect("it is there");
    // The log is written by a separate thread.
    let until = |words: &str| {
        let deadline = Deadline::within(PATIENCE);
        while !written().contains(words) {
            assert!(!deadline.has_passed(), "{words} is not in {}", written());
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
    };
    until("/api/v1/commands/start");
    assert!(written().contains("127.0.0.1"), "{}", written());
    assert_eq!(program.read("/api/v1/state", &[]).status, 401);
    assert_eq!(program.post_with("/sign-out", &[("sec-fetch-site", "cross-site")], "").status, 403);
    until("another origin");
    assert!(!written().contains("/api/v1/state"), "who only looks is not worth a line");
    drop(program);
    let lines = crate::journal::journal(&folder, &["export"]).1;
    assert!(!lines.contains("\"kind\":\"command\""), "{lines}");
}

#[test]
fn of_keys_that_are_changed_at_once_none_is_lost_and_who_locks_the_folder_keeps_nobody_from_it() {
    let folder = Folder::new("at-once");
    folder.token(&["add", "first", "--role", "operator"]);
    std::thread::scope(|scope| {
        for number in 0..8 {
            let folder = &folder;
            scope.spawn(move || folder.token(&["add", &format!("key-{number}"), "--role", "viewer"]));
        }
    });
    let shown = folder.token(&[]);
    for number in 0..8 {
        assert!(shown.contains(&format!("key-{number} (viewer)")), "{shown}");
    }
    // Anybody who may read the folder can hold this lock, and removing a key must work all the same.
    let held = std::fs::File::open(&folder.0).expect("the folder is there");
    held.lock().expect("nobody else has it");
    folder.token(&["remove", "key-3"]);
    assert!(!folder.token(&[]).contains("key-3"));
}
