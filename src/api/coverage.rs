//! How far the hall and its areas have been searched, in JSON and as text, and the views of every cell as CSV. The core
//! counts the cells.

use std::fmt::Write as _;

use schemars::JsonSchema;
use serde::Serialize;

use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::snapshot::searched::{Searched, SearchedHall};
use hallsweep_core::units::{Cell, Revision, WallTime};
use hallsweep_core::world::areas::Area;

/// How far the hall and its areas have been searched.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct CoverageJson {
    /// Revision at which the map, the robot or the mission last changed.
    pub revision: u64,
    /// Calibrated model of the robot's sensor: `simCamera`; null if there is none, so that no probability is known.
    pub sensor: Option<&'static str>,
    /// Range of the robot's sonar, in cells; 0 for a robot that bumps into obstacles.
    pub sonar_cells: u8,
    /// Probability that the bomb was found so far, from the probabilities of all areas; null if it is unknown.
    pub success: Option<f64>,
    /// The whole hall. Cells that were not seen are counted only if the hall is known beforehand.
    pub hall: SearchedJson,
    /// Named areas, in the order of the hall file.
    pub areas: Vec<AreaSearchedJson>,
}

/// Numbers of cells, by how they were searched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct SearchedJson {
    /// Number of cells in which the robot was.
    pub driven: usize,
    /// Number of cells into which the robot has only looked, obstacles included.
    pub seen_only: usize,
    /// Number of cells that nobody has seen.
    pub never_seen: usize,
    /// Number of cells to which no way can lead.
    pub unreachable: usize,
    /// Probability that a piece in one of these cells was found, from 0 to 1; null if it is unknown.
    pub detection: Option<f64>,
}

/// Named area and how far it has been searched.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AreaSearchedJson {
    pub name: String,
    /// Probability that the bomb is in this area, from 0 to 1.
    pub probability: f64,
    #[serde(flatten)]
    pub searched: SearchedJson,
}

impl CoverageJson {
    pub fn new(snapshot: &Snapshot, revision: Revision) -> CoverageJson {
        let (all, sensor) = (snapshot.searched(), snapshot.venue.sensor);
        let area = |(area, searched): &(Area, Searched)| AreaSearchedJson {
            name: area.name.to_string(),
            probability: area.probability,
            searched: searched.into(),
        };
        CoverageJson {
            revision: revision.0,
            sensor: sensor.model.map(|model| model.name()),
            sonar_cells: sensor.cells,
            success: all.success(),
            hall: (&all.hall).into(),
            areas: all.areas.iter().map(area).collect(),
        }
    }
}

impl From<&Searched> for SearchedJson {
    fn from(searched: &Searched) -> SearchedJson {
        let Searched { driven, seen_only, never_seen, unreachable, detection } = *searched;
        SearchedJson { driven, seen_only, never_seen, unreachable, detection }
    }
}

/// The whole hall in the first line, and each area in a line such as `gate 1: driven 40, seen only 3, never seen 12,
/// unreachable 0, detection 91 %`.
pub fn lines(all: &SearchedHall) -> String {
    let areas = all.areas.iter().map(|(area, searched)| format!("\n{}: {}", area.name, line(searched)));
    line(&all.hall) + &areas.collect::<String>()
}

fn line(searched: &Searched) -> String {
    let Searched { driven, seen_only, never_seen, unreachable, detection } = searched;
    let detection = detection.map_or_else(|| "unknown".to_owned(), |share| format!("{:.0} %", (share * 100.0).floor()));
    format!("driven {driven}, seen only {seen_only}, never seen {never_seen}, unreachable {unreachable}, detection {detection}")
}

/// All cells that were looked at, one in each line of a CSV file.
pub fn csv(snapshot: &Snapshot) -> String {
    let sensor = snapshot.venue.sensor;
    let named = sensor.model.map_or(if sensor.cells == 0 { "bump" } else { "sonar" }, |model| model.name());
    let mut cells: Vec<(Cell, _)> = snapshot.coverage.iter().collect();
    cells.sort_unstable_by_key(|(cell, _)| (cell.y, cell.x));
    let mut text = "x,y,mark,sensor,passes,nearest_cells,last_look,detection\r\n".to_owned();
    for (Cell { x, y }, views) in cells {
        let mark = snapshot.map.at(Cell::new(x, y)).name();
        let (passes, nearest) = (views.count(), views.nearest().unwrap_or_default());
        let last = super::time::minute(WallTime { unix_ms: i64::from(views.minute) * 60_000, offset_s: 0 });
        let detection = sensor.detection(views).map_or_else(String::new, |share| format!("{share:.3}"));
        let _ = write!(text, "{x},{y},{mark},{named},{passes},{nearest},{last},{detection}\r\n");
    }
    text
}
