//! A journal entry as a line of text: when, then what. The same run gives the same bytes.

use std::fmt::Display;

use crate::core::effect::{Entry, Fact};
use crate::wire::time::rfc3339;

/// The time, then the fact in a few words; no line break.
pub(super) fn line(entry: &Entry) -> String {
    format!("{} {}", rfc3339(entry.wall), words(&entry.fact)).replace(['\n', '\r'], " ")
}

fn words(fact: &Fact) -> String {
    match fact {
        Fact::Command { door, who, command, refused } => {
            format!("command {command} by {who} ({}): {}", door.name(), refused.unwrap_or("accepted"))
        }
        Fact::MissionBegan(mission, strategy) => format!("mission {mission} began ({})", strategy.name()),
        Fact::MissionArchived(mission, left) => format!("mission {mission} archived, bombs left: {}", list(left)),
        Fact::Phase(phase, None) => format!("phase {}", phase.name()),
        Fact::Phase(phase, Some(within)) => format!("phase {} (interrupting {})", phase.name(), within.name()),
        Fact::Holds(holds) => format!("holds {}", list(holds.iter().map(|hold| hold.name()))),
        Fact::Goal(goal) => goal.map_or_else(|| "goal none".to_owned(), |cell| format!("goal {cell}")),
        Fact::Pose(pose) => format!("pose {} {}", pose.cell, pose.heading.name()),
        Fact::Obstacle(cell, kind) => format!("obstacle {cell} {kind}"),
        Fact::Luggage { id, cell, pose, photo } => {
            let photo = photo.as_ref().map_or_else(|why| format!("no photo: {why}"), |photo| format!("{photo:?}"));
            format!("luggage #{id} {cell} from {} {}: {photo}", pose.cell, pose.heading.name())
        }
        Fact::Verdict { luggage, verdict, who } => format!("verdict #{luggage} {} by {who}", verdict.name()),
        Fact::Temperature(source, celsius) => format!("temperature {celsius} by {source}"),
        Fact::AlarmRaised(alarm, text) => format!("alarm {alarm} raised: {text}"),
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
    use crate::core::event::Photo;
    use crate::core::mission::Hold;
    use crate::core::units::{Cell, LuggageId, Pose, Wall};

    fn check(fact: Fact, expect: &str) {
        assert_eq!(line(&Entry { wall: Wall::default(), fact }), format!("1970-01-01T00:00:00.000+00:00 {expect}"));
    }

    #[test]
    fn an_entry_is_one_line() {
        check(Fact::Holds(vec![Hold::Operator, Hold::AwaitingStart]), "holds operator, awaitingStart");
        check(Fact::Holds(Vec::new()), "holds none");
        check(Fact::Pose(Pose::START), "pose (0, 0) south");
        let photo = Ok(Photo { bytes: [0; 12].into(), media_type: "image/png" });
        let fact = Fact::Luggage { id: LuggageId(3), cell: Cell::new(0, 1), pose: Pose::START, photo };
        check(fact, "luggage #3 (0, 1) from (0, 0) south: Photo(image/png, 12 bytes)");
        check(Fact::AlarmRaised(Default::default(), "two\nlines".to_owned()), "alarm 0 raised: two lines");
    }
}
