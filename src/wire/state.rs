//! Everything at one revision in one JSON object: what `GET /api/v1/state` and the first event of a stream carry.

use serde::Serialize;

use super::alarm::AlarmJson;
use super::log::LogLineJson;
use super::luggage::LuggageJson;
use super::map::MapJson;
use super::mission::MissionJson;
use super::robot::RobotJson;
use super::temperature::TemperatureJson;
use crate::core::world::resource::Resource;
use crate::core::world::snapshot::Snapshot;

/// The whole state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateJson {
    /// Which run of the program this is.
    pub run: String,
    /// How often anything has changed in this run.
    pub revision: u64,
    /// The mission.
    pub mission: MissionJson,
    /// The robot.
    pub robot: RobotJson,
    /// The hall as far as it is known.
    pub map: MapJson,
    /// The luggage of this mission, by number.
    pub luggage: Vec<LuggageJson>,
    /// The temperature.
    pub temperature: TemperatureJson,
    /// The alarms, oldest first.
    pub alarms: Vec<AlarmJson>,
    /// The latest log lines, oldest first.
    pub log: Vec<LogLineJson>,
}

impl From<&Snapshot> for StateJson {
    fn from(snapshot: &Snapshot) -> StateJson {
        StateJson {
            run: snapshot.run.to_string(),
            revision: snapshot.revision.0,
            mission: mission(snapshot),
            robot: robot(snapshot),
            map: MapJson::from(snapshot),
            luggage: luggage(snapshot),
            temperature: temperature(snapshot),
            alarms: alarms(snapshot),
            log: log_after(snapshot, 0),
        }
    }
}

/// The mission of this snapshot.
#[must_use]
pub fn mission(snapshot: &Snapshot) -> MissionJson {
    MissionJson::new(&snapshot.mission, snapshot.revision_of(Resource::Mission))
}

/// The robot of this snapshot.
#[must_use]
pub fn robot(snapshot: &Snapshot) -> RobotJson {
    RobotJson::new(&snapshot.robot, snapshot.revision_of(Resource::Robot))
}

/// The temperature of this snapshot.
#[must_use]
pub fn temperature(snapshot: &Snapshot) -> TemperatureJson {
    TemperatureJson::new(&snapshot.temperature, snapshot.revision_of(Resource::Temperature))
}

/// The luggage of this snapshot, by number.
#[must_use]
pub fn luggage(snapshot: &Snapshot) -> Vec<LuggageJson> {
    snapshot.luggage.iter().map(|luggage| LuggageJson::from(&**luggage)).collect()
}

/// The alarms of this snapshot, oldest first.
#[must_use]
pub fn alarms(snapshot: &Snapshot) -> Vec<AlarmJson> {
    snapshot.alarms.iter().map(|alarm| AlarmJson::from(&**alarm)).collect()
}

/// The log lines at hand with a number above `number`, oldest first.
#[must_use]
pub fn log_after(snapshot: &Snapshot, number: u64) -> Vec<LogLineJson> {
    snapshot.log.iter().filter(|line| line.number > number).map(|line| LogLineJson::from(&**line)).collect()
}
