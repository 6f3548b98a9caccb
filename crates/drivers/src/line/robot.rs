//! The robot's end of the line protocol. It decides which orders begin, how they are answered, and when the robot
//! halts by itself. It also keeps count of where the robot stands. It does not move the body itself: it sends
//! requests to the body and gets reports back.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use super::crc::Crc32;
use super::frame::{LONGEST_FOR_ROBOT, LineReader, framed};
use super::from_robot::{FromRobot, Hello, RobotName, Words};
use super::numbers::Seq;
use super::to_robot::{RobotTask, ToRobot};
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order, Stamp};
use hallsweep_core::event::{Ahead, Capabilities, OffCentre, Photo, RobotEvent, Whereabouts};
use hallsweep_core::units::{Epoch, Now, OrderId, Pose};

/// A moving robot halts by itself if no valid line comes for this time (safety S5).
const WATCHDOG: Duration = Duration::from_millis(400);

/// Maximum number of lines and photos that wait for the wire. Further ones are dropped. The important lines are sent
/// again when the program asks.
const WAITING: usize = 32;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyRequest {
    Order(Order),
    /// Halt, and report the end of the current order.
    Halt,
    Led(bool),
}

#[derive(Debug)]
pub struct LineRobot {
    name: RobotName,
    lines: LineReader,
    /// The capabilities that the body has reported. `None` before this report. Until then, the robot sends nothing.
    capabilities: Option<Capabilities>,
    stands: Whereabouts,
    /// The greatest number of an order that has begun or was voided. Without a number, the robot obeys no order.
    last: Option<Seq>,
    under_way: Option<UnderWay>,
    /// The last answer. It is sent again if the program repeats the order.
    answer: Option<(Seq, FromRobot)>,
    /// The number above which orders must begin. It is applied when the current order has ended.
    from: Option<Seq>,
    sonar_cm: Option<u16>,
    ahead: Option<Ahead>,
    /// When the last valid line came. A moving robot halts if the next valid line does not come within `WATCHDOG`.
    heard: Duration,
    asked: VecDeque<BodyRequest>,
    outputs: VecDeque<Arc<[u8]>>,
}

#[derive(Clone, Copy, Debug)]
struct UnderWay {
    seq: Seq,
    task: RobotTask,
    is_halted: bool,
}

impl LineRobot {
    /// A robot that was just switched on. It sends nothing before its body has reported its place and its
    /// capabilities.
    #[must_use]
    pub fn new(name: RobotName) -> LineRobot {
        LineRobot {
            name,
            lines: LineReader::default(),
            capabilities: None,
            stands: Whereabouts { pose: Pose::START, off_centre: false },
            last: None,
            under_way: None,
            answer: None,
            from: None,
            sonar_cm: None,
            ahead: None,
            heard: Duration::ZERO,
            asked: VecDeque::new(),
            outputs: VecDeque::new(),
        }
    }

    /// The connection of the program has ended, or another program is connected now. The robot halts. Reports about
    /// earlier orders are not sent any more.
    pub fn handle_lost(&mut self) {
        self.lines = LineReader::default();
        self.outputs.clear();
        self.halt();
    }

    pub fn handle_received(&mut self, bytes: &[u8], now: Now) {
        for byte in bytes {
            // A line that is too long does not belong to this protocol. It must not keep a motion going.
            let Some(text) = self.lines.take(*byte).filter(|text| text.len() <= LONGEST_FOR_ROBOT) else { continue };
            self.heard = now.since_start;
            if let Some(said) = ToRobot::parse(&text) {
                self.obey(said, now);
            }
        }
    }

    pub fn handle_event(&mut self, event: RobotEvent) {
        match event {
            RobotEvent::Stands(stands) => self.stands = stands,
            RobotEvent::LinkUp(capabilities) => self.capabilities = Some(capabilities),
            RobotEvent::Sonar(cm) => {
                self.sonar_cm = cm;
                self.say(&FromRobot::Sonar(cm));
            }
            RobotEvent::Temperature(celsius) => self.say(&FromRobot::Temperature(celsius)),
            RobotEvent::Ahead(ahead) => self.ahead = Some(ahead),
            RobotEvent::Done(_) => self.done(),
            RobotEvent::Blocked(_, obstacle) => {
                let cm = self.sonar_cm;
                self.answer(true, |seq| FromRobot::Blocked(seq, cm, obstacle));
            }
            RobotEvent::Halted(_, off_centre) => self.answer(off_centre, |seq| FromRobot::Halted(seq, off_centre)),
            RobotEvent::Failed(_, why) => self.answer(true, |seq| FromRobot::Failed(seq, Words::new(&why))),
            RobotEvent::PhotoFailed(_, why) => self.answer(false, |seq| FromRobot::NoPhoto(seq, Words::new(&why))),
            RobotEvent::Photo(_, photo) => self.send_photo(&photo),
            RobotEvent::StandsOutside(..)
            | RobotEvent::LinkLost(_)
            | RobotEvent::Paused
            | RobotEvent::Found(..)
            | RobotEvent::Arm(_)
            | RobotEvent::ParcelLost(_) => {}
        }
    }

    pub fn handle_timeout(&mut self, now: Now) {
        if self.poll_timeout().is_some_and(|at| at <= now.since_start) {
            self.halt();
        }
    }

    pub fn poll_asked(&mut self) -> Option<BodyRequest> {
        self.asked.pop_front()
    }

    /// The next line or photo to send. The caller must also read the program's lines while it sends, so that no halt
    /// has to wait.
    pub fn poll_output(&mut self) -> Option<Arc<[u8]>> {
        self.outputs.pop_front()
    }

    /// When the robot will halt by itself unless a valid line comes earlier. The time is counted from the start of
    /// the run.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.motion().filter(|motion| !motion.is_halted).map(|_| self.heard + WATCHDOG)
    }

    fn motion(&self) -> Option<UnderWay> {
        self.under_way.filter(|under_way| under_way.task.is_motion())
    }

    fn obey(&mut self, said: ToRobot, now: Now) {
        match said {
            ToRobot::Hello => self.say_hello(),
            ToRobot::From(seq) if self.last >= Some(seq) => self.say_hello(),
            ToRobot::From(seq) => {
                self.halt();
                self.from = Some(seq);
                self.begin_above();
                if self.from.is_some() {
                    // The robot stops only later, or a photo goes on. Until then, this `hello` tells the program that
                    // the robot is still there.
                    self.say_hello();
                }
            }
            ToRobot::Order(task, seq, deadline_ms) => self.order(task, seq, Duration::from_millis(deadline_ms.into()), now),
            ToRobot::Halt(seq) => self.void(seq),
            ToRobot::Led(blinks) => self.asked.push_back(BodyRequest::Led(blinks)),
        }
    }

    /// Begins an order if it is new and no other order is being carried out. The program repeats each order until it
    /// is answered.
    fn order(&mut self, task: RobotTask, seq: Seq, deadline: Duration, now: Now) {
        if self.last.is_none() || self.from.is_some() || self.under_way.is_some() {
            return;
        }
        if self.last >= Some(seq) {
            return self.answer_again(seq);
        }
        self.last = Some(seq);
        self.under_way = Some(UnderWay { seq, task, is_halted: false });
        let action = match task {
            RobotTask::Forward => Action::Move(Move::Forward),
            RobotTask::Backward => Action::Move(Move::Backward),
            RobotTask::Left => Action::Move(Move::TurnLeft),
            RobotTask::Right => Action::Move(Move::TurnRight),
            RobotTask::Recentre => Action::Recentre,
            RobotTask::Photo => Action::Photograph(Stamp { pose: self.stands.pose, wall: now.wall }),
        };
        let id = OrderId(seq.number().into());
        self.asked.push_back(BodyRequest::Order(Order { id, action, epoch: Epoch(0), deadline }));
    }

    /// Handles a halt. A running motion is answered when the robot has stopped. After the halt, no order up to this
    /// number can begin.
    fn void(&mut self, seq: Seq) {
        if self.motion().is_some() {
            self.halt();
        } else if self.last.is_some_and(|last| last < seq) && self.under_way.is_none() {
            self.last = Some(seq);
            self.settle(seq, FromRobot::Halted(seq, self.stands.off_centre));
        } else {
            self.answer_again(seq);
        }
    }

    fn halt(&mut self) {
        if let Some(under_way) = self.under_way.as_mut().filter(|under_way| under_way.task.is_motion() && !under_way.is_halted) {
            under_way.is_halted = true;
            self.asked.push_back(BodyRequest::Halt);
        }
    }

    fn done(&mut self) {
        let ahead = self.ahead.take();
        if let Some(motion) = self.motion() {
            self.stands.pose = motion.task.after(self.stands.pose);
        }
        self.answer(false, |seq| FromRobot::Done(seq, ahead));
    }

    fn answer(&mut self, off_centre: OffCentre, words: impl FnOnce(Seq) -> FromRobot) {
        let Some(UnderWay { seq, task, .. }) = self.under_way.take() else { return };
        self.ahead = None;
        if task.is_motion() {
            self.stands.off_centre = off_centre;
        }
        self.settle(seq, words(seq));
        self.begin_above();
    }

    fn settle(&mut self, seq: Seq, words: FromRobot) {
        self.say(&words);
        self.answer = Some((seq, words));
    }

    fn answer_again(&mut self, seq: Seq) {
        if let Some((_, words)) = self.answer.clone().filter(|(answered, _)| *answered == seq) {
            self.say(&words);
        }
    }

    /// Sends a photo without storing it. If the program repeats the order, the answer is that the photo is lost.
    fn send_photo(&mut self, photo: &Photo) {
        let Some(UnderWay { seq, .. }) = self.under_way.take() else { return };
        self.answer =
            Some((seq, FromRobot::NoPhoto(seq, Words::new("the photo was sent already and is lost: order another photo"))));
        if self.from.is_none() && self.outputs.len() < WAITING {
            let length = u32::try_from(photo.bytes.len()).unwrap_or(u32::MAX);
            let mut crc = Crc32::new();
            crc.add(&photo.bytes);
            self.say(&FromRobot::Photo(seq, length, crc.value()));
            self.outputs.push_back(Arc::clone(&photo.bytes));
        }
        self.begin_above();
    }

    fn begin_above(&mut self) {
        if let Some(from) = self.from.take_if(|_| self.under_way.is_none()) {
            self.last = Some(from);
            self.answer = None;
            self.say_hello();
        }
    }

    fn say_hello(&mut self) {
        let Some(Capabilities { parts, step, turn, photo, .. }) = self.capabilities else { return };
        let stands = Whereabouts { off_centre: self.stands.off_centre || self.motion().is_some(), ..self.stands };
        let hello = Hello { name: self.name.clone(), parts, step, turn, photo, stands, last: self.last };
        self.say(&FromRobot::Hello(hello));
    }

    fn say(&mut self, words: &FromRobot) {
        if self.outputs.len() < WAITING {
            self.outputs.push_back(Arc::from(framed(&words.to_string())));
        }
    }
}

#[cfg(test)]
mod tests;
