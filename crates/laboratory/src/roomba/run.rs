//! A run of the Roomba in simulated time: its frames, its transitions and its figures. `drawing` draws a run.
//! `compare` compares two runs.

use super::driver::Driver;
use super::floor::{self, Floor};
use super::length::RunLength;
use super::machine::Machine;
use super::phase::Phase;
use super::room::{Body, seconds};
use super::tree::Tree;
use hallsweep_sim::BodyPose;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Controller {
    Machine,
    Tree,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Number of ticks since the start.
    pub tick: u32,
    /// Pose of the body, measured from the north-west corner of the room.
    pub pose: BodyPose,
    pub phase: Phase,
    /// Whether a wall cut the move of this tick short.
    pub bumper: bool,
    /// Number of floor squares that the body has passed over so far.
    pub passed: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// Number of ticks from the start until the new phase began.
    pub tick: u32,
    pub from: Phase,
    pub to: Phase,
    /// Angle of the turn, in radians in `-π..π`, if the new phase is a turn.
    pub angle: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    pub seconds: f64,
    /// Length of the path of the body's centre, in metres.
    pub path_m: f64,
    /// Number of phases that a wall ended.
    pub bumps: u32,
    /// Number of squares of 5 cm of which the body passed over the centre.
    pub passed: u32,
    /// Number of squares that a body can pass over. Only squares in the corners are out of reach.
    pub reachable: u32,
    /// Duration of each phase in seconds, in the order of `Phase::ALL`.
    pub in_phase_s: [f64; 4],
}

#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    pub controller: Controller,
    /// Seed of the random angles.
    pub seed: u64,
    /// One frame for the start and one for each tick.
    pub frames: Vec<Frame>,
    pub transitions: Vec<Transition>,
    pub figures: Figures,
}

impl Controller {
    pub const ALL: [Controller; 2] = [Controller::Machine, Controller::Tree];

    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Controller::Machine => "machine",
            Controller::Tree => "tree",
        }
    }
}

impl Frame {
    #[must_use]
    pub fn seconds(&self) -> f64 {
        seconds(self.tick)
    }
}

impl Transition {
    #[must_use]
    pub fn seconds(&self) -> f64 {
        seconds(self.tick)
    }
}

impl Figures {
    /// Share of the reachable floor that was passed over, in `0.0..=1.0`.
    #[must_use]
    pub fn share(&self) -> f64 {
        f64::from(self.passed) / f64::from(self.reachable)
    }
}

impl Run {
    #[must_use]
    pub fn new(controller: Controller, seed: u64, length: RunLength) -> Run {
        match controller {
            Controller::Machine => driven_by(Machine::new(seed), controller, seed, length, Body::START),
            Controller::Tree => driven_by(Tree::new(seed), controller, seed, length, Body::START),
        }
    }
}

pub(super) fn driven_by(mut driver: impl Driver, controller: Controller, seed: u64, length: RunLength, start: Body) -> Run {
    let mut body = start;
    let mut floor = Floor::new();
    let mut path_m = 0.0;
    let mut in_phase = [0; 4];
    let mut frames = Vec::with_capacity(length.ticks() as usize + 1);
    let mut transitions = Vec::new();
    floor.pass(body.pose.x_m, body.pose.y_m);
    let frame = |tick, body: Body, phase, floor: &Floor| {
        let Body { pose, bumper } = body;
        Frame { tick, pose, phase, bumper, passed: floor.passed() }
    };
    frames.push(frame(0, body, driver.motion().phase, &floor));
    for tick in 0..length.ticks() {
        let before = driver.motion().phase;
        let next = body.driven(driver.tick(body.bumper));
        let motion = driver.motion();
        // A phase in its first tick has just begun. The first phase of the run is not a transition, because no phase
        // was before it.
        if motion.ticks == 1 && tick > 0 {
            transitions.push(Transition { tick, from: before, to: motion.phase, angle: motion.angle });
        }
        path_m += (next.pose.x_m - body.pose.x_m).hypot(next.pose.y_m - body.pose.y_m);
        body = next;
        floor.pass(body.pose.x_m, body.pose.y_m);
        in_phase[motion.phase as usize] += 1;
        frames.push(frame(tick + 1, body, motion.phase, &floor));
    }
    let bumps = transitions.iter().filter(|change| change.to == Phase::GoBack).fold(0, |count, _| count + 1);
    let figures = Figures {
        seconds: seconds(length.ticks()),
        path_m,
        bumps,
        passed: floor.passed(),
        reachable: floor::reachable(),
        in_phase_s: in_phase.map(seconds),
    };
    Run { controller, seed, frames, transitions, figures }
}
