//! Tests of both ends, joined by a wire that loses, damages, duplicates and delays bytes, in simulated time and by a
//! seed. In all cases, every order is answered once and nothing begins after a halt. Both ends agree where the robot
//! stands.

use std::collections::VecDeque;
use std::time::Duration;

use super::{BodyRequest, LineDriver, LineRobot, RobotName};
use crate::{Driver, Output};
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order, Stamp};
use hallsweep_core::event::{Capabilities, Obstacle, Photo, RobotEvent, Whereabouts};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::robot::Parts;
use hallsweep_core::units::{Epoch, Now, OrderId, Pose, WallTime};

const TICK: Duration = Duration::from_millis(5);

const ORDERS: u64 = 120;

struct Wire {
    chance: RandomStream,
    trouble: f64,
    /// Bytes on the wire with their times of arrival. They arrive in the order in which they were sent.
    bytes: VecDeque<(Duration, u8)>,
}

impl Wire {
    fn new(seed: u64, name: &str, trouble: f64) -> Wire {
        Wire { chance: RandomStream::new(seed, name), trouble, bytes: VecDeque::new() }
    }

    fn send(&mut self, bytes: &[u8], now: Duration) {
        let held_back = if self.chance.happens(self.trouble) { self.chance.below(120) } else { 0 };
        let free = self.bytes.back().map_or(now, |(at, _)| *at).max(now + Duration::from_millis(held_back));
        let times = if self.chance.happens(self.trouble / 2.0) { 2 } else { 1 };
        for byte in bytes.repeat(times) {
            if self.chance.happens(self.trouble / 20.0) {
                continue;
            }
            let noise = if self.chance.happens(self.trouble / 20.0) { self.chance.below(256) } else { 0 };
            self.bytes.push_back((free, byte ^ u8::try_from(noise).unwrap()));
        }
    }

    fn receive(&mut self, now: Duration) -> Vec<u8> {
        let due = self.bytes.iter().take_while(|(at, _)| *at <= now).count();
        self.bytes.drain(..due).map(|(_, byte)| byte).collect()
    }
}

/// A body that does what it is requested to do, unless an obstacle is in its way.
struct Body {
    chance: RandomStream,
    pose: Pose,
    off_centre: bool,
    under_way: Option<(Order, Duration)>,
    begun: u64,
}

impl Body {
    fn obey(&mut self, asked: BodyRequest, now: Duration) -> Option<RobotEvent> {
        match asked {
            BodyRequest::Order(order) => {
                assert!(self.under_way.is_none(), "one order at a time");
                self.begun += u64::from(order.action.is_motion());
                let takes = Duration::from_millis(50 + self.chance.below(400));
                self.under_way = Some((order, now + takes));
                None
            }
            BodyRequest::Halt => {
                let (order, _) = self.under_way.take().expect("only what moves is halted");
                self.off_centre = true;
                Some(RobotEvent::Halted(order.id, true))
            }
            BodyRequest::Led(_) => None,
        }
    }

    fn passes(&mut self, now: Duration) -> Option<RobotEvent> {
        let (order, _) = self.under_way.take_if(|(_, until)| *until <= now)?;
        Some(match order.action {
            Action::Photograph(_) => RobotEvent::Photo(order.id, photo()),
            Action::Move(_) if self.chance.happens(0.15) => {
                self.off_centre = true;
                RobotEvent::Blocked(order.id, Obstacle::Unknown)
            }
            action @ (Action::Move(_) | Action::Recentre | Action::Enter | Action::Leave | Action::Arm(_)) => {
                (self.pose, self.off_centre) = (after(self.pose, action), false);
                RobotEvent::Done(order.id)
            }
        })
    }
}

fn photo() -> Photo {
    let bytes: Vec<u8> = super::picture::PNG.iter().copied().chain((0..2000).map(|n: u32| n.to_le_bytes()[0])).collect();
    Photo { bytes: bytes.into(), media_type: "image/png" }
}

fn after(Pose { cell, heading }: Pose, action: Action) -> Pose {
    match action {
        Action::Move(Move::Forward) => Pose { cell: cell.ahead(heading), heading },
        Action::Move(Move::Backward) => Pose { cell: cell.ahead(heading.opposite()), heading },
        Action::Move(Move::TurnLeft) => Pose { cell, heading: heading.left() },
        Action::Move(Move::TurnRight) => Pose { cell, heading: heading.right() },
        Action::Recentre => Pose { cell, heading },
        other @ (Action::Move(Move::NudgeLeft | Move::NudgeRight)
        | Action::Photograph(_)
        | Action::Enter
        | Action::Leave
        | Action::Arm(_)) => panic!("{other:?} is no motion of this robot"),
    }
}

struct Run {
    now: Now,
    chance: RandomStream,
    driver: LineDriver,
    there: Wire,
    back: Wire,
    robot: LineRobot,
    body: Body,
    /// What the program knows: whether the link is up, where the robot stands, and which order is open.
    is_up: bool,
    pose: Pose,
    off_centre: bool,
    open: Option<Order>,
    given: u64,
    answered: u64,
    /// Number of motions that had begun when the program learnt of the last halt. No other motion may begin before
    /// the next order.
    begun_at_halt: Option<u64>,
}

impl Run {
    fn new(seed: u64, trouble: f64) -> Run {
        let ms = Duration::from_millis;
        let can =
            Capabilities { step: ms(450), turn: ms(450), photo: ms(450), arm: ms(0), nudges: false, parts: Parts::ROUND_ROBOT };
        let mut robot = LineRobot::new(RobotName::new("ada").unwrap());
        robot.handle_event(RobotEvent::LinkUp(can));
        let mut driver = LineDriver::new();
        driver.handle_connected(Now::default());
        Run {
            now: Now::default(),
            chance: RandomStream::new(seed, "program"),
            driver,
            there: Wire::new(seed, "there", trouble),
            back: Wire::new(seed, "back", trouble),
            robot,
            body: Body {
                chance: RandomStream::new(seed, "body"),
                pose: Pose::START,
                off_centre: false,
                under_way: None,
                begun: 0,
            },
            is_up: false,
            pose: Pose::START,
            off_centre: false,
            open: None,
            given: 0,
            answered: 0,
            begun_at_halt: None,
        }
    }

    fn run(mut self) -> Run {
        for _ in 0..400_000 {
            if self.given == ORDERS && self.open.is_none() {
                return self;
            }
            self.tick();
        }
        panic!("after {} orders nothing went on", self.given);
    }

    fn tick(&mut self) {
        self.now.since_start += TICK;
        self.program();
        self.driver.handle_timeout(self.now);
        self.carry_there();
        self.robot_lives();
        let heard = self.back.receive(self.now.since_start);
        self.driver.handle_received(&heard, self.now);
        while let Some(event) = self.driver.poll_event() {
            self.told(event);
        }
    }

    /// Lets the program send an order if it can. Sometimes it halts the robot instead.
    fn program(&mut self) {
        if self.is_up && self.open.is_none() && self.given < ORDERS {
            self.given += 1;
            let action = match self.chance.below(6) {
                _ if self.off_centre => Action::Recentre,
                0 => Action::Photograph(Stamp { pose: self.pose, wall: WallTime::default() }),
                1 => Action::Move(Move::TurnLeft),
                2 => Action::Move(Move::TurnRight),
                3 => Action::Move(Move::Backward),
                _ => Action::Move(Move::Forward),
            };
            let order = Order { id: OrderId(self.given), action, epoch: Epoch(0), deadline: Duration::from_millis(2500) };
            (self.open, self.begun_at_halt) = (Some(order), None);
            self.driver.handle_order(order, self.now);
        } else if self.chance.happens(0.004) {
            self.driver.handle_halt(self.now);
        }
    }

    fn carry_there(&mut self) {
        while let Some(output) = self.driver.poll_output() {
            match output {
                Output::Send(bytes) => self.there.send(&bytes, self.now.since_start),
                Output::GiveUp(words) => self.reconnect(&words),
                other @ (Output::Reconnect | Output::Draw(..)) => panic!("{other:?}"),
            }
        }
    }

    fn reconnect(&mut self, words: &str) {
        self.there.bytes.clear();
        self.back.bytes.clear();
        self.driver.handle_lost(words, self.now);
        self.driver.handle_connected(self.now);
        self.robot.handle_lost();
    }

    fn robot_lives(&mut self) {
        let heard = self.there.receive(self.now.since_start);
        self.robot.handle_received(&heard, self.now);
        self.robot.handle_timeout(self.now);
        let done = self.body.passes(self.now.since_start);
        // The motion has just ended, before the halt arrived.
        if let Some(event) = done {
            self.robot.handle_event(event);
        }
        while let Some(asked) = self.robot.poll_asked() {
            if asked == BodyRequest::Halt && self.body.under_way.is_none() {
                continue;
            }
            if let Some(event) = self.body.obey(asked, self.now.since_start) {
                self.robot.handle_event(event);
            }
        }
        while let Some(bytes) = self.robot.poll_output() {
            self.back.send(&bytes, self.now.since_start);
        }
    }

    fn told(&mut self, event: RobotEvent) {
        match event {
            RobotEvent::LinkLost(_) => (self.is_up, self.open) = (false, None),
            RobotEvent::Stands(Whereabouts { pose, off_centre }) => (self.pose, self.off_centre) = (pose, off_centre),
            RobotEvent::LinkUp(_) => {
                self.is_up = true;
                self.agree();
            }
            RobotEvent::Done(id) => {
                let order = self.close(id);
                (self.pose, self.off_centre) = (after(self.pose, order.action), false);
                self.agree();
            }
            RobotEvent::Blocked(id, _) | RobotEvent::Failed(id, _) | RobotEvent::Halted(id, true) => {
                self.close(id);
                self.off_centre = true;
                self.stays();
            }
            RobotEvent::Halted(id, false) => {
                self.close(id);
                self.stays();
            }
            RobotEvent::Photo(id, picture) => {
                assert_eq!(picture, photo());
                self.close(id);
            }
            RobotEvent::PhotoFailed(id, _) => drop(self.close(id)),
            other @ (RobotEvent::StandsOutside(..)
            | RobotEvent::Paused
            | RobotEvent::Found(..)
            | RobotEvent::Arm(_)
            | RobotEvent::ParcelLost(_)
            | RobotEvent::Sonar(_)
            | RobotEvent::Ahead(_)
            | RobotEvent::Temperature(_)) => panic!("nobody has said {other:?}"),
        }
    }

    fn close(&mut self, id: OrderId) -> Order {
        self.answered += 1;
        self.open.take_if(|order| order.id == id).expect("every order is answered once, and nothing else is")
    }

    /// From now on, checks that no motion begins before the next order, whatever still arrives on the wire.
    fn stays(&mut self) {
        self.agree();
        self.begun_at_halt = Some(self.body.begun);
    }

    fn agree(&self) {
        assert_eq!((self.pose, self.off_centre), (self.body.pose, self.body.off_centre), "both agree where it stands");
        assert!(self.begun_at_halt.is_none_or(|begun| begun == self.body.begun), "nothing begins after a halt");
    }
}

#[test]
fn over_a_good_wire_every_order_is_answered_and_the_link_stands() {
    let run = Run::new(0, 0.0).run();
    assert_eq!(run.answered, ORDERS);
}

/// Tests safety S5, R2 (docs/safety.md).
#[test]
fn whatever_the_wire_does_every_order_is_answered_once_and_both_agree_where_the_robot_stands() {
    for seed in 0..60 {
        for trouble in [0.02, 0.1, 0.3] {
            let run = Run::new(seed, trouble).run();
            assert!(run.answered > ORDERS / 2, "seed {seed}, trouble {trouble}: {} orders were answered", run.answered);
        }
    }
}
