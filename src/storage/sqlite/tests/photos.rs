//! Photos are files beside the journal, and every photo of a piece is found.

use super::super::fault::Then;
use super::super::folder::Folder;
use super::super::photos::Pictures;
use super::testing::*;
use crate::runtime::archive::{Archive, NoTake, Unreadable};
use hallsweep_core::command::Verdict;
use hallsweep_core::units::LuggageId;

/// An older version recorded only the newest photo of each piece, and no notes. Its folder still has the files of all
/// photos.
#[test]
fn every_photo_of_a_piece_is_found_also_in_a_journal_that_did_not_list_them() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep([begin(1), vec![taken(1, 1, photo("first")), taken(1, 2, photo("again")), found(2, None)]].concat());
    let all =
        |archive: &dyn Archive| [(1, 1), (1, 2), (1, 3), (2, 1)].map(|(id, take)| archive.take(LuggageId(id), take).unwrap());
    let expect = [Some(photo("first")), Some(photo("again")), None, None];
    assert_eq!(all(&*scribe.opened.archive), expect);
    drop(scribe);
    let old = rusqlite::Connection::open(scratch.data().join("journal.db")).unwrap();
    old.execute_batch("DROP TABLE pages; DROP TABLE takes; ALTER TABLE luggage DROP COLUMN note; PRAGMA user_version = 2;")
        .unwrap();
    drop(old);
    std::fs::remove_file(scratch.data().join("journal.head")).unwrap();
    drop(Scribe::new(scratch.open()));
    check_finds(&scratch, &[]);
    assert_eq!(all(&*scratch.open().archive), expect);
}

/// Safety D3.
#[test]
fn a_photo_is_a_file_named_by_its_digest() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(vec![found(1, Some(photo("bag"))), found(2, None), found(3, Some(photo("bag")))]);
    let archive = &scribe.opened.archive;
    assert_eq!(archive.photo(LuggageId(1)), Ok(Some(photo("bag"))));
    assert_eq!((archive.photo(LuggageId(2)), archive.photo(LuggageId(4))), (Ok(None), Ok(None)));
    let files: Vec<_> = bytes(&scratch.data().join("photos"));
    assert_eq!(files.len(), 1, "the same photo is kept once: {files:?}");
    let name = files[0].0.strip_prefix(scratch.data()).unwrap().display().to_string();
    assert_eq!((name.len(), name.ends_with(".png")), ("photos/".len() + 2 + 1 + 62 + ".png".len(), true), "{name}");

    std::fs::write(&files[0].0, "bog").unwrap();
    let Err(Unreadable(words)) = archive.photo(LuggageId(1)) else { panic!("another photo was shown") };
    assert!(words.contains("was changed"), "{words}");
    check_finds(&scratch, &["was changed"]);
    scribe.keep(vec![found(1, Some(photo("bag")))]);
    assert_eq!(scribe.opened.archive.photo(LuggageId(1)), Ok(Some(photo("bag"))), "taken again it is whole");
    std::fs::remove_file(&files[0].0).unwrap();
    check_finds(&scratch, &["is missing"]);
}

/// Safety R5.
#[cfg(unix)]
#[test]
fn what_stands_in_the_place_of_a_photo_gives_way_or_is_named() {
    let (scratch, other) = (Scratch::new(), Scratch::new());
    let mut scribe = Scribe::new(other.open());
    scribe.keep(vec![found(1, Some(photo("bag")))]);
    let name = bytes(&other.data().join("photos"))[0].0.strip_prefix(other.data()).unwrap().to_owned();
    let place = scratch.data().join(name);
    std::fs::create_dir_all(place.parent().unwrap()).unwrap();
    for pipe in [&place, &place.with_extension("unfinished")] {
        assert!(std::process::Command::new("mkfifo").arg(pipe).status().unwrap().success());
    }
    let keep =
        || Pictures::Files(&Folder::new(&scratch.data())).keep(&rusqlite::Connection::open_in_memory().unwrap(), &photo("bag"));
    keep().expect("both pipes have given way");
    std::fs::remove_dir_all(scratch.data().join("photos")).unwrap();
    let shelf = place.parent().unwrap();
    for (named, is_folder) in [(&*place, true), (shelf, false)] {
        std::fs::create_dir_all(named.parent().unwrap()).unwrap();
        if is_folder {
            std::fs::create_dir(named).unwrap()
        } else {
            std::fs::write(named, "").unwrap()
        }
        let words = keep().unwrap_err().words(&scratch.data(), Then::GoesOn);
        assert!(words.contains(named.to_str().unwrap()) && words.contains("goes on by itself"), "{words}");
        std::fs::remove_dir_all(scratch.data().join("photos")).unwrap();
    }
    let room = scratch.data().join("room.unfinished");
    std::fs::create_dir(&room).unwrap();
    let words = Folder::new(&scratch.data()).prove_room(9).unwrap_err().words(&scratch.data(), Then::GoesOn);
    assert!(words.contains("room.unfinished: it is a folder"), "{words}");
}

#[test]
fn a_photo_that_is_missing_or_another_is_spoilt_and_one_that_cannot_be_opened_is_not() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(vec![taken(1, 1, photo("bag"))]);
    let (archive, file) = (&scribe.opened.archive, bytes(&scratch.data().join("photos")).remove(0).0);
    let take = || archive.take(LuggageId(1), 1);
    assert_eq!(take(), Ok(Some(photo("bag"))));
    std::fs::write(&file, "bog").unwrap();
    assert!(matches!(take(), Err(NoTake::Spoilt(words)) if words.contains("was changed")));
    std::fs::remove_file(&file).unwrap();
    assert!(matches!(take(), Err(NoTake::Spoilt(words)) if words.contains("is missing")));
    std::fs::create_dir(&file).unwrap();
    assert!(
        matches!(take(), Err(NoTake::Unreadable(Unreadable(words))) if words.contains(&format!("{}: it is a folder", file.display())))
    );
}

#[test]
fn a_failed_retake_leaves_the_photo_there_was() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(vec![found(1, Some(photo("bag"))), verdict(1, Verdict::Safe)]);
    scribe.keep(vec![found(1, None)]);
    assert_eq!(scribe.opened.archive.photo(LuggageId(1)), Ok(Some(photo("bag"))));
    let record = scribe.opened.archive.luggage(LuggageId(1)).unwrap().expect("it is on record");
    assert_eq!((record.verdict_name(), &*record.verdict.unwrap().who), ("safe", "anna"));
    assert_eq!(scribe.opened.archive.luggage(LuggageId(7)), Ok(None));
}
