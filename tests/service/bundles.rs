//! The bundle of a mission can be unpacked and checked without hallsweep, and any change of a file is noticed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::journal::{journal, serve};
use crate::kill::Folder;
use crate::program::{Program, hallsweep};

fn bundle(folder: &Folder, words: &[&str]) -> Output {
    hallsweep(&[&["export", "bundle", "--data", folder.text()], words].concat()).output().expect("the program starts")
}

/// Unpacks a bundle with Python, and returns the folder of its files.
fn unpacked(zip: &Path) -> PathBuf {
    let to = zip.with_extension("unpacked");
    let status = Command::new("python3").args(["-m", "zipfile", "-e"]).args([zip, &to]).status().expect("python3 is there");
    assert!(status.success(), "it is no ZIP file");
    to.join("hallsweep-mission-1")
}

fn is_sound(files: &Path) -> bool {
    let check = Command::new("sha256sum").args(["--check", "--strict", "--quiet", "SHA256SUMS"]).current_dir(files).output();
    check.expect("sha256sum is there").status.success()
}

fn begun(folder: &Folder) -> (Program, u64) {
    let program = serve(folder);
    program.command("start").accepted();
    let first = program.until_asked();
    program.post(&format!("/api/v1/luggage/{first}/verdict"), "{\"verdict\":\"danger\",\"size\":\"suitcase\"}").accepted();
    program.until_phase("bombLocated");
    (program, first)
}

#[test]
fn a_bundle_is_checked_without_hallsweep_and_a_changed_file_is_noticed() {
    let folder = Folder::new("bundles");
    let (program, piece) = begun(&folder);
    let over_http = program.read(&format!("/api/v1/luggage/{piece}/photo?take=1"), &[]).body;
    drop(program);
    let zip = PathBuf::from(format!("{}-mission.zip", folder.text()));
    let written = bundle(&folder, &["1", "-o", zip.to_str().expect("a plain name")]);
    let said = String::from_utf8_lossy(&written.stderr).into_owned();
    assert!(written.status.success() && written.stdout.is_empty(), "{said}");
    let files = unpacked(&zip);
    assert!(is_sound(&files), "as it was written");
    let sums = Command::new("sha256sum").arg("SHA256SUMS").current_dir(&files).output().expect("it is there").stdout;
    let digest = String::from_utf8(sums).expect("plain text").split(' ').next().expect("a digest").to_owned();
    assert!(digest.len() == 64 && said.contains(&digest), "{digest} in {said}");

    let photo = fs::read(files.join(format!("photos/luggage-{piece}-photo-1.png"))).expect("the photo is in it");
    assert!(photo == over_http, "byte by byte");
    let entries = fs::read_to_string(files.join("entries.jsonl")).expect("they are in it");
    assert!(entries.lines().any(|line| line.contains("\"size\":\"suitcase\"")), "{entries}");
    let report = files.join("report.html");
    let (well, said) = journal(&folder, &["check", "--report", report.to_str().expect("a plain name")]);
    assert!(well && said.contains("is confirmed"), "{said}");
    let readme = fs::read_to_string(files.join("README.txt")).expect("it is in it");
    assert!(readme.contains("sha256sum -c SHA256SUMS"), "{readme}");

    let again = bundle(&folder, &["1", "-o", "-"]);
    assert!(again.stdout == fs::read(&zip).expect("it was written"), "the same record gives the same bytes");
    fs::write(files.join("entries.jsonl"), entries.replace("danger", "safe")).expect("it can be changed");
    assert!(!is_sound(&files), "a change is noticed");
}

#[test]
fn what_cannot_be_bundled_is_said_and_nothing_is_written() {
    let folder = Folder::new("no-bundles");
    let (program, piece) = begun(&folder);
    let zip = PathBuf::from(format!("{}-mission.zip", folder.text()));
    let inside = folder.path().join("mission.zip");
    for (words, wanted) in [
        (["2", "-o", zip.to_str().expect("a plain name")], "there is no mission 2"),
        (["1", "-o", inside.to_str().expect("a plain name")], "is inside a data folder"),
    ] {
        let output = bundle(&folder, &words);
        assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains(wanted), "{output:?}");
    }
    assert!(!zip.exists() && !inside.exists());
    drop(program);
    // A lost photo is named, and the rest is written.
    for part in fs::read_dir(folder.path().join("photos")).expect("it is there") {
        fs::remove_dir_all(part.expect("it can be read").path()).expect("it can be removed");
    }
    assert!(bundle(&folder, &["1", "-o", zip.to_str().expect("a plain name"), "--language", "it"]).status.success());
    let files = unpacked(&zip);
    let readme = fs::read_to_string(files.join("README.txt")).expect("it is in it");
    assert!(is_sound(&files) && readme.contains("Per controllare i file") && readme.contains(&format!("#{piece}")), "{readme}");
}
