//! Stored missions in JSON: the list of missions, one mission with luggage and map, and the entries of a mission. The
//! door limits the length of a list, and says where the next part begins.

use schemars::JsonSchema;
use serde::Serialize;

use super::address::address;
use super::exercise::ExerciseJson;
use super::journal::{self, ConditionsShape};
use super::luggage::LuggageJson;
use super::map::{MapJson, Plan};
use super::mission::ClosedJson;
use super::robot::PositionJson;
use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::engine::Past;
use hallsweep_core::hall::HallId;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::Entry;
use hallsweep_core::units::{MissionId, Seq, WallTime};

/// Summary of a mission.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MissionRecordJson {
    /// Number of the mission.
    pub id: u64,
    /// Search strategy.
    pub strategy: String,
    /// Time at which the mission began, RFC 3339 with zone.
    pub began: String,
    /// Time at which the mission ended by RESET or the next START; null for the present mission.
    pub archived: Option<String>,
    /// Last phase of the mission.
    pub phase: String,
    /// Number of pieces of luggage found.
    pub pieces: u64,
    /// Number of dangerous pieces.
    pub dangerous: u64,
    /// Numbers of the dangerous pieces that were still in place when the mission ended.
    pub left: Vec<u64>,
    /// Whether the mission is an exercise; absent otherwise.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub exercise: bool,
    /// Addresses of further data of the mission.
    pub links: Links,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Links {
    /// Address of the mission with its luggage and its map.
    #[serde(rename = "self")]
    pub itself: String,
    /// Address of all events of the mission.
    pub events: String,
    /// Address of the map alone.
    pub map: String,
    /// Address of the mission's page for people.
    pub page: String,
}

/// Missions, the newest first.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MissionListJson {
    pub missions: Vec<MissionRecordJson>,
    /// Address of the rest of the list; null at the end.
    pub next: Option<String>,
}

/// A mission with its luggage, map and conditions, at its end or at present.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MissionWholeJson {
    #[serde(flatten)]
    pub record: MissionRecordJson,
    /// Hall and temperature threshold at the mission's end or at present; null if they are not recorded.
    pub conditions: Option<ConditionsShape>,
    /// Results of the exercise; absent if the mission is no exercise.
    #[serde(rename = "exerciseResults", skip_serializing_if = "Option::is_none")]
    pub results: Option<ExerciseJson>,
    /// Luggage of the mission, sorted by number.
    pub luggage: Vec<LuggageJson>,
    /// Known part of the hall; null if the map is not stored.
    pub map: Option<MapJson>,
    /// One sentence for each part of the record that cannot be understood. The effects of such parts are missing
    /// here.
    pub damage: Vec<String>,
}

impl Links {
    pub fn of(mission: MissionId, hall: Option<&HallId>) -> Links {
        let itself = address(hall, &format!("/api/v1/missions/{mission}"));
        Links {
            events: format!("{itself}/events"),
            map: format!("{itself}/map"),
            page: address(hall, &format!("/missions/{mission}")),
            itself,
        }
    }
}

impl MissionWholeJson {
    pub fn new(
        record: MissionRecordJson,
        state: Option<&PersistentState>,
        damage: Vec<String>,
        hall: Option<&HallId>,
    ) -> MissionWholeJson {
        let luggage = state.into_iter().flat_map(|state| state.luggage.iter());
        let luggage = luggage.map(|luggage| LuggageJson::new(luggage, hall)).collect();
        let map = state.map(|state| MapJson::from(Plan::from(state)));
        let results = state.and_then(ExerciseJson::of);
        MissionWholeJson { record, conditions: state.and_then(conditions), results, luggage, map, damage }
    }
}

fn conditions(state: &PersistentState) -> Option<ConditionsShape> {
    state.conditions.as_ref().map(ConditionsShape::from)
}

/// State of a mission after one of its entries.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct MomentJson {
    /// Number of the mission.
    pub mission: u64,
    /// Number of the entry.
    pub seq: u64,
    /// Time at which the entry was written, RFC 3339 with zone.
    pub time: String,
    /// Phase of the mission.
    #[schemars(with = "vocabulary::Phase")]
    pub phase: &'static str,
    /// Reasons why the robot had to stand still.
    #[schemars(with = "Vec<vocabulary::Hold>")]
    pub holds: Vec<&'static str>,
    /// Cell to which the robot was driving, or null.
    pub goal: Option<PositionJson>,
    /// Cell and heading of the robot that searches, after its last completed step or turn.
    pub robot: StandsJson,
    /// Last reading in °C; null if no recent reading is recorded.
    pub celsius: Option<f64>,
    /// Time of the reading; null if the time is not known.
    pub read_at: Option<String>,
    /// Time since which the source of the reading was silent; null if the temperature was known.
    pub silent_since: Option<String>,
    /// Hall and temperature threshold; null if they are not recorded.
    pub conditions: Option<ConditionsShape>,
    /// Statement with which the mission was closed; absent if it is not closed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed: Option<ClosedJson>,
    /// Luggage found up to this entry, sorted by number.
    pub luggage: Vec<LuggageJson>,
    /// Known part of the hall.
    pub map: MapJson,
    /// One sentence for each part of the record that cannot be understood.
    pub damage: Vec<String>,
    /// Addresses of the later events and of the page that shows this moment.
    pub links: MomentLinks,
}

/// Cell and heading of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StandsJson {
    pub position: PositionJson,
    /// Direction in which the robot faces: `north`, `east`, `south` or `west`.
    #[schemars(with = "vocabulary::Heading")]
    pub heading: &'static str,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct MomentLinks {
    pub events: String,
    pub page: String,
}

impl MomentJson {
    /// The state of the mission after the entry `past.seq`. `wall` is the time of this entry.
    pub fn new(mission: MissionId, past: &Past, wall: WallTime, damage: Vec<String>, hall: Option<&HallId>) -> MomentJson {
        let Links { events, page, .. } = Links::of(mission, hall);
        let (seq, state, reading) = (past.seq, &past.state, past.reading());
        MomentJson {
            mission: mission.0,
            seq: seq.0,
            time: rfc3339(wall),
            phase: state.phase.name().name(),
            holds: state.holds.to_vec().iter().map(|hold| hold.name()).collect(),
            goal: state.goal.map(|goal| goal.cell().into()),
            robot: StandsJson { position: state.pose.cell.into(), heading: state.pose.heading.name() },
            celsius: reading.map(|reading| reading.celsius.degrees()),
            read_at: reading.and_then(|reading| reading.read).map(rfc3339),
            silent_since: reading.and_then(|reading| reading.silent_since).map(rfc3339),
            conditions: conditions(state),
            closed: state.closed.as_deref().map(ClosedJson::from),
            luggage: state.luggage.iter().map(|luggage| LuggageJson::new(luggage, hall)).collect(),
            map: MapJson::from(Plan::from(state)),
            damage,
            links: MomentLinks { events: format!("{events}?after={seq}"), page: format!("{page}/moment?at={seq}") },
        }
    }
}

/// Events of a mission.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "it is there for its schema")]
pub struct EventListJson {
    /// Events, oldest first.
    events: Vec<journal::ListedLine>,
    /// Address of the rest of the list; null at the end.
    next: Option<String>,
}

/// Writes the entries of a mission as one JSON object, `{"events":[…],"next":…}`. Each entry has the form of an
/// exported line. If an entry cannot be read, its line has the reason instead.
pub fn events(mission: MissionId, entries: Vec<(Seq, Result<Entry, String>)>, next: Option<String>) -> String {
    let line = |(seq, entry): (Seq, Result<Entry, String>)| match entry {
        Ok(entry) => journal::line(&journal::Line { seq, mission: Some(mission), entry, picture: None }),
        Err(why) => journal::unreadable(seq, &why),
    };
    let lines: Vec<String> = entries.into_iter().map(line).collect();
    format!("{{\"events\":[{}],\"next\":{}}}", lines.join(","), serde_json::Value::from(next))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{TEN, drawn, piece};
    use hallsweep_core::command::Strategy;
    use hallsweep_core::state::fact::Fact;
    use hallsweep_core::units::{Cell, Pose};

    fn record() -> MissionRecordJson {
        MissionRecordJson {
            id: 3,
            strategy: "snail".to_owned(),
            began: String::new(),
            archived: None,
            phase: "explored".to_owned(),
            pieces: 1,
            dangerous: 0,
            left: Vec::new(),
            exercise: false,
            links: Links::of(MissionId(3), None),
        }
    }

    #[test]
    fn a_mission_comes_with_its_luggage_its_map_and_where_there_is_more() {
        let mut state = PersistentState::first(Strategy::Snail);
        state.map = drawn(&["11W"], 1);
        let piece = piece(7, Cell::new(2, 0), None);
        state.luggage.insert(piece);
        let json = serde_json::to_value(MissionWholeJson::new(record(), Some(&state), Vec::new(), None)).unwrap();
        assert_eq!((&json["id"], &json["luggage"][0]["id"]), (&3.into(), &7.into()));
        assert_eq!(json["luggage"][0]["photo"]["url"], "/api/v1/luggage/7/photo?take=1");
        assert_eq!(
            json["map"],
            serde_json::json!({"origin": {"x": 0, "y": 0}, "width": 3, "height": 1, "rows": ["r1X"]}),
            "revisions are of one run, so a record has none"
        );
        assert_eq!(json["links"]["self"], "/api/v1/missions/3");
    }

    #[test]
    fn what_is_not_kept_is_null() {
        let json = serde_json::to_value(MissionWholeJson::new(record(), None, vec!["entry 3".to_owned()], None)).unwrap();
        assert_eq!((&json["map"], &json["luggage"]), (&serde_json::Value::Null, &serde_json::json!([])));
        assert_eq!(json["damage"], serde_json::json!(["entry 3"]));
    }

    #[test]
    fn events_are_lines_of_the_journal_in_one_object() {
        let entries = vec![
            (Seq(4), Ok(Entry { wall: TEN, fact: Fact::Pose(Pose::START) })),
            (Seq(7), Err("a \"mouse\" was at it".to_owned())),
            (Seq(9), Ok(Entry { wall: TEN, fact: Fact::Led(true) })),
        ];
        let text = events(MissionId(3), entries, Some("/more?after=9".to_owned()));
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!((&json["events"][0]["seq"], &json["events"][2]["kind"]), (&4.into(), &"led".into()));
        let unreadable = serde_json::json!({"seq": 7, "kind": "unreadable", "why": "a \"mouse\" was at it"});
        assert_eq!(json["events"][1], unreadable);
        assert_eq!((&json["events"][0]["mission"], &json["next"]), (&3.into(), &"/more?after=9".into()));
        let end: serde_json::Value = serde_json::from_str(&events(MissionId(3), Vec::new(), None)).unwrap();
        assert_eq!(end, serde_json::json!({"events": [], "next": null}));
    }
}
