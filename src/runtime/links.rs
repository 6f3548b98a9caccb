//! The loop's ends of the links to all robots, by their ids.

use std::future::poll_fn;
use std::task::{Context, Poll};

use super::halt::Halts;
use super::link::{RobotLink, Stamped};
use hallsweep_core::effect::Order;
use hallsweep_core::event::{RobotEvent, RobotId};

/// The links to all robots.
pub(super) struct Links {
    links: Vec<Link>,
    /// Whose report was taken last: the one behind it is asked first, so that none reports over the others.
    last: usize,
}

struct Link {
    robot: RobotId,
    ends: RobotLink,
    /// Whether the adapter's end is gone for good.
    has_ended: bool,
}

impl Links {
    pub(super) fn new(links: impl IntoIterator<Item = (RobotId, RobotLink)>) -> Links {
        let link = |(robot, ends)| Link { robot, ends, has_ended: false };
        Links { links: links.into_iter().map(link).collect(), last: 0 }
    }

    /// The next report of any robot. That an adapter has ended is reported once, as a lost link.
    pub(super) async fn report(&mut self) -> (RobotId, RobotEvent) {
        poll_fn(|context| self.poll_report(context)).await
    }

    fn poll_report(&mut self, context: &mut Context<'_>) -> Poll<(RobotId, RobotEvent)> {
        let count = self.links.len();
        for place in (1..=count).map(|n| (self.last + n) % count) {
            let link = &mut self.links[place];
            if link.has_ended {
                continue;
            }
            let Poll::Ready(report) = link.ends.reports.poll_recv(context) else { continue };
            self.last = place;
            link.has_ended = report.is_none();
            let ended = || RobotEvent::LinkLost("the robot's adapter has ended".to_owned());
            return Poll::Ready((link.robot.clone(), report.unwrap_or_else(ended)));
        }
        Poll::Pending
    }

    /// The halts so far that concern this robot.
    pub(super) fn halts(&self, robot: &RobotId) -> Halts {
        self.to(robot).map_or_else(Halts::default, |link| link.halts.now())
    }

    /// Gives an order to a robot, to be begun only if there are no further halts than these; false when its adapter does not take it.
    pub(super) fn send(&self, robot: &RobotId, order: Order, halts: Halts) -> bool {
        let Some(link) = self.to(robot) else { return false };
        let sent = link.orders.try_send(Stamped { order, halts: halts.count });
        if let Err(error) = &sent {
            tracing::warn!(%robot, %error, "the robot's adapter does not take its orders");
        }
        sent.is_ok()
    }

    /// Halts one robot.
    pub(super) fn halt(&self, robot: &RobotId) {
        if let Some(link) = self.to(robot) {
            link.halt.send_modify(|count| *count += 1);
        }
    }

    /// Lets the LED of a robot blink, or not.
    pub(super) fn light(&self, robot: &RobotId, blinks: bool) {
        if let Some(link) = self.to(robot) {
            link.led.send_replace(blinks);
        }
    }

    fn to(&self, robot: &RobotId) -> Option<&RobotLink> {
        self.links.iter().find(|link| link.robot == *robot).map(|link| &link.ends)
    }
}
