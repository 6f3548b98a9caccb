//! The engine as its command line: containers and volumes that are gone when the test ends.

use std::io::Write;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// How long anything is waited for: far longer than it takes.
const PATIENCE: Duration = Duration::from_secs(60);

const GLANCE: Duration = Duration::from_millis(20);

/// docker or podman, and what it runs.
pub(crate) struct ContainerEngine {
    program: String,
    /// The image, and the one with a shell in it.
    pub(crate) image: String,
    pub(crate) debug: String,
}

/// A container, which is gone with this.
pub(crate) struct Container<'a> {
    engine: &'a ContainerEngine,
    pub(crate) name: String,
}

/// A volume of the engine, which is gone with this.
pub(crate) struct Volume<'a> {
    engine: &'a ContainerEngine,
    pub(crate) name: String,
}

/// A port of this machine, which the engine chooses, for the console.
pub(crate) const ON_LOOPBACK: &str = "--publish=127.0.0.1::8080";

/// Says that a test is left out, and why; fails instead where everything must be there.
pub(crate) fn left_out(missing: &str) {
    let required = std::env::var("HALLSWEEP_REQUIRE_CLIENTS").is_ok_and(|value| value == "1");
    assert!(!required, "the tests of the image need {missing}");
    say(&format!("a test of the image is left out: it needs {missing}"));
}

/// Written past the test harness, which would keep it to itself.
pub(crate) fn say(words: &str) {
    writeln!(std::io::stderr(), "{words}").expect("standard error is open");
}

/// The engine; `None` where there is none, which is said, or fails where it must be there.
pub(crate) fn engine() -> Option<ContainerEngine> {
    let told = |name: &str| std::env::var(name).ok();
    let found = told("HALLSWEEP_ENGINE").zip(told("HALLSWEEP_IMAGE")).zip(told("HALLSWEEP_IMAGE_DEBUG"));
    let Some(((program, image), debug)) = found else {
        left_out("an engine, as .ci/image finds one");
        return None;
    };
    Some(ContainerEngine { program, image, debug })
}

/// Waits until something is there.
#[expect(clippy::disallowed_methods, reason = "a test bounds its own patience by the real clock")]
pub(crate) fn until<T>(wanted: &str, look: impl Fn() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(begun.elapsed() < PATIENCE, "never came to be: {wanted}");
        sleep(GLANCE);
    }
}

/// A name that no other test of this run has.
pub(crate) fn unused(what: &str) -> String {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    format!("hallsweep-{what}-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed))
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).trim_end().to_owned()
}

impl ContainerEngine {
    pub(crate) fn is_docker(&self) -> bool {
        self.program.ends_with("docker")
    }

    /// Runs a command of the engine to its end, whatever that is. One that takes minutes is ended: `wait` waits for ever.
    pub(crate) fn ask(&self, arguments: &[&str]) -> Output {
        Command::new("timeout")
            .arg("300")
            .arg(&self.program)
            .args(arguments)
            .stdin(Stdio::null())
            .output()
            .expect("the engine can be run")
    }

    /// The same for one that must end well; what it prints.
    pub(crate) fn run(&self, arguments: &[&str]) -> String {
        let output = self.ask(arguments);
        assert!(output.status.success(), "{arguments:?}: {}{}", text(&output.stdout), text(&output.stderr));
        text(&output.stdout)
    }

    /// Runs an image to its end, with these options of the engine and arguments of its own: its exit code, and all that it said. Its
    /// log is read for that, since of what is soon over an engine does not always pass on all.
    pub(crate) fn once(&self, image: &str, options: &[&str], arguments: &[&str]) -> (String, String) {
        let container = self.start(image, options, arguments);
        (self.run(&["wait", &container.name]), container.logs().trim().to_owned())
    }

    /// A container of the image that serves.
    pub(crate) fn serve(&self, options: &[&str], arguments: &[&str]) -> Container<'_> {
        self.start(&self.image, options, arguments)
    }

    pub(crate) fn start(&self, image: &str, options: &[&str], arguments: &[&str]) -> Container<'_> {
        let name = unused("container");
        let container = Container { engine: self, name: name.clone() };
        self.run(&[&["run", "--detach", "--name", &name], options, &[image], arguments].concat());
        container
    }

    pub(crate) fn volume(&self) -> Volume<'_> {
        let name = unused("volume");
        self.run(&["volume", "create", &name]);
        Volume { engine: self, name }
    }
}

impl Container<'_> {
    /// Where this machine reaches a port of it.
    pub(crate) fn published(&self, port: &str) -> SocketAddr {
        let said = self.engine.run(&["port", &self.name, port]);
        said.lines().next().and_then(|line| line.parse().ok()).unwrap_or_else(|| panic!("{port} is published: {said}"))
    }

    /// Runs a command in it.
    pub(crate) fn exec(&self, command: &[&str]) -> Output {
        self.engine.ask(&[&["exec", &self.name], command].concat())
    }

    /// What it has written, on both ways.
    pub(crate) fn logs(&self) -> String {
        let output = self.engine.ask(&["logs", &self.name]);
        format!("{}\n{}", text(&output.stdout), text(&output.stderr))
    }

    /// Waits for words in its log, and returns all that is there by then.
    pub(crate) fn until_logged(&self, words: &str) -> String {
        until(words, || Some(self.logs()).filter(|logs| logs.contains(words)))
    }

    /// Waits until it serves.
    pub(crate) fn until_healthy(&self) {
        until("it is healthy", || self.exec(&["hallsweep", "healthcheck"]).status.success().then_some(()));
    }

    /// Its end by a command of the engine, as `stop`; its exit code.
    pub(crate) fn end(&self, how: &[&str]) -> String {
        self.engine.run(&[how, &[&self.name]].concat());
        self.engine.run(&["wait", &self.name])
    }

    pub(crate) fn start_again(&self) {
        self.engine.run(&["start", &self.name]);
    }
}

impl Drop for Container<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("{} said:\n{}", self.name, self.logs());
        }
        self.engine.ask(&["rm", "--force", "--volumes", &self.name]);
    }
}

impl Volume<'_> {
    /// As an option of the engine: where the image keeps everything.
    pub(crate) fn at_data(&self) -> String {
        format!("--volume={}:/data", self.name)
    }

    /// Where this machine finds it; `None`, with a word, where that is not for us to touch.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        let folder = PathBuf::from(self.engine.run(&["volume", "inspect", "--format", "{{.Mountpoint}}", &self.name]));
        let is_ours = rustix::process::geteuid().is_root() && folder.is_dir();
        if !is_ours {
            left_out("root, and an engine on this very machine");
        }
        is_ours.then_some(folder)
    }
}

impl Drop for Volume<'_> {
    fn drop(&mut self) {
        self.engine.ask(&["volume", "rm", "--force", &self.name]);
    }
}
