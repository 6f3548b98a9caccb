//! Floods of STOPs at an interface, while the robot is at the end of a slow wire.

use std::sync::mpsc::Receiver;
use std::time::Instant;

use super::terminals::Terminals;
use super::{Emulator, has, serve};
use crate::program::PATIENCE;
use crate::stop_floods::pipelined;

/// Number of STOPs, far more than the slow wire can carry during the flood.
const STOPS: usize = 4_000;

/// Largest number of halts after the flood: halts on the way when the next order is written, and halts of STOPs that
/// the program had not finished.
const STRAGGLERS: usize = 5;

/// Lines up to and including the next motion.
fn until_motion(said: &Receiver<String>) -> Vec<String> {
    let is_motion = |line: &String| line.starts_with(['w', 'a', 'd', 'c']);
    let mut lines = Vec::new();
    while !lines.last().is_some_and(is_motion) {
        lines.push(said.recv_timeout(PATIENCE).expect("the robot is told to move"));
    }
    lines
}

fn halts(lines: &[String]) -> usize {
    lines.iter().filter(|line| line.starts_with("h ")).count()
}

/// Safety S1, S6. At most ten halts a second are written. With hundreds of halts in the queue the link would be lost,
/// or the next order would arrive seconds later.
#[test]
#[expect(clippy::disallowed_methods, reason = "how many halts there may be follows from how long the flood lasts")]
fn over_a_slow_wire_a_flood_of_stops_leaves_the_link_up_and_the_next_order_in_front() {
    for baud in [9_600, 115_200] {
        let (cable, said) = Terminals::slow(baud / 10);
        let _emulator = Emulator::with(&["--serial", &cable.robot, "--hall", "empty-8x8"]);
        let program = serve(&cable.program);
        program.command("start").accepted();
        until_motion(&said);
        let began = Instant::now();
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| pipelined(&program, "POST /h HTTP/1.1\r\nHost: localhost\r\n\r\n", STOPS / 4));
            }
        });
        let seconds = began.elapsed().as_secs() + 1;
        assert!(!has(&program.read("/api/v1/state", &[]).json(), "robotLink"), "{baud} baud");
        let during: Vec<String> = said.try_iter().collect();
        let most = 10 * usize::try_from(seconds).expect("it is over") + STRAGGLERS;
        assert!((1..=most).contains(&halts(&during)), "{baud} baud: {} halts in {seconds} s", halts(&during));
        program.command("start").accepted();
        let until_order = until_motion(&said);
        assert!(halts(&until_order) <= STRAGGLERS, "{baud} baud: {until_order:?}");
        let greeted_again = during.iter().chain(&until_order).any(|line| line.starts_with("from "));
        assert!(!greeted_again, "{baud} baud: the link was lost and found again");
    }
}
