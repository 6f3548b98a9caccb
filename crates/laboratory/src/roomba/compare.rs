//! Checks whether two runs are the same (docs/laboratory.md): the same transitions in the same order, with durations
//! that differ by at most one tick. Positions are not compared, because they follow from the phases and the walls.

use std::fmt;

use super::run::{Controller, Run, Transition};

#[derive(Clone, Debug, PartialEq)]
pub struct Parting {
    /// Number of equal transitions before the first difference.
    pub common: usize,
    /// Each controller with its transition at the first difference. `None` if its run has no more transitions.
    pub next: [(Controller, Option<Transition>); 2],
}

/// The first difference between the transitions of two runs. `None` if the transitions are equal.
#[must_use]
pub(super) fn parting(one: &Run, other: &Run) -> Option<Parting> {
    let most = one.transitions.len().max(other.transitions.len());
    (0..most).find(|index| !is_same(one, other, *index)).map(|common| {
        let next = |run: &Run| (run.controller, run.transitions.get(common).copied());
        Parting { common, next: [next(one), next(other)] }
    })
}

fn is_same(one: &Run, other: &Run, index: usize) -> bool {
    match (one.transitions.get(index), other.transitions.get(index)) {
        (Some(a), Some(b)) => {
            let kind = |change: &Transition| (change.from, change.to, change.angle.map(f64::to_bits));
            kind(a) == kind(b) && lasted(one, index).abs_diff(lasted(other, index)) <= 1
        }
        // The other run may have ended just before this transition, because it may be late by one tick per phase.
        (Some(last), None) => is_about_to_end(one, last, index),
        (None, Some(last)) => is_about_to_end(other, last, index),
        (None, None) => true,
    }
}

/// Duration of the phase that ended with this transition, in ticks.
fn lasted(run: &Run, index: usize) -> u32 {
    let began = index.checked_sub(1).and_then(|before| run.transitions.get(before)).map_or(0, |change| change.tick);
    run.transitions.get(index).map_or(0, |change| change.tick.saturating_sub(began))
}

fn is_about_to_end(run: &Run, last: &Transition, index: usize) -> bool {
    let end = run.frames.last().map_or(0, |frame| frame.tick) as usize;
    last.tick as usize + index + 1 >= end
}

impl fmt::Display for Parting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said = |change: &Option<Transition>| match change {
            Some(change) => {
                let angle = change.angle.map_or_else(String::new, |angle| format!(" with a turn of {angle:.3} rad"));
                format!("goes from {} to {} at {:.2} s{angle}", change.from.name(), change.to.name(), change.seconds())
            }
            None => "has no further transition".to_owned(),
        };
        let [(one, first), (other, second)] = &self.next;
        let (one, other, first, second) = (one.name(), other.name(), said(first), said(second));
        write!(f, "{one} and {other} differ after {} transitions: the {one} {first}, the {other} {second}", self.common)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Phase, RunLength};
    use super::*;

    fn run() -> Run {
        Run::new(Controller::Machine, 1, RunLength::from_seconds(60.0).unwrap())
    }

    /// Compares a run with a changed copy of it.
    fn with(change: impl FnOnce(&mut Run)) -> Option<Parting> {
        let mut other = Run { controller: Controller::Tree, ..run() };
        change(&mut other);
        parting(&run(), &other)
    }

    #[test]
    fn equal_runs_do_not_part() {
        assert!(run().transitions.len() > 5);
        assert_eq!(with(|_| ()), None);
    }

    #[test]
    fn a_phase_may_be_a_tick_longer_and_no_more() {
        let later = |by: u32| move |run: &mut Run| run.transitions[2..].iter_mut().for_each(|change| change.tick += by);
        assert_eq!(with(later(1)), None);
        assert_eq!(with(later(2)).unwrap().common, 2);
    }

    #[test]
    fn another_angle_and_another_phase_part_them() {
        let turn = run().transitions.iter().position(|change| change.angle.is_some()).unwrap();
        assert_eq!(with(|run| run.transitions[turn].angle = Some(0.25)).unwrap().common, turn);
        assert_eq!(with(|run| run.transitions[3].to = Phase::Rotate).map(|parting| parting.common), Some(3));
    }

    #[test]
    fn a_transition_that_only_one_run_made_parts_them_unless_time_was_up() {
        assert_eq!(with(|run| run.transitions.truncate(4)).unwrap().common, 4);
        let at_the_end = |run: &mut Run| {
            let last = Transition { tick: 3599, from: Phase::MoveInSpiral, to: Phase::MoveForward, angle: None };
            run.transitions.push(last);
        };
        assert_eq!(with(at_the_end), None);
    }

    #[test]
    fn a_parting_says_where_and_what_each_does() {
        let said = with(|run| run.transitions.truncate(0)).unwrap().to_string();
        assert_eq!(
            said,
            "machine and tree differ after 0 transitions: the machine goes from MoveForward to MoveInSpiral at 3.00 s, \
             the tree has no further transition"
        );
    }
}
