//! Stored entries are read again: by the next start, by the archive, and by readers of the journal.

use proptest::prelude::*;

use super::super::{ReadOnlyJournal, connect, folder::Folder, rebuild, rows, schema};
use super::testing::*;
use crate::api::journal::Line;
use crate::api::journal::tests::arbitrary;
use crate::api::journal_words;
use crate::runtime::archive::{Sound, Span, Unreadable};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, CommandId, Hot, HotAnswer, LuggageRef, Note, Strategy as Order, Verdict};
use hallsweep_core::engine::{IDS, Recalled};
use hallsweep_core::snapshot::log::Tone;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{Cell, LuggageId, MissionId, Seq};

/// The recalled log has commands and findings, and no steps.
#[test]
fn the_latest_of_what_people_did_and_what_was_found_is_recalled() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    for id in 1..=40 {
        scribe.keep(vec![found(id, None), wall(1, 1), verdict(id, Verdict::Danger)]);
    }
    drop(scribe);
    let latest = scratch.open().recalled.expect("something was kept").latest;
    let said: Vec<String> = latest.into_iter().map(|line| line.said.to_string()).collect();
    let expected = (11..=40).flat_map(|id| [found(id, None), verdict(id, Verdict::Danger)]);
    assert_eq!(said, expected.map(|fact| journal_words::words(&fact)).collect::<Vec<_>>());
}

/// Safety D1.
#[test]
fn every_commit_is_flushed_and_no_old_sqlite_writes_it() {
    let scratch = Scratch::new();
    drop(scratch.open());
    let connection = connect::writer(&Folder::new(&scratch.data())).unwrap();
    let text = |name: &str| connection.query_row(&format!("PRAGMA {name}"), [], |row| row.get::<_, String>(0)).unwrap();
    let number = |name: &str| connection.query_row(&format!("PRAGMA {name}"), [], |row| row.get::<_, i64>(0)).unwrap_or(0);
    assert_eq!(text("journal_mode"), "wal");
    assert_eq!((number("synchronous"), number("foreign_keys"), number("mmap_size")), (2, 1, 0));
    assert!(
        rusqlite::version_number() > 3_051_002,
        "{}: up to 3.51.2 a reset of the log can corrupt the file",
        rusqlite::version()
    );
}

/// Safety V3, R1: record and verdict are there at the next start.
#[test]
fn what_was_kept_stands_at_the_next_start() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    assert_eq!((&scribe.opened.recalled, &scribe.opened.failure), (&None, &None));
    let pages = [begin(1), vec![command(Some("a-1")), found(1, Some(photo("bag")))], vec![verdict(1, Verdict::Danger)]];
    for page in pages.clone() {
        scribe.keep(page);
    }
    drop(scribe);
    let recalled = scratch.open().recalled.expect("something was kept");
    let entries: Vec<Entry> = pages.concat().into_iter().map(at_noon).collect();
    let commands = vec![at_noon(command(Some("a-1")))];
    let latest = recalled.latest.clone();
    assert_eq!(recalled, Recalled { state: fold(&entries), written: Seq(7), commands, kept_back: Vec::new(), latest });
    assert!(recalled.state.luggage[0].is_dangerous());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Safety D2, R1: the same state follows from the journal, whatever happened.
    #[test]
    fn whatever_was_kept_folds_to_the_same(pages in prop::collection::vec(prop::collection::vec(harmless(), 1..8), 1..8)) {
        let scratch = Scratch::new();
        let mut scribe = Scribe::new(scratch.open());
        for page in pages.clone() {
            scribe.hand(page);
        }
        drop(scribe);
        let entries: Vec<Entry> = pages.concat().into_iter().map(at_noon).collect();
        let opened = scratch.open();
        prop_assert_eq!(opened.recalled.map(|recalled| recalled.state), Some(fold(&entries)));
        check_finds(&scratch, &[]);
    }
}

/// Facts whose numbers fit into the tables.
fn harmless() -> impl Strategy<Value = Fact> {
    arbitrary::fact().prop_filter("numbers beyond 2^63", |fact| {
        !matches!(
            fact,
            Fact::MissionBegan(..)
                | Fact::MissionArchived(..)
                | Fact::Judged(_)
                | Fact::Unsure { .. }
                | Fact::Revealed { .. }
                | Fact::Verdict { .. }
                | Fact::Luggage { .. }
                | Fact::Secured(_)
        ) && !matches!(fact, Fact::State(_))
    })
}

#[test]
fn reading_begins_at_the_last_entry_that_says_everything() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(vec![wall(1, 1)]);
    scribe.keep(vec![Fact::State(Box::new(PersistentState::first(Order::default())))]);
    scribe.keep(vec![wall(2, 2)]);
    drop(scribe);
    let state = scratch.open().recalled.expect("something was kept").state;
    assert_eq!(state, fold(&[at_noon(wall(2, 2))]));
}

/// The ids of the last commands are recalled, however old they are. Otherwise a repeated command would have an effect
/// again.
#[test]
fn the_last_ids_are_known_at_the_next_start_however_long_ago_they_came() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    let named = |range: std::ops::Range<usize>| -> Vec<Fact> { range.map(|n| command(Some(&format!("id-{n}")))).collect() };
    scribe.keep([named(0..2), vec![command(None)]].concat());
    for _ in 0..5 {
        scribe.keep((0..1000).map(|x| wall(x, 3)).collect());
    }
    drop(scribe);
    let recalled = |scratch: &Scratch| scratch.open().recalled.expect("something was kept").commands;
    let entries = |range| -> Vec<Entry> { named(range).into_iter().map(at_noon).collect() };
    assert_eq!(recalled(&scratch), entries(0..2));
    Scribe::new(scratch.open()).keep(named(2..IDS + 3));
    assert_eq!(recalled(&scratch), entries(3..IDS + 3), "and no more than are remembered");
}

#[test]
fn a_journal_of_the_first_format_is_brought_up_to_date() {
    let scratch = Scratch::new();
    let path = scratch.data().join("journal.db");
    std::fs::create_dir(scratch.data()).unwrap();
    let mut old = rusqlite::Connection::open(&path).unwrap();
    schema::of_format(&mut old, 1);
    for (place, fact) in (1..).zip([vec![command(Some("a-1"))], begin(1), vec![wall(1, 1)]].concat()) {
        let line = Line { seq: Seq(place), mission: None, entry: at_noon(fact), picture: None };
        rows::insert(&old, &line).unwrap();
    }
    // An old entry that cannot be read does not prevent a start.
    old.execute("INSERT INTO events VALUES (7, NULL, 0, 0, 'command', 'no JSON')", []).unwrap();
    let state = Line {
        seq: Seq(8),
        mission: None,
        entry: at_noon(Fact::State(Box::new(PersistentState::first(Order::default())))),
        picture: None,
    };
    rows::insert(&old, &state).unwrap();
    drop(old);
    let mut scribe = Scribe::new(scratch.open());
    assert_eq!(scribe.opened.failure, None);
    let recalled = scribe.opened.recalled.clone().expect("all of it is there");
    assert_eq!((recalled.written, recalled.commands), (Seq(8), vec![at_noon(command(Some("a-1")))]));
    scribe.keep(vec![command(Some("a-2"))]);
    drop(scribe);
    let version = connect::writer(&Folder::new(&scratch.data())).unwrap().query_row("PRAGMA user_version", [], |row| row.get(0));
    assert_eq!(version, Ok(schema::FORMAT));
    assert_eq!(scratch.open().recalled.expect("it was kept").commands.len(), 2);
}

/// Safety D2.
#[test]
fn the_tables_are_rebuilt_from_the_journal() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep([begin(1), vec![found(1, Some(photo("bag"))), verdict(1, Verdict::Safe)]].concat());
    let Err(Unreadable(words)) = rebuild(&scratch.data()) else { panic!("it was rebuilt under a running program") };
    assert!(words.contains("another hallsweep uses the folder"), "{words}");
    drop(scribe);
    check_finds(&scratch, &[]);
    meddle(&scratch, "UPDATE luggage SET verdict = 'danger'; DELETE FROM missions");
    check_finds(&scratch, &["the table missions", "the table luggage"]);
    assert_eq!(rebuild(&scratch.data()), Ok(4));
    check_finds(&scratch, &[]);
}

/// The table keeps the latest answers of unsure judges, as the state does, and so does a table that is rebuilt.
#[test]
fn who_was_unsure_is_in_the_table_as_in_the_state() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    let doubt = |n: usize| Fact::Unsure {
        luggage: LuggageId(1),
        who: format!("judge {n}").into(),
        note: Note::new("a shadow").filter(|_| n.is_multiple_of(2)),
        hot: Hot { hidden: Some(HotAnswer::CannotSay), ..Hot::NONE },
    };
    let pages = [[begin(1), vec![found(1, Some(photo("bag")))]].concat(), (0..20).map(doubt).collect()];
    let entries: Vec<Entry> = pages.iter().flatten().cloned().map(at_noon).collect();
    for page in pages {
        scribe.keep(page);
    }
    let expected = fold(&entries).luggage.get(LuggageId(1)).expect("it was found").unsure.clone();
    assert_eq!((expected.len(), &*expected[0].who), (16, "judge 4"));
    let shown = |scribe: &Scribe| scribe.opened.archive.luggage(LuggageId(1)).unwrap().expect("it is there").unsure;
    assert_eq!(shown(&scribe), expected);
    drop(scribe);
    check_finds(&scratch, &[]);
    meddle(&scratch, "UPDATE luggage SET record = json_remove(record, '$.unsure')");
    check_finds(&scratch, &["the table luggage"]);
    rebuild(&scratch.data()).unwrap();
    check_finds(&scratch, &[]);
    assert_eq!(shown(&Scribe::new(scratch.open())), expected);
}

#[test]
fn a_check_finds_what_is_missing_and_what_says_nothing() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    scribe.keep(vec![wall(1, 1), wall(2, 2), wall(3, 3), wall(4, 4)]);
    drop(scribe);
    let changed = "entries 5 to 8 were changed";
    meddle(&scratch, "DELETE FROM events WHERE seq IN (6, 7)");
    check_finds(&scratch, &["entries 6 to 7 are missing", changed]);
    meddle(&scratch, "INSERT INTO losses VALUES (5, 1)");
    check_finds(&scratch, &[changed]);
    meddle(
        &scratch,
        "INSERT INTO events VALUES (9, NULL, 0, 0, 'led', '{\"kind\":\"led\"}'), (10, NULL, 0, 0, 'mark', '{\"kind\":\"led\",\"blinking\":true}')",
    );
    check_finds(&scratch, &["entry 9 ", "entry 10 has a wrong kind", changed, "the entries from 9 on are in no page"]);
}

/// Overwrites an entry, as a bad disk would.
fn damage(scratch: &Scratch, seq: Seq) {
    rewrite(scratch, &format!("UPDATE events SET body = 'mouse' WHERE seq = {seq}"));
}

/// Checks that the report names the entry and says what to do. It must not ask for rebuilt tables, which would have
/// less data.
fn check_advises(scratch: &Scratch, damaged: Seq, words: &str) {
    let findings = ReadOnlyJournal::open(&scratch.data()).unwrap().check().unwrap();
    assert!(findings.faults[0].starts_with(&format!("entry {damaged} of the journal cannot be understood")), "{findings:?}");
    assert!(findings.faults.iter().all(|fault| !fault.contains("rebuild")), "{findings:?}");
    let advice = findings.notes.last().expect("there is advice");
    assert!(advice.contains(words) && advice.contains("`hallsweep journal export` prints the sound entries"), "{advice}");
}

#[test]
fn of_a_mission_with_a_damaged_entry_the_rest_is_shown_and_the_damage_said() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep([begin(1), vec![found(1, Some(photo("bag"))), verdict(1, Verdict::Danger)]].concat());
    let lost = scribe.keep(vec![wall(4, 4)]);
    scribe.keep(vec![wall(5, 5)]);
    scribe.keep(archive(1));
    let state = PersistentState::first(Order::default());
    let summed_up = scribe.keep(vec![Fact::State(Box::new(state))]);
    scribe.keep(begin(2));
    let ended = scribe.keep([vec![wall(6, 6)], archive(2)].concat());
    damage(&scratch, lost);
    let kept = &scribe.opened.archive;
    let Sound { of, damage: said } = kept.state(MissionId(1)).unwrap().expect("there was a mission 1");
    let at = |x| of.map.at(Cell::new(x, x)).is_obstacle();
    assert_eq!((at(4), at(5), of.luggage.len()), (false, true, 1));
    assert!(said.len() == 1 && said[0].starts_with(&format!("entry {lost} of the journal cannot be understood")), "{said:?}");
    let entries = kept.entries(MissionId(1), Span::after(Seq(0)), 100).unwrap();
    let damaged: Vec<Seq> = entries.iter().filter(|(_, entry)| entry.is_err()).map(|(seq, _)| *seq).collect();
    assert_eq!((damaged, entries.len()), (vec![lost], 10));
    assert_eq!(kept.missions(None, 9).map(|missions| missions.len()), Ok(2));
    assert_eq!(kept.state(MissionId(2)).unwrap().map(|sound| sound.damage), Some(Vec::new()), "the other has none");

    check_advises(&scratch, lost, "hallsweep continues without these entries, so you need to do nothing");

    // Without damage, reading would begin at this entry. Now it begins at an earlier one.
    damage(&scratch, summed_up);
    check_advises(&scratch, lost, "copy the whole folder");
    let Sound { of, damage: said } = kept.state(MissionId(2)).unwrap().expect("there was a mission 2");
    assert!(of.map.at(Cell::new(6, 6)).is_obstacle());
    assert_eq!(said.len(), 2, "what was passed on the way is said: {said:?}");

    (lost.0 + 1..=ended.0).for_each(|seq| damage(&scratch, Seq(seq)));
    let Sound { damage: said, .. } = kept.state(MissionId(2)).unwrap().expect("there was a mission 2");
    assert!(said.len() == 9 && said[8].contains("more entries cannot be understood"), "{said:?}");
    let mut lines = Vec::new();
    let reading = ReadOnlyJournal::open(&scratch.data()).unwrap();
    reading
        .lines(None, None, |seq, line| {
            lines.push((seq, line.is_ok()));
            true
        })
        .unwrap();
    assert_eq!(lines.iter().filter(|(_, is_sound)| !is_sound).count() as u64, ended.0 - lost.0 + 1);
}

/// Safety V1, A6: before the verdict "safe" was durable, a verdict "danger" came. So "safe" was refused, and is shown
/// as refused.
#[test]
fn a_safe_that_a_danger_overtook_stands_there_as_refused() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep([begin(1), vec![found(1, Some(photo("bag"))), found(2, Some(photo("box")))]].concat());
    let said = |luggage, verdict: Verdict| {
        let Fact::Command { issuer, .. } = command(None) else { unreachable!("it is a command") };
        let id = CommandId::new(&format!("of-{luggage}-{}", verdict.name()));
        let luggage = LuggageId(luggage);
        let asked =
            Asked::Command(Command::Verdict { luggage: LuggageRef::Id(luggage), verdict, note: None, hot: Default::default() });
        Fact::Command { issuer, id, asked, epoch: None, luggage: Some(luggage), refused: None }
    };
    scribe.keep(vec![said(1, Verdict::Safe), verdict(1, Verdict::Safe)]);
    scribe.keep(vec![said(1, Verdict::Danger), verdict(1, Verdict::Danger)]);
    scribe.keep(vec![said(2, Verdict::Safe), verdict(2, Verdict::Safe)]);
    let refusals = |facts: Vec<Fact>| -> Vec<(String, Option<&'static str>)> {
        let of = |fact| {
            let Fact::Command { asked, refused, luggage: Some(_), .. } = fact else { return None };
            Some((asked.to_string(), refused.map(|refused| refused.code())))
        };
        facts.into_iter().filter_map(of).collect()
    };
    let expected =
        [("safe #1", Some("decided")), ("danger #1", None), ("safe #2", None)].map(|(words, code)| (words.to_owned(), code));
    let entries = scribe.opened.archive.entries(MissionId(1), Span::after(Seq(0)), 100).unwrap();
    assert_eq!(refusals(entries.into_iter().map(|(_, entry)| entry.unwrap().fact).collect()), expected);
    let mut lines = Vec::new();
    let reading = ReadOnlyJournal::open(&scratch.data()).unwrap();
    reading
        .lines(None, None, |_, line| {
            lines.push(line.unwrap().entry.fact);
            true
        })
        .unwrap();
    assert_eq!(refusals(lines), expected);
    drop(scribe);
    let recalled = scratch.open().recalled.unwrap();
    assert_eq!(refusals(recalled.commands.into_iter().map(|entry| entry.fact).collect()), expected);
    let warned = recalled.latest.iter().filter(|line| line.tone == Tone::Warning).count();
    assert_eq!(warned, 1, "{:?}", recalled.latest);
}

#[test]
fn entries_on_record_cannot_be_changed() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    drop(scribe);
    let connection = connect::writer(&Folder::new(&scratch.data())).unwrap();
    let refused = connection.execute("UPDATE events SET at_ms = 0", []).unwrap_err().to_string();
    assert!(refused.contains("never changed"), "{refused}");
}

#[test]
fn lines_are_read_beside_a_running_program() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(vec![wall(0, 9)]);
    scribe.keep(begin(1));
    let reading = ReadOnlyJournal::open(&scratch.data()).unwrap();
    let places = |mission: Option<u64>, last| {
        let mut places = Vec::new();
        let visit = |seq: Seq, line: Result<crate::api::journal::Line, String>| {
            assert_eq!(line.unwrap().seq, seq);
            places.push(seq.0);
            true
        };
        reading.lines(mission.map(MissionId), last, visit).unwrap();
        places
    };
    assert_eq!(places(None, None), [1, 2, 3, 4, 5]);
    assert_eq!(places(None, Some(2)), [4, 5]);
    assert_eq!(places(Some(1), Some(3)), [3, 4, 5]);
    assert_eq!(places(Some(1), Some(30)), [2, 3, 4, 5]);
    assert_eq!(places(Some(7), None), [0_u64; 0]);
}
