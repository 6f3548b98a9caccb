//! The rivals of Rust: a package of their own beside this file, built when the benchmark runs and never otherwise.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds them; without them, those that use them are left out.
pub(crate) fn build() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/coap/rivals/Cargo.toml");
    println!("building coap-rs and the bare bound (benches/coap/rivals) …");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["build", "--release", "--locked", "--quiet", "--manifest-path"]).arg(manifest);
    let built = command.arg("--target-dir").arg(folder()).status();
    if !built.is_ok_and(|status| status.success()) {
        println!("  they were not built: coap-rs and the bare bound are left out");
    }
}

/// Where a program of theirs is.
pub(crate) fn program(name: &str) -> PathBuf {
    folder().join("release").join(name)
}

/// Beside what cargo makes of hallsweep itself: this program is in `target/release/deps`.
fn folder() -> PathBuf {
    let own = std::env::current_exe().expect("the system knows which program this is");
    own.ancestors().nth(3).expect("it is in target/release/deps").join("rivals")
}
