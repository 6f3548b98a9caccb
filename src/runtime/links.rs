//! The loop's ends of the links to all robots. Each link is found by the id of its robot.

use std::future::poll_fn;
use std::task::{Context, Poll};

use super::halt::Halts;
use super::link::{RobotLink, Stamped};
use hallsweep_core::effect::Order;
use hallsweep_core::event::RobotEvent;
use hallsweep_core::robot::RobotId;

pub(super) struct Links {
    links: Vec<RobotEnd>,
    /// Index of the robot whose report was taken last. The following robot is polled first, so that every robot gets
    /// its turn.
    last: usize,
}

struct RobotEnd {
    robot: RobotId,
    ends: RobotLink,
    has_ended: bool,
}

impl Links {
    pub(super) fn new(links: impl IntoIterator<Item = (RobotId, RobotLink)>) -> Links {
        let link = |(robot, ends)| RobotEnd { robot, ends, has_ended: false };
        Links { links: links.into_iter().map(link).collect(), last: 0 }
    }

    /// Waits for the next report of any robot. If an adapter ends, this is reported once, as a lost link.
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

    pub(super) fn halts(&self, robot: &RobotId) -> Halts {
        self.to(robot).map_or_else(Halts::default, |link| link.halts.now())
    }

    /// Sends an order with the halts so far. A further halt makes a motion void. Returns false if the adapter does
    /// not take the order.
    pub(super) fn send(&self, robot: &RobotId, order: Order, halts: Halts) -> bool {
        let Some(link) = self.to(robot) else { return false };
        let sent = link.orders.try_send(Stamped { order, halts: halts.count });
        if let Err(error) = &sent {
            tracing::warn!(%robot, %error, "the robot's adapter does not accept an order");
        }
        sent.is_ok()
    }

    pub(super) fn halt(&self, robot: &RobotId) {
        if let Some(link) = self.to(robot) {
            link.halt.send_modify(|count| *count += 1);
        }
    }

    pub(super) fn light(&self, robot: &RobotId, blinks: bool) {
        if let Some(link) = self.to(robot) {
            link.led.send_replace(blinks);
        }
    }

    fn to(&self, robot: &RobotId) -> Option<&RobotLink> {
        self.links.iter().find(|link| link.robot == *robot).map(|link| &link.ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::halt::Halter;
    use crate::runtime::link::{REPORTS, RobotSide, link};
    use crate::runtime::tests::within::within;
    use hallsweep_core::effect::Action;
    use hallsweep_core::units::{Epoch, OrderId};

    fn porter() -> RobotId {
        RobotId::new("porter").unwrap()
    }

    /// The links to two robots, the adapters' ends in the same order, and the halter of both robots.
    fn pair() -> (Links, [RobotSide; 2], Halter) {
        let halter = Halter::new(Epoch(0));
        let ((first, first_side), (second, second_side)) = (link(halter.watch()), link(halter.watch()));
        (Links::new([(RobotId::discovery(), first), (porter(), second)]), [first_side, second_side], halter)
    }

    fn order() -> Order {
        let deadline = std::time::Duration::from_secs(1);
        Order { id: OrderId(1), action: Action::Recentre, epoch: Epoch(0), deadline }
    }

    #[tokio::test]
    async fn a_halt_of_one_robot_is_not_one_of_the_other_and_a_stop_is_of_both() {
        let (links, [mut discovery, mut porters], halter) = pair();
        links.halt(&porter());
        assert_eq!(within("its halt", porters.halts.raised()).await.count, 1);
        assert_eq!((links.halts(&RobotId::discovery()).count, links.halts(&porter()).count), (0, 1));
        let stopped = halter.stop();
        for (side, count) in [(&mut discovery, 1), (&mut porters, 2)] {
            let halts = within("the stop", side.halts.raised()).await;
            assert_eq!((halts.count, halts.epoch, side.halts.now()), (count, stopped, halts));
        }
    }

    /// Safety S2: an order goes to its robot alone, and is void after a halt of that robot.
    #[tokio::test]
    async fn an_order_goes_to_its_robot_alone_and_is_void_after_a_halt_of_that_robot() {
        let (links, [mut discovery, mut porters], _halter) = pair();
        assert!(links.send(&porter(), order(), links.halts(&porter())));
        assert!(discovery.orders.try_recv().is_err());
        let given = porters.orders.try_recv().unwrap();
        assert_eq!(given.halts, porters.halts.now().count);
        links.halt(&RobotId::discovery());
        assert_eq!(given.halts, porters.halts.now().count, "the other was halted");
        links.halt(&porter());
        assert!(given.halts < porters.halts.now().count);
        assert!(!links.send(&RobotId::new("nobody").unwrap(), order(), Halts::default()));
    }

    #[tokio::test]
    async fn no_robot_reports_over_the_others_and_an_end_is_said_once() {
        let (mut links, [discovery, porters], _halter) = pair();
        for _ in 0..REPORTS {
            discovery.reports.try_send(RobotEvent::Sonar(None)).unwrap();
        }
        porters.reports.try_send(RobotEvent::Sonar(Some(7))).unwrap();
        let two = [within("a report", links.report()).await, within("a report", links.report()).await];
        assert!(two.contains(&(porter(), RobotEvent::Sonar(Some(7)))), "{two:?}");
        drop(porters);
        let mut ends = 0;
        for _ in 0..REPORTS {
            ends += u32::from(
                matches!(within("a report", links.report()).await, (robot, RobotEvent::LinkLost(_)) if robot == porter()),
            );
        }
        assert_eq!(ends, 1);
    }
}
