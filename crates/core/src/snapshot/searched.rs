//! How far a hall and its named areas have been searched: the figures of every door, of the report and of the metrics.
//! They are counted when somebody asks, from the map and the coverage of a snapshot or of a past state.

use crate::state::{PersistentState, Reach, Venue};
use crate::units::Cell;
use crate::world::areas::Area;
use crate::world::coverage::{Coverage, Sensor};
use crate::world::hall_map::{HallMap, Mark};

/// The figures of a hall.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchedHall {
    /// The whole hall. Cells that the robot has not seen are counted only if the hall is known beforehand.
    pub hall: Searched,
    /// The named areas, in the order of the hall file.
    pub areas: Vec<(Area, Searched)>,
}

/// Numbers of cells, by how they were searched. Walls that were only seen along their line are not counted, because no
/// piece of luggage can be there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Searched {
    pub driven: usize,
    /// Cells in which the robot was not, but into which it has looked. Obstacles are among them.
    pub seen_only: usize,
    /// Unknown cells, while the search may still reach some.
    pub never_seen: usize,
    /// Cells that are still unknown when everything that can be reached was searched.
    pub unreachable: usize,
    /// The probability that the search has found a piece that is in one of these cells, each being as likely. `None` if
    /// the sensor is not calibrated.
    pub detection: Option<f64>,
}

impl SearchedHall {
    /// Counts the cells. The work grows with the number of known cells.
    #[must_use]
    pub fn of(map: &HallMap, coverage: &Coverage, venue: &Venue) -> SearchedHall {
        let is_over = map.unsearched() == 0;
        let areas = venue.areas.iter().map(|area| {
            let mut count = Count::new(coverage, venue.sensor);
            let mut cells = 0;
            for (y, columns) in area.rows() {
                for columns in columns {
                    cells += columns.clone().count();
                    map.known_in(y, columns).for_each(|(cell, mark)| count.add(cell, mark));
                }
            }
            let unknown = cells - count.known;
            (area.clone(), if is_over { count.finish(0, unknown) } else { count.finish(unknown, 0) })
        });
        let areas: Vec<(Area, Searched)> = areas.collect();
        let mut count = Count::new(coverage, venue.sensor);
        map.known().for_each(|(cell, mark)| count.add(cell, mark));
        // Unknown cells around the known ones may be outside the hall, so they count only if the hall is known beforehand.
        let Reach { reachable, free } = venue.reach.unwrap_or_default();
        let never_seen = (reachable as usize).saturating_sub(count.free);
        SearchedHall { hall: count.finish(never_seen, free.saturating_sub(reachable) as usize), areas }
    }

    /// The probability that the search has found the bomb so far: the sum of each area's probability times its
    /// probability of detection, and the same for the rest of the hall. `None` if there are no areas, or if the sensor is
    /// not calibrated.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a hall has fewer cells than 2^53")]
    pub fn success(&self) -> Option<f64> {
        let detected = |searched: &Searched| Some(searched.detection? * searched.cells() as f64);
        let (mut success, mut left, mut cells, mut sum) = (0.0, 1.0, self.hall.cells(), detected(&self.hall)?);
        for (area, searched) in &self.areas {
            success += area.probability * searched.detection?;
            left -= area.probability;
            cells = cells.saturating_sub(searched.cells());
            sum -= detected(searched)?;
        }
        let rest = (sum / cells.max(1) as f64).clamp(0.0, 1.0);
        (!self.areas.is_empty()).then_some(success + left.max(0.0) * rest)
    }
}

/// A count of known cells.
struct Count<'a> {
    coverage: &'a Coverage,
    sensor: Sensor,
    driven: usize,
    seen_only: usize,
    known: usize,
    /// Cells that were found to be free.
    free: usize,
    /// Sum of the probabilities of detection.
    detection: Option<f64>,
}

impl<'a> Count<'a> {
    fn new(coverage: &'a Coverage, sensor: Sensor) -> Count<'a> {
        Count { coverage, sensor, driven: 0, seen_only: 0, known: 0, free: 0, detection: sensor.model.map(|_| 0.0) }
    }

    fn add(&mut self, cell: Cell, mark: Mark) {
        let mut views = self.coverage.at(cell);
        if mark == Mark::Visited && views.bits == 0 {
            // The robot was put down here. That tells as much as driving into the cell.
            views.bits = 1;
        }
        self.known += 1;
        self.free += usize::from(mark.is_searched());
        match mark {
            Mark::Wall if views.bits == 0 => return,
            Mark::Visited => self.driven += 1,
            Mark::Unknown | Mark::Seen | Mark::Wall | Mark::Luggage | Mark::NotInspected => self.seen_only += 1,
        }
        self.detection = self.detection.zip(self.sensor.detection(views)).map(|(sum, one)| sum + one);
    }

    #[expect(clippy::cast_precision_loss, reason = "a hall has fewer cells than 2^53")]
    fn finish(self, never_seen: usize, unreachable: usize) -> Searched {
        let Count { driven, seen_only, detection, .. } = self;
        let searched = Searched { driven, seen_only, never_seen, unreachable, detection: None };
        let mean = |sum: f64| sum / searched.cells() as f64;
        Searched { detection: detection.filter(|_| searched.cells() > 0).map(mean), ..searched }
    }
}

impl From<&PersistentState> for SearchedHall {
    fn from(state: &PersistentState) -> SearchedHall {
        SearchedHall::of(&state.map, &state.coverage, &state.venue())
    }
}

impl Searched {
    /// Number of all counted cells.
    #[must_use]
    pub const fn cells(&self) -> usize {
        self.driven + self.seen_only + self.never_seen + self.unreachable
    }

    /// Returns the numbers of cells by kind, each with its name.
    #[must_use]
    pub const fn parts(&self) -> [(&'static str, usize); 4] {
        [("driven", self.driven), ("seenOnly", self.seen_only), ("neverSeen", self.never_seen), ("unreachable", self.unreachable)]
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::units::{Revision, WallTime};
    use crate::world::coverage::{Sensor, SensorModel};

    /// `.` visited, `s` seen, `#` wall that was looked at, `|` wall along its line, `b` luggage. The first cell is home.
    fn drawn(rows: &[&str]) -> (HallMap, Coverage) {
        let (mut map, mut coverage) = (HallMap::new(Cell::HOME, Revision(1)), Coverage::default());
        for (y, row) in (0..).zip(rows) {
            for (x, letter) in (0..).zip(row.chars()) {
                let mark = match letter {
                    '.' => Mark::Visited,
                    's' => Mark::Seen,
                    '#' | '|' => Mark::Wall,
                    'b' => Mark::Luggage,
                    _ => continue,
                };
                let cell = Cell::new(x, y);
                map.mark(cell, mark, Revision(1));
                if letter != '|' {
                    coverage.look(cell.ahead(crate::units::Heading::West), cell, WallTime { unix_ms: 0, offset_s: 0 });
                }
            }
        }
        (map, coverage)
    }

    /// The name of an area, its probability, and two opposite corners.
    type Drawn = (&'static str, f64, [(i32, i32); 2]);

    fn venue(model: Option<SensorModel>, areas: &[Drawn]) -> Venue {
        let area = |(name, probability, corners): &Drawn| Area {
            name: (*name).into(),
            probability: *probability,
            corners: corners.iter().map(|(x, y)| Cell::new(*x, *y)).collect(),
        };
        Venue { areas: areas.iter().map(area).collect(), sensor: Sensor { cells: 0, model }, ..Venue::default() }
    }

    #[test]
    fn every_cell_of_an_area_is_counted_once_by_how_it_was_searched() {
        let (map, coverage) = drawn(&["..s?", ".#b?", "..||", "..|?|", "||||"]);
        let venue = venue(Some(SensorModel::SimCamera), &[("west", 0.5, [(0, 0), (1, 3)]), ("east", 0.25, [(2, 0), (3, 3)])]);
        let searched = SearchedHall::of(&map, &coverage, &venue);
        let [(_, west), (_, east)] = &*searched.areas else { panic!("there are two areas") };
        assert_eq!(west.parts().map(|(_, cells)| cells), [7, 1, 0, 0]);
        assert_eq!(east.parts().map(|(_, cells)| cells), [0, 2, 3, 0], "the search is not over");
        let once = venue.sensor.detection(coverage.at(Cell::new(1, 0)));
        assert!(west.detection.zip(once).is_some_and(|(west, once)| (west - once).abs() < 1e-12));
        assert!(east.detection.zip(once).is_some_and(|(east, once)| (east - once * 2.0 / 5.0).abs() < 1e-12));
        let success = searched.success().zip(once).map(|(success, once)| success - once * (0.5 + 0.25 * 0.4));
        assert!(success.is_some_and(|off| off.abs() < 1e-12));
        assert_eq!(searched.hall.parts().map(|(_, cells)| cells), [7, 3, 0, 0], "the rest may be outside the hall");
        let (mut over, mut venue) = (map.clone(), venue);
        for cell in over.frontier().collect::<Vec<_>>() {
            over.mark(cell, Mark::Wall, Revision(2));
        }
        let searched = SearchedHall::of(&over, &coverage, &venue);
        assert_eq!(searched.areas[1].1.parts().map(|(_, cells)| cells), [0, 2, 0, 3], "nothing more can be reached");
        venue.areas = Arc::new([Area { probability: 1.0, ..venue.areas[0].clone() }]);
        assert_eq!(SearchedHall::of(&map, &coverage, &venue).success(), searched.areas[0].1.detection);
        let known = Venue { reach: Some(Reach { reachable: 12, free: 15 }), ..venue };
        let searched = SearchedHall::of(&map, &coverage, &known);
        assert_eq!(searched.hall.parts().map(|(_, cells)| cells), [7, 3, 4, 3]);
    }

    #[test]
    fn a_sensor_that_is_not_calibrated_and_an_area_without_cells_have_no_probability() {
        let (map, coverage) = drawn(&["..||"]);
        let unknown = SearchedHall::of(&map, &coverage, &venue(None, &[("a", 0.5, [(0, 0), (1, 0)])]));
        assert_eq!((unknown.hall.detection, unknown.areas[0].1.detection, unknown.success()), (None, None, None));
        let walls = venue(Some(SensorModel::SimCamera), &[("a", 0.5, [(2, 0), (3, 0)])]);
        let walls = SearchedHall::of(&map, &coverage, &walls);
        assert_eq!((walls.areas[0].1, walls.success()), (Searched::default(), None));
    }

    #[test]
    fn an_area_that_nobody_has_come_near_was_never_seen() {
        let (map, coverage) = drawn(&["."]);
        let venue = venue(None, &[("far", 1.0, [(50, 50), (59, 59)])]);
        let searched = SearchedHall::of(&map, &coverage, &venue);
        assert_eq!(searched.areas[0].1, Searched { never_seen: 100, ..Searched::default() });
    }
}
