//! Safety R5: the program's own table of its files is complete. Other tests damage files that the program reads or
//! writes again while it runs.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

use hallsweep::storage::names;

use crate::damage::{ALL, Damage, ENDED, HALLS, KILLED, check_goes, command, copy, end, seen};
use crate::journal::holds;
use crate::kill::Folder;
use crate::program::{Deadline, PATIENCE, Program, hallsweep};

/// The page that lists every file of the data folder.
const PAGE: &str = include_str!("../../docs/journal.md");

/// Whether a path matches this name. `*` matches within one path component.
fn is_of(name: &str, path: &str) -> bool {
    let part = |(wanted, part): (&str, &str)| match wanted.split_once('*') {
        Some((before, after)) => part.len() > before.len() + after.len() && part.starts_with(before) && part.ends_with(after),
        None => wanted == part,
    };
    name.split('/').count() == path.split('/').count() && name.split('/').zip(path.split('/')).all(part)
}

/// All files and folders below a folder, as relative paths.
fn listed(folder: &Path) -> BTreeSet<String> {
    let (mut paths, mut open) = (BTreeSet::new(), vec![folder.to_owned()]);
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(next).expect("it can be read") {
            let path = entry.expect("it can be read").path();
            if path.is_dir() {
                open.push(path.clone());
            }
            paths.insert(path.strip_prefix(folder).expect("it is in it").to_str().expect("plain letters").to_owned());
        }
    }
    paths
}

/// Command that archives missions older than `days` at its start. 0 keeps all missions in the journal.
fn archived(name: &str, days: &str) -> Command {
    let mut serve =
        hallsweep(&["serve", "--http", "127.0.0.1:0", "--hall", "seed", "--seed", "7", "--speed", "max", "--data", name]);
    serve.env("HALLSWEEP__STORE__KEEP_DAYS", days);
    serve
}

#[test]
fn whatever_the_program_keeps_in_its_folder_is_in_its_own_table_and_in_the_documents() {
    /// Files that exist only for a moment, or after a kill.
    const BRIEF: [&str; 7] = [
        "*.new",
        "archives/*.unfinished",
        "hallsweep-*.mode",
        "hallsweep-unpack",
        "journal.db-journal",
        "photos/*/*.unfinished",
        "room.unfinished",
    ];
    let searched = copy(&KILLED);
    fs::write(searched.path().join("stops"), "damaged").expect("the folder is ours");
    end(Program::started(command(&searched, HALLS[0]).env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true")));
    let old = crate::earlier::copy("data-files-archived");
    end(Program::started(&mut archived(old.text(), "0")));
    end(Program::started(&mut archived(old.text(), "1")));
    let outside = crate::virtual_robots::remembered("listed");
    let judged = crate::judges::answered_once("listed");
    let exercise = crate::exercise::begun("listed");
    let folders = [searched.path(), old.path(), outside.path(), judged.path(), exercise.path()];
    let there: BTreeSet<String> = folders.into_iter().flat_map(listed).collect();
    let unknown: Vec<&String> = there.iter().filter(|path| !names::ALL.iter().any(|name| is_of(name.written(), path))).collect();
    assert!(unknown.is_empty(), "these are not in src/storage/names.rs: {unknown:?}");
    let is_met = |name: &str| there.iter().any(|path| is_of(name, path));
    let is_due = |name: &&str| !BRIEF.contains(name) && !is_met(name);
    let unmet: Vec<&str> = names::ALL.iter().map(|name| name.written()).filter(is_due).collect();
    assert!(unmet.is_empty(), "nobody makes these: {unmet:?}");
}

#[test]
fn the_page_of_the_journal_lists_every_name_and_no_other() {
    let (_, table) = PAGE.split_once("\n| file | what |\n|---|---|\n").expect("the table of files");
    let rows: Vec<&str> = table.lines().map_while(|line| line.strip_prefix("| `")?.split('`').next()).collect();
    let known: Vec<&str> = names::ALL.iter().map(|name| name.written()).collect();
    assert_eq!(rows.iter().collect::<BTreeSet<_>>(), known.iter().collect::<BTreeSet<_>>());
    assert_eq!(rows.len(), known.len());
}

/// A kill, or another person, can leave anything at the path of an unfinished file.
#[test]
fn nothing_in_the_place_of_an_unfinished_file_keeps_one_from_being_written() {
    for damage in [Damage::Garbage, Damage::APipe, Damage::ADevice, Damage::ALinkToNowhere] {
        let folder = Folder::new("data-files-unfinished");
        for name in ["stops.new", "simulated-robot.new", "simulated-pair.new", "simulated-hall.new", "halls/mine.new"] {
            damage.apply(&folder.path().join(name));
        }
        let program = Program::started(&mut command(&folder, HALLS[0]));
        program.until("all robots are there", |state| {
            state["robots"].as_array().expect("a list").iter().all(|robot| !robot["parts"].is_null())
        });
        let kept = program.send("PUT", "/api/v1/simulator/halls/mine", "application/toml", "width = 2\nheight = 2\n");
        assert_eq!(kept.status, 200, "{damage:?}: {}", kept.text());
        let chosen = program.put("/api/v1/simulator/hall", "{\"name\":\"mine\"}");
        assert_eq!(chosen.status, 200, "{damage:?}: {}", chosen.text());
        program.command("stop").accepted();
        end(program);
        let program = Program::started(&mut command(&folder, HALLS[0]));
        assert_eq!(program.json("simulator")["hall"]["name"], "mine", "{damage:?}");
        let stops = fs::symlink_metadata(folder.path().join("stops")).expect("it is made at the first start");
        assert!(stops.is_file() && !folder.path().join("stops.new").exists(), "{damage:?}");
    }
}

#[test]
fn a_kept_hall_that_is_damaged_is_named_when_somebody_asks_for_it() {
    let folder = copy(&KILLED);
    let file = folder.path().join("halls/mine.toml");
    let program = Program::started(&mut command(&folder, HALLS[0]));
    // The first half of a hall file may be a valid hall file, so this damage is left out.
    for damage in ALL.into_iter().filter(|damage| *damage != Damage::CutShort) {
        damage.apply(&file);
        let before = seen(&file);
        let answer = program.read("/api/v1/simulator/halls/mine", &[]);
        let said = answer.text();
        assert_ne!(answer.status, 200, "{damage:?}: {said}");
        assert!(said.contains(file.to_str().expect("plain")) && said.contains("move it away"), "{damage:?}: {said}");
        assert!(seen(&file) == before, "{damage:?}: it is left as it is");
    }
}

/// A file that the user may not read, such as one from a backup that another user restored. Its content is unknown to
/// the program.
#[test]
fn what_the_user_may_not_read_is_named_with_what_to_do_and_holds_the_robots_where_it_matters() {
    use std::os::unix::fs::PermissionsExt;
    const HELD: [&str; 10] = [
        "journal.db",
        "journal.lock",
        "journal.head",
        "journal.lost",
        "photos",
        "stops",
        "simulated-robot.txt",
        "simulated-robot-porter.txt",
        "simulated-pair.txt",
        "simulated-hall.toml",
    ];
    let bars = |path: &Path, mode: u32| fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("it is ours");
    for (file, is_held) in HELD.map(|file| (file, true)).into_iter().chain([("halls", false), ("archives", false)]) {
        let folder = copy(&ENDED);
        let path = folder.path().join(file);
        if !path.exists() {
            if file.contains('.') { fs::write(&path, "").unwrap() } else { fs::create_dir(&path).unwrap() }
        }
        bars(&path, 0);
        let program = Program::started(&mut unprivileged(&command(&folder, HALLS[0])));
        let state = program.json("state");
        let said = state["mission"]["storeFailure"].as_str().map_or_else(|| state["log"].to_string(), str::to_owned);
        assert_eq!(holds(&state, "store"), is_held, "{file}: {state:#}");
        assert!(said.contains(path.to_str().expect("plain")), "{file} is not named: {said}");
        assert!(
            ["give that user access", "let the user who runs hallsweep read", "move it away"]
                .iter()
                .any(|advice| said.contains(advice)),
            "{file}: {said}"
        );
        assert_eq!(program.read("/", &[]).status, 200, "{file}");
        end(program);
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0, "{file} is left as it is");
        bars(&path, if path.is_dir() { 0o700 } else { 0o600 });
        let program = Program::started(&mut unprivileged(&command(&folder, HALLS[0])));
        assert!(!holds(&program.json("state"), "store"), "{file}: {:#}", program.json("state"));
        if file != "simulated-hall.toml" {
            check_goes(&program, file);
        }
    }
}

/// The same command without the capabilities by which root reads files that are closed to it.
fn unprivileged(command: &Command) -> Command {
    let mut bare = Command::new(command.get_program());
    if rustix::process::geteuid().is_root() {
        bare = Command::new("setpriv");
        bare.args(["--bounding-set", "-dac_override,-dac_read_search", "--"]).arg(command.get_program());
    }
    bare.args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => bare.env(name, value),
            None => bare.env_remove(name),
        };
    }
    bare
}

/// Safety S1: everybody who could press STOP can still press it, and the log names the file.
#[test]
fn keys_that_are_damaged_while_it_runs_shut_nobody_out() {
    let folder = Folder::new("data-files-keys");
    let (file, log) = (folder.path().join("access.toml"), folder.path().with_extension("log"));
    let mut serve = command(&folder, HALLS[0]);
    serve.env("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true").stderr(Stdio::from(File::create(&log).expect("it can be written")));
    let program = Program::started(&mut serve);
    let whole = fs::read_to_string(&file).expect("the first start makes a key");
    let token = whole.split("token = \"").nth(1).and_then(|rest| rest.split('"').next()).expect("it has a token");
    for (times, damage) in (1..).zip(ALL) {
        damage.apply(&file);
        let deadline = Deadline::within(PATIENCE);
        let said = || fs::read_to_string(&log).expect("it can be read").matches("read before stay valid").count();
        while said() < times {
            assert!(!deadline.has_passed(), "{damage:?}: the log says nothing");
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        let bearer = format!("Bearer {token}");
        assert_eq!(program.read("/api/v1/state", &[("authorization", &bearer)]).status, 200, "{damage:?}");
    }
    let _ = fs::remove_file(log);
}

/// Missions are removed from the journal only when a usable archive holds them.
#[test]
fn what_stands_in_the_place_of_an_archive_is_named_and_the_missions_stay() {
    let made = crate::earlier::copy("data-files-archive");
    end(Program::started(&mut archived(made.text(), "0")));
    let before = copy(&made);
    end(Program::started(&mut archived(made.text(), "1")));
    let name = listed(made.path()).into_iter().find(|path| is_of("archives/*.hallsweep", path)).expect("there is an archive");
    for damage in ALL {
        let folder = copy(&before);
        let archive = folder.path().join(&name);
        fs::create_dir_all(archive.parent().expect("it is in a folder")).expect("the folder is ours");
        fs::copy(made.path().join(&name), &archive).expect("the folder is ours");
        damage.apply(&archive);
        let there = seen(&archive);
        let program = Program::started(&mut archived(folder.text(), "1"));
        let log = program.json("state")["log"].to_string();
        assert!(log.contains(archive.to_str().expect("plain")) && log.contains("move it away"), "{damage:?}: {log}");
        assert_eq!(program.json("missions")["missions"].as_array().map(Vec::len), Some(2), "{damage:?}");
        assert!(!holds(&program.json("state"), "store") && seen(&archive) == there, "{damage:?}");
    }
}

#[test]
fn the_damaged_memory_of_a_robot_outside_holds_it() {
    // Nothing listens at this address.
    const ROBOT: &str = "virtual-tcp=127.0.0.1:9";
    let serve = |folder: &Folder| {
        Program::started(&mut hallsweep(&["serve", "--http", "127.0.0.1:0", "--robot", ROBOT, "--data", folder.text()]))
    };
    let kept = crate::virtual_robots::remembered("damaged");
    let damages = ALL.into_iter().filter(|damage| ![Damage::Zeros, Damage::ALinkToNowhere].contains(damage));
    let try_all = |name: &str| {
        for damage in damages.clone() {
            let folder = Folder::new(&format!("data-files-{name}"));
            let path = folder.path().join(name);
            fs::copy(kept.path().join(name), &path).expect("the folder is ours");
            damage.apply(&path);
            let before = seen(&path);
            let program = serve(&folder);
            let state = program.json("state");
            let words = state["mission"]["storeFailure"].as_str().unwrap_or_default().to_owned();
            assert!(holds(&state, "store") && holds(&state, "robotLink"), "{name}: {damage:?}: {state:#}");
            assert!(words.contains(path.to_str().expect("plain")) && words.contains("put the robot at its start"), "{words}");
            assert!(program.command("start").problem(409).contains(name), "{name}: {damage:?}: START says which file");
            end(program);
            assert!(seen(&path) == before, "{name}: {damage:?}: it is left as it is");
        }
        let folder = Folder::new(&format!("data-files-{name}"));
        assert!(!holds(&serve(&folder).json("state"), "store"), "{name}: without the file all is well");
    };
    std::thread::scope(|scope| {
        let try_all = &try_all;
        for name in ["robot-discovery.txt", "robot-discovery.out-of-date"] {
            scope.spawn(move || try_all(name));
        }
    });
}

/// The robots are in a hall that no longer exists. The test follows the advice in the message.
#[test]
fn a_mission_in_a_hall_that_is_gone_can_be_put_away() {
    let folder = copy(&KILLED);
    for (gone, words) in [("simulated-hall.toml", "a mission is under way in another hall"), ("simulated-robot.txt", "")] {
        fs::remove_file(folder.path().join(gone)).expect("it is there");
        let program = Program::started(&mut command(&folder, HALLS[0]));
        let state = program.json("state");
        let said = state["mission"]["storeFailure"].as_str().unwrap_or_default().to_owned();
        assert!(said.contains(words) && holds(&state, "store") != words.is_empty(), "{gone}: {state:#}");
        if words.is_empty() {
            let piece = program.until_asked();
            program.verdict(piece, "safe").accepted();
            program.command("reset").accepted();
            check_goes(&program, gone);
        }
    }
}
