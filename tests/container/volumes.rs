//! Volumes as container platforms create them: for any user, given to a group at each start, with one mode for all
//! files, and of an earlier version.

use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::client::{Client, kept};
use crate::engine::{ContainerEngine, ON_LOOPBACK, Volume, engine, left_out, text, unused};

/// Every file and folder of a volume, including the volume itself.
fn everything(folder: &Path) -> Vec<PathBuf> {
    let mut found = vec![folder.to_owned()];
    for entry in fs::read_dir(folder).expect("it can be read").map(|entry| entry.expect("it can be read").path()) {
        if entry.is_dir() { found.extend(everything(&entry)) } else { found.push(entry) }
    }
    found
}

/// Change that a cluster makes to a volume before each start (`fsGroup`): everything belongs to the group, which gets
/// the owner's rights, and new files in folders inherit the group.
fn give_to(group: u32, folder: &Path) {
    for path in everything(folder) {
        chown(&path, None, Some(group)).expect("a test of volumes is root's");
        let mode = fs::metadata(&path).expect("it is there").mode() & 0o7777;
        let more = if path.is_dir() { 0o2070 } else { 0o060 };
        fs::set_permissions(&path, fs::Permissions::from_mode(mode | more)).expect("the folder is ours");
    }
}

/// Keys as `hallsweep token` prints them.
fn keys_of(engine: &ContainerEngine, options: &[&str]) -> String {
    let (code, shown) = engine.once(&engine.image, options, &["token"]);
    assert_eq!(code, "0", "{shown}");
    shown
}

/// Starts the program, reads its state with the key, ends it, and returns its log.
fn serves(engine: &ContainerEngine, volume: &Volume<'_>, options: &[&str]) -> String {
    let container = engine.serve(&[options, &[ON_LOOPBACK, &volume.at_data()]].concat(), &[]);
    let state = Client::of(&container).state();
    assert!(!state["mission"]["holds"].to_string().contains("store"), "{}", state["mission"]);
    assert_eq!(container.end(&["stop"]), "0");
    container.logs()
}

fn readable_by_others(folder: &Path) -> Vec<PathBuf> {
    let mut open = everything(folder);
    open.retain(|path| fs::metadata(path).expect("it is there").mode() & 0o007 != 0);
    open
}

/// Safety A1.
#[test]
fn any_user_of_the_group_0_serves_from_a_volume_and_others_read_nothing() {
    let Some(engine) = engine() else { return };
    let volume = engine.volume();
    let Some(folder) = volume.folder() else { return };
    let mut keys = Vec::new();
    // OpenShift gives each project another user number.
    for user in ["--user=1000650000:0", "--user=1000660000:0", "--user=65532:0"] {
        serves(&engine, &volume, &[user, "--cap-drop=all"]);
        keys.push(keys_of(&engine, &[user, &volume.at_data()]));
        assert_eq!(readable_by_others(&folder), Vec::<PathBuf>::new(), "{user}");
    }
    keys.dedup();
    assert_eq!(keys.len(), 1, "the same keys for all of them");
    let stranger = ["--user=1000650000:1000650000", "--cap-drop=all", &volume.at_data()];
    let (code, said) = engine.once(&engine.image, &stranger, &["token"]);
    assert!(code == "1" && said.contains("cannot be read"), "{code}: {said}");
}

#[test]
fn a_volume_that_is_given_to_a_group_at_each_start_keeps_its_keys_and_missions() {
    let Some(engine) = engine() else { return };
    let volume = engine.volume();
    let Some(folder) = volume.folder() else { return };
    let pod = ["--user=65532:65532", "--group-add=2000", "--cap-drop=all", "--read-only"];
    let mut keys = Vec::new();
    for start in 1..=3 {
        give_to(2000, &folder);
        let logs = serves(&engine, &volume, &pod);
        assert!(logs.contains("can read the keys"), "start {start}: {logs}");
        keys.push(keys_of(&engine, &[&pod[..], &[&volume.at_data()]].concat()));
    }
    keys.dedup();
    assert_eq!(keys.len(), 1);
    assert_eq!(readable_by_others(&folder), Vec::<PathBuf>::new());
    // A mode that nobody intended is still refused, and the robot is held.
    fs::set_permissions(folder.join("access.toml"), fs::Permissions::from_mode(0o664)).expect("the folder is ours");
    let (code, said) = engine.once(&engine.image, &[&pod[..], &[&volume.at_data()]].concat(), &["token"]);
    assert!(code == "1" && said.contains("chmod 600"), "{code}: {said}");
}

/// Folder seen through a driver that gives every file the same mode, whatever mode was set.
struct OneMode {
    behind: PathBuf,
    seen: PathBuf,
}

impl OneMode {
    /// Mounts the folder with these further options; `None` after a note when that is impossible.
    fn with(more: &[&str]) -> Option<OneMode> {
        let [behind, seen] = ["behind", "seen"].map(|what| std::env::temp_dir().join(unused(what)));
        fs::create_dir(&behind).and_then(|()| fs::create_dir(&seen)).expect("there is room");
        let volume = OneMode { behind, seen };
        let mut bindfs = Command::new("bindfs");
        bindfs.args(["--perms=0777", "-o", "allow_other"]).args(more).arg(&volume.behind).arg(&volume.seen);
        if bindfs.stderr(Stdio::null()).status().is_ok_and(|status| status.success()) {
            return Some(volume);
        }
        left_out("bindfs, and the right to mount");
        None
    }
}

impl Drop for OneMode {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("--lazy").arg(&self.seen).status();
        let _ = fs::remove_dir(&self.seen);
        let _ = fs::remove_dir_all(&self.behind);
    }
}

#[test]
fn a_volume_that_forces_a_mode_on_every_file_is_used_with_a_word() {
    let Some(engine) = engine() else { return };
    // One driver ignores changes of modes; the other refuses them, and all files belong to another user.
    let ours = ["--force-user=65532", "--chmod-ignore", "--chown-ignore"];
    let others = ["--force-user=4321", "--force-group=4321", "--chmod-deny", "--chown-deny"];
    for rules in [&ours[..], &others[..]] {
        let Some(volume) = OneMode::with(rules) else { return };
        let at_data = format!("--volume={}:/data", volume.seen.display());
        let mut keys = Vec::new();
        for start in 1..=2 {
            let container = engine.serve(&[ON_LOOPBACK, "--cap-drop=all", &at_data], &[]);
            let state = Client::of(&container).state();
            assert!(!state["mission"]["holds"].to_string().contains("store"), "{}", state["mission"]);
            assert_eq!(container.end(&["stop"]), "0");
            let logs = container.logs();
            assert!(logs.contains("all files on this volume have the same mode"), "start {start} with {rules:?}: {logs}");
            keys.push(keys_of(&engine, &[&at_data]));
        }
        keys.dedup();
        assert_eq!(keys.len(), 1);
    }
}

/// Folder of the host in place of a volume, deleted with this value.
struct HostFolder(PathBuf);

impl HostFolder {
    /// Folder for this user alone; `None` after a note when the test may not change owners.
    fn of(user: u32) -> Option<HostFolder> {
        let folder = HostFolder(std::env::temp_dir().join(unused("folder")));
        fs::create_dir(&folder.0).expect("there is room");
        fs::set_permissions(&folder.0, fs::Permissions::from_mode(0o700)).expect("the folder is ours");
        if chown(&folder.0, Some(user), Some(user)).is_ok() {
            return Some(folder);
        }
        left_out("root, to make folders of other users");
        None
    }

    fn at_data(&self) -> String {
        format!("--volume={}:/data", self.0.display())
    }
}

impl Drop for HostFolder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn a_folder_that_its_user_may_not_use_is_said_with_what_to_do() {
    let Some(engine) = engine() else { return };
    let Some(folder) = HostFolder::of(0) else { return };
    for (mode, code, words) in [
        (0o700, "2", "give this user access to the folder"),
        (0o755, "1", "let the user who runs hallsweep write to that folder"),
    ] {
        fs::set_permissions(&folder.0, fs::Permissions::from_mode(mode)).unwrap();
        let (ended, said) = engine.once(&engine.image, &["--user=4321:4321", &folder.at_data()], &[]);
        assert!(ended == code && said.contains("/data") && said.contains(words), "{ended}: {said}");
    }
}

#[test]
fn a_folder_of_the_host_is_used_by_whoever_owns_it() {
    let Some(engine) = engine() else { return };
    for user in [65532, 4321] {
        let Some(folder) = HostFolder::of(user) else { return };
        let own = [&format!("--user={user}:{user}"), "--cap-drop=all", &folder.at_data()];
        for _ in 0..2 {
            let container = engine.serve(&own, &[]);
            container.until_healthy();
            assert_eq!(container.end(&["stop"]), "0");
            assert!(!container.logs().contains("can read the keys"), "{}", container.logs());
        }
        let keys = fs::metadata(folder.0.join("access.toml")).unwrap();
        assert_eq!((keys.uid(), keys.mode() & 0o777), (user, 0o600));
    }
}

/// Safety R1.
#[test]
fn a_volume_of_an_earlier_version_stands_as_it_was_and_goes_on() {
    let Some(engine) = engine() else { return };
    let earlier = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/container/earlier");
    let volume = engine.volume();
    let Some(folder) = volume.folder() else { return };
    let mut tar = Command::new("tar");
    tar.args(["--numeric-owner", "-xpzf"]).arg(earlier.join("volume.tar.gz")).arg("-C").arg(&folder);
    assert!(tar.status().unwrap().success());
    let options = [ON_LOOPBACK, &volume.at_data(), "--env=HALLSWEEP__ROBOT__SPEED=max"];
    let container = engine.serve(&options, &["--hall", "seed"]);
    let client = Client::of(&container);
    let then: Value = serde_json::from_slice(&fs::read(earlier.join("shown.json")).unwrap()).unwrap();
    assert_eq!(kept(&client.state()), then);
    assert!(text(&container.exec(&["hallsweep", "token"]).stdout).contains("lobby (viewer)"));
    let check = container.exec(&["hallsweep", "journal", "check"]);
    assert!(check.status.success(), "{}", text(&check.stdout));
    client.post(&format!("luggage/{}/verdict", client.until_asked()), r#"{"verdict":"safe"}"#);
    client.search_the_hall();
    assert_eq!(container.end(&["stop"]), "0");

    // The first image left its volumes readable for one fixed user alone.
    for path in everything(&folder) {
        chown(&path, Some(999), Some(999)).unwrap();
        let mode = fs::metadata(&path).unwrap().mode();
        fs::set_permissions(&path, fs::Permissions::from_mode(mode & 0o700)).unwrap();
    }
    let container = engine.serve(&[&options[..], &["--user=999:999"]].concat(), &["--hall", "seed"]);
    assert_eq!(Client::of(&container).state()["mission"]["phase"], "explored");
}

#[test]
fn a_backup_of_the_volume_comes_up_as_another_container() {
    let Some(engine) = engine() else { return };
    let volume = engine.volume();
    let options = [ON_LOOPBACK, &volume.at_data(), "--env=HALLSWEEP__ROBOT__SPEED=max"];
    let first = engine.serve(&options, &["--hall", "seed"]);
    let before = Client::of(&first).search_the_hall();
    let keys = text(&first.exec(&["hallsweep", "token"]).stdout);
    first.end(&["stop"]);
    // As in docs/container.md, with `tar` of the debug image's busybox.
    let backup = std::env::temp_dir().join(unused("backup"));
    fs::create_dir(&backup).unwrap();
    let at_backup = format!("--volume={}:/backup", backup.display());
    let tar = |volume: &Volume<'_>, how: &str| {
        let as_root = ["--user=0", "--entrypoint=busybox", &at_backup, &volume.at_data()];
        let (code, said) = engine.once(&engine.debug, &as_root, &["tar", "-C", "/data", how, "/backup/hallsweep.tar", "."]);
        assert_eq!(code, "0", "{said}");
    };
    tar(&volume, "-cf");
    let again = engine.volume();
    tar(&again, "-xpf");
    let second = engine.serve(&[ON_LOOPBACK, &again.at_data()], &["--hall", "seed"]);
    assert_eq!(kept(&Client::of(&second).state()), kept(&before));
    assert_eq!(text(&second.exec(&["hallsweep", "token"]).stdout), keys);
    fs::remove_dir_all(&backup).unwrap();
}
