//! The Roomba's state machine: four states and their transitions. The states themselves are described in `phase`.
//!
//! ```text
//!               ┌───────── 20 s ─────────┐
//!               ▼                        │
//!   ┌───► MoveForward ───── 3 s ──► MoveInSpiral
//!   │           └──────┐ bumper ┌────────┘
//!   │ turned           ▼        ▼
//! Rotate ◄── 0.5 s ─── GoBack
//! ```

use super::driver::Driver;
use super::phase::{Motion, Phase, TURNS};
use super::room::Velocity;
use hallsweep_core::rng::RandomStream;

/// State machine of the original specification (seed 001).
#[derive(Clone, Debug)]
pub(super) struct Machine {
    motion: Motion,
    turns: RandomStream,
}

impl Machine {
    pub(super) fn new(seed: u64) -> Machine {
        let mut turns = RandomStream::new(seed, TURNS);
        Machine { motion: Motion::begin(Phase::MoveForward, &mut turns), turns }
    }

    /// Checks the bumper before the time, so that a wall met in the last tick of a phase still counts.
    fn next(&self, bumper: bool) -> Option<Phase> {
        if self.motion.meets_wall(bumper) {
            return Some(Phase::GoBack);
        }
        self.motion.is_over().then_some(match self.motion.phase {
            Phase::MoveForward => Phase::MoveInSpiral,
            Phase::MoveInSpiral | Phase::Rotate => Phase::MoveForward,
            Phase::GoBack => Phase::Rotate,
        })
    }
}

impl Driver for Machine {
    fn tick(&mut self, bumper: bool) -> Velocity {
        if let Some(next) = self.next(bumper) {
            self.motion = Motion::begin(next, &mut self.turns);
        }
        self.motion.tick()
    }

    fn motion(&self) -> Motion {
        self.motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The states of the first `ticks` ticks, each with its duration. `bumper` says for each tick whether the bumper
    /// is pressed.
    fn states(ticks: u32, bumper: impl Fn(u32) -> bool) -> Vec<(Phase, u32)> {
        let mut machine = Machine::new(1);
        let mut seen: Vec<(Phase, u32)> = Vec::new();
        for tick in 0..ticks {
            let _ = machine.tick(bumper(tick));
            match seen.last_mut() {
                Some((phase, had)) if *phase == machine.motion().phase => *had += 1,
                Some(_) | None => seen.push((machine.motion().phase, 1)),
            }
        }
        seen
    }

    #[test]
    fn without_walls_it_goes_forward_and_in_spirals_by_turns() {
        let (forward, spiral) = ((Phase::MoveForward, 180), (Phase::MoveInSpiral, 1200));
        assert_eq!(states(2760, |_| false), [forward, spiral, forward, spiral]);
    }

    #[test]
    fn a_wall_sends_it_back_from_forward_and_from_a_spiral() {
        let seen = states(60, |tick| tick == 20);
        assert_eq!(seen[..2], [(Phase::MoveForward, 20), (Phase::GoBack, 30)]);
        assert_eq!(seen[2].0, Phase::Rotate);
        let seen = states(260, |tick| tick == 200);
        assert_eq!(seen[..3], [(Phase::MoveForward, 180), (Phase::MoveInSpiral, 20), (Phase::GoBack, 30)]);
    }

    #[test]
    fn a_wall_met_at_the_very_end_of_a_phase_counts_before_the_time() {
        assert_eq!(states(181, |tick| tick == 180)[1].0, Phase::GoBack);
        assert_eq!(states(1381, |tick| tick == 1380)[2].0, Phase::GoBack);
    }

    #[test]
    fn going_back_and_turning_heed_no_wall() {
        let angle = Motion::begin(Phase::Rotate, &mut RandomStream::new(1, TURNS)).angle.unwrap();
        let seen = states(1000, |tick| (20..50).contains(&tick));
        assert_eq!(seen[1], (Phase::GoBack, 30));
        assert!((f64::from(seen[2].1) - angle.abs() * 120.0).abs() <= 1.0, "{seen:?} for {angle}");
        assert_eq!(seen[3].0, Phase::MoveForward);
    }
}
