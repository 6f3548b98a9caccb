//! Mission §15: a person orders the areas of the hall, closes them one by one, and has one searched again.

use std::sync::Arc;

use hallsweep_core::closing::{AreaClosing, OpenInArea};
use hallsweep_core::command::{Again, Command, Note, Verdict};
use hallsweep_core::engine::Engine;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::state::Venue;
use hallsweep_core::units::{Cell, MissionId, Now};
use hallsweep_core::world::areas::Area;
use hallsweep_core::world::hall_map::Bounds;
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::mortal::Mortal;
use crate::operator::{Operator, in_drawn};

const ROWS: [&str; 4] = ["S.....", "......", ".....a", "......"];

fn area(name: &str, probability: f64, least: (i32, i32), most: (i32, i32)) -> Area {
    let corners = [Cell::new(least.0, least.1), Cell::new(most.0, most.1)].into();
    Area { name: name.into(), probability, corners }
}

/// Two areas, in the west and in the east of the drawn hall.
pub(crate) fn note_areas(engine: &mut Engine, now: Now) {
    let areas = [area("west", 0.2, (0, 0), (2, 3)), area("east", 0.7, (4, 0), (5, 3))];
    engine.note_venue(Venue { name: "drawn".into(), areas: areas.into(), ..Venue::default() }, now);
}

fn with_areas() -> Run {
    let mut run = in_drawn(&ROWS);
    let now = run.now();
    note_areas(&mut run.engine, now);
    run
}

fn order(names: &[&str]) -> Command {
    Command::OrderAreas(names.iter().map(|name| Arc::from(*name)).collect())
}

fn close(area: &str, mission: Option<u64>) -> Command {
    let (name, note) = (Note::new("Rossi").unwrap(), Note::new("dogs were there"));
    Command::CloseArea(AreaClosing { area: area.into(), name, note, mission: mission.map(MissionId) })
}

fn again(area: &str) -> Command {
    Command::SearchAgain(Again::Area(area.into()))
}

/// Places in the order, and whether the area is closed, of west and east.
fn shown(run: &mut Run) -> [(Option<usize>, bool); 2] {
    let areas = run.state().mission.areas.clone();
    [0, 1].map(|n| (areas[n].order, areas[n].closed.is_some()))
}

#[test]
fn an_order_holds_from_before_the_start_until_the_mission_is_put_away() {
    let mut run = with_areas();
    assert_eq!(shown(&mut run), [(None, false), (None, false)]);
    run.give(order(&["east"])).unwrap();
    assert_eq!(run.phase(), PhaseName::Idle);
    run.stands_still();
    run.give(Command::Start).unwrap();
    assert_eq!(shown(&mut run), [(None, false), (Some(1), false)], "the mission begins with it");
    run.give(order(&["west", "east"])).unwrap();
    assert_eq!(shown(&mut run), [(Some(1), false), (Some(2), false)]);
    run.give(order(&[])).unwrap();
    assert_eq!(shown(&mut run), [(None, false), (None, false)]);
    run.give(order(&["west"])).unwrap();
    run.give(close("west", Some(1))).unwrap();
    run.until_explored();
    run.give(Command::Reset).unwrap();
    assert_eq!(shown(&mut run), [(None, false), (None, false)], "the next mission begins anew");
}

#[test]
fn a_name_that_the_hall_does_not_have_is_refused_and_changes_nothing() {
    let mut run = with_areas();
    let unknown = || Err(Refused::UnknownArea("north".into()));
    run.give(order(&["east"])).unwrap();
    assert_eq!(run.give(order(&["west", "north"])).map(drop), unknown());
    assert_eq!(run.give(close("north", None)).map(drop), Err(Refused::NotInPhase(PhaseName::Idle)), "there is no mission");
    run.give(Command::Start).unwrap();
    assert_eq!(run.give(close("north", None)).map(drop), unknown());
    assert_eq!(run.give(close("west", Some(2))).map(drop), Err(Refused::OtherMission(MissionId(1))));
    run.until_explored();
    assert_eq!(run.give(again("north")).map(drop), unknown());
    assert_eq!(shown(&mut run), [(None, false), (Some(1), false)]);
    let mut bare = in_drawn(&ROWS);
    bare.give(order(&[])).expect("it is the order already");
    assert_eq!(bare.give(order(&["west"])).map(drop), Err(Refused::UnknownArea("west".into())), "the hall has no areas");
}

#[test]
fn neither_an_order_nor_a_closing_moves_or_stops_a_robot() {
    let mut run = with_areas();
    run.give(Command::Start).unwrap();
    run.until("some way", |state| state.mission.progress.visited > 3);
    let before = run.state();
    run.give(order(&["east"])).unwrap();
    run.give(close("west", None)).unwrap();
    assert_eq!((run.phase(), run.holds(), run.state().robot.pose), (PhaseName::Exploring, vec![], before.robot.pose));
    run.until("it goes on", |state| state.robot.pose.cell != before.robot.pose.cell);
    run.give(Command::Stop).unwrap();
    run.until("it stands", |state| !state.robot.halting);
    run.give(order(&["west"])).unwrap();
    run.give(close("east", None)).unwrap();
    run.stands_still();
    run.give(Command::BackHome).unwrap();
    run.give(order(&[])).unwrap();
    run.until_phase(PhaseName::AtHome);
    run.give(order(&["west"])).unwrap();
    run.stands_still();
}

#[test]
fn a_closed_area_is_on_record_with_what_was_open_in_it() {
    let mut run = with_areas();
    run.give(Command::Start).unwrap();
    run.give(order(&["west", "east"])).unwrap();
    let id = run.until_pending();
    let map = run.state().map.clone();
    run.give(close("east", None)).unwrap();
    let closed = run.state().mission.areas[1].closed.clone().expect("it was closed");
    let unknown = |cells: Bounds| {
        let columns = cells.least.x..=cells.most.x;
        let all = columns.flat_map(|x| (cells.least.y..=cells.most.y).map(move |y| Cell::new(x, y)));
        all.filter(|cell| !map.at(*cell).is_searched() && *cell != Cell::new(5, 2)).count()
    };
    let cells = unknown(Bounds::of(Cell::new(4, 0)).including(Cell::new(5, 3)));
    assert_eq!(closed.open, OpenInArea { cells, pending: 1 });
    assert_eq!(
        (&*closed.who, closed.name.text(), closed.note.as_ref().map(Note::text)),
        ("operator", "Rossi", Some("dogs were there"))
    );
    assert_eq!(run.give(close("east", None)).map(drop), Err(Refused::AreaClosed("east".into())));
    run.verdict(id.0, Verdict::Safe).expect("the piece is judged all the same");
    let log = run.state().log.iter().map(|line| line.said.to_string()).collect::<Vec<_>>().join("\n");
    assert!(
        log.contains("order of areas: west, east") && log.contains("close area east, by Rossi (note: dogs were there)"),
        "{log}"
    );
}

#[test]
fn an_area_is_searched_again_by_its_name_and_opened_if_it_was_closed() {
    let mut run = with_areas();
    run.give(Command::Start).unwrap();
    run.until_explored();
    run.give(again("west")).unwrap();
    let cells: Vec<Cell> = run.state().mission.again.iter().copied().collect();
    assert_eq!((cells.len(), run.phase()), (11, PhaseName::Exploring), "all but the cell where the robot stands: {cells:?}");
    assert!(cells.iter().all(|cell| cell.x <= 2));
    run.give(close("west", None)).unwrap();
    let state = run.state();
    assert!(state.mission.again.is_empty(), "the search leaves out the rest of it");
    assert_eq!(state.mission.areas[0].closed.as_ref().map(|closed| closed.open.cells), Some(11), "and this is on record");
    run.until_explored();
    run.give(again("west")).unwrap();
    assert_eq!(shown(&mut run), [(None, false), (None, false)], "it is open again");
    assert_eq!(run.state().mission.again.len(), 11);
    run.until_explored();
    assert!(run.state().mission.again.is_empty());
}

/// Another hall lies there now, or somebody has edited its file.
#[test]
fn what_was_decided_about_areas_that_are_gone_is_forgotten() {
    let mut run = with_areas();
    run.give(order(&["east", "west"])).unwrap();
    run.give(Command::Start).unwrap();
    run.give(close("west", None)).unwrap();
    run.give(close("east", None)).unwrap();
    let (now, areas) = (run.now(), [area("east", 0.7, (4, 0), (5, 3))]);
    run.engine.note_venue(Venue { name: "drawn".into(), areas: areas.into(), ..Venue::default() }, now);
    let shown: Vec<_> = run.state().mission.areas.iter().map(|view| (view.order, view.closed.is_some())).collect();
    assert_eq!(shown, [(Some(1), true)]);
    run.give(order(&["west"])).expect_err("the hall does not have it any more");
}

#[test]
fn order_and_closed_areas_outlive_a_kill() {
    let hall = Arc::new(Hall::from_rows("drawn", &ROWS).expect("the tests draw sound halls"));
    let mut mortal = Mortal::born(hall, SimSettings::new(1, Camera::Stub));
    note_areas(&mut mortal.engine, Now::default());
    mortal.give(order(&["east", "west"])).unwrap();
    mortal.give(Command::Start).unwrap();
    mortal.give(close("west", None)).unwrap();
    while mortal.keep_one() {}
    let mut mortal = mortal.killed(0);
    let state = mortal.recalled().state;
    assert_eq!(*state.area_order, [Arc::from("east"), Arc::from("west")]);
    assert!(state.closed_areas["west"].open.cells > 0 && state.under_way);
    mortal.give(close("west", None)).expect_err("it is closed still");
}

/// An area of 70 × 70 cells has more cells than may be searched again.
#[test]
fn an_area_of_any_size_can_be_opened_again() {
    let rows: Vec<String> = (0..70).map(|y| if y == 0 { format!("S{}", ".".repeat(69)) } else { ".".repeat(70) }).collect();
    let mut run = in_drawn(&rows.iter().map(String::as_str).collect::<Vec<_>>());
    let venue = Venue { name: "drawn".into(), areas: [area("all", 0.9, (0, 0), (69, 69))].into(), ..Venue::default() };
    let now = run.now();
    run.engine.note_venue(venue, now);
    run.give(Command::Start).unwrap();
    run.until_explored();
    assert!(matches!(run.give(again("all")), Err(Refused::AreaTooLarge(_))));
    run.give(close("all", None)).unwrap();
    run.give(again("all")).unwrap();
    let mission = &run.state().mission;
    assert!(mission.areas[0].closed.is_none() && mission.again.is_empty(), "it is open, and no cell is searched again");
}
