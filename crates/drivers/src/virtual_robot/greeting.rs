//! Finds out whether a page with the virtual robot is open. Only the first version of the server shows this: with a
//! page, it greets each new client. When a page is closed and opened again, the robot is at its start.

use std::time::Duration;

use super::{Command, Dialect, Leg, LegStage, VirtualRobot};
use crate::Output;
use hallsweep_core::event::{RobotEvent, Whereabouts};

/// Longest wait for the server's greeting after connecting.
pub(super) const GREETING: Duration = Duration::from_secs(1);

/// After this number of connections in a row without a greeting, the page counts as closed. One missing greeting may
/// only mean that the server is busy.
const UNGREETED: u8 = 2;

/// How often to check whether the page is still open while the robot stands still.
const LOOK: Duration = Duration::from_secs(1);

impl VirtualRobot {
    /// Handles a greeting, which means that a page is open. The server greets all clients whenever one connects, so
    /// the open page may already be known.
    pub(super) fn greeted(&mut self) {
        if !self.is_connected {
            // The greeting came over a connection that was already closed from this side.
            return;
        }
        if !self.is_greeted {
            self.greeted_after = self.now.saturating_sub(self.connected);
        }
        (self.greeting, self.looked, self.is_greeted, self.has_server_ended, self.ungreeted) = (None, self.now, true, false, 0);
        if std::mem::take(&mut self.is_page_closed) {
            self.page_opened_anew();
        }
        if matches!(self.leg(), Some(Leg { stage: LegStage::Fresh, .. })) {
            self.queue();
        } else if !self.is_up {
            (self.is_up, self.said) = (true, None);
            let whereabouts = Whereabouts { pose: self.reckoning.pose(), off_centre: self.off_centre };
            self.events.extend([RobotEvent::Stands(whereabouts), RobotEvent::LinkUp(self.can())]);
        }
    }

    /// Handles that the page was opened anew. The robot is then at its start.
    fn page_opened_anew(&mut self) {
        self.reckoning.put_home();
        (self.off_centre, self.unheard, self.lost, self.is_told_lost, self.met) = (false, None, None, false, None);
        self.is_changed = true;
    }

    /// Handles the first order after a fault that asked the user to reload the page. The server does not report
    /// whether the user did it. So the order is taken as the sign that the page was reloaded.
    pub(super) fn is_put_home(&mut self) {
        self.page_opened_anew();
        // The server may still wait for the end of a move in the closed page. Until then it begins no other move.
        self.send(Command::Alarm);
        let pose = self.reckoning.pose();
        self.events.push_back(RobotEvent::Stands(Whereabouts { pose, off_centre: false }));
        self.answer(|order| RobotEvent::Halted(order, false));
    }

    /// Handles a missing greeting. Either there is no page, or the server is busy. Only without a page does the
    /// server also close the connection.
    pub(super) fn not_greeted(&mut self) {
        // This makes the next check due at once.
        (self.greeting, self.looked) = (None, self.now.saturating_sub(LOOK));
        self.go_down("no page of the virtual robot is open: open the address of its server in a browser");
    }

    /// Handles a closed connection. If a working server closes several connections in a row (`UNGREETED`) without a
    /// greeting, it has no page.
    pub(super) fn closed(&mut self, by_both: bool) {
        if by_both && !self.is_greeted && !self.is_up {
            self.ungreeted = self.ungreeted.saturating_add(1);
            self.is_page_closed = self.ungreeted >= UNGREETED && !self.has_server_ended;
        }
    }

    pub(super) fn reconnect(&mut self) {
        // An alarm that was sent over another connection does not count here.
        (self.is_connected, self.greeting, self.alarmed) = (false, None, None);
        self.outputs.push_back(Output::Reconnect);
    }

    /// When to check the page next while no order is open. The page may have been closed or opened anew, or the
    /// server may send its messages to another client now.
    pub(super) fn look(&self) -> Option<Duration> {
        let is_idle = self.is_connected && self.task.is_none() && self.greeting.is_none();
        (self.dialect == Dialect::Semicolons && is_idle).then_some(self.looked + LOOK)
    }

    /// Reports that the robot cannot be reached, but only once for the same reason.
    pub(super) fn go_down(&mut self, words: &str) {
        self.leave_unheard();
        let is_new = self.said.as_deref() != Some(words);
        if std::mem::take(&mut self.is_up) || is_new {
            self.events.push_back(RobotEvent::LinkLost(words.to_owned()));
        }
        self.said = Some(words.to_owned());
    }

    pub(super) fn look_after_page(&mut self) {
        if self.greeting.is_some_and(|at| at <= self.now) {
            self.not_greeted();
        }
        if self.look().is_some_and(|at| at <= self.now) {
            self.reconnect();
        }
    }
}
