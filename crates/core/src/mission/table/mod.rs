//! The transition table: the rules for every input in every phase (mission §4). Rules are read from the top, and the
//! first rule that applies decides. The table is complete and has no wildcard. A new input compiles only after it is
//! in `everywhere` or in each phase. A new phase compiles only after it defines each input that is not in
//! `everywhere`. `docs/mission-table.md` prints the table, and a test compares the two.

mod alarm;
mod everywhere;
mod search;
mod shared;

pub(super) use self::everywhere::{InputRow, row};
use super::Input;
use super::rule::Rule;
use crate::phase::PhaseName;

/// Returns the rules for `input` in `phase`. There is at least one rule, and the last rule always applies.
pub(crate) const fn rules(phase: PhaseName, input: Input) -> &'static [Rule] {
    let input = match row(input) {
        InputRow::Everywhere(rules) => return rules,
        InputRow::Halting { elsewhere, driving } => return if matches!(phase, PhaseName::Driving) { driving } else { elsewhere },
        InputRow::ByPhase(input) => input,
    };
    match phase {
        PhaseName::Idle => search::idle(input),
        PhaseName::Exploring => search::exploring(input),
        PhaseName::Inspecting => search::inspecting(input),
        PhaseName::Driving => search::driving(input),
        PhaseName::ReturningHome => search::returning_home(input),
        PhaseName::AtHome => search::at_home(input),
        PhaseName::ReturningWithAlarm => alarm::returning_with_alarm(input),
        PhaseName::BombLocated => alarm::bomb_located(input),
        PhaseName::Retrieving => alarm::retrieving(input),
        PhaseName::BagSecured => alarm::bag_secured(input),
        PhaseName::Explored => search::explored(input),
        PhaseName::Fault => alarm::fault(input),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{Again, Command, Door, Issuer, Move};
    use crate::mission::{Act, InputContext};
    use crate::units::Cell;
    use crate::world::hall_map::Bounds;

    #[test]
    fn every_cell_ends_with_a_rule_that_always_applies() {
        for phase in PhaseName::ALL {
            for input in Input::COMMANDS.into_iter().chain(Input::EVENTS) {
                let last = rules(phase, input).last().expect("a cell is never empty");
                assert!(matches!(last, Rule::Go(..) | Rule::Never(_) | Rule::AsInterrupted), "{phase:?} × {input:?}");
            }
        }
    }

    #[test]
    fn events_are_never_refused() {
        for phase in PhaseName::ALL {
            for input in Input::EVENTS {
                let refuses = |rule: &Rule| matches!(rule, Rule::RefuseIf(_) | Rule::RefuseIfThen(..) | Rule::Never(_));
                assert!(!rules(phase, input).iter().any(refuses), "{phase:?} × {input:?}");
            }
        }
    }

    #[test]
    fn stop_is_accepted_in_every_phase() {
        for phase in PhaseName::ALL {
            assert!(matches!(rules(phase, Input::Stop), [Rule::Go(..)]), "{phase:?}");
        }
    }

    /// Safety S1: a repeated STOP may be ignored only if no command has released the robot in between.
    #[test]
    fn what_lets_a_halted_robot_go_is_a_command_that_is_known_to() {
        let commands = [
            Command::Start,
            Command::BackHome,
            Command::GoOn,
            Command::SearchAgain(Again::Within(Bounds::of(Cell::HOME))),
            Command::Retrieve(None),
            Command::Reset,
            Command::Move(Move::Forward),
            Command::Goto(Cell::HOME),
        ];
        assert!(commands.iter().all(Command::releases));
        let known = commands.map(|command| InputContext::of(&command, &Issuer::operator(Door::LOCAL), None).0);
        let releases = |rule: &Rule| match rule {
            Rule::RefuseIfThen(_, acts) | Rule::When(_, _, acts) | Rule::Go(_, acts) => acts.contains(&Act::Release),
            Rule::RefuseIf(_) | Rule::Never(_) | Rule::AsInterrupted => false,
        };
        for phase in PhaseName::ALL {
            for input in Input::COMMANDS.into_iter().chain(Input::EVENTS) {
                assert!(known.contains(&input) || !rules(phase, input).iter().any(releases), "{phase:?} × {input:?}");
            }
        }
    }
}
