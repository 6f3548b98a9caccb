//! A mission is handed over with a receipt, and the code on the receipt shows later whether the record is still the one
//! that was handed over.

use std::process::Command;

use crate::journal::{journal, serve};
use crate::kill::Folder;
use crate::program::{Program, hallsweep};

/// Changes the sender of all commands in a journal and computes all digests again, as somebody who may write to the
/// folder could.
const FORGERY: &str = r#"
import hashlib, json, sqlite3, sys
folder = sys.argv[1]
db = sqlite3.connect(folder + "/journal.db")
guards = db.execute("SELECT name, sql FROM sqlite_master WHERE type = 'trigger'").fetchall()
for name, _ in guards:
    db.execute("DROP TRIGGER " + name)
db.execute("""UPDATE events SET body = replace(body, '"who":"operator"', '"who":"somebody"') WHERE kind = 'command'""")
last = bytes(32)
start = 0
for (end,) in db.execute("SELECT last FROM pages ORDER BY last").fetchall():
    digest = hashlib.sha256(last)
    for row in db.execute("SELECT seq, mission, at_ms, offset_s, kind, body FROM events WHERE seq > ? AND seq <= ? ORDER BY seq", (start, end)):
        digest.update(json.dumps(row, separators=(",", ":"), ensure_ascii=False).encode() + b"\n")
    last, start = digest.digest(), end
    db.execute("UPDATE pages SET digest = ? WHERE last = ?", (last, end))
for _, sql in guards:
    db.execute(sql)
db.commit()
db.execute("PRAGMA wal_checkpoint(TRUNCATE)")
open(folder + "/journal.head", "w").write("entry %020d sha256 %s\n" % (start, last.hex()))
"#;

fn codes(program: &Program, mission: u64) -> Vec<String> {
    let list = program.json(&format!("missions/{mission}/receipts"));
    let receipts = list["receipts"].as_array().expect("a list").iter();
    receipts.map(|receipt| receipt["code"].as_str().expect("it has a code").to_owned()).collect()
}

#[test]
fn a_receipt_is_confirmed_until_the_record_before_it_is_changed() {
    let folder = Folder::new("receipts");
    let program = serve(&folder);
    let hand_over = |body: &str| program.post("/api/v1/commands/handOver", body);
    assert!(hand_over(r#"{"to":"police"}"#).problem(409).contains("not possible while"), "no mission is under way");
    program.command("start").accepted();
    let piece = program.until_asked();
    let state = || {
        let state = program.json("state");
        ["phase", "holds", "epoch"].map(|name| state["mission"][name].clone())
    };
    let before = state();
    hand_over(r#"{"to":"Inspector <b>Bianchi</b>","note":"with the photos"}"#).accepted();
    assert_eq!(state(), before, "it halts nobody, and the piece still waits for its verdict");
    assert!(hand_over(r#"{"to":"court","mission":2}"#).problem(409).contains("mission 1 is under way now"));
    program.verdict(piece, "danger").accepted();
    program.until_phase("bombLocated");
    hand_over(r#"{"to":"court","mission":1}"#).accepted();
    let list = program.json("missions/1/receipts");
    let (first, codes_then) = (&list["receipts"][0], codes(&program, 1));
    assert_eq!(
        (&first["to"], &first["note"], &first["by"]),
        (&"Inspector <b>Bianchi</b>".into(), &"with the photos".into(), &"operator (http, 127.0.0.1)".into())
    );
    let rest = program.json(&format!("missions/1/receipts?after={}&limit=1", first["seq"]));
    assert_eq!((rest["receipts"][0]["to"].as_str(), &rest["next"]), (Some("court"), &serde_json::Value::Null));
    let page = program.read("/missions/1/receipts", &[("accept-language", "it")]).text();
    assert!(page.contains(&codes_then[0]) && page.contains("Inspector &#60;b&#62;") && !page.contains("<b>Bianchi"), "{page}");

    for code in &codes_then {
        let (well, said) = journal(&folder, &["check", "--receipt", code]);
        assert!(well && said.contains("is confirmed"), "while the program runs: {said}");
    }
    program.command("reset").problem(409);
    program.post("/api/v1/alarms/1/acknowledge", "").accepted();
    program.command("reset").accepted();
    program.command("start").accepted();
    program.until_asked();
    assert_eq!(codes(&program, 1), codes_then, "later entries change no receipt");
    drop(program);
    let check = |code: &str| journal(&folder, &["check", "--receipt", code]);
    let (well, said) = check(&codes_then[0].to_uppercase());
    assert!(
        well && said.contains("by: operator (http, 127.0.0.1)\n  to: Inspector <b>Bianchi</b>\n  note: with the photos\n"),
        "{said}"
    );

    let seq: u64 = codes_then[0].split('-').nth(1).expect("an entry").parse().expect("a number");
    let digits = codes_then[0].rsplit('-').next().expect("the digits");
    for (code, why) in [
        (format!("1-{}-{digits}", seq + 1), "is no hand-over of mission 1"),
        (format!("2-{seq}-{digits}"), "is no hand-over of mission 2"),
        (format!("7-{seq}-{digits}"), "is no hand-over of mission 7"),
        (format!("1-{}-{digits}", u64::MAX), "is no hand-over of mission 1"),
        (format!("1-{seq}-0123456789abcdef"), "the digest differs"),
        (format!("1-{seq}"), "write mission, entry and 16 digits"),
    ] {
        let (well, said) = check(&code);
        assert!(!well && said.contains(why), "{code}: {said}");
    }

    let forged = Command::new("python3").args(["-c", FORGERY, folder.text()]).status().expect("python3 is there");
    assert!(forged.success());
    let (well, said) = journal(&folder, &["check"]);
    assert!(well, "nothing in the folder shows the forgery: {said}");
    for code in &codes_then {
        let (well, said) = check(code);
        assert!(!well && said.contains("the digest differs"), "but the receipt does: {said}");
    }
}

#[test]
fn a_receipt_of_another_journal_is_not_confirmed() {
    let codes = ["receipts-one", "receipts-other"].map(|name| {
        let folder = Folder::new(name);
        let program = serve(&folder);
        program.command("start").accepted();
        program.until_asked();
        program.post("/api/v1/commands/handOver", r#"{"to":"police"}"#).accepted();
        (codes(&program, 1), folder)
    });
    let [(one, folder), (other, _other)] = &codes;
    assert!(journal(folder, &["check", "--receipt", &one[0]]).0);
    let (well, said) = journal(folder, &["check", "--receipt", &other[0]]);
    assert!(!well && said.contains("is not confirmed"), "{said}");
}

#[test]
fn a_mission_that_was_moved_to_an_archive_is_confirmed_there() {
    let folder = Folder::new("receipts-archived");
    let program = serve(&folder);
    program.command("start").accepted();
    let piece = program.until_asked();
    program.post("/api/v1/commands/handOver", r#"{"to":"police"}"#).accepted();
    let code = codes(&program, 1).remove(0);
    program.command("stop").accepted();
    program.verdict(piece, "safe").accepted();
    program.command("reset").accepted();
    drop(program);
    let archive = format!("{}-old.hallsweep", folder.text());
    let (well, said) = journal(&folder, &["archive", "--before", "2999-01-01", "-o", &archive]);
    assert!(well, "{said}");
    let (well, said) = journal(&folder, &["check", "--receipt", &code]);
    assert!(!well && said.contains("add --archive with its path"), "{said}");
    let (well, said) = journal(&folder, &["check", "--archive", &archive, "--receipt", &code]);
    assert!(well && said.contains("is confirmed"), "{said}");
    let output = hallsweep(&["journal", "--data", &archive, "check", "--receipt", &code]).output().expect("the program starts");
    assert!(String::from_utf8_lossy(&output.stdout).contains("is confirmed"), "{output:?}");
    std::fs::remove_file(archive).expect("it was written");
}
