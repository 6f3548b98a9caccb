//! Tests of the state file with real files: what is read again, what is never overwritten, and what happens when
//! nothing can be written. The format is tested in `hallsweep_sim::page`.

use std::fs;

use super::*;
use crate::storage::tests::scratch::Scratch;
use hallsweep_core::units::{Cell, Pose};

fn hall() -> Hall {
    Hall::from_rows("first", &["S..", "..."]).unwrap()
}

fn at(x: i32) -> SimMemory {
    SimMemory { pose: Pose { cell: Cell::new(x, 0), ..Pose::START }, ..SimMemory::NEW }
}

fn remembered(folder: &Scratch) -> Option<SimMemory> {
    SimStateFile::open(&folder.0, &RobotId::discovery(), &hall(), &hall()).unwrap().1
}

#[test]
fn a_new_folder_remembers_nothing_and_then_the_last_that_was_kept() {
    let folder = Scratch::new();
    let (mut state_file, memory) = SimStateFile::open(&folder.0, &RobotId::discovery(), &hall(), &hall()).unwrap();
    assert_eq!(memory, None);
    assert!(!names::SIMULATED.within(&folder.0).exists(), "opening writes nothing");
    for x in [0, 1, 2, 1, 0, 1] {
        state_file.keep(at(x));
        assert_eq!(remembered(&folder), Some(at(x)));
    }
    let (mut state_file, _) = SimStateFile::open(&folder.0, &RobotId::discovery(), &hall(), &hall()).unwrap();
    state_file.keep(at(2));
    assert_eq!(remembered(&folder), Some(at(2)), "it goes on in the file that is there");
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 1, "nothing else is left in the folder");
}

#[test]
fn a_file_of_another_hall_is_refused_and_left_alone_until_it_is_begun_anew() {
    let folder = Scratch::new();
    let mut state_file = SimStateFile::begin_anew(&folder.0, &RobotId::discovery(), &hall());
    state_file.keep(at(1));
    let second = Hall::from_rows("second", &["S...."]).unwrap();
    let error = SimStateFile::open(&folder.0, &RobotId::discovery(), &second, &second).unwrap_err();
    let words = error.to_string();
    assert!(words.contains("simulated-robot.txt") && words.contains("--hall first") && words.contains("--data DIR"), "{words}");
    assert!(
        matches!(error, StateFileError::OtherHall { remembered, given, .. } if (&*remembered, &*given) == ("first", "second"))
    );
    assert_eq!(remembered(&folder), Some(at(1)));
    let changed = Hall::from_rows("first", &["S..", "..#"]).unwrap();
    let words = SimStateFile::open(&folder.0, &RobotId::discovery(), &changed, &changed).unwrap_err().to_string();
    assert!(words.contains("before its file was changed"), "{words}");
    let renamed = Hall::from_rows("renamed", &["S..", "..."]).unwrap();
    assert!(SimStateFile::open(&folder.0, &RobotId::discovery(), &renamed, &renamed).is_ok(), "another name for the same hall");
    SimStateFile::begin_anew(&folder.0, &RobotId::discovery(), &second).keep(at(4));
    assert_eq!(SimStateFile::open(&folder.0, &RobotId::discovery(), &second, &second).unwrap().1, Some(at(4)));
}

/// Safety A7.
#[test]
fn what_cannot_be_understood_is_said_with_the_file_and_left_alone() {
    let folder = Scratch::new();
    let whole = page::whole(&Whose::of(&hall()), 0, &at(1));
    let wall = page::whole(&Whose::of(&hall()), 0, &at(3));
    let newer = String::from_utf8(whole.clone()).unwrap().replace("version 1", "version 7").into_bytes();
    let cases: [(&[u8], &str); 6] = [
        (b"", "does not begin like"),
        (&whole[..100], "100 bytes instead of 4096"),
        (&[&whole[..], b"x"].concat(), "4097 bytes"),
        (&[0xff; 4096], "not text"),
        (&wall, "cannot stand at the position"),
        (&newer, "version 7"),
    ];
    for (bytes, expect) in cases {
        fs::write(names::SIMULATED.within(&folder.0), bytes).unwrap();
        let words = SimStateFile::open(&folder.0, &RobotId::discovery(), &hall(), &hall()).unwrap_err().to_string();
        assert!(words.contains(expect) && words.contains("simulated-robot.txt") && words.contains("move"), "{words}");
        assert_eq!(fs::read(names::SIMULATED.within(&folder.0)).unwrap(), bytes);
    }
    fs::remove_file(names::SIMULATED.within(&folder.0)).unwrap();
    fs::create_dir(names::SIMULATED.within(&folder.0)).unwrap();
    let words = SimStateFile::open(&folder.0, &RobotId::discovery(), &hall(), &hall()).unwrap_err().to_string();
    assert!(words.starts_with("cannot read") && words.contains("simulated-robot.txt"), "{words}");
}

#[test]
fn what_cannot_be_written_is_owed_until_it_can() {
    let folder = Scratch::new();
    let inner = folder.0.join("not yet");
    let mut state_file = SimStateFile::begin_anew(&inner, &RobotId::discovery(), &hall());
    state_file.keep(at(1));
    state_file.keep(at(2));
    assert_eq!(state_file.owed(), Some(at(2)));
    fs::create_dir(&inner).unwrap();
    state_file.keep(state_file.owed().unwrap());
    assert_eq!(state_file.owed(), None);
    assert_eq!(SimStateFile::open(&inner, &RobotId::discovery(), &hall(), &hall()).unwrap().1, Some(at(2)));
}
