//! The rivals written in Rust: a separate package beside this file, which only this benchmark builds.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds the rivals; when the build fails, the parts that need them leave them out.
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

/// Path of a rival's executable.
pub(crate) fn program(name: &str) -> PathBuf {
    folder().join("release").join(name)
}

/// Build folder of the rivals, beside cargo's own: this program is in `target/release/deps`.
fn folder() -> PathBuf {
    let own = std::env::current_exe().expect("the system knows which program this is");
    own.ancestors().nth(3).expect("it is in target/release/deps").join("rivals")
}
