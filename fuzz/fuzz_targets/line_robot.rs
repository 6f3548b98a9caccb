//! The line protocol: with any bytes on the wire, cut anywhere, both ends continue and stay within their bounds, they
//! parse what they send themselves, and an order is answered at most once.
#![no_main]

use std::time::Duration;

use hallsweep_drivers::line::{FromRobot, LineDriver, LineReader, LineRobot, RobotName, ToRobot, framed};
use hallsweep_drivers::{Driver, Output};
use hallsweep_fuzz::core::command::Move;
use hallsweep_fuzz::core::effect::{Action, Order};
use hallsweep_fuzz::core::event::{Capabilities, RobotEvent};
use hallsweep_fuzz::core::robot::Parts;
use hallsweep_fuzz::core::units::{Epoch, Now, OrderId};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((cut, bytes)) = bytes.split_first() else { return };
    let cut = usize::from(*cut).max(1);
    read_back(bytes);
    to_the_driver(bytes, cut);
    to_the_robot(bytes, cut);
});

/// Every valid line parses as a message that is printed and parsed as the same, or as none. A checksum is added to
/// each line, so that the parser of messages is reached too.
fn read_back(bytes: &[u8]) {
    let mut reader = LineReader::default();
    let lines = bytes.split(|byte| *byte == b'\n').filter_map(|line| std::str::from_utf8(line).ok());
    for text in lines.flat_map(framed).filter_map(|byte| reader.take(byte)) {
        if let Some(said) = ToRobot::parse(&text) {
            assert_eq!(ToRobot::parse(&said.to_string()), Some(said));
        }
        if let Some(said) = FromRobot::parse(&text) {
            assert_eq!(FromRobot::parse(&said.to_string()), Some(said));
        }
    }
}

fn to_the_driver(bytes: &[u8], cut: usize) {
    let (mut driver, mut now) = (LineDriver::new(), Now::default());
    driver.handle_connected(now);
    let (mut given, mut open, mut up) = (0, None, false);
    for piece in bytes.chunks(cut) {
        driver.handle_received(piece, now);
        now.since_start += Duration::from_millis(10);
        driver.handle_timeout(now);
        while let Some(output) = driver.poll_output() {
            match output {
                Output::GiveUp(words) => driver.handle_lost(&words, now),
                Output::Send(_) | Output::Reconnect | Output::Draw(..) => {}
            }
        }
        while let Some(event) = driver.poll_event() {
            match event {
                RobotEvent::LinkUp(_) => up = true,
                RobotEvent::LinkLost(_) => (up, open) = (false, None),
                RobotEvent::Done(id) | RobotEvent::Blocked(id, _) | RobotEvent::Halted(id, _) | RobotEvent::Failed(id, _) => {
                    assert_eq!(open.take(), Some(id), "an order is answered once");
                }
                _ => {}
            }
        }
        if up && open.is_none() {
            given += 1;
            open = Some(OrderId(given));
            let action = Action::Move(Move::Forward);
            let order = Order { id: OrderId(given), action, epoch: Epoch(0), deadline: Duration::from_secs(1) };
            driver.handle_order(order, now);
        }
    }
}

fn to_the_robot(bytes: &[u8], cut: usize) {
    let mut now = Now::default();
    let mut robot = LineRobot::new(RobotName::new("fuzzed").expect("it is a name"));
    let (ms, parts) = (Duration::from_millis(9), Parts::ROUND_ROBOT);
    robot.handle_event(RobotEvent::LinkUp(Capabilities { step: ms, turn: ms, photo: ms, arm: ms, nudges: false, parts }));
    for piece in bytes.chunks(cut) {
        robot.handle_received(piece, now);
        now.since_start += Duration::from_millis(100);
        robot.handle_timeout(now);
        while robot.poll_asked().is_some() {}
        let said = std::iter::from_fn(|| robot.poll_output()).count();
        assert!(said <= 32, "{said} lines wait at most");
    }
}
