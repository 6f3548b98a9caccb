//! One leg: a motion of the virtual robot by one command. The server reports the end of a leg too early or not at
//! all. So each leg has a duration, after which it counts as ended if nothing was met.

use std::time::Duration;

use super::words::Command;
use hallsweep_core::units::Heading;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    pub(super) way: Way,
    pub(super) stage: LegStage,
    pub(super) is_acknowledged: bool,
    /// Whether the leg was halted but cannot stop: a turn goes on to its end. If the server refuses a halted turn,
    /// the turn is not tried again.
    pub(super) is_halted: bool,
    /// When the server first refused the motion. The flag says whether an alarm was sent after that, to end the other
    /// motion that the server reports.
    pub(super) refused: Option<(Duration, bool)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// A straight motion: direction, length in cells, and duration. `rest` is the length of the legs that follow, in
    /// cells. `before` is the duration of the earlier legs.
    Straight { towards: Heading, cells: f64, backward: bool, lasts: Duration, rest: f64, before: Duration },
    /// A quarter turn.
    Turn { left: bool, lasts: Duration },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LegStage {
    /// The motion waits for a new connection. The server's greeting on this connection shows that a page is open and
    /// that the server sends its messages to this program.
    Fresh,
    /// The server refused the motion because another one was running. It is tried again at this time.
    Refused(Duration),
    /// The motion was handed over for sending, but it is not confirmed as sent yet.
    Queued,
    /// The motion was confirmed as sent at this time, counted from the start of the run.
    Sent(Duration),
    /// The motion was cut short after `lasted`. Until `until`, an earlier contact may still be reported.
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

    /// Whether the robot may be carrying out this motion.
    pub(super) const fn is_sent(&self) -> bool {
        matches!(self.stage, LegStage::Sent(_) | LegStage::Halting { .. })
    }
}
