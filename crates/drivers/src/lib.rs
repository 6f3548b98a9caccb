//! Drivers for robots that are not ours. A driver is sans-IO: orders, halts, bytes from the robot and the passing of
//! time go in; bytes for the robot and reports come out. Sockets, timers and files are handled by its caller.
//!
//! ```text
//!   Order ───────►┌────────┐ ─── Output::Send ──► the robot
//!   a halt ──────►│ driver │ ◄── bytes ──────────
//!   the LED ─────►│        │ ─── memory ────────► a small file, before anybody is told
//!                 └────────┘ ─── RobotEvent ────► the core
//! ```
//! A driver does not decide what to do next: it gets one order at a time, and answers it once.

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

    /// The connection is lost, or could not be made. `words` gives the reason.
    fn handle_lost(&mut self, words: &str, now: Now);

    /// The connection that `Output::Reconnect` was to end is closed. The flag is false if the robot did not close its
    /// side in time.
    fn handle_closed(&mut self, _by_both: bool, _: Now) {}

    /// Bytes from the robot: any piece of a stream, or one whole message.
    fn handle_received(&mut self, bytes: &[u8], now: Now);

    /// The bytes of the latest `Output::Send` were passed to the operating system.
    fn handle_sent(&mut self, now: Now);

    /// Begins an order, or answers at once why it cannot begin.
    fn handle_order(&mut self, order: Order, now: Now);

    /// Halts the robot, whatever it does. A photo is no motion, so it goes on.
    fn handle_halt(&mut self, now: Now);

    fn handle_led(&mut self, blinks: bool, now: Now);

    fn handle_drawing(&mut self, order: OrderId, drawing: Photo, now: Now);

    fn handle_timeout(&mut self, now: Now);

    fn poll_output(&mut self) -> Option<Output>;

    fn poll_event(&mut self) -> Option<RobotEvent>;

    /// When the next action is due, since the start of the run.
    fn poll_timeout(&self) -> Option<Duration>;

    /// The state of the robot that the next program needs, if it has changed. Store it before sending more to the
    /// robot and before passing on later reports. Always `None` for a robot that knows its own state.
    fn poll_memory(&mut self) -> Option<String> {
        None
    }

    fn is_off_centre(&self) -> OffCentre;
}

#[derive(Clone, Debug, PartialEq)]
pub enum Output {
    /// Send these bytes to the robot, in one piece.
    Send(Vec<u8>),
    /// Close the connection, wait until the robot has closed it too, and connect again. This is not reported as a lost
    /// link.
    Reconnect,
    /// Close an unusable connection, for this reason; the link is then lost.
    GiveUp(String),
    /// Draw the known surroundings ahead, as the photo of a robot without a camera.
    Draw(OrderId, Subject),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// The stamp printed on the drawing, as on a photo.
    pub stamp: Stamp,
    pub name: Option<String>,
}
