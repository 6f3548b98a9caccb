//! The lines of the log as values, so that each language can make its own sentences. `Display` gives the English
//! sentence for programs. `log` decides when a line is shown and how many lines there are.

use std::fmt;
use std::sync::Arc;

use crate::asked::Asked;
use crate::command::Issuer;
use crate::hold::{Hold, HoldReason};
use crate::phase::{FaultCause, PhaseName};
use crate::refused::Refused;
use crate::robot::RobotId;
use crate::snapshot::fact_words;
use crate::state::fact::Fact;
use crate::units::{Cell, LuggageId, Pose};
use crate::world::alarm::AlarmCause;
use behaviour_trees::state::StateError;

/// A line of the log. `Display` gives its English sentence.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// Somebody sent a command, or did something to the simulator.
    Asked {
        asked: Asked,
        /// The piece that the request means, if its text does not name the piece.
        meant: Option<LuggageId>,
        issuer: Issuer,
        refused: Option<Refused>,
    },
    /// A verdict of safe was accepted, but a danger arrived before the safe was recorded. The safe is therefore
    /// refused after all, with this refusal.
    Overtaken(Refused),
    Held(Hold, Option<HoldReason>),
    Over(Hold),
    /// The phase changed from the first to the second.
    Phase(PhaseName, PhaseName),
    Fault(FaultCause),
    Alarm(AlarmCause),
    /// A piece was found and recorded.
    Found {
        luggage: LuggageId,
        cell: Cell,
        has_photo: bool,
    },
    PhotographedAgain(LuggageId),
    /// A new photo failed, so the earlier photo of this piece stays.
    PhotoStays(LuggageId),
    /// No place is left from which the robot could take another photo of this piece.
    NoOtherView(LuggageId),
    Secured(LuggageId),
    NoWay(Cell),
    HomeThroughRings,
    /// The robot reports a place that differs from the recorded one. `None` means the robot that searches.
    Stands(Option<RobotId>, Pose),
    Robot(RobotId, Trouble),
    TreesBeginAnew(StateError),
    StartedAgain,
    /// The program was ended by the signal with this name.
    Ended(String),
    PutDown,
    /// A fact from the journal, from before a restart or from another time. `Said::fact` makes such a line.
    Fact(Arc<Fact>),
    /// Any other text, such as a message about a damaged file.
    Words(String),
}

/// A problem of a robot or of its link. Texts come from the robot or from the link.
#[derive(Clone, Debug, PartialEq)]
pub enum Trouble {
    /// The robot reports that it stands in this cell, which is too far away for any hall.
    TooFar(Cell),
    /// The robot's last reading was too hot, and the robot has no thermometer any more.
    NoThermometer,
    /// The link to the robot is still lost, but now for this reason. The hold was raised before.
    StillUnreached(String),
    Unreached(String),
    /// The robot met something as it left this cell.
    MetObstacle(Cell),
    Failed(String),
    NoPhoto(String),
    Unanswered,
}

impl fmt::Display for Said {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Said::Asked { asked, meant, issuer, refused } => {
                write!(f, "{asked}")?;
                meant.map_or(Ok(()), |id| write!(f, " #{id}"))?;
                match refused {
                    None => write!(f, ", by {issuer}"),
                    Some(refused) => write!(f, " refused, by {issuer}: {refused}"),
                }
            }
            Said::Overtaken(refused) => write!(f, "a safe was overtaken, and so refused: {refused}"),
            Said::Held(hold, None) => write!(f, "held: {}", hold.in_words()),
            Said::Held(hold, Some(why)) => write!(f, "held: {} ({why})", hold.in_words()),
            Said::Over(hold) => f.write_str(hold.over_in_words()),
            Said::Phase(before, after) => write!(f, "{} → {}", before.in_words(), after.in_words()),
            Said::Fault(cause) => write!(f, "fault: {cause}"),
            Said::Alarm(cause) => write!(f, "{cause}"),
            Said::Found { luggage, cell, has_photo } => {
                let but = if *has_photo { "" } else { ", but its photo failed: take it again, or answer danger" };
                write!(f, "luggage #{luggage} found at {cell}{but}")
            }
            Said::PhotographedAgain(luggage) => write!(f, "luggage #{luggage} photographed again"),
            Said::PhotoStays(luggage) => {
                write!(f, "photo of luggage #{luggage} could not be taken again; the first one stays")
            }
            Said::NoOtherView(luggage) => {
                write!(f, "no further place for a photo of luggage #{luggage} can be reached")
            }
            Said::Secured(luggage) => write!(f, "luggage #{luggage} is in the container"),
            Said::NoWay(cell) => write!(f, "no way leads to {cell}"),
            Said::HomeThroughRings => {
                f.write_str("every known way home leads through a keep-out ring: the robot keeps as far from the bomb as it can")
            }
            Said::Stands(robot, Pose { cell, heading }) => {
                let robot = robot.as_ref().map_or("the robot", RobotId::name);
                write!(f, "{robot} says that it stands at {cell}, facing {}", heading.name())
            }
            Said::Robot(robot, trouble) => trouble.tell(robot, f),
            Said::TreesBeginAnew(why) => write!(f, "the pair's trees begin anew: {why}"),
            Said::StartedAgain => f.write_str("the program was started again; everything is as it was"),
            Said::Ended(by) => write!(f, "the program was ended by {by}: the robot halts"),
            Said::PutDown => f.write_str("the robot was put down in another hall"),
            Said::Fact(fact) => f.write_str(&fact_words::words(fact)),
            Said::Words(words) => f.write_str(words),
        }
    }
}

impl Said {
    /// Makes a line about a fact. Lines stay in memory for a long time, so large parts that are not shown (a photo,
    /// the whole state) are left out.
    #[must_use]
    pub fn fact(fact: &Fact) -> Said {
        if let Fact::Luggage { record, .. } = fact {
            return Said::Fact(Arc::new(Fact::Luggage { record: Arc::clone(record), photo: None }));
        }
        let is_large = matches!(fact, Fact::State(_) | Fact::Retrieval(_) | Fact::Goal(..));
        if is_large { Said::Words(fact_words::words(fact)) } else { Said::Fact(Arc::new(fact.clone())) }
    }
}

impl Trouble {
    fn tell(&self, robot: &RobotId, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Trouble::TooFar(cell) => {
                write!(f, "{robot} says that it stands at {cell}, further from home than any hall reaches")
            }
            Trouble::NoThermometer => {
                write!(f, "{robot} has no thermometer now, and the last reading was too hot: report what the hall's is")
            }
            Trouble::StillUnreached(why) => write!(f, "{robot}: {why}"),
            Trouble::Unreached(why) => write!(f, "{robot} cannot be reached ({why}): mend the link"),
            Trouble::MetObstacle(cell) => write!(f, "{robot} met an obstacle at {cell}"),
            Trouble::Failed(why) => write!(f, "{robot} could not carry out its order ({why})"),
            Trouble::NoPhoto(why) => write!(f, "{robot} took no photo ({why})"),
            Trouble::Unanswered => write!(f, "{robot} did not finish its order in time: look after it"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{Command, Door, LuggageRef, Note, Strategy, Verdict};
    use crate::event::Photo;
    use crate::state::PersistentState;
    use crate::units::Celsius;
    use crate::units::WallTime;
    use crate::world::luggage::{Luggage, PhotoState};

    fn check(said: Said, expect: &str) {
        assert_eq!(said.to_string(), expect);
    }

    fn srm1() -> RobotId {
        RobotId::new("srm1").unwrap()
    }

    #[test]
    fn who_asked_for_something_is_told_and_which_piece_was_meant() {
        let issuer = Issuer { door: Door("http"), who: "anna".into(), from: "192.0.2.7".into() };
        let asked =
            |command, meant, refused| Said::Asked { asked: Asked::Command(command), meant, issuer: issuer.clone(), refused };
        check(asked(Command::Start, None, None), "START, by anna (http, 192.0.2.7)");
        let refused = "START refused, by anna (http, 192.0.2.7): the robot is moving: press STOP first";
        check(asked(Command::Start, None, Some(Refused::Moving)), refused);
        let safe = Command::Verdict {
            luggage: LuggageRef::Pending,
            verdict: Verdict::Safe,
            note: Note::new("red"),
            hot: Default::default(),
        };
        check(asked(safe, Some(LuggageId(3)), None), "safe (note: red) #3, by anna (http, 192.0.2.7)");
    }

    #[test]
    fn a_hold_says_why_where_there_is_more_to_say() {
        check(Said::Held(Hold::Operator, None), "held: stopped by the operator");
        let held = |why| Said::Held(Hold::TemperatureStale, Some(why)).to_string();
        let words = "held: the temperature sensor is silent: mend it first";
        assert_eq!(held(HoldReason::Silent("roof".into())), format!("{words} (roof)"));
        assert_eq!(held(HoldReason::Unheard("roof".into())), format!("{words} (roof has not been heard yet)"));
        assert_eq!(held(HoldReason::Reading(Celsius::new(31.0).unwrap())), format!("{words} (31.0 °C)"));
        assert_eq!(held(HoldReason::Words("why".to_owned())), format!("{words} (why)"));
    }

    #[test]
    fn what_happens_is_a_sentence() {
        let id = LuggageId(3);
        let cell = Cell::new(1, 2);
        let found = |has_photo| Said::Found { luggage: id, cell, has_photo };
        check(found(true), "luggage #3 found at (1, 2)");
        check(found(false), "luggage #3 found at (1, 2), but its photo failed: take it again, or answer danger");
        check(Said::PhotographedAgain(id), "luggage #3 photographed again");
        check(Said::PhotoStays(id), "photo of luggage #3 could not be taken again; the first one stays");
        check(Said::Phase(PhaseName::Idle, PhaseName::Exploring), "idle → exploring");
        check(Said::Fault(FaultCause::NoWayHome), "fault: no known way leads home: clear the way, or fetch the robot");
        check(Said::Stands(None, Pose::START), "the robot says that it stands at (0, 0), facing south");
        check(Said::Stands(Some(srm1()), Pose::START), "srm1 says that it stands at (0, 0), facing south");
        check(Said::NoWay(cell), "no way leads to (1, 2)");
        check(Said::Ended("SIGTERM".to_owned()), "the program was ended by SIGTERM: the robot halts");
        let begin = "the pair's trees begin anew: this is the state of another tree, or of this one before it was changed";
        check(Said::TreesBeginAnew(StateError::OtherTree), begin);
        let overtaken = Refused::Decided { luggage: id, verdict: Verdict::Danger };
        let words = "a safe was overtaken, and so refused: luggage #3 was already found danger: a verdict is final";
        check(Said::Overtaken(overtaken), words);
    }

    #[test]
    fn what_is_the_matter_with_a_robot_is_said_by_its_name() {
        let check = |trouble, expect| check(Said::Robot(srm1(), trouble), expect);
        let why = || "it is off".to_owned();
        let far = "srm1 says that it stands at (999, 0), further from home than any hall reaches";
        check(Trouble::TooFar(Cell::new(999, 0)), far);
        let heat = "srm1 has no thermometer now, and the last reading was too hot: report what the hall's is";
        check(Trouble::NoThermometer, heat);
        check(Trouble::StillUnreached(why()), "srm1: it is off");
        check(Trouble::Unreached(why()), "srm1 cannot be reached (it is off): mend the link");
        check(Trouble::MetObstacle(Cell::new(1, 2)), "srm1 met an obstacle at (1, 2)");
        check(Trouble::Failed(why()), "srm1 could not carry out its order (it is off)");
        check(Trouble::NoPhoto(why()), "srm1 took no photo (it is off)");
        check(Trouble::Unanswered, "srm1 did not finish its order in time: look after it");
    }

    /// There are many lines, and they stay in memory.
    #[test]
    fn a_line_of_the_journal_keeps_no_map_and_no_photo() {
        let state = Fact::State(Box::new(PersistentState::first(Strategy::Snail)));
        assert_eq!(Said::fact(&state), Said::Words(fact_words::words(&state)));
        let photo = PhotoState::Taken { bytes: 4, take: 1 };
        let (cell, pose, taken) = (Cell::HOME, Pose::START, WallTime::default());
        let record = Luggage {
            id: LuggageId(3),
            cell,
            pose,
            taken,
            first_taken: taken,
            photo,
            verdict: None,
            seen_from: Vec::new(),
            unsure: Vec::new(),
            judged: Vec::new(),
            truth: None,
            piece: None,
            secured: None,
            clock_set_ms: 0,
        };
        let fact = Fact::Luggage { record: Arc::new(record), photo: Some(Photo { bytes: [1].into(), media_type: "image/png" }) };
        let said = Said::fact(&fact);
        assert_eq!(said.to_string(), fact_words::words(&fact));
        assert!(matches!(said, Said::Fact(fact) if matches!(&*fact, Fact::Luggage { photo: None, .. })));
        let told = Fact::Holds(vec![Hold::Operator]);
        assert_eq!(Said::fact(&told), Said::Fact(Arc::new(told)));
    }
}
