//! The whole state at one revision, as one JSON object. It is the content of `GET /api/v1/state` and of the first
//! event of a stream.

use schemars::JsonSchema;
use serde::Serialize;

use super::alarm::AlarmJson;
use super::log::LogLineJson;
use super::luggage::LuggageJson;
use super::map::MapJson;
use super::mission::MissionJson;
use super::retrieval::RetrievalJson;
use super::robot::{NamedRobotJson, RobotJson};
use super::temperature::TemperatureJson;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::resource::Resource;

/// The whole state at one revision.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StateJson {
    /// Identifier of this run of the program.
    pub run: String,
    /// Revision of the state, raised by every change in this run.
    pub revision: u64,
    pub mission: MissionJson,
    /// The robot that searches.
    pub robot: RobotJson,
    /// All robots, beginning with the robot that searches.
    pub robots: Vec<NamedRobotJson>,
    /// Known part of the hall.
    pub map: MapJson,
    /// Luggage of this mission, sorted by number.
    pub luggage: Vec<LuggageJson>,
    pub temperature: TemperatureJson,
    /// The alarms, oldest first.
    pub alarms: Vec<AlarmJson>,
    pub retrieval: RetrievalJson,
    /// The latest log lines, oldest first.
    pub log: Vec<LogLineJson>,
}

impl StateJson {
    pub fn new(snapshot: &Snapshot, luggage: Vec<LuggageJson>) -> StateJson {
        StateJson {
            run: snapshot.run.to_string(),
            revision: snapshot.revision.0,
            mission: mission(snapshot),
            robot: robot(snapshot),
            robots: robots(snapshot),
            map: MapJson::from(snapshot),
            luggage,
            temperature: temperature(snapshot),
            alarms: alarms(snapshot),
            retrieval: retrieval(snapshot),
            log: log_after(snapshot, 0),
        }
    }
}

impl From<&Snapshot> for StateJson {
    fn from(snapshot: &Snapshot) -> StateJson {
        StateJson::new(snapshot, luggage(snapshot))
    }
}

pub fn mission(snapshot: &Snapshot) -> MissionJson {
    MissionJson::new(&snapshot.mission, snapshot.revision_of(Resource::Mission))
}

pub fn robot(snapshot: &Snapshot) -> RobotJson {
    RobotJson::new(&snapshot.robot, snapshot.revision_of(Resource::Robot))
}

/// Returns all robots of a snapshot. The first one is the robot that searches.
pub fn robots(snapshot: &Snapshot) -> Vec<NamedRobotJson> {
    let revision = snapshot.revision_of(Resource::Robot);
    let named = |(place, shown)| NamedRobotJson::new(shown, place == 0, revision);
    snapshot.robots.iter().enumerate().map(named).collect()
}

pub fn temperature(snapshot: &Snapshot) -> TemperatureJson {
    TemperatureJson::new(&snapshot.temperature, snapshot.revision_of(Resource::Temperature))
}

pub fn luggage(snapshot: &Snapshot) -> Vec<LuggageJson> {
    snapshot.luggage.iter().map(|luggage| LuggageJson::new(luggage, snapshot.hall.as_ref())).collect()
}

pub fn alarms(snapshot: &Snapshot) -> Vec<AlarmJson> {
    snapshot.alarms.iter().map(AlarmJson::from).collect()
}

pub fn retrieval(snapshot: &Snapshot) -> RetrievalJson {
    RetrievalJson::new(snapshot.retrieval.as_deref(), snapshot.revision_of(Resource::Retrieval))
}

pub fn log_after(snapshot: &Snapshot, number: u64) -> Vec<LogLineJson> {
    snapshot.log.iter().filter(|line| line.number > number).map(|line| LogLineJson::from(&**line)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{idle, searching};
    use hallsweep_core::robot::RobotId;
    use hallsweep_core::snapshot::robot::RobotShown;

    #[test]
    fn the_state_has_the_shape_the_clients_know() {
        let json = serde_json::to_value(StateJson::from(&searching())).unwrap();
        assert_eq!(json["mission"]["phase"], "inspecting");
        assert_eq!(json["mission"]["goal"], serde_json::json!({"x": 4, "y": 4}));
        assert_eq!(
            json["mission"]["progress"],
            serde_json::json!({"visited": 15, "unknown": 4, "percent": null, "secondsLeft": null})
        );
        assert_eq!(json["mission"]["refusals"]["backHome"], "not possible while idle");
        assert_eq!(
            json["robot"],
            serde_json::json!({"revision": 20, "state": "stopped", "halting": false, "heading": "east", "position": {"x": 2, "y": 2},
                "offCentre": false, "outside": false, "sonar": 42, "led": "blinking", "unreachedSince": null})
        );
        assert_eq!(
            json["temperature"],
            serde_json::json!({"revision": 20, "celsius": 21.4, "readAt": "2026-02-03T10:00:00.000+01:00", "silentSince": null, "status": "ok", "threshold": 25.0, "cool": 24.0, "hot": []})
        );
        assert_eq!(
            json["luggage"][2],
            serde_json::json!({"id": 3, "verdict": "pending", "cell": {"x": 3, "y": 2}, "position": {"x": 2, "y": 2},
                "heading": "east", "taken": "2026-02-03T10:00:00.000+01:00", "decided": null,
                "secured": null,
                "photo": {"state": "taken", "url": "/api/v1/luggage/3/photo?take=1", "bytes": 4, "take": 1, "reason": null}})
        );
        assert_eq!(json["luggage"][0]["decided"]["by"], "operator");
        assert_eq!(
            json["alarms"][0],
            serde_json::json!({"id": 1, "recorded": true, "raised": "2026-02-03T10:00:00.000+01:00",
                "text": "luggage #2 is dangerous", "luggage": 2, "acknowledged": null})
        );
        assert_eq!(json["log"][0]["number"], 1);
    }

    #[test]
    fn every_robot_is_there_with_its_name_and_what_it_has() {
        let mut snapshot = idle();
        let porter = RobotShown { id: RobotId::new("porter").unwrap(), parts: None, ..snapshot.robots[0].clone() };
        snapshot.robots = snapshot.robots.iter().cloned().chain([porter]).collect();
        let json = serde_json::to_value(StateJson::from(&snapshot)).unwrap();
        let (discovery, porter) = (&json["robots"][0], &json["robots"][1]);
        assert_eq!((&discovery["name"], &discovery["searches"]), (&"discovery".into(), &true.into()));
        assert_eq!(
            discovery["parts"],
            serde_json::json!(["base", "camera", "sonar", "led", "thermometer", "bump", "acknowledgedMoves"])
        );
        assert_eq!(discovery["replaced"], serde_json::json!([]));
        assert_eq!(
            *porter,
            serde_json::json!({"name": "porter", "searches": false, "parts": null, "replaced": null, "unreached": null, "holds": [], "revision": 1, "state": "stopped",
                "halting": false, "heading": "south", "position": {"x": 0, "y": 0}, "offCentre": false, "outside": false, "sonar": null, "led": "off",
                "unreachedSince": null, "arm": null})
        );
        for (key, value) in json["robot"].as_object().unwrap() {
            assert_eq!(discovery.get(key), Some(value), "the one that searches says of itself the same twice: {key}");
        }
    }

    #[test]
    fn what_is_not_there_is_null_and_not_absent() {
        let json = serde_json::to_value(StateJson::from(&idle())).unwrap();
        for pointer in [
            "/mission/goal",
            "/mission/interrupted",
            "/mission/fault",
            "/mission/storeFailure",
            "/robot/sonar",
            "/temperature/celsius",
            "/temperature/readAt",
            "/temperature/silentSince",
        ] {
            assert_eq!(json.pointer(pointer), Some(&serde_json::Value::Null), "{pointer}");
        }
    }
}
