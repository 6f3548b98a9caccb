//! BehaviorTree.CPP in a process of its own: `tests/clients/behaviortree.py`.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The process ends by itself when its input does, and by force after this time.
const PATIENCE_S: &str = "600";

/// The process, which is started by the first case.
#[derive(Default)]
pub(super) struct Original {
    process: Option<(Child, ChildStdin, BufReader<ChildStdout>)>,
}

impl Original {
    /// Whether the package is installed. If not, a message says what to install, or the test fails under
    /// `HALLSWEEP_REQUIRE_CLIENTS=1`.
    pub(super) fn is_here() -> bool {
        let mut import = python();
        import.args(["-c", "import behaviortreepy"]).stdin(Stdio::null()).stderr(Stdio::null());
        if import.status().is_ok_and(|status| status.success()) {
            return true;
        }
        let missing = "behaviortreepy, of which there are wheels for Python up to 3.13 on x86_64 \
                       (python3 -m pip install --target tests/clients/python_modules -r tests/clients/requirements.txt)";
        let required = std::env::var("HALLSWEEP_REQUIRE_CLIENTS").is_ok_and(|value| value == "1");
        // The package is not available for other processors, so nothing requires it there.
        assert!(!required || cfg!(not(target_arch = "x86_64")), "the test beside BehaviorTree.CPP needs {missing}");
        // Written past the test harness, which would swallow it.
        writeln!(std::io::stderr(), "a test beside BehaviorTree.CPP is left out: it needs {missing}").expect("it is open");
        false
    }

    /// The answer to a case, line by line. If the process dies of it, the next case starts another.
    pub(super) fn ask(&mut self, told: &str) -> Result<Vec<String>, String> {
        let (_, input, output) = self.process.get_or_insert_with(start);
        let mut said = Vec::new();
        let asked = input.write_all(told.as_bytes()).and_then(|()| input.flush());
        if asked.is_ok() {
            for line in output.by_ref().lines().map_while(Result::ok) {
                if line == "end" {
                    return Ok(said);
                }
                said.push(line);
            }
        }
        self.end();
        Err(format!("BehaviorTree.CPP, or the script that tells it what to do, has broken down after {said:?}"))
    }

    fn end(&mut self) {
        if let Some((mut child, input, _)) = self.process.take() {
            drop(input);
            child.wait().unwrap();
        }
    }
}

impl Drop for Original {
    fn drop(&mut self) {
        self.end();
    }
}

fn start() -> (Child, ChildStdin, BufReader<ChildStdout>) {
    let mut python = python();
    python.arg(clients().join("behaviortree.py")).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = python.spawn().unwrap();
    let (input, output) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
    (child, input, BufReader::new(output))
}

fn clients() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/clients")
}

fn python() -> Command {
    let mut timeout = Command::new("timeout");
    timeout.args([PATIENCE_S, "python3", "-W", "ignore"]).env("PYTHONPATH", clients().join("python_modules"));
    timeout
}
