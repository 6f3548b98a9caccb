//! Words for refusals. The core does not distinguish the simulator's refusals, but here each has a phrase of its own.

use crate::phrases::Language;
use hallsweep_core::hold::Hold;
use hallsweep_core::refused::Refused;

/// Codes of the simulator's refusals. The core has these refusals only in words; the pages have a phrase for each
/// code.
const OF_THE_SIMULATOR: [&str; 9] = [
    "notPaused",
    "nothingUnderWay",
    "notBlocked",
    "unusableHall",
    "notAName",
    "nameTaken",
    "tooManyKept",
    "noDataFolder",
    "notSimulated",
];

impl Language {
    /// The reason of a refusal, without a full stop. If a door refused in its own words, these stay as they are.
    pub fn refused(self, refused: &Refused) -> String {
        let say = || self.say_of("refused", refused.code());
        let said = match refused {
            Refused::Held(holds, store_failure) => say().with("holds", self.holds(holds, store_failure.as_deref())),
            Refused::Outdated { sent, now } => say().with("sent", sent).with("now", now),
            Refused::NotInPhase(phase) => say().with("phase", self.phase(*phase)),
            Refused::IntoObstacle(cell) => say().with("cell", cell),
            Refused::VerdictPending(id)
            | Refused::BombUnfetched(id)
            | Refused::UnknownLuggage(id)
            | Refused::NotABomb(id)
            | Refused::NoPhoto(id)
            | Refused::HotUnanswered(id)
            | Refused::NotInspected(id) => say().with("id", id),
            Refused::Decided { luggage, verdict } => say().with("id", luggage).with("verdict", self.verdict(verdict.name())),
            Refused::UnknownAlarm(id) => say().with("id", id),
            Refused::FetcherUnreached(robot) | Refused::FetcherAbroad(robot) => say().with("robot", robot),
            Refused::FaultStands(fault) => say().with("fault", self.fault(fault)),
            Refused::OpenPoints { mission, open } => {
                say().with("open", self.open_points(**open).join(", ")).with("code", format!("{:?}", open.code(*mission)))
            }
            Refused::OtherMission(mission) => say().with("mission", mission),
            Refused::AreaTooLarge(most) => say().with("most", most),
            Refused::UnknownArea(area) | Refused::AreaClosed(area) => say().with("area", format!("{area:?}")),
            Refused::OtherContent(id) => say().with("id", id.text()),
            Refused::UnknownSensor(sensor) => say().with("sensor", format!("{sensor:?}")),
            Refused::NotAllowed(words) => say().with("detail", words),
            Refused::InWords(refusal) if OF_THE_SIMULATOR.contains(&refusal.code) => {
                self.say_of("problem", refusal.code).with("detail", &refusal.words)
            }
            Refused::InWords(refusal) => return refusal.words.clone(),
            Refused::SentBefore
            | Refused::Driving
            | Refused::NotStopped
            | Refused::NotCapable
            | Refused::Moving
            | Refused::Unrecorded
            | Refused::NothingPending
            | Refused::PhotoUnderWay
            | Refused::NoRetrievalRobot
            | Refused::ExerciseOver
            | Refused::NothingSearched
            | Refused::StoreDown
            | Refused::NotKept
            | Refused::NotOnRecord => say(),
        };
        said.to_string()
    }

    /// Joins the words for the holds. The reason why the store cannot write comes first, because it may be the cause
    /// of other holds.
    fn holds(self, holds: &[Hold], store_failure: Option<&str>) -> String {
        let store = store_failure.map(|why| self.say("refused-held-store").with("why", why).to_string());
        let others =
            holds.iter().filter(|hold| store.is_none() || **hold != Hold::Store).map(|hold| self.hold(*hold).to_string());
        store.iter().cloned().chain(others).collect::<Vec<_>>().join("; ")
    }
}
