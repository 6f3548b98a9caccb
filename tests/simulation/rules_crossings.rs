//! Events that cross: an interrupted drive by hand, late answers, and a link that was never up.

use hallsweep_core::command::{Command, Move, TemperatureReport, Verdict};
use hallsweep_core::effect::Action;
use hallsweep_core::event::{Event, Obstacle, RobotEvent, Whereabouts};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::units::{AlarmId, Cell, Celsius, Heading, LuggageId, Pose};

use crate::bare::Bare;
use crate::operator::sensor_reads;

/// Requirement R-waitForHome: a bomb is located only when discovery is home.
#[test]
fn danger_given_while_driven_away_from_home_brings_the_robot_back_first() {
    let mut bare = Bare::at_home_with_a_pending_bag();
    bare.give(Command::Goto(Cell::new(0, 1))).unwrap();
    bare.verdict(Verdict::Danger).unwrap();
    bare.drive_on();
    assert_eq!((bare.phase(), bare.cell()), (PhaseName::ReturningWithAlarm, Cell::new(0, 1)));
    assert_eq!(bare.holds(), [Hold::Operator, Hold::AwaitingStart]);
    bare.give(Command::Start).unwrap();
    bare.drive_on();
    assert_eq!((bare.phase(), bare.cell()), (PhaseName::BombLocated, Cell::HOME));
}

/// The danger is recorded together with the drive, before the drive begins.
#[test]
fn danger_recorded_together_with_a_drive_from_home_waits_for_its_end() {
    let mut bare = Bare::at_home_with_a_pending_bag();
    bare.keeps = false;
    bare.give(Command::Goto(Cell::new(0, 1))).unwrap();
    bare.verdict(Verdict::Danger).unwrap();
    bare.keeps = true;
    bare.keep();
    bare.drive_on();
    assert_eq!((bare.phase(), bare.cell()), (PhaseName::ReturningWithAlarm, Cell::new(0, 1)));
}

/// Rule 6: a drive from home that is interrupted within a step has left home, wherever the robot stands.
#[test]
fn a_drive_from_home_cut_short_is_no_longer_waiting_at_home() {
    for stop in [Command::Stop, Command::Temperature(TemperatureReport::TooHigh)] {
        let mut bare = Bare::at_home_with_a_pending_bag();
        bare.give(Command::Goto(Cell::new(0, 1))).unwrap();
        bare.give(stop).unwrap();
        bare.halted();
        assert_eq!(bare.phase(), PhaseName::Exploring);
        bare.give(Command::Temperature(TemperatureReport::Ok)).unwrap();
        bare.give(Command::BackHome).unwrap();
        assert_eq!(bare.order(), Some(Action::Recentre));
        bare.drive_on();
        assert_eq!(bare.phase(), PhaseName::AtHome);
        assert!(!bare.state().robot.off_centre);
    }
}

#[test]
fn a_step_that_was_done_before_the_stop_reached_it_still_counts() {
    let mut bare = Bare::at_home_with_a_pending_bag();
    bare.give(Command::Goto(Cell::new(0, 1))).unwrap();
    bare.until_forward();
    bare.give(Command::Stop).unwrap();
    bare.done();
    assert_eq!((bare.phase(), bare.cell()), (PhaseName::Exploring, Cell::new(0, 1)));
}

/// Rule 6: everything that ends a drive during a mission also raises `operator`, so that the mission never resumes
/// unasked.
#[test]
fn every_hold_that_ends_a_drive_also_raises_operator() {
    type Ends = fn(&mut Bare);
    let ends: [Ends; 5] = [
        |bare| drop(bare.give(Command::Temperature(TemperatureReport::TooHigh))),
        |bare| bare.robot(RobotEvent::Temperature(Celsius::new(40.0).unwrap())),
        |bare| bare.watch_silent("roof"),
        |bare| bare.event(Event::StoreFailed("disk full".to_owned())),
        |bare| bare.robot(RobotEvent::LinkLost("cable".to_owned())),
    ];
    for end in ends {
        let mut bare = Bare::linked();
        bare.give(Command::Start).unwrap();
        bare.give(Command::Stop).unwrap();
        bare.halted();
        bare.give(Command::Goto(Cell::new(0, 3))).unwrap();
        end(&mut bare);
        bare.event(Event::StoreRestored);
        assert_eq!(bare.phase(), PhaseName::Exploring);
        assert!(bare.holds().contains(&Hold::Operator) && bare.holds().contains(&Hold::AwaitingStart), "{:?}", bare.holds());
    }
}

/// Rule 2, after a fault.
#[test]
fn start_from_a_fault_does_not_explore_past_a_pending_verdict() {
    let mut bare = Bare::at_home_with_a_pending_bag();
    bare.give(Command::Goto(Cell::new(0, 1))).unwrap();
    let order = bare.takes_back().expect("a step is under way");
    bare.robot(RobotEvent::Failed(order.id, "wheel".to_owned()));
    assert_eq!(bare.phase(), PhaseName::Fault);
    assert_eq!(bare.give(Command::Start), Err(Refused::VerdictPending(LuggageId(1))));
    bare.verdict(Verdict::Safe).unwrap();
    bare.give(Command::Start).unwrap();
    assert_eq!(bare.phase(), PhaseName::Exploring);
}

/// Safety S3: reconnecting or booting never moves the robot.
#[test]
fn before_the_link_is_up_a_start_is_refused_and_the_link_moves_nothing() {
    let mut bare = Bare::unlinked();
    assert_eq!(bare.give(Command::Start), Err(Refused::Held(vec![Hold::RobotLink], None)));
    bare.link_up();
    assert_eq!((bare.order(), bare.holds()), (None, vec![]));
}

/// The map is never wrong: a late answer is still true.
#[test]
fn a_step_answered_after_its_deadline_still_counts() {
    let mut bare = Bare::linked();
    bare.give(Command::Start).unwrap();
    let late = bare.takes_back().expect("a step is under way");
    assert_eq!(late.action, Action::Move(Move::Forward));
    bare.wait_in_vain();
    assert_eq!(bare.phase(), PhaseName::Fault);
    bare.robot(RobotEvent::Done(late.id));
    assert_eq!(bare.cell(), Cell::new(0, 1));
    bare.give(Command::Start).unwrap();
    bare.done();
    assert_eq!(bare.phase(), PhaseName::Exploring);
}

#[test]
fn answers_to_orders_nobody_gave_change_nothing() {
    let mut bare = Bare::linked();
    bare.give(Command::Start).unwrap();
    let before = bare.state().robot;
    bare.robot(RobotEvent::Done(hallsweep_core::units::OrderId(99)));
    bare.robot(RobotEvent::Blocked(hallsweep_core::units::OrderId(99), Obstacle::Unknown));
    assert_eq!(bare.state().robot, before);
}

/// A person blocks the only passage, and leaves after the reset.
#[test]
fn a_blocked_way_home_can_be_tried_again_after_a_reset() {
    let mut bare = Bare::at_a_bag();
    bare.verdict(Verdict::Danger).unwrap();
    bare.until_forward();
    bare.meets(Obstacle::Unknown);
    bare.drive_on();
    assert_eq!(bare.phase(), PhaseName::Fault);
    bare.give(Command::Acknowledge(AlarmId(1))).unwrap();
    bare.give(Command::Reset).unwrap();
    for _ in 0..3 {
        bare.give(Command::Start).unwrap();
        for _ in 0..40 {
            match bare.order() {
                Some(Action::Move(Move::Forward)) if bare.cell() == Cell::new(0, 0) => bare.meets(Obstacle::Unknown),
                Some(Action::Photograph(_)) => bare.photo(),
                Some(_) => bare.done(),
                None => break,
            }
        }
        if bare.cell() == Cell::HOME {
            return;
        }
    }
    panic!("it never got home; the phase is {:?}", bare.phase());
}

#[test]
fn two_silent_sensors_must_both_read_again() {
    let mut bare = Bare::linked();
    bare.watch_silent("roof");
    bare.watch_silent("door");
    bare.give(sensor_reads("roof", 20.0)).unwrap();
    assert_eq!(bare.holds(), [Hold::TemperatureStale]);
    bare.give(sensor_reads("door", 20.0)).unwrap();
    assert!(bare.holds().is_empty());
}

/// The refusals of the buttons are part of the mission: when they change, the mission's revision changes.
#[test]
fn a_refusal_that_ends_raises_the_missions_revision() {
    use hallsweep_core::world::resource::Resource;
    let mut bare = Bare::at_home_with_a_pending_bag();
    let before = bare.state();
    assert!(before.mission.refusals.start.is_some());
    bare.verdict(Verdict::Safe).unwrap();
    let after = bare.state();
    assert!(after.mission.refusals.start.is_none());
    assert!(after.revision_of(Resource::Mission) > before.revision_of(Resource::Mission));
}

#[test]
fn a_piece_that_failed_twice_stays_one_record_that_waits() {
    let mut bare = Bare::in_front_of(Obstacle::Luggage(hallsweep_core::units::Piece(1)));
    bare.photo_fails();
    bare.give(Command::BackHome).unwrap();
    bare.drive_on();
    bare.give(Command::Start).unwrap();
    while !matches!(bare.order(), Some(Action::Photograph(_))) {
        bare.done();
    }
    bare.photo_fails();
    let state = bare.state();
    assert_eq!((state.luggage.len(), state.mission.phase), (1, PhaseName::Inspecting));
    assert_eq!(bare.verdict(Verdict::Safe), Err(Refused::NoPhoto(LuggageId(1))));
}

/// A pose that far away must be an error; no map of that size is allocated.
#[test]
fn a_robot_that_says_it_stands_beyond_any_hall_is_in_fault_and_nothing_is_laid_out_for_it() {
    let mut bare = Bare::linked();
    let pose = Pose { cell: Cell::new(1_000_000, 0), heading: Heading::East };
    bare.robot(RobotEvent::Stands(Whereabouts { pose, off_centre: false }));
    assert_eq!((bare.phase(), bare.cell()), (PhaseName::Fault, Cell::HOME));
}
