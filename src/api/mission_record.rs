//! Stored missions in JSON: the list of missions, one mission with luggage and map, and the entries of a mission. The door
//! bounds the length of a list and says where the next part begins.

use schemars::JsonSchema;
use serde::Serialize;

use super::journal::{self, ConditionsShape};
use super::luggage::LuggageJson;
use super::map::{MapJson, Plan};
use super::robot::PositionJson;
use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::effect::Entry;
use hallsweep_core::engine::Past;
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::{MissionId, Seq, WallTime};

/// A mission in one line.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MissionRecordJson {
    /// Its number.
    pub id: u64,
    /// The order of its search.
    pub strategy: String,
    /// When it began, RFC 3339 with zone.
    pub began: String,
    /// When it was put away, or null while it is the present one.
    pub archived: Option<String>,
    /// The last phase it came to, by its name in the protocol.
    pub phase: String,
    /// How many pieces of luggage were found.
    pub pieces: u64,
    pub dangerous: u64,
    /// The numbers of the dangerous pieces that were left in place when it was put away.
    pub left: Vec<u64>,
    /// Where there is more of it.
    pub links: Links,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Links {
    /// The mission with its luggage and its map.
    #[serde(rename = "self")]
    pub itself: String,
    /// Everything that happened in it.
    pub events: String,
    /// Its map alone.
    pub map: String,
    /// Its page for people.
    pub page: String,
}

/// Missions, the newest first.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MissionListJson {
    pub missions: Vec<MissionRecordJson>,
    /// Where the list goes on, or null at its end.
    pub next: Option<String>,
}

/// A mission with everything that stood when it was put away, or that stands now.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MissionWholeJson {
    #[serde(flatten)]
    pub record: MissionRecordJson,
    /// In which hall it was at its end, and what counted as too hot then; null where no record says so.
    pub conditions: Option<ConditionsShape>,
    /// Its luggage, by number.
    pub luggage: Vec<LuggageJson>,
    /// Its hall as far as it was known, or null when that is not kept.
    pub map: Option<MapJson>,
    /// What of the record cannot be understood, a sentence each: what follows from it is not in here.
    pub damage: Vec<String>,
}

impl Links {
    pub fn of(mission: MissionId) -> Links {
        let itself = format!("/api/v1/missions/{mission}");
        Links { events: format!("{itself}/events"), map: format!("{itself}/map"), page: format!("/missions/{mission}"), itself }
    }
}

impl MissionWholeJson {
    pub fn new(record: MissionRecordJson, state: Option<&PersistentState>, damage: Vec<String>) -> MissionWholeJson {
        let luggage = state.into_iter().flat_map(|state| state.luggage.iter());
        let luggage = luggage.map(|luggage| LuggageJson::from(&**luggage)).collect();
        let map = state.map(|state| MapJson::from(Plan::from(state)));
        MissionWholeJson { record, conditions: state.and_then(conditions), luggage, map, damage }
    }
}

fn conditions(state: &PersistentState) -> Option<ConditionsShape> {
    state.conditions.as_ref().map(ConditionsShape::from)
}

/// How a mission stood after one of its entries.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct MomentJson {
    /// The mission.
    pub mission: u64,
    /// The entry, and when it was written, RFC 3339 with zone.
    pub seq: u64,
    pub time: String,
    /// Where the mission stood, by its name in the protocol.
    #[schemars(with = "vocabulary::Phase")]
    pub phase: &'static str,
    /// What held the robot.
    #[schemars(with = "Vec<vocabulary::Hold>")]
    pub holds: Vec<&'static str>,
    /// The cell it was on its way to, or null.
    pub goal: Option<PositionJson>,
    /// Where the robot that searches stood after its last completed step or turn.
    pub robot: StandsJson,
    /// The last reading in °C, or null where there was none not long before.
    pub celsius: Option<f64>,
    /// When it was read; null where that is not known.
    pub read_at: Option<String>,
    /// Since when its source was silent, so that the temperature was not known; null while it was.
    pub silent_since: Option<String>,
    /// In which hall it was, and what counted as too hot; null where no record says so.
    pub conditions: Option<ConditionsShape>,
    /// The luggage that had been found, by number.
    pub luggage: Vec<LuggageJson>,
    /// The hall as far as it was known.
    pub map: MapJson,
    /// What of the record cannot be understood, a sentence each.
    pub damage: Vec<String>,
    /// What happened from then on, and the page that shows this moment.
    pub links: MomentLinks,
}

/// Where a robot stands.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StandsJson {
    pub position: PositionJson,
    /// `north`, `east`, `south` or `west`.
    #[schemars(with = "vocabulary::Heading")]
    pub heading: &'static str,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct MomentLinks {
    pub events: String,
    pub page: String,
}

impl MomentJson {
    /// `wall` is the time of the entry `past.seq`.
    pub fn new(mission: MissionId, past: &Past, wall: WallTime, damage: Vec<String>) -> MomentJson {
        let Links { events, page, .. } = Links::of(mission);
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
            luggage: state.luggage.iter().map(|luggage| LuggageJson::from(&**luggage)).collect(),
            map: MapJson::from(Plan::from(state)),
            damage,
            links: MomentLinks { events: format!("{events}?after={seq}"), page: format!("{page}/moment?at={seq}") },
        }
    }
}

/// `events`, as its schema has it.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "it is there for its schema")]
pub struct EventListJson {
    /// Oldest first.
    events: Vec<journal::ListedLine>,
    /// Where the list goes on, or null at its end.
    next: Option<String>,
}

/// Entries of a mission as one JSON object, `{"events":[…],"next":…}`, each in the form of an exported line. An entry that cannot
/// be read is replaced by the reason.
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
    use crate::api::fixture::{TEN, drawn, piece};
    use hallsweep_core::command::Strategy;
    use hallsweep_core::effect::Fact;
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
            links: Links::of(MissionId(3)),
        }
    }

    #[test]
    fn a_mission_comes_with_its_luggage_its_map_and_where_there_is_more() {
        let mut state = PersistentState::first(Strategy::Snail);
        state.map = drawn(&["11W"], 1);
        let piece = piece(7, Cell::new(2, 0), None);
        state.luggage.insert(piece);
        let json = serde_json::to_value(MissionWholeJson::new(record(), Some(&state), Vec::new())).unwrap();
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
        let json = serde_json::to_value(MissionWholeJson::new(record(), None, vec!["entry 3".to_owned()])).unwrap();
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
