//! Tests that every entry is read back as it was written, and that any other text is refused with a sentence.

pub(crate) mod arbitrary;

use proptest::prelude::*;

use super::*;
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, Door, Issuer, LuggageRef, Verdict};
use hallsweep_core::refused::Refused;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{Cell, LuggageId, Pose, Revision};
use hallsweep_core::world::hall_map::{HallMap, Mark};

fn at(seq: u64, fact: Fact) -> Line {
    let entry = Entry { wall: WallTime { unix_ms: 1_770_109_512_250, offset_s: 3600 }, fact };
    Line { seq: Seq(seq), mission: Some(MissionId(3)), entry, picture: None }
}

fn refused(text: &str) -> String {
    read_body(text).expect_err(text).to_string()
}

proptest! {
    /// Safety R1: no entry loses anything when it is written and read back.
    #[test]
    fn every_entry_is_read_back_as_it_was(seq in any::<u64>(), mission in any::<Option<u64>>(), entry in arbitrary::entry()) {
        let before = Line { seq: Seq(seq), mission: mission.map(MissionId), entry, picture: None };
        let text = line(&before);
        prop_assert!(!text.contains('\n'));
        prop_assert_eq!(line(&read_line(text.as_bytes()).unwrap()), text);
        prop_assert_eq!(read_body(&body(&before.entry.fact, None)).unwrap().0, before.entry.fact);
    }

    /// Tests commands separately, because they have more kinds than all other facts.
    #[test]
    fn every_command_is_read_back_with_what_became_of_it(facts in prop::collection::vec(arbitrary::command(), 16)) {
        for fact in facts {
            prop_assert_eq!(read_body(&body(&fact, None)).unwrap().0, fact);
        }
    }

    #[test]
    fn the_kind_stands_in_the_object(fact in arbitrary::fact()) {
        let object: serde_json::Value = serde_json::from_str(&body(&fact, None)).unwrap();
        prop_assert_eq!(&object["kind"], kind(&fact));
    }

    /// Safety A7: any bytes give a line or an error.
    #[test]
    fn any_bytes_give_a_line_or_a_sentence(bytes in any::<Vec<u8>>()) {
        if let Err(unparsed) = read_line(&bytes) {
            prop_assert!(unparsed.to_string().contains(' '));
        }
    }

    /// Safety A7: a valid line that is damaged in one place gives a line or an error.
    #[test]
    fn a_damaged_line_gives_a_line_or_a_sentence(entry in arbitrary::entry(), place in any::<prop::sample::Index>(), with: u8) {
        let mut bytes = line(&Line { seq: Seq(1), mission: None, entry, picture: None }).into_bytes();
        let place = place.index(bytes.len());
        bytes[place] = with;
        if let Err(unparsed) = read_line(&bytes) {
            prop_assert!(unparsed.to_string().contains(' '));
        }
    }
}

#[test]
fn a_line_is_an_object_that_people_can_read() {
    assert_eq!(
        line(&at(12, Fact::Pose(Pose::START))),
        r#"{"seq":12,"at":"2026-02-03T10:05:12.250+01:00","unixMs":1770109512250,"offsetS":3600,"mission":3,"kind":"pose","x":0,"y":0,"heading":"south"}"#
    );
}

#[test]
fn the_journal_has_codes_and_an_exported_line_has_sentences() {
    let (issuer, luggage) = (Issuer::operator(Door::LOCAL), LuggageId(2));
    let asked = Asked::Command(Command::Verdict {
        luggage: LuggageRef::Id(luggage),
        verdict: Verdict::Danger,
        note: None,
        hot: Default::default(),
    });
    let refused = Some(Refused::Decided { luggage, verdict: Verdict::Safe });
    let fact = Fact::Command { issuer, id: None, asked, epoch: None, luggage: Some(luggage), refused };
    assert_eq!(
        body(&fact, None),
        r#"{"kind":"command","command":{"code":"verdict","luggage":2,"verdict":"danger"},"door":"local","who":"operator","from":"here","id":null,"luggage":2,"refused":{"code":"decided","luggage":2,"verdict":"safe"}}"#
    );
    let exported = line(&at(12, fact));
    let expect = r#""kind":"command","command":"danger #2","door":"local","who":"operator","from":"here","id":null,"luggage":2,"refused":{"code":"decided","words":"luggage #2 was already found safe: a verdict is final"}}"#;
    assert!(exported.ends_with(expect), "{exported}");
}

#[test]
fn fields_that_a_later_version_adds_are_skipped() {
    let text = r#"{"kind":"led","blinking":true,"colour":"red"}"#;
    assert_eq!(read_body(text).unwrap().0, Fact::Led(true));
}

#[test]
fn meanings_that_a_later_version_adds_are_refused() {
    for (text, expect) in [
        (r#"{"kind":"danced"}"#, "danced"),
        (r#"{"kind":"holds","holds":["operator","boredom"]}"#, "\"boredom\" is no hold"),
        (r#"{"kind":"obstacle","x":1,"y":1,"takenFor":"ghost"}"#, "\"ghost\" is no obstacle"),
        (r#"{"kind":"mark","x":1,"y":1,"mark":"lava"}"#, "\"lava\" is no mark"),
        (r#"{"kind":"temperature","source":"a","celsius":1e9}"#, "no temperature"),
        (r#"{"kind":"phase","phase":{"name":"dreaming"}}"#, "dreaming"),
        (r#"{"kind":"goal","goal":null,"search":{"strategy":"snail","notes":[0,77]}}"#, "does not fit the strategy snail"),
        (r#"{"kind":"led"}"#, "missing field `blinking`"),
        (r#"{"kind":"alarmRaised","alarm":1,"luggage":null,"text":{"code":"smoke"}}"#, "\"smoke\" is no code"),
        (
            r#"{"kind":"alarmRaised","alarm":1,"luggage":null,"text":{"code":"call","luggage":1,"saying":"hello"}}"#,
            "\"hello\" is no call",
        ),
    ] {
        let said = refused(text);
        assert!(said.contains(expect), "{text}: {said}");
    }
}

#[test]
fn a_digest_that_would_lead_out_of_the_folder_is_refused() {
    let record = r#""luggage":{"id":1,"cell":{"x":0,"y":1},"pose":{"x":0,"y":0,"heading":"south"},"taken":{"unixMs":0,"offsetS":0},"photo":{"failed":"dark"},"verdict":null,"piece":null}"#;
    let text =
        |digest: &str| format!(r#"{{"kind":"luggage",{record},"picture":{{"digest":"{digest}","mediaType":"image/png"}}}}"#);
    assert!(read_body(&text(&"0".repeat(64))).is_ok());
    assert!(refused(&text("../../../etc/passwd")).contains("digest"));
}

#[test]
fn phases_inside_phases_without_end_are_refused() {
    let deep = r#"{"name":"fault","cause":"noWayHome","interrupted":"#.repeat(100_000);
    assert!(refused(&format!(r#"{{"kind":"phase","phase":{deep}"#)).contains("recursion"));
}

#[test]
fn a_row_of_the_map_cannot_be_without_end() {
    for row in [r#"[0,0,"V2000000000"]"#, r#"[0,2000000000,"V1"]"#, r#"[9000,0,"V1"]"#, r#"[0,0,"V0"]"#, r#"[0,0,"V"]"#] {
        let whole = body(&Fact::State(Box::new(PersistentState::first(Default::default()))), None);
        let drawn = whole.replace(r#"[0,0,"V1"]"#, row);
        assert_ne!(whole, drawn);
        assert!(refused(&drawn).contains("of the map is no row"), "{row}");
    }
}

/// Found by fuzzing: the coordinate one step beyond this cell overflowed.
#[test]
fn a_cell_that_no_map_reaches_is_refused() {
    let pose = r#"{"kind":"pose","x":2147483647,"y":0,"heading":"east"}"#;
    let mark = r#"{"kind":"mark","x":0,"y":-2147483648,"mark":"wall"}"#;
    for text in [pose, mark] {
        assert!(refused(text).contains("no coordinate of a cell"), "{}", refused(text));
    }
}

#[test]
fn a_large_hall_takes_some_kilobytes() {
    let mut standing = PersistentState::first(Default::default());
    standing.map = hall(512);
    let text = body(&Fact::State(Box::new(standing.clone())), None);
    assert!(text.len() < 64 * 1024, "{} bytes", text.len());
    assert_eq!(read_body(&text).unwrap().0, Fact::State(Box::new(standing)));
}

/// A hall of `size` columns and rows, with walls in the east and in the south and with some pillars.
fn hall(size: i32) -> HallMap {
    let mut map = HallMap::new(Cell::HOME, Revision(1));
    for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
        let wall = x == size - 1 || y == size - 1 || (x % 37 == 5 && y % 41 == 5);
        map.mark(Cell::new(x, y), if wall { Mark::Wall } else { Mark::Visited }, Revision(1));
    }
    map
}
