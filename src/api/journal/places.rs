//! Cells, poses and times in the journal. A time has the exact millisecond and offset. Its RFC 3339 form is only for
//! people.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

use super::{Unparsed, names};
use crate::api::time::rfc3339;
use hallsweep_core::command::Again;
use hallsweep_core::search::Goal;
use hallsweep_core::units::{Cell, Pose, WallTime};
use hallsweep_core::world::hall_map::{Bounds, REACH};

/// Maximum coordinate of a cell in a journal, in each direction from home: twice the reach of a map.
const FARTHEST: i32 = 2 * REACH;

#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Point {
    #[serde(deserialize_with = "side")]
    pub(super) x: i32,
    #[serde(deserialize_with = "side")]
    pub(super) y: i32,
}

/// Two opposite corners of an area of cells.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct AreaShape {
    #[serde(deserialize_with = "side")]
    x: i32,
    #[serde(deserialize_with = "side")]
    y: i32,
    #[serde(deserialize_with = "side")]
    to_x: i32,
    #[serde(deserialize_with = "side")]
    to_y: i32,
}

/// Cells that are to be searched again: between two corners, or the area of this name.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum AgainShape {
    Within(AreaShape),
    Area { area: String },
}

#[derive(Serialize, Deserialize)]
pub(super) struct PoseShape {
    #[serde(deserialize_with = "side")]
    x: i32,
    #[serde(deserialize_with = "side")]
    y: i32,
    heading: String,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Moment {
    /// The time in RFC 3339, for people. It is not read back.
    #[serde(default)]
    at: String,
    unix_ms: i64,
    offset_s: i32,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) enum GoalShape {
    Visit(Point),
    Home,
}

impl From<Cell> for Point {
    fn from(Cell { x, y }: Cell) -> Point {
        Point { x, y }
    }
}

impl From<Point> for Cell {
    fn from(Point { x, y }: Point) -> Cell {
        Cell { x, y }
    }
}

impl From<&Again> for AgainShape {
    fn from(again: &Again) -> AgainShape {
        match again {
            Again::Within(bounds) => AgainShape::Within((*bounds).into()),
            Again::Area(name) => AgainShape::Area { area: name.to_string() },
        }
    }
}

impl AgainShape {
    pub(super) fn again(self) -> Result<Again, Unparsed> {
        match self {
            AgainShape::Within(area) => Ok(Again::Within(area.into())),
            AgainShape::Area { area } => names::area(area).map(Again::Area),
        }
    }
}

impl From<Bounds> for AreaShape {
    fn from(Bounds { least, most }: Bounds) -> AreaShape {
        AreaShape { x: least.x, y: least.y, to_x: most.x, to_y: most.y }
    }
}

impl From<AreaShape> for Bounds {
    fn from(AreaShape { x, y, to_x, to_y }: AreaShape) -> Bounds {
        Bounds { least: Cell::new(x, y), most: Cell::new(to_x, to_y) }
    }
}

impl From<Pose> for PoseShape {
    fn from(Pose { cell: Cell { x, y }, heading }: Pose) -> PoseShape {
        PoseShape { x, y, heading: heading.name().to_owned() }
    }
}

impl PoseShape {
    pub(super) fn pose(&self) -> Result<Pose, Unparsed> {
        Ok(Pose { cell: Cell::new(self.x, self.y), heading: names::heading(&self.heading)? })
    }
}

impl From<WallTime> for Moment {
    fn from(wall: WallTime) -> Moment {
        Moment { at: rfc3339(wall), unix_ms: wall.unix_ms, offset_s: wall.offset_s }
    }
}

impl From<Moment> for WallTime {
    fn from(Moment { unix_ms, offset_s, .. }: Moment) -> WallTime {
        WallTime { unix_ms, offset_s }
    }
}

impl From<Goal> for GoalShape {
    fn from(goal: Goal) -> GoalShape {
        match goal {
            Goal::Visit(cell) => GoalShape::Visit(cell.into()),
            Goal::Home => GoalShape::Home,
        }
    }
}

impl From<GoalShape> for Goal {
    fn from(goal: GoalShape) -> Goal {
        match goal {
            GoalShape::Visit(cell) => Goal::Visit(cell.into()),
            GoalShape::Home => Goal::Home,
        }
    }
}

/// Reads one coordinate of a cell. A coordinate beyond `FARTHEST` is refused.
pub(super) fn side<'de, D: Deserializer<'de>>(deserializer: D) -> Result<i32, D::Error> {
    let side = i32::deserialize(deserializer)?;
    if (-FARTHEST..=FARTHEST).contains(&side) {
        return Ok(side);
    }
    Err(D::Error::custom(format!("{side} is no coordinate of a cell: coordinates are between -{FARTHEST} and {FARTHEST}")))
}
