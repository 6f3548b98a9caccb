//! Safety R5: whichever file of the data folder is damaged, the console starts, names the file and the remedy, and no
//! robot moves.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use hallsweep::storage::names::{self, Name};
use serde_json::Value;

use crate::journal::{holds, serve};
use crate::kill::Folder;
use crate::program::{Program, hallsweep};

/// The hall of the settings, and the hall that was chosen while the program ran and in which the robots are.
pub(crate) const HALLS: [&str; 2] = ["empty-8x8", "airport"];

/// Command for the program with a second robot, which archives missions after a day.
pub(crate) fn command(folder: &Folder, hall: &str) -> Command {
    let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0", "--hall", hall, "--speed", "max", "--data", folder.text()]);
    command.env("HALLSWEEP__ROBOTS__PORTER__KIND", "sim").env("HALLSWEEP__STORE__KEEP_DAYS", "1");
    command
}

/// A folder in which a piece of luggage waits for its verdict, after a STOP and a kill.
pub(crate) static KILLED: LazyLock<Folder> = LazyLock::new(|| {
    let folder = Folder::new("damage-killed");
    let program = Program::started(&mut command(&folder, HALLS[0]));
    program.until("all robots are there", |state| {
        let robots = state["robots"].as_array().expect("a list");
        robots.len() == 4 && robots.iter().all(|robot| !robot["parts"].is_null())
    });
    let kept = program.send("PUT", "/api/v1/simulator/halls/mine", "application/toml", "width = 2\nheight = 2\n");
    assert_eq!(kept.status, 200, "{}", kept.text());
    let chosen = program.put("/api/v1/simulator/hall", &format!("{{\"name\":\"{}\"}}", HALLS[1]));
    assert_eq!(chosen.status, 200, "{}", chosen.text());
    program.command("start").accepted();
    program.until_asked();
    program.command("stop").accepted();
    // A STOP is answered before the journal stores it. The next command is answered when both are stored.
    program.put("/api/v1/temperature", "{\"status\":\"ok\"}").accepted();
    program.killer()();
    drop(program);
    folder
});

/// A folder after an orderly end: one file contains the whole journal.
pub(crate) static ENDED: LazyLock<Folder> = LazyLock::new(|| {
    let folder = copy(&KILLED);
    let (well, said) = crate::journal::journal(&folder, &["rebuild"]);
    assert!(well, "{said}");
    folder
});

/// A change to a file, or a replacement of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Damage {
    CutShort,
    Emptied,
    OneWrongByte,
    Zeros,
    Garbage,
    AFolder,
    APipe,
    ADevice,
    ALinkToNowhere,
}

use Damage::{ADevice, AFolder, ALinkToNowhere, APipe, CutShort, Emptied, Garbage, OneWrongByte, Zeros};

pub(crate) const ALL: [Damage; 9] = [CutShort, Emptied, OneWrongByte, Zeros, Garbage, AFolder, APipe, ADevice, ALinkToNowhere];

impl Damage {
    pub(crate) fn apply(self, path: &Path) {
        // Only a regular file is read: reading from a pipe would block.
        let is_file = fs::symlink_metadata(path).is_ok_and(|there| there.is_file());
        let mut bytes = if is_file { fs::read(path).expect("the folder is this test's own") } else { Vec::new() };
        remove(path);
        fs::create_dir_all(path.parent().expect("it is in a folder")).expect("the folder is this test's own");
        let write = |bytes: &[u8]| fs::write(path, bytes).expect("the folder is this test's own");
        let link = |to: &str| std::os::unix::fs::symlink(to, path).expect("the folder is this test's own");
        match self {
            CutShort => write(&bytes[..bytes.len() / 2]),
            Emptied => write(&[]),
            OneWrongByte => {
                if let Some(byte) = bytes.first_mut() {
                    *byte ^= 1;
                }
                write(&bytes);
            }
            Zeros => write(&vec![0; bytes.len()]),
            Garbage => write(&[0xa5, b'\n', 0xff].repeat(999)),
            AFolder => fs::create_dir_all(path.join("inner")).expect("the folder is this test's own"),
            APipe => assert!(Command::new("mkfifo").arg(path).status().expect("the folder is this test's own").success()),
            ADevice => link("/dev/zero"),
            ALinkToNowhere => link("/nowhere/at/all"),
        }
    }

    fn leaves_no_file(self) -> bool {
        matches!(self, AFolder | APipe | ADevice | ALinkToNowhere)
    }
}

fn remove(path: &Path) {
    match fs::symlink_metadata(path) {
        Ok(there) if there.is_dir() => fs::remove_dir_all(path).expect("the folder is this test's own"),
        Ok(_) => fs::remove_file(path).expect("the folder is this test's own"),
        Err(_) => {}
    }
}

/// Type and content of the file at a path.
pub(crate) fn seen(path: &Path) -> Option<(fs::FileType, Vec<u8>)> {
    let there = fs::symlink_metadata(path).ok()?.file_type();
    Some((there, if there.is_file() { fs::read(path).expect("it can be read") } else { Vec::new() }))
}

pub(crate) fn copy(kept: &Folder) -> Folder {
    static NUMBER: AtomicUsize = AtomicUsize::new(0);
    let folder = Folder::new(&format!("damage-{}", NUMBER.fetch_add(1, Ordering::Relaxed)));
    let copied = Command::new("cp").arg("-a").arg(kept.path().join(".")).arg(folder.path()).status();
    assert!(copied.expect("cp is there").success());
    folder
}

/// Consequence of a damage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Follows {
    /// The robots are held, and the message names the file. The file stays as it is.
    Held,
    /// The robots are held, because the journal has changed.
    HeldByTheJournal,
    /// The robot is held as by a STOP, and the damaged content is moved to another file.
    AsByAStop,
    /// The console's log names the file, and nothing is held.
    Said,
    /// No consequence: the file is not read, or it is made again.
    Nothing,
}

use Follows::{AsByAStop, Held, HeldByTheJournal, Nothing, Said};

/// A name in the program's own table, a file of that name, and the consequence of a damage.
type Row = (&'static str, &'static str, fn(Damage) -> Follows);

const TABLE: [Row; 27] = [
    ("journal.db", "journal.db", held),
    // After a cut the journal has lost entries, but the cause cannot be seen.
    ("journal.db-wal", "journal.db-wal", |damage| if matches!(damage, CutShort | Emptied) { HeldByTheJournal } else { Held }),
    ("journal.db-shm", "journal.db-shm", held_by_no_file),
    (
        "journal.db-journal",
        "journal.db-journal",
        |damage| if damage.leaves_no_file() || damage == Garbage { Held } else { Nothing },
    ),
    ("journal.lock", "journal.lock", held_by_no_file),
    // A power cut can leave this file empty or filled with zeros.
    ("journal.head", "journal.head", |damage| if matches!(damage, Emptied | Zeros) { Nothing } else { Held }),
    ("journal.lost", "journal.lost", |damage| if damage == Emptied { Nothing } else { Held }),
    // Read where a piece needs two judges: see `damaged_answers_are_asked_for_again`.
    ("kept-back.json", "kept-back.json", nothing),
    // Read where an exercise is under way.
    ("exercise.txt", "exercise.txt", nothing),
    ("stops", "stops", |damage| if damage.leaves_no_file() { Held } else { AsByAStop }),
    ("stops.damaged", "stops.damaged", nothing),
    ("simulated-robot.txt", "simulated-robot.txt", held),
    ("simulated-robot-*.txt", "simulated-robot-porter.txt", held),
    ("simulated-pair.txt", "simulated-pair.txt", held),
    ("simulated-hall.toml", "simulated-hall.toml", held),
    ("halls", "halls", said_unless_a_folder),
    ("halls/*.toml", "halls/mine.toml", nothing),
    ("archives", "archives", said_unless_a_folder),
    ("archives/*.unfinished", "archives/missions-1-to-1.hallsweep.unfinished", nothing),
    ("photos", "photos", |damage| if damage == AFolder { Nothing } else { Held }),
    ("room.unfinished", "room.unfinished", nothing),
    ("hallsweep-*.mode", "hallsweep-0123456789abcdef.mode", nothing),
    ("hallsweep-unpack", "hallsweep-unpack", nothing),
    ("*.new", "stops.new", nothing),
    ("*.new", "simulated-robot.new", nothing),
    ("*.new", "simulated-pair.new", nothing),
    ("*.new", "simulated-hall.new", nothing),
];

/// Names that have tests of their own.
const APART: [(&str, &str); 7] = [
    ("access.toml", "damaged_keys_let_nobody_in_and_hold_the_robot"),
    ("archives/*.hallsweep", "what_stands_in_the_place_of_an_archive_is_named_and_the_missions_stay"),
    ("photos/*", "a_damaged_photo_is_to_be_taken_again"),
    ("photos/*/*", "a_damaged_photo_is_to_be_taken_again"),
    ("photos/*/*.unfinished", "what_stands_in_the_place_of_a_photo_gives_way_or_is_named"),
    ("robot-*.txt", "the_damaged_memory_of_a_robot_outside_holds_it"),
    ("robot-*.out-of-date", "the_damaged_memory_of_a_robot_outside_holds_it"),
];

const fn held(_: Damage) -> Follows {
    Held
}

const fn nothing(_: Damage) -> Follows {
    Nothing
}

/// The content of such a file is not read.
fn held_by_no_file(damage: Damage) -> Follows {
    if damage.leaves_no_file() { Held } else { Nothing }
}

fn said_unless_a_folder(damage: Damage) -> Follows {
    if damage == AFolder { Nothing } else { Said }
}

#[test]
fn every_file_of_the_data_folder_is_tried_damaged() {
    let of_photos = include_str!("../../src/storage/sqlite/tests/photos.rs");
    let own = [include_str!("damage.rs"), include_str!("data_files.rs"), of_photos].concat();
    let tried = |name: &Name| TABLE.iter().any(|(of, ..)| *of == name.written());
    let apart = |name: &Name| APART.iter().any(|(of, test)| *of == name.written() && own.contains(&format!("fn {test}(")));
    let untried: Vec<&str> = names::ALL.iter().filter(|name| !tried(name) && !apart(name)).map(|name| name.written()).collect();
    assert!(untried.is_empty(), "these have no row: {untried:?}");
}

#[test]
fn whatever_file_is_damaged_the_console_names_it_holds_the_robots_and_goes_on_when_its_advice_is_followed() {
    const AT_ONCE: usize = 4;
    LazyLock::force(&ENDED);
    let cases: Vec<_> = TABLE.iter().flat_map(|(_, file, follows)| ALL.map(|damage| (*file, damage, follows(damage)))).collect();
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some((file, damage, follows)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    try_damaged(file, *damage, *follows);
                }
            });
        }
    });
}

fn try_damaged(file: &str, damage: Damage, follows: Follows) {
    let what = format!("{file}: {damage:?}");
    // The files beside the journal exist only after a kill.
    let folder = copy(if file.starts_with("journal.db-") { &KILLED } else { &ENDED });
    let path = folder.path().join(file);
    damage.apply(&path);
    let before = seen(&path);
    let program = Program::started(&mut command(&folder, HALLS[0]));
    let state = program.json("state");
    let log = state["log"].to_string();
    match follows {
        Held | HeldByTheJournal => {
            let state = check_held(&program, &what, if follows == Held { file } else { "journal.db" });
            // A robot whose position is unknown is not linked.
            let is_lost = ["simulated-robot.txt", "simulated-hall.toml"].contains(&file);
            assert!(holds(&state, "robotLink") || !is_lost, "{what}: {state:#}");
            check_shown(&state, file);
            end(program);
            assert!(seen(&path) == before, "{what}: it is left as it is");
            check_advice(&folder, &what, &state, &path);
        }
        AsByAStop => {
            assert!(holds(&state, "operator") && !holds(&state, "store"), "{what}: {state:#}");
            assert!(log.contains("stops was damaged") && log.contains("press START to continue"), "{what}: {log}");
            assert!(seen(&folder.path().join("stops.damaged")) == before, "{what}: somebody can look at what was there");
            check_goes(&program, &what);
        }
        Said => {
            assert!(!holds(&state, "store"), "{what}: {state:#}");
            assert!(log.contains(path.to_str().expect("plain")) && log.contains("move it away"), "{what}: {log}");
            check_goes(&program, &what);
            assert!(seen(&path) == before, "{what}: it is left as it is");
        }
        Nothing => {
            assert!(!holds(&state, "store") && holds(&state, "restart"), "{what}: {state:#}");
            assert!(!log.contains(path.to_str().expect("plain")), "{what}: {log}");
            check_goes(&program, &what);
        }
    }
}

/// Follows the advice in the message of the hold and starts again. No hold may remain.
fn check_advice(folder: &Folder, what: &str, held: &Value, damaged: &Path) {
    const TOGETHER: &str = "journal.db, journal.db-wal, journal.db-shm, journal.head and the folder photos away together";
    let words = held["mission"]["storeFailure"].as_str().expect("it says why");
    let away = |names: &[&str]| names.iter().for_each(|name| remove(&folder.path().join(name)));
    if words.contains(TOGETHER) {
        away(&["journal.db", "journal.db-wal", "journal.db-shm", "journal.head", "photos"]);
    } else if words.contains("move journal.head away") {
        away(&["journal.head"]);
    } else {
        assert!(words.contains("move it away"), "{what}: {words}");
        remove(damaged);
    }
    let mut program = Program::started(&mut command(folder, HALLS[0]));
    if damaged.ends_with("simulated-hall.toml") {
        // The mission belongs to the hall that was chosen while the program ran.
        let words = check_held(&program, what, "simulated-robot.txt")["mission"]["storeFailure"].to_string();
        assert!(words.contains("start hallsweep again with --hall airport"), "{what}: {words}");
        end(program);
        program = Program::started(&mut command(folder, HALLS[1]));
    }
    assert!(!holds(&program.json("state"), "store"), "{what}: {:#}", program.json("state"));
    check_goes(&program, what);
}

/// Fails unless the mission continues after a verdict, if one is pending, and START.
pub(crate) fn check_goes(program: &Program, what: &str) {
    let state = program.until(what, |state| !holds(state, "robotLink"));
    if let Some(piece) = state["luggage"].as_array().and_then(|all| all.iter().find(|piece| piece["verdict"] == "pending")) {
        let path = format!("/api/v1/luggage/{}", piece["id"]);
        if piece["photo"]["state"] == "failed" {
            // A piece without a photo cannot be called safe.
            program.post(&format!("{path}/verdict"), "{\"verdict\":\"danger\"}").accepted();
            return;
        }
        program.post(&format!("{path}/verdict"), "{\"verdict\":\"safe\"}").accepted();
    }
    program.command("start").accepted();
}

pub(crate) fn end(program: Program) {
    program.killer()();
    drop(program);
}

/// Fails unless the console works, the robot is held, STOP works, and START is refused.
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

/// The state of the mission is shown as long as the journal itself can be read.
fn check_shown(state: &Value, damaged: &str) {
    if !damaged.starts_with("journal.db") {
        let pending = state["luggage"][0]["verdict"] == "pending";
        let shown = (state["mission"]["phase"].as_str(), pending, holds(state, "operator"));
        assert_eq!(shown, (Some("inspecting"), true, true), "{damaged}: {state:#}");
    }
}

/// Safety V2: a damaged photo counts as no photo, and a pipe in its place blocks nobody.
#[test]
fn a_damaged_photo_is_to_be_taken_again() {
    for (damage, is_shelf) in ALL.into_iter().flat_map(|damage| [(damage, false), (damage, true)]) {
        let folder = copy(&ENDED);
        let photo = photo(&folder.path().join("photos"));
        let damaged = if is_shelf { photo.parent().expect("it is on a shelf") } else { &photo };
        damage.apply(damaged);
        let program = Program::started(&mut command(&folder, HALLS[0]));
        let piece = program.until_asked();
        assert_eq!(program.json(&format!("luggage/{piece}"))["photo"]["state"], "failed", "{damage:?}");
        assert_eq!(program.read("/", &[]).status, 200);
        program.verdict(piece, "safe").problem(409);
        check_goes(&program, &format!("{damage:?}"));
    }
}

fn photo(folder: &Path) -> PathBuf {
    let first = |folder: &Path| {
        let mut here = fs::read_dir(folder).expect("the folder can be read");
        here.find_map(Result::ok).expect("something is in it").path()
    };
    first(&first(folder))
}

/// Safety A1, R5: if the keys cannot be read, nobody gets access, and no robot moves, because nobody could stop it.
/// Once the file is mended, the keys work again.
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
    for damage in ALL {
        let folder = copy(&ENDED);
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

/// New files in an existing folder are private to their owner, or open to the group if the folder is.
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
