//! Tests the published messages while the state changes.

use serde_json::Value;

use super::*;
use crate::api::coverage::CoverageJson;
use crate::api::log::LogLineJson;
use crate::api::resources::ResourceKind;
use crate::api::state::StateJson;
use crate::api::tests::fixture::{idle, piece, searching, touch, write};
use crate::doors::mqtt::topics::TopicKind;
use hallsweep_core::command::Verdict;
use hallsweep_core::hall::HallId;
use hallsweep_core::robot::RobotState;
use hallsweep_core::snapshot::log::Tone;
use hallsweep_core::units::{Cell, LuggageId, Revision, WallTime};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_core::world::luggage::{Luggage, PhotoState};

mod numbers;

fn topics() -> Topics {
    Topics::new("hallsweep", "discovery", "unibo/qak")
}

/// The old topics belong to the default hall.
#[test]
fn a_further_hall_publishes_below_its_own_base_and_nothing_for_old_clients() {
    let topics = Topics::of_further("hallsweep/halls", &HallId::new("south").unwrap());
    let (mut feed, mut snapshot) = (ChangeFeed::new(topics.clone(), true), searching());
    let first = show(&mut feed, &snapshot, ms(0));
    touch(&mut snapshot, 9, &Resource::ALL);
    snapshot.robot.pose.cell.x += 1;
    feed.renew(2);
    let all = first.into_iter().chain(show(&mut feed, &snapshot, ms(1000)));
    let others: Vec<_> = all.filter(|said| !said.topic.starts_with("hallsweep/halls/south/")).map(|said| said.topic).collect();
    assert!(!others.is_empty() && others.iter().all(|topic| *topic == topics.discovery()), "{others:?}");
}

fn feed() -> ChangeFeed {
    ChangeFeed::new(topics(), false)
}

const fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

fn all(feed: &mut ChangeFeed, now: Duration) -> Vec<Publication> {
    std::iter::from_fn(|| feed.poll_publication(now)).collect()
}

fn show(feed: &mut ChangeFeed, snapshot: &Snapshot, now: Duration) -> Vec<Publication> {
    feed.handle_state(Arc::new(snapshot.clone()));
    all(feed, now)
}

fn names(publications: &[Publication]) -> Vec<&str> {
    let short = |publication: &'_ Publication| publication.topic.rsplit_once('/').map_or(0, |(above, _)| above.len() + 1);
    publications.iter().map(|publication| &publication.topic[short(publication)..]).collect()
}

fn on<'a>(publications: &'a [Publication], topic: &str) -> Vec<&'a str> {
    let of_topic = publications.iter().filter(|publication| publication.topic == topic);
    of_topic.map(|publication| std::str::from_utf8(&publication.payload).unwrap()).collect()
}

fn old(publications: &[Publication]) -> Vec<String> {
    let content = |message: &str| {
        let rest = message.strip_prefix("msg(modelContent,event,resourcemodel,none,content(").expect("the head of the message");
        rest.rsplit_once("),").expect("its number").0.to_owned()
    };
    on(publications, "unibo/qak/events").into_iter().map(content).collect()
}

fn numbers(publications: &[Publication]) -> Vec<u64> {
    let number = |message: &str| message.rsplit_once(',').unwrap().1.trim_end_matches(')').parse().unwrap();
    on(publications, "unibo/qak/events").into_iter().map(number).collect()
}

fn json(publications: &[Publication], topic: &str) -> Value {
    serde_json::from_str(on(publications, topic).last().expect("something on the topic")).unwrap()
}

/// A piece with this number. Its photo was taken `seconds` seconds after ten o'clock.
fn found(id: u64, seconds: i64) -> Arc<Luggage> {
    let mut luggage = Luggage::clone(&piece(id, Cell::new(1, 2), None));
    luggage.taken = WallTime { unix_ms: luggage.taken.unix_ms + seconds * 1000, ..luggage.taken };
    Arc::new(luggage)
}

fn put(snapshot: &mut Snapshot, luggage: Arc<Luggage>) {
    let mut all: Vec<Arc<Luggage>> = snapshot.luggage.iter().filter(|other| other.id != luggage.id).cloned().collect();
    all.push(luggage);
    all.sort_by_key(|piece| piece.id);
    snapshot.luggage = all.into_iter().collect();
    let revision = snapshot.revision.0 + 1;
    touch(snapshot, revision, &[Resource::Luggage]);
}

fn step(snapshot: &mut Snapshot) {
    let (revision, cell) = (snapshot.revision.0 + 1, snapshot.robot.pose.cell);
    snapshot.robot.pose.cell = Cell::new(cell.x + 1, cell.y);
    snapshot.map.mark(snapshot.robot.pose.cell, Mark::Visited, snapshot.revision.next());
    touch(snapshot, revision, &[Resource::Robot, Resource::Map]);
}

#[test]
fn before_the_first_state_there_is_nothing_to_say() {
    let mut feed = feed();
    assert_eq!((feed.poll_publication(ms(0)), feed.poll_timeout()), (None, None));
}

#[test]
fn at_first_everything_is_said_once_beginning_with_being_there() {
    let mut feed = feed();
    let said = show(&mut feed, &searching(), ms(0));
    assert_eq!(said[0], Publication::kept("hallsweep/discovery/availability".to_owned(), "online"));
    let expected = [
        "availability",
        "events",
        "events",
        "events",
        "event",
        "event",
        "event",
        "mission",
        "robot",
        "map",
        "coverage",
        "luggage",
        "temperature",
        "alarms",
        "retrieval",
        "log",
    ];
    assert_eq!(names(&said), expected);
    assert_eq!((all(&mut feed, ms(60_000)), feed.poll_timeout()), (Vec::new(), None));
}

#[test]
fn what_a_broker_keeps_and_what_passes_is_told_apart() {
    for publication in show(&mut feed(), &searching(), ms(0)) {
        let is_passing = ["/event", "/events"].iter().any(|end| publication.topic.ends_with(end));
        assert_eq!(publication.retain, !is_passing, "{}", publication.topic);
    }
}

#[test]
fn nothing_is_said_where_others_may_speak_but_for_the_old_words() {
    let mut feed = ChangeFeed::new(topics(), true);
    let mut said = show(&mut feed, &searching(), ms(0));
    let picture = feed.poll_photo().unwrap();
    assert!(feed.handle_photo(picture, photo(4)));
    said.extend(all(&mut feed, ms(0)));
    for publication in said {
        let kind = if feed.is_numbered(&publication) { TopicKind::Old } else { TopicKind::Ours };
        assert_eq!(topics().kind_of(&publication.topic), kind, "{}", publication.topic);
    }
}

#[test]
fn every_resource_shows_what_the_http_door_shows_at_the_same_revision() {
    for state in [idle(), searching()] {
        let said = show(&mut feed(), &state, ms(0));
        let whole = serde_json::to_value(StateJson::from(&state)).unwrap();
        // The whole state leaves the coverage out, because all cells are counted for it.
        let coverage: Value = serde_json::to_value(CoverageJson::new(&state, state.revision)).unwrap();
        assert_eq!(json(&said, &topics().state(Resource::Coverage)), coverage);
        for resource in Resource::ALL.into_iter().filter(|resource| *resource != Resource::Coverage) {
            assert_eq!(json(&said, &topics().state(resource)), whole[ResourceKind::Of(resource).row().name], "{resource:?}");
        }
    }
}

#[test]
fn only_what_changed_is_said_and_a_map_changes_with_its_robot() {
    let (mut feed, mut state) = (feed(), searching());
    show(&mut feed, &state, ms(0));
    touch(&mut state, 21, &[Resource::Temperature]);
    assert_eq!(names(&show(&mut feed, &state, ms(1000))), ["temperature"]);
    touch(&mut state, 22, &[Resource::Robot]);
    assert_eq!(names(&show(&mut feed, &state, ms(2000))), ["robot", "map", "coverage"]);
}

#[test]
fn a_hasty_resource_is_said_ten_times_a_second_and_the_newest_last() {
    let (mut feed, mut state) = (feed(), searching());
    show(&mut feed, &state, ms(0));
    let mut said = Vec::new();
    for tick in 1..=200_u32 {
        state.temperature.celsius = Some(crate::api::tests::fixture::degrees(20.0 + f64::from(tick) / 100.0));
        touch(&mut state, 20 + u64::from(tick), &[Resource::Temperature]);
        said.extend(show(&mut feed, &state, ms(u64::from(tick) * 5)));
    }
    assert_eq!(said.len(), 10);
    touch(&mut state, 300, &[Resource::Temperature]);
    state.temperature.celsius = None;
    assert_eq!(show(&mut feed, &state, ms(1001)), []);
    assert_eq!(feed.poll_timeout(), Some(ms(1100)));
    assert_eq!(json(&all(&mut feed, ms(1100)), "hallsweep/discovery/state/temperature")["celsius"], Value::Null);
}

/// Simulates a robot that takes a step every 10 ms for ten seconds, in a square hall with `side` cells a side.
/// Returns how many bytes about the map were published; each message contains the whole map.
fn said_of_maps(side: i32) -> usize {
    let (mut feed, mut state) = (feed(), searching());
    for cell in (0..side).flat_map(|y| (0..side).map(move |x| Cell::new(x, y))) {
        state.map.mark(cell, Mark::Visited, Revision(20));
    }
    show(&mut feed, &state, ms(0));
    let mut bytes = 0;
    for tick in 1..=1000 {
        state.robot.pose.cell = Cell::new(i32::try_from(tick % 2).unwrap(), 0);
        touch(&mut state, 20 + tick, &[Resource::Robot, Resource::Map]);
        let said = show(&mut feed, &state, ms(10 * tick));
        let is_map = |said: &&Publication| said.topic.ends_with("/map") || said.payload.starts_with(MAP.as_bytes());
        bytes += said.iter().filter(is_map).map(|map| map.payload.len()).sum::<usize>();
    }
    bytes
}

const MAP: &str = "msg(modelContent,event,resourcemodel,none,content(roomMap(";

#[test]
fn a_map_is_said_the_more_seldom_the_larger_it_is_and_at_last_as_it_is() {
    let (middling, large) = (said_of_maps(300), said_of_maps(600));
    assert!(large < middling + middling / 5, "{middling} bytes, then {large}");
    let (mut feed, mut state) = (feed(), searching());
    state.map.mark(Cell::new(1000, 1000), Mark::Visited, Revision(20));
    show(&mut feed, &state, ms(0));
    step(&mut state);
    assert_eq!(names(&show(&mut feed, &state, ms(200))), ["events", "robot"], "the robot is said at once");
    assert!(feed.poll_timeout().is_some_and(|due| due > ms(900)));
    assert_eq!(names(&all(&mut feed, ms(60_000))), ["coverage", "map", "events"]);
    assert_eq!(feed.poll_timeout(), None);
}

#[test]
fn of_luggage_without_end_what_waits_is_said_still_and_how_many_there_are() {
    let (mut feed, mut state) = (feed(), searching());
    state.luggage = (1..=9000).map(|id| piece(id, Cell::new(1, 2), (id != 2).then_some(Verdict::Safe))).collect();
    let said = show(&mut feed, &state, ms(0));
    let luggage = json(&said, "hallsweep/discovery/state/luggage");
    assert_eq!((&luggage["pieces"], &luggage["pending"], &luggage["luggage"][0]["id"]), (&9000.into(), &1.into(), &2.into()));
    assert!(said.iter().all(|publication| publication.payload.len() < 200_000));
}

#[test]
fn every_line_of_the_log_is_said_once_and_in_order() {
    let (mut feed, mut state) = (feed(), searching());
    let mut lines = on(&show(&mut feed, &state, ms(0)), "hallsweep/discovery/event").join("\n");
    for text in ["a", "b", "c"] {
        write(&mut state, Tone::Warning, text);
        write(&mut state, Tone::Info, text);
        touch(&mut state, 21, &[Resource::Log]);
        lines += "\n";
        lines += &on(&show(&mut feed, &state, ms(1)), "hallsweep/discovery/event").join("\n");
    }
    let expected: Vec<String> =
        state.log.iter().map(|line| serde_json::to_string(&LogLineJson::from(&**line)).unwrap()).collect();
    assert_eq!(lines.lines().collect::<Vec<_>>(), expected);
}

#[test]
fn lines_that_are_no_longer_at_hand_show_as_a_gap() {
    let (mut feed, mut state) = (feed(), searching());
    show(&mut feed, &state, ms(0));
    for text in ["lost", "kept", "kept, too"] {
        write(&mut state, Tone::Info, text);
    }
    state.log = state.log[4..].into();
    let said = show(&mut feed, &state, ms(1));
    let lines = on(&said, "hallsweep/discovery/event").into_iter().map(|line| serde_json::from_str::<Value>(line).unwrap());
    assert_eq!(lines.map(|line| line["number"].as_u64().unwrap()).collect::<Vec<_>>(), [5, 6]);
}

#[test]
fn old_listeners_hear_of_robot_map_and_luggage_in_this_order() {
    let (mut feed, mut state) = (feed(), idle());
    assert_eq!(
        old(&show(&mut feed, &state, ms(0))),
        ["robot(state(stopped),direction(downDir),position(0,0))", "roomMap(state('r @'))"]
    );
    put(&mut state, found(1, 0));
    step(&mut state);
    state.robot.state = RobotState::MovingForward;
    let said = show(&mut feed, &state, ms(100));
    assert_eq!(
        old(&said),
        [
            "robot(state(movingForward),direction(downDir),position(1,0))",
            "roomMap(state('1 r @'))",
            "luggage(state('photo 1, position: (1, 2), date: 2026-02-03T10:00:00.000+01:00'))",
        ]
    );
    assert_eq!(numbers(&said), [3, 4, 5]);
}

#[test]
fn what_an_old_item_does_not_show_makes_no_old_message() {
    let (mut feed, mut state) = (feed(), searching());
    show(&mut feed, &state, ms(0));
    state.robot.sonar_cm = Some(7);
    let decided = Luggage { verdict: piece(3, Cell::HOME, Some(Verdict::Safe)).verdict.clone(), ..(*state.luggage[2]).clone() };
    put(&mut state, Arc::new(decided));
    touch(&mut state, 30, &[Resource::Robot]);
    assert_eq!(old(&show(&mut feed, &state, ms(1000))), Vec::<String>::new());
}

#[test]
fn old_listeners_hear_of_the_robot_every_20_ms_and_of_all_luggage() {
    let (mut feed, mut state) = (feed(), idle());
    show(&mut feed, &state, ms(0));
    let mut said = Vec::new();
    for tick in 1..=100 {
        step(&mut state);
        put(&mut state, found(tick, 0));
        said.extend(show(&mut feed, &state, ms(tick)));
    }
    let contents = old(&said);
    let of = |name: &str| contents.iter().filter(|content| content.starts_with(name)).count();
    assert_eq!((of("robot"), of("roomMap"), of("luggage")), (5, 5, 100));
    assert_eq!(numbers(&said), (3..113).collect::<Vec<u64>>());
}

#[test]
fn a_piece_that_is_gone_before_it_was_said_is_said_all_the_same() {
    let (mut feed, mut state) = (feed(), idle());
    show(&mut feed, &state, ms(0));
    put(&mut state, found(1, 0));
    feed.handle_state(Arc::new(state.clone()));
    put(&mut state, found(1, 9));
    feed.handle_state(Arc::new(state.clone()));
    state.luggage = Default::default();
    touch(&mut state, 40, &[Resource::Luggage]);
    let said = old(&show(&mut feed, &state, ms(100)));
    assert_eq!(said, ["luggage(state('photo 1, position: (1, 2), date: 2026-02-03T10:00:09.000+01:00'))"]);
}

#[test]
fn of_a_mission_that_stands_already_only_the_piece_in_question_is_news() {
    let said = old(&show(&mut feed(), &searching(), ms(0)));
    assert_eq!(said.iter().filter(|content| content.contains("photo")).count(), 1);
    assert!(said[2].contains("photo 3,"), "{said:?}");
}

#[test]
fn on_a_new_connection_what_is_kept_and_the_newest_old_items_are_said_again_but_no_event() {
    let mut feed = feed();
    let first = show(&mut feed, &searching(), ms(0));
    feed.renew(0);
    let again = all(&mut feed, ms(1000));
    let expected: Vec<&Publication> = first.iter().filter(|publication| !publication.topic.ends_with("/event")).collect();
    assert_eq!(names(&again), names(&expected.into_iter().cloned().collect::<Vec<_>>()));
    assert_eq!((old(&again), numbers(&again)), (old(&first), vec![4, 5, 6]));
}

#[test]
fn old_messages_that_were_not_acknowledged_are_numbered_anew_and_their_luggage_is_said_again() {
    let (mut feed, mut state) = (feed(), idle());
    show(&mut feed, &state, ms(0));
    for id in 1..=3 {
        put(&mut state, found(id, 0));
    }
    assert_eq!(numbers(&show(&mut feed, &state, ms(100))), [3, 4, 5]);
    feed.renew(2);
    let again = all(&mut feed, ms(200));
    assert_eq!(numbers(&again), [4, 5, 6, 7, 8]);
    let contents = old(&again);
    let photos: Vec<&str> = contents.iter().filter_map(|content| content.split_once("photo ")?.1.split(',').next()).collect();
    assert_eq!(photos, ["2", "3", "1"], "the two that may be lost, and the one that waits for its verdict");
    feed.renew(u64::MAX);
    assert_eq!(numbers(&all(&mut feed, ms(300)))[0], 1);
}

#[test]
fn a_slow_line_says_everything_in_its_turn() {
    let (mut feed, mut state) = (feed(), searching());
    show(&mut feed, &state, ms(0));
    let mut said = Vec::new();
    for tick in 1..=200 {
        step(&mut state);
        write(&mut state, Tone::Info, "a step");
        let revision = state.revision.0;
        touch(&mut state, revision, &Resource::ALL);
        feed.handle_state(Arc::new(state.clone()));
        said.extend((0..2).filter_map(|_| feed.poll_publication(ms(tick * 10))));
    }
    for resource in Resource::ALL {
        let times = on(&said, &topics().state(resource)).len();
        assert!(times >= 5, "{resource:?} only {times} times in two seconds");
    }
}

fn photo(bytes: usize) -> Photo {
    Photo { bytes: vec![7; bytes].into(), media_type: "image/png" }
}

fn picture(luggage: u64, take: u32) -> Picture {
    Picture { luggage: LuggageId(luggage), take }
}

#[test]
fn home_assistant_is_told_only_when_it_is_wished() {
    let (mut without, mut with) = (feed(), ChangeFeed::new(topics(), true));
    let plain = show(&mut without, &searching(), ms(0));
    assert_eq!(without.poll_photo(), None);
    assert!(!without.handle_photo(picture(3, 1), photo(4)));
    let more = show(&mut with, &searching(), ms(0));
    let added: Vec<&Publication> = more.iter().filter(|publication| !plain.contains(publication)).collect();
    assert_eq!(
        added.iter().map(|publication| publication.topic.as_str()).collect::<Vec<_>>(),
        ["homeassistant/device/discovery/config", "hallsweep/discovery/homeassistant"]
    );
    assert!(added.iter().all(|publication| publication.retain));
}

#[test]
fn home_assistant_is_told_of_the_robot_again_when_it_starts() {
    let mut feed = ChangeFeed::new(topics(), true);
    show(&mut feed, &searching(), ms(0));
    feed.handle_birth();
    assert_eq!(names(&all(&mut feed, ms(1))), ["config"]);
}

#[test]
fn the_state_of_the_vacuum_is_said_when_it_is_another_one() {
    let (mut feed, mut state) = (ChangeFeed::new(topics(), true), idle());
    let said = show(&mut feed, &state, ms(0));
    assert_eq!(json(&said, "hallsweep/discovery/homeassistant")["state"], "docked");
    touch(&mut state, 2, &[Resource::Mission]);
    assert_eq!(names(&show(&mut feed, &state, ms(200))), ["mission", "coverage"]);
    state.mission.phase = hallsweep_core::phase::PhaseName::Exploring;
    touch(&mut state, 3, &[Resource::Mission]);
    let said = show(&mut feed, &state, ms(400));
    assert_eq!(json(&said, "hallsweep/discovery/homeassistant")["state"], "cleaning");
}

#[test]
fn the_last_photo_is_asked_for_once_and_goes_out_when_it_is_given() {
    let (mut feed, mut state) = (ChangeFeed::new(topics(), true), searching());
    show(&mut feed, &state, ms(0));
    assert_eq!((feed.poll_photo(), feed.poll_photo()), (Some(picture(3, 1)), None));
    assert!(feed.handle_photo(picture(3, 1), photo(4)));
    assert_eq!(all(&mut feed, ms(1)), [Publication::kept("hallsweep/discovery/photo".to_owned(), vec![7; 4])]);
    let retaken = Luggage { photo: PhotoState::Taken { bytes: 4, take: 2 }, ..(*state.luggage[0]).clone() };
    put(&mut state, Arc::new(retaken));
    show(&mut feed, &state, ms(200));
    assert_eq!(feed.poll_photo(), Some(picture(1, 2)), "the one that was taken last, not the one of the last piece");
    put(&mut state, found(4, 0));
    show(&mut feed, &state, ms(400));
    assert!(!feed.handle_photo(picture(1, 2), photo(4)), "there is a newer one");
    assert_eq!(feed.poll_photo(), Some(picture(4, 1)));
}

#[test]
fn a_photo_that_failed_or_is_too_large_is_not_shown() {
    let (mut feed, mut state) = (ChangeFeed::new(topics(), true), idle());
    let failed = Luggage { photo: PhotoState::Failed("lens covered".to_owned()), ..(*found(1, 0)).clone() };
    put(&mut state, Arc::new(failed));
    show(&mut feed, &state, ms(0));
    assert_eq!(feed.poll_photo(), None);
    put(&mut state, found(2, 0));
    show(&mut feed, &state, ms(200));
    let asked = feed.poll_photo().unwrap();
    assert!(!feed.handle_photo(asked, photo(PHOTO_MOST + 1)));
    assert_eq!(all(&mut feed, ms(400)), []);
}

#[test]
fn on_a_new_connection_the_photo_is_said_again_or_asked_for_again() {
    let mut feed = ChangeFeed::new(topics(), true);
    show(&mut feed, &searching(), ms(0));
    let asked = feed.poll_photo().unwrap();
    feed.renew(0);
    assert_eq!(feed.poll_photo(), Some(asked), "it was never given back");
    assert!(feed.handle_photo(asked, photo(4)));
    all(&mut feed, ms(200));
    feed.renew(0);
    assert_eq!(feed.poll_photo(), None);
    assert!(names(&all(&mut feed, ms(400))).contains(&"photo"));
}
