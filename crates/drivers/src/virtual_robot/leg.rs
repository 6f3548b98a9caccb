//! One motion of the virtual robot: from the moment it is wanted to its end. Its server says nothing of the end, or says it too early, so
//! each has a time at which it has ended when nothing was met.

use std::time::Duration;

use super::words::Command;
use hallsweep_core::units::Heading;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    pub(super) way: Way,
    pub(super) stage: LegStage,
    /// Whether the server has said that it has ended.
    pub(super) is_acknowledged: bool,
    /// Whether a halt has come that it cannot obey: a turn ends by itself, and is not begun again.
    pub(super) is_halted: bool,
    /// When the server first refused it, and whether an alarm has been sent since to end what it believes to be under way.
    pub(super) refused: Option<(Duration, bool)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// So many cells this way, with its front ahead or behind, and how long that is asked for; so many cells are left for further
    /// legs, and so long the legs before it have lasted.
    Straight { towards: Heading, cells: f64, backward: bool, lasts: Duration, rest: f64, before: Duration },
    /// A quarter turn.
    Turn { left: bool, lasts: Duration },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LegStage {
    /// It waits for a new connection, which shows that a page is open and that what it says comes to us.
    Fresh,
    /// It was not begun, because another one was under way, and is tried again then.
    Refused(Duration),
    /// It is on its way to the robot.
    Queued,
    /// It was sent at this time.
    Sent(Duration),
    /// It was cut short when it had lasted so long; until then the word of a contact before may come.
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

    /// Whether the robot may be moving by it.
    pub(super) const fn is_sent(&self) -> bool {
        matches!(self.stage, LegStage::Sent(_) | LegStage::Halting { .. })
    }
}
