//! Tests of the key file: faults that it survives, and contents that it refuses. They are in a separate file because
//! they are long.

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
    keys.add("lobby", Role::Viewer).unwrap();
    file.write(&keys).unwrap();
    let read = file.read().unwrap().unwrap();
    for (kept, key) in read.iter().zip(keys.iter()) {
        assert_eq!((&kept.name, kept.role, kept.token.reveal()), (&key.name, key.role, key.token.reveal()));
    }
    assert_eq!(read.iter().count(), 2);
    assert_eq!(fs::read_dir(folder.0.join("deeper")).unwrap().count(), 1, "nothing else is left there");
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
