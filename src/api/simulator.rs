//! The simulator in JSON: its state, the changes to it, and the hall into which the robots are to be put. State and
//! changes use the same names, so that a client can edit the state and send it back.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};
use serde_json::Value;

use super::fields::{Body, BodyFields, Unusable, in_short};
use super::robot::PositionJson;
use crate::runtime::simulator::{Change, HallSource, MOST_BLOCKED, OtherHall, Simulator, SimulatorState, Speed};
use hallsweep_core::units::Cell;

/// State of the simulator.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct SimulatorJson<'a> {
    hall: HallJson<'a>,
    /// Seed of the simulation, as digits in quotes, because some clients round large numbers.
    #[serde(serialize_with = "in_digits")]
    #[schemars(with = "String", regex(pattern = "^[0-9]+$"))]
    seed: u64,
    #[serde(serialize_with = "speed")]
    #[schemars(with = "SpeedShape")]
    speed: Speed,
    paused: bool,
    link_lost: bool,
    no_thermometer: bool,
    camera_fails: bool,
    blocked: Vec<PositionJson>,
    /// Names of the offered halls.
    halls: Vec<String>,
    /// Names of the offered halls that users stored.
    kept_halls: Vec<String>,
    /// Reason why the hall cannot be changed now; null if the hall can be changed.
    bound: Option<String>,
}

#[derive(Debug, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
struct HallJson<'a> {
    name: &'a str,
    /// Number of columns.
    width: u32,
    /// Number of rows.
    height: u32,
    /// Side of a cell, in metres.
    cell_m: f64,
    /// Number of pieces of luggage.
    pieces: usize,
}

impl<'a> SimulatorJson<'a> {
    pub fn new(simulator: &dyn Simulator, state: &'a SimulatorState, bound: Option<String>) -> SimulatorJson<'a> {
        let SimulatorState { hall, seed, speed, is_paused, faults } = state;
        let (width, height) = hall.size;
        SimulatorJson {
            hall: HallJson { name: &hall.name, width, height, cell_m: hall.cell_m, pieces: hall.pieces },
            seed: *seed,
            speed: *speed,
            paused: *is_paused,
            link_lost: faults.link_lost,
            no_thermometer: faults.no_thermometer,
            camera_fails: faults.camera_fails,
            blocked: faults.blocked.iter().copied().map(PositionJson::from).collect(),
            halls: simulator.halls(),
            kept_halls: simulator.kept_halls(),
            bound,
        }
    }
}

fn in_digits<S: Serializer>(number: &u64, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(number)
}

fn speed<S: Serializer>(speed: &Speed, to: S) -> Result<S::Ok, S::Error> {
    match speed {
        Speed::Times(factor) => to.serialize_f64(*factor),
        Speed::Max => to.serialize_str("max"),
    }
}

/// Speed as a multiple of real time, or `max` for the highest possible speed.
struct SpeedShape;

impl JsonSchema for SpeedShape {
    fn schema_name() -> Cow<'static, str> {
        "Speed".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Speed as a multiple of real time, or `max` for the highest possible speed.",
            "oneOf": [{"type": "number", "minimum": Speed::SLOWEST, "maximum": Speed::FASTEST}, {"const": "max"}],
        })
    }
}

/// Body of `PUT simulator`.
#[derive(JsonSchema)]
pub struct ChangeBody(#[schemars(with = "ChangeShape")] pub Change);

/// Changes to the simulator; absent fields are left unchanged.
#[derive(JsonSchema)]
#[schemars(rename = "SimulatorChange", rename_all = "camelCase", deny_unknown_fields)]
#[expect(dead_code, reason = "it is read field by field, so that what is wrong is said in words")]
struct ChangeShape {
    speed: Option<SpeedShape>,
    paused: Option<bool>,
    link_lost: Option<bool>,
    no_thermometer: Option<bool>,
    camera_fails: Option<bool>,
    /// Free cells that get an obstacle. This list replaces the previous list of such cells.
    #[schemars(length(max = MOST_BLOCKED))]
    blocked: Option<Vec<PositionJson>>,
}

impl Body for ChangeBody {
    const FIELDS: &'static [&'static str] = &["speed", "paused", "linkLost", "noThermometer", "cameraFails", "blocked"];

    fn taken(fields: &BodyFields) -> Result<ChangeBody, Unusable> {
        let whether = |name| fields.field(name, "true or false", Value::as_bool);
        let max = |value: &Value| value.as_str().filter(|text| *text == "max").map(str::to_owned);
        let number_or_max = |value: &Value| max(value).or_else(|| Some(value.as_f64()?.to_string()));
        let speed = fields.field("speed", "a number, such as 2, or \"max\"", number_or_max)?;
        let blocked = fields.field("blocked", "a list of cells, such as [{\"x\":1,\"y\":2}]", |value| {
            let side = |cell: &Value, name: &str| i32::try_from(cell.get(name)?.as_i64()?).ok();
            value.as_array()?.iter().map(|cell| Some(Cell::new(side(cell, "x")?, side(cell, "y")?))).collect()
        })?;
        Ok(ChangeBody(Change {
            speed: speed.as_deref().map(pace).transpose()?,
            is_paused: whether("paused")?,
            link_lost: whether("linkLost")?,
            no_thermometer: whether("noThermometer")?,
            camera_fails: whether("cameraFails")?,
            blocked,
        }))
    }
}

/// Reads a speed. Blanks at both ends and a decimal comma are allowed, because people type them.
pub fn pace(text: &str) -> Result<Speed, Unusable> {
    if text.trim() == "max" {
        return Ok(Speed::Max);
    }
    let range = Speed::SLOWEST..=Speed::FASTEST;
    let factor = text.trim().replace(',', ".").parse().ok().filter(|factor| range.contains(factor));
    factor.map(Speed::Times).ok_or_else(|| {
        let words = format!("`speed` is {}: send {} to {}, or max", in_short(text), Speed::SLOWEST, Speed::FASTEST);
        Unusable::new(words)
    })
}

/// Body of `PUT simulator/hall`.
pub struct HallBody(pub OtherHall);

impl JsonSchema for HallBody {
    fn schema_name() -> Cow<'static, str> {
        "HallBody".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let form = |named: &str, other: &str, what: &str| {
            json_schema!({
                "type": "object",
                "properties": {
                    (named): {"type": "string", "description": what},
                    (other): {"const": null},
                    "seed": {
                        "description": "Seed of the simulation, as a number or as digits in quotes; the present seed if absent.",
                        "oneOf": [
                            {"type": "integer", "minimum": 0, "maximum": u64::MAX},
                            {"type": "string", "pattern": "^[0-9]{1,20}$"},
                            {"const": null},
                        ],
                    },
                },
                "required": [named],
                "additionalProperties": false,
            })
        };
        json_schema!({
            "description": "Name of an offered hall, or a hall file, with an optional seed.",
            "oneOf": [form("name", "toml", "Name of an offered hall."), form("toml", "name", "Contents of a hall file.")],
        })
    }
}

impl Body for HallBody {
    const FIELDS: &'static [&'static str] = &["name", "toml", "seed"];

    fn taken(fields: &BodyFields) -> Result<HallBody, Unusable> {
        let source = match (fields.text("name")?, fields.text("toml")?) {
            (Some(name), None) => HallSource::Named(name),
            (None, Some(toml)) => HallSource::Toml(toml),
            (Some(_), Some(_)) => return Err(Unusable::new("send either `name` or `toml`, not both".to_owned())),
            (None, None) => {
                let words = "the body has no hall: send `name`, as \"airport\", or `toml`, the text of a hall file".to_owned();
                return Err(Unusable::new(words));
            }
        };
        let digits = |value: &Value| value.as_str().map_or_else(|| value.as_u64(), |text| text.parse().ok());
        Ok(HallBody(OtherHall { source, seed: fields.field("seed", "a whole number from 0", digits)? }))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::api::fields::{Unread, body};

    fn change(text: &str) -> Result<Change, String> {
        body::<ChangeBody>(text.as_bytes()).map(|ChangeBody(change)| change).map_err(said)
    }

    fn said(unread: Unread) -> String {
        match unread {
            Unread::Malformed(words) => words,
            Unread::Unusable(unusable) => unusable.to_string(),
        }
    }

    #[test]
    fn what_is_named_changes_and_nothing_else() {
        assert_eq!(change("{}"), Ok(Change::default()));
        let all = r#"{"speed":"max","paused":true,"linkLost":false,"cameraFails":true,"blocked":[{"x":1,"y":-2}]}"#;
        let expect = Change {
            speed: Some(Speed::Max),
            is_paused: Some(true),
            link_lost: Some(false),
            camera_fails: Some(true),
            blocked: Some(BTreeSet::from([Cell::new(1, -2)])),
            no_thermometer: None,
        };
        assert_eq!(change(all), Ok(expect));
        assert_eq!(change(r#"{"speed":2.5}"#), Ok(Change { speed: Some(Speed::Times(2.5)), ..Change::default() }));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_field() {
        for (body, words) in [
            (r#"{"speed":0}"#, "`speed` is 0: send 0.1 to 1000, or max"),
            (r#"{"speed":"fast"}"#, "`speed` is \"fast\": send a number, such as 2, or \"max\""),
            (r#"{"speed":"2"}"#, "`speed` is \"2\""),
            (r#"{"paused":"yes"}"#, "`paused` is \"yes\": send true or false"),
            (r#"{"blocked":[{"x":1}]}"#, "`blocked` is [{\"x\":1}]: send a list of cells"),
            (r#"{"blocked":[{"x":1,"y":5000000000}]}"#, "`blocked` is"),
            (r#"{"hall":"airport"}"#, "this command has no field `hall`"),
        ] {
            let why = change(body).expect_err(body);
            assert!(why.contains(words), "{body}: {why}");
        }
    }

    #[test]
    fn a_hall_is_named_or_sent_and_never_both() {
        let hall = |text: &str| body::<HallBody>(text.as_bytes()).map(|HallBody(hall)| hall).map_err(said);
        let named = OtherHall { source: HallSource::Named("seed".to_owned()), seed: Some(18_446_744_073_709_551_615) };
        assert_eq!(hall(r#"{"name":"seed","seed":"18446744073709551615"}"#), Ok(named));
        let sent = OtherHall { source: HallSource::Toml("width = 2".to_owned()), seed: None };
        assert_eq!(hall(r#"{"toml":"width = 2"}"#), Ok(sent));
        assert!(hall("{}").is_err_and(|why| why.contains("the body has no hall")));
        assert!(hall(r#"{"name":"a","toml":"b"}"#).is_err_and(|why| why.contains("not both")));
        assert!(hall(r#"{"name":"a","seed":-1}"#).is_err_and(|why| why.contains("`seed` is -1")));
    }
}
