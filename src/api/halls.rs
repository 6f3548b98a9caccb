//! The list of halls in JSON: for each hall its addresses, and what may need a person there.

use schemars::JsonSchema;
use serde::Serialize;

use super::address::address;
use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::hall::HallId;
use hallsweep_core::snapshot::Snapshot;

/// The halls that the key of the request sees, sorted by name.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct HallListJson {
    pub halls: Vec<HallJson>,
}

/// A hall, and what may need a person there.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
#[schemars(rename = "HallSummary")]
pub struct HallJson {
    /// Name of the hall in addresses, settings and keys.
    pub name: String,
    /// Whether this is the default hall, to which all addresses lead that name no hall.
    pub default: bool,
    /// Name of the hall on its pages: that of the hall file, or the address of the robot.
    pub title: String,
    /// Revision of the hall's state.
    pub revision: u64,
    /// Phase of the mission.
    #[schemars(with = "vocabulary::Phase")]
    pub phase: &'static str,
    /// Reasons why the robot must not move.
    #[schemars(with = "Vec<vocabulary::Hold>")]
    pub holds: Vec<&'static str>,
    /// Number of pieces of luggage that wait for a verdict.
    pub waiting: usize,
    /// Time since which the first of them waits; null if none waits.
    pub waiting_since: Option<String>,
    /// Number of alarms that nobody has acknowledged.
    pub alarms: usize,
    /// Effect of the temperature: `ok`, `tooHigh` or `stale`.
    #[schemars(with = "vocabulary::TemperatureStatus")]
    pub temperature: &'static str,
    /// Whether the mission is an exercise; absent otherwise.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub exercise: bool,
    pub links: HallLinks,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct HallLinks {
    /// Address of the whole state.
    pub state: String,
    /// Address of the hall's page for people.
    pub page: String,
}

impl HallJson {
    pub fn new(name: &HallId, title: &str, snapshot: &Snapshot) -> HallJson {
        let (hall, mission) = (snapshot.hall.as_ref(), &snapshot.mission);
        HallJson {
            name: name.to_string(),
            default: hall.is_none(),
            title: title.to_owned(),
            revision: snapshot.revision.0,
            phase: mission.phase.name(),
            holds: mission.holds.iter().map(|hold| hold.name()).collect(),
            waiting: snapshot.luggage.pending().count(),
            waiting_since: snapshot.luggage.pending().map(|piece| piece.taken).min().map(rfc3339),
            alarms: snapshot.alarms.iter().filter(|alarm| alarm.acknowledged.is_none()).count(),
            temperature: snapshot.temperature.status.name(),
            exercise: mission.is_exercise,
            links: HallLinks { state: address(hall, "/api/v1/state"), page: address(hall, "/") },
        }
    }
}
