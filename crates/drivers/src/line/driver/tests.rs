//! Tests of the driver: orders, their answers, and photos.

use super::testing::{ADA, BLIND, FORWARD, Test, lost, photograph};
use super::*;
use crate::line::MOST_BYTES;
use crate::line::picture::PNG;
use hallsweep_core::effect::Stamp;
use hallsweep_core::event::{Ahead, Obstacle};
use hallsweep_core::units::{Piece, WallTime};

#[test]
fn every_action_is_said_in_its_word() {
    for (action, text) in [
        (FORWARD, "w 43 2000"),
        (Action::Move(Move::Backward), "s 43 2000"),
        (Action::Move(Move::TurnLeft), "a 43 2000"),
        (Action::Move(Move::TurnRight), "d 43 2000"),
        (Action::Recentre, "c 43 2000"),
        (photograph(), "photo 43 2000"),
    ] {
        let mut test = Test::up(ADA);
        test.order(action);
        assert_eq!(test.said(), [text]);
    }
}

#[test]
fn an_order_is_repeated_with_the_time_that_is_left_until_it_is_answered() {
    let mut test = Test::up(ADA);
    test.order(FORWARD);
    test.passes(250);
    assert_eq!(test.said(), ["w 43 2000", "w 43 1900", "w 43 1800"]);
    test.hears("done 43");
    assert_eq!(test.events(), [RobotEvent::Done(OrderId(7))]);
    test.hears("done 43");
    test.passes(240);
    assert_eq!((test.said(), test.events()), (vec![], vec![]), "it was answered, and is over");
}

#[test]
fn every_answer_becomes_the_report_of_it() {
    let id = OrderId(7);
    let wall = Obstacle::Wall { left: 3, right: 2 };
    let ahead = Ahead { free: 1, obstacle: Some(Obstacle::Luggage(Piece(5))) };
    for (text, events, off_centre) in [
        ("done 43", vec![RobotEvent::Done(id)], false),
        ("done 43 ahead 1 luggage 5", vec![RobotEvent::Ahead(ahead), RobotEvent::Done(id)], false),
        ("blocked 43 4 wall 3 2", vec![RobotEvent::Sonar(Some(4)), RobotEvent::Blocked(id, wall)], true),
        ("blocked 43 none unknown", vec![RobotEvent::Blocked(id, Obstacle::Unknown)], true),
        ("halted 43 off", vec![RobotEvent::Halted(id, true)], true),
        ("halted 43 centred", vec![RobotEvent::Halted(id, false)], false),
        ("failed 43 a wheel slips", vec![RobotEvent::Failed(id, "a wheel slips".to_owned())], true),
        ("done 42", vec![], false),
        ("done 44", vec![], false),
    ] {
        let mut test = Test::up(ADA);
        test.order(FORWARD);
        test.hears(text);
        assert_eq!((test.events(), test.driver.is_off_centre()), (events, off_centre), "{text}");
    }
}

#[test]
fn readings_are_told_as_they_come_and_of_many_in_a_moment_the_hottest() {
    let degrees = |celsius| RobotEvent::Temperature(hallsweep_core::units::Celsius::new(celsius).unwrap());
    let mut test = Test::up(&ADA.replace("bump", "bump thermometer"));
    test.hears("temp 21.5");
    assert_eq!(test.events(), [degrees(21.5)]);
    for celsius in ["22.0", "60.0", "20.0"] {
        test.hears(&format!("temp {celsius}"));
        test.hears("sonar 37");
    }
    assert_eq!(test.events(), []);
    test.passes(500);
    assert_eq!(test.events(), [RobotEvent::Sonar(Some(37)), degrees(60.0)]);
    test.hears("temp 20.0");
    test.passes(500);
    assert_eq!(test.events(), [degrees(20.0)], "the last is told too");
}

#[test]
fn what_a_robot_measures_without_a_sensor_is_not_listened_to() {
    let mut test = Test::up(&ADA.replace(" sonar", ""));
    test.hears("temp 60.0");
    test.hears("sonar 37");
    test.passes(500);
    assert_eq!(test.events(), []);
}

#[test]
fn how_far_what_blocks_it_is_tells_one_with_a_sonar_alone() {
    let mut test = Test::up(BLIND);
    test.order(FORWARD);
    test.hears("blocked 43 12 unknown");
    assert_eq!(test.events(), [RobotEvent::Blocked(OrderId(7), Obstacle::Unknown)]);
}

#[test]
fn no_wall_is_longer_and_no_way_freer_than_a_robot_can_see() {
    let mut test = Test::up(ADA);
    test.order(FORWARD);
    test.hears("blocked 43 none wall 65535 7");
    let wall = Obstacle::Wall { left: 100, right: 7 };
    assert_eq!(test.events(), [RobotEvent::Blocked(OrderId(7), wall)]);
}

#[test]
fn a_robot_that_halts_by_itself_again_and_again_has_failed() {
    let mut test = Test::up(ADA);
    for order in 1..=20_u64 {
        test.order(FORWARD);
        test.hears(&format!("halted {} centred", 42 + order));
        let fails = matches!(test.events()[..], [RobotEvent::Failed(..)]);
        assert_eq!(fails, order == 20, "order {order}");
    }
}

#[test]
fn a_halt_goes_out_at_once_and_is_repeated_until_the_robot_stands() {
    let mut test = Test::up(ADA);
    test.order(FORWARD);
    test.driver.handle_halt(test.now);
    test.passes(100);
    assert_eq!(test.said(), ["w 43 2000", "h 43", "h 43"]);
    test.hears("halted 43 off");
    assert_eq!(test.events(), [RobotEvent::Halted(OrderId(7), true)]);
    test.passes(100);
    test.driver.handle_halt(test.now);
    assert_eq!(test.said(), ["h 43"], "whatever it does, it is told");
    test.driver.handle_lost("the connection was closed", test.now);
    test.driver.handle_halt(test.now);
    assert_eq!(test.said(), Vec::<String>::new(), "nobody is there");
}

#[test]
fn a_photo_goes_on_through_a_halt_that_is_told_at_once() {
    let mut test = Test::up(ADA);
    test.order(photograph());
    let bytes = [PNG, &[7; 1000]].concat();
    test.photo(&bytes, &bytes[..500]);
    test.said();
    test.driver.handle_halt(test.now);
    assert_eq!(test.said(), ["h 42"]);
    test.driver.handle_received(&bytes[500..], test.now);
    assert!(matches!(&test.events()[..], [RobotEvent::Photo(OrderId(7), photo)] if *photo.bytes == bytes));
}

#[test]
fn a_motion_never_begins_after_its_deadline() {
    let mut test = Test::up(ADA);
    test.order_within(FORWARD, 300);
    test.passes(200);
    // After the deadline, only the halt is sent. The robot's answer to the halt is also the answer to the order.
    test.hears("sonar 10");
    test.said();
    test.passes(200);
    assert_eq!(test.said(), ["h 43", "h 43"]);
    assert!(test.driver.poll_timeout() > Some(test.now.since_start), "it waits until the next is due");
}

#[test]
fn what_a_robot_has_not_is_refused_or_drawn() {
    let mut test = Test::up(BLIND);
    test.order(photograph());
    let subject = Subject { stamp: Stamp { pose: Pose::START, wall: WallTime::default() }, name: None };
    assert_eq!(test.outputs(), [Output::Draw(OrderId(7), subject)]);
    let drawing = Photo { bytes: std::sync::Arc::from(*b"drawn"), media_type: "image/png" };
    test.driver.handle_drawing(OrderId(6), drawing.clone(), test.now);
    assert_eq!(test.events(), [], "nobody asked for that one");
    test.driver.handle_drawing(OrderId(7), drawing.clone(), test.now);
    assert_eq!(test.events(), [RobotEvent::Photo(OrderId(7), drawing)]);
    for action in [Action::Move(Move::NudgeLeft), Action::Enter, Action::Arm(hallsweep_core::arm::ArmAction::Lift)] {
        test.order(action);
        assert!(matches!(&test.events()[..], [RobotEvent::Failed(OrderId(7), words)] if words.starts_with("the line protocol")));
    }
    test.driver.handle_led(true, test.now);
    assert_eq!(test.said(), Vec::<String>::new(), "it has no LED");
}

#[test]
fn an_order_beside_another_or_without_a_robot_fails_in_words() {
    let failed = |test: &mut Test| match &test.events()[..] {
        [RobotEvent::Failed(OrderId(7), words)] => words.clone(),
        other => panic!("{other:?}"),
    };
    let mut test = Test::connected();
    test.order(FORWARD);
    assert_eq!(failed(&mut test), "the robot is not connected");
    let mut test = Test::up(ADA);
    test.order(FORWARD);
    test.order(FORWARD);
    assert_eq!(failed(&mut test), "order 7 is still under way");
    let mut test = Test::up(BLIND);
    test.order(photograph());
    test.order(FORWARD);
    assert_eq!(failed(&mut test), "order 7 is still under way", "it is a drawing");
    let mut test = Test::up("hello ada camera step=0 turn=0 photo=9 at=0,0,south centred last=");
    test.order(FORWARD);
    assert_eq!(failed(&mut test), "the robot says that it has no base");
}

#[test]
fn the_led_is_told_at_once_and_again_with_every_hello() {
    let mut test = Test::up(ADA);
    test.driver.handle_led(true, test.now);
    test.passes(500);
    assert_eq!(test.said(), ["led blink", "hello", "led blink"]);
}

/// Tests safety R2 (docs/safety.md).
#[test]
fn an_order_under_way_when_the_link_is_lost_is_not_answered_and_leaves_it_off_centre() {
    let mut test = Test::up(ADA);
    test.order(FORWARD);
    test.driver.handle_lost("the connection was closed", test.now);
    assert_eq!(lost(&test.events()), "the connection was closed");
    assert!(test.driver.is_off_centre());
    test.driver.handle_connected(test.now);
    test.hears(&format!("{ADA}43"));
    assert_eq!(test.said().last().map(String::as_str), Some("from 44"));
    test.hears("done 43");
    test.hears(&format!("{ADA}44"));
    assert!(matches!(test.events()[..], [RobotEvent::Stands(_), RobotEvent::LinkUp(_)]));
}

#[test]
fn what_had_begun_to_come_over_a_connection_that_is_lost_is_forgotten() {
    let hello = format!("{ADA}43");
    let half_photo = [framed("photo 43 1000 00000000"), b"\xff\xd8\xff".to_vec()].concat();
    for begun in [&b"halted 43 o"[..], &half_photo] {
        let mut test = Test::up(ADA);
        test.order(photograph());
        test.driver.handle_received(begun, test.now);
        test.driver.handle_lost("the connection was closed", test.now);
        test.driver.handle_connected(test.now);
        test.hears(&hello);
        assert_eq!(test.said().last().map(String::as_str), Some("from 44"));
    }
}

#[test]
fn a_drawing_for_an_order_that_was_lost_is_nobodys() {
    let mut test = Test::up(BLIND);
    test.order(photograph());
    test.driver.handle_lost("the connection was closed", test.now);
    test.events();
    let drawing = Photo { bytes: std::sync::Arc::from(*b"drawn"), media_type: "image/png" };
    test.driver.handle_drawing(OrderId(7), drawing, test.now);
    assert_eq!(test.events(), []);
}

#[test]
fn a_connection_that_takes_the_place_of_another_ends_the_order() {
    let mut test = Test::up(ADA);
    test.order(FORWARD);
    test.driver.handle_connected(test.now);
    assert!(test.driver.is_off_centre());
    assert_eq!(test.driver.poll_timeout(), Some(HELLO), "the order is not repeated");
}

#[test]
fn a_drawing_that_is_not_made_in_time_is_a_photo_that_failed() {
    let mut test = Test::up(BLIND);
    test.order_within(photograph(), 2000);
    test.hears(&format!("{BLIND}42"));
    test.passes(1000);
    test.hears(&format!("{BLIND}42"));
    test.passes(1000);
    assert_eq!(test.events(), [RobotEvent::PhotoFailed(OrderId(7), "the photo was not drawn in time".to_owned())]);
    test.order(FORWARD);
    assert_eq!(test.events(), [], "and it goes on");
}

#[test]
fn a_photo_with_lost_or_damaged_bytes_fails_and_lines_are_read_again() {
    let bytes = [PNG, &[7; 1000]].concat();
    let damaged = [&PNG[1..], &[7; 1001]].concat();
    for (sent, why) in [(&damaged[..], "damaged"), (&bytes[..900], "only 900 of")] {
        let mut test = Test::up(ADA);
        test.order_within(photograph(), 10_000);
        test.photo(&bytes, sent);
        test.passes(1000);
        assert!(matches!(&test.events()[..], [RobotEvent::PhotoFailed(OrderId(7), words)] if words.contains(why)), "{why}");
        test.hears("sonar 5");
        assert_eq!(test.events(), [RobotEvent::Sonar(Some(5))]);
    }
}

#[test]
fn while_a_photo_comes_nothing_is_asked_and_the_link_stands() {
    let bytes = [PNG, &[7; 100_000]].concat();
    let mut test = Test::up(ADA);
    test.order_within(photograph(), 60_000);
    test.photo(&bytes, b"");
    test.said();
    for piece in bytes.chunks(10_000) {
        test.passes(900);
        test.driver.handle_received(piece, test.now);
    }
    assert_eq!(test.said(), Vec::<String>::new());
    assert!(matches!(&test.events()[..], [RobotEvent::Photo(OrderId(7), photo)] if photo.bytes.len() > 100_000));
    test.passes(10);
    assert_eq!(test.said(), ["hello", "led off"]);
}

#[test]
fn a_photo_that_comes_too_late_is_passed_over_and_so_are_the_lines_in_it() {
    let mut test = Test::up(ADA);
    test.order_within(photograph(), 500);
    test.passes(400);
    test.hears("sonar 1");
    test.passes(100);
    let why = "the photo did not arrive in time".to_owned();
    assert_eq!(test.events(), [RobotEvent::Sonar(Some(1)), RobotEvent::PhotoFailed(OrderId(7), why)]);
    let bytes = framed("sonar 99");
    test.photo(&bytes, &bytes);
    test.hears("sonar 5");
    test.passes(500);
    assert_eq!(test.events(), [RobotEvent::Sonar(Some(5))]);
}

#[test]
fn the_photo_of_another_order_is_passed_over() {
    let mut test = Test::up(ADA);
    test.order(photograph());
    let other = framed("sonar 99");
    test.hears(&format!("photo 42 {} 00000000", other.len()));
    test.driver.handle_received(&other, test.now);
    test.hears("done 43");
    assert_eq!(test.events(), [], "nor is it a motion");
    test.photo(PNG, PNG);
    assert!(matches!(test.events()[..], [RobotEvent::Photo(OrderId(7), _)]));
}

#[test]
fn a_photo_of_no_size_that_is_taken_fails() {
    for length in [0, MOST_BYTES + 1, u32::MAX] {
        let mut test = Test::up(ADA);
        test.order(photograph());
        test.hears(&format!("photo 43 {length} 00000000"));
        assert!(matches!(&test.events()[..], [RobotEvent::PhotoFailed(OrderId(7), words)] if words.contains("1 to 4194304")));
    }
}

mod whatever {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn comes_from_the_robot_cut_anywhere_ends_nothing(
            pieces in prop::collection::vec(prop_oneof![
                prop::collection::vec(any::<u8>(), 0..200),
                prop::sample::select(vec!["done 43", "photo 43 100000 00000000", "halted 43 off", "sonar none", "hello x"]).prop_map(framed),
                Just(framed(&format!("{ADA}0"))),
                Just(framed(&format!("{ADA}1"))),
            ], 0..40),
            cut in 1_usize..50,
        ) {
            let mut test = Test::up(ADA);
            test.order(photograph());
            for piece in pieces.concat().chunks(cut) {
                test.driver.handle_received(piece, test.now);
                test.passes(10);
                test.outputs();
                test.events();
            }
        }
    }
}
