//! Tests of the driver: what it says to a robot, and what follows from each line of it.

use super::*;
use crate::line::MOST_BYTES;
use crate::line::crc::Crc32;
use crate::line::picture::PNG;
use hallsweep_core::effect::Stamp;
use hallsweep_core::event::{Ahead, Capabilities, Obstacle, Piece, Whereabouts};
use hallsweep_core::units::{Cell, Epoch, Heading, Pose, WallTime};

const ADA: &str = "hello ada base camera sonar led bump step=800 turn=650 photo=2000 at=2,3,west centred last=";
const BLIND: &str = "hello ada base step=800 turn=650 photo=0 at=0,0,south centred last=";

struct Test {
    driver: LineDriver,
    now: Now,
}

impl Test {
    /// A driver whose connection stands.
    fn connected() -> Test {
        let mut test = Test { driver: LineDriver::new(), now: Now::default() };
        test.driver.handle_connected(test.now);
        assert_eq!(test.said(), ["", "hello"]);
        test
    }

    /// A driver whose robot has introduced itself, and knows that orders begin above 42.
    fn up(hello: &str) -> Test {
        let mut test = Test::connected();
        test.hears(&format!("{hello}41"));
        assert_eq!(test.said(), ["from 42"]);
        test.hears(&format!("{hello}42"));
        assert!(matches!(test.events()[..], [RobotEvent::Stands(_), RobotEvent::LinkUp(_)]));
        test.said();
        test
    }

    fn hears(&mut self, text: &str) {
        self.driver.handle_received(&framed(text), self.now);
    }

    fn passes(&mut self, ms: u64) {
        for _ in 0..ms / 10 {
            self.now.since_start += Duration::from_millis(10);
            self.driver.handle_timeout(self.now);
        }
    }

    fn order(&mut self, action: Action) {
        self.order_within(action, 2000);
    }

    fn order_within(&mut self, action: Action, ms: u64) {
        let deadline = Duration::from_millis(ms);
        self.driver.handle_order(Order { id: OrderId(7), action, epoch: Epoch(0), deadline }, self.now);
    }

    fn outputs(&mut self) -> Vec<Output> {
        std::iter::from_fn(|| self.driver.poll_output()).collect()
    }

    /// The texts that it has said since; nothing else was asked for.
    fn said(&mut self) -> Vec<String> {
        let text = |output: Output| match output {
            Output::Send(bytes) => String::from_utf8(bytes).unwrap().trim_end().split('*').next().unwrap().to_owned(),
            other @ (Output::Reconnect | Output::GiveUp(_) | Output::Draw(..)) => panic!("{other:?}"),
        };
        self.outputs().into_iter().map(text).collect()
    }

    fn events(&mut self) -> Vec<RobotEvent> {
        std::iter::from_fn(|| self.driver.poll_event()).collect()
    }

    fn photo(&mut self, bytes: &[u8], sent: &[u8]) {
        let mut crc = Crc32::new();
        crc.add(bytes);
        self.hears(&format!("photo 43 {} {:08X}", bytes.len(), crc.value()));
        self.driver.handle_received(sent, self.now);
    }
}

const FORWARD: Action = Action::Move(Move::Forward);

fn photograph() -> Action {
    Action::Photograph(Stamp { pose: Pose::START, wall: WallTime::default() })
}

/// Why the connection is given up; that is the last that is done.
fn given_up(test: &mut Test) -> String {
    let outputs = test.outputs();
    let Some(Output::GiveUp(words)) = outputs.last() else {
        panic!("a connection that is given up was expected, not {outputs:?}")
    };
    assert_eq!(test.driver.poll_timeout(), None, "nothing more is said");
    words.clone()
}

fn lost(events: &[RobotEvent]) -> &str {
    match events {
        [RobotEvent::LinkLost(words)] => words,
        other => panic!("only a link that is lost was expected, not {other:?}"),
    }
}

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
fn a_robot_that_stands_beyond_every_hall_is_not_linked() {
    let mut test = Test::connected();
    let far = ADA.replace("2,3,west", "2049,3,west");
    test.hears(&format!("{far}41"));
    test.hears(&format!("{far}42"));
    assert!(given_up(&mut test).contains("further from the entrance than any hall"));
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
    // Whatever the robot answers to that is the answer of the order.
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
    for action in [Action::Move(Move::NudgeLeft), Action::Enter, Action::Arm(hallsweep_core::retrieval::ArmAction::Lift)] {
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

#[test]
fn a_robot_that_says_nothing_is_given_up_with_what_was_seen_of_it() {
    let mut test = Test::up(ADA);
    test.order_within(FORWARD, 60_000);
    test.hears("what is this");
    test.driver.handle_received(b"noise*0000\n", test.now);
    test.passes(1500);
    let words = "the robot said nothing for 1.5 s; lines were damaged on their way; `what is this` was not understood";
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

/// Safety R2.
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
fn a_robot_that_was_switched_off_and_on_is_a_lost_link_and_its_order_is_over() {
    let mut test = Test::up(ADA);
    test.order(FORWARD);
    test.said();
    test.hears(&format!("{BLIND}0"));
    let words = given_up(&mut test);
    assert_eq!(words, "ada was switched off and on: look whether it stands where it says");
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
    assert_eq!(words, "bob has taken the place of ada: look where it stands");
    test.driver.handle_lost(&words, test.now);
    assert_eq!(lost(&test.events()), words);
    test.driver.handle_connected(test.now);
    test.hears("hello bob base step=800 turn=650 photo=0 at=0,0,south off last=100");
    assert_eq!(test.said(), ["", "hello", "from 101"]);
    test.hears("hello bob base step=800 turn=650 photo=0 at=0,0,south off last=101");
    assert!(matches!(test.events()[..], [RobotEvent::Stands(Whereabouts { off_centre: true, .. }), RobotEvent::LinkUp(_)]));
    assert!(test.driver.is_off_centre());
}

/// Somebody has carried it away, or it has lost count: what it would tell next would be of another place.
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
    assert_eq!(given_up(&mut test), "ada says that it stands at (0, 3), west, and stood at (1, 3), west: look where it stands");
}

/// Whatever else it says, as that it has begun nothing yet.
#[test]
fn one_that_stands_elsewhere_in_the_middle_of_an_order_is_a_lost_link_too() {
    for (is_ordered, at, last) in [(true, "1,4,west", 43), (true, "3,3,west", 42), (false, "1,3,west", 42)] {
        let mut test = Test::up(ADA);
        if is_ordered {
            test.order(FORWARD);
        }
        test.hears(&(ADA.replace("2,3,west", at) + &last.to_string()));
        assert!(given_up(&mut test).contains("look where it stands"), "{at} {last}");
    }
}

#[test]
fn a_robot_that_never_takes_a_number_is_not_asked_in_a_hurry_and_given_up_after_a_minute() {
    // It never hears of one, or always of orders above it.
    for more in [0, 2] {
        let (mut test, mut last, mut said) = (Test::connected(), 41, 0);
        for _ in 0..6100 {
            test.hears(&format!("{ADA}{last}"));
            last += more;
            said += test.outputs().len();
            test.passes(10);
        }
        assert!(matches!(test.driver.link, Link::Down), "it is given up");
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
        assert!(given_up(&mut test).contains("look where it stands"), "{answer}");
    }
}

#[test]
fn a_robot_that_has_other_parts_than_it_had_is_a_lost_link() {
    let mut test = Test::up(ADA);
    test.hears(&(ADA.replace(" camera", "") + "42"));
    assert_eq!(given_up(&mut test), "ada has other parts than it had: is it the same robot?");
}

#[test]
fn another_program_that_has_given_it_orders_is_a_lost_link() {
    let mut test = Test::up(ADA);
    test.hears(&format!("{ADA}43"));
    assert_eq!(given_up(&mut test), "another program has given the robot orders: let one drive it");
}

/// Safety S3: whatever of a former order it may still be doing.
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
fn a_drawing_that_is_not_made_in_time_is_a_photo_that_failed() {
    let mut test = Test::up(BLIND);
    test.order_within(photograph(), 2000);
    test.hears(&format!("{BLIND}42"));
    test.passes(1000);
    test.hears(&format!("{BLIND}42"));
    test.passes(1000);
    assert_eq!(test.events(), [RobotEvent::PhotoFailed(OrderId(7), "it was not drawn in time".to_owned())]);
    test.order(FORWARD);
    assert_eq!(test.events(), [], "and it goes on");
}

#[test]
fn one_that_has_counted_its_last_order_is_to_be_switched_off_and_on() {
    let mut test = Test::connected();
    test.hears(&format!("{ADA}2147483647"));
    assert_eq!(lost(&test.events()), ALL_COUNTED);
    test.hears(&format!("{ADA}0"));
    assert_eq!(test.said(), ["from 1"]);
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
    let why = "the photo did not come in time".to_owned();
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
        assert!(
            matches!(&test.events()[..], [RobotEvent::PhotoFailed(OrderId(7), words)] if words.contains("4194304 are taken"))
        );
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
