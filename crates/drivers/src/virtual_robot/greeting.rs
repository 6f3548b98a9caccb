//! Whether a page with the virtual robot is open. If so, the server of the first version greets each new client. When a
//! page is closed and opened again, the robot is at its start. The later versions do not report whether there is a
//! page.

use std::time::Duration;

use super::{Command, Dialect, Leg, LegStage, VirtualRobot};
use crate::Output;
use hallsweep_core::event::{RobotEvent, Whereabouts};

/// Longest wait for the server's greeting on a new connection.
pub(super) const GREETING: Duration = Duration::from_secs(1);

/// Number of connections in a row without a greeting that mean that there is no page. A single one may be due to a busy
/// server.
const UNGREETED: u8 = 2;

/// How often to check whether the page is still open, while the robot stands.
const LOOK: Duration = Duration::from_secs(1);

impl VirtualRobot {
    /// Handles a greeting: a page is open. The server greets all clients whenever one connects, so this need not be
    /// news.
    pub(super) fn greeted(&mut self) {
        if !self.is_connected {
            // The greeting came over a connection that was given up.
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

    /// Opening the page anew puts the robot back to its start.
    fn page_opened_anew(&mut self) {
        self.reckoning.put_home();
        (self.off_centre, self.unheard, self.lost, self.is_told_lost, self.met) = (false, None, None, false, None);
        self.is_changed = true;
    }

    /// Handles the first order after a fault that asked for the page to be opened anew. This server does not report
    /// whether this was done, so the order is taken as a sign that it was.
    pub(super) fn is_put_home(&mut self) {
        self.page_opened_anew();
        // The server may still wait for the end of a move in the closed page, and begin no other move.
        self.send(Command::Alarm);
        let pose = self.reckoning.pose();
        self.events.push_back(RobotEvent::Stands(Whereabouts { pose, off_centre: false }));
        self.answer(|order| RobotEvent::Halted(order, false));
    }

    /// Handles a missing greeting. There is no page, or the server is busy: it closes the connection in the former case
    /// only.
    pub(super) fn not_greeted(&mut self) {
        // The next connection is made immediately.
        (self.greeting, self.looked) = (None, self.now.saturating_sub(LOOK));
        self.go_down("no page of the virtual robot is open: open the address of its server in a browser");
    }

    /// Handles a closed connection. A server that works, and closes two connections in a row without a greeting, has no
    /// page.
    pub(super) fn closed(&mut self, by_both: bool) {
        if by_both && !self.is_greeted && !self.is_up {
            self.ungreeted = self.ungreeted.saturating_add(1);
            self.is_page_closed = self.ungreeted >= UNGREETED && !self.has_server_ended;
        }
    }

    pub(super) fn reconnect(&mut self) {
        // An alarm on another connection no longer counts.
        (self.is_connected, self.greeting, self.alarmed) = (false, None, None);
        self.outputs.push_back(Output::Reconnect);
    }

    /// When to check the page although no order is open. It may have been closed or opened anew, or another client may
    /// now receive the server's messages.
    pub(super) fn look(&self) -> Option<Duration> {
        let is_idle = self.is_connected && self.task.is_none() && self.greeting.is_none();
        (self.dialect == Dialect::Semicolons && is_idle).then_some(self.looked + LOOK)
    }

    /// Reports that the robot cannot be reached, once for each reason.
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
