//! The program's end of the line protocol. It sends one order at a time and repeats the order until it is answered.
//! It sends a `hello` every half second. The file `greeting` begins the link, and `answers` handles the robot's
//! lines.

use std::collections::VecDeque;
use std::time::Duration;

use super::frame::{LineReader, framed};
use super::from_robot::RobotName;
use super::numbers::{Seq, millis};
use super::picture::Picture;
use super::to_robot::{RobotTask, ToRobot};
use crate::{Driver, Output, Subject};
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order};
use hallsweep_core::event::{OffCentre, Photo, RobotEvent};
use hallsweep_core::robot::{Part, Parts};
use hallsweep_core::units::{Celsius, Now, OrderId, Pose};

/// A line that is not answered is repeated after this time.
const REPEATED: Duration = Duration::from_millis(100);

/// Interval of `hello`, which asks the robot to introduce itself. Three intervals fit into `SILENCE`.
pub(super) const HELLO: Duration = Duration::from_millis(500);

/// If the robot is silent for this time while the link is up, it counts as gone.
const SILENCE: Duration = Duration::from_millis(1500);

/// How long to wait for the robot's first line. Some boards are reset when their serial device is opened, and then
/// need two seconds to start.
const AWAKE: Duration = Duration::from_secs(5);

/// Longest pause between two bytes of a photo. After a longer pause, the rest of the photo counts as lost.
const PAUSE: Duration = Duration::from_secs(1);

/// How long to wait for the answer to a halt. After that, the connection is closed, since a new connection halts the
/// robot too.
const UNHALTED: Duration = Duration::from_millis(1500);

/// Failure of every order when the robot has received the last possible order number.
pub(super) const ALL_COUNTED: &str = "the robot has no order numbers left: switch the robot off and on";

#[derive(Debug)]
pub struct LineDriver {
    pub(super) link: LinkStage,
    lines: LineReader,
    /// The beginning of a valid line with unknown meaning. It helps to find the reason of a fault.
    pub(super) not_understood: Option<String>,
    pub(super) picture: Option<Picture>,
    pub(super) open: Option<Open>,
    /// A drawing that is being made instead of a photo, and its deadline.
    drawing: Option<(OrderId, Duration)>,
    /// The number of the last order. Before the first order, it is one less than the number of the first order.
    pub(super) seq: Seq,
    /// The last halt line: the number up to which it voids orders, and when it was sent. `None` if an order was sent
    /// after the halt.
    last_halt: Option<(Seq, Duration)>,
    led: bool,
    /// Before this time, a change of the LED is not sent at once, but with the next `hello`.
    led_at: Duration,
    pub(super) off_centre: OffCentre,
    /// A distance that was not reported yet. `Some(None)` means that nothing is in range, and `None` means that there
    /// is no new reading.
    pub(super) sonar: Option<Option<u16>>,
    pub(super) temperature: Option<Celsius>,
    pub(super) readings_at: Duration,
    pub(super) unasked: u8,
    pub(super) name: Option<RobotName>,
    pub(super) connected: Duration,
    /// When the last valid line or part of a photo came. The robot's silence is counted from this time.
    pub(super) heard: Duration,
    pub(super) hello_at: Duration,
    pub(super) outputs: VecDeque<Output>,
    pub(super) events: VecDeque<RobotEvent>,
    /// The last reported reason why there is no link.
    pub(super) told: Option<String>,
}

#[derive(Debug)]
pub(super) enum LinkStage {
    Down,
    /// Connected, but not ready for orders. The value is the number that was sent to the robot: orders will have
    /// greater numbers. `None` if the robot has not introduced itself yet, or has no numbers left.
    Greeting(Option<Seq>),
    Up(Robot),
}

#[derive(Debug)]
pub(super) struct Robot {
    pub(super) name: RobotName,
    pub(super) parts: Parts,
    /// Orders have numbers above this one. If the robot still knows this number, it is the same robot and was not
    /// switched off.
    pub(super) from: Seq,
    pub(super) pose: Pose,
}

#[derive(Debug)]
pub(super) struct Open {
    pub(super) order: Order,
    pub(super) task: RobotTask,
    pub(super) until: Duration,
    repeat_at: Duration,
    /// Whether the order was halted. The halt is then repeated instead of the order.
    pub(super) is_halted: bool,
    pub(super) is_late: bool,
}

impl LineDriver {
    #[must_use]
    pub fn new() -> LineDriver {
        LineDriver {
            link: LinkStage::Down,
            lines: LineReader::default(),
            not_understood: None,
            picture: None,
            open: None,
            drawing: None,
            seq: Seq::FIRST,
            last_halt: None,
            led: false,
            led_at: Duration::ZERO,
            off_centre: false,
            sonar: None,
            temperature: None,
            readings_at: Duration::ZERO,
            unasked: 0,
            name: None,
            connected: Duration::ZERO,
            heard: Duration::ZERO,
            hello_at: Duration::ZERO,
            outputs: VecDeque::new(),
            events: VecDeque::new(),
            told: None,
        }
    }

    pub(super) fn say(&mut self, words: ToRobot) {
        self.outputs.push_back(Output::Send(framed(&words.to_string())));
    }

    pub(super) fn say_led(&mut self) {
        if self.has(Part::Led) {
            self.say(ToRobot::Led(self.led));
        }
    }

    pub(super) fn has(&self, part: Part) -> bool {
        matches!(&self.link, LinkStage::Up(robot) if robot.parts.has(part))
    }

    fn repeat(&mut self, now: Now) {
        let Some(open) = &mut self.open else { return };
        open.repeat_at = now.since_start + REPEATED;
        let left = millis(open.until.saturating_sub(now.since_start)).max(1);
        if open.is_halted {
            return self.say_halt(self.seq, now);
        }
        let order = ToRobot::Order(open.task, self.seq, left);
        self.last_halt = None;
        self.say(order);
    }

    fn say_halt(&mut self, voids: Seq, now: Now) {
        self.last_halt = Some((voids, now.since_start));
        self.say(ToRobot::Halt(voids));
    }

    fn task(&self, action: Action) -> Result<RobotTask, &'static str> {
        let task = match action {
            Action::Move(Move::Forward) => RobotTask::Forward,
            Action::Move(Move::Backward) => RobotTask::Backward,
            Action::Move(Move::TurnLeft) => RobotTask::Left,
            Action::Move(Move::TurnRight) => RobotTask::Right,
            Action::Recentre => RobotTask::Recentre,
            Action::Photograph(_) => RobotTask::Photo,
            Action::Move(Move::NudgeLeft | Move::NudgeRight) => return Err("the line protocol has no small corrective turns"),
            Action::Enter | Action::Leave => return Err("the line protocol has no orders outside the hall"),
            Action::Arm(_) => return Err("the line protocol has no orders for an arm"),
        };
        if self.has(Part::Base) || !task.is_motion() { Ok(task) } else { Err("the robot says that it has no base") }
    }

    fn begin(&mut self, order: Order, now: Now) -> Result<(), String> {
        if !matches!(self.link, LinkStage::Up(_)) {
            return Err("the robot is not connected".to_owned());
        }
        if let Some(id) = self.open.as_ref().map(|open| open.order.id).or(self.drawing.map(|(id, _)| id)) {
            return Err(format!("order {id} is still under way"));
        }
        let task = self.task(order.action)?;
        let until = now.since_start.saturating_add(order.deadline);
        if let Action::Photograph(stamp) = order.action
            && !self.has(Part::Camera)
        {
            self.drawing = Some((order.id, until));
            self.outputs.push_back(Output::Draw(order.id, Subject { stamp, name: None }));
            return Ok(());
        }
        self.seq = self.seq.next().ok_or(ALL_COUNTED)?;
        self.open = Some(Open { order, task, until, repeat_at: now.since_start, is_halted: false, is_late: false });
        self.repeat(now);
        Ok(())
    }

    /// Drops the open order because it will not be answered. Its outcome is unknown.
    pub(super) fn drop_order(&mut self) {
        let open = self.open.take();
        self.off_centre |= open.is_some_and(|open| open.task.is_motion());
        self.drawing = None;
        self.picture = None;
    }

    /// Handles the passed deadline of an order. A motion is halted, because it must not begin so late. A photo fails,
    /// because it is no longer awaited.
    fn expire(&mut self, now: Now) {
        let Some(open) = &mut self.open else { return };
        if open.task.is_motion() && !open.is_halted {
            open.is_halted = true;
            open.is_late = true;
            open.until = now.since_start + UNHALTED;
        } else if open.task.is_motion() {
            self.break_link("the robot did not answer a halt".to_owned());
        } else if let Some(open) = self.open.take() {
            self.picture = None;
            self.events.push_back(RobotEvent::PhotoFailed(open.order.id, "the photo did not arrive in time".to_owned()));
        }
    }

    fn give_up(&mut self, patience: Duration) {
        let damaged = if self.lines.passed_over() > 0 { "; some lines arrived damaged" } else { "" };
        let unknown = self.not_understood.take().map(|text| format!("; `{text}` was not understood"));
        let words = format!("the robot said nothing for {} s{damaged}{}", patience.as_secs_f64(), unknown.unwrap_or_default());
        self.break_link(words);
    }

    pub(super) fn break_link(&mut self, words: String) {
        self.link = LinkStage::Down;
        self.drop_order();
        self.outputs.push_back(Output::GiveUp(words));
    }

    const fn patience(&self) -> Option<Duration> {
        match self.link {
            LinkStage::Down => None,
            LinkStage::Greeting(_) => Some(AWAKE),
            LinkStage::Up(_) => Some(SILENCE),
        }
    }

    fn picture_until(&self) -> Option<Duration> {
        self.picture.as_ref().map(|picture| picture.until.min(self.heard + PAUSE))
    }

    /// When to send the next `hello`. It is not sent while a photo arrives, so that the robot need not answer in the
    /// middle of the photo. Missing bytes are noticed by `PAUSE`.
    const fn next_hello(&self) -> Option<Duration> {
        match (&self.link, &self.picture) {
            (LinkStage::Down, _) | (_, Some(_)) => None,
            (LinkStage::Greeting(_) | LinkStage::Up(_), None) => Some(self.hello_at),
        }
    }

    fn next_repeat(&self) -> Option<Duration> {
        self.open.as_ref().filter(|open| self.picture.is_none() || open.task.is_motion()).map(|open| open.repeat_at)
    }
}

impl Default for LineDriver {
    fn default() -> LineDriver {
        LineDriver::new()
    }
}

impl Driver for LineDriver {
    fn handle_connected(&mut self, now: Now) {
        self.drop_order();
        self.link = LinkStage::Greeting(None);
        self.lines = LineReader::default();
        (self.connected, self.heard, self.last_halt) = (now.since_start, now.since_start, None);
        // The last program may have sent only a part of a line. A line feed ends that part.
        self.outputs.push_back(Output::Send(b"\n".to_vec()));
        self.greet(now);
    }

    fn handle_lost(&mut self, words: &str, _: Now) {
        self.link = LinkStage::Down;
        self.drop_order();
        self.tell_lost(words);
    }

    fn handle_received(&mut self, mut bytes: &[u8], now: Now) {
        while let [first, rest @ ..] = bytes {
            if let Some(picture) = &mut self.picture {
                let taken = picture.take(bytes);
                self.heard = now.since_start;
                if picture.is_whole() {
                    self.develop(now);
                }
                bytes = &bytes[taken..];
                continue;
            }
            if let Some(text) = self.lines.take(*first) {
                self.line(&text, now);
            }
            bytes = rest;
        }
    }

    fn handle_sent(&mut self, _: Now) {}

    fn handle_order(&mut self, order: Order, now: Now) {
        if let Err(why) = self.begin(order, now) {
            self.events.push_back(RobotEvent::Failed(order.id, why));
        }
    }

    fn handle_halt(&mut self, now: Now) {
        let voids = match &mut self.open {
            Some(open) if open.task.is_motion() => {
                if !open.is_halted {
                    (open.is_halted, open.until) = (true, now.since_start + UNHALTED);
                }
                self.seq
            }
            _ if matches!(self.link, LinkStage::Down) => return,
            // A photo goes on. Its order has the last number, so the halt voids only the orders before it.
            Some(_) => self.seq.before(),
            None => self.voided(),
        };
        // The lines of repeated STOPs must not fill a slow wire, because the next order is sent after these lines. A halt
        // that was sent during a photo still serves after it, because only the photo has a greater number.
        let is_open = self.open.is_some();
        let voids_enough = |voided| voided == voids || (!is_open && voided == voids.before());
        let serves = |(voided, said)| voids_enough(voided) && now.since_start.saturating_sub(said) < REPEATED;
        if self.last_halt.is_some_and(serves) {
            return;
        }
        if self.open.as_ref().is_some_and(|open| open.is_halted) { self.repeat(now) } else { self.say_halt(voids, now) }
    }

    fn handle_led(&mut self, blinks: bool, now: Now) {
        self.led = blinks;
        if self.led_at <= now.since_start {
            self.led_at = now.since_start + REPEATED;
            self.say_led();
        }
    }

    fn handle_drawing(&mut self, order: OrderId, drawing: Photo, _: Now) {
        if self.drawing.take_if(|(id, _)| *id == order).is_some() {
            self.events.push_back(RobotEvent::Photo(order, drawing));
        }
    }

    fn handle_timeout(&mut self, now: Now) {
        let is_due = |at: Option<Duration>| at.is_some_and(|at| at <= now.since_start);
        if is_due(self.picture_until()) {
            self.develop(now);
        }
        if is_due(self.open.as_ref().map(|open| open.until)) {
            self.expire(now);
        }
        if is_due(self.drawing.map(|(_, until)| until)) {
            let missed =
                self.drawing.take().map(|(id, _)| RobotEvent::PhotoFailed(id, "the photo was not drawn in time".to_owned()));
            self.events.extend(missed);
        }
        if let Some(patience) = self.patience().filter(|patience| is_due(Some(self.heard + *patience))) {
            return self.give_up(patience);
        }
        if is_due(self.next_readings()) {
            self.tell_readings(now);
        }
        if is_due(self.next_repeat()) {
            self.repeat(now);
        }
        if is_due(self.next_hello()) {
            self.greet(now);
        }
    }

    fn poll_output(&mut self) -> Option<Output> {
        self.outputs.pop_front()
    }

    fn poll_event(&mut self) -> Option<RobotEvent> {
        self.events.pop_front()
    }

    fn poll_timeout(&self) -> Option<Duration> {
        let silent = self.patience().map(|patience| self.heard + patience);
        let until = self.open.as_ref().map(|open| open.until);
        let drawn = self.drawing.map(|(_, until)| until);
        [silent, until, drawn, self.picture_until(), self.next_repeat(), self.next_hello(), self.next_readings()]
            .into_iter()
            .flatten()
            .min()
    }

    fn is_off_centre(&self) -> OffCentre {
        self.off_centre
    }
}

#[cfg(test)]
mod flood_tests;
#[cfg(test)]
pub(super) mod testing;
#[cfg(test)]
mod tests;
