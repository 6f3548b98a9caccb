//! Mission §11: the person in charge closes the mission, and has seen what is left open.

use std::sync::Arc;

use hallsweep_core::closing::{Closing, OpenPoints};
use hallsweep_core::command::{Command, Move, Note, Strategy, Verdict};
use hallsweep_core::effect::Effect;
use hallsweep_core::event::RobotEvent;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::{Reach, Venue};
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::bare::Bare;
use crate::mortal::Mortal;
use crate::operator::{Operator, in_drawn};

fn close(seen: &str) -> Command {
    Command::Close(Closing { name: Note::new("Anna Rossi").unwrap(), note: Note::new("handed to the police"), seen: seen.into() })
}

/// The command of somebody who has seen what is left open now.
fn close_as_seen(state: &Snapshot) -> Command {
    close(&state.mission.open.code(state.mission.id))
}

#[test]
fn a_searched_hall_is_closed_with_a_name_and_nothing_else_changes() {
    let mut run = in_drawn(&["S...", ".a..", "...."]);
    run.give(Command::Start).unwrap();
    run.until_pending();
    assert_eq!(run.give(close("")), Err(Refused::NotInPhase(PhaseName::Inspecting)));
    run.verdict(1, Verdict::Safe).unwrap();
    run.until_explored();
    let before = run.state();
    assert_eq!(before.mission.open, OpenPoints::default());
    run.give(close("")).unwrap();
    let state = run.state();
    let closed = state.mission.closed.as_ref().expect("it was closed");
    assert_eq!(
        (&*closed.who, closed.name.text(), closed.note.as_ref().map(Note::text)),
        ("operator", "Anna Rossi", Some("handed to the police"))
    );
    assert_eq!((state.mission.phase, state.robot.led_blinking), (before.mission.phase, before.robot.led_blinking));
    let log = state.log.last().expect("closing is in the log").said.to_string();
    assert!(log.contains("close, by Anna Rossi"), "{log}");
}

/// Nothing waits for *close*: START and RESET end a mission as ever, and a new mission is not closed.
#[test]
fn nothing_waits_for_closing_and_it_ends_when_a_robot_moves_again() {
    for first in [Command::Start, Command::Reset] {
        let mut run = in_drawn(&["S...", "....", "...."]);
        run.give(Command::Start).unwrap();
        run.until_explored();
        run.give(first.clone()).expect("closing is not needed");
        let mut run = in_drawn(&["S...", "....", "...."]);
        run.give(Command::Start).unwrap();
        run.until_explored();
        run.give(close("")).unwrap();
        run.give(first).unwrap();
        assert!(run.state().mission.closed.is_none());
    }
    let mut run = in_drawn(&["S....", ".....", "....."]);
    run.give(Command::Start).unwrap();
    run.until("some way", |state| state.mission.progress.visited > 5);
    run.give(Command::BackHome).unwrap();
    run.until("home", |state| state.mission.phase == PhaseName::AtHome);
    let open = run.state().mission.open;
    assert!(open.places > 0, "{open:?}");
    let seen = close_as_seen(&run.state());
    run.give(seen).unwrap();
    run.give(Command::Start).unwrap();
    assert!(run.state().mission.closed.is_none(), "the search goes on");
}

#[test]
fn what_is_left_open_is_named_before_a_mission_is_closed() {
    let hall = Arc::new(Hall::from_rows("drawn", &["S..#.", ".a.#.", "...#.", "..b#."]).unwrap());
    let mut run = Run::new(hall, SimSettings::new(1, Camera::Stub), Settings::default(), Strategy::Auto);
    let reach = Some(Reach { reachable: 10, free: 14 });
    run.engine.note_venue(Venue { name: "drawn".into(), reach, ..Venue::default() }, run.now());
    run.give(Command::Start).unwrap();
    run.until_pending();
    run.verdict(1, Verdict::Danger).unwrap();
    run.until("home", |state| state.mission.phase == PhaseName::BombLocated);
    let open = run.state().mission.open;
    assert_eq!((open.pending, open.bombs, open.unreachable), (0, 1, 4));
    assert!(open.places > 0 && open.unvisited > 0, "{open:?}");
    let mission = run.state().mission.id;
    let refused = Refused::OpenPoints { mission, open: Box::new(open) };
    let others = [OpenPoints { bombs: 0, pending: 1, ..open }, OpenPoints::default()].map(|other| other.code(mission));
    for seen in others.into_iter().chain([String::new(), open.code(mission.next())]) {
        assert_eq!(run.give(close(&seen)), Err(refused.clone()), "{seen}");
    }
    let words = refused.to_string();
    assert!(words.contains("bombs in the hall: 1") && words.contains("cells that cannot be reached: 4"), "{words}");
    let seen = close_as_seen(&run.state());
    run.give(seen).unwrap();
    assert_eq!(run.state().mission.closed.as_ref().map(|closed| closed.open), Some(open));
}

/// A danger at home, after the mission was closed, is not part of what the person in charge has seen.
#[test]
fn a_verdict_that_comes_later_ends_it() {
    let mut run = in_drawn(&["S...", ".a..", "...."]);
    run.give(Command::Start).unwrap();
    run.until_pending();
    run.give(Command::BackHome).unwrap();
    run.until("home", |state| state.mission.phase == PhaseName::AtHome);
    let seen = close_as_seen(&run.state());
    run.give(seen.clone()).unwrap();
    run.verdict(1, Verdict::Danger).unwrap();
    assert!(run.state().mission.closed.is_none());
    assert!(matches!(run.give(seen), Err(Refused::OpenPoints { .. })), "a bomb takes the place of a piece that waits");
}

#[test]
fn without_a_mission_there_is_nothing_to_close() {
    let mut bare = Bare::linked();
    bare.give(Command::Move(Move::Forward)).unwrap();
    let order =
        bare.effects.iter().rev().find_map(|effect| if let Effect::Order(_, order) = effect { Some(*order) } else { None });
    bare.robot(RobotEvent::Failed(order.expect("it is driven").id, "wheel".to_owned()));
    assert_eq!(bare.phase(), PhaseName::Fault);
    assert_eq!(bare.give(close("")), Err(Refused::NotInPhase(PhaseName::Fault)));
}

#[test]
fn a_closed_mission_is_closed_after_a_kill() {
    let hall = Arc::new(Hall::from_rows("drawn", &["S..", "..."]).unwrap());
    let mut mortal = Mortal::searching_by(Strategy::Auto, Settings::default(), hall, SimSettings::new(1, Camera::Stub));
    mortal.give(Command::Start).unwrap();
    while mortal.state().mission.phase != PhaseName::Explored {
        mortal.keep_all();
        mortal.advance();
    }
    mortal.keep_all();
    mortal.give(close("")).unwrap();
    assert!(mortal.state().mission.closed.is_none(), "it is not on record yet");
    mortal.keep_all();
    let mut mortal = mortal.killed(0);
    let closed = mortal.state().mission.closed.clone();
    assert_eq!(closed.map(|closed| closed.name.text().to_owned()).as_deref(), Some("Anna Rossi"));
}
