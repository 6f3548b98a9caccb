//! What a stream sends after its first event: the resources that changed, and nothing else.
//! Event names, ids and heartbeats are the stream's business.

use serde::Serialize;

use super::alarm::AlarmJson;
use super::log::LogLineJson;
use super::luggage::LuggageJson;
use super::map::MapChange;
use super::mission::MissionJson;
use super::robot::RobotJson;
use super::state;
use super::temperature::TemperatureJson;
use crate::core::units::Revision;
use crate::core::world::resource::Resource;
use crate::core::world::snapshot::Snapshot;

/// The resources that changed; what did not is absent.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the fields are documented at `StateJson`")]
pub struct ChangesJson {
    pub revision: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mission: Option<MissionJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<RobotJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<MapChange>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luggage: Option<Vec<LuggageJson>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature: Option<TemperatureJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alarms: Option<Vec<AlarmJson>>,
    /// Only the lines the reader has not got.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log: Option<Vec<LogLineJson>>,
}

impl ChangesJson {
    /// What a reader of `older` lacks.
    #[must_use]
    pub fn between(older: &Snapshot, snapshot: &Snapshot) -> ChangesJson {
        let read = older.log.last().map_or(0, |line| line.number);
        let map = MapChange::between(older, snapshot);
        ChangesJson::gathered(snapshot, older.revision, map, read)
    }

    /// What a reader lacks of whom only the revision is known. Log lines carry their numbers, so all at hand are sent when
    /// the log has grown, and the reader drops those it has.
    #[must_use]
    pub fn since(snapshot: &Snapshot, revision: Revision) -> ChangesJson {
        ChangesJson::gathered(snapshot, revision, MapChange::since(snapshot, revision), 0)
    }

    fn gathered(snapshot: &Snapshot, since: Revision, map: Option<MapChange>, read: u64) -> ChangesJson {
        let changed = |resource| snapshot.revision_of(resource) > since;
        ChangesJson {
            revision: snapshot.revision.0,
            mission: changed(Resource::Mission).then(|| state::mission(snapshot)),
            robot: changed(Resource::Robot).then(|| state::robot(snapshot)),
            map,
            luggage: changed(Resource::Luggage).then(|| state::luggage(snapshot)),
            temperature: changed(Resource::Temperature).then(|| state::temperature(snapshot)),
            alarms: changed(Resource::Alarms).then(|| state::alarms(snapshot)),
            log: changed(Resource::Log).then(|| state::log_after(snapshot, read)),
        }
    }
}
