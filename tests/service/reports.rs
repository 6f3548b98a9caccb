//! A mission report contains what the journal recorded. It is the same by every way, and a later check against the
//! journal names any change of either.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::journal::{journal, serve};
use crate::kill::Folder;
use crate::program::{PATIENCE, Program, hallsweep};
use crate::third_party::patiently;

/// Runs `hallsweep report`. Returns whether the command succeeded, and its output.
fn report(folder: &Folder, words: &[&str]) -> (bool, Vec<u8>) {
    let output = hallsweep(&[&["report", "--data", folder.text()], words].concat()).output().expect("the program starts");
    let said = if output.status.success() { output.stdout } else { output.stderr };
    (output.status.success(), said)
}

/// Writes a report to a file beside the folder.
fn saved(folder: &Folder, name: &str, page: &[u8]) -> PathBuf {
    let path = PathBuf::from(format!("{}-{name}", folder.text()));
    fs::write(&path, page).expect("it can be written");
    path
}

/// Decompresses gzip data.
fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut unpacked = Vec::new();
    flate2::read::GzDecoder::new(bytes).read_to_end(&mut unpacked).expect("it is whole");
    unpacked
}

fn confirmed(folder: &Folder, report: &Path) -> (bool, String) {
    journal(folder, &["check", "--report", report.to_str().expect("a plain name")])
}

/// A mission with a safe piece, a STOP, a refusal, and a bomb with a note, which continues to its end.
fn a_mission(program: &Program) {
    program.command("start").accepted();
    let first = program.until_asked();
    program.verdict(first, "safe").accepted();
    let second = program.until_asked();
    program.command("stop").accepted();
    program.verdict(first, "danger").problem(409);
    let verdict = serde_json::json!({"verdict": "danger", "note": "wires <b>& battery</b>"}).to_string();
    program.post(&format!("/api/v1/luggage/{second}/verdict"), &verdict).accepted();
    program.command("start").accepted();
    program.until_phase("bombLocated");
}

/// All files below a folder, except those that SQLite keeps beside the journal while it reads.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    for path in fs::read_dir(folder).expect("it is there").map(|entry| entry.expect("it can be read").path()) {
        if path.is_dir() {
            files.extend(self::files(&path));
        } else if !["db-wal", "db-shm"].iter().any(|end| path.extension().is_some_and(|extension| extension == *end)) {
            files.push((path.clone(), fs::read(&path).expect("it can be read")));
        }
    }
    files.sort();
    files
}

#[test]
fn a_report_is_the_same_by_every_way_and_is_confirmed_while_the_journal_grows() {
    let folder = Folder::new("reports");
    let mut program = serve(&folder);
    a_mission(&program);
    let under_way = saved(&folder, "under-way.html", &report(&folder, &["1"]).1);
    for alarm in program.json("state")["alarms"].as_array().expect("a list") {
        program.press(&format!("/api/v1/alarms/{}/acknowledge", alarm["id"])).accepted();
    }
    program.command("reset").accepted();
    let mut kept = vec![under_way];
    for language in ["en", "it"] {
        let (well, page) = report(&folder, &["1", "--language", language]);
        assert!(well, "{}", String::from_utf8_lossy(&page));
        let answer = program.read(&format!("/missions/1/report?language={language}"), &[]);
        assert_eq!(answer.status, 200);
        assert_eq!(answer.header("content-disposition"), "attachment; filename=\"hallsweep-mission-1.html\"");
        assert!(answer.body == page, "over HTTP and by the command");
        kept.push(saved(&folder, &format!("{language}.html"), &page));
    }
    let packed = program.read("/missions/1/report?language=en", &[("accept-encoding", "gzip")]);
    assert_eq!(packed.header("content-encoding"), "gzip");
    assert!(unpacked(&packed.body) == fs::read(&kept[1]).expect("it was saved"), "packed, to its end");
    let by_browser = program.read("/missions/1/report", &[("accept-language", "it")]);
    assert!(by_browser.body == fs::read(&kept[2]).expect("it was saved"), "in the language of whoever asks");

    let page = String::from_utf8(fs::read(&kept[1]).expect("it was saved")).expect("it is UTF-8");
    for wanted in [
        "<dd>2: safe 1, danger 1, pending 0</dd>",
        "wires &#60;b&#62;&#38; battery&#60;/b&#62;",
        "luggage #1 was already found safe: a verdict is final",
        "<dt>STOP pressed</dt><dd>1</dd>",
        "alarm 1 raised",
        "operator (http, 127.0.0.1)",
        "A bomb was located",
        " · simulated</p>",
        "<dt>Robots</dt><dd>discovery (simulated), ",
    ] {
        assert!(page.contains(wanted), "{wanted} in {page}");
    }
    assert_eq!(page.matches("src=\"data:image/png;base64,").count(), 2, "both photos");
    for unwanted in ["http://", "https://", "<script", " href=", " src=\"/"] {
        assert!(!page.contains(unwanted), "{unwanted}: it is self-contained");
    }

    program.command("start").accepted();
    program.until_asked();
    for path in &kept {
        let (well, said) = confirmed(&folder, path);
        assert!(well && said.contains("is confirmed") && said.contains("mission 1"), "{said}");
    }
    program.signal("TERM");
    assert!(program.ended_within(std::time::Duration::from_secs(20)).is_some_and(|status| status.success()));
    let before = files(folder.path());
    assert!(report(&folder, &["1"]).0 && confirmed(&folder, &kept[0]).0);
    assert!(files(folder.path()) == before, "making it and holding it against the journal writes nothing");
    drop(serve(&folder));
    kept.iter().for_each(|path| assert!(confirmed(&folder, path).0, "also after a start"));
    kept.iter().for_each(|path| fs::remove_file(path).expect("it was saved"));
}

/// "A bomb was located" sounds like a complete search, although the search was broken off.
#[test]
fn beside_what_a_mission_came_to_stands_what_was_not_searched() {
    let folder = Folder::new("reports-unsearched");
    let program = serve(&folder);
    a_mission(&program);
    let open = program.json("mission")["progress"]["unknown"].as_u64().expect("a number");
    assert!(open > 1, "the search was broken off");
    let places = format!("{open} known places not searched");
    let page = |path: &str| program.read(path, &[("accept", "text/html")]).text();
    for (path, wanted) in [
        ("/", format!("<span class=\"left\"><span class=\"unseen\">· </span>{places}</span>")),
        ("/", format!("bomb located · {places} · hallsweep</title>")),
        ("/missions", "A bomb was located · the search ended there</span></td>".to_owned()),
        ("/missions/1", format!("A bomb was located · {places} · simulated</h2>")),
        ("/missions/1/report?language=en", format!("A bomb was located · {places} · simulated</p>")),
        ("/missions/1/report?language=en", format!("<dt>Known places not searched</dt><dd>{open}</dd>")),
    ] {
        let page = page(path);
        assert!(page.contains(&wanted), "{wanted} in {path}: {page}");
    }
}

#[test]
fn a_report_in_which_any_byte_was_changed_is_not_confirmed() {
    let folder = Folder::new("reports-changed");
    let program = serve(&folder);
    a_mission(&program);
    drop(program);
    let (_, page) = report(&folder, &["1"]);
    let check = |changed: &[u8], words: &str| {
        let path = saved(&folder, "changed.html", changed);
        let (well, said) = confirmed(&folder, &path);
        assert!(!well && said.contains("is not confirmed") && said.contains(words), "{words}: {said}");
        fs::remove_file(path).expect("it was saved");
    };
    // Places spread over the whole page, chosen with a multiplier that reaches every part.
    for step in 0..64_usize {
        let place = step * 0x9E37_79B9 % page.len();
        let mut changed = page.clone();
        changed[place] ^= 1 << (step % 8);
        check(&changed, "");
    }
    let text = String::from_utf8(page.clone()).expect("it is UTF-8");
    let line_of = |words: &str| text[..text.find(words).expect("it is in it")].matches('\n').count() + 1;
    for (one, other) in [
        ("<b>danger</b>, by operator", "<b>safe</b>, by operator"),
        ("A bomb was located", "No bomb was located"),
        ("STOP pressed</dt><dd>1", "STOP pressed</dt><dd>0"),
        ("SHA-256 ", "SHA-512 "),
    ] {
        check(text.replacen(one, other, 1).as_bytes(), &format!("in line {}", line_of(one)));
    }
    let claim = text.split_once("content=\"").and_then(|(_, rest)| rest.split_once('"')).expect("a claim").0.to_owned();
    let claimed = |other: &str| text.replacen(&claim, other, 1).into_bytes();
    let number = |words: &str| claim.split_once(words).expect("it is claimed").1.split(',').next().expect("a number").to_owned();
    let entry = number("entry ");
    check(&claimed(&claim.replace("language en", "language it")), "in line 2");
    check(&claimed(&claim.replace("mission 1", "mission 2")), "the journal has no mission 2 up to entry");
    check(&claimed(&claim.replace(&format!("entry {entry}"), "entry 20")), "");
    check(&claimed(&claim.replace(&format!("entry {entry}"), "entry 999999")), "the journal has no mission 1 up to entry 999999");
    check(&claimed(&claim.replace("edition 5", "edition 6")), "edition 6, which this hallsweep does not know");
    check(&claimed(&claim.replace("edition 5", "edition 1")), "in line ");
    check(&claimed("anything"), "the file is not a hallsweep report");
    check(&page[..page.len() - 1], "the file has no more text");
    check(&[&page[..], b"\n"].concat(), "and the journal has no more text");
    check(b"", "the file is not a hallsweep report");

    let path = saved(&folder, "sound.html", &page);
    assert!(confirmed(&folder, &path).0, "as it was it is confirmed");
    let photo = files(&folder.path().join("photos")).remove(0);
    let mut bytes = photo.1.clone();
    bytes[100] ^= 1;
    fs::write(&photo.0, bytes).expect("it can be written");
    let (well, said) = confirmed(&folder, &path);
    assert!(!well && said.contains("was changed"), "{said}");
    fs::remove_file(path).expect("it was saved");
}

#[test]
fn what_cannot_be_reported_is_said() {
    let folder = Folder::new("reports-none");
    let (well, said) = report(&folder, &["1"]);
    assert!(!well && String::from_utf8_lossy(&said).contains("there is no journal in"));
    let program = serve(&folder);
    let (well, said) = report(&folder, &["7"]);
    assert!(!well && String::from_utf8_lossy(&said).contains("there is no mission 7 in the journal"), "{said:?}");
    for words in [&["1", "--language", "de"][..], &["x"], &["1", "--format", "pdf"], &[]] {
        assert!(!report(&folder, words).0, "{words:?}");
    }
    assert_eq!(program.read("/missions/7/report", &[]).status, 404);
    assert!(program.read("/missions/1/report?language=de", &[]).problem(422).contains("en or it"));
    let (well, said) = confirmed(&folder, Path::new("/nowhere/report.html"));
    assert!(!well && said.contains("/nowhere/report.html cannot be read"), "{said}");
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("it is there").success());
    let waits = hallsweep(&["journal", "check", "--data", folder.text(), "--report", pipe.to_str().expect("a plain name")]);
    let said = patiently(&waits).output().expect("it comes to its end").stderr;
    let said = String::from_utf8_lossy(&said);
    assert!(said.contains("pipe cannot be read: it is a pipe or a device, not a plain file"), "{said}");
}

/// A temporary disk failure is no part of the mission, so it must not appear in a report.
#[test]
fn a_photo_that_cannot_be_read_just_now_makes_no_report_and_leaves_what_was_there() {
    let folder = Folder::new("reports-unreadable");
    let program = serve(&folder);
    a_mission(&program);
    let photos: Vec<PathBuf> = files(&folder.path().join("photos")).into_iter().map(|(photo, _)| photo).collect();
    let aside = |photo: &PathBuf| photo.with_extension("aside");
    for photo in &photos {
        fs::rename(photo, aside(photo)).and_then(|()| fs::create_dir(photo)).expect("it can be put aside");
    }
    let words = program.read("/missions/1/report", &[]).problem(503);
    assert!(words.contains("it is a folder"), "{words}");
    drop(program);
    let older = saved(&folder, "older.html", b"of yesterday");
    let into_older = ["1", "-o", older.to_str().expect("a plain name")];
    let (well, said) = report(&folder, &into_older);
    assert!(!well && String::from_utf8_lossy(&said).contains("it is a folder"), "{said:?}");
    assert_eq!(fs::read(&older).expect("it is there"), b"of yesterday");
    photos.iter().for_each(|photo| fs::remove_dir(photo).expect("it was made"));
    let (well, lost) = report(&folder, &["1", "-o", "-"]);
    let lost = String::from_utf8(lost).expect("it is UTF-8");
    assert!(well && lost.matches("is lost: its file is missing").count() == 2 && !lost.contains(folder.text()), "{lost}");
    assert!(!Path::new("-").exists(), "it was printed");
    photos.iter().for_each(|photo| fs::rename(aside(photo), photo).expect("it was put aside"));
    assert!(report(&folder, &into_older).0);
    assert!(fs::read(&older).expect("it is there") == report(&folder, &["1"]).1, "the same in a file");
    assert!(confirmed(&folder, &older).0);
    fs::remove_file(older).expect("it was saved");
}

/// Safety V3.
#[test]
fn what_was_said_to_be_lost_is_neither_reported_nor_confirmed() {
    let folder = Folder::new("reports-lost");
    let mut program = serve(&folder);
    program.command("start").accepted();
    program.until_asked();
    let (_, before) = report(&folder, &["1"]);
    program.command("stop").accepted();
    // A STOP is answered even if the disk is slow. An orderly end stores the STOP in the journal first.
    program.signal("TERM");
    assert!(program.ended_within(PATIENCE).is_some_and(|status| status.success()));
    let (_, after) = report(&folder, &["1"]);
    let until = |page: &[u8]| -> u64 {
        let page = String::from_utf8_lossy(page).into_owned();
        page.split_once(", entry ").and_then(|(_, rest)| rest.split(',').next()?.parse().ok()).expect("it is claimed")
    };
    assert!(until(&before) < until(&after));
    let lost = format!("everything after entry {:020} was said to be lost\n", until(&before));
    fs::write(folder.path().join("journal.lost"), lost).expect("it can be written");
    // The file would still say that these entries were stored.
    fs::remove_file(folder.path().join("journal.head")).expect("it is there");
    assert!(report(&folder, &["1"]).1 == before, "it ends where it ended then");
    for format in ["jsonl", "csv"] {
        let list = String::from_utf8(report(&folder, &["1", "--format", format]).1).expect("it is UTF-8");
        assert!(!list.contains("STOP") && list.contains("START"), "{list}");
    }
    let [before, after] =
        [("before", before), ("after", after)].map(|(name, page)| saved(&folder, &format!("{name}.html"), &page));
    assert!(confirmed(&folder, &before).0);
    let (well, said) = confirmed(&folder, &after);
    assert!(!well && said.contains("the journal has no mission 1 up to entry"), "{said}");
    [before, after].iter().for_each(|path| fs::remove_file(path).expect("it was saved"));
}

/// A journal in memory is lost when the program ends.
#[test]
fn where_nothing_is_kept_a_report_says_that_nothing_can_confirm_it() {
    let program = Program::with(&["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", "max", "--data", "none"]);
    a_mission(&program);
    let page = program.read("/missions/1/report?language=en", &[]).text();
    assert!(page.contains("nothing can confirm this report later") && page.contains("base64,"), "{page}");
}

#[test]
fn the_record_of_a_mission_is_there_as_lines_and_as_a_table() {
    let folder = Folder::new("reports-lists");
    let program = serve(&folder);
    a_mission(&program);
    let (_, exported) = journal(&folder, &["export", "--mission", "1"]);
    let lines = program.read("/missions/1/record.jsonl", &[]);
    assert_eq!(
        (lines.header("content-type"), lines.text()),
        ("application/jsonl", exported.clone()),
        "as the journal is exported"
    );
    assert_eq!(report(&folder, &["1", "--format", "jsonl"]).1, exported.as_bytes());
    let robots = &program.json("missions/1")["conditions"]["robots"];
    assert_eq!((&robots[0]["name"], &robots[0]["kind"]), (&"discovery".into(), &"sim".into()), "who took part: {robots}");
    let table = program.read("/missions/1/record.csv", &[]);
    assert_eq!(table.header("content-type"), "text/csv; charset=utf-8");
    assert!(table.body == report(&folder, &["1", "--format", "csv"]).1);
    let table = table.text();
    assert_eq!(table.lines().count(), exported.lines().count() + 1, "each entry a row");
    assert!(table.contains(",command,STOP,operator,127.0.0.1,http,accepted\r\n"), "{table}");
    let italian = String::from_utf8(report(&folder, &["1", "--format", "csv", "--language", "it"]).1).expect("it is UTF-8");
    assert!(italian.contains(",command,STOP,operator,127.0.0.1,http,accettato\r\n"), "{italian}");
}
