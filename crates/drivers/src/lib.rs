//! Drivers for robots that are not simulated by this program. A driver does no input or output of its own. Orders,
//! halts, bytes from the robot and the time go in. Bytes for the robot and reports come out. The caller handles
//! sockets, timers and files.
//!
//! ```text
//!   Order ───────►┌────────┐ ─── Output::Send ──► the robot
//!   a halt ──────►│ driver │ ◄── bytes ──────────
//!   the LED ─────►│        │ ─── memory ────────► a small file, before reports are passed on
//!                 └────────┘ ─── RobotEvent ────► the core
//! ```
//! A driver does not decide what to do next. It gets one order at a time and answers it once.

pub mod line;
mod virtual_robot;

use std::fmt;
use std::time::Duration;

pub use virtual_robot::{Dialect, Extent, Room, Thing, VirtualRobot};

use hallsweep_core::effect::{Order, Stamp};
use hallsweep_core::event::{OffCentre, Photo, RobotEvent};
use hallsweep_core::units::{Now, OrderId};

pub trait Driver: fmt::Debug + Send {
    fn handle_connected(&mut self, now: Now);

    /// The connection was lost or could not be made. `words` is the reason.
    fn handle_lost(&mut self, words: &str, now: Now);

    /// The connection was closed, as `Output::Reconnect` requested. The flag is false if the robot did not close its
    /// side in time.
    fn handle_closed(&mut self, _by_both: bool, _: Now) {}

    /// Bytes came from the robot: any part of a stream, or one whole message.
    fn handle_received(&mut self, bytes: &[u8], now: Now);

    /// The bytes of the latest `Output::Send` were passed to the operating system.
    fn handle_sent(&mut self, now: Now);

    /// Begins an order, or reports at once why it cannot begin.
    fn handle_order(&mut self, order: Order, now: Now);

    /// Halts the robot, whatever the robot is doing. A photo is not a motion, so it goes on.
    fn handle_halt(&mut self, now: Now);

    fn handle_led(&mut self, blinks: bool, now: Now);

    fn handle_drawing(&mut self, order: OrderId, drawing: Photo, now: Now);

    fn handle_timeout(&mut self, now: Now);

    fn poll_output(&mut self) -> Option<Output>;

    fn poll_event(&mut self) -> Option<RobotEvent>;

    /// When the next action is due, counted from the start of the run.
    fn poll_timeout(&self) -> Option<Duration>;

    /// The robot's state that the next run of the program needs. `None` if the state has not changed since the last
    /// call. Always `None` for a robot that remembers its own state. Store the state before sending more to the
    /// robot and before passing on later reports.
    fn poll_memory(&mut self) -> Option<String> {
        None
    }

    fn is_off_centre(&self) -> OffCentre;
}

#[derive(Clone, Debug, PartialEq)]
pub enum Output {
    /// Send these bytes to the robot, in one piece.
    Send(Vec<u8>),
    /// Close the connection, wait until the robot has closed it too, and connect again. This is not a lost link and
    /// is not reported as one.
    Reconnect,
    /// Close an unusable connection for this reason. The link is then reported as lost.
    GiveUp(String),
    /// Draw what is known about the cells ahead. The drawing replaces a photo if the robot has no camera.
    Draw(OrderId, Subject),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// The stamp that is printed on the drawing, as on a photo.
    pub stamp: Stamp,
    pub name: Option<String>,
}
