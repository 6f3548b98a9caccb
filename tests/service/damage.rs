//! Safety R5: whatever file of the data folder is damaged, the console comes up, says which file and what to do, and nothing moves.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value;

use crate::journal::{holds, serve};
use crate::kill::Folder;
use crate::program::{Program, hallsweep};

/// A folder in which a piece of luggage waits for its verdict, after a STOP and a kill.
static KEPT: LazyLock<Folder> = LazyLock::new(|| {
    let folder = Folder::new("damage");
    let program = serve(&folder);
    program.command("start").accepted();
    program.until_asked();
    program.command("stop").accepted();
    // A STOP is answered before it is on record; what comes after it is answered when both are.
    program.put("/api/v1/temperature", "{\"status\":\"ok\"}").accepted();
    program.killer()();
    drop(program);
    folder
});

/// What is done to a file, or put in its place.
#[derive(Clone, Copy, Debug)]
enum Damage {
    CutShort,
    Emptied,
    Zeros,
    Garbage,
    AFolder,
    APipe,
    ALinkToNowhere,
}

use Damage::{AFolder, ALinkToNowhere, APipe, CutShort, Emptied, Garbage, Zeros};

const ALL: [Damage; 7] = [CutShort, Emptied, Zeros, Garbage, AFolder, APipe, ALinkToNowhere];

impl Damage {
    fn apply(self, path: &Path) {
        let bytes = fs::read(path).unwrap_or_default();
        if path.is_dir() {
            fs::remove_dir_all(path).expect("the folder is this test's own");
        } else if path.exists() {
            fs::remove_file(path).expect("the folder is this test's own");
        }
        match self {
            CutShort => fs::write(path, &bytes[..bytes.len() / 2]).expect("the folder is this test's own"),
            Emptied => fs::write(path, "").expect("the folder is this test's own"),
            Zeros => fs::write(path, vec![0; bytes.len()]).expect("the folder is this test's own"),
            Garbage => fs::write(path, [0xa5, b'\n', 0xff].repeat(999)).expect("the folder is this test's own"),
            AFolder => fs::create_dir_all(path.join("inner")).expect("the folder is this test's own"),
            APipe => assert!(Command::new("mkfifo").arg(path).status().expect("the folder is this test's own").success()),
            ALinkToNowhere => std::os::unix::fs::symlink("/nowhere/at/all", path).expect("the folder is this test's own"),
        }
    }
}

/// A copy of what was kept.
fn copy() -> Folder {
    static NUMBER: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let folder = Folder::new(&format!("damage-{number}"));
    let copied = Command::new("cp").arg("-a").arg(KEPT.path().join(".")).arg(folder.path()).status();
    assert!(copied.expect("cp is there").success());
    folder
}

fn started(folder: &Folder) -> Program {
    Program::with(&["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--speed", "max", "--data", folder.text()])
}

/// The console is there, the robot is held, STOP works, and START is refused.
fn check_held(program: &Program, what: &str, file: &str) -> Value {
    let state = program.json("state");
    let words = state["mission"]["storeFailure"].as_str().unwrap_or_default().to_owned();
    assert!(holds(&state, "store"), "{what}: {state:#}");
    assert!(words.contains(file) && words.contains("start"), "{what}: {words}");
    let page = program.read("/", &[]);
    assert!(page.status == 200 && page.text().contains(file), "{what}: the console says which file");
    let refused = program.command("start").problem(409);
    assert!(refused.contains(file) && refused.contains("start"), "{what}: START says which file, and what to do: {refused}");
    program.command("stop").accepted();
    state
}

#[test]
fn a_damaged_file_holds_the_robot_and_is_named_with_what_to_do() {
    let every: [(&str, &[Damage]); 8] = [
        ("journal.db", &[AFolder, APipe, ALinkToNowhere]),
        ("journal.db-wal", &[Zeros, Garbage, AFolder, APipe, ALinkToNowhere]),
        ("journal.db-shm", &[AFolder, APipe, ALinkToNowhere]),
        ("journal.lock", &[AFolder, APipe, ALinkToNowhere]),
        ("journal.head", &[CutShort, Garbage, AFolder, APipe, ALinkToNowhere]),
        ("journal.lost", &[CutShort, Zeros, Garbage, AFolder, APipe, ALinkToNowhere]),
        ("stops", &[AFolder, APipe, ALinkToNowhere]),
        ("simulated-robot.txt", &ALL),
    ];
    for (file, damages) in every {
        for damage in damages {
            let folder = copy();
            damage.apply(&folder.path().join(file));
            let program = started(&folder);
            let state = check_held(&program, &format!("{file}: {damage:?}"), file);
            assert_eq!(holds(&state, "robotLink"), file == "simulated-robot.txt", "a robot that may be anywhere is not there");
            check_shown(&state, file);
        }
    }
    for damage in [Garbage, APipe, ALinkToNowhere] {
        let folder = copy();
        damage.apply(&folder.path().join("photos"));
        let state = check_held(&started(&folder), &format!("photos: {damage:?}"), "photos");
        check_shown(&state, "photos");
    }
}

/// What stands is shown as long as the journal itself can be read.
fn check_shown(state: &Value, damaged: &str) {
    let pending = state["luggage"][0]["verdict"] == "pending";
    let shown = (state["mission"]["phase"].as_str(), pending, holds(state, "operator"));
    let is_readable = !damaged.starts_with("journal.db");
    assert_eq!(shown == (Some("inspecting"), true, true), is_readable, "{damaged}: {state:#}");
}

/// All of the journal in one file, as it is after an orderly end.
#[test]
fn a_journal_without_its_log_that_is_damaged_holds_the_robot() {
    for damage in [CutShort, Zeros, Garbage] {
        let folder = copy();
        let (well, said) = crate::journal::journal(&folder, &["rebuild"]);
        assert!(well, "{said}");
        damage.apply(&folder.path().join("journal.db"));
        check_held(&started(&folder), &format!("journal.db: {damage:?}"), "journal.db");
    }
}

/// Nobody knows whether the last STOP is on record: so it is taken for one.
#[test]
fn a_memory_of_stop_that_cannot_be_understood_holds_the_robot_as_a_stop_does() {
    for damage in [CutShort, Emptied, Zeros, Garbage] {
        let folder = copy();
        let program = started(&folder);
        program.command("start").problem(409);
        let piece = program.until_asked();
        program.verdict(piece, "safe").accepted();
        program.command("start").accepted();
        let epoch = program.json("state")["mission"]["epoch"].as_u64();
        program.killer()();
        drop(program);
        damage.apply(&folder.path().join("stops"));
        let program = started(&folder);
        let state = program.json("state");
        assert!(holds(&state, "operator") && !holds(&state, "store"), "{damage:?}: {state:#}");
        assert!(state["mission"]["epoch"].as_u64() > epoch, "{damage:?}: what was sent before it is outdated");
        let log = state["log"].to_string();
        assert!(log.contains("stops was damaged") && log.contains("as by a STOP"), "{damage:?}: {log}");
        program.command("start").accepted();
    }
}

/// What is of no consequence holds nobody up.
#[test]
fn what_can_be_made_again_is_made_again() {
    let every: [(&str, &[Damage]); 5] = [
        ("journal.db-shm", &[CutShort, Zeros, Garbage]),
        ("journal.lock", &[Garbage]),
        ("journal.head", &[Emptied, Zeros]),
        ("journal.lost", &[Emptied]),
        ("room.unfinished", &[Garbage, APipe, ALinkToNowhere]),
    ];
    for (file, damages) in every {
        for damage in damages {
            let folder = copy();
            damage.apply(&folder.path().join(file));
            let program = started(&folder);
            let state = program.json("state");
            assert!(!holds(&state, "store") && holds(&state, "restart"), "{file}: {damage:?}: {state:#}");
            assert_eq!(state["luggage"][0]["verdict"], "pending", "{file}: {damage:?}");
        }
    }
}

/// Safety V2: a picture that is not what it was is none, and nobody waits at a pipe.
#[test]
fn a_damaged_photo_is_to_be_taken_again() {
    for damage in ALL {
        let folder = copy();
        damage.apply(&photo(&folder.path().join("photos")));
        let program = started(&folder);
        let piece = program.until_asked();
        assert_eq!(program.json(&format!("luggage/{piece}"))["photo"]["state"], "failed", "{damage:?}");
        assert_eq!(program.read("/", &[]).status, 200);
        program.verdict(piece, "safe").problem(409);
    }
}

fn photo(folder: &Path) -> PathBuf {
    let first = |folder: &Path| {
        let mut here = fs::read_dir(folder).expect("the folder can be read");
        here.find_map(Result::ok).expect("something is in it").path()
    };
    first(&first(folder))
}

/// Safety A1, R5: keys that cannot be read let nobody in, and nothing moves that nobody could stop; the mended file lets people in.
#[test]
fn damaged_keys_let_nobody_in_and_hold_the_robot() {
    const KEYED: &str = "HALLSWEEP__HTTP__REQUIRE_TOKEN";
    let arguments = |folder: &Folder| -> Vec<String> {
        ["serve", "--http", "127.0.0.1:0", "--hall", "airport", "--data", folder.text()].map(str::to_owned).to_vec()
    };
    let start = |folder: &Folder| {
        let arguments = arguments(folder);
        let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
        Program::started(hallsweep(&words).env(KEYED, "true"))
    };
    for damage in [Zeros, Garbage, Emptied, AFolder, APipe, ALinkToNowhere] {
        let folder = copy();
        let file = folder.path().join("access.toml");
        drop(start(&folder));
        let whole = fs::read_to_string(&file).expect("the first start makes a key");
        let token = whole.split("token = \"").nth(1).and_then(|rest| rest.split('"').next()).expect("it has a token").to_owned();
        damage.apply(&file);
        let program = start(&folder);
        let said = program.says();
        assert!(said.contains("nobody can sign in") && said.contains("access.toml"), "{damage:?}: {said}");
        let bearer = format!("Bearer {token}");
        let asked = || program.read("/api/v1/state", &[("authorization", &bearer)]);
        assert_eq!(asked().status, 401, "{damage:?}");
        let unasked = program.read("/sign-in", &[("accept", "text/html")]).text();
        assert!(unasked.contains("nobody can sign in"), "{damage:?}: {unasked}");
        let page =
            program.post_with("/sign-in", &[("content-type", "application/x-www-form-urlencoded")], &format!("token={token}"));
        assert!(page.status == 403 && page.text().contains("nobody can sign in"), "{damage:?}: {}", page.text());

        if file.is_dir() {
            fs::remove_dir_all(&file).unwrap();
        } else {
            fs::remove_file(&file).unwrap();
        }
        let (fresh, mended) = (folder.path().join("fresh"), &file);
        fs::write(&fresh, &whole).unwrap();
        fs::set_permissions(&fresh, std::os::unix::fs::PermissionsExt::from_mode(0o600)).unwrap();
        fs::rename(&fresh, mended).unwrap();
        let deadline = crate::program::Deadline::within(crate::program::PATIENCE);
        while asked().status != 200 {
            assert!(!deadline.has_passed(), "{damage:?}: the mended file counts");
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        let state = asked().json();
        let words = state["mission"]["storeFailure"].as_str().unwrap_or_default();
        assert!(holds(&state, "store") && words.contains("access.toml"), "{damage:?}: {state:#}");
    }
}

/// Whoever looks into a folder that was there already finds files for their owner alone, or for the group where the folder is its.
#[test]
fn every_file_is_private_or_the_groups_where_the_folder_is() {
    use std::os::unix::fs::PermissionsExt;
    for (above, file, inner) in [(0o755, 0o600, 0o700), (0o770, 0o660, 0o770)] {
        let folder = Folder::new(&format!("damage-modes-{above:o}"));
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(above)).unwrap();
        let program = serve(&folder);
        program.command("start").accepted();
        program.until_asked();
        program.command("stop").accepted();
        let mut names = Vec::new();
        let mut open = vec![folder.path().to_owned()];
        while let Some(path) = open.pop() {
            for entry in fs::read_dir(path).unwrap() {
                let path = entry.unwrap().path();
                let mode = fs::metadata(&path).unwrap().permissions().mode() & 0o777;
                assert_eq!(mode, if path.is_dir() { inner } else { file }, "{above:o}: {}", path.display());
                names.push(path.file_name().unwrap().to_string_lossy().into_owned());
                if path.is_dir() {
                    open.push(path);
                }
            }
        }
        for name in [
            "journal.db",
            "journal.db-wal",
            "journal.db-shm",
            "journal.head",
            "journal.lock",
            "journal.lost",
            "stops",
            "simulated-robot.txt",
        ] {
            assert!(names.iter().any(|there| there == name), "{name} is not in {names:?}");
        }
        assert!(names.iter().any(|name| name.ends_with(".png")), "{names:?}");
    }
}
