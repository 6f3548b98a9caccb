//! The lines from the program to the robot: writes and reads their texts. `driver` decides when they are sent.

use std::fmt;

use super::numbers::{Seq, number};
use hallsweep_core::units::Pose;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToRobot {
    Hello,
    /// Halt. All orders up to this number are void, and new orders have greater numbers.
    From(Seq),
    /// An order with its number. After the given milliseconds, the robot halts by itself.
    Order(RobotTask, Seq, u32),
    /// Halt. All orders up to this number are void.
    Halt(Seq),
    Led(bool),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotTask {
    Forward,
    Backward,
    /// Turn 90° to the left.
    Left,
    /// Turn 90° to the right.
    Right,
    /// Drive back to the centre of the cell, and turn to the heading of the last completed order.
    Recentre,
    Photo,
}

impl RobotTask {
    const ALL: [RobotTask; 6] =
        [RobotTask::Forward, RobotTask::Backward, RobotTask::Left, RobotTask::Right, RobotTask::Recentre, RobotTask::Photo];

    const fn word(self) -> &'static str {
        match self {
            RobotTask::Forward => "w",
            RobotTask::Backward => "s",
            RobotTask::Left => "a",
            RobotTask::Right => "d",
            RobotTask::Recentre => "c",
            RobotTask::Photo => "photo",
        }
    }

    #[must_use]
    pub fn is_motion(self) -> bool {
        self != RobotTask::Photo
    }

    pub(super) const fn after(self, pose: Pose) -> Pose {
        let Pose { cell, heading } = pose;
        match self {
            RobotTask::Forward => Pose { cell: cell.ahead(heading), heading },
            RobotTask::Backward => Pose { cell: cell.ahead(heading.opposite()), heading },
            RobotTask::Left => Pose { cell, heading: heading.left() },
            RobotTask::Right => Pose { cell, heading: heading.right() },
            RobotTask::Recentre | RobotTask::Photo => pose,
        }
    }
}

impl ToRobot {
    #[must_use]
    pub fn parse(text: &str) -> Option<ToRobot> {
        let words: Vec<&str> = text.split(' ').collect();
        match words[..] {
            ["hello"] => Some(ToRobot::Hello),
            ["from", seq] => Seq::read(seq).map(ToRobot::From),
            ["h", seq] => Seq::read(seq).map(ToRobot::Halt),
            ["led", "blink"] => Some(ToRobot::Led(true)),
            ["led", "off"] => Some(ToRobot::Led(false)),
            [word, seq, deadline] => {
                let task = RobotTask::ALL.into_iter().find(|task| task.word() == word)?;
                Some(ToRobot::Order(task, Seq::read(seq)?, number(deadline)?))
            }
            _ => None,
        }
    }
}

impl fmt::Display for ToRobot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ToRobot::Hello => f.write_str("hello"),
            ToRobot::From(seq) => write!(f, "from {seq}"),
            ToRobot::Order(task, seq, deadline_ms) => write!(f, "{} {seq} {deadline_ms}", task.word()),
            ToRobot::Halt(seq) => write!(f, "h {seq}"),
            ToRobot::Led(blinks) => f.write_str(if *blinks { "led blink" } else { "led off" }),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::line::framed;

    /// Longest line to the robot, with check and line feed, in bytes. A small robot needs a buffer of this size.
    const ROOM: usize = 40;

    fn said() -> impl Strategy<Value = ToRobot> {
        let seq = (1..=Seq::LAST.number()).prop_map(|number| Seq::new(number).expect("it is within"));
        let task = prop::sample::select(&RobotTask::ALL[..]);
        prop_oneof![
            Just(ToRobot::Hello),
            seq.clone().prop_map(ToRobot::From),
            seq.clone().prop_map(ToRobot::Halt),
            any::<bool>().prop_map(ToRobot::Led),
            (task, seq, any::<u32>()).prop_map(|(task, seq, deadline)| ToRobot::Order(task, seq, deadline)),
        ]
    }

    #[test]
    fn the_texts_are_those_of_the_documentation() {
        let seven = Seq::new(7).expect("seven is one");
        for (said, text) in [
            (ToRobot::From(seven), "from 7"),
            (ToRobot::Order(RobotTask::Forward, seven, 1990), "w 7 1990"),
            (ToRobot::Order(RobotTask::Photo, seven, 4000), "photo 7 4000"),
            (ToRobot::Halt(seven), "h 7"),
            (ToRobot::Led(true), "led blink"),
        ] {
            assert_eq!(said.to_string(), text);
        }
    }

    #[test]
    fn what_says_nothing_is_nothing() {
        for wrong in
            ["", "w", "w 7", "w 0 1990", "w 7 1990 1", "w  7 1990", "x 7 1990", "h", "h 0", "h 4294967295", "led", "led on"]
        {
            assert_eq!(ToRobot::parse(wrong), None, "{wrong}");
        }
    }

    proptest! {
        #[test]
        fn what_is_said_is_read_back_and_fits_a_small_buffer(said in said()) {
            prop_assert_eq!(ToRobot::parse(&said.to_string()), Some(said));
            prop_assert!(framed(&said.to_string()).len() <= ROOM);
        }

        #[test]
        fn any_text_says_something_or_nothing(text in any::<String>()) {
            if let Some(said) = ToRobot::parse(&text) {
                prop_assert_eq!(ToRobot::parse(&said.to_string()), Some(said));
            }
        }
    }
}
