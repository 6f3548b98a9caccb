//! Robots that are not ours, each behind a driver of its own. A driver is sans-IO: orders, halts, bytes from the robot and the passing
//! of time go in; bytes for the robot and reports come out. Sockets, timers and files are the business of whoever runs it.
//!
//! ```text
//!   Order ───────►┌────────┐ ─── Output::Send ──► the robot
//!   a halt ──────►│ driver │ ◄── bytes ──────────
//!   the LED ─────►│        │ ─── memory ────────► a small file, before anybody is told
//!                 └────────┘ ─── RobotEvent ────► the core
//! ```
//! What to do next is decided by nobody here: a driver gets one order at a time, and answers it once.

pub mod line;
mod virtual_robot;

use std::fmt;
use std::time::Duration;

pub use virtual_robot::{Dialect, Extent, Room, Thing, VirtualRobot};

use hallsweep_core::effect::{Order, Stamp};
use hallsweep_core::event::{OffCentre, Photo, RobotEvent};
use hallsweep_core::units::{Now, OrderId};

/// What speaks to one robot.
pub trait Driver: fmt::Debug + Send {
    /// A new connection to the robot stands.
    fn handle_connected(&mut self, now: Now);

    /// The connection is lost, or could not be made; why.
    fn handle_lost(&mut self, words: &str, now: Now);

    /// The connection that `Output::Reconnect` was to end has ended; whether the robot has closed it too, and did so within its time.
    fn handle_closed(&mut self, _by_both: bool, _: Now) {}

    /// What the robot sent: of a stream any piece of it, of a protocol of messages a whole one.
    fn handle_received(&mut self, bytes: &[u8], now: Now);

    /// What `Output::Send` asked for has been handed over.
    fn handle_sent(&mut self, now: Now);

    /// Begins an order, or answers at once why it cannot.
    fn handle_order(&mut self, order: Order, now: Now);

    /// Halts the robot, whatever it does. A photo is no motion and goes on.
    fn handle_halt(&mut self, now: Now);

    /// Lets the LED blink, or not, where there is one.
    fn handle_led(&mut self, blinks: bool, now: Now);

    /// The drawing that `Output::Draw` asked for.
    fn handle_drawing(&mut self, order: OrderId, drawing: Photo, now: Now);

    /// Lets time pass: everything that is due by `now` happens.
    fn handle_timeout(&mut self, now: Now);

    /// What is to be done for it next.
    fn poll_output(&mut self) -> Option<Output>;

    /// The next report, if there is one.
    fn poll_event(&mut self) -> Option<RobotEvent>;

    /// When something will happen next by itself, since the start of the run.
    fn poll_timeout(&self) -> Option<Duration>;

    /// What the next program must know of the robot, if that has changed: it is to be kept before the robot is told more and before
    /// anybody is told of reports that follow. `None` always where the robot knows itself.
    fn poll_memory(&mut self) -> Option<String> {
        None
    }

    /// Whether the robot stands away from the centre of its cell.
    fn is_off_centre(&self) -> OffCentre;
}

/// What a driver wants done.
#[derive(Clone, Debug, PartialEq)]
pub enum Output {
    /// Send this to the robot, in one piece.
    Send(Vec<u8>),
    /// Close the connection, wait until the robot has closed it too, and make a new one. It is no loss: nobody is told.
    Reconnect,
    /// Close the connection as one that is no good any more, for this reason; it is then lost.
    GiveUp(String),
    /// Draw what is known of what is ahead, for a robot that has no camera.
    Draw(OrderId, Subject),
}

/// What a drawing shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// What is written on it, as on a photo.
    pub stamp: Stamp,
    /// What the robot calls the thing ahead, if it has said.
    pub name: Option<String>,
}
