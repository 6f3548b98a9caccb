//! Tests that a report can be written of any record, in remembered words and with all markup escaped. Lost parts, and
//! parts that cannot be read at the moment, are treated differently.

use std::sync::Arc;
use std::time::Duration;

use proptest::strategy::{Strategy as _, ValueTree};
use proptest::test_runner::TestRunner;
use sha2::{Digest, Sha256};

use super::edition_tests::words;
use super::scaled::tests::{noise, png};
use super::{Claim, Comparison, Difference, Failure, Report, list};
use crate::api::journal::tests::arbitrary;
use crate::api::tests::fixture::exported;
use crate::phrases::{Language, said_here};
use crate::runtime::archive::{At, Happened, Head, NoTake, PastMoment, Sound, Unreadable, hex};
use crate::runtime::tests::partial_archive::PartialArchive;
use hallsweep_core::asked::Asked;
use hallsweep_core::closing::{Closed, OpenPoints};
use hallsweep_core::command::{Command, Door, Issuer, Note, Strategy};
use hallsweep_core::engine::Past;
use hallsweep_core::event::Photo;
use hallsweep_core::hold::Hold;
use hallsweep_core::settings::Rules;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::state::{Conditions, Participant, PersistentState, Phase, Reach, Venue};
use hallsweep_core::units::{Cell, Celsius, LuggageId, MissionId, Pose, Seq, WallTime};
use hallsweep_core::world::luggage::{Luggage, PhotoState};

pub(super) const MISSION: MissionId = MissionId(1);

/// A mission with these entries. Every piece has this photo, and entry 3 cannot be read.
pub(super) struct Mission {
    pub(super) entries: Vec<Entry>,
    photo: Result<&'static [u8], NoTake>,
    damage: Vec<String>,
    lost_after: Option<Seq>,
}

impl Mission {
    pub(super) fn of(entries: Vec<Entry>) -> Mission {
        Mission { entries, photo: Ok(b"bag"), damage: Vec::new(), lost_after: None }
    }

    pub(super) fn report(&self, language: Language) -> String {
        let mut page = Vec::new();
        let report = Report::new(self, MISSION, language).unwrap().expect("there are entries");
        report.write(&mut page).unwrap();
        String::from_utf8(page).unwrap()
    }

    pub(super) fn report_of(&self, edition: u32, language: Language) -> String {
        let claim = Claim { edition, ..Claim::read(self.report(language).as_bytes()).unwrap() };
        let mut page = Vec::new();
        Report::again(self, claim).unwrap().expect("there are entries").write(&mut page).unwrap();
        String::from_utf8(page).unwrap()
    }

    /// The result of `journal check --report` for this page.
    fn confirms(&self, page: &str) -> Result<(), Difference> {
        let mut comparison = Comparison::new(page.as_bytes());
        let claim = Claim::read(page.as_bytes()).unwrap();
        Report::again(self, claim).unwrap().expect("there are entries").write(&mut comparison).unwrap();
        comparison.finish().unwrap()
    }
}

impl PartialArchive for Mission {
    fn take(&self, _: LuggageId, take: u32) -> Result<Option<Photo>, NoTake> {
        let photo = Photo { bytes: self.photo.clone()?.into(), media_type: "image/png" };
        Ok((take < 4).then_some(photo))
    }

    fn moments(&self, _: MissionId, _: &[At]) -> Vec<PastMoment> {
        let mut state = PersistentState::first(Strategy::default());
        self.entries.iter().filter(|entry| !matches!(entry.fact, Fact::State(_))).for_each(|entry| state.apply(entry));
        let past = Past { seq: Seq(9), state, trail: Vec::new(), temperatures: Vec::new(), latest: Vec::new() };
        let wall = WallTime::default();
        vec![PastMoment { past: Sound { of: past, damage: self.damage.clone() }, wall, earlier: None, later: None }]
    }

    fn entries(&self, _: MissionId) -> Vec<Happened> {
        let damaged = |seq| (seq == 3).then(|| Unreadable("a mouse was at it".to_owned()));
        let happened = |(entry, seq): (&Entry, u64)| (Seq(seq), damaged(seq).map_or_else(|| Ok(entry.clone()), Err));
        self.entries.iter().zip(1..).map(happened).collect()
    }

    fn lines(&self, mission: MissionId, happened: Vec<Happened>) -> Vec<(Seq, String)> {
        exported(mission, happened)
    }

    fn head(&self, until: Seq) -> Option<Head> {
        Some(Head { seq: until.min(Seq(self.entries.len() as u64)), digest: [0xa5; 32] })
    }

    fn lost_after(&self) -> Option<Seq> {
        self.lost_after
    }
}

/// A mission with thousands of entries of every kind, which are always the same.
pub(super) fn of_every_kind() -> Mission {
    let mut runner = TestRunner::deterministic();
    let entries = (0..4000).map(|_| arbitrary::entry().new_tree(&mut runner).expect("a value").current()).collect();
    Mission::of(entries)
}

#[test]
fn whatever_is_on_record_is_written_in_words_that_are_remembered() {
    let mission = of_every_kind();
    let known: Vec<String> = words();
    for language in Language::ALL {
        said_here(|said| said.clear());
        let page = mission.report(language);
        assert!(page.ends_with("</html>\n") && page.contains("<svg class=\"hall\""), "{page}");
        assert_eq!(page.matches("<tr").count() as u64, page.matches("</tr>").count() as u64);
        said_here(|said| {
            assert!(said.len() > 100, "{said:?}");
            let unknown = |id: &&String| !known.iter().any(|line| line.starts_with(&format!("{} {id} = ", language.tag())));
            let unknown: Vec<&String> = said.iter().filter(unknown).collect();
            assert!(unknown.is_empty(), "not in words.txt: {unknown:?}");
        });
        assert_eq!(page, mission.report(language), "the same record is the same page");
    }
    assert_ne!(mission.report(Language::English), mission.report(Language::Italian));
}

fn command(who: &str, words: &str) -> Entry {
    asked(who, Asked::Words(words.to_owned()))
}

fn asked(who: &str, asked: Asked) -> Entry {
    let issuer = Issuer { who: who.into(), ..Issuer::operator(Door("http")) };
    let fact = Fact::Command { issuer, id: None, asked, epoch: None, luggage: None, refused: None };
    Entry { wall: WallTime { unix_ms: 1_770_109_512_250, offset_s: 3600 }, fact }
}

#[test]
fn what_others_wrote_is_neither_markup_nor_a_formula() {
    let script = "<script>alert('1')</script>\" onload=\"x";
    let mission = Mission::of(vec![command(script, script), command("=cmd|'/C calc'!A0", "@SUM(1)"), command("-", "x")]);
    for language in Language::ALL {
        let page = mission.report(language);
        assert!(!page.contains("<script>") && page.contains("&#60;script&#62;alert"), "{page}");
        let mut table = Vec::new();
        list::write_table(&mission, MISSION, language, &mut table).unwrap();
        let table = String::from_utf8(table).unwrap();
        assert!(table.contains(",'@SUM(1),'=cmd|'/C calc'!A0,here,http,"), "{table}");
        assert!(table.contains("3,,unreadable,a mouse was at it,,,,\r\n"), "{table}");
        assert!(table.contains("\"<script>alert('1')</script>\"\" onload=\"\"x\""), "{table}");
    }
    let mut lines = Vec::new();
    list::write_lines(&mission, MISSION, &mut lines).unwrap();
    let lines = String::from_utf8(lines).unwrap();
    assert!(lines.lines().count() == 3 && lines.lines().all(|line| serde_json::from_str::<serde_json::Value>(line).is_ok()));
}

#[test]
fn every_stop_of_a_shared_entry_counts() {
    let stop = || asked("anna", Asked::Command(Command::Stop));
    let stops = Asked::Stops { count: 2960, within: Some(Duration::from_secs(1)) };
    let mission = Mission::of(vec![stop(), asked("anna", stops), command("anna", "x"), stop()]);
    assert!(mission.report(Language::English).contains("<dt>STOP pressed</dt><dd>2962</dd>"));
}

#[test]
fn the_outcome_of_a_search_says_how_much_of_the_hall_could_be_reached_where_that_is_on_record() {
    let page = |reach, language| {
        let venue = Venue { name: "depot".into(), cell_m: Some(0.5), reach, ..Venue::default() };
        let threshold = Celsius::new(25.0).expect("a temperature");
        let facts = [Fact::Conditions(Conditions { venue, threshold, rules: Rules::default() }), Fact::Phase(Phase::Explored)];
        Mission::of(facts.map(|fact| Entry { fact, ..command("anna", "x") }).to_vec()).report(language)
    };
    let partly = Some(Reach { reachable: 51, free: 60 });
    let english = page(partly, Language::English);
    for said in [
        "<p class=\"outcome\">Everything that can be reached from the start was searched: 51 of 60 free cells · ",
        "<dt>Can be reached</dt><dd>51 of 60 free cells can be reached from the start</dd>",
    ] {
        assert!(english.contains(said), "{said} in {english}");
    }
    assert!(page(partly, Language::Italian).contains("dalla partenza si raggiungono 51 celle libere su 60"));
    let earlier = page(None, Language::English);
    assert!(earlier.contains("The whole hall was searched") && !earlier.contains("Can be reached"), "edition 1 says it so");
}

#[test]
fn the_outcome_says_what_was_not_searched_and_whether_it_was_simulated_and_by_which_robots() {
    let mission = |robots: &[(&str, &str, Option<&str>)], seed| {
        let robot = |(name, kind, address): &(&str, &str, Option<&str>)| Participant {
            name: (*name).into(),
            kind: (*kind).into(),
            address: address.map(Into::into),
        };
        let venue = Venue { name: "depot".into(), robots: robots.iter().map(robot).collect(), seed, ..Venue::default() };
        let threshold = Celsius::new(25.0).expect("a temperature");
        let facts = [Fact::Conditions(Conditions { venue, threshold, rules: Rules::default() }), Fact::Phase(Phase::BagSecured)];
        Mission::of(facts.map(|fact| Entry { fact, ..command("anna", "x") }).to_vec())
    };
    let simulated = mission(&[("discovery", "sim", None), ("srm1", "sim", None)], Some(7));
    for (mission, outcome, robots) in [
        (
            &simulated,
            "The bomb was fetched and secured · 4 known places not searched · simulated</p>",
            "discovery (simulated) and srm1 (simulated); seed 7",
        ),
        (
            &mission(&[("discovery", "virtual-tcp", Some("localhost:8999"))], None),
            " · virtual robot</p>",
            "discovery (virtual robot, localhost:8999)",
        ),
        (
            &mission(&[("discovery", "line", Some("/dev/ttyUSB0"))], None),
            " · line robot</p>",
            "discovery (line robot, /dev/ttyUSB0)",
        ),
        (&mission(&[], None), " · not on record whether simulated</p>", "not on record"),
    ] {
        let page = mission.report(Language::English);
        assert!(page.contains(outcome) && page.contains(&format!("<dt>Robots</dt><dd>{robots}</dd>")), "{robots}: {page}");
        assert_eq!(mission.confirms(&page), Ok(()));
    }
    let italian = simulated.report(Language::Italian);
    assert!(
        italian.contains(" · 4 posti noti non esplorati · simulato</p>")
            && italian.contains("discovery (simulato) e srm1 (simulato); seme 7"),
        "{italian}"
    );
    let earlier = simulated.report_of(1, Language::English);
    assert!(earlier.contains("The bomb was fetched and secured</p>") && !earlier.contains("simulated"), "edition 1 says it so");
}

#[test]
fn a_temperature_that_stays_is_a_level_line_until_it_is_not_known_any_more_and_none_where_nothing_was_read() {
    let at = |second: i64, fact| {
        let began = command("anna", "x").wall;
        Entry { wall: WallTime { unix_ms: began.unix_ms + second * 1000, ..began }, fact }
    };
    let read = || at(0, Fact::Temperature("robot".into(), Celsius::new(21.5).expect("a temperature")));
    let end = || at(719, command("anna", "x").fact);
    let silent = || at(300, Fact::ThermometerSilent("robot".into()));
    for (entries, said, points) in [
        (vec![read(), end()], "<dd>constant 21.5 °C</dd>", "points=\"0,75.0 719,75.0 \""),
        (
            vec![read(), silent(), at(400, Fact::Holds(vec![Hold::RobotLink])), end()],
            "<dd>constant 21.5 °C</dd>",
            "points=\"0,75.0 300,75.0 \"",
        ),
        (vec![silent(), end()], "No reading is on record.", ""),
    ] {
        let mission = Mission::of(entries);
        let page = mission.report(Language::English);
        assert!(page.contains(said) && page.contains(points), "{said}: {page}");
        assert_eq!(mission.confirms(&page), Ok(()));
    }
    let earlier = Mission::of(vec![read(), end()]).report_of(1, Language::English);
    assert!(earlier.contains("points=\"0,75.0 \"") && !earlier.contains("constant"), "edition 1 has it so: {earlier}");
}

fn found() -> Entry {
    piece(1, 3)
}

/// The entry of a piece that was photographed once. The photo has this number of bytes.
fn piece(id: u64, bytes: usize) -> Entry {
    let record = Luggage {
        id: LuggageId(id),
        cell: Cell::new(0, 1),
        pose: Pose::START,
        taken: WallTime::default(),
        first_taken: WallTime::default(),
        photo: PhotoState::Taken { bytes, take: 1 },
        verdict: None,
        seen_from: Vec::new(),
        unsure: Vec::new(),
        judged: Vec::new(),
        truth: None,
        piece: None,
        secured: None,
        clock_set_ms: 0,
    };
    Entry { fact: Fact::Luggage { record: record.into(), photo: None }, ..command("anna", "x") }
}

#[test]
fn a_piece_was_found_when_it_was_first_photographed_however_often_it_is_photographed() {
    let mut found = piece(1, 3);
    if let Fact::Luggage { record, .. } = &mut found.fact {
        Arc::make_mut(record).taken = WallTime { unix_ms: 3_723_000, offset_s: 0 };
    }
    let mission = Mission::of(vec![found]);
    let found = |page: String| {
        let (_, rest) = page.split_once("<dt>Found</dt><dd>").expect("it says when");
        rest.split_once("</dd>").expect("that is closed").0.to_owned()
    };
    assert_eq!(found(mission.report(Language::English)), "1 Jan 1970, 01:00:00");
    assert_eq!(found(mission.report_of(1, Language::English)), "1 Jan 1970, 02:02:03", "edition 1 has it so");
}

#[test]
fn a_record_that_counts_billions_of_photos_is_a_report_of_the_latest() {
    for (take, photos) in [(3, 3), (1002, 1), (u32::MAX, 0)] {
        let mut found = piece(1, 3);
        if let Fact::Luggage { record, .. } = &mut found.fact {
            Arc::make_mut(record).photo = PhotoState::Taken { bytes: 3, take };
        }
        let page = Mission::of(vec![found]).report(Language::English);
        assert_eq!(page.matches("<img").count(), photos, "the first three are kept");
    }
}

#[test]
fn a_photo_that_is_lost_is_said_to_be_so_and_one_that_cannot_be_read_just_now_makes_no_report() {
    let with = |photo| Mission { photo: Err(photo), ..Mission::of(vec![found()]) };
    let words = "look after data-of-anna".to_owned();
    for (language, said) in [
        (Language::English, "<p class=\"missing\">Photo 1 is lost: its file is missing, or is not the one on record.</p>"),
        (Language::Italian, "<p class=\"missing\">La foto 1 è perduta: il suo file manca, o non è quello registrato.</p>"),
    ] {
        let page = with(NoTake::Spoilt(words.clone())).report(language);
        assert!(page.contains(said) && !page.contains("data-of-anna"), "{page}");
        let mission = with(NoTake::Unreadable(Unreadable(words.clone())));
        let report = Report::new(&mission, MISSION, language).unwrap().expect("there are entries");
        assert!(matches!(report.write(&mut Vec::new()), Err(Failure::Unreadable(Unreadable(why))) if why == words));
    }
}

fn photographed(pieces: u64, seed: u32) -> Mission {
    let photo: &[u8] = png(&noise(seed), (160, 120), png::ColorType::Rgb, png::BitDepth::Eight).leak();
    Mission { photo: Ok(photo), ..Mission::of((1..=pieces).map(|id| piece(id, photo.len())).collect()) }
}

#[test]
fn the_photos_of_a_report_of_770_pieces_are_scaled_down_and_it_is_confirmed() {
    let mission = photographed(770, 1);
    let page = mission.report(Language::English);
    assert!(page.len() < 10_000_000, "{} bytes", page.len());
    assert_eq!(page.matches("src=\"data:image/jpeg;base64,").count(), 770);
    let original = hex(&Sha256::digest(mission.photo.as_ref().unwrap()));
    assert_eq!(page.matches(&*original).count(), 770, "the digest of the original, with each piece");
    assert!(page.contains("Photos are scaled down here") && page.contains("/api/v1/luggage/NUMBER/photo?take=PHOTO"));
    assert_eq!(mission.confirms(&page), Ok(()));
    let (before, photo) = page.split_once("data:image/jpeg;base64,").unwrap();
    let other = format!("{before}data:image/jpeg;base64,{}", photo.replacen('A', "B", 1));
    assert!(mission.confirms(&other).is_err(), "another scaled photo");
    assert!(photographed(770, 2).confirms(&page).is_err(), "another original");
}

#[test]
fn a_small_report_has_its_photos_whole_and_one_that_cannot_be_scaled_is_named() {
    let page = photographed(9, 1).report(Language::English);
    assert_eq!(page.matches("src=\"data:image/png;base64,").count(), 9);
    assert!(!page.contains("scaled down"), "{page}");
    // The record says that the photo is large, but the bytes cannot be decoded as a photo.
    let none: &[u8] = vec![0; 7 << 20].leak();
    let mission = Mission { photo: Ok(none), ..Mission::of(vec![piece(1, none.len())]) };
    let digest = hex(&Sha256::digest(none));
    for (language, said) in
        [(Language::English, "Photo 1 is not shown here"), (Language::Italian, "La foto 1 non è mostrata qui")]
    {
        let page = mission.report(language);
        assert!(page.contains(said) && page.contains(&digest) && page.len() < 100_000, "{page}");
        assert_eq!(mission.confirms(&page), Ok(()));
    }
    assert!(mission.report_of(1, Language::English).len() > none.len(), "as edition 1 has it");
}

#[test]
fn what_cannot_be_understood_is_said_once_wherever_it_stands() {
    let damage = ["a mouse was at it", "entry 9 of the journal cannot be understood"].map(str::to_owned).to_vec();
    let sound = Mission { damage: damage.clone(), ..Mission::of(vec![found()]) }.report(Language::English);
    assert!(sound.contains("What is missing here") && sound.contains(&format!("<li>{}</li>\n<li>{}</li>", damage[0], damage[1])));
    let entries = vec![found(), found(), found()];
    let damaged = Mission { damage, ..Mission::of(entries.clone()) }.report(Language::English);
    assert_eq!((damaged.matches("<li>a mouse").count(), damaged.matches("<li>entry 9").count()), (1, 1), "{damaged}");
    assert!(Mission::of(entries).report(Language::English).contains("<li>a mouse was at it</li>"));
    assert!(!Mission::of(vec![found()]).report(Language::English).contains("What is missing here"));
}

/// Safety V3: lost entries are in no report. The next start deletes these entries.
#[test]
fn what_was_said_to_be_lost_is_in_no_report_and_in_no_list() {
    let entries = vec![command("anna", "START"), command("anna", "STOP"), found(), command("bruno", "START")];
    let mission = Mission { lost_after: Some(Seq(2)), ..Mission::of(entries.clone()) };
    let page = mission.report(Language::English);
    let claim = Claim::read(page.as_bytes()).unwrap();
    assert_eq!(claim.until, Seq(2));
    let (mut lines, mut table) = (Vec::new(), Vec::new());
    list::write_lines(&mission, MISSION, &mut lines).unwrap();
    list::write_table(&mission, MISSION, Language::English, &mut table).unwrap();
    let (lines, table) = (String::from_utf8(lines).unwrap(), String::from_utf8(table).unwrap());
    assert_eq!((lines.lines().count(), table.lines().count()), (2, 3));
    assert!(!page.contains("bruno") && !lines.contains("bruno") && !table.contains("bruno"));
    assert!(Report::again(&mission, claim).unwrap().is_some());
    let whole = Claim::read(Mission::of(entries).report(Language::English).as_bytes()).unwrap();
    assert!(whole.until == Seq(4) && Report::again(&mission, whole).unwrap().is_none(), "made before that was said");
}

#[test]
fn what_a_mission_took_is_what_each_run_measured_where_the_clock_was_set() {
    let at = |ms: i64, fact: Option<Fact>| {
        let entry = command("anna", "x");
        Entry { wall: entry.wall.set_by(ms), fact: fact.unwrap_or(entry.fact) }
    };
    let started = || Some(Fact::ProgramStarted("1".to_owned()));
    let by_clock = vec![at(0, None), at(10_000, None), at(10_000, None), at(45_000, started()), at(50_000, None)];
    let page = Mission::of(by_clock).report(Language::English);
    assert!(page.contains("<dt>Took (h:mm:ss)</dt><dd>0:00:50</dd>") && !page.contains("The clock was changed"), "{page}");
    let set = vec![
        at(0, None),
        at(10_000, None),
        // Entry 3, which cannot be read in this test.
        at(10_000, None),
        at(-3_589_000, Some(Fact::ClockSet(-3_600_000))),
        at(-3_580_000, None),
        // This entry was written late, with a time from before the change of the clock. The time counts only once.
        at(-3_585_000, None),
        at(50_000_000, started()),
        at(50_005_000, None),
    ];
    let page = Mission::of(set).report(Language::English);
    assert!(page.contains("<dt>Took (h:mm:ss)</dt><dd>0:00:25</dd>"), "{page}");
    assert!(page.contains("<dt>The clock was changed</dt><dd>1 ×"), "{page}");
}

/// Nothing waits for *close*. A report says whether it came, also after START has put the mission away.
#[test]
fn a_report_says_who_has_closed_the_mission_and_in_how_many_pieces_nothing_was_found() {
    let at_noon = |fact| Entry { wall: WallTime::default(), fact };
    let pages = |entries: Vec<Entry>| Language::ALL.map(|language| Mission::of(entries.clone()).report(language));
    let began = || at_noon(Fact::MissionBegan(MISSION, Strategy::default()));
    let [english, italian] = pages(vec![began()]);
    assert!(english.contains("not closed") && english.contains("No piece was judged."), "{english}");
    assert!(italian.contains("non chiusa") && italian.contains("Nessun bagaglio è stato giudicato."));
    let (name, note) = (Note::new("Anna <Rossi>").unwrap(), Note::new("handed over"));
    let open = OpenPoints { unvisited: 12, ..OpenPoints::default() };
    let closed = Closed { who: "anna".into(), name, note, open, wall: WallTime::default() };
    let verdict = Fact::Verdict {
        luggage: LuggageId(1),
        verdict: hallsweep_core::command::Verdict::Safe,
        who: "anna".into(),
        note: None,
        hot: Default::default(),
    };
    let [english, italian] = pages(vec![began(), piece(1, 9), at_noon(verdict), at_noon(Fact::Closed(Box::new(closed)))]);
    let row = "mission closed by Anna &#60;Rossi&#62;, key anna (note: handed over); open points: cells never visited: 12</dd>";
    assert!(english.contains(row) && english.contains("No device was found in 1 judged piece."), "{english}");
    assert!(italian.contains("missione chiusa da Anna &#60;Rossi&#62;, chiave anna"));
}

#[test]
fn a_report_begins_as_a_document_and_ends_with_lines_to_sign_on_and_its_evidence() {
    let mission = Mission::of(vec![command("anna", "x"), command("anna", "y")]);
    for (language, begins, signed) in [
        (Language::English, "<span>Search of an evacuated hall by robots</span>", "<h3>Received by</h3>"),
        (Language::Italian, "<span>Ispezione robotizzata di una sala evacuata</span>", "<h3>Ricevuto da</h3>"),
    ] {
        let page = mission.report(language);
        let at = |words: &str| page.find(words).unwrap_or_else(|| panic!("{words} in {page}"));
        assert!(at(begins) < at("<section>") && at(signed) < at("<section class=\"evidence\">"));
        assert_eq!(page.matches("class=\"signatures\"").count(), 1);
        assert_eq!(mission.confirms(&page), Ok(()));
        assert!(!mission.report_of(2, language).contains(signed), "edition 2 has no such lines");
    }
}
