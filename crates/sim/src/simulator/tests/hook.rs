//! Tests of the hook: which pieces it takes, when it refuses, and that no piece is lost when the program dies.

use std::sync::Arc;
use std::time::Duration;

use super::super::*;
use crate::settings::Camera;
use hallsweep_core::arm::ArmAction;
use hallsweep_core::place::Place;
use hallsweep_core::units::{Cell, Epoch};

/// Home, with a piece of two cells to the south.
const ROWS: [&str; 3] = ["S..", "aa.", "..."];

fn settings() -> SimSettings {
    SimSettings { sonar_noise_cm: 0.0, has_hook: true, ..SimSettings::new(1, Camera::Stub) }
}

fn robot() -> Sim {
    let mut sim = Sim::new(Arc::new(Hall::from_rows("test", &ROWS).unwrap()), settings());
    while sim.poll_event().is_some() {}
    sim
}

fn at(ms: u64) -> Now {
    Now { since_start: Duration::from_millis(ms), ..Now::default() }
}

fn order(sim: &mut Sim, action: ArmAction, ms: u64) {
    let order = Order { id: OrderId(ms), action: Action::Arm(action), deadline: Duration::from_secs(60), epoch: Epoch(0) };
    sim.handle_order(order, at(ms));
}

fn said(sim: &mut Sim) -> Vec<RobotEvent> {
    std::iter::from_fn(|| sim.poll_event()).collect()
}

#[test]
fn it_sees_takes_and_lets_go_of_the_whole_piece() {
    let mut sim = robot();
    let here = Place::Cell(Cell::new(0, 1));
    order(&mut sim, ArmAction::FindParcel(here), 0);
    assert!(matches!(said(&mut sim)[..], [RobotEvent::Found(_, Some(parcel))] if parcel.place == here));
    order(&mut sim, ArmAction::CloseGripper, 0);
    sim.handle_timeout(at(1400));
    assert_eq!(said(&mut sim), [], "it takes a second and a half");
    sim.handle_timeout(at(1500));
    assert!(matches!(said(&mut sim)[..], [RobotEvent::Arm(arm), RobotEvent::Done(_)] if arm.lifted));
    for cell in [Cell::new(0, 1), Cell::new(1, 1)] {
        assert_eq!(sim.hall.truth(cell), crate::Truth::Free, "no part of it stands at {cell}");
    }
    assert_eq!(sim.taken_in().count(), 0, "it is on its back, not in the container");
    order(&mut sim, ArmAction::Release, 2000);
    sim.handle_timeout(at(4000));
    assert!(matches!(said(&mut sim)[..], [RobotEvent::Arm(arm), RobotEvent::Done(_)] if arm.holds.is_none()));
    assert_eq!(sim.taken_in().count(), 1);
}

#[test]
fn a_halt_leaves_the_piece_where_it_is() {
    let mut sim = robot();
    order(&mut sim, ArmAction::CloseGripper, 0);
    sim.handle_halt(at(700));
    assert!(matches!(said(&mut sim)[..], [RobotEvent::Halted(_, false)]));
    sim.handle_timeout(at(5000));
    assert_eq!((said(&mut sim), sim.hook().holds), (Vec::new(), None));
}

#[test]
fn what_it_cannot_do_is_refused_in_words() {
    let mut sim = robot();
    sim.taken.carried = Some(hallsweep_core::units::Piece(9));
    order(&mut sim, ArmAction::CloseGripper, 0);
    order(&mut sim, ArmAction::Lift, 1);
    sim.pose.cell = Cell::new(2, 2);
    sim.body = sim.centre();
    order(&mut sim, ArmAction::Release, 2);
    let refused = said(&mut sim);
    assert!(refused.len() == 3 && refused.iter().all(|event| matches!(event, RobotEvent::Failed(..))), "{refused:?}");
    let mut bare = Sim::new(Arc::new(Hall::from_rows("test", &ROWS).unwrap()), SimSettings { has_hook: false, ..settings() });
    said(&mut bare);
    order(&mut bare, ArmAction::CloseGripper, 0);
    assert!(matches!(&said(&mut bare)[..], [RobotEvent::Failed(_, words)] if words == "it has no arm"));
}

/// Tests safety R2 (docs/safety.md).
#[test]
fn a_piece_on_its_back_is_there_after_the_program_has_died() {
    let mut sim = robot();
    order(&mut sim, ArmAction::CloseGripper, 0);
    sim.handle_timeout(at(2000));
    let hall = Arc::new(Hall::from_rows("test", &ROWS).unwrap());
    let mut again = Sim::remembering(Arc::clone(&hall), settings(), sim.memory());
    assert!(sim.memory().fits(&hall));
    let reports = said(&mut again);
    assert!(
        matches!(reports[..], [RobotEvent::Stands(_), RobotEvent::Arm(arm), RobotEvent::LinkUp(_)] if arm.lifted),
        "{reports:?}"
    );
    assert_eq!(again.hall.truth(Cell::new(1, 1)), crate::Truth::Free);
    again.handle_hall(hall);
    assert_eq!(again.hall.truth(Cell::new(1, 1)), crate::Truth::Free, "whatever others do, it is on this robot's back");
}
