//! The virtual robot of the Bologna laboratory. A page in a browser shows the robot in a room. A server connects the
//! page with programs: over TCP in the first version, over WebSocket in the version of 2021. The protocols are in
//! `words`, and the robot's assumed position is in `reckoning`.
//!
//! The robot measures nothing. About a move, it reports at most that it has met something. So its driver measures the
//! time of each move:
//!
//! ```text
//!   order ─► [TCP: a new connection] ─► moveForward 330 ─┬─ no report for 330 ms and a margin ─► done
//!                                                        └─ collision wallDown ─► blocked
//! ```
//! Over TCP, the server sends all messages only to the last client that connected from this machine. Without a page,
//! it drops commands. So each motion begins with a new connection. If a page is open, the server greets the
//! connection and sends its messages there from then on.

use std::collections::VecDeque;
use std::time::Duration;

use crate::{Driver, Output, Subject};
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order};
use hallsweep_core::event::{Capabilities, OffCentre, Photo, RobotEvent};
use hallsweep_core::robot::{Part, Parts};
use hallsweep_core::units::{Heading, Now, OrderId, Pose};

mod gauge;
mod greeting;
mod leg;
mod memory;
mod motion;
mod reckoning;
mod room;
mod task;
mod touch;
mod words;

use greeting::GREETING;
use leg::{Leg, LegStage, Way};
use motion::Unheard;
use reckoning::Reckoning;
pub use room::{Extent, Room, Thing};
use task::{Aim, OrderTask, Then};
use words::{Command, Heard, Stream};

/// Duration of a turn. It must be short, because a turn cannot be halted (safety S5). A shorter turn would look wrong
/// on the page.
const TURN: Duration = Duration::from_millis(400);

/// Longest time for a photo. Drawing takes some hundredths of a second, but the machine may be busy.
const DRAWING: Duration = Duration::from_secs(2);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// JSON between semicolons, over TCP. The server reports only contacts.
    Semicolons,
    /// JSON messages over WebSocket. The server also reports the ends of moves.
    Messages,
}

#[derive(Debug)]
pub struct VirtualRobot {
    dialect: Dialect,
    reckoning: Reckoning,
    /// Time for one cell. `step` is in use and may be measured. `step_set` is from the settings or the scene file.
    step: Duration,
    step_set: Duration,
    /// Time from sending a move to the report of a contact, not counting the driving. `None` if it was not measured
    /// yet.
    latency: Option<Duration>,
    stream: Stream,
    is_connected: bool,
    is_greeted: bool,
    /// When the wait for the greeting ends.
    greeting: Option<Duration>,
    /// When it was last checked that the server greets (a page is open).
    looked: Duration,
    /// How long the server took to greet the last connection.
    greeted_after: Duration,
    connected: Duration,
    /// Number of connections in a row without a greeting.
    ungreeted: u8,
    /// Whether the server works but has no page. False if the server has ended, because its page may still be open.
    is_page_closed: bool,
    has_server_ended: bool,
    /// The state of the link as it was last reported to the core. `said` is the reason.
    is_up: bool,
    said: Option<String>,
    task: Option<OrderTask>,
    /// Whether an alarm for a STOP must still be sent. It waits for a connection or for the end of a turn. An alarm
    /// during a turn would leave the robot at a wrong angle.
    owes_alarm: bool,
    /// When the last alarm was handed over for sending. `None` if anything was sent after it.
    alarmed: Option<Duration>,
    off_centre: OffCentre,
    /// Whether the LED of a real robot would blink now.
    led: bool,
    unheard: Option<Unheard>,
    /// Why the position is unknown until the page is opened anew. `is_told_lost` says whether an order was answered
    /// with this reason.
    lost: Option<String>,
    is_told_lost: bool,
    /// The name of the thing that the robot met last. `None` if the robot has moved on since or the server gave no
    /// name.
    met: Option<String>,
    /// How long the robot had driven until its first contact. It is used to measure the latency.
    first_contact: Option<Duration>,
    room: Option<Room>,
    /// Distance from the robot's start to the thing ahead, in cells. `None` after the step was measured.
    gauge: Option<f64>,
    is_gauged: bool,
    /// Driving time ahead so far, while the step is measured.
    gauged: Duration,
    /// Counter of corrections. A correction adds `FOUND`, and a completed step or turn subtracts 1. Above `ASTRAY`,
    /// the scene file counts as that of another room.
    astray: u8,
    /// Number of corrections of the position since the robot last entered a new cell.
    wandered: u8,
    /// When the robot last completed a step without a contact.
    stepped: Option<Duration>,
    outputs: VecDeque<Output>,
    events: VecDeque<RobotEvent>,
    is_changed: bool,
    now: Duration,
}

impl VirtualRobot {
    /// A robot at its start. `step` is the assumed time for a cell.
    #[must_use]
    pub fn new(dialect: Dialect, step: Duration) -> VirtualRobot {
        VirtualRobot {
            dialect,
            reckoning: Reckoning::at_home(),
            step,
            step_set: step,
            latency: None,
            stream: Stream::default(),
            is_connected: false,
            is_greeted: false,
            greeting: None,
            looked: Duration::ZERO,
            greeted_after: Duration::ZERO,
            connected: Duration::ZERO,
            ungreeted: 0,
            is_page_closed: false,
            has_server_ended: false,
            is_up: false,
            said: None,
            task: None,
            owes_alarm: false,
            alarmed: None,
            off_centre: false,
            led: false,
            unheard: None,
            lost: None,
            is_told_lost: false,
            met: None,
            first_contact: None,
            room: None,
            gauge: None,
            is_gauged: false,
            gauged: Duration::ZERO,
            astray: 0,
            wandered: 0,
            stepped: None,
            outputs: VecDeque::new(),
            events: VecDeque::new(),
            is_changed: true,
            now: Duration::ZERO,
        }
    }

    fn can(&self) -> Capabilities {
        let parts = match self.dialect {
            Dialect::Semicolons => Parts::of(&[Part::Base, Part::Bump]),
            Dialect::Messages => Parts::of(&[Part::Base, Part::Bump, Part::AcknowledgedMoves]),
        };
        let (step, turn) = (self.longest_step(), self.longest_turn());
        Capabilities { step, turn, photo: DRAWING, arm: Duration::ZERO, nudges: false, parts }
    }

    fn hear(&mut self, heard: Heard) {
        match heard {
            Heard::Page => self.greeted(),
            Heard::Contact(name) => self.contact(name),
            Heard::Ended(name) => self.acknowledged(name),
            Heard::Refused(name) => self.refused(name),
        }
    }

    fn send(&mut self, command: Command) {
        self.alarmed = Some(self.now).filter(|_| command == Command::Alarm);
        self.outputs.push_back(Output::Send(self.written(command)));
    }

    fn written(&self, command: Command) -> Vec<u8> {
        match self.dialect {
            Dialect::Semicolons => command.between_semicolons(),
            Dialect::Messages => command.as_message(),
        }
    }

    fn leg(&self) -> Option<&Leg> {
        self.task.as_ref().and_then(|task| task.leg.as_ref())
    }

    fn leg_mut(&mut self) -> Option<&mut Leg> {
        self.task.as_mut().and_then(|task| task.leg.as_mut())
    }

    fn answer(&mut self, answer: impl FnOnce(OrderId) -> RobotEvent) {
        if let Some(task) = self.task.take() {
            self.events.push_back(answer(task.order));
            self.is_changed = true;
        }
    }

    fn fail(&mut self, words: &str) {
        self.answer(|order| RobotEvent::Failed(order, words.to_owned()));
    }

    fn begin(&mut self, action: Action) {
        match action {
            Action::Move(_) if self.off_centre => self.fail("it stands away from the centre of its cell: recentre first"),
            Action::Move(step) => self.begin_move(step),
            Action::Recentre => self.begin_recentring(),
            Action::Photograph(stamp) => {
                self.aim(Aim::Draw);
                let subject = Subject { stamp, name: self.met.clone() };
                self.outputs.extend(self.task.as_ref().map(|task| Output::Draw(task.order, subject)));
            }
            Action::Enter | Action::Leave => self.fail("it cannot leave its room"),
            Action::Arm(_) => self.fail("it has no arm"),
        }
    }

    fn begin_move(&mut self, step: Move) {
        let Pose { cell, heading } = self.reckoning.pose();
        let (towards, backward) = match step {
            Move::Forward => (heading, false),
            Move::Backward => (heading.opposite(), true),
            Move::TurnLeft => return self.begin_turn(heading.left(), true),
            Move::TurnRight => return self.begin_turn(heading.right(), false),
            Move::NudgeLeft | Move::NudgeRight => return self.fail("it has no small corrective turns"),
        };
        let to = Pose { cell: cell.ahead(towards), heading };
        let cells = self.reckoning.way_to(to.cell, towards).clamp(0.5, 1.5);
        self.aim(Aim::Step(to));
        self.drive(towards, cells, backward);
    }

    fn begin_turn(&mut self, heading: Heading, left: bool) {
        self.aim(Aim::Turn(Pose { heading, ..self.reckoning.pose() }));
        self.set_out(Way::Turn { left, lasts: TURN });
    }

    fn aim(&mut self, aim: Aim) {
        if let Some(task) = &mut self.task {
            task.aim = aim;
        }
    }
}

impl Driver for VirtualRobot {
    fn handle_connected(&mut self, now: Now) {
        self.now = now.since_start;
        self.stream.begin();
        (self.is_connected, self.is_greeted, self.connected) = (true, false, self.now);
        if self.owes_alarm {
            self.alarm();
        }
        match self.dialect {
            Dialect::Semicolons => self.greeting = Some(self.now + GREETING),
            // This server does not greet. Only the end of a move shows whether a page is open.
            Dialect::Messages => self.greeted(),
        }
    }

    fn handle_lost(&mut self, words: &str, now: Now) {
        self.now = now.since_start;
        (self.is_connected, self.is_greeted, self.greeting, self.has_server_ended) = (false, false, None, true);
        // If an alarm was sent last, it may not have arrived. So it is sent again.
        self.owes_alarm |= self.alarmed.take().is_some();
        self.go_down(words);
    }

    fn handle_closed(&mut self, by_both: bool, now: Now) {
        self.now = now.since_start;
        self.closed(by_both);
    }

    fn handle_received(&mut self, bytes: &[u8], now: Now) {
        self.now = now.since_start;
        match self.dialect {
            Dialect::Semicolons => {
                for heard in self.stream.read(bytes) {
                    self.hear(heard);
                }
            }
            Dialect::Messages => {
                if let Some(heard) = words::message(bytes) {
                    self.hear(heard);
                }
            }
        }
    }

    fn handle_sent(&mut self, now: Now) {
        self.now = now.since_start;
        if let Some(leg) = self.leg_mut().filter(|leg| leg.stage == LegStage::Queued) {
            leg.stage = LegStage::Sent(now.since_start);
            self.is_changed = true;
        }
    }

    fn handle_order(&mut self, order: Order, now: Now) {
        self.now = now.since_start;
        if let Some(task) = &self.task {
            let words = format!("order {} is still under way", task.order);
            return self.events.push_back(RobotEvent::Failed(order.id, words));
        }
        let deadline = self.now.saturating_add(order.deadline);
        let Order { id, action, .. } = order;
        self.task = Some(OrderTask { order: id, action, deadline, aim: Aim::Back, leg: None, hindered: 0 });
        match self.lost.clone().filter(|_| action.is_motion()) {
            Some(_) if self.is_told_lost && self.dialect == Dialect::Messages => self.is_put_home(),
            Some(lost) => self.fail_lost(lost),
            None if !self.is_up => self.fail("it is not connected"),
            None if !action.is_motion() => self.begin(action),
            None if self.is_to_be_gauged() => self.begin_gauging(),
            None => match self.is_to_touch(order.deadline) {
                Some((way, is_certain)) => self.begin_touching(way, is_certain),
                None => self.begin(action),
            },
        }
    }

    fn handle_halt(&mut self, now: Now) {
        self.now = now.since_start;
        self.halt();
    }

    /// The robot has no LED. But a request to begin blinking shows that a search starts with an empty map.
    fn handle_led(&mut self, blinks: bool, _: Now) {
        if blinks && !self.led {
            self.reckoning.begin_search();
        }
        (self.led, self.is_changed) = (blinks, true);
    }

    fn handle_drawing(&mut self, order: OrderId, drawing: Photo, _: Now) {
        if self.task.as_ref().is_some_and(|task| task.order == order && task.aim == Aim::Draw) {
            self.answer(|order| RobotEvent::Photo(order, drawing));
        }
    }

    fn handle_timeout(&mut self, now: Now) {
        self.now = now.since_start;
        self.look_after_page();
        self.pass();
    }

    fn poll_output(&mut self) -> Option<Output> {
        self.outputs.pop_front()
    }

    fn poll_event(&mut self) -> Option<RobotEvent> {
        self.events.pop_front()
    }

    fn poll_timeout(&self) -> Option<Duration> {
        let deadline = self.task.as_ref().map(|task| task.deadline);
        [self.greeting, self.look(), deadline, self.leg_due()].into_iter().flatten().min()
    }

    fn poll_memory(&mut self) -> Option<String> {
        std::mem::take(&mut self.is_changed).then(|| self.remembered())
    }

    fn is_off_centre(&self) -> OffCentre {
        self.off_centre
    }
}
