//! Tests of the key file: faults that it survives, and contents that it refuses. They are in a separate file because
//! they are long.

use std::sync::Arc;

use super::*;
use crate::storage::tests::scratch::Scratch;

fn overwritten(file: &KeyFile, text: &str) -> String {
    file.0.replace(text.as_bytes()).unwrap();
    file.read().expect_err("this holds no keys").to_string()
}

#[test]
fn what_was_written_is_read_again() {
    let folder = Scratch::new();
    let file = KeyFile::within(&folder.0.join("deeper"));
    assert!(file.read().unwrap().is_none(), "there is none yet");
    let mut keys = Keys::first().unwrap();
    keys.add("lobby", Role::Viewer, None).unwrap();
    file.write(&keys).unwrap();
    let read = file.read().unwrap().unwrap();
    for (kept, key) in read.iter().zip(keys.iter()) {
        assert_eq!((&kept.name, kept.role, kept.token.reveal()), (&key.name, key.role, key.token.reveal()));
    }
    assert_eq!(read.iter().count(), 2);
    assert_eq!(fs::read_dir(folder.0.join("deeper")).unwrap().count(), 1, "nothing else is left there");
}

/// Safety A1: a file of earlier versions stays as it is, and a limited key does not become an unlimited one.
#[test]
fn a_file_is_written_again_byte_for_byte_with_and_without_halls() {
    let folder = Scratch::new();
    let file = KeyFile::within(&folder.0);
    let (one, other) = ("ab".repeat(32), "cd".repeat(32));
    let earlier = format!(
        "{HEADER}[[key]]\nname = \"operator\"\nrole = \"operator\"\ntoken = \"{one}\"\n\n[[key]]\nname = \"lobby\"\nrole = \
         \"viewer\"\n"
    );
    for halls in [None, Some("[\"south\"]"), Some("[\"south\", \"east\"]"), Some("[\"east\", \"south\"]")] {
        let line = halls.map(|halls| format!("halls = {halls}\n")).unwrap_or_default();
        let text = format!("{earlier}{line}token = \"{other}\"\n");
        file.0.replace(text.as_bytes()).unwrap();
        let keys = file.read().unwrap().unwrap();
        file.write(&keys).unwrap();
        assert_eq!(fs::read_to_string(file.path()).unwrap(), text);
        assert_eq!(keys.named("lobby").unwrap().sees(&HallId::new("west").unwrap()), halls.is_none(), "{halls:?}");
    }
}

/// Otherwise `hallsweep token` could write a file that nobody can read any more.
#[test]
fn as_many_keys_as_possible_with_as_many_halls_as_possible_are_read_again() {
    let folder = Scratch::new();
    let file = KeyFile::within(&folder.0);
    let names: Vec<String> = (0..128).map(|number| format!("h{number:031}")).collect();
    let halls = keys::halls(names.iter().map(String::as_str)).unwrap();
    let mut keys = Keys::first().unwrap();
    while keys.add(&format!("k{:031}", keys.iter().count()), Role::Operator, Some(Arc::clone(&halls))).is_ok() {}
    file.write(&keys).unwrap();
    assert!(fs::metadata(file.path()).unwrap().len() * 3 <= LARGEST);
    assert_eq!(file.read().unwrap().unwrap().iter().filter(|key| key.halls.as_ref() == Some(&halls)).count(), 63);
}

/// Safety A1: a file that was edited by hand never admits anybody to more halls than its owner meant.
#[test]
fn halls_that_are_none_are_refused_without_a_word_that_may_be_a_token() {
    let folder = Scratch::new();
    let file = KeyFile::within(&folder.0);
    let token = "ab".repeat(32);
    let key = |name: &str, line: &str| {
        format!("[[key]]\nname = \"{name}\"\nrole = \"operator\"\n{line}\ntoken = \"{}\"\n", token.replace('a', &name[..1]))
    };
    let many: Vec<String> = (0..129).map(|number| format!("h{number}")).collect();
    for (line, words) in [
        ("halls = []", "halls of key 2"),
        ("halls = [\"\"]", "halls of key 2"),
        ("halls = [\"South\"]", "halls of key 2"),
        ("halls = [\"south east\"]", "halls of key 2"),
        ("halls = [\"south\", \"east\", \"south\"]", "halls of key 2"),
        (&format!("halls = [\"south\", \"{token}\"]"), "halls of key 2"),
        (&format!("halls = {many:?}"), "halls of key 2"),
        ("halls = \"south\"", "line 9 cannot be read"),
        (&format!("halls = \"{token}\""), "line 9 cannot be read"),
        (&format!("halls = [{token}]"), "line 9 cannot be read"),
        ("halls = [[\"south\"]]", "line 9 cannot be read"),
        ("halls = [1]", "line 9 cannot be read"),
        ("halls = false", "line 9 cannot be read"),
        ("halls = [\"south\"]\nhalls = [\"east\"]", "line 10 cannot be read"),
        ("hall = [\"south\"]", "line 9 cannot be read"),
        ("Halls = [\"south\"]", "line 9 cannot be read"),
    ] {
        let said = overwritten(&file, &(key("chief", "") + &key("desk", line)));
        assert!(said.contains(words) && said.contains("access.toml"), "{line}: {said}");
        assert!(!said.contains("abab") && !said.contains("South"), "{line}: {said}");
    }
    let said = overwritten(&file, &(key("chief", "halls = [\"south\"]") + &key("desk", "halls = [\"east\"]")));
    assert!(said.contains("for all halls"), "nobody could act in every hall: {said}");
}

#[test]
fn a_change_shows_from_outside() {
    let folder = Scratch::new();
    let file = KeyFile::within(&folder.0);
    assert!(file.stamp().is_err());
    let keys = Keys::first().unwrap();
    file.write(&keys).unwrap();
    let first = file.stamp().unwrap();
    assert_eq!(file.stamp().unwrap(), first);
    file.write(&keys).unwrap();
    assert_ne!(file.stamp().unwrap(), first, "another file, though it says the same");
}

/// Safety A1.
#[cfg(unix)]
#[test]
fn the_file_is_private_from_its_first_moment_and_refused_when_it_is_not() {
    use std::os::unix::fs::PermissionsExt;
    let scratch = Scratch::new();
    let folder = scratch.0.join("new");
    let file = KeyFile::within(&folder);
    file.write(&Keys::first().unwrap()).unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!((mode(file.path()), mode(&folder)), (0o600, 0o700));
    for open in [0o640, 0o604, 0o660, 0o777] {
        fs::set_permissions(file.path(), fs::Permissions::from_mode(open)).unwrap();
        let said = file.read().unwrap_err().to_string();
        assert!(said.contains("chmod 600") && said.contains(&format!("{open:o}")), "{said}");
    }
    fs::set_permissions(file.path(), fs::Permissions::from_mode(0o400)).unwrap();
    assert!(file.read().is_ok());
}

#[test]
fn what_holds_no_keys_is_refused_with_its_line_and_without_a_token() {
    let folder = Scratch::new();
    let file = KeyFile::within(&folder.0);
    let token = "ab".repeat(32);
    let key =
        |name: &str, role: &str, token: &str| format!("[[key]]\nname = \"{name}\"\nrole = \"{role}\"\ntoken = \"{token}\"\n");
    let cases = [
        (String::new(), "key"),
        ("key = []".to_owned(), "last operator"),
        (key("lobby", "viewer", &token), "last operator"),
        (key("operator", "operator", &token).repeat(2), "already"),
        (key("operator", "admin", &token), "line 3"),
        (key("operator", "operator", "secret"), "token of key 1"),
        (key("operator", "operator", &token) + &key("op.erator", "operator", &"cd".repeat(32)), "name of key 2"),
        (key(&token, "operator", &token), "name of key 1"),
        (key("operator", &token, "operator"), "line 3 cannot be read"),
        (format!("[[key]]\n{token} = \"operator\""), "line 2 cannot be read"),
        (format!("{token} = 1"), "line 1 cannot be read"),
        (format!("[[key]]\nname = {token}"), "line 2 cannot be read"),
        (format!("[[key]]\ntoken = \"{token}\nname = 1"), "line 2"),
        (key("operator", "operator", &token) + "color = 1", "line 5 cannot be read"),
        ("\u{0}\u{1}".to_owned(), "line 1"),
    ];
    for (text, words) in cases {
        let said = overwritten(&file, &text);
        assert!(said.contains(words) && said.contains("access.toml"), "{text}: {said}");
        assert!(!said.contains(&token[..8]) && !said.contains("secret"), "{said}");
    }
}

#[test]
fn a_damaged_file_is_told_from_one_that_may_not_be_read() {
    let folder = Scratch::new();
    let file = KeyFile::within(&folder.0);
    overwritten(&file, "");
    fs::write(file.path(), [0xa5, 0xff]).unwrap();
    let said = file.read().expect_err("this is no text").to_string();
    assert!(said.contains("is not valid: the file is not UTF-8 text; correct the file"), "{said}");
}

#[test]
fn a_folder_that_cannot_be_written_is_said_with_what_to_do() {
    let folder = Scratch::new();
    fs::create_dir_all(&folder.0).unwrap();
    fs::write(folder.0.join("a-file"), "").unwrap();
    let said = KeyFile::within(&folder.0.join("a-file")).write(&Keys::first().unwrap()).unwrap_err().to_string();
    assert!(said.contains("a-file") && said.contains("--data"), "{said}");
}
