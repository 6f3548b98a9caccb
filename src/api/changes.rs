//! The events of a stream after the first one. Each event has only the resources that changed. The stream adds the
//! names and ids of the events, and the heartbeats.

use schemars::JsonSchema;
use serde::Serialize;

use super::alarm::AlarmJson;
use super::log::LogLineJson;
use super::luggage::LuggageJson;
use super::map::MapChange;
use super::mission::MissionJson;
use super::retrieval::RetrievalJson;
use super::robot::{NamedRobotJson, RobotJson};
use super::state;
use super::temperature::TemperatureJson;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Revision;
use hallsweep_core::world::resource::Resource;

/// Up to this number of pieces, every change of a piece sends all pieces. With more pieces, only the changed pieces
/// are sent, because all pieces would make up most of the traffic.
const WHOLE: usize = 256;

/// Resources that changed; unchanged resources are absent.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ChangesJson {
    pub revision: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mission: Option<MissionJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<RobotJson>,
    /// All robots, sent when a robot or its holds changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robots: Option<Vec<NamedRobotJson>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<MapChange>,
    /// All luggage. Sent in place of `pieces` if there are at most 256 pieces, after a reconnection, when the mission
    /// has changed, and when pieces were removed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luggage: Option<Vec<LuggageJson>>,
    /// New and changed pieces, sent in place of `luggage` if there are more than 256. Each replaces the piece with
    /// the same `id`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pieces: Option<Vec<LuggageJson>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature: Option<TemperatureJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alarms: Option<Vec<AlarmJson>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub retrieval: Option<RetrievalJson>,
    /// New log lines; after a reconnection, all stored log lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log: Option<Vec<LogLineJson>>,
}

impl ChangesJson {
    pub fn between(older: &Snapshot, snapshot: &Snapshot) -> ChangesJson {
        let read = older.log.last().map_or(0, |line| line.number);
        let map = MapChange::between(older, snapshot);
        let changes = ChangesJson::gathered(snapshot, older.revision, map, read);
        // Every change of the mission marks the list of robots as changed, because the list contains holds as well.
        // Most of these changes do not change the list, so the lists are compared.
        let is_same = changes.robot.is_none() && older.robots == snapshot.robots;
        let robots = changes.robots.filter(|_| !is_same);
        if snapshot.revision_of(Resource::Luggage) <= older.revision {
            return ChangesJson { robots, ..changes };
        }
        let (luggage, pieces) = luggage(older, snapshot);
        ChangesJson { robots, luggage, pieces, ..changes }
    }

    /// Returns what changed since a revision whose snapshot is not stored. If the log has grown, all stored lines are
    /// sent. The lines are numbered, so the reader can drop the lines that it already has.
    pub fn since(snapshot: &Snapshot, revision: Revision) -> ChangesJson {
        let changes = ChangesJson::gathered(snapshot, revision, MapChange::since(snapshot, revision), 0);
        let is_other = snapshot.revision_of(Resource::Luggage) > revision;
        ChangesJson { luggage: is_other.then(|| state::luggage(snapshot)), ..changes }
    }

    fn gathered(snapshot: &Snapshot, since: Revision, map: Option<MapChange>, read: u64) -> ChangesJson {
        let changed = |resource| snapshot.revision_of(resource) > since;
        ChangesJson {
            revision: snapshot.revision.0,
            mission: changed(Resource::Mission).then(|| state::mission(snapshot)),
            robot: changed(Resource::Robot).then(|| state::robot(snapshot)),
            robots: (changed(Resource::Robot) || changed(Resource::Mission)).then(|| state::robots(snapshot)),
            map,
            luggage: None,
            pieces: None,
            temperature: changed(Resource::Temperature).then(|| state::temperature(snapshot)),
            alarms: changed(Resource::Alarms).then(|| state::alarms(snapshot)),
            retrieval: changed(Resource::Retrieval).then(|| state::retrieval(snapshot)),
            log: changed(Resource::Log).then(|| state::log_after(snapshot, read)),
        }
    }
}

/// Returns either all of the luggage, or only the changed pieces. All of the luggage is sent if there are few pieces,
/// if the mission has changed, or if pieces were removed, because changed pieces do not tell which pieces are gone.
fn luggage(older: &Snapshot, snapshot: &Snapshot) -> (Option<Vec<LuggageJson>>, Option<Vec<LuggageJson>>) {
    if snapshot.luggage.len() <= WHOLE || snapshot.luggage.len() < older.luggage.len() || older.mission.id != snapshot.mission.id
    {
        return (Some(state::luggage(snapshot)), None);
    }
    let changed = snapshot.luggage.changed_since(&older.luggage);
    (None, Some(changed.map(|piece| LuggageJson::new(piece, snapshot.hall.as_ref())).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{idle, piece, searching, touch, write};
    use hallsweep_core::command::Verdict;
    use hallsweep_core::hold::Hold;
    use hallsweep_core::snapshot::log::Tone;
    use hallsweep_core::units::Cell;

    #[test]
    fn only_what_changed_is_sent() {
        let older = searching();
        let mut newer = older.clone();
        touch(&mut newer, 21, &[Resource::Temperature]);
        let json = serde_json::to_value(ChangesJson::between(&older, &newer)).unwrap();
        let mut fields: Vec<&String> = json.as_object().unwrap().keys().collect();
        fields.sort();
        assert_eq!(fields, ["revision", "temperature"]);
    }

    #[test]
    fn robots_are_sent_when_one_has_changed_or_what_holds_it() {
        let older = searching();
        let robots = |newer: &Snapshot| ChangesJson::between(&older, newer).robots;
        let mut newer = older.clone();
        touch(&mut newer, 21, &[Resource::Mission]);
        assert_eq!(robots(&newer), None);
        assert_eq!(
            ChangesJson::since(&newer, older.revision).robots,
            Some(state::robots(&newer)),
            "who knows what was held before"
        );
        let mut held = newer.robots[0].clone();
        held.holds.push(Hold::Operator);
        newer.robots = std::sync::Arc::from([held]);
        assert_eq!(robots(&newer), Some(state::robots(&newer)));
        let mut newer = older.clone();
        touch(&mut newer, 21, &[Resource::Robot]);
        assert_eq!(robots(&newer), Some(state::robots(&newer)), "their revision is another");
    }

    #[test]
    fn where_there_is_much_luggage_only_what_changed_of_it_is_sent() {
        let mut older = searching();
        for id in 4..=300 {
            older.luggage.insert(piece(id, Cell::new(3, 2), Some(Verdict::Safe)));
        }
        let mut newer = older.clone();
        newer.luggage.insert(piece(3, Cell::new(3, 2), Some(Verdict::Safe)));
        newer.luggage.insert(piece(301, Cell::new(4, 2), None));
        touch(&mut newer, 21, &[Resource::Luggage]);
        let changes = ChangesJson::between(&older, &newer);
        let ids = |pieces: Option<Vec<LuggageJson>>| pieces.map(|pieces| pieces.iter().map(|piece| piece.id).collect::<Vec<_>>());
        assert_eq!((ids(changes.luggage), ids(changes.pieces)), (None, Some(vec![3, 301])));
        let missed = ChangesJson::since(&newer, older.revision);
        assert_eq!((missed.luggage.map(|all| all.len()), missed.pieces), (Some(301), None), "who knows what was sent before");
        let mut emptied = idle();
        touch(&mut emptied, 22, &[Resource::Luggage]);
        assert_eq!(ChangesJson::between(&newer, &emptied).luggage, Some(Vec::new()));
    }

    #[test]
    fn only_new_log_lines_are_sent() {
        let older = searching();
        let mut newer = older.clone();
        write(&mut newer, Tone::Info, "one more");
        touch(&mut newer, 21, &[Resource::Log]);
        let lines = ChangesJson::between(&older, &newer).log.unwrap();
        assert_eq!(lines.iter().map(|line| line.number).collect::<Vec<_>>(), [4]);
        assert_eq!(ChangesJson::since(&newer, older.revision).log.unwrap().len(), 4);
    }

    #[test]
    fn a_reader_who_has_everything_lacks_nothing() {
        let snapshot = searching();
        let json = serde_json::to_value(ChangesJson::since(&snapshot, snapshot.revision)).unwrap();
        assert_eq!(json, serde_json::json!({"revision": 20}));
    }
}
