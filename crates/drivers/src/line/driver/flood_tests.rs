//! Tests of the number of lines on the wire when very many STOPs, changes of the LED or photos come.

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::testing::{ADA, FORWARD, Test, photograph};
use super::*;
use crate::line::picture::PNG;

#[derive(Clone, Copy, Debug)]
enum Step {
    Stop,
    Order,
    Photograph,
    Answer(&'static str),
    Passes(u64),
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        8 => Just(Step::Stop),
        2 => Just(Step::Order),
        1 => Just(Step::Photograph),
        2 => prop_oneof![Just("done"), Just("halted"), Just("nophoto")].prop_map(Step::Answer),
        4 => (0..13_u64).prop_map(|tens| Step::Passes(tens * 10)),
    ]
}

struct Flooded {
    test: Test,
    written: Vec<(Duration, ToRobot)>,
}

impl Flooded {
    fn new() -> Flooded {
        Flooded { test: Test::up(ADA), written: Vec::new() }
    }

    fn step(&mut self, step: Step) {
        match step {
            Step::Stop => self.test.driver.handle_halt(self.test.now),
            Step::Order => self.test.order_within(FORWARD, 60_000),
            Step::Photograph => self.test.order_within(photograph(), 60_000),
            Step::Answer(word) => {
                let tail = if word == "done" { "" } else { " off" };
                self.test.hears(&format!("{word} {}{tail}", self.test.driver.seq));
            }
            Step::Passes(ms) => {
                for _ in 0..ms / 10 {
                    self.test.passes(10);
                    self.write();
                }
                // The robot is present and answers each halt before the driver closes the connection.
                self.test.hears("sonar 50");
                let soon = self.test.now.since_start + Duration::from_millis(200);
                if self.test.driver.open.as_ref().is_some_and(|open| open.is_halted && open.until < soon) {
                    self.step(Step::Answer("halted"));
                }
            }
        }
        self.test.events();
        self.write();
    }

    fn write(&mut self) {
        let now = self.test.now.since_start;
        let read = |text: String| (now, ToRobot::parse(&text).expect("the driver writes lines of the protocol"));
        self.written.extend(self.test.said().into_iter().map(read));
    }

    /// Number of lines of each kind that were written in the last second.
    fn within_a_second(&self) -> BTreeMap<&'static str, usize> {
        let mut counts = BTreeMap::new();
        let since = self.test.now.since_start.saturating_sub(Duration::from_secs(1));
        for (_, line) in self.written.iter().rev().take_while(|(at, _)| *at >= since) {
            let kind = match line {
                ToRobot::Halt(_) => "h",
                ToRobot::Order(..) => "order",
                ToRobot::Led(_) => "led",
                ToRobot::Hello | ToRobot::From(_) => "hello",
            };
            *counts.entry(kind).or_default() += 1;
        }
        counts
    }

    /// Whether the last halt is recent and voids every written motion, and no order was written after the halt.
    fn is_halted(&self) -> bool {
        let is_halt = |(_, line): &(Duration, ToRobot)| matches!(line, ToRobot::Halt(_));
        let Some(place) = self.written.iter().rposition(is_halt) else { return false };
        let (at, ToRobot::Halt(voids)) = self.written[place] else { return false };
        let is_voided = |line: &ToRobot| !matches!(line, ToRobot::Order(task, seq, _) if task.is_motion() && *seq > voids);
        self.test.now.since_start - at < REPEATED
            && self.written.iter().all(|(_, line)| is_voided(line))
            && !self.written[place..].iter().any(|(_, line)| matches!(line, ToRobot::Order(..)))
    }
}

proptest! {
    /// Tests safety S1, S6 (docs/safety.md).
    #[test]
    fn every_stop_of_a_flood_is_served_by_a_halt_that_is_young_and_behind_every_order(
        steps in prop::collection::vec(step(), 1..200),
    ) {
        let mut flooded = Flooded::new();
        let (mut motion_allowed, mut checked) = (false, 0);
        for step in steps {
            motion_allowed |= matches!(step, Step::Order);
            flooded.step(step);
            if matches!(step, Step::Stop) {
                prop_assert!(flooded.is_halted(), "{:?}", flooded.written);
                motion_allowed = false;
            }
            // After a STOP, a motion is not written again. Only a new order lets the robot move.
            let is_motion = |(_, line): &(Duration, ToRobot)| matches!(line, ToRobot::Order(task, ..) if task.is_motion());
            prop_assert!(motion_allowed || !flooded.written[checked..].iter().any(is_motion), "{:?}", flooded.written);
            checked = flooded.written.len();
            let lines = flooded.within_a_second();
            let [halts, orders] = ["h", "order"].map(|kind| lines.get(kind).copied().unwrap_or(0));
            prop_assert!(halts <= 11 + orders, "{halts} halts and {orders} orders within a second");
        }
    }
}

/// Safety S1: counts the lines that are written in addition to the usual ones. A wire of 9600 baud carries 960 bytes
/// a second.
#[test]
fn a_second_of_stops_without_end_writes_ten_halts_and_the_next_order_right_behind_them() {
    for moves in [false, true] {
        let mut flooded = Flooded::new();
        if moves {
            flooded.step(Step::Order);
        }
        for _ in 0..100 {
            (0..40).for_each(|_| flooded.step(Step::Stop));
            flooded.step(Step::Passes(10));
        }
        let halts = flooded.within_a_second()["h"];
        assert!((10..=11).contains(&halts), "{halts} halts; the robot moves: {moves}");
        flooded.step(Step::Answer("halted"));
        let before = flooded.written.len();
        flooded.step(Step::Order);
        assert!(matches!(flooded.written[before..], [(_, ToRobot::Order(RobotTask::Forward, ..))]));
    }
}

/// Safety S1: the halt was sent during the photo and names the motion before the photo, which is the last motion.
#[test]
fn a_halt_during_a_photo_serves_the_stop_right_after_the_photo() {
    let mut flooded = Flooded::new();
    for step in [Step::Order, Step::Answer("done"), Step::Photograph, Step::Stop, Step::Answer("nophoto"), Step::Stop] {
        flooded.step(step);
    }
    assert_eq!(flooded.within_a_second()["h"], 1);
    assert!(flooded.is_halted());
}

/// Safety S1: a halt that was written on a lost connection may not have arrived.
#[test]
fn a_halt_of_the_connection_before_serves_no_stop() {
    let mut test = Test::up(&ADA.replace("at=2,3", "at=0,0"));
    test.driver.seq = Seq::FIRST;
    test.driver.handle_halt(test.now);
    test.driver.handle_connected(test.now);
    test.driver.handle_halt(test.now);
    assert_eq!(test.said(), ["h 1", "", "hello", "h 1"]);
}

#[test]
fn of_a_flood_of_changes_of_the_led_the_first_is_told_at_once_and_the_last_with_the_next_hello() {
    let mut test = Test::up(ADA);
    for n in 0..40 {
        test.driver.handle_led(n % 2 == 0, test.now);
        test.driver.handle_led(true, test.now);
    }
    assert_eq!(test.said(), ["led blink"]);
    test.driver.handle_led(false, test.now);
    test.passes(500);
    assert_eq!(test.said(), ["hello", "led off"]);
}

#[test]
fn a_robot_that_sends_photos_without_end_is_not_asked_more_often_who_it_is() {
    let mut flooded = Flooded::new();
    for _ in 0..100 {
        flooded.test.photo(PNG, PNG);
        flooded.step(Step::Passes(10));
    }
    assert_eq!(flooded.within_a_second(), BTreeMap::from([("hello", 2), ("led", 2)]));
}
