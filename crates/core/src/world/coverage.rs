//! What a search has looked at, and the probability of detection that follows. A cell's *views* are the different
//! places from which the robot has looked at the cell. A view from the same place shows the same, so it counts once.
//!
//! The probability follows the theory of search: with the sweep width W of each view, the track length L and the area A
//! that it covers, the coverage is the sum of W · L ÷ A, and the probability of detection is 1 − e^−coverage. Here the
//! track is as long as a cell, and A is the cell.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::sweep::SIM_CAMERA;
use super::tiles::{TILE, cells_of, place_in_tile, tile_of};
use crate::units::{Cell, Heading, WallTime};

named! {
    ALL by name;
    /// A sensor whose sweep widths were calibrated.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum SensorModel {
        /// The camera of the simulated robot while it can miss luggage (`robot.camera_misses`), in cells of half a metre.
        SimCamera = "simCamera",
    }
}

impl Sensor {
    /// The side of a cell for which sensors were calibrated, in metres.
    pub const CALIBRATED_M: f64 = 0.5;

    /// Returns the probability that the robot has recognised a piece in a cell with these views, if one
    /// is there. `None` if it is unknown.
    #[must_use]
    pub fn detection(self, views: Views) -> Option<f64> {
        let SensorModel::SimCamera = self.model?;
        let of_each = (1..=FURTHEST).zip(SIM_CAMERA).map(|(distance, width_m)| f64::from(views.at_distance(distance)) * width_m);
        Some(1.0 - (-of_each.sum::<f64>() / Sensor::CALIBRATED_M).exp())
    }
}

/// The sensor of the searching robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sensor {
    /// Number of cells ahead of which sonar and camera report; 0 for a robot that bumps into obstacles.
    pub cells: u8,
    /// `None` if the sensor is not calibrated for this hall. The probability of detection is then unknown.
    pub model: Option<SensorModel>,
}

/// Maximum distance of a view, in cells. No robot's sonar is believed beyond it.
pub const FURTHEST: u8 = 8;

/// The views of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Views {
    /// One bit for each heading of a look and each distance: the bits 0 to 7 are looks to the north from 1 to 8 cells.
    pub bits: u32,
    /// Minute of the last look, since 1970.
    pub minute: u32,
}

impl Views {
    /// Number of different views.
    #[must_use]
    pub const fn count(self) -> u32 {
        self.bits.count_ones()
    }

    /// The distance of the nearest view, in cells. `None` if the robot has never looked there.
    #[must_use]
    pub fn nearest(self) -> Option<u8> {
        (1..=FURTHEST).find(|distance| self.at_distance(*distance) > 0)
    }

    /// Number of views from this distance.
    #[must_use]
    pub const fn at_distance(self, distance: u8) -> u32 {
        (self.bits >> (distance - 1) & 0x0101_0101).count_ones()
    }
}

/// The views of all cells, in tiles of the map. Snapshots share the memory of tiles that have not changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coverage(Arc<BTreeMap<Cell, Arc<[Views]>>>);

impl Coverage {
    #[must_use]
    pub fn at(&self, cell: Cell) -> Views {
        self.0.get(&tile_of(cell)).map_or(Views::default(), |tile| tile[place_in_tile(cell)])
    }

    /// Returns every cell that was looked at, with its views.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, Views)> {
        let tiles = self.0.iter();
        let corner = |at: &Cell| Cell::new(at.x * TILE, at.y * TILE);
        let cells = tiles.flat_map(move |(at, tile)| cells_of(corner(at)).zip(tile.iter().copied()));
        cells.filter(|(_, views)| views.bits != 0)
    }

    /// Notes a look from a cell to another in the same row or column. Looks from elsewhere or from too far do not count.
    pub(crate) fn look(&mut self, from: Cell, to: Cell, wall: WallTime) {
        let distance = from.x.abs_diff(to.x).max(from.y.abs_diff(to.y));
        let towards = |heading: &Heading| u16::try_from(distance).is_ok_and(|distance| from.onward(*heading, distance) == to);
        let Some(heading) = Heading::ALL.into_iter().find(towards) else { return };
        if (1..=u32::from(FURTHEST)).contains(&distance) {
            let minute = u32::try_from(wall.unix_ms / 60_000).unwrap_or(0);
            self.add(to, Views { bits: 1 << (heading as u32 * u32::from(FURTHEST) + distance - 1), minute });
        }
    }

    /// Adds views to those of a cell.
    pub fn add(&mut self, cell: Cell, views: Views) {
        let known = self.at(cell);
        let views = Views { bits: known.bits | views.bits, minute: known.minute.max(views.minute) };
        if views != known {
            let tiles = Arc::make_mut(&mut self.0);
            let empty = || vec![Views::default(); (TILE * TILE) as usize].into();
            Arc::make_mut(tiles.entry(tile_of(cell)).or_insert_with(empty))[place_in_tile(cell)] = views;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: WallTime = WallTime { unix_ms: 120_000, offset_s: 0 };

    #[test]
    fn a_view_from_the_same_place_counts_once_and_only_along_a_row_or_column() {
        let mut coverage = Coverage::default();
        let cell = Cell::new(40, -1);
        for from in [Cell::new(39, -1), Cell::new(39, -1), Cell::new(40, 2), Cell::new(48, -1), Cell::new(40, -9)] {
            coverage.look(from, cell, NOW);
        }
        let views = coverage.at(cell);
        assert_eq!((views.count(), views.nearest(), views.minute), (4, Some(1), 2));
        for from in [cell, Cell::new(49, -1), Cell::new(39, 0), Cell::new(i32::MIN, -1)] {
            coverage.look(from, cell, WallTime { unix_ms: 600_000, ..NOW });
        }
        assert_eq!(coverage.at(cell), views, "these are no views");
        assert_eq!(coverage.iter().collect::<Vec<_>>(), [(cell, views)]);
    }

    #[test]
    fn a_snapshot_keeps_its_coverage() {
        let mut coverage = Coverage::default();
        coverage.look(Cell::HOME, Cell::new(1, 0), NOW);
        let before = coverage.clone();
        coverage.look(Cell::HOME, Cell::new(0, 1), NOW);
        assert_eq!((before.iter().count(), coverage.iter().count()), (1, 2));
    }

    #[test]
    fn more_views_detect_more_and_an_unknown_sensor_says_nothing() {
        let sensor = Sensor { cells: 3, model: Some(SensorModel::SimCamera) };
        let near = Views { bits: 0b1, minute: 0 };
        let far = Views { bits: 0b100, minute: 0 };
        let both = Views { bits: 0b101, minute: 0 };
        let [near, far, both] = [near, far, both].map(|views| sensor.detection(views).expect("it is calibrated"));
        assert!(0.0 < far && far < near && near < both && both < 1.0, "{far} {near} {both}");
        assert!((1.0 - (1.0 - near) * (1.0 - far) - both).abs() < 1e-12, "the coverages add up");
        assert_eq!(sensor.detection(Views::default()), Some(0.0));
        assert_eq!(Sensor { model: None, ..sensor }.detection(Views { bits: 1, minute: 0 }), None);
    }
}
