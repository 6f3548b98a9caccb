//! What happens to the pair as time passes. The end of an order, a missed deadline and a slip are each handled at
//! their exact time. So the result does not depend on how often time is advanced. `orders` has the beginning of work.

use std::time::Duration;

use super::grip::{Grip, STEP};
use super::orders::moved;
use super::robot::{Astray, PairTask, Work};
use super::{Pair, RobotEvent};
use hallsweep_core::arm::{ArmAction, Controllers, Gripper, Parcel};
use hallsweep_core::pair::Which;
use hallsweep_core::units::OrderId;

/// How often force and angle of a lifted parcel are reported.
const REPORTS: Duration = Duration::from_millis(500);

/// Lowest height of a parcel while it is being lowered, as a share of the full height. So the grippers bear the
/// parcel until the lowering ends.
const TOUCHES: f64 = 1e-6;

#[derive(Clone, Copy)]
enum Due {
    End(Which),
    Deadline(Which),
    Hold,
    Report,
}

impl Pair {
    pub(super) fn pass_to(&mut self, now: Duration) {
        while let Some((at, due)) = self.next_due(true).filter(|(at, _)| *at <= now) {
            self.now = self.now.max(at);
            match due {
                Due::End(which) => self.finish(which),
                Due::Deadline(which) => self.give_up(which),
                Due::Hold => self.hold(),
                Due::Report => {
                    self.next_report = self.now + REPORTS;
                    self.tell_arms();
                }
            }
        }
        self.now = self.now.max(now);
    }

    /// Time of the next event that causes a report.
    pub(super) fn next_heard(&self) -> Option<Duration> {
        self.next_due(false).map(|(at, _)| at)
    }

    /// The next event and its time. If several events have the same time, the end of an order comes first.
    fn next_due(&self, with_steps: bool) -> Option<(Duration, Due)> {
        let ends = Which::ALL.map(|which| Some((self.task(which)?.run?.ends, Due::End(which))));
        let deadlines = Which::ALL.map(|which| Some((self.task(which)?.deadline, Due::Deadline(which))));
        let lifting = Which::ALL
            .into_iter()
            .any(|which| matches!(self.task(which), Some(PairTask { work: Work::Arm(ArmAction::Lift), run: Some(_), .. })));
        let is_loaded = lifting || self.grip.as_ref().is_some_and(Grip::is_loaded);
        let held = [
            (with_steps && is_loaded).then_some((self.next_step, Due::Hold)),
            is_loaded.then_some((self.next_report, Due::Report)),
        ];
        ends.into_iter().chain(deadlines).chain(held).flatten().min_by_key(|(at, _)| *at)
    }

    fn task(&self, which: Which) -> Option<&PairTask> {
        self.robots[which.index()].task.as_ref()
    }

    fn finish(&mut self, which: Which) {
        self.unkept = true;
        let together = self.task(which).and_then(|task| task.run).is_some_and(|run| run.together);
        if together {
            return self.finish_together();
        }
        let Some(PairTask { order, work, .. }) = self.robots[which.index()].task.take() else { return };
        let robot = &mut self.robots[which.index()];
        match work {
            Work::Step { to, until, against: Some(obstacle) } => {
                robot.astray = Astray::Along(to, until);
                self.say(which, RobotEvent::Blocked(order, obstacle));
            }
            Work::Step { to, against: None, .. } => {
                robot.stands = moved(robot.stands, to);
                // The base has moved, so the gripper is no longer aligned with a parcel.
                if robot.aligned.take().is_some() {
                    self.tell_arm(which);
                }
                self.done(which, order);
            }
            Work::Turn { clockwise } => {
                let heading = robot.stands.heading;
                robot.stands.heading = if clockwise { heading.right() } else { heading.left() };
                self.done(which, order);
            }
            Work::Back => {
                robot.astray = Astray::Not;
                self.done(which, order);
            }
            Work::Arm(action) => self.finish_arm(which, order, action),
        }
    }

    fn finish_arm(&mut self, which: Which, order: OrderId, action: ArmAction) {
        match action {
            ArmAction::FindParcel(place) => {
                let found = self.look(place);
                return self.say(which, RobotEvent::Found(order, found));
            }
            ArmAction::AlignEndEffector(place) => self.robots[which.index()].aligned = Some(place),
            ArmAction::CloseGripper if self.settings.mishaps.jams.contains(&self.parcel_number()) => {
                let words = "the gripper does not close: something is jammed in it".to_owned();
                return self.say(which, RobotEvent::Failed(order, words));
            }
            ArmAction::CloseGripper => {
                self.robots[which.index()].gripper = Gripper::Closed;
                self.grasp();
            }
            ArmAction::HoldForce => self.robots[which.index()].controllers.force = true,
            ArmAction::HoldAngle => self.robots[which.index()].controllers.angle = true,
            ArmAction::HoldDistance => self.robots[which.index()].controllers.distance = true,
            ArmAction::Release => self.release(which),
            // These two actions are finished in `finish_together`.
            ArmAction::Lift | ArmAction::Lower => {}
        }
        self.tell_arms();
        self.done(which, order);
    }

    /// Begins a grip if both grippers are closed around the same parcel.
    fn grasp(&mut self) {
        let [one, two] = &self.robots;
        let closed = one.gripper == Gripper::Closed && two.gripper == Gripper::Closed;
        let Some(place) = one.aligned.filter(|place| closed && two.aligned == Some(*place)) else { return };
        if let Some(piece) = self.ground.piece_at(place) {
            self.grip = Some(Grip::new(Parcel { piece, place }, &mut self.noise));
        }
    }

    fn release(&mut self, which: Which) {
        let robot = &mut self.robots[which.index()];
        (robot.gripper, robot.aligned, robot.controllers) = (Gripper::Open, None, Controllers::default());
        if let Some(Parcel { piece, place }) = self.grip.take().map(|grip| grip.parcel)
            && place == self.settings.container
        {
            self.ground.take_in(piece);
        }
    }

    fn finish_together(&mut self) {
        let [Some(one), Some(two)] = Which::ALL.map(|which| self.robots[which.index()].task.take()) else { return };
        let orders = [one.order, two.order];
        match (one.work, two.work) {
            (Work::Step { .. }, Work::Step { .. }) => return self.finish_train_step([one, two]),
            (Work::Arm(ArmAction::Lift), _) => self.set_height(1.0),
            (Work::Arm(ArmAction::Lower), _) => {
                self.set_height(0.0);
                if let Some(parcel) = self.grip.as_ref().map(|grip| grip.parcel) {
                    self.ground.put(parcel);
                }
            }
            (Work::Step { .. } | Work::Back | Work::Turn { .. } | Work::Arm(_), _) => {
                self.robots.iter_mut().for_each(|robot| robot.astray = Astray::Not);
            }
        }
        self.tell_arms();
        Which::ALL.into_iter().zip(orders).for_each(|(which, order)| self.done(which, order));
    }

    fn set_height(&mut self, height: f64) {
        if let Some(grip) = &mut self.grip {
            grip.height = height;
        }
    }

    fn finish_train_step(&mut self, tasks: [PairTask; 2]) {
        let [Work::Step { to: one, until, against }, Work::Step { to: two, against: other, .. }] = [tasks[0].work, tasks[1].work]
        else {
            return;
        };
        let (to, met) = ([one, two], [against, other]);
        if met.iter().any(Option::is_some) {
            for which in Which::ALL {
                let (index, order) = (which.index(), tasks[which.index()].order);
                self.robots[index].astray = Astray::Along(to[index], until);
                let answer = met[index].map_or(RobotEvent::Halted(order, true), |obstacle| RobotEvent::Blocked(order, obstacle));
                self.say(which, answer);
            }
            return;
        }
        let before = [self.robots[0].stands.place, self.robots[1].stands.place];
        if let Some(grip) = &mut self.grip {
            grip.parcel.place = if two == grip.parcel.place { before[0] } else { before[1] };
            grip.steps += 1;
        }
        let over = self.grip.as_ref().map(|grip| grip.parcel.place);
        for (robot, to) in self.robots.iter_mut().zip(to) {
            (robot.stands, robot.aligned) = (moved(robot.stands, to), over);
        }
        self.tell_arms();
        Which::ALL.into_iter().for_each(|which| self.done(which, tasks[which.index()].order));
    }

    /// Whether the current step of both robots brings the parcel to the container. The parcel moves to the place
    /// where the leading base stood.
    fn carries_into_container(&self) -> bool {
        let (Some(grip), Some(Work::Step { to, .. })) = (&self.grip, self.task(Which::Srm2).map(|task| task.work)) else {
            return false;
        };
        let leader = if to == grip.parcel.place { Which::Srm1 } else { Which::Srm2 };
        self.robots[leader.index()].stands.place == self.settings.container
    }

    fn hold(&mut self) {
        self.next_step += STEP;
        let now = self.now;
        let running =
            self.robots[0].task.as_ref().and_then(|task| Some((task.work, task.run.filter(|run| run.together)?.done(now))));
        let arrives = self.carries_into_container();
        let number = self.parcel_number();
        let [one, two] = [self.robots[0].controllers, self.robots[1].controllers];
        let at_work =
            Controllers { force: one.force && two.force, angle: one.angle && two.angle, distance: one.distance && two.distance };
        let pace = self.ground.hall().cell_m() / self.settings.loaded_step.as_secs_f64();
        let Some(grip) = &mut self.grip else { return };
        let rise = STEP.as_secs_f64() / self.settings.arm.as_secs_f64();
        // The values of `after_steps` for which a slip is due now. In the last step of the way, this includes all
        // larger values.
        let (mut speed, mut slipping) = (0.0, None);
        let stood = !grip.is_loaded();
        match running {
            Some((Work::Arm(ArmAction::Lift), done)) => {
                if stood {
                    self.ground.lift(grip.parcel.piece);
                }
                grip.height = (grip.height + rise).min(1.0);
                if done >= 0.5 {
                    slipping = Some(0..=0);
                }
            }
            Some((Work::Arm(ArmAction::Lower), _)) => grip.height = (grip.height - rise).max(TOUCHES),
            Some((Work::Step { .. }, done)) => {
                speed = pace;
                if done >= 0.5 {
                    slipping = Some(grip.steps.max(1)..=if arrives { u32::MAX } else { grip.steps });
                }
            }
            Some((Work::Back, _)) => speed = pace,
            Some((Work::Turn { .. } | Work::Arm(_), _)) | None => {}
        }
        let is_lost = grip.advance(at_work, speed, &mut self.noise);
        let leaves_floor = stood && grip.is_loaded();
        self.holding.add(grip);
        if leaves_floor {
            // The state must be stored now: after a halt or a kill, it must be known that the parcel is off the
            // floor.
            self.unkept = true;
            self.tell_arms();
        }
        let is_due = |after_steps| slipping.as_ref().is_some_and(|due| due.contains(&after_steps));
        let slips = self.slips.iter().position(|slip| slip.parcel == number && is_due(slip.after_steps));
        if let Some(index) = slips {
            self.slips.remove(index);
        }
        if is_lost || slips.is_some() {
            self.lose();
        }
    }

    /// Drops the parcel, and stops both robots. The parcel falls to the place that it had when the step began. The
    /// bases also count as standing at their old places.
    fn lose(&mut self) {
        let Some(Grip { parcel, .. }) = self.grip.take() else { return };
        self.unkept = true;
        self.ground.put(parcel);
        for robot in &mut self.robots {
            (robot.gripper, robot.aligned, robot.controllers) = (Gripper::Open, None, Controllers::default());
        }
        self.tell_arms();
        Which::ALL.into_iter().for_each(|which| self.say(which, RobotEvent::ParcelLost(parcel)));
        Which::ALL.into_iter().for_each(|which| self.halt(which));
    }

    /// Stops the work of a robot. If both robots do this work together, the other robot stops too. Each reports that
    /// it stopped. A look or a controller is not a motion, so it goes on.
    pub(super) fn halt(&mut self, which: Which) {
        let Some(task) = self.task(which) else { return };
        if !task.work.is_motion() {
            return;
        }
        let together = task.run.is_some_and(|run| run.together);
        self.unkept = true;
        // The arms are reported first, so that no report shows an arm as moving after the stop.
        self.tell_arms();
        self.halt_alone(which);
        if together {
            self.halt_alone(which.other());
        }
    }

    /// Ends an order whose deadline has passed, and reports it as failed.
    fn give_up(&mut self, which: Which) {
        let Some(task) = self.task(which) else { return };
        let words = if task.run.is_some() {
            "it did not finish in time and has halted by itself"
        } else {
            "the other robot did not do its part in time"
        };
        let together = task.run.is_some_and(|run| run.together);
        self.unkept = true;
        if let Some(order) = self.robots[which.index()].stop(self.now) {
            self.say(which, RobotEvent::Failed(order, words.to_owned()));
        }
        if together {
            self.halt_alone(which.other());
        }
    }

    fn halt_alone(&mut self, which: Which) {
        if let Some(order) = self.robots[which.index()].stop(self.now) {
            let off_centre = self.robots[which.index()].is_off_centre();
            self.say(which, RobotEvent::Halted(order, off_centre));
        }
    }

    fn done(&mut self, which: Which, order: OrderId) {
        self.say(which, RobotEvent::Done(order));
    }

    pub(super) fn say(&mut self, which: Which, event: RobotEvent) {
        self.events.push_back((which, event));
    }

    fn tell_arm(&mut self, which: Which) {
        self.say(which, RobotEvent::Arm(self.arm(which)));
    }

    pub(super) fn tell_arms(&mut self) {
        Which::ALL.into_iter().for_each(|which| self.tell_arm(which));
    }
}
