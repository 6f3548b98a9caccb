//! Contents of the image: few files, nothing of the build, and the licences of all third-party code.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use flate2::write::GzEncoder;
use serde_json::Value;

use crate::engine::{ContainerEngine, engine, say, text, unused};

const MOST_BYTES: u64 = 40_000_000;

const MOST_COMPRESSED: usize = 15_000_000;

/// Files of an image in a folder, which is deleted with this value.
struct Files(PathBuf);

impl Files {
    fn of(engine: &ContainerEngine, image: &str) -> (Files, Vec<u8>) {
        let name = unused("contents");
        engine.run(&["create", "--name", &name, image]);
        let exported = engine.ask(&["export", &name]);
        engine.run(&["rm", "--volumes", &name]);
        assert!(exported.status.success(), "{}", text(&exported.stderr));
        let folder = std::env::temp_dir().join(&name);
        std::fs::create_dir(&folder).expect("the folder is ours");
        let tar = folder.with_extension("tar");
        std::fs::write(&tar, &exported.stdout).expect("the folder is ours");
        let unpacked = Command::new("tar").arg("-C").arg(&folder).arg("-xf").arg(&tar).stderr(Stdio::null()).status();
        assert!(unpacked.expect("tar is there").success());
        std::fs::remove_file(tar).expect("the folder is ours");
        (Files(folder), exported.stdout)
    }

    fn read(&self, path: &str) -> Vec<u8> {
        std::fs::read(self.0.join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
    }

    fn text(&self, path: &str) -> String {
        String::from_utf8(self.read(path)).expect("it is text")
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn inspected(engine: &ContainerEngine, image: &str) -> Value {
    let all: Value = serde_json::from_str(&engine.run(&["image", "inspect", image])).expect("JSON");
    all[0].clone()
}

/// Third-party crates in the program, as cargo resolves them.
fn crates() -> BTreeSet<(String, String)> {
    let tree =
        ["tree", "--locked", "--offline", "--package=hallsweep", "--prefix=none", "--edges=normal,no-proc-macro", "--format={p}"];
    let target = format!("--target={}-unknown-linux-gnu", std::env::consts::ARCH);
    let listed = Command::new(env!("CARGO")).args(tree).arg(target).output().expect("cargo is there");
    assert!(listed.status.success(), "{}", text(&listed.stderr));
    let all = text(&listed.stdout);
    let others = all.lines().filter(|line| !line.contains("(/"));
    let named = others.filter_map(|line| line.trim_end_matches(" (*)").split_once(" v"));
    named.map(|(name, version)| (name.to_owned(), version.to_owned())).collect()
}

#[test]
fn it_is_small_and_holds_the_program_and_nothing_of_how_it_was_built() {
    let Some(engine) = engine() else { return };
    let size = inspected(&engine, &engine.image)["Size"].as_u64().expect("a size");
    let (files, tar) = Files::of(&engine, &engine.image);
    let mut packed = GzEncoder::new(Vec::new(), flate2::Compression::default());
    std::io::Write::write_all(&mut packed, &tar).expect("there is room");
    let compressed = packed.finish().expect("there is room").len();
    let program = files.read("usr/bin/hallsweep");
    say(&format!("the image has {size} bytes, {compressed} compressed; the program in it {}", program.len()));
    assert!(size < MOST_BYTES && compressed < MOST_COMPRESSED, "{size} and {compressed} bytes");
    let program = String::from_utf8_lossy(&program);
    for secret in ["/build/crates", "/build/src", "/cargo/", concat!("/ro", "ot/")] {
        assert!(!program.contains(secret), "{secret} is in the program");
    }
    for absent in ["bin/sh", "usr/bin/sh", "build", "root", "opt", "papers"] {
        assert!(!files.0.join(absent).exists(), "{absent} is in the image");
    }
    assert!(files.0.join("usr/share/zoneinfo/Europe/Rome").is_file());
}

#[test]
fn it_says_what_it_is_and_runs_as_a_user_that_a_cluster_can_see_is_not_root() {
    let Some(engine) = engine() else { return };
    for image in [&engine.image, &engine.debug] {
        let config = inspected(&engine, image)["Config"].clone();
        assert_eq!(config["User"], "65532:0", "{config}");
        assert_eq!(config["Entrypoint"], serde_json::json!(["hallsweep"]));
        assert!(config["Volumes"]["/data"].is_object(), "{config}");
        let label = |name: &str| config["Labels"][format!("org.opencontainers.image.{name}")].as_str().map(str::to_owned);
        assert_eq!(label("title").as_deref(), Some("hallsweep"));
        assert_eq!(label("version").as_deref(), Some(env!("CARGO_PKG_VERSION")));
        assert_eq!(label("licenses").as_deref(), Some("MIT OR Apache-2.0"));
        assert!(label("revision").is_some_and(|revision| revision != "unknown") && label("description").is_some());
        let (_, version) = engine.once(image, &[], &["--version"]);
        assert_eq!(version, concat!("hallsweep ", env!("CARGO_PKG_VERSION")));
    }
}

#[test]
fn the_papers_name_everything_that_others_wrote_with_its_licence() {
    let Some(engine) = engine() else { return };
    let (files, _) = Files::of(&engine, &engine.image);
    let licences = files.text("usr/share/doc/hallsweep/licences.txt");
    let parts: Value = serde_json::from_str(&files.text("usr/share/doc/hallsweep/sbom.cdx.json")).expect("JSON");
    assert_eq!(parts["bomFormat"], "CycloneDX");
    let components = parts["components"].as_array().expect("a list");
    let listed: BTreeSet<(String, String)> = components
        .iter()
        .map(|part| (part["name"].as_str().expect("text").to_owned(), part["version"].as_str().expect("text").to_owned()))
        .collect();
    let crates = crates();
    assert!(crates.len() > 100, "{crates:?}");
    for part in &crates {
        assert!(licences.contains(&format!("  {} {}\n", part.0, part.1)), "no licence of {part:?}");
        assert!(listed.contains(part), "{part:?} is missing from the list of parts");
    }
    assert!(licences.contains("Apache License") && licences.contains("Permission is hereby granted, free of charge"));
    assert!(files.text("usr/share/doc/hallsweep/rust-standard-library.txt").contains("Rust"));
    for package in ["libc6", "libgcc-s1", "tzdata", "ca-certificates"] {
        let status = files.text(&format!("var/lib/dpkg/status.d/{package}"));
        assert!(status.contains(&format!("Package: {package}\n")) && status.contains("\nVersion: "), "{status}");
        assert!(!files.text(&format!("usr/share/doc/{package}/copyright")).is_empty());
    }
    for ours in ["LICENSE-MIT", "LICENSE-APACHE", "idiomorph.LICENSE", "inter.LICENSE", "lucide.LICENSE"] {
        assert!(!files.text(&format!("usr/share/doc/hallsweep/{ours}")).is_empty());
    }
}

#[test]
fn the_debuggable_one_has_a_shell_and_the_lines_of_our_sources() {
    let Some(engine) = engine() else { return };
    let container = engine.start(&engine.debug, &["--env=HALLSWEEP__ROBOT__SPEED=max"], &["--hall", "seed"]);
    container.until_healthy();
    let shell = container.exec(&["sh", "-c", "cat /proc/1/comm"]);
    assert_eq!(text(&shell.stdout), "hallsweep", "{shell:?}");
    let (files, _) = Files::of(&engine, &engine.debug);
    let program = files.0.join("usr/bin/hallsweep");
    let lines = Command::new("readelf").arg("--debug-dump=rawline").arg(program).stderr(Stdio::null()).output();
    let lines = lines.expect("readelf is where a C compiler is").stdout;
    assert!(String::from_utf8_lossy(&lines).contains("kept_halls.rs"), "a source that is ours");
    assert_eq!(container.end(&["stop"]), "0");
}
