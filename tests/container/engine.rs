//! The command line of the engine, with containers and volumes that are removed when the test ends.

use std::io::Write;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Time limit of every wait, much longer than any should take.
const PATIENCE: Duration = Duration::from_secs(60);

const GLANCE: Duration = Duration::from_millis(20);

/// docker or podman, and the images to run.
pub(crate) struct ContainerEngine {
    program: String,
    /// Names of the image and of its variant with a shell.
    pub(crate) image: String,
    pub(crate) debug: String,
}

/// Container, which is removed with this value.
pub(crate) struct Container<'a> {
    engine: &'a ContainerEngine,
    pub(crate) name: String,
}

/// Volume of the engine, which is removed with this value.
pub(crate) struct Volume<'a> {
    engine: &'a ContainerEngine,
    pub(crate) name: String,
}

/// Publishes the console on a local port that the engine chooses.
pub(crate) const ON_LOOPBACK: &str = "--publish=127.0.0.1::8080";

/// Reports that a test is skipped because something is missing, or panics where it is required.
pub(crate) fn left_out(missing: &str) {
    let required = std::env::var("HALLSWEEP_REQUIRE_CLIENTS").is_ok_and(|value| value == "1");
    assert!(!required, "the tests of the image need {missing}");
    say(&format!("a test of the image is left out: it needs {missing}"));
}

/// Written directly, because the test harness would capture the output.
pub(crate) fn say(words: &str) {
    writeln!(std::io::stderr(), "{words}").expect("standard error is open");
}

/// The engine. A missing engine is reported and gives `None`, or panics where it is required.
pub(crate) fn engine() -> Option<ContainerEngine> {
    let told = |name: &str| std::env::var(name).ok();
    let found = told("HALLSWEEP_ENGINE").zip(told("HALLSWEEP_IMAGE")).zip(told("HALLSWEEP_IMAGE_DEBUG"));
    let Some(((program, image), debug)) = found else {
        left_out("an engine, as .ci/image finds one");
        return None;
    };
    Some(ContainerEngine { program, image, debug })
}

/// Waits until `look` finds something.
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

/// Name that no other test of this run uses.
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

    /// Runs a command of the engine to its end, whatever the result. A command that takes more than five minutes is
    /// killed, because `wait` might never return.
    pub(crate) fn ask(&self, arguments: &[&str]) -> Output {
        Command::new("timeout")
            .arg("300")
            .arg(&self.program)
            .args(arguments)
            .stdin(Stdio::null())
            .output()
            .expect("the engine can be run")
    }

    /// Runs a command that must succeed, and returns its output.
    pub(crate) fn run(&self, arguments: &[&str]) -> String {
        let output = self.ask(arguments);
        assert!(output.status.success(), "{arguments:?}: {}{}", text(&output.stdout), text(&output.stderr));
        text(&output.stdout)
    }

    /// Runs an image to its end; returns the exit code and the output. The output is read from the log, because
    /// engines sometimes lose the output of a short run.
    pub(crate) fn once(&self, image: &str, options: &[&str], arguments: &[&str]) -> (String, String) {
        let container = self.start(image, options, arguments);
        (self.run(&["wait", &container.name]), container.logs().trim().to_owned())
    }

    /// Starts a container of the image that serves.
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
    /// Local address of a published port.
    pub(crate) fn published(&self, port: &str) -> SocketAddr {
        let said = self.engine.run(&["port", &self.name, port]);
        said.lines().next().and_then(|line| line.parse().ok()).unwrap_or_else(|| panic!("{port} is published: {said}"))
    }

    /// Runs a command in the container.
    pub(crate) fn exec(&self, command: &[&str]) -> Output {
        self.engine.ask(&[&["exec", &self.name], command].concat())
    }

    /// Standard output and standard error of the container.
    pub(crate) fn logs(&self) -> String {
        let output = self.engine.ask(&["logs", &self.name]);
        format!("{}\n{}", text(&output.stdout), text(&output.stderr))
    }

    /// Waits for these words in the log, and returns the log.
    pub(crate) fn until_logged(&self, words: &str) -> String {
        until(words, || Some(self.logs()).filter(|logs| logs.contains(words)))
    }

    /// Waits until the health check succeeds.
    pub(crate) fn until_healthy(&self) {
        until("it is healthy", || self.exec(&["hallsweep", "healthcheck"]).status.success().then_some(()));
    }

    /// Ends the container with a command of the engine such as `stop`; returns the exit code.
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
    /// Option of the engine that mounts the volume at the image's data folder.
    pub(crate) fn at_data(&self) -> String {
        format!("--volume={}:/data", self.name)
    }

    /// Folder of the volume on this machine; `None` after a note when the test may not access it.
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
