//! The costs of moves. With these costs, a search compares steps, turns and bumps.

use std::fmt;
use std::time::Duration;

/// The cost of each kind of move, in quarters of a step. These are small whole numbers, so that a search can sort by
/// them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Costs {
    pub turn: u32,
    /// A step that meets an obstacle, including the way back.
    pub bump: u32,
}

/// The cost of one step forward, in quarters of a step. The tables of the score use the cost of a way in this unit,
/// so another unit would change the score.
pub const STEP: u32 = 4;

/// Maximum cost of a turn or a bump. It limits the memory of a search.
const MOST: u32 = 100;

impl Costs {
    /// Returns the costs for a robot with these times for a step and a quarter turn, rounded to quarters of a step. A
    /// bump takes about as long as a step.
    #[must_use]
    pub fn of(step: Duration, turn: Duration) -> Costs {
        let steps = turn.as_secs_f64() / step.as_secs_f64().max(1e-3);
        Costs { turn: units(steps), bump: STEP }
    }

    /// Returns the costs with these weights, rounded to quarters of a step. `None` if a step weighs nothing, or if a
    /// turn or a bump weighs more than 25 steps.
    #[must_use]
    pub fn weighed(step: f64, turn: f64, bump: f64) -> Option<Costs> {
        let in_steps = [turn / step, bump / step];
        let are_sound =
            step > 0.0 && step.is_finite() && in_steps.iter().all(|steps| (0.0..=f64::from(MOST / STEP)).contains(steps));
        are_sound.then(|| Costs { turn: units(in_steps[0]), bump: units(in_steps[1]) })
    }

    /// Parses `STEP,TURN,BUMP`, such as `1,1.5,1`. Returns `None` unless the text has three valid weights.
    #[must_use]
    pub fn read(written: &str) -> Option<Costs> {
        let numbers: Option<Vec<f64>> = written.split(',').map(|number| number.trim().parse().ok()).collect();
        let [step, turn, bump] = numbers?.try_into().ok()?;
        Costs::weighed(step, turn, bump)
    }

    pub const EVEN: Costs = Costs { turn: STEP, bump: STEP };
}

/// Converts quarters of a step (the unit of `Costs`) to thousandths of a step (the unit of the score).
pub(crate) fn in_thousandths(cost: u32) -> i32 {
    i32::try_from(u64::from(cost) * 1000 / u64::from(STEP)).unwrap_or(i32::MAX)
}

/// Returns the highest cost that does not exceed this many thousandths of a step.
pub(crate) fn affordable(thousandths: i32) -> u32 {
    let thousandths = u64::try_from(thousandths).unwrap_or(0);
    u32::try_from(thousandths * u64::from(STEP) / 1000).unwrap_or(u32::MAX)
}

/// Writes the form that `read` accepts: `STEP,TURN,BUMP`, in steps.
impl fmt::Display for Costs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let steps = |cost: u32| f64::from(cost) / f64::from(STEP);
        write!(f, "1,{},{}", steps(self.turn), steps(self.bump))
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is clamped to small positive numbers")]
fn units(steps: f64) -> u32 {
    (steps * f64::from(STEP)).round().clamp(0.0, f64::from(MOST)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_weighed_to_a_quarter_of_a_step() {
        assert_eq!(Costs::of(Duration::from_millis(330), Duration::from_millis(500)), Costs { turn: 6, bump: 4 });
        assert_eq!(Costs::read("1,1.5,2"), Some(Costs { turn: 6, bump: 8 }));
        assert_eq!(Costs::read("2, 0, 0"), Some(Costs { turn: 0, bump: 0 }));
        for written in ["1,1.5,2", "1,0,0", "1,1,1"] {
            assert_eq!(Costs::read(written).map(|costs| costs.to_string()).as_deref(), Some(written));
        }
        for unusable in ["", "1", "1,1", "1,1,1,1", "0,1,1", "-1,1,1", "1,26,1", "1,-1,1", "1,NaN,1", "inf,1,1", "a,b,c"] {
            assert_eq!(Costs::read(unusable), None, "{unusable}");
        }
    }
}
