//! Tests of the robot's end: which orders begin, which answers are repeated, and when it halts by itself.

use super::*;
use hallsweep_core::event::Obstacle;
use hallsweep_core::robot::Parts;
use hallsweep_core::units::{Cell, Heading};

struct Test {
    robot: LineRobot,
    now: Now,
}

impl Test {
    fn switched_on() -> Test {
        let mut robot = LineRobot::new(RobotName::new("ada").unwrap());
        let ms = Duration::from_millis;
        let can =
            Capabilities { step: ms(800), turn: ms(650), photo: ms(0), arm: ms(0), nudges: false, parts: Parts::ROUND_ROBOT };
        robot.handle_event(RobotEvent::LinkUp(can));
        Test { robot, now: Now::default() }
    }

    /// A robot that accepts orders above 5.
    fn ready() -> Test {
        let mut test = Test::switched_on();
        test.hears("from 5");
        test.said();
        test
    }

    fn hears(&mut self, text: &str) {
        self.robot.handle_received(&framed(text), self.now);
    }

    fn said(&mut self) -> Vec<String> {
        let text = |bytes: Arc<[u8]>| String::from_utf8_lossy(&bytes).trim_end().split('*').next().unwrap().to_owned();
        std::iter::from_fn(|| self.robot.poll_output()).map(text).collect()
    }

    fn asked(&mut self) -> Vec<BodyRequest> {
        std::iter::from_fn(|| self.robot.poll_asked()).collect()
    }

    /// The action that the body was requested to begin. The test fails if there was any other request.
    fn begun(&mut self) -> Option<Action> {
        match self.asked()[..] {
            [] => None,
            [BodyRequest::Order(order)] => Some(order.action),
            ref other => panic!("{other:?}"),
        }
    }

    fn reports(&mut self, event: RobotEvent) {
        self.robot.handle_event(event);
    }
}

const SIX: OrderId = OrderId(6);

#[test]
fn one_that_was_switched_on_obeys_no_order_before_it_is_told_from_where() {
    let mut test = Test::switched_on();
    test.hears("w 6 2000");
    test.hears("h 6");
    assert_eq!((test.begun(), test.said()), (None, vec![]));
    test.hears("hello");
    let hello = "hello ada base camera sonar led thermometer bump step=800 turn=650 photo=0 at=0,0,south centred last=";
    assert_eq!(test.said(), [format!("{hello}0")]);
    test.hears("from 5");
    assert_eq!(test.said(), [format!("{hello}5")]);
    test.hears("w 6 2000");
    assert_eq!(test.begun(), Some(Action::Move(Move::Forward)));
}

#[test]
fn an_order_begins_once_and_is_answered_as_often_as_it_is_asked() {
    let mut test = Test::ready();
    test.hears("w 6 2000");
    test.hears("w 6 1900");
    assert_eq!(test.begun(), Some(Action::Move(Move::Forward)));
    test.reports(RobotEvent::Done(SIX));
    test.hears("w 6 1800");
    test.hears("h 6");
    assert_eq!((test.begun(), test.said()), (None, vec!["done 6".to_owned(); 3]));
    test.hears("w 5 2000");
    assert_eq!((test.begun(), test.said()), (None, vec![]), "nobody waits for that one");
}

#[test]
fn an_order_that_was_voided_before_it_was_heard_never_begins() {
    let mut test = Test::ready();
    test.hears("h 6");
    test.hears("w 6 2000");
    assert_eq!((test.begun(), test.said()), (None, vec!["halted 6 centred".to_owned(); 2]));
    test.hears("w 7 2000");
    assert_eq!(test.begun(), Some(Action::Move(Move::Forward)));
}

#[test]
fn a_halt_is_passed_on_once_and_answered_when_it_stands() {
    let mut test = Test::ready();
    test.hears("w 6 2000");
    test.hears("h 6");
    test.hears("h 6");
    assert!(matches!(test.asked()[..], [BodyRequest::Order(_), BodyRequest::Halt]));
    assert_eq!(test.said(), Vec::<String>::new());
    test.reports(RobotEvent::Halted(SIX, true));
    test.hears("h 6");
    assert_eq!(test.said(), vec!["halted 6 off"; 2]);
    test.hears("hello");
    assert!(test.said()[0].contains("at=0,0,south off last=6"));
}

/// Tests safety S5 (docs/safety.md).
#[test]
fn one_that_moves_and_hears_nothing_good_halts_by_itself() {
    let mut test = Test::ready();
    test.hears("w 6 2000");
    assert_eq!(test.begun(), Some(Action::Move(Move::Forward)));
    let after = |test: &mut Test, ms| {
        test.now.since_start += Duration::from_millis(ms);
        test.robot.handle_timeout(test.now);
    };
    after(&mut test, 399);
    test.hears("what is this");
    after(&mut test, 399);
    assert_eq!(test.asked(), [], "a line that is not understood is a good one");
    test.robot.handle_received(b"w 6 2000*0000\n", test.now);
    after(&mut test, 1);
    assert_eq!((test.asked(), test.robot.poll_timeout()), (vec![BodyRequest::Halt], None));
    test.reports(RobotEvent::Halted(SIX, true));
    assert_eq!((test.said(), test.robot.poll_timeout()), (vec!["halted 6 off".to_owned()], None));
}

/// Tests safety S5 (docs/safety.md).
#[test]
fn one_whose_program_is_gone_halts_at_once_and_says_nothing_of_it_to_the_next() {
    let mut test = Test::ready();
    test.hears("w 6 2000");
    test.hears("hello");
    test.asked();
    test.robot.handle_lost();
    assert_eq!((test.asked(), test.said()), (vec![BodyRequest::Halt], vec![]));
}

#[test]
fn half_an_order_of_a_program_that_is_gone_is_not_made_whole_by_the_next() {
    let mut test = Test::ready();
    let order = framed("w 6 2000");
    let (first, second) = order.split_at(4);
    test.robot.handle_received(first, test.now);
    test.robot.handle_lost();
    test.robot.handle_received(second, test.now);
    assert_eq!(test.begun(), None);
}

#[test]
fn while_an_order_is_under_way_another_is_overlooked() {
    let mut test = Test::ready();
    test.hears("w 6 2000");
    test.begun();
    test.hears("w 7 2000");
    test.hears("photo 7 4000");
    assert_eq!((test.begun(), test.said()), (None, vec![]));
    test.reports(RobotEvent::Done(SIX));
    test.hears("w 7 2000");
    assert_eq!(test.begun(), Some(Action::Move(Move::Forward)));
}

#[test]
fn a_beginning_that_it_has_heard_already_halts_nothing() {
    let mut test = Test::ready();
    test.hears("w 6 2000");
    test.begun();
    test.hears("from 6");
    assert!(matches!(&test.said()[..], [hello] if hello.ends_with("off last=6")));
    assert_eq!(test.asked(), []);
}

#[test]
fn what_was_answered_before_a_new_beginning_is_not_answered_again() {
    let mut test = Test::ready();
    test.hears("w 6 2000");
    test.reports(RobotEvent::Done(SIX));
    test.hears("from 9");
    test.said();
    test.hears("w 6 2000");
    assert_eq!(test.said(), Vec::<String>::new());
}

#[test]
fn where_it_stands_follows_from_what_it_has_done() {
    let mut test = Test::ready();
    for (seq, word) in (6..).zip(["w", "a", "s", "d", "w"]) {
        test.hears(&format!("{word} {seq} 2000"));
        test.reports(RobotEvent::Done(OrderId(seq)));
    }
    assert_eq!(test.robot.stands.pose, Pose { cell: Cell::new(-1, 2), heading: Heading::South });
    test.hears("w 11 2000");
    test.reports(RobotEvent::Sonar(Some(4)));
    test.reports(RobotEvent::Blocked(OrderId(11), Obstacle::Unknown));
    assert_eq!(test.said().last().map(String::as_str), Some("blocked 11 4 unknown"));
    test.hears("hello");
    assert!(test.said()[0].contains("at=-1,2,south off"));
    test.hears("c 12 2000");
    test.reports(RobotEvent::Done(OrderId(12)));
    assert_eq!(test.robot.stands, Whereabouts { pose: test.robot.stands.pose, off_centre: false });
}

#[test]
fn a_new_beginning_halts_what_moves_and_is_said_when_it_stands() {
    let mut test = Test::ready();
    test.hears("w 6 2000");
    test.hears("from 7");
    assert!(matches!(test.asked()[..], [BodyRequest::Order(_), BodyRequest::Halt]));
    test.hears("hello");
    assert!(test.said()[0].ends_with("off last=6"));
    test.reports(RobotEvent::Halted(SIX, true));
    assert!(matches!(&test.said()[..], [halted, hello] if halted == "halted 6 off" && hello.ends_with("off last=7")));
    test.hears("from 7");
    test.hears("w 7 2000");
    assert_eq!(test.begun(), None, "it is heard twice, and seven is void");
}

#[test]
fn a_photo_is_stamped_with_where_it_stands_and_when() {
    let mut test = Test::ready();
    test.now.wall.unix_ms = 1_767_254_400_000;
    test.hears("a 6 2000");
    test.reports(RobotEvent::Done(SIX));
    test.asked();
    test.hears("photo 7 4000");
    let stamp = Stamp { pose: Pose { heading: Heading::East, ..Pose::START }, wall: test.now.wall };
    assert_eq!(test.begun(), Some(Action::Photograph(stamp)));
}

#[test]
fn a_photo_is_sent_once() {
    let mut test = Test::ready();
    test.hears("photo 6 4000");
    assert!(matches!(test.begun(), Some(Action::Photograph(_))));
    test.hears("h 5");
    assert_eq!(test.asked(), [], "it is no motion");
    test.reports(RobotEvent::Photo(SIX, Photo { bytes: Arc::from(*b"123456789"), media_type: "image/png" }));
    assert_eq!(test.said(), ["photo 6 9 CBF43926", "123456789"]);
    test.hears("photo 6 4000");
    assert_eq!(
        (test.begun(), test.said()),
        (None, vec!["nophoto 6 the photo was sent already and is lost: order another photo".to_owned()])
    );
}

#[test]
fn a_photo_goes_on_whatever_is_halted_and_leaves_it_where_it_stands() {
    let mut test = Test::ready();
    test.hears("w 6 2000");
    test.reports(RobotEvent::Blocked(SIX, Obstacle::Unknown));
    test.hears("photo 7 4000");
    test.asked();
    test.said();
    test.hears("h 6");
    assert_eq!(test.said(), ["blocked 6 none unknown"]);
    test.hears("h 8");
    assert_eq!(test.said(), Vec::<String>::new(), "it is busy");
    test.robot.handle_lost();
    assert_eq!(test.asked(), []);
    test.reports(RobotEvent::PhotoFailed(OrderId(7), "it is dark".to_owned()));
    test.hears("h 8");
    assert_eq!(test.said(), ["nophoto 7 it is dark", "halted 8 off"]);
}

#[test]
fn a_photo_for_a_program_that_is_gone_is_not_sent() {
    let mut test = Test::ready();
    test.hears("photo 6 4000");
    test.hears("from 7");
    assert!(matches!(&test.said()[..], [hello] if hello.ends_with("last=6")), "it is there, and not ready yet");
    test.reports(RobotEvent::Photo(SIX, Photo { bytes: Arc::from(*b"bytes"), media_type: "image/png" }));
    assert!(matches!(&test.said()[..], [hello] if hello.ends_with("last=7")));
}

#[test]
fn a_program_that_asks_and_never_reads_makes_nothing_grow() {
    let mut test = Test::ready();
    for _ in 0..1000 {
        test.hears("hello");
    }
    assert_eq!(test.said().len(), WAITING);
}
