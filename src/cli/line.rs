//! A journal entry as a line of text: when, then what. The same run gives the same bytes.

use std::fmt::Display;

use crate::core::effect::{Entry, Fact};
use crate::core::world::luggage::PhotoState;
use crate::wire::time::rfc3339;

/// The time, then the fact in a few words; no line break.
pub(super) fn of(entry: &Entry) -> String {
    format!("{} {}", rfc3339(entry.wall), words(&entry.fact)).replace(['\n', '\r'], " ")
}

fn words(fact: &Fact) -> String {
    match fact {
        Fact::ProgramStarted(version) => format!("program started, version {version}"),
        Fact::Standing(standing) => {
            format!("all that stands: mission {}, {} cells visited", standing.mission, standing.map.visited())
        }
        Fact::Command { issuer, command, refused, .. } => {
            let became = refused.as_ref().map_or_else(|| "accepted".to_owned(), |refusal| format!("refused: {}", refusal.words));
            format!("command {command} by {issuer}: {became}")
        }
        Fact::MissionBegan(mission, strategy) => format!("mission {mission} began ({})", strategy.name()),
        Fact::MissionArchived(mission, left) => format!("mission {mission} archived, bombs left: {}", list(left)),
        Fact::Phase(phase) => match phase.interrupted() {
            Some(interrupted) => format!("phase {} (interrupting {})", phase.name().name(), interrupted.name().name()),
            None => format!("phase {}", phase.name().name()),
        },
        Fact::Holds(holds) => format!("holds {}", list(holds.iter().map(|hold| hold.name()))),
        Fact::Epoch(epoch) => format!("epoch {epoch}"),
        Fact::Goal(goal, _) => goal.map_or_else(|| "goal none".to_owned(), |goal| format!("goal {}", goal.cell())),
        Fact::Pose(pose) => format!("pose {} {}", pose.cell, pose.heading.name()),
        Fact::Led(blinking) => format!("led {}", if *blinking { "blinking" } else { "off" }),
        Fact::Obstacle(cell, kind) => format!("obstacle {cell} {kind}"),
        Fact::Mark(cell, mark) => format!("cell {cell} {}", mark.name()),
        Fact::Luggage { record, .. } => {
            let photo = match &record.photo {
                PhotoState::Taken { bytes, take } => format!("photo {take}, {bytes} bytes"),
                PhotoState::Failed(why) => format!("no photo: {why}"),
            };
            format!("luggage #{} {} from {} {}: {photo}", record.id, record.cell, record.pose.cell, record.pose.heading.name())
        }
        Fact::Verdict { luggage, verdict, who } => format!("verdict #{luggage} {} by {who}", verdict.name()),
        Fact::Temperature(source, celsius) => format!("temperature {celsius} by {source}"),
        Fact::AlarmRaised(alarm, _, text) => format!("alarm {alarm} raised: {text}"),
        Fact::AlarmAcknowledged(alarm, who) => format!("alarm {alarm} acknowledged by {who}"),
        Fact::Strategy(strategy) => format!("strategy {}", strategy.name()),
        Fact::MapEmptied(heading) => format!("map emptied, facing {}", heading.name()),
    }
}

fn list<T: Display>(things: impl IntoIterator<Item = T>) -> String {
    let words: Vec<String> = things.into_iter().map(|thing| thing.to_string()).collect();
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mission::Hold;
    use crate::core::units::{Cell, Pose, Wall};
    use crate::core::world::hall_map::Mark;

    fn check(fact: Fact, expect: &str) {
        assert_eq!(of(&Entry { wall: Wall::default(), fact }), format!("1970-01-01T00:00:00.000+00:00 {expect}"));
    }

    #[test]
    fn an_entry_is_one_line() {
        check(Fact::Holds(vec![Hold::Operator, Hold::AwaitingStart]), "holds operator, awaitingStart");
        check(Fact::Holds(Vec::new()), "holds none");
        check(Fact::Pose(Pose::START), "pose (0, 0) south");
        check(Fact::Mark(Cell::new(1, 2), Mark::Wall), "cell (1, 2) wall");
        check(Fact::AlarmRaised(Default::default(), None, "two\nlines".to_owned()), "alarm 0 raised: two lines");
    }
}
