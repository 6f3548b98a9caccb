//! The Roomba's behaviour tree, `config/behaviours/roomba.xml`, and its four leaves. Their order is in the file,
//! while `phase` describes each leaf.

use std::time::Duration;

use super::driver::Driver;
use super::phase::{Motion, Phase, TURNS};
use super::room::{TICKS_PER_SECOND, Velocity};
use behaviour_trees::{Blackboard, Catalogue, Leaf, LeafKind, Leaves, Status, xml};
use hallsweep_core::rng::RandomStream;

/// The tree, in the file format of the usual graphical editor.
const FILE: &str = include_str!("../../../../config/behaviours/roomba.xml");

/// Maximum number of ticks of the tree in one tick of the body. A tree that has ended is ticked once more, so that it
/// begins again immediately. One repetition is enough, because the leaf that runs after it lasts for more than a
/// tick.
const ROUNDS: u32 = 2;

/// Behaviour tree of the original specification (seed 001).
#[derive(Debug)]
pub(super) struct Tree {
    tree: behaviour_trees::Tree,
    blackboard: Blackboard,
    leaves: Wheels,
}

/// Runs the leaves of the tree, and stores the speeds that they request.
#[derive(Debug)]
struct Wheels {
    motion: Motion,
    turns: RandomStream,
    bumper: bool,
    velocity: Velocity,
}

const STILL: Velocity = Velocity { linear: 0.0, angular: 0.0 };

impl Tree {
    pub(super) fn new(seed: u64) -> Tree {
        let mut blackboard = Blackboard::new();
        let catalogue = Catalogue::new(Phase::ALL.map(|phase| LeafKind::action(phase.name(), Vec::new())).into());
        let document = xml::read(FILE).expect("the file is a part of the program, and the tests read it");
        let tree = behaviour_trees::Tree::build(&document, None, &catalogue, &mut blackboard)
            .expect("the file is a part of the program, and the tests build it");
        let mut turns = RandomStream::new(seed, TURNS);
        let motion = Motion::begin(Phase::MoveForward, &mut turns);
        Tree { tree, blackboard, leaves: Wheels { motion, turns, bumper: false, velocity: STILL } }
    }
}

impl Driver for Tree {
    fn tick(&mut self, bumper: bool) -> Velocity {
        self.leaves.bumper = bumper;
        self.leaves.velocity = STILL;
        let mut passed = Duration::from_secs(1) / TICKS_PER_SECOND;
        for _ in 0..ROUNDS {
            match self.tree.tick(&mut self.blackboard, &mut self.leaves, passed) {
                Ok(Status::Success | Status::Failure) => passed = Duration::ZERO,
                // After a fault, tree and body stand still. A fault cannot happen here, because the leaves have no
                // ports.
                Ok(Status::Running | Status::Skipped | Status::Idle) | Err(_) => break,
            }
        }
        self.leaves.velocity
    }

    fn motion(&self) -> Motion {
        self.leaves.motion
    }
}

impl Leaves for Wheels {
    fn tick(&mut self, leaf: &mut Leaf<'_>) -> Status {
        // The catalogue contains exactly the phases, in the same order.
        let Some(phase) = Phase::ALL.get(leaf.kind()).copied() else { return Status::Failure };
        if leaf.is_starting() {
            self.motion = Motion::begin(phase, &mut self.turns);
        }
        // The bumper is checked first, as in the state machine. So a wall that is met in the last tick still counts.
        if self.motion.meets_wall(self.bumper) {
            return Status::Failure;
        }
        if self.motion.is_over() {
            return Status::Success;
        }
        self.velocity = self.motion.tick();
        Status::Running
    }

    fn halt(&mut self, _leaf: &mut Leaf<'_>) {
        self.velocity = STILL;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names of the running nodes after each tick. `ticks` says for each tick whether the bumper is pressed.
    fn told(ticks: &[bool]) -> Vec<String> {
        let mut tree = Tree::new(1);
        let mut told = Vec::new();
        for bumper in ticks {
            let _ = tree.tick(*bumper);
            let running = tree.tree.nodes().filter(|node| node.after == Status::Running).map(|node| node.name.to_owned());
            told.push(running.collect::<Vec<_>>().join(" "));
        }
        told
    }

    #[test]
    fn its_leaves_run_one_at_a_time_under_their_sequence() {
        assert_eq!(told(&[false])[0], "Selector Sweep MoveForward");
        assert_eq!(told(&[false; 181])[180], "Selector Sweep MoveInSpiral");
        assert_eq!(told(&[false, true])[1], "Selector TurnAway GoBack");
        let mut ticks = vec![false, true];
        ticks.extend([false; 30]);
        assert_eq!(told(&ticks)[31], "Selector TurnAway Rotate");
    }

    #[test]
    fn when_it_has_ended_it_begins_again_within_the_same_tick() {
        let mut tree = Tree::new(1);
        for _ in 0..1380 {
            let velocity = tree.tick(false);
            assert_ne!(velocity, STILL);
        }
        assert_eq!(tree.motion().phase, Phase::MoveInSpiral);
        assert_eq!(tree.tick(false), Velocity { linear: 0.5, angular: 0.0 });
        assert_eq!((tree.motion().phase, tree.motion().ticks), (Phase::MoveForward, 1));
    }

    #[test]
    fn a_halted_leaf_stops_the_body() {
        let mut tree = Tree::new(1);
        assert_ne!(tree.tick(false), STILL);
        tree.tree.halt(&mut tree.blackboard, &mut tree.leaves);
        assert_eq!(tree.leaves.velocity, STILL);
    }
}
