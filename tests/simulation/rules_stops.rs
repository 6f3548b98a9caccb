//! Safety S8: after a halt, `robot.halting` is true until the robot stands, and nothing new begins before. The answer
//! to a STOP names a revision in which the robot halts or stands.

use hallsweep_core::command::{Command, Door, Issuer, Move, Request};
use hallsweep_core::effect::Effect;
use hallsweep_core::event::{Event, RobotEvent};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::RobotState;
use hallsweep_core::units::{AlarmId, Cell, Epoch};

use crate::bare::Bare;
use crate::operator::{Operator, in_hall};

/// Robot during a step.
fn driving() -> Bare {
    let mut bare = Bare::linked();
    bare.give(Command::Start).expect("an idle robot starts");
    assert!(bare.order().is_some() && !bare.state().robot.halting);
    bare
}

fn is_halting(bare: &mut Bare) -> bool {
    bare.state().robot.halting
}

#[test]
fn every_halt_says_that_it_halts_until_the_robot_says_that_it_stands() {
    type Halting = fn(&mut Bare);
    let causes: [(&str, Halting); 4] = [
        ("stop", |bare| drop(bare.give(Command::Stop))),
        ("button", |bare| drop(bare.give(Command::Temperature(hallsweep_core::command::TemperatureReport::TooHigh)))),
        ("sensor", |bare| bare.watch_silent("roof")),
        ("store", |bare| bare.event(Event::StoreFailed("disk full".to_owned()))),
    ];
    let answers: [(&str, Halting); 2] = [("halted", Bare::halted), ("done all the same", Bare::done)];
    for (name, cause) in causes {
        for (said, answer) in answers {
            let mut bare = driving();
            cause(&mut bare);
            let state = bare.state();
            assert!(state.robot.halting && state.robot.state != RobotState::Stopped, "{name}: it may still be moving");
            answer(&mut bare);
            let state = bare.state();
            assert_eq!((state.robot.halting, state.robot.state), (false, RobotState::Stopped), "{name}, {said}");
        }
    }
}

#[test]
fn a_stop_is_answered_when_the_robot_stands_or_after_a_tenth_of_a_second() {
    let mut bare = driving();
    let ticket = bare.give(Command::Stop).unwrap();
    assert_eq!(bare.answer(ticket), None);
    bare.halted();
    let revision = bare.answer(ticket).expect("it stands").unwrap().revision;
    let state = bare.state();
    assert_eq!((revision, state.robot.halting), (state.revision, false));

    let mut bare = driving();
    let ticket = bare.give(Command::Stop).unwrap();
    let due = bare.engine.poll_timeout().expect("the answer does not wait for ever");
    assert_eq!(due.as_millis(), 100, "nothing has taken time so far");
    bare.wait_in_vain();
    let revision = bare.answer(ticket).expect("it has waited long enough").unwrap().revision;
    assert!(is_halting(&mut bare) && revision <= bare.state().revision);
}

/// The command with the sender of the STOP may come late, after many other commands.
#[test]
fn a_stop_that_has_halted_does_not_undo_the_start_that_was_given_after_it() {
    let mut bare = driving();
    let raised = bare.raise();
    assert!(is_halting(&mut bare));
    bare.halted();
    bare.give(Command::Start).expect("it stands, and is held by nothing else");
    assert!(bare.order().is_some());
    let stop = Request { epoch: Some(raised), ..Request::new(Command::Stop, Issuer::operator(Door("mqtt"))) };
    let ticket = bare.ask(stop.clone()).expect("it is on record");
    let state = bare.state();
    assert!(state.mission.holds.is_empty() && bare.order().is_some(), "the START stands");
    assert!(state.log.iter().any(|entry| entry.said.to_string().contains("STOP, by")));
    bare.done();
    assert!(bare.answer(ticket).is_some_and(|answer| answer.is_ok()));
    let again = Request { epoch: Some(raised.next()), ..stop };
    bare.ask(again).expect("a stop is never refused");
    assert!(!bare.state().mission.holds.is_empty(), "another one does");
}

/// Safety S4, R1: nobody knows when the command was given, and a STOP or a restart may have come since. An epoch in
/// the command would tell.
#[test]
fn a_start_that_was_sent_before_and_names_no_epoch_is_outdated_and_nothing_else_is() {
    let again = |command, epoch| {
        let request = Request::new(command, Issuer::operator(Door("mqtt")));
        Request { epoch, is_again: true, ..request }
    };
    let mut bare = driving();
    let raised = bare.raise();
    bare.halted();
    let goto = Command::Goto(Cell { x: 1, y: 1 });
    for command in [Command::Start, Command::BackHome, Command::Retrieve(None), Command::Move(Move::Forward), goto] {
        assert_eq!(bare.ask(again(command, None)).err(), Some(Refused::SentBefore));
    }
    assert!(bare.order().is_none());
    assert_eq!(bare.ask(again(Command::Acknowledge(AlarmId(1)), None)).err(), Some(Refused::UnknownAlarm(AlarmId(1))));
    bare.ask(again(Command::Start, Some(raised))).expect("it was given after the last stop");
}

/// Safety S4: the time when a command was given counts, whatever epoch its sender names.
#[test]
fn a_start_that_was_given_before_the_stop_is_outdated_though_it_names_an_epoch_to_come() {
    for named in [None, Some(1), Some(999)] {
        let mut bare = driving();
        let given = bare.state().mission.epoch;
        bare.raise();
        bare.halted();
        let start = Request::new(Command::Start, Issuer::operator(Door("mqtt")));
        let start = Request { epoch: named.map(Epoch), arrived: Some(given), ..start };
        assert!(matches!(bare.ask(start), Err(Refused::Outdated { .. })), "{named:?}");
        assert!(bare.state().mission.holds.contains(&Hold::Operator) && bare.order().is_none());
    }
}

/// Only a command given after a STOP ends its hold: the record of the STOP, which comes last, raises the hold again.
#[test]
fn a_reset_that_was_given_before_the_stop_leaves_it_held() {
    let mut bare = Bare::linked();
    let given = bare.state().mission.epoch;
    let raised = bare.raise();
    let reset = Request { arrived: Some(given), ..Request::new(Command::Reset, Issuer::operator(Door("mqtt"))) };
    bare.ask(reset).expect("an idle robot is reset");
    let stop = Request { epoch: Some(raised), ..Request::new(Command::Stop, Issuer::operator(Door("mqtt"))) };
    bare.ask(stop).expect("a stop is never refused");
    assert!(bare.state().mission.holds.contains(&Hold::Operator));
}

#[test]
fn a_stop_while_nothing_moves_is_answered_at_once() {
    let mut bare = Bare::linked();
    let ticket = bare.give(Command::Stop).unwrap();
    assert!(bare.answer(ticket).is_some() && !is_halting(&mut bare));
    let mut bare = Bare::in_front_of(hallsweep_core::event::Obstacle::Unknown);
    let ticket = bare.give(Command::Stop).unwrap();
    assert!(bare.answer(ticket).is_some() && !is_halting(&mut bare), "a photo is no motion");
}

/// The order that follows is not part of the state that the answer to the STOP names.
#[test]
fn nothing_new_begins_before_the_robot_stands_and_the_answer_names_the_moment_in_which_it_does() {
    let mut bare = driving();
    let stop = bare.give(Command::Stop).unwrap();
    bare.effects.clear();
    bare.give(Command::Start).unwrap();
    assert!(is_halting(&mut bare));
    assert!(!bare.effects.iter().any(|effect| matches!(effect, Effect::Order(..))), "it may still be moving");
    bare.halted();
    let revision = bare.answer(stop).expect("it stands").unwrap().revision;
    let state = bare.state();
    assert_eq!((revision, state.robot.halting, state.robot.state), (state.revision, false, RobotState::Stopped));
    assert_eq!(bare.order(), None);
    bare.wait_in_vain();
    assert!(bare.order().is_some(), "then it goes on");
}

#[test]
fn a_robot_that_cannot_be_reached_is_halting_until_it_is_back() {
    let mut bare = driving();
    bare.takes_back();
    bare.robot(RobotEvent::LinkLost("cable".to_owned()));
    assert!(is_halting(&mut bare));
    let stop = bare.give(Command::Stop).unwrap();
    assert_eq!(bare.answer(stop), None);
    bare.link_up();
    assert!(!is_halting(&mut bare));
    assert!(bare.answer(stop).is_some());

    let mut bare = Bare::linked();
    bare.robot(RobotEvent::LinkLost("cable".to_owned()));
    assert!(!is_halting(&mut bare), "it stood when the link was lost");
}

#[test]
fn an_order_that_is_never_answered_leaves_it_halting_until_somebody_has_looked_after_it() {
    let mut bare = driving();
    let late = bare.takes_back().expect("a step is under way");
    bare.wait_in_vain();
    assert_eq!((bare.phase(), is_halting(&mut bare)), (PhaseName::Fault, true));
    bare.robot(RobotEvent::Halted(late.id, true));
    assert!(!is_halting(&mut bare), "it answers late");

    let mut bare = driving();
    bare.takes_back();
    bare.wait_in_vain();
    bare.give(Command::Start).unwrap();
    assert!(!is_halting(&mut bare) && bare.order().is_some());
}

#[test]
fn whole_missions_with_a_stop_at_every_step_are_never_answered_with_a_moving_robot() {
    let mut run = in_hall("seed");
    run.give(Command::Start).unwrap();
    let mut stops = 0;
    while run.advance() && stops < 300 {
        let stopped = run.give(Command::Stop).unwrap();
        let state = run.state();
        assert!(stopped.revision <= state.revision);
        assert!(matches!(state.robot.state, RobotState::Stopped | RobotState::TakingPhoto | RobotState::SendingPhoto));
        assert!(!state.robot.halting);
        run.stands_still();
        stops += 1;
        if let Some(id) = run.state().pending().map(|luggage| luggage.id.0) {
            run.verdict(id, hallsweep_core::command::Verdict::Safe).unwrap();
        }
        if run.give(Command::Start).is_err() {
            break;
        }
    }
    assert!(stops > 50, "{stops}");
}
