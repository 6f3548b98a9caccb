//! The simulated robot, without input or output of its own. Orders, halts and the time go in, and reports come out.
//! Nothing here waits. Channels, timers and the speed factor belong to `link`. The core decides what to do next.
//!
//! There is no clock tick. When a motion begins, the exact time at which it ends or touches something is computed.

use std::collections::VecDeque;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;
use std::time::Duration;

use super::drive::{BodyPose, Chassis, Motion, Wheels, normal};
use super::hall::Hall;
use super::memory::{SimMemory, Taken, centre_of, reseeded, without};
use super::senses::{Senses, Thermometer};
use super::settings::SimSettings;
use super::sonar::way_to_contact;
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order};
use hallsweep_core::event::{Obstacle, RobotEvent};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::{Now, OrderId, Pose};

mod entrance;
mod faults;
mod hook;
mod introduction;
mod photo;
mod recall;

pub use self::faults::Faults;
use self::{hook::Handling, photo::Film};

#[derive(Debug)]
pub struct Sim {
    /// The hall without the pieces that this robot has taken.
    hall: Arc<Hall>,
    /// The hall including the pieces that this robot has taken.
    floor: Arc<Hall>,
    taken: Taken,
    settings: SimSettings,
    chassis: Chassis,
    now: Duration,
    /// The cell and heading of the robot after its last completed order.
    pose: Pose,
    /// Number of steps from home to a robot that stands outside and faces the entrance. 0 if the robot is in the
    /// hall.
    outside: u8,
    /// Where the robot really stands while it does not move.
    body: BodyPose,
    task: Option<SimTask>,
    led: bool,
    senses: Senses,
    thermometer: Thermometer,
    faults: Faults,
    failures: RandomStream,
    events: VecDeque<RobotEvent>,
    before: Duration,
    /// Number of times that the robot continued after the program had ended.
    restarts: u32,
    /// Whether the state has changed since it was last stored.
    unkept: bool,
}

#[derive(Debug)]
struct SimTask {
    order: OrderId,
    deadline: Duration,
    work: Work,
}

#[derive(Debug)]
enum Work {
    Drive { motion: Motion, end: End },
    Photograph { ends: Duration, film: Film },
    Handle { ends: Duration, what: Handling },
}

/// How a motion ends if nothing interrupts it.
#[derive(Clone, Copy, Debug)]
enum End {
    At(Pose),
    /// Outside the entrance, this many steps from home.
    Outside(u8),
    /// At an obstacle. The obstacle is in front of the robot if `ahead`, or else behind it.
    Against {
        ahead: bool,
    },
}

#[derive(Clone, Copy)]
enum Due {
    End,
    Deadline,
    Temperature,
}

impl Sim {
    /// Makes a new robot at home in this hall, facing south. Its first reports are `Stands`, the hook if there is
    /// one, and `LinkUp`.
    #[must_use]
    pub fn new(hall: Arc<Hall>, settings: SimSettings) -> Sim {
        Sim::placed(hall, settings, SimMemory::NEW)
    }

    /// Makes a robot that stands still at the place in its memory.
    fn placed(hall: Arc<Hall>, settings: SimSettings, memory: SimMemory) -> Sim {
        let settings = settings.sound();
        let floor = Arc::clone(&hall);
        let hall = without(&floor, memory.taken);
        let noise = SimSettings { seed: reseeded(settings.seed, memory.restarts), ..settings };
        let mut sim = Sim {
            chassis: Chassis { wheel_radius_m: settings.wheel_radius_m, axle_m: settings.axle_m },
            now: Duration::ZERO,
            pose: memory.pose,
            outside: memory.outside,
            body: memory.body(hall.cell_m()),
            taken: memory.taken,
            floor,
            task: None,
            led: false,
            senses: Senses::new(Arc::clone(&hall), &noise),
            thermometer: Thermometer::new(Arc::clone(&hall), memory.age),
            faults: Faults::default(),
            failures: RandomStream::new(noise.seed, "photo"),
            events: VecDeque::new(),
            before: memory.age,
            restarts: memory.restarts,
            unkept: true,
            hall,
            settings,
        };
        sim.introduce();
        sim
    }

    /// Begins an order, or reports at once why it cannot be done.
    pub fn handle_order(&mut self, order: Order, now: Now) {
        self.pass_to(now.since_start);
        if let Some(task) = &self.task {
            let words = format!("order {} is still under way", task.order);
            return self.events.push_back(RobotEvent::Failed(order.id, words));
        }
        match order.action {
            Action::Move(step) => self.begin_move(order, step),
            Action::Recentre => self.begin_recentring(order),
            Action::Photograph(stamp) => self.begin_photo(order, stamp),
            Action::Enter => self.begin_entering(order),
            Action::Leave => self.begin_leaving(order),
            Action::Arm(action) => self.begin_hook(order, action),
        }
    }

    /// Stops wheels and hook where they are. A photo is not a motion and goes on.
    pub fn handle_halt(&mut self, now: Now) {
        self.pass_to(now.since_start);
        if let Some(SimTask { order, work: Work::Drive { .. } | Work::Handle { .. }, .. }) = self.task {
            self.stop_wheels();
            self.events.push_back(RobotEvent::Halted(order, self.is_off_centre()));
        }
    }

    pub const fn handle_led(&mut self, blinking: bool) {
        self.led = blinking;
    }

    /// Handles everything that is due up to `now`, in order of time.
    pub fn handle_timeout(&mut self, now: Now) {
        self.pass_to(now.since_start);
    }

    pub fn poll_event(&mut self) -> Option<RobotEvent> {
        self.events.pop_front()
    }

    /// When something will happen next by itself, counted from the start of the run.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.next_due().map(|(at, _)| at)
    }

    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    /// Whether the robot is away from the centre of its cell or between two headings.
    #[must_use]
    pub fn is_off_centre(&self) -> bool {
        self.body_at(self.now) != self.centre()
    }

    /// Tells the robot that somebody has removed or moved luggage in the hall.
    pub fn handle_hall(&mut self, hall: Arc<Hall>) {
        self.floor = hall;
        self.look_at_floor();
    }

    fn look_at_floor(&mut self) {
        self.hall = without(&self.floor, self.taken);
        self.senses.look_into(Arc::clone(&self.hall));
    }

    /// Where the robot's body really is at `now`, if nothing interrupts its motion.
    #[must_use]
    pub fn pose_at(&self, now: Now) -> BodyPose {
        self.body_at(now.since_start)
    }

    #[must_use]
    pub const fn led(&self) -> bool {
        self.led
    }

    fn begin_move(&mut self, order: Order, step: Move) {
        if self.is_off_centre() {
            return self.fail(order.id, "it stands away from the centre of its cell: recentre first");
        }
        if self.outside > 0 {
            return self.fail(order.id, "it is before the entrance: it must enter first");
        }
        let heading = self.pose.heading;
        match step {
            Move::Forward => self.begin_step(order, 1.0),
            Move::Backward => self.begin_step(order, -1.0),
            Move::TurnLeft => self.begin_turn(order, -FRAC_PI_2, Pose { heading: heading.left(), ..self.pose }),
            Move::TurnRight => self.begin_turn(order, FRAC_PI_2, Pose { heading: heading.right(), ..self.pose }),
            Move::NudgeLeft | Move::NudgeRight => self.fail(order.id, "it has no small corrective turns"),
        }
    }

    /// Begins a step of one cell: along the heading if `sign` is 1, backwards if it is −1. An obstacle makes the step
    /// shorter.
    fn begin_step(&mut self, order: Order, sign: f64) {
        let heading = if sign > 0.0 { self.pose.heading } else { self.pose.heading.opposite() };
        let target = self.pose.cell.ahead(heading);
        let (way, end) = match way_to_contact(self.hall.truth(target)) {
            Some(way) => (way, End::Against { ahead: sign > 0.0 }),
            None => (1.0, End::At(Pose { cell: target, ..self.pose })),
        };
        self.drive(order, sign * way, end);
    }

    /// Begins a turn by `angle` radians. A positive angle is clockwise.
    fn begin_turn(&mut self, order: Order, angle: f64, to: Pose) {
        let speed = FRAC_PI_2 / self.settings.turn.as_secs_f64();
        let lasts = self.settings.turn.mul_f64(angle.abs() / FRAC_PI_2);
        self.begin_motion(order, self.chassis.spin(speed.copysign(angle)), lasts, End::At(to));
    }

    /// Takes a sonar reading and returns the robot to where its last completed order left it. After a halt, the robot
    /// is either off the centre or between two headings, never both. It makes no other motion before it has
    /// recentred.
    fn begin_recentring(&mut self, order: Order) {
        let reading = self.senses.listen(self.body);
        self.events.push_back(reading);
        if !self.is_off_centre() {
            self.events.push_back(RobotEvent::Done(order.id));
            return;
        }
        let centre = self.centre();
        let angle = normal(centre.theta - self.body.theta);
        if angle == 0.0 {
            let (dx, dy) = centre.ahead();
            let way_m = (centre.x_m - self.body.x_m) * dx + (centre.y_m - self.body.y_m) * dy;
            let end = if self.outside > 0 { End::Outside(self.outside) } else { End::At(self.pose) };
            self.drive(order, way_m / self.hall.cell_m(), end);
        } else {
            self.begin_turn(order, angle, self.pose);
        }
    }

    /// Drives straight on by this number of cells. A negative number drives backwards.
    fn drive(&mut self, order: Order, cells: f64, end: End) {
        let speed = self.hall.cell_m() / self.settings.step.as_secs_f64();
        let lasts = self.settings.step.mul_f64(cells.abs());
        self.begin_motion(order, self.chassis.straight(speed.copysign(cells)), lasts, end);
    }

    fn begin_motion(&mut self, order: Order, wheels: Wheels, lasts: Duration, end: End) {
        let motion = Motion { from: self.body, wheels, began: self.now, ends: self.now + lasts };
        self.begin(order, Work::Drive { motion, end });
    }

    fn begin(&mut self, order: Order, work: Work) {
        self.task = Some(SimTask { order: order.id, deadline: self.now.saturating_add(order.deadline), work });
        self.unkept = true;
    }

    /// Handles everything that is due up to `now`, each at its exact time. So the result does not depend on how often
    /// time is advanced.
    fn pass_to(&mut self, now: Duration) {
        while let Some((at, due)) = self.next_due().filter(|(at, _)| *at <= now) {
            self.now = self.now.max(at);
            self.unkept = true;
            match due {
                Due::End => self.finish(),
                Due::Deadline => {
                    if let Some(order) = self.task.as_ref().map(|task| task.order) {
                        self.stop_wheels();
                        self.fail(order, "it did not finish in time and has halted by itself");
                    }
                }
                Due::Temperature => self.events.extend(self.thermometer.read()),
            }
        }
        self.now = self.now.max(now);
    }

    /// The next event and its time. If several events have the same time, the end of the order comes first.
    fn next_due(&self) -> Option<(Duration, Due)> {
        let end = self.task.as_ref().and_then(|task| Some((task.work.ends()?, Due::End)));
        let deadline = self.task.as_ref().map(|task| (task.deadline, Due::Deadline));
        let is_read = !self.faults.no_thermometer;
        let temperature = self.thermometer.next().filter(|_| is_read).map(|at| (at, Due::Temperature));
        [end, deadline, temperature].into_iter().flatten().min_by_key(|(at, _)| *at)
    }

    fn finish(&mut self) {
        let Some(SimTask { order, work, .. }) = self.task.take() else { return };
        match work {
            Work::Drive { end: End::Outside(steps), .. } => {
                self.outside = steps;
                self.body = self.centre();
                self.events.push_back(RobotEvent::Done(order));
            }
            Work::Drive { end: End::At(pose), .. } => {
                (self.pose, self.outside) = (pose, 0);
                self.body = self.centre();
                self.events.extend(self.senses.listen_for_change(self.body));
                self.tell_hook();
                self.events.extend(self.senses.look_ahead(self.pose));
                self.events.push_back(RobotEvent::Done(order));
            }
            Work::Drive { motion, end: End::Against { ahead } } => {
                self.body = motion.at(self.chassis, motion.ends);
                self.events.extend(self.senses.listen_for_change(self.body));
                let obstacle = if ahead { self.senses.recognise(self.pose, self.pose) } else { Obstacle::Unknown };
                self.events.push_back(RobotEvent::Blocked(order, obstacle));
            }
            Work::Photograph { film, .. } => self.deliver(order, film),
            Work::Handle { what, .. } => self.handled(order, what),
        }
    }

    fn fail(&mut self, order: OrderId, words: &str) {
        self.events.push_back(RobotEvent::Failed(order, words.to_owned()));
    }

    /// Ends the current order without a report, and leaves the body where it is now.
    fn stop_wheels(&mut self) {
        self.body = self.body_at(self.now);
        self.task = None;
        self.unkept = true;
    }

    fn centre(&self) -> BodyPose {
        centre_of(self.pose, self.outside, self.hall.cell_m())
    }

    fn body_at(&self, now: Duration) -> BodyPose {
        match &self.task {
            Some(SimTask { work: Work::Drive { motion, .. }, .. }) => motion.at(self.chassis, now),
            Some(SimTask { work: Work::Photograph { .. } | Work::Handle { .. }, .. }) | None => self.body,
        }
    }
}

impl Work {
    /// When the work ends. `None` while a photo is being developed elsewhere, because the work then ends when the
    /// photo is ready.
    const fn ends(&self) -> Option<Duration> {
        match self {
            Work::Drive { motion, .. } => Some(motion.ends),
            Work::Handle { ends, .. } => Some(*ends),
            Work::Photograph { film: Film::Away, .. } => None,
            Work::Photograph { ends, film: Film::Here(_) | Film::Developed(_) } => Some(*ends),
        }
    }
}

#[cfg(test)]
mod tests;
