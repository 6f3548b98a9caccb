//! How far a hall and its named areas have been searched: the figures of every door, of the report and of the metrics.
//! They are counted when somebody asks, from the map and the coverage of a snapshot or of a past state.

use crate::state::{Reach, Venue};
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
        let searched = |area: &Area| (area.clone(), Searched::of(area, map, coverage, venue.sensor));
        // Unknown cells around the known ones may be outside the hall, so they count only if the hall is known beforehand.
        let Reach { reachable, free } = venue.reach.unwrap_or_default();
        let known_free = map.known().filter(|(_, mark)| mark.is_searched()).count();
        let (never_seen, unreachable) =
            ((reachable as usize).saturating_sub(known_free), free.saturating_sub(reachable) as usize);
        let hall = Searched { never_seen, unreachable, ..Searched::count(map.known(), coverage, venue.sensor) };
        SearchedHall { hall: hall.with_mean(), areas: venue.areas.iter().map(searched).collect() }
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

impl Searched {
    /// Counts the cells of one area. Only known cells are visited, because an area may be as large as the hall.
    #[must_use]
    pub fn of(area: &Area, map: &HallMap, coverage: &Coverage, sensor: Sensor) -> Searched {
        let columns = || area.rows().flat_map(|(y, columns)| columns.into_iter().map(move |columns| (y, columns)));
        let known = || columns().flat_map(|(y, columns)| map.known_in(y, columns));
        let unknown = columns().map(|(_, columns)| columns.count()).sum::<usize>() - known().count();
        let (never_seen, unreachable) = if map.unsearched() == 0 { (0, unknown) } else { (unknown, 0) };
        Searched { never_seen, unreachable, ..Searched::count(known(), coverage, sensor) }.with_mean()
    }

    /// Counts known cells. `detection` is the sum of their probabilities.
    fn count(cells: impl Iterator<Item = (Cell, Mark)>, coverage: &Coverage, sensor: Sensor) -> Searched {
        let mut searched = Searched { detection: sensor.model.map(|_| 0.0), ..Searched::default() };
        for (cell, mark) in cells {
            let mut views = coverage.at(cell);
            match mark {
                Mark::Wall if views.bits == 0 => continue,
                Mark::Visited => {
                    searched.driven += 1;
                    // The first cell has no view: the robot was put down there, which tells as much as driving into it.
                    views.bits = views.bits.max(1);
                }
                Mark::Unknown | Mark::Seen | Mark::Wall | Mark::Luggage | Mark::NotInspected => searched.seen_only += 1,
            }
            searched.detection = searched.detection.zip(sensor.detection(views)).map(|(sum, one)| sum + one);
        }
        searched
    }

    #[expect(clippy::cast_precision_loss, reason = "a hall has fewer cells than 2^53")]
    fn with_mean(self) -> Searched {
        let cells = self.cells();
        Searched { detection: self.detection.filter(|_| cells > 0).map(|sum| sum / cells as f64), ..self }
    }

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
