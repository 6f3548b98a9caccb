//! Tests of data folders made from archives: they are complete or missing, they are sound, and they record where they
//! begin.

use std::path::PathBuf;

use std::os::unix::fs::MetadataExt;

use super::super::archive_file::write_out_within;
use super::super::cut::Bound;
use super::super::folder::Folder;
use super::super::{ReadOnlyJournal, chain, connect, project, unpack, write_out};
use super::archives::{LATER, archive_of, end, faults, file, held, lines, play, shown, some_missions};
use super::testing::*;
use crate::runtime::archive::Unreadable;
use hallsweep_core::units::Seq;

/// Archives of missions 1 and 2; neither records that the other was archived.
fn two_in_a_row() -> (Scratch, [PathBuf; 2]) {
    let scratch = some_missions();
    let archives = ["first", "second"].map(|name| file(&scratch, name));
    for archive in &archives {
        let bound = Bound { entries: 16, ..Bound::NONE };
        write_out_within(&scratch.data(), LATER, LATER, bound, |_| archive.clone()).unwrap().expect("one is over");
    }
    (scratch, archives)
}

/// A folder unpacked from the second archive.
fn of_the_second() -> (Scratch, PathBuf, Scratch) {
    let (scratch, [_, second]) = two_in_a_row();
    let elsewhere = Scratch::new();
    unpack(&second, &elsewhere.data(), LATER).unwrap();
    (scratch, second, elsewhere)
}

#[test]
fn an_archive_becomes_a_folder_that_goes_on_by_itself() {
    let scratch = some_missions();
    let (old, elsewhere) = (file(&scratch, "old"), Scratch::new());
    write_out(&scratch.data(), LATER, LATER, &old).unwrap().expect("three are over");
    let before = std::fs::read(&old).unwrap();
    let in_it = lines(&old);
    assert_eq!(unpack(&old, &elsewhere.data(), LATER), Ok(in_it.len() as u64 + 1));
    let all = lines(&elsewhere.data());
    assert_eq!(all[..in_it.len()], in_it);
    assert!(all.last().is_some_and(|own| own.contains("\"kind\":\"unpacked\"") && own.contains("\"behind\":0")), "{all:?}");
    check_finds(&elsewhere, &[]);
    let (there, here) = (archive_of(&old), elsewhere.open());
    (1..=3).for_each(|mission| assert!(shown(&*here.archive, mission) == shown(&*there, mission), "{mission}"));
    let mut scribe = Scribe::new(here);
    play(&mut scribe, 4, "trunk");
    drop(scribe);
    check_finds(&elsewhere, &[]);
    assert_eq!(std::fs::read(&old).unwrap(), before, "reading changes nothing");
    let left = Scratch::new();
    std::fs::create_dir(left.data()).unwrap();
    std::fs::write(left.data().join("journal.lost"), "everything after entry 00000000000000000003 was said to be lost\n")
        .unwrap();
    for (from, to, words) in [
        (old.clone(), left.data(), "is not empty"),
        (old.clone(), elsewhere.data(), "is not empty"),
        (old.clone(), old.clone(), "cannot be used"),
        (old.clone(), PathBuf::from("/"), "is not empty"),
        (scratch.data(), file(&scratch, "new"), "there is no archive"),
    ] {
        let Err(Unreadable(said)) = unpack(&from, &to, LATER) else { panic!("{words}") };
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn a_folder_of_a_later_archive_is_sound_and_says_where_it_begins() {
    let (scratch, [first, second]) = two_in_a_row();
    assert_eq!(held(&scratch, &[first.clone(), second.clone()]), Vec::<String>::new());
    for (archive, mission, behind) in [(&first, 1, 0), (&second, 2, 8)] {
        let elsewhere = Scratch::new();
        unpack(archive, &elsewhere.data(), LATER).unwrap();
        check_finds(&elsewhere, &[]);
        assert_eq!(held(&elsewhere, std::slice::from_ref(archive)), Vec::<String>::new());
        let begins = chain::anchor(&connect::reader(&Folder::new(archive)).unwrap().unwrap().connection).unwrap();
        assert_eq!(begins.seq, Seq(behind));
        let notes = ReadOnlyJournal::open(&elsewhere.data()).unwrap().check().unwrap().notes;
        let said = format!("begins after entry {behind}, whose page has the digest {}", begins.hex());
        assert_eq!(
            notes.iter().any(|note| note.contains("unpacked from the archive second") && note.contains(&said)),
            behind > 0
        );
        assert!(shown(&*archive_of(&elsewhere.data()), mission) == shown(&*archive_of(archive), mission));
    }
}

#[test]
fn what_an_unpacked_folder_writes_out_itself_follows_on_the_archive_that_it_was() {
    let (_scratch, second, elsewhere) = of_the_second();
    let mut scribe = Scribe::new(elsewhere.open());
    play(&mut scribe, 5, "trunk");
    scribe.keep(end(5));
    drop(scribe);
    assert_eq!(held(&elsewhere, std::slice::from_ref(&second)), Vec::<String>::new(), "whatever was added");
    let own = file(&elsewhere, "own");
    write_out(&elsewhere.data(), LATER, LATER, &own).unwrap().expect("two are over");
    assert_eq!((faults(&own), faults(&elsewhere.data())), (Vec::new(), Vec::new()));
    for archives in [vec![own.clone()], vec![own, second.clone()]] {
        assert_eq!(held(&elsewhere, &archives), Vec::<String>::new(), "{archives:?}");
    }
    let found = held(&elsewhere, &[second]);
    assert!(found.iter().any(|fault| fault.contains("an archive between the two is missing")), "{found:?}");
}

/// What somebody may change in a folder unpacked from the second archive. For each change there is the report of a
/// check against the archive.
fn tampered(folder: &Scratch) -> [(String, &'static str); 3] {
    let connection = connect::writer(&Folder::new(&folder.data())).unwrap();
    let page = |seq| chain::page_of(&connection, Seq(seq)).unwrap().unwrap().hex();
    let moved = format!(
        "DELETE FROM events WHERE seq <= 16; DELETE FROM pages WHERE last < 16 OR last > 24;
         UPDATE events SET body = replace(replace(body, '\"behind\":8', '\"behind\":16'), '{}', '{}') WHERE seq = 25",
        page(8),
        page(16)
    );
    let changed = "UPDATE events SET at_ms = at_ms + 1 WHERE seq = 18; DELETE FROM pages WHERE last > 8";
    let other = "UPDATE events SET body = json_set(body, '$.digest', printf('%064d', 1)) WHERE seq = 25;
                 DELETE FROM pages WHERE last > 24";
    [
        (moved, "the journal does not begin where"),
        (changed.to_owned(), "the journal differs from the archive"),
        (other.to_owned(), "is not an archive of this journal"),
    ]
}

/// Somebody changes the beginning and recomputes all digests, so that the folder itself does not show it.
#[test]
fn who_moves_the_beginning_of_an_unpacked_folder_is_found_out_by_the_archive() {
    for which in 0..3 {
        let (_scratch, second, folder) = of_the_second();
        let (sql, words) = &tampered(&folder)[which];
        rewrite(&folder, sql);
        let connection = connect::writer(&Folder::new(&folder.data())).unwrap();
        project::rebuild(&connection).unwrap();
        chain::close_page(&connection).unwrap();
        drop(connection);
        std::fs::remove_file(folder.data().join("journal.head")).unwrap();
        check_finds(&folder, &[]);
        let found = held(&folder, &[second]);
        assert!(found.first().is_some_and(|fault| fault.contains(words)), "{words}: {found:?}");
    }
}

#[test]
fn a_beginning_that_is_not_on_record_is_a_fault() {
    let (_scratch, _, folder) = of_the_second();
    rewrite(&folder, "DELETE FROM events WHERE seq <= 12; DELETE FROM pages WHERE last < 12");
    check_finds(&folder, &["entries 1 to 12 are missing"]);
    let (_scratch, _, folder) = of_the_second();
    rewrite(&folder, "UPDATE pages SET digest = zeroblob(32) WHERE last = 8");
    let found = faults(&folder.data());
    assert!(found.iter().any(|fault| fault.contains("entries 1 to 8 are missing")), "{found:?}");
}

#[test]
fn what_a_kill_left_of_an_unpacking_is_begun_anew_and_an_empty_folder_is_taken() {
    let (_scratch, [_, second]) = two_in_a_row();
    let elsewhere = Scratch::new();
    let left = elsewhere.data().join("hallsweep-unpack");
    std::fs::create_dir_all(left.join("photos/ab")).unwrap();
    std::fs::write(left.join("photos/ab/cd.png"), "half a photo").unwrap();
    std::fs::write(left.join("journal.db"), "half a journal").unwrap();
    let lock = Folder::new(&left).lock().unwrap();
    let Err(Unreadable(words)) = unpack(&second, &elsewhere.data(), LATER) else { panic!("another was at it") };
    assert!(words.contains("another hallsweep uses the folder"), "{words}");
    drop(lock);
    unpack(&second, &elsewhere.data(), LATER).unwrap();
    check_finds(&elsewhere, &[]);
    assert!(!left.exists() && !elsewhere.data().join("photos/ab").exists());
}

/// The folder may be a mounted volume or the target of a link. Files in it that hallsweep did not write are left
/// alone.
#[test]
fn a_folder_that_is_there_stays_and_what_is_in_it_is_nobodys_to_remove() {
    let (_scratch, [_, second]) = two_in_a_row();
    let elsewhere = Scratch::new();
    let (place, link) = (elsewhere.data().with_file_name("volume"), elsewhere.data().with_file_name("link"));
    std::fs::create_dir_all(place.join("lost+found")).unwrap();
    std::os::unix::fs::symlink(&place, &link).unwrap();
    let before = std::fs::metadata(&place).unwrap().ino();
    // A kill came between the parts: the journal, which is moved last, is missing.
    std::fs::create_dir_all(place.join("hallsweep-unpack")).unwrap();
    std::fs::create_dir_all(place.join("photos/ab")).unwrap();
    unpack(&second, &link, LATER).unwrap();
    assert_eq!(faults(&place), Vec::<String>::new());
    assert_eq!(std::fs::metadata(&place).unwrap().ino(), before, "the folder is the one that was there");
    assert!(place.join("lost+found").exists() && !place.join("photos/ab").exists() && !place.join("hallsweep-unpack").exists());
    let Err(Unreadable(words)) = unpack(&second, &place, LATER) else { panic!("there is a journal") };
    assert!(words.contains("is not empty"), "{words}");

    let foreign = elsewhere.data().with_file_name("foreign");
    std::fs::create_dir(&foreign).unwrap();
    std::fs::write(foreign.join("diary"), "mine").unwrap();
    assert!(unpack(&second, &foreign, LATER).is_err());
    assert_eq!(std::fs::read_dir(&foreign).unwrap().count(), 1);
}

/// Unknown files at the place of building are refused. Otherwise everybody who may write beside the folder could
/// plant keys or a STOP in it.
#[test]
fn what_lies_where_a_folder_is_built_is_not_taken_into_it() {
    let (_scratch, [_, second]) = two_in_a_row();
    let elsewhere = Scratch::new();
    let build = elsewhere.data().with_file_name("data.hallsweep-unpack");
    std::fs::create_dir(&build).unwrap();
    std::fs::write(build.join("access.toml"), "keys of somebody else").unwrap();
    let Err(Unreadable(words)) = unpack(&second, &elsewhere.data(), LATER) else { panic!("it was taken") };
    assert!(words.contains("has other contents") && !elsewhere.data().exists(), "{words}");
    std::fs::remove_dir_all(&build).unwrap();
    std::os::unix::fs::symlink(elsewhere.data().with_file_name("."), &build).unwrap();
    assert!(unpack(&second, &elsewhere.data(), LATER).is_err());
}
