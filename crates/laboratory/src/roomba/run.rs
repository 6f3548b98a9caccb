//! A run of the Roomba: what it did tick by tick, and what that came to. Everything happens in simulated time.
//! How a run is drawn stands in `drawing`; how two are compared, in `compare`.

use super::driver::Driver;
use super::floor::{self, Floor};
use super::length::RunLength;
use super::machine::Machine;
use super::phase::Phase;
use super::room::{Body, TICKS_PER_SECOND};
use super::tree::Tree;
use hallsweep_sim::BodyPose;

/// Who drives the Roomba.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Controller {
    /// The finite state machine.
    Machine,
    /// The behaviour tree.
    Tree,
}

/// How the Roomba stood after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// How many ticks had passed.
    pub tick: u32,
    /// Where it stood, from the north-west corner of the room.
    pub pose: BodyPose,
    /// What it had done in that tick.
    pub phase: Phase,
    /// Whether a wall had cut the tick's move short.
    pub bumper: bool,
    /// How many squares of the floor it had passed over.
    pub passed: u32,
}

/// A phase that followed another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// How many ticks had passed when the new phase began.
    pub tick: u32,
    /// The phase that ended.
    pub from: Phase,
    /// The phase that began.
    pub to: Phase,
    /// By how much it turns, in radians in `-π..π`, when the new phase is a turn.
    pub angle: Option<f64>,
}

/// What a run came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// How long it lasted, in seconds.
    pub seconds: f64,
    /// How far the centre of the body went, in metres.
    pub path_m: f64,
    /// How often a wall ended a phase.
    pub bumps: u32,
    /// How many squares of 5 cm the body passed over, by their centres.
    pub passed: u32,
    /// How many of them a body can pass over at all: all but those in the corners.
    pub reachable: u32,
    /// How long it was in each phase, in seconds, in the order of `Phase::ALL`.
    pub in_phase_s: [f64; 4],
}

/// A run from its beginning, in the middle of the room, to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Who drove.
    pub controller: Controller,
    /// Where its angles came from.
    pub seed: u64,
    /// The start, and every tick.
    pub frames: Vec<Frame>,
    /// Every change of phase, in order.
    pub transitions: Vec<Transition>,
    /// What it came to.
    pub figures: Figures,
}

impl Controller {
    /// Both.
    pub const ALL: [Controller; 2] = [Controller::Machine, Controller::Tree];

    /// The word for it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Controller::Machine => "machine",
            Controller::Tree => "tree",
        }
    }
}

impl Frame {
    /// When it was, in seconds since the start.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        seconds(self.tick)
    }
}

impl Transition {
    /// When it was, in seconds since the start.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        seconds(self.tick)
    }
}

impl Figures {
    /// The share of the floor that it passed over, of what it can reach; in `0.0..=1.0`.
    #[must_use]
    pub fn share(&self) -> f64 {
        f64::from(self.passed) / f64::from(self.reachable)
    }
}

impl Run {
    /// Runs it, as long as was asked.
    #[must_use]
    pub fn new(controller: Controller, seed: u64, length: RunLength) -> Run {
        match controller {
            Controller::Machine => driven_by(Machine::new(seed), controller, seed, length, Body::START),
            Controller::Tree => driven_by(Tree::new(seed), controller, seed, length, Body::START),
        }
    }
}

/// A run that begins with the body as it is given.
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
        // A phase in its first tick has just begun, whatever the one before was; only the first of all follows none.
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

fn seconds(ticks: u32) -> f64 {
    f64::from(ticks) / f64::from(TICKS_PER_SECOND)
}
