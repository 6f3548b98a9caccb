//! The hall map in JSON: all known cells row by row, or only the cells that changed. The text forms of old clients
//! are in `map_text`.

use schemars::JsonSchema;
use serde::Serialize;

use super::robot::PositionJson;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::{Cell, Revision};
use hallsweep_core::world::hall_map::{HallMap, Mark, cells_of};
use hallsweep_core::world::resource::Resource;

#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    pub hall: &'a HallMap,
    /// Cell where the robot stands, or stood at the moment that is shown.
    pub robot: Cell,
}

/// Known part of the hall, borders included; the mark of cell (x, y) is `rows[y - origin.y][x - origin.x]`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct MapJson {
    /// Revision at which the map or the robot last changed. Absent in a mission's record, because a revision is valid
    /// in one run only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revision: Option<u64>,
    /// Cell of the first character of the first row.
    pub origin: PositionJson,
    /// Number of columns.
    pub width: i32,
    /// Number of rows.
    pub height: i32,
    /// Rows from north to south, with one character per cell: `r` robot, `1` visited, `0` unknown, `X` obstacle.
    pub rows: Vec<String>,
}

/// Changed cells. The map shows one robot: when a new `r` arrives, clients change the cell of the previous `r` to
/// `1`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct MapCells {
    /// Revision at which the map or the robot last changed.
    pub revision: u64,
    /// Cell of the first character of the first row.
    pub origin: PositionJson,
    /// Number of columns.
    pub width: i32,
    /// Number of rows.
    pub height: i32,
    pub cells: Vec<CellJson>,
}

/// A cell and its mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct CellJson {
    /// Column.
    pub x: i32,
    /// Row.
    pub y: i32,
    /// Mark of the cell: `r` robot, `1` visited, `0` unknown, `X` obstacle.
    pub mark: char,
}

/// Change of the map in a stream of events.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum MapChange {
    /// The whole map.
    Whole(MapJson),
    /// The changed cells.
    Cells(MapCells),
}

impl<'a> From<&'a Snapshot> for Plan<'a> {
    fn from(snapshot: &'a Snapshot) -> Plan<'a> {
        Plan { hall: &snapshot.map, robot: snapshot.robot.pose.cell }
    }
}

impl<'a> From<&'a PersistentState> for Plan<'a> {
    fn from(state: &'a PersistentState) -> Plan<'a> {
        Plan { hall: &state.map, robot: state.pose.cell }
    }
}

impl From<&Snapshot> for MapJson {
    fn from(snapshot: &Snapshot) -> MapJson {
        MapJson { revision: Some(map_revision(snapshot).0), ..MapJson::from(Plan::from(snapshot)) }
    }
}

impl From<Plan<'_>> for MapJson {
    fn from(plan: Plan<'_>) -> MapJson {
        let bounds = plan.hall.known_bounds();
        MapJson {
            revision: None,
            origin: bounds.least.into(),
            width: bounds.width(),
            height: bounds.height(),
            rows: (bounds.least.y..=bounds.most.y)
                .map(|y| (bounds.least.x..=bounds.most.x).map(|x| mark_char(plan, Cell::new(x, y))).collect())
                .collect(),
        }
    }
}

impl MapChange {
    /// Returns the changes between two snapshots; `None` if the map is the same. If the robot only turned, no cell
    /// has changed, but the map has a new revision.
    pub fn between(older: &Snapshot, snapshot: &Snapshot) -> Option<MapChange> {
        let mut changed: Vec<Cell> = snapshot.map.changes_since(&older.map).into_iter().map(|(cell, _)| cell).collect();
        changed.extend([older.robot.pose.cell, snapshot.robot.pose.cell]);
        changed.retain(|cell| mark_char(older.into(), *cell) != mark_char(snapshot.into(), *cell));
        changed.sort_unstable();
        changed.dedup();
        (!changed.is_empty() || map_revision(snapshot) > map_revision(older)).then(|| MapChange::cells(snapshot, changed))
    }

    /// Returns the cells of all tiles that changed since a revision whose snapshot is not stored. If all tiles
    /// changed, the map may have been emptied meanwhile, so the whole map is sent.
    pub fn since(snapshot: &Snapshot, revision: Revision) -> Option<MapChange> {
        if map_revision(snapshot) <= revision {
            return None;
        }
        if snapshot.map.tiles().all(|(_, tile)| tile.revision > revision) {
            return Some(MapChange::Whole(MapJson::from(snapshot)));
        }
        let bounds = snapshot.map.known_bounds();
        let newer = snapshot.map.tiles().filter(|(_, tile)| tile.revision > revision);
        let mut cells: Vec<Cell> = newer.flat_map(|(corner, _)| cells_of(corner)).filter(|cell| bounds.contains(*cell)).collect();
        cells.push(snapshot.robot.pose.cell);
        cells.sort_unstable();
        cells.dedup();
        Some(MapChange::cells(snapshot, cells))
    }

    fn cells(snapshot: &Snapshot, cells: Vec<Cell>) -> MapChange {
        let bounds = snapshot.map.known_bounds();
        let with_mark = |cell: Cell| CellJson { x: cell.x, y: cell.y, mark: mark_char(snapshot.into(), cell) };
        MapChange::Cells(MapCells {
            revision: map_revision(snapshot).0,
            origin: bounds.least.into(),
            width: bounds.width(),
            height: bounds.height(),
            cells: cells.into_iter().map(with_mark).collect(),
        })
    }
}

/// The revision at which anything shown in a map last changed, including the robot.
pub fn map_revision(snapshot: &Snapshot) -> Revision {
    snapshot.revision_of(Resource::Map).max(snapshot.revision_of(Resource::Robot))
}

/// Character of a cell: `r` robot, `1` visited, `0` unknown, `X` obstacle. A cell that was only seen to be free is
/// shown as unknown.
pub fn mark_char(plan: Plan<'_>, cell: Cell) -> char {
    if cell == plan.robot {
        return 'r';
    }
    match plan.hall.at(cell) {
        Mark::Unknown | Mark::Seen => '0',
        Mark::Visited => '1',
        Mark::Wall | Mark::Luggage | Mark::NotInspected => 'X',
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{drawn, idle, searching, touch};

    fn cells(change: Option<MapChange>) -> Vec<(i32, i32, char)> {
        match change {
            Some(MapChange::Cells(map)) => map.cells.iter().map(|cell| (cell.x, cell.y, cell.mark)).collect(),
            Some(MapChange::Whole(map)) => panic!("only cells were expected, not {map:?}"),
            None => Vec::new(),
        }
    }

    #[test]
    fn every_known_cell_is_there_and_the_robot_in_its_own() {
        let map = MapJson::from(&searching());
        assert_eq!((map.origin, map.width, map.height), (PositionJson { x: 0, y: 0 }, 6, 5));
        assert_eq!(map.rows, ["111X1X", "11110X", "1XrX0X", "11110X", "XXXXX0"]);
    }

    #[test]
    fn rows_and_columns_may_lie_north_and_west_of_home() {
        let mut snapshot = idle();
        snapshot.map.mark(Cell::new(-1, -1), Mark::Wall, Revision(2));
        let map = MapJson::from(&snapshot);
        assert_eq!((map.origin, map.rows), (PositionJson { x: -1, y: -1 }, vec!["X0".to_owned(), "0r".to_owned()]));
    }

    #[test]
    fn a_step_sends_the_cell_left_and_the_cell_entered() {
        let older = idle();
        let mut newer = older.clone();
        newer.map.mark(Cell::new(0, 1), Mark::Visited, Revision(2));
        newer.robot.pose.cell = Cell::new(0, 1);
        touch(&mut newer, 2, &[Resource::Map, Resource::Robot]);
        assert_eq!(cells(MapChange::between(&older, &newer)), [(0, 0, '1'), (0, 1, 'r')]);
        assert_eq!(MapChange::between(&newer, &newer.clone()), None);
    }

    #[test]
    fn an_emptied_map_takes_back_what_was_known() {
        let (older, newer) = (searching(), idle());
        let changes = cells(MapChange::between(&older, &newer));
        assert!(changes.contains(&(5, 0, '0')) && changes.contains(&(0, 0, 'r')), "{changes:?}");
    }

    #[test]
    fn a_returning_reader_gets_the_tiles_that_changed_since() {
        let mut snapshot = idle();
        snapshot.map = drawn(&["11"], 2);
        snapshot.map.mark(Cell::new(40, 0), Mark::Wall, Revision(9));
        touch(&mut snapshot, 9, &[Resource::Map]);
        let changes = cells(MapChange::since(&snapshot, Revision(5)));
        assert!(changes.contains(&(40, 0, 'X')) && changes.contains(&(0, 0, 'r')), "{changes:?}");
        assert!(!changes.contains(&(1, 0, '1')), "the first tile has not changed since");
        assert_eq!(MapChange::since(&snapshot, Revision(9)), None);
    }

    #[test]
    fn a_returning_reader_whose_every_tile_is_older_gets_the_whole_map() {
        let mut snapshot = idle();
        touch(&mut snapshot, 9, &[Resource::Map]);
        snapshot.map = drawn(&["1"], 9);
        assert!(matches!(MapChange::since(&snapshot, Revision(5)), Some(MapChange::Whole(_))));
    }
}
