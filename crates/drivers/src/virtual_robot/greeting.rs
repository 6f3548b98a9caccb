//! Whether a page is open in which the virtual robot stands: the server of the first version greets whoever connects, when there is one.
//! A page that is closed and opened again has the robot at its start. The later versions do not say whether there is one.

use std::time::Duration;

use super::{Command, Dialect, Leg, LegStage, VirtualRobot};
use crate::Output;
use hallsweep_core::event::{RobotEvent, Whereabouts};

/// So long a greeting is waited for when a connection was made.
pub(super) const GREETING: Duration = Duration::from_secs(1);

/// So many connections in a row that are not greeted say that there is no page: one may be that of a server that is busy.
const UNGREETED: u8 = 2;

/// So often it is looked whether its page is still open, while it stands.
const LOOK: Duration = Duration::from_secs(1);

impl VirtualRobot {
    /// A page is open. The server says so to all when anybody connects, so it need not be news.
    pub(super) fn greeted(&mut self) {
        if !self.is_connected {
            // It was said over a connection that is given up.
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

    /// Whoever opens its page anew puts it back to where it starts.
    fn page_opened_anew(&mut self) {
        self.reckoning.put_home();
        (self.off_centre, self.unheard, self.lost, self.is_told_lost, self.met) = (false, None, None, false, None);
        self.is_changed = true;
    }

    /// Where nobody can see whether the page was opened anew, the first order after the fault that asks for it says so.
    pub(super) fn is_put_home(&mut self) {
        self.page_opened_anew();
        // Its server may still wait for the end of a move in the page that was closed, and begin no other.
        self.send(Command::Alarm);
        let pose = self.reckoning.pose();
        self.events.push_back(RobotEvent::Stands(Whereabouts { pose, off_centre: false }));
        self.answer(|order| RobotEvent::Halted(order, false));
    }

    /// Whether there is no page, or the server is busy, shows when it closes the connection, or not.
    pub(super) fn not_greeted(&mut self) {
        // The next connection is made at once.
        (self.greeting, self.looked) = (None, self.now.saturating_sub(LOOK));
        self.go_down("no page of the virtual robot is open: open the address of its server in a browser");
    }

    /// A well server that closes one connection without having greeted it, and the next, has no page.
    pub(super) fn closed(&mut self, by_both: bool) {
        if by_both && !self.is_greeted && !self.is_up {
            self.ungreeted = self.ungreeted.saturating_add(1);
            self.is_page_closed = self.ungreeted >= UNGREETED && !self.has_server_ended;
        }
    }

    /// A new connection is made: until it stands nothing is waited for.
    pub(super) fn reconnect(&mut self) {
        // Over another connection no alarm of this one serves.
        (self.is_connected, self.greeting, self.alarmed) = (false, None, None);
        self.outputs.push_back(Output::Reconnect);
    }

    /// When it is to be looked after although nothing is wanted of it: a page may be closed or opened anew, or another client may have
    /// taken what the server says.
    pub(super) fn look(&self) -> Option<Duration> {
        let is_idle = self.is_connected && self.task.is_none() && self.greeting.is_none();
        (self.dialect == Dialect::Semicolons && is_idle).then_some(self.looked + LOOK)
    }

    /// The core is told that it cannot be reached, once for each reason.
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
