//! Passes an option to the linker that Cargo.toml cannot express: it compresses the line numbers that a release has
//! when it is built with CARGO_PROFILE_RELEASE_DEBUG. Only on Linux are these line numbers in the program itself.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is = |name: &str, value: &str| std::env::var(name).is_ok_and(|found| found == value);
    if is("CARGO_CFG_TARGET_OS", "linux") && is("PROFILE", "release") {
        println!("cargo::rustc-link-arg-bins=-Wl,--compress-debug-sections=zlib");
    }
}
