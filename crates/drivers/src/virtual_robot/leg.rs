//! One motion of the virtual robot, from its request to its end. The server does not report the end, or reports it too
//! early. So each motion has a time after which it has ended if nothing was met.

use std::time::Duration;

use super::words::Command;
use hallsweep_core::units::Heading;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    pub(super) way: Way,
    pub(super) stage: LegStage,
    pub(super) is_acknowledged: bool,
    /// Whether a halt has come that the motion cannot obey. A turn ends by itself, and is not begun again.
    pub(super) is_halted: bool,
    /// When the server first refused the motion, and whether an alarm was sent since then to end the motion that the
    /// server believes to be under way.
    pub(super) refused: Option<(Duration, bool)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// Straight ahead or backwards: the direction, the length in cells and the duration; then the cells left for
    /// further legs, and the duration of the legs before this one.
    Straight { towards: Heading, cells: f64, backward: bool, lasts: Duration, rest: f64, before: Duration },
    /// A quarter turn.
    Turn { left: bool, lasts: Duration },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LegStage {
    /// The motion waits for a new connection, which shows that a page is open and that the server's messages come to
    /// us.
    Fresh,
    /// The motion was refused because another one was under way. It is tried again at this time.
    Refused(Duration),
    /// The motion was handed over for sending, and is not confirmed as sent.
    Queued,
    /// The motion was confirmed as sent at this time, since the start of the run.
    Sent(Duration),
    /// The motion was cut short after `lasted`. Until `until` the report of an earlier contact may come.
    Halting { lasted: Duration, until: Duration },
}

impl Leg {
    pub(super) const fn new(way: Way, stage: LegStage) -> Leg {
        Leg { way, stage, is_acknowledged: false, is_halted: false, refused: None }
    }

    pub(super) const fn command(&self) -> Command {
        match self.way {
            Way::Straight { backward: false, lasts, .. } => Command::Forward(lasts),
            Way::Straight { backward: true, lasts, .. } => Command::Backward(lasts),
            Way::Turn { left: true, lasts } => Command::Left(lasts),
            Way::Turn { left: false, lasts } => Command::Right(lasts),
        }
    }

    pub(super) const fn lasts(&self) -> Duration {
        match self.way {
            Way::Straight { lasts, .. } | Way::Turn { lasts, .. } => lasts,
        }
    }

    /// Whether the robot may be in this motion.
    pub(super) const fn is_sent(&self) -> bool {
        matches!(self.stage, LegStage::Sent(_) | LegStage::Halting { .. })
    }
}
