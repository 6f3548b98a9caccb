//! How the virtual robot's motions begin and end: what is heard while one is under way, what is not heard, and what follows for where it
//! stands.

use std::time::Duration;

use super::back::FEELS;
use super::contacts::LATE_WORD;
use super::memory::Unheard;
use super::{Aim, Command, Dialect, Leg, PUT_HOME, Stage, Then, VirtualRobot, Way};
use crate::Output;
use hallsweep_core::event::RobotEvent;
use hallsweep_core::units::{Heading, Pose};

/// What the word of a contact takes, before it was measured: a frame of the page, and the way.
pub(super) const LATENCY: Duration = Duration::from_millis(30);

/// Behind the end of a move so long is waited for the word of a contact at its very end, beside the latency to and fro.
const MARGIN: Duration = Duration::from_millis(60);

/// A turn that is not over swallows what is told next, so that a page that is busy has so much longer for it.
pub(super) const TURNS_LATE: Duration = Duration::from_millis(120);

/// The same before the latency was measured: the first contact may come as late as this.
const FIRST_MARGIN: Duration = Duration::from_millis(400);

/// Nearer to the centre than a frame of the page brings it, it is centred.
pub(super) const CENTRED: f64 = 0.04;

/// No leg lasts longer, so that a robot whose program has died stops within half a second (safety S5). What is longer is driven in several.
const LONGEST: Duration = Duration::from_millis(450);

/// An order moves it no further than that at once, in cells.
const FURTHEST: f64 = 1.5;

/// What was not begun because another motion was under way is tried again so much later.
const AGAIN: Duration = Duration::from_millis(100);

/// A move that is not acknowledged so long after its end was never made.
const UNACKNOWLEDGED: Duration = Duration::from_millis(1500);

/// A link that is lost so soon after a move was sent may have been lost before the robot heard of it, and where the server is slow, later.
const BEGUN: Duration = Duration::from_millis(10);

/// In how many legs a way is driven that takes so long.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "no way takes longer than some seconds")]
pub(super) fn legs(lasts: Duration) -> u32 {
    lasts.div_duration_f64(LONGEST).ceil().max(1.0) as u32
}

impl VirtualRobot {
    pub(super) fn margin(&self) -> Duration {
        self.latency.map_or(FIRST_MARGIN, |latency| MARGIN + latency * 2)
    }

    pub(super) fn latency(&self) -> Duration {
        self.latency.unwrap_or(LATENCY)
    }

    pub(super) fn drive(&mut self, towards: Heading, cells: f64, backward: bool) {
        self.drive_on(towards, cells, backward, Duration::ZERO);
    }

    fn drive_on(&mut self, towards: Heading, cells: f64, backward: bool, before: Duration) {
        let all = cells.clamp(0.0, FURTHEST);
        let cells = all / f64::from(legs(self.step.mul_f64(all)));
        let way = Way::Straight { towards, cells, backward, lasts: self.step.mul_f64(cells), rest: all - cells, before };
        self.set_out(way);
    }

    pub(super) fn set_out(&mut self, way: Way) {
        let leg = Leg::new(way, Stage::Fresh);
        if let Some(task) = &mut self.task {
            task.leg = Some(leg);
        }
        match self.dialect {
            Dialect::Semicolons => self.reconnect(),
            Dialect::Messages => self.queue(),
        }
    }

    /// Gives the leg to the robot.
    pub(super) fn queue(&mut self) {
        let Some(leg) = self.leg_mut() else { return };
        leg.stage = Stage::Queued;
        let command = leg.command();
        self.send(command);
        self.is_changed = true;
    }

    /// When something follows from silence.
    pub(super) fn leg_due(&self) -> Option<Duration> {
        let leg = self.leg()?;
        match leg.stage {
            Stage::Refused(until) | Stage::Halting { until, .. } => Some(until),
            Stage::Fresh | Stage::Queued => None,
            Stage::Sent(sent) if self.awaits_word(leg) => Some(self.end_of(leg, sent) + UNACKNOWLEDGED),
            Stage::Sent(sent) => Some(self.end_of(leg, sent)),
        }
    }

    fn end_of(&self, leg: &Leg, sent: Duration) -> Duration {
        let late = if matches!(leg.way, Way::Turn { .. }) { TURNS_LATE } else { Duration::ZERO };
        sent + leg.lasts() + self.margin() + late
    }

    fn awaits_word(&self, leg: &Leg) -> bool {
        self.dialect == Dialect::Messages && !leg.is_acknowledged
    }

    /// What is due by now happens.
    pub(super) fn pass(&mut self) {
        if self.task.as_ref().is_some_and(|task| task.deadline <= self.now) {
            return self.give_up();
        }
        if self.leg_due().is_none_or(|due| due > self.now) {
            return;
        }
        let Some(leg) = self.leg().copied() else { return };
        match leg.stage {
            Stage::Refused(_) => self.queue(),
            Stage::Halting { lasted, .. } => self.halted(leg, lasted),
            Stage::Sent(_) if self.awaits_word(&leg) => {
                self.lose_sight("it did not say that the move has ended, so maybe its page was closed");
            }
            Stage::Sent(_) => self.ended(leg),
            Stage::Fresh | Stage::Queued => {}
        }
    }

    fn give_up(&mut self) {
        match self.leg().copied().filter(Leg::is_sent) {
            Some(Leg { way: Way::Turn { .. }, .. }) => self.lose_sight("it did not turn in time"),
            Some(leg) => {
                self.cut_short(leg);
                self.send(Command::Alarm);
                self.off_centre = true;
                self.fail("it did not finish in time and was halted");
            }
            None => {
                self.forget_unsent();
                self.fail("it did not happen in time");
            }
        }
    }

    /// What has not gone out by now does not go out any more.
    pub(super) fn forget_unsent(&mut self) {
        self.outputs.retain(|output| !matches!(output, Output::Send(_)));
    }

    /// Whether the leg was handed over to be sent, and nobody has said that it was.
    fn is_on_its_way(&self) -> bool {
        let is_queued = self.leg().is_some_and(|leg| leg.stage == Stage::Queued);
        is_queued && !self.outputs.iter().any(|output| matches!(output, Output::Send(_)))
    }

    /// A leg came to its end, and nothing was met.
    fn ended(&mut self, leg: Leg) {
        let Some(aim) = self.task.as_ref().map(|task| task.aim) else { return };
        self.is_changed = true;
        if let Way::Straight { towards, cells, backward, lasts, rest, before } = leg.way {
            if aim == Aim::Gauge {
                self.gauged += lasts;
            }
            if aim != Aim::Feel {
                self.reckoning.advance(towards, cells);
            }
            if rest > CENTRED / 2.0 {
                self.off_centre = true;
                return self.drive_on(towards, rest, backward, before + lasts);
            }
        }
        match aim {
            Aim::Step(to) if self.is_barred(to.cell) => {
                if let Way::Straight { towards, backward, .. } = leg.way {
                    self.go_on_until_met(towards, backward);
                }
            }
            Aim::Step(to) => {
                (self.stepped, self.off_centre) = (Some(self.now), false);
                self.complete(to);
            }
            Aim::Turn(to) => self.complete(to),
            Aim::Aside(to) => self.turned_aside(to, leg.is_halted),
            Aim::Feel => {
                self.felt(FEELS);
                self.go_back();
            }
            Aim::Back | Aim::Return | Aim::Gauged => self.go_back(),
            Aim::Gauge => {
                self.off_centre = true;
                self.gauge_on();
            }
            Aim::Retreat(then) => self.measure(then),
            Aim::Measure(Then::Gauged) => {
                self.aim(Aim::Gauged);
                self.go_back();
            }
            Aim::Measure(Then::Met(_)) if self.room.is_some() => self.stands_before_it(),
            // What it met from here before it does not meet again: it stands elsewhere, or that was not met here.
            Aim::Measure(Then::Met(_)) => self.lose(LATE_WORD),
            Aim::Touch { is_certain, further } => self.not_touched(is_certain, further),
            Aim::Draw => {}
        }
    }

    pub(super) fn complete(&mut self, pose: Pose) {
        self.astray = self.astray.saturating_sub(1);
        self.reckoning.complete(pose);
        if !self.off_centre {
            self.met = None;
        }
        self.answer(RobotEvent::Done);
    }

    pub(super) fn acknowledged(&mut self, name: Option<&str>) {
        let Some(leg) = self.leg_mut().filter(|leg| leg.is_sent()) else { return };
        let word = leg.command().word();
        // An old one, of what was cut short by a contact, comes late and under its own name.
        leg.is_acknowledged |= name.is_none_or(|name| name == word);
    }

    /// What was refused may have been another program's: it is ours when it is called like ours, which was sent just now.
    pub(super) fn refused(&mut self, name: Option<&str>) {
        let (now, soon, off_centre) = (self.now, self.margin(), self.off_centre);
        let Some(leg) = self.leg_mut() else { return };
        let Stage::Sent(sent) = leg.stage else { return };
        if name.is_some_and(|name| name != leg.command().word()) || now.saturating_sub(sent) > soon {
            return;
        }
        if leg.is_halted {
            return self.answer(|order| RobotEvent::Halted(order, off_centre));
        }
        leg.stage = Stage::Refused(now + AGAIN);
        self.is_changed = true;
    }

    /// A turn cannot be halted: it ends by itself, and is answered then. A drawing is no motion.
    pub(super) fn halt(&mut self) {
        self.forget_unsent();
        let Some(leg) = self.leg().copied() else { return };
        // What the next program must know changes by it.
        self.is_changed = true;
        match (leg.stage, leg.way) {
            (Stage::Sent(sent), Way::Straight { .. }) => {
                let (lasted, until) = (self.now.saturating_sub(sent), self.now + self.margin());
                self.send(Command::Alarm);
                if let Some(leg) = self.leg_mut() {
                    leg.stage = Stage::Halting { lasted, until };
                }
            }
            (Stage::Sent(_), Way::Turn { .. }) => {
                if let Some(leg) = self.leg_mut() {
                    leg.is_halted = true;
                }
            }
            (Stage::Halting { .. }, _) => {}
            (Stage::Fresh | Stage::Refused(_) | Stage::Queued, _) => {
                let off_centre = self.off_centre;
                self.answer(|order| RobotEvent::Halted(order, off_centre));
            }
        }
    }

    fn halted(&mut self, leg: Leg, lasted: Duration) {
        self.moved_for(leg, lasted);
        (self.off_centre, self.met) = (true, None);
        self.answer(|order| RobotEvent::Halted(order, true));
    }

    fn cut_short(&mut self, leg: Leg) {
        match leg.stage {
            Stage::Sent(sent) => self.moved_for(leg, self.now.saturating_sub(sent)),
            Stage::Halting { lasted, .. } => self.moved_for(leg, lasted),
            Stage::Fresh | Stage::Refused(_) | Stage::Queued => {}
        }
    }

    fn moved_for(&mut self, leg: Leg, lasted: Duration) {
        if let Way::Straight { towards, lasts, .. } = leg.way {
            self.moved(towards, lasted.min(lasts).div_duration_f64(self.step));
        }
    }

    /// It has moved so far, from where it is taken to stand or, when it only feels, from where it stands in truth.
    pub(super) fn moved(&mut self, towards: Heading, cells: f64) {
        self.first_contact = None;
        match &mut self.unheard {
            Some(unheard) => unheard.felt += cells,
            None => self.reckoning.advance(towards, cells),
        }
    }

    /// Nobody knows whether it was told to move.
    pub(super) fn left_in_doubt(&mut self) {
        self.off_centre = true;
        self.lost = Some(format!("it was lost in the moment in which it was told to move. {PUT_HOME}"));
    }

    /// It was going forward against something that stands there, and has met it by itself; of what is behind it nobody knows.
    fn left_against_something(&mut self, backward: bool) {
        let heading = self.reckoning.pose().heading;
        match self.reckoning.contact_ahead() {
            Some((way, true)) if !backward => self.reckoning.advance(heading, way),
            Some(_) | None => self.left_in_doubt(),
        }
    }

    /// The link is lost, or the program has ended: what is under way ends by itself, and nobody hears how. On the way back and in a turn
    /// nothing is to be met.
    pub(super) fn leave_unheard(&mut self) {
        let is_on_its_way = self.is_on_its_way();
        self.forget_unsent();
        let Some(task) = self.task.take() else { return };
        self.is_changed = true;
        let may_be_unheard = BEGUN + self.greeted_after;
        let Some(leg) = task.leg.filter(|leg| leg.is_sent() || is_on_its_way) else { return };
        if is_on_its_way || matches!(leg.stage, Stage::Sent(sent) if self.now.saturating_sub(sent) < may_be_unheard) {
            return self.left_in_doubt();
        }
        self.off_centre |= matches!(leg.way, Way::Straight { .. });
        if let Stage::Halting { lasted, .. } = leg.stage
            && !matches!(task.aim, Aim::Step(_))
        {
            return self.moved_for(leg, lasted);
        }
        match (leg.way, task.aim) {
            (Way::Turn { .. }, Aim::Turn(to) | Aim::Aside(to)) => self.reckoning.complete(to),
            (Way::Straight { towards, cells, .. }, Aim::Step(_)) => {
                let cells = match leg.stage {
                    Stage::Halting { lasted, .. } => cells.min(lasted.div_duration_f64(self.step)),
                    Stage::Fresh | Stage::Refused(_) | Stage::Queued | Stage::Sent(_) => cells,
                };
                self.unheard = Some(Unheard { towards, cells, felt: 0.0 });
            }
            (Way::Straight { cells, .. }, Aim::Feel) => {
                if let Some(unheard) = &mut self.unheard {
                    unheard.felt += cells;
                }
            }
            (
                Way::Straight { towards, cells, .. },
                Aim::Turn(_) | Aim::Back | Aim::Aside(_) | Aim::Return | Aim::Retreat(_) | Aim::Gauge | Aim::Gauged | Aim::Draw,
            ) => {
                self.reckoning.advance(towards, cells);
            }
            (Way::Straight { backward, .. }, Aim::Measure(_) | Aim::Touch { .. }) => self.left_against_something(backward),
            (Way::Turn { .. }, _) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Task;
    use super::*;
    use crate::Driver;
    use hallsweep_core::command::Move;
    use hallsweep_core::effect::{Action, Order};
    use hallsweep_core::units::{Epoch, Now, OrderId};

    struct Test {
        robot: VirtualRobot,
        now: Now,
    }

    impl Test {
        fn connected() -> Test {
            let robot = VirtualRobot::new(Dialect::Messages, Duration::from_millis(330));
            let mut test = Test { robot, now: Now::default() };
            test.robot.handle_connected(test.now);
            test
        }

        /// Gives an order, and tells it that it was sent.
        fn begin(&mut self, id: OrderId, action: Action) {
            let deadline = Duration::from_secs(3);
            self.robot.handle_order(Order { id, action, epoch: Epoch(0), deadline }, self.now);
            assert!(matches!(self.robot.poll_output(), Some(Output::Send(_))));
            self.robot.handle_sent(self.now);
        }

        fn passes(&mut self, time: Duration) {
            self.now.since_start += time;
            self.robot.handle_timeout(self.now);
        }

        fn last_event(&mut self) -> Option<RobotEvent> {
            std::iter::from_fn(|| self.robot.poll_event()).last()
        }
    }

    /// Safety S6: another client's turn was under way, so that ours was not begun.
    #[test]
    fn a_turn_that_was_refused_is_not_tried_again_after_a_halt() {
        let mut test = Test::connected();
        test.begin(OrderId(1), Action::Move(Move::TurnLeft));
        test.robot.handle_halt(test.now);
        test.robot.handle_received(br#"{"endmove":false,"move":"turnLeft_notallowed"}"#, test.now);
        test.passes(AGAIN);
        assert_eq!((test.robot.poll_output(), test.last_event()), (None, Some(RobotEvent::Halted(OrderId(1), false))));
    }

    /// Safety S6: it feels whether its step is complete, is halted, and the word of what it met comes then.
    #[test]
    fn what_is_met_in_the_moment_of_a_halt_sets_nothing_moving() {
        let mut test = Test::connected();
        test.begin(OrderId(1), Action::Move(Move::Forward));
        test.passes(Duration::from_millis(200));
        test.robot.handle_lost("the cable was pulled", test.now);
        test.robot.handle_connected(test.now);
        test.begin(OrderId(2), Action::Recentre);
        test.passes(Duration::from_millis(90));
        test.robot.handle_halt(test.now);
        assert_eq!(test.robot.poll_output(), Some(Output::Send(Command::Alarm.as_message())));
        test.robot.handle_received(br#"{"collision":"moveForward","target":"wallDown"}"#, test.now);
        assert_eq!((test.robot.poll_output(), test.last_event()), (None, Some(RobotEvent::Halted(OrderId(2), true))));
    }

    /// Safety S6: the file was still being written when the link was lost, and STOP came when it was found again.
    #[test]
    fn what_has_not_gone_out_when_the_link_is_lost_never_goes_out() {
        let mut test = Test::connected();
        let order =
            Order { id: OrderId(1), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
        test.robot.handle_order(order, test.now);
        test.robot.handle_lost("the cable was pulled", test.now);
        test.robot.handle_connected(test.now);
        test.robot.handle_halt(test.now);
        assert_eq!(test.robot.poll_output(), None);
        assert!(test.robot.lost.is_none() && !test.robot.off_centre, "it was not told to move");
    }

    #[test]
    fn what_was_going_out_when_the_link_was_lost_may_have_come() {
        let mut test = Test::connected();
        let order =
            Order { id: OrderId(1), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
        test.robot.handle_order(order, test.now);
        assert!(matches!(test.robot.poll_output(), Some(Output::Send(_))), "and nobody says whether it was sent");
        test.robot.handle_lost("it does not take what is sent", test.now);
        assert!(test.robot.lost.is_some());
    }

    /// Every client hears of every refusal.
    #[test]
    fn a_refusal_of_another_programs_move_is_not_taken_for_ours() {
        for (name, late) in [("moveBackward", 10), ("moveForward", 500)] {
            let mut test = Test::connected();
            test.robot.step = Duration::from_secs(1);
            test.begin(OrderId(1), Action::Move(Move::Forward));
            test.passes(Duration::from_millis(late));
            let said = format!("{{\"endmove\":false,\"move\":\"{name}_notallowed\"}}");
            test.robot.handle_received(said.as_bytes(), test.now);
            assert!(test.robot.leg().is_some_and(|leg| matches!(leg.stage, Stage::Sent(_))), "{name} after {late} ms");
        }
    }

    /// While a new connection is made the old one may still greet, since the server greets all when anybody connects.
    #[test]
    fn a_greeting_over_a_connection_that_is_given_up_begins_nothing() {
        let mut test = Test { robot: VirtualRobot::new(Dialect::Semicolons, Duration::from_millis(330)), now: Now::default() };
        let greet = |test: &mut Test| test.robot.handle_received(b";{\"type\":\"webpage-ready\"};", test.now);
        test.robot.handle_connected(test.now);
        greet(&mut test);
        let order =
            Order { id: OrderId(1), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
        test.robot.handle_order(order, test.now);
        greet(&mut test);
        assert_eq!(test.robot.poll_output(), Some(Output::Reconnect));
        assert_eq!(test.robot.poll_output(), None);
        test.robot.handle_connected(test.now);
        greet(&mut test);
        assert!(matches!(test.robot.poll_output(), Some(Output::Send(_))));
    }

    const CONTACT: &[u8] = br#"{"collision":"moveForward","target":"wallDown"}"#;

    /// A step that is complete by the clock, with its end acknowledged.
    fn stepped() -> Test {
        let mut test = Test::connected();
        test.robot.latency = Some(Duration::ZERO);
        test.begin(OrderId(1), Action::Move(Move::Forward));
        test.robot.handle_received(br#"{"endmove":true,"move":"moveForward"}"#, test.now);
        test.passes(Duration::from_secs(1));
        assert_eq!(test.last_event(), Some(RobotEvent::Done(OrderId(1))));
        test
    }

    /// Nobody had ordered anything when that was found out.
    #[test]
    fn of_a_word_that_came_too_late_whoever_orders_next_is_told() {
        let mut test = stepped();
        test.robot.handle_received(CONTACT, test.now);
        assert_eq!(test.last_event(), None);
        let order =
            Order { id: OrderId(2), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
        test.robot.handle_order(order, test.now);
        assert!(matches!(test.last_event(), Some(RobotEvent::Failed(OrderId(2), words)) if words.contains("too late")));
        assert_eq!(test.robot.poll_output(), None);
    }

    /// The file was still being written when that was found out.
    #[test]
    fn what_has_not_gone_out_when_the_robot_is_lost_never_goes_out() {
        let mut test = stepped();
        let order =
            Order { id: OrderId(2), action: Action::Move(Move::Forward), epoch: Epoch(0), deadline: Duration::from_secs(3) };
        test.robot.handle_order(order, test.now);
        test.robot.handle_received(CONTACT, test.now);
        assert!(matches!(test.last_event(), Some(RobotEvent::Failed(OrderId(2), _))));
        assert_eq!(test.robot.poll_output(), None);
    }

    #[test]
    fn one_that_is_lost_against_something_behind_it_is_not_taken_to_stand_before_what_is_ahead() {
        for (backward, is_lost) in [(false, false), (true, true)] {
            let mut test = Test::connected();
            test.robot.reckoning.advance(Heading::South, 0.9);
            test.robot.reckoning.meet(Some("wallDown"), Heading::South).expect("it is new");
            test.robot.reckoning.advance(Heading::North, 0.9);
            let way = Way::Straight {
                towards: Heading::South,
                cells: 1.0,
                backward,
                lasts: Duration::from_millis(330),
                rest: 0.0,
                before: Duration::ZERO,
            };
            let leg = Some(Leg::new(way, Stage::Sent(Duration::ZERO)));
            let aim = Aim::Touch { is_certain: true, further: 0 };
            test.robot.task =
                Some(Task { order: OrderId(1), action: Action::Recentre, deadline: Duration::MAX, aim, leg, hindered: 0 });
            test.now.since_start += Duration::from_secs(1);
            test.robot.handle_lost("the cable was pulled", test.now);
            assert_eq!(test.robot.lost.is_some(), is_lost, "backward: {backward}");
        }
    }

    #[test]
    fn back_from_touching_or_gauging_a_recentring_is_done() {
        for aim in [Aim::Return, Aim::Gauged] {
            let mut test = Test::connected();
            (test.robot.gauge, test.robot.gauged) = (Some(7.0), Duration::from_secs(3));
            let (order, deadline) = (OrderId(1), Duration::MAX);
            test.robot.task = Some(Task { order, action: Action::Recentre, deadline, aim, leg: None, hindered: 0 });
            test.robot.go_back();
            assert_eq!((test.robot.poll_output(), test.last_event()), (None, Some(RobotEvent::Done(order))), "{aim:?}");
        }
    }
}
