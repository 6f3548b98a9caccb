//! The real program on a free local port with its own folder, started and ended by benchmarks.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

pub(crate) struct Program {
    child: Child,
    /// Data folder, which is deleted with this value.
    pub(crate) folder: PathBuf,
    /// HTTP address such as `127.0.0.1:40123`.
    pub(crate) address: String,
    said: BufReader<ChildStdout>,
}

impl Program {
    /// Starts `serve` with these arguments, without `HALLSWEEP_` variables and with an empty data folder.
    pub(crate) fn serve(arguments: &[&str]) -> Program {
        static STARTED: AtomicU32 = AtomicU32::new(0);
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("hallsweep-bench-{}-{number}", std::process::id()));
        let mut command = Command::new(env!("CARGO_BIN_EXE_hallsweep"));
        for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("HALLSWEEP_")) {
            command.env_remove(name);
        }
        command
            .args(["serve", "--http", "127.0.0.1:0", "--coap", "127.0.0.1:0", "--mqtt", "127.0.0.1:0", "--data"])
            .arg(&folder)
            .args(arguments);
        let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut child = child.expect("the program was built for this benchmark");
        let said = BufReader::new(child.stdout.take().expect("its output is piped"));
        let mut program = Program { child, folder, address: String::new(), said };
        program.address = program.door("http://");
        program
    }

    /// Address of the next door that the program announces with this scheme, such as `coap://`.
    pub(crate) fn door(&mut self, scheme: &str) -> String {
        let mut line = String::new();
        while !line.contains(scheme) {
            line.clear();
            let read = self.said.read_line(&mut line).expect("it says where it is");
            assert!(read > 0, "it has ended without a word of {scheme}");
        }
        let (_, door) = line.split_once(scheme).expect("the line was looked for");
        door.split_whitespace().next().unwrap_or_default().trim_end_matches('/').to_owned()
    }

    /// Path of a file in the process's `/proc` folder, such as `stat`.
    pub(crate) fn proc(&self, name: &str) -> PathBuf {
        format!("/proc/{}/{name}", self.child.id()).into()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
