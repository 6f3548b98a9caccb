//! Tests of how driver and robot begin a link, and of what ends it.

use super::*;
use crate::line::driver::testing::{ADA, BLIND, FORWARD, Test, given_up, lost};
use crate::{Driver, Output};
use hallsweep_core::command::Move;
use hallsweep_core::effect::Action;
use hallsweep_core::event::Whereabouts;
use hallsweep_core::robot::Parts;
use hallsweep_core::units::{Cell, Heading, Pose};

#[test]
fn the_link_is_up_when_the_robot_says_from_where_it_takes_orders() {
    let mut test = Test::connected();
    test.hears(&format!("{ADA}41"));
    assert_eq!((test.said(), test.events()), (vec!["from 42".to_owned()], vec![]));
    test.hears(&format!("{ADA}41"));
    assert_eq!(test.events(), [], "that is an answer to an earlier hello");
    test.passes(500);
    assert_eq!(test.said(), ["from 42"]);
    test.hears(&format!("{ADA}42"));
    test.hears(&format!("{ADA}42"));
    let ms = Duration::from_millis;
    let parts = Parts::of(&[Part::Base, Part::Camera, Part::Sonar, Part::Led, Part::Bump, Part::AcknowledgedMoves]);
    let can = Capabilities { step: ms(800), turn: ms(650), photo: ms(2000), arm: ms(0), nudges: false, parts };
    let pose = Pose { cell: Cell::new(2, 3), heading: Heading::West };
    let stands = Whereabouts { pose, off_centre: false };
    assert_eq!(test.events(), [RobotEvent::Stands(stands), RobotEvent::LinkUp(can)]);
}

#[test]
fn one_that_has_heard_of_more_orders_meanwhile_begins_above_those() {
    let mut test = Test::connected();
    test.hears(&format!("{ADA}41"));
    test.hears(&format!("{ADA}50"));
    test.passes(500);
    assert_eq!((test.said(), test.events()), (vec!["from 42".to_owned(), "from 51".to_owned()], vec![]));
}

#[test]
fn a_robot_that_was_just_switched_on_begins_above_one() {
    let mut test = Test::connected();
    test.hears(&format!("{ADA}0"));
    assert_eq!(test.said(), ["from 1"]);
    test.hears(&format!("{ADA}1"));
    assert_eq!(test.events().len(), 2);
    test.said();
    test.order(FORWARD);
    assert_eq!(test.said(), ["w 2 2000"]);
}

#[test]
fn a_robot_that_stands_beyond_every_hall_is_not_linked() {
    let mut test = Test::connected();
    let far = ADA.replace("2,3,west", "2049,3,west");
    test.hears(&format!("{far}41"));
    test.hears(&format!("{far}42"));
    assert!(given_up(&mut test).contains("further from the entrance than any hall"));
}

#[test]
fn a_robot_that_says_nothing_is_given_up_with_what_was_seen_of_it() {
    let mut test = Test::up(ADA);
    test.order_within(FORWARD, 60_000);
    test.hears("what is this");
    test.driver.handle_received(b"noise*0000\n", test.now);
    test.passes(1500);
    let words = "the robot said nothing for 1.5 s; some lines arrived damaged; `what is this` was not understood";
    assert_eq!(test.outputs().last(), Some(&Output::GiveUp(words.to_owned())));
    assert_eq!(test.driver.poll_timeout(), None, "nothing more is said");
    for _ in 0..2 {
        test.driver.handle_lost(words, test.now);
    }
    assert_eq!(lost(&test.events()), words, "and nobody is told twice");
}

#[test]
fn a_board_that_is_reset_by_its_connection_has_time_to_wake() {
    let mut test = Test::connected();
    test.passes(4900);
    assert!(test.said().iter().all(|text| text == "hello"));
    test.passes(100);
    assert!(matches!(test.outputs().last(), Some(Output::GiveUp(_))));
}

#[test]
fn a_robot_that_was_switched_off_and_on_is_a_lost_link_and_its_order_is_over() {
    let mut test = Test::up(ADA);
    test.order(FORWARD);
    test.said();
    test.hears(&format!("{BLIND}0"));
    let words = given_up(&mut test);
    assert_eq!(words, "ada was switched off and on: check that its reported place is right");
    test.driver.handle_lost(&words, test.now);
    assert_eq!(lost(&test.events()), words);
    test.driver.handle_connected(test.now);
    test.hears(&format!("{BLIND}0"));
    assert_eq!(test.said(), ["", "hello", "from 1"]);
    test.hears(&format!("{BLIND}1"));
    assert!(matches!(test.events()[..], [RobotEvent::Stands(_), RobotEvent::LinkUp(_)]));
    assert!(!test.driver.is_off_centre(), "it says that it stands well");
}

#[test]
fn a_robot_that_knows_of_fewer_orders_than_it_did_was_switched_off_and_on() {
    let mut test = Test::up(ADA);
    test.hears(&format!("{ADA}3"));
    assert!(given_up(&mut test).contains("switched off and on"));
}

#[test]
fn a_robot_that_takes_the_place_of_another_is_a_lost_link() {
    let mut test = Test::up(ADA);
    test.hears("hello bob base step=800 turn=650 photo=0 at=0,0,south off last=42");
    let words = given_up(&mut test);
    assert_eq!(words, "bob answers instead of ada: check the place of the robot");
    test.driver.handle_lost(&words, test.now);
    assert_eq!(lost(&test.events()), words);
    test.driver.handle_connected(test.now);
    test.hears("hello bob base step=800 turn=650 photo=0 at=0,0,south off last=100");
    assert_eq!(test.said(), ["", "hello", "from 101"]);
    test.hears("hello bob base step=800 turn=650 photo=0 at=0,0,south off last=101");
    assert!(matches!(test.events()[..], [RobotEvent::Stands(Whereabouts { off_centre: true, .. }), RobotEvent::LinkUp(_)]));
    assert!(test.driver.is_off_centre());
}

/// Somebody has carried the robot away, or the robot has counted its moves wrongly. Its next reports would be about
/// wrong cells.
#[test]
fn a_robot_that_says_that_it_stands_elsewhere_than_it_has_come_is_a_lost_link() {
    let at = |place: &str, last: u32| ADA.replace("2,3,west", place) + &last.to_string();
    let done = |action: Action, place: &str| {
        let mut test = Test::up(ADA);
        test.order(action);
        test.hears(&at("2,3,west", 43));
        test.hears(&at("2,3,west", 42));
        test.hears(&at(place, 43));
        test.hears("done 43");
        test.hears(&at(place, 43));
        assert!(!test.outputs().iter().any(|output| matches!(output, Output::GiveUp(_))), "{action:?}");
        test
    };
    done(FORWARD, "1,3,west");
    done(Action::Move(Move::Backward), "3,3,west");
    done(Action::Move(Move::TurnLeft), "2,3,south");
    done(Action::Move(Move::TurnRight), "2,3,north");
    done(Action::Recentre, "2,3,west");
    let mut test = done(FORWARD, "1,3,west");
    test.hears(&at("0,3,west", 43));
    assert_eq!(given_up(&mut test), "ada says that it is at (0, 3), west, but was at (1, 3), west: check its place");
}

/// This holds whatever else the robot reports, even if it reports that no order has begun yet.
#[test]
fn one_that_stands_elsewhere_in_the_middle_of_an_order_is_a_lost_link_too() {
    for (is_ordered, at, last) in [(true, "1,4,west", 43), (true, "3,3,west", 42), (false, "1,3,west", 42)] {
        let mut test = Test::up(ADA);
        if is_ordered {
            test.order(FORWARD);
        }
        test.hears(&(ADA.replace("2,3,west", at) + &last.to_string()));
        assert!(given_up(&mut test).contains("check its place"), "{at} {last}");
    }
}

#[test]
fn a_robot_that_never_takes_a_number_is_not_asked_in_a_hurry_and_given_up_after_a_minute() {
    // This robot either never confirms the number, or always knows of orders above it.
    for more in [0, 2] {
        let (mut test, mut last, mut said) = (Test::connected(), 41, 0);
        for _ in 0..6100 {
            test.hears(&format!("{ADA}{last}"));
            last += more;
            said += test.outputs().len();
            test.passes(10);
        }
        assert!(matches!(test.driver.link, LinkStage::Down), "it is given up");
        assert!(said < 150, "{said} lines in a minute");
    }
}

#[test]
fn a_robot_that_is_blocked_or_halted_has_not_come_further() {
    for answer in ["blocked 43 12 wall", "halted 43 off", "failed 43 no way"] {
        let mut test = Test::up(ADA);
        test.order(FORWARD);
        test.hears(answer);
        test.said();
        test.hears(&format!("{ADA}43"));
        assert_eq!(test.said(), Vec::<String>::new(), "{answer}");
        test.hears(&(ADA.replace("2,3", "1,3") + "43"));
        assert!(given_up(&mut test).contains("check its place"), "{answer}");
    }
}

#[test]
fn a_robot_that_has_other_parts_than_it_had_is_a_lost_link() {
    let mut test = Test::up(ADA);
    test.hears(&(ADA.replace(" camera", "") + "42"));
    assert_eq!(given_up(&mut test), "ada now reports other parts: check that it is the same robot");
}

#[test]
fn another_program_that_has_given_it_orders_is_a_lost_link() {
    let mut test = Test::up(ADA);
    test.hears(&format!("{ADA}43"));
    assert_eq!(given_up(&mut test), "another program has given the robot orders: let only one program drive the robot");
}

/// Safety S3: the robot may still be carrying out an earlier order.
#[test]
fn a_halt_goes_out_to_a_robot_that_is_being_greeted_with_a_number_that_it_obeys() {
    let mut test = Test::connected();
    test.driver.handle_halt(test.now);
    assert_eq!(test.said(), ["h 1"]);
    test.hears(&format!("{ADA}41"));
    test.driver.handle_halt(test.now);
    assert_eq!(test.said(), ["from 42", "h 42"]);
}

#[test]
fn one_that_has_counted_its_last_order_is_to_be_switched_off_and_on() {
    let mut test = Test::connected();
    test.hears(&format!("{ADA}2147483647"));
    assert_eq!(lost(&test.events()), ALL_COUNTED);
    test.hears(&format!("{ADA}0"));
    assert_eq!(test.said(), ["from 1"]);
}
