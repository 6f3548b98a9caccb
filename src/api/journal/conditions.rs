//! The conditions of a mission, in the journal and in the API: the hall, the temperature threshold, the robots and
//! the seed.

use std::ops::RangeInclusive;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Unparsed, names};
use crate::api::is_default;
use hallsweep_core::settings::{AfterDanger, HotRule, Rules, SafeBy};
use hallsweep_core::state::{Conditions, Participant, Reach, Venue};
use hallsweep_core::units::{Bounds, Cell};
use hallsweep_core::world::areas::Area;
use hallsweep_core::world::coverage::{Sensor, SensorModel};

/// Minimum and maximum side of a cell, in metres: no hall has smaller or larger cells.
const SIDES_M: RangeInclusive<f64> = 0.01..=100.0;
/// Minimum and maximum radius of a keep-out ring, in metres.
const RINGS_M: RangeInclusive<f64> = 0.0..=Rules::WIDEST_M;
/// Maximum distance of an area's corner from the start, in columns or rows. No hall is larger.
const FARTHEST_CORNER: i32 = 2048;
/// Maximum length of the name of a hall, in bytes.
const NAME_BYTES: usize = 4096;

/// Conditions of a mission, as `{"hall":"airport","cellM":0.5,"threshold":25.0}`. `cellM` is the side of a cell in
/// metres, or null if it is unknown; `threshold` is in °C. If the hall is known beforehand, `"reach":[51,60]` has the
/// numbers of reachable cells and of all free cells. `"robots":[{"name":"discovery","kind":"sim"}]` are the robots
/// that take part, beginning with the robot that searches. `"seed":"7"` is the seed of a simulated hall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Conditions")]
#[serde(rename_all = "camelCase")]
pub struct ConditionsShape {
    hall: String,
    cell_m: Option<f64>,
    threshold: f64,
    /// Whether the robot measures its way by time and has no scene file. Obstacles may then be one cell beside the
    /// shown place.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    reckoned: bool,
    /// Number of free cells that a robot can reach from its start, and number of all free cells. Absent if the hall
    /// is not known beforehand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reach: Option<(u32, u32)>,
    /// Robots that take part, beginning with the robot that searches; absent in records of earlier versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    robots: Vec<ParticipantShape>,
    /// Whether the mission is an exercise; absent otherwise.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    exercise: bool,
    /// Seed of a simulated hall, in digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    seed: Option<String>,
    /// What the search does after a danger: `go_on`; absent if the robot comes home.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    after_danger: Option<String>,
    /// Radius of the keep-out rings, in metres; absent if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    keep_out_m: Option<f64>,
    /// Number of judges that a verdict of safe needs; absent if one judge is enough.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    safe_by: Option<String>,
    /// Whether the three questions are compulsory: `required`; absent if they are not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hot: Option<String>,
    /// Number of further photos when a judge is unsure; absent if there are two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    unsure_views: Option<u8>,
    /// Range of the robot's sonar, in cells; absent for a robot that bumps into obstacles.
    #[serde(default, skip_serializing_if = "is_default")]
    sonar_cells: u8,
    /// Calibrated model of the robot's sensor: `simCamera`; absent if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sensor: Option<String>,
    /// Named areas of the hall; absent if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    areas: Vec<NamedAreaShape>,
}

/// Named area of a hall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "NamedArea")]
struct NamedAreaShape {
    name: String,
    /// Probability that the bomb is in this area.
    probability: f64,
    /// Two opposite corners of a rectangle, or the corners of a polygon in order, each as `[column, row]` from the start.
    corners: Vec<(i32, i32)>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Participant")]
struct ParticipantShape {
    name: String,
    /// Kind of robot: `sim`, `virtual-tcp`, `virtual-ws` or `line`.
    kind: String,
    /// Address of the robot, as `localhost:8999`; absent for a robot that is part of this program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    address: Option<String>,
}

impl From<&Conditions> for ConditionsShape {
    fn from(Conditions { venue, threshold, rules }: &Conditions) -> ConditionsShape {
        let usual = Rules::default();
        ConditionsShape {
            hall: venue.name.to_string(),
            cell_m: venue.cell_m,
            threshold: threshold.degrees(),
            reckoned: venue.is_reckoned,
            reach: venue.reach.map(|Reach { reachable, free }| (reachable, free)),
            robots: venue.robots.iter().map(ParticipantShape::from).collect(),
            exercise: venue.is_exercise,
            seed: venue.seed.map(|seed| seed.to_string()),
            after_danger: (rules.after_danger != usual.after_danger).then(|| rules.after_danger.name().to_owned()),
            keep_out_m: Some(rules.keep_out_m).filter(|metres| *metres != usual.keep_out_m),
            safe_by: (rules.safe_by != usual.safe_by).then(|| rules.safe_by.name().to_owned()),
            hot: (rules.hot != usual.hot).then(|| rules.hot.name().to_owned()),
            unsure_views: Some(rules.unsure_views).filter(|views| *views != usual.unsure_views),
            sonar_cells: venue.sensor.cells,
            sensor: venue.sensor.model.map(|sensor| sensor.name().to_owned()),
            areas: venue.areas.iter().map(NamedAreaShape::from).collect(),
        }
    }
}

impl From<&Area> for NamedAreaShape {
    fn from(area: &Area) -> NamedAreaShape {
        let corners = area.corners.iter().map(|corner| (corner.x, corner.y)).collect();
        NamedAreaShape { name: area.name.to_string(), probability: area.probability, corners }
    }
}

impl From<&Participant> for ParticipantShape {
    fn from(Participant { name, kind, address }: &Participant) -> ParticipantShape {
        ParticipantShape { name: name.to_string(), kind: kind.to_string(), address: address.as_deref().map(str::to_owned) }
    }
}

impl From<ParticipantShape> for Participant {
    fn from(ParticipantShape { name, kind, address }: ParticipantShape) -> Participant {
        Participant { name: name.into(), kind: kind.into(), address: address.map(Arc::from) }
    }
}

impl ConditionsShape {
    pub(super) fn conditions(self) -> Result<Conditions, Unparsed> {
        let ConditionsShape {
            hall, cell_m, threshold, reckoned: is_reckoned, reach, robots, exercise: is_exercise, seed, ..
        } = self;
        let reach = reach.map(|(reachable, free)| Reach { reachable, free });
        if cell_m.is_some_and(|side| !SIDES_M.contains(&side)) {
            return Err(Unparsed("the side of a cell is out of range".to_owned()));
        }
        if reach.is_some_and(|reach| reach.reachable > reach.free) {
            return Err(Unparsed("more cells can be reached than are free".to_owned()));
        }
        if hall.len() > NAME_BYTES {
            return Err(Unparsed("the name of the hall is too long".to_owned()));
        }
        let seed = seed.map(|digits| digits.parse().map_err(|_| Unparsed("the seed is not a number".to_owned()))).transpose()?;
        let rules = Rules {
            after_danger: rule(self.after_danger, &AfterDanger::ALL, AfterDanger::name)?,
            keep_out_m: self.keep_out_m.unwrap_or(0.0),
            safe_by: rule(self.safe_by, &SafeBy::ALL, SafeBy::name)?,
            hot: rule(self.hot, &HotRule::ALL, HotRule::name)?,
            unsure_views: self.unsure_views.unwrap_or(Rules::MOST_VIEWS),
        };
        if rules.unsure_views > Rules::MOST_VIEWS {
            return Err(Unparsed("there are too many further photos".to_owned()));
        }
        if !RINGS_M.contains(&rules.keep_out_m) {
            return Err(Unparsed("the radius of the keep-out rings is out of range".to_owned()));
        }
        let robots = robots.into_iter().map(Participant::from).collect();
        let model = |name: String| names::named("sensor", &name, &SensorModel::ALL, SensorModel::name);
        let area = |NamedAreaShape { name, probability, corners }: NamedAreaShape| Area {
            name: name.into(),
            probability,
            corners: corners.into_iter().map(|(x, y)| Cell::new(x, y)).collect(),
        };
        let areas: Arc<[Area]> = self.areas.into_iter().map(area).collect();
        let all = Bounds::of(Cell::HOME).grown(FARTHEST_CORNER);
        Area::check(&areas, all).map_err(|(n, fault)| Unparsed(format!("area {}: {fault}", n + 1)))?;
        let sensor = Sensor { cells: self.sonar_cells, model: self.sensor.map(model).transpose()? };
        Ok(Conditions {
            venue: Venue { name: hall.into(), cell_m, is_reckoned, reach, robots, is_exercise, seed, areas, sensor },
            threshold: names::celsius(threshold)?,
            rules,
        })
    }
}

/// Reads the name of a rule. If there is none, the usual rule applied.
fn rule<T: Copy + Default>(name: Option<String>, all: &[T], name_of: fn(T) -> &'static str) -> Result<T, Unparsed> {
    name.map_or(Ok(T::default()), |name| names::named("rule", &name, all, name_of))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Conditions, Unparsed> {
        serde_json::from_str::<ConditionsShape>(text).expect("it is JSON of this shape").conditions()
    }

    #[test]
    fn a_record_says_which_robots_took_part_and_that_of_an_earlier_version_does_not() {
        let earlier = r#"{"hall":"airport","cellM":0.5,"threshold":25.0}"#;
        let conditions = read(earlier).unwrap();
        assert!(conditions.venue.robots.is_empty() && conditions.venue.seed.is_none());
        assert_eq!(serde_json::to_string(&ConditionsShape::from(&conditions)).unwrap(), earlier);
        let now = r#"{"hall":"airport","cellM":0.5,"threshold":25.0,"robots":[{"name":"discovery","kind":"sim"},{"name":"scout","kind":"line","address":"/dev/ttyUSB0"}],"seed":"18446744073709551615"}"#;
        let conditions = read(now).unwrap();
        assert_eq!((&*conditions.venue.robots[1].name, conditions.venue.seed), ("scout", Some(u64::MAX)));
        assert_eq!(serde_json::to_string(&ConditionsShape::from(&conditions)).unwrap(), now);
        assert!(read(&now.replace("\"18446744073709551615\"", "\"x\"")).is_err());
    }

    /// The search relies on this check: it makes room for all areas, and numbers them in 128 bits.
    #[test]
    fn areas_of_a_damaged_journal_are_refused() {
        let area = |name: &str, corners: &str| format!(r#"{{"name":"{name}","probability":0.01,"corners":{corners}}}"#);
        let with = |areas: &[String]| {
            read(&format!(r#"{{"hall":"airport","cellM":0.5,"threshold":25.0,"areas":[{}]}}"#, areas.join(",")))
        };
        let good = area("gate", "[[-2048,-2048],[2048,2048]]");
        assert_eq!(with(std::slice::from_ref(&good)).unwrap().venue.areas.len(), 1);
        for damaged in [
            vec![area("far", "[[0,0],[2049,0]]")],
            vec![area("beyond", "[[0,0],[2147483647,-2147483648]]")],
            vec![good, area("overlapping", "[[0,0],[1,1]]")],
            (0..65).map(|n| area(&format!("a{n}"), &format!("[[{n},0],[{n},0]]"))).collect(),
        ] {
            assert!(with(&damaged).is_err(), "{damaged:?}");
        }
    }
}
