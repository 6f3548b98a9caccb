//! Halls in files of every format, on the command line and over HTTP: converted, searched, explored and downloaded. A
//! lossy conversion says so, an existing file is not overwritten, and an error names its file and leaves nothing
//! behind.

use std::path::PathBuf;
use std::process::Output;

use serde_json::Value;

use crate::program::{Program, run};

/// Folder of one test, removed when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let folder = std::env::temp_dir().join(format!("hallsweep-halls-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("the temporary directory can be written");
        Folder(folder)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("a printable path").to_owned()
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        std::fs::write(self.0.join(name), bytes).expect("the folder is ours");
        self.path(name)
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.0.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("the folder is ours");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Converts a hall and returns the printed line.
fn convert(from: &str, to: &str, more: &[&str]) -> String {
    let output = run(&[&["hall", "convert", from, to], more].concat());
    assert!(output.status.success(), "{from}: {}", said(&output));
    let line = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(line.ends_with('\n') && line.lines().count() == 1, "one line: {line}");
    line.trim_end().to_owned()
}

fn explored(hall: &str) -> Value {
    let output = run(&["explore", "--json", "--verdicts", "all-safe", "--hall", hall]);
    assert!(output.status.success(), "{hall}: {}", said(&output));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

#[test]
fn a_hall_is_converted_into_every_format_and_searched_in_each() {
    let folder = Folder::new("formats");
    let words = "; lost: the shape of 1 piece; kind, colour or height of 7 pieces; the danger of 1 piece; the temperature; the name; the \
                 description";
    for (name, names, lost) in [
        ("a.toml", "a.toml", "; nothing is lost"),
        ("a.map", "a.map", words),
        ("a.yaml", "a.yaml and a.pgm", words),
        ("a.txt", "a.txt", "; lost: the luggage (7 pieces, now walls); the temperature; the name; the description"),
    ] {
        let to = folder.path(name);
        let line = convert("airport", &to, &[]);
        let names = names.replace("a.", &folder.path("a."));
        assert_eq!(line, format!("{names}: 16 × 10 cells of 0.5 m, 7 pieces of luggage{lost}"));
        assert_eq!((&explored(&to)["cells"], &explored(&to)["complete"]), (&138.into(), &true.into()), "{name}");
    }
    assert_eq!(folder.names(), ["a.map", "a.pgm", "a.toml", "a.txt", "a.yaml"]);
    let of_image = explored(&folder.path("a.pgm"));
    assert_eq!(of_image["cells"], 138, "the image is enough where its YAML lies beside it");
}

#[test]
fn a_start_that_moves_is_said() {
    let folder = Folder::new("start");
    let from = folder.write("from.toml", "drawing = \"\"\"\n...\n..S\n\"\"\"\n");
    let line = convert(&from, &folder.path("from.map"), &[]);
    assert!(line.ends_with("; lost: the start moves from column 3, row 2 to column 1, row 1"), "{line}");
    let line = convert(&from, &folder.path("from.yaml"), &[]);
    assert!(line.ends_with("; nothing is lost"), "{line}");
}

#[test]
fn a_hall_of_the_largest_size_comes_back_from_a_file_of_every_format() {
    let folder = Folder::new("largest");
    let from = folder.write("from.toml", "width = 2048\nheight = 2048\n");
    for name in ["m.toml", "m.map", "m.yaml", "m.txt"] {
        convert(&from, &folder.path(name), &[]);
        let line = convert(&folder.path(name), &folder.path("again.map"), &["--force"]);
        assert!(line.contains(": 2048 × 2048 cells of 0.5 m"), "{line}");
    }
}

#[test]
fn a_cell_of_an_image_is_as_long_as_it_is_asked_for() {
    let folder = Folder::new("cell");
    folder.write("m.pgm", b"P2 4 2 255\n254 254 254 254\n254 254 254 0\n");
    let yaml = folder.write(
        "m.yaml",
        "image: m.pgm\nresolution: 0.25\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
    );
    let line = convert(&yaml, &folder.path("half.txt"), &[]);
    assert!(line.contains(": 2 × 1 cells of 0.5 m"), "{line}");
    assert_eq!(folder.read("half.txt"), b"|r, X, \n");
    let line = convert(&yaml, &folder.path("quarter.txt"), &["--cell", "0.25"]);
    assert!(
        line.contains(": 4 × 2 cells of 0.25 m") && line.ends_with("lost: cells of 0.25 m become cells of 0.5 m; the name"),
        "{line}"
    );
    assert_eq!(folder.read("quarter.txt"), b"|1, 1, 1, 1, \n|r, 1, 1, X, \n", "world (0, 0) is in the south-west");
    // The image may be in another folder than the YAML file.
    let text = String::from_utf8(folder.read("m.yaml")).expect("UTF-8").replace("m.pgm", &folder.path("m.pgm"));
    std::fs::create_dir(folder.path("far")).expect("the folder is ours");
    let far = folder.write("far/away.yml", text);
    assert!(convert(&far, &folder.path("away.txt"), &[]).contains(": 2 × 1 cells of 0.5 m"));
    for (cell, words) in [
        ("0.1", "cells of 0.1 m are finer than the pixels of 0.25 m: give 0.25 or more"),
        ("nan", "`--cell` is NaN: give a number from 0.1 to 5"),
        ("-1", "`--cell` is -1: give a number from 0.1 to 5"),
    ] {
        let output = run(&["hall", "convert", &yaml, &folder.path("no.txt"), "--cell", cell]);
        assert!(output.status.code() == Some(2) && said(&output).contains(words), "{}", said(&output));
    }
    let output = run(&["hall", "convert", "airport", &folder.path("no.txt"), "--cell", "1"]);
    assert!(said(&output).contains("--cell is 1 m, but the cells of this file are 0.5 m wide: leave --cell out"));
    assert!(!folder.names().contains(&"no.txt".to_owned()));
}

#[test]
fn what_is_there_is_not_overwritten_unless_it_is_forced() {
    let folder = Folder::new("force");
    for (there, to) in [("m.toml", "m.toml"), ("n.yaml", "n.yaml"), ("o.pgm", "o.yaml")] {
        folder.write(there, "mine");
        let before = folder.names();
        let output = run(&["hall", "convert", "airport", &folder.path(to)]);
        assert_eq!(output.status.code(), Some(1));
        assert!(
            said(&output).contains(&format!("{there} exists already: choose another name, or overwrite the file with --force"))
        );
        assert_eq!((folder.read(there), folder.names()), (b"mine".to_vec(), before));
        let output = run(&["explore", "--hall", "empty-8x8", "--map", &folder.path(to)]);
        assert!(output.status.code() == Some(1) && output.stdout.is_empty(), "it is said before the mission, not after it");
        convert("airport", &folder.path(to), &["--force"]);
        assert_ne!(folder.read(there), b"mine");
    }
    // A hall may be converted onto itself.
    convert(&folder.path("m.toml"), &folder.path("m.toml"), &["--force"]);
    assert_eq!(explored(&folder.path("m.toml"))["cells"], 138);
    assert_eq!(folder.names(), ["m.toml", "n.pgm", "n.yaml", "o.pgm", "o.yaml"]);
}

#[test]
fn what_cannot_be_read_or_written_is_said_and_leaves_nothing() {
    let folder = Folder::new("faults");
    let (to, rest) = (folder.path("out.yaml"), "origin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
    let yaml = |name: &str, image: &str, resolution: &str| {
        folder.write(name, format!("image: {image}\nresolution: {resolution}\n{rest}"))
    };
    folder.write("short.pgm", b"P5\n9 9\n255\n\xff\xff");
    folder.write("vast.pgm", b"P5\n4000000000 4000000000\n255\n\xff\xff");
    folder.write("good.pgm", b"P5\n2 1\n255\n\xff\xff");
    folder.write("alone.pgm", b"P5\n2 1\n255\n\xff\xff");
    folder.write(
        "turned.yaml",
        "image: good.pgm\nresolution: 0.5\norigin: [0, 0, 1.5]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
    );
    let large = std::fs::File::create(folder.path("large.pgm")).and_then(|file| file.set_len((64 << 20) + 1));
    large.expect("a file with a hole takes no room");
    let faults = [
        (yaml("large.yaml", "large.pgm", "0.5"), "large.pgm: this image is larger than 67108864 bytes"),
        (folder.path("none.toml"), "none.toml: cannot read this file ("),
        (folder.path("."), "cannot read this file ("),
        (
            folder.write("type.map", "type tile\nheight 1\nwidth 1\nmap\n.\n"),
            ":1: maps of type \"tile\" are not supported: use `octile` or `octile-corner`",
        ),
        (folder.path("alone.pgm"), "alone.pgm: an image does not give the size of a pixel: put "),
        (yaml("short.yaml", "short.pgm", "0.5"), "short.pgm: the image should have 81 pixels, but ends after 2"),
        (
            yaml("vast.yaml", "vast.pgm", "0.5"),
            "vast.pgm: an image of 4000000000 × 4000000000 pixels is too large: at most 16384 × 16384",
        ),
        (yaml("nan.yaml", "good.pgm", ".nan"), "nan.yaml:2: `resolution` is NaN: give a number from 0.001 to 5"),
        (yaml("gone.yaml", "gone.pgm", "0.5"), "gone.yaml:1: cannot read the image "),
        (yaml("folder.yaml", ".", "0.5"), "folder.yaml:1: cannot read the image "),
        (folder.path("turned.yaml"), "turned.yaml:3: `origin` turns the image by 1.5 radians"),
        (folder.write("long.yaml", "# ".repeat(40_000)), "long.yaml: this file is larger than 65536 bytes"),
        (
            folder.write("two.txt", "|r, 1, \n|1, r, \n"),
            "two.txt:2: there is a second robot `r` in row 2, column 2: keep only one",
        ),
    ];
    let before = folder.names();
    for (from, words) in &faults {
        let output = run(&["hall", "convert", from, &to]);
        assert!(output.status.code() == Some(2) && said(&output).contains(words), "{from}: {}", said(&output));
        let output = run(&["explore", "--hall", from]);
        let said = said(&output);
        assert!(
            output.status.code() == Some(2) && said.contains("setting hall.file = ") && said.contains(words),
            "{from}: {said}"
        );
    }
    assert_eq!(folder.names(), before);
    std::fs::create_dir(folder.path("d.pgm")).expect("the folder is ours");
    let before = folder.names();
    for (to, code, words) in [
        ("out.gif", 2, "out.gif does not end with a known format: use one of .toml, .map, .yaml, .txt"),
        ("out", 2, "does not end with a known format"),
        ("no/such/out.toml", 1, "no/such/out.toml cannot be written: "),
        ("good.pgm/out.toml", 1, "good.pgm/out.toml cannot be written: "),
        ("d.yaml", 1, "d.pgm cannot be written: it is a folder"),
    ] {
        for force in [&[][..], &["--force"]] {
            let output = run(&[&["hall", "convert", "airport", &folder.path(to)], force].concat());
            assert!(output.status.code() == Some(code) && said(&output).contains(words), "{to}: {}", said(&output));
        }
        let output = run(&["explore", "--hall", "empty-8x8", "--map", &folder.path(to)]);
        assert!(output.status.code() == Some(code) && said(&output).contains(words), "{to}: {}", said(&output));
    }
    assert_eq!(folder.names(), before);
}

#[test]
fn explore_writes_the_map_as_it_was_explored() {
    let folder = Folder::new("explored");
    for name in ["m.toml", "m.map", "m.yaml"] {
        let map = folder.path(name);
        let output = run(&["explore", "--hall", "airport", "--verdicts", "all-safe", "--map", &map]);
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        assert!(
            text.lines().last().is_some_and(|line| line.starts_with(&map) && line.contains("18 × 12 cells of 0.5 m")),
            "{text}"
        );
        let again = explored(&map);
        assert_eq!((&again["cells"], &again["complete"]), (&138.into(), &true.into()), "{name}");
    }
    let text = folder.path("m.txt");
    let output = run(&["explore", "--json", "--hall", "empty-8x8", "--map", &text]);
    serde_json::from_slice::<Value>(&output.stdout).expect("one JSON object and nothing else");
    assert!(said(&output).contains("m.txt: 10 × 10 cells"), "{}", said(&output));
    let rows = String::from_utf8(folder.read("m.txt")).expect("UTF-8");
    assert_eq!(rows.lines().nth(1), Some("|X, r, 1, 1, 1, 1, 1, 1, 1, X, "));
    assert_eq!(explored(&text)["cells"], 64);
}

#[test]
fn the_running_program_gives_its_map_in_every_file() {
    let folder = Folder::new("served");
    let from = folder.path("from.yaml");
    convert("empty-8x8", &from, &[]);
    let program = Program::serve(&from, "max");
    program.command("start").accepted();
    program.until_phase("explored");
    for name in ["hall.toml", "hall.map", "hall.yaml", "hall.pgm", "hall.txt"] {
        let answer = program.read(&format!("/api/v1/map/{name}"), &[]);
        assert_eq!(answer.status, 200, "{name}");
        folder.write(name, answer.body);
    }
    for name in ["hall.toml", "hall.map", "hall.yaml", "hall.txt"] {
        assert_eq!(explored(&folder.path(name))["cells"], 64, "{name}");
    }
    let shown = program.read("/api/v1/map", &[("accept", "text/plain")]).text();
    assert_eq!(explored(&folder.write("shown.txt", shown))["cells"], 64, "as old clients show it");
}

#[test]
fn a_scene_of_the_virtual_robot_becomes_a_hall_that_is_searched() {
    let folder = Folder::new("scene");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/config/scenes/three-bags.js");
    let to = folder.path("room.toml");
    let output = run(&["hall", "import", scene, &to]);
    assert!(output.status.success(), "{}", said(&output));
    let line = String::from_utf8(output.stdout).expect("UTF-8");
    let shown = "8 × 8 cells of 0.5 m, 3 pieces of luggage; lost: the moving obstacles (1); the sonars of the hall \
         (2); the names of luggage (3)\n";
    assert_eq!(line, format!("{to}: {shown}"));
    assert!(include_str!("../../docs/halls.md").contains(shown.trim_end()), "the page shows the same");
    let explored = run(&["explore", "--hall", &to, "--verdicts", "all-safe", "--json"]);
    assert!(explored.status.success(), "{}", said(&explored));
    let again = run(&["hall", "import", scene, &to]);
    assert!(!again.status.success() && said(&again).contains("exists already"), "{}", said(&again));
    assert!(run(&["hall", "import", scene, &to, "--force"]).status.success());
    std::fs::copy(scene, &to).expect("the folder can be written");
    let onto_itself = run(&["hall", "import", &to, &to, "--force"]);
    assert!(!onto_itself.status.success() && said(&onto_itself).contains("is the scene file itself"), "{}", said(&onto_itself));
    assert_eq!(std::fs::read(&to).expect("it is there"), std::fs::read(scene).expect("it is there"));
}

#[test]
fn a_scene_that_is_none_is_refused_with_its_line_and_leaves_nothing_behind() {
    let folder = Folder::new("no-scene");
    let wrong = folder.write("wrong.js", "export default {\n  floor: { size: { x: 0, y: 35 } },\n}");
    let to = folder.path("room.toml");
    for (file, expect) in [
        (wrong.clone(), format!("{wrong}:2: a side of the floor is 0, but must be 4 to 1000: correct this line")),
        (folder.path("none.js"), "cannot read this file (".to_owned()),
    ] {
        let output = run(&["hall", "import", &file, &to]);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(said(&output).contains(&expect), "{}", said(&output));
    }
    assert_eq!(folder.names(), ["wrong.js"]);
    let served = run(&["explore", "--hall", &wrong]);
    assert!(said(&served).contains("make a hall of it with `hallsweep hall import"), "{}", said(&served));
}
