//! The line protocol, for robots that people build themselves. It runs over TCP or a serial device. For authors of a
//! robot's program, it is described in `docs/robot-line-protocol.md`.
//!
//! ```text
//!   Driver of the program             wire              end of the robot
//!   driver ──► to_robot ──► frame ═════════════► frame ──► to_robot ──► robot
//!   driver ◄── from_robot ◄─ frame ◄═════════════ frame ◄── from_robot ◄── robot
//!          ◄── crc of the bytes of a photo
//! ```
//! Both ends do no input or output of their own. The robot's end is not bound to the simulator. It passes requests to
//! the robot's body and sends the body's reports.

mod answers;
mod crc;
mod driver;
mod frame;
mod from_robot;
mod greeting;
mod numbers;
mod picture;
mod robot;
mod to_robot;

#[cfg(test)]
mod wire_tests;

pub use self::driver::LineDriver;
pub use self::frame::{LONGEST, LineReader, framed};
pub use self::from_robot::{FromRobot, Hello, RobotName, Words};
pub use self::numbers::Seq;
pub use self::picture::MOST_BYTES;
pub use self::robot::{BodyRequest, LineRobot};
pub use self::to_robot::{RobotTask, ToRobot};
