//! Named areas of a hall, each with the probability that the bomb is there. The hall file has the areas; the mission
//! records them with its conditions.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::closing::OpenInArea;
use crate::units::{Bounds, Cell};
use crate::words::is_visible;
use crate::world::hall_map::{HallMap, Mark};
use crate::world::records::LuggageRecords;

#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    pub name: Arc<str>,
    /// The probability that the bomb is in this area, from 0 to 1.
    pub probability: f64,
    /// Two opposite corners of a rectangle, or the corners of a polygon in order. Corners are cells of the area.
    pub corners: Arc<[Cell]>,
}

/// Why an area cannot be used. `check` says which area it is.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AreaFault {
    #[error("there are {0} areas: give at most {most}", most = Area::MOST)]
    TooMany(usize),
    #[error("the name of an area is one line of 1 to {most} visible characters", most = Area::NAME)]
    Name,
    #[error("an earlier area has the same name")]
    SameName,
    #[error("the probability is a number from 0 to 1")]
    Probability,
    #[error("the probabilities of the areas up to this one add up to more than 1")]
    Sum,
    #[error("the area has {0} corners: give {least} to {most}, two for a rectangle", least = Area::CORNERS.start(), most = Area::CORNERS.end())]
    Corners(usize),
    #[error("the corner {0} is outside the hall")]
    Outside(Cell),
    #[error("the cell {1} is in the area \"{0}\" too")]
    Overlap(Arc<str>, Cell),
}

impl Area {
    /// Maximum number of areas of a hall. It bounds the list on the page and the work of the search.
    pub const MOST: usize = 64;

    /// Minimum and maximum number of corners.
    pub const CORNERS: RangeInclusive<usize> = 2..=32;

    /// Maximum length of a name, in characters. A longer name does not fit in the list on the page.
    pub const NAME: usize = 40;

    /// Whether the text is one line of 1 to `NAME` visible characters, without blanks around it.
    #[must_use]
    pub fn is_name(text: &str) -> bool {
        (1..=Area::NAME).contains(&text.chars().count()) && text.trim() == text && text.chars().all(is_visible)
    }

    /// Returns what is open in the area, as the map shows it. `again` are the cells to be searched again.
    #[must_use]
    pub fn open(&self, map: &HallMap, again: &BTreeSet<Cell>, luggage: &LuggageRecords) -> OpenInArea {
        let is_open = |cell: &Cell| matches!(map.at(*cell), Mark::Unknown | Mark::NotInspected) || again.contains(cell);
        let has = |Cell { x, y }| columns(&self.outline(), y).iter().any(|columns| columns.contains(&x));
        let pending = luggage.pending().filter(|piece| has(piece.cell)).count();
        OpenInArea { cells: self.cells().filter(is_open).count(), pending }
    }

    /// Returns the cells whose centre is within the outline or on it, row by row.
    pub fn cells(&self) -> impl Iterator<Item = Cell> {
        self.rows().flat_map(|(y, columns)| columns.into_iter().flatten().map(move |x| Cell::new(x, y)))
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = (i32, Vec<RangeInclusive<i32>>)> {
        let outline = self.outline();
        let rows = outline.iter().map(|corner| corner.y);
        let rows = rows.clone().min().unwrap_or(0)..=rows.max().unwrap_or(-1);
        rows.map(move |y| (y, columns(&outline, y)))
    }

    fn outline(&self) -> Vec<Cell> {
        match *self.corners {
            [one, other] => vec![one, Cell::new(other.x, one.y), other, Cell::new(one.x, other.y)],
            _ => self.corners.to_vec(),
        }
    }

    /// Checks all areas of a hall.
    ///
    /// # Errors
    /// The first area with a fault.
    pub fn check(areas: &[Area], hall: Bounds) -> Result<(), (usize, AreaFault)> {
        if areas.len() > Area::MOST {
            return Err((Area::MOST, AreaFault::TooMany(areas.len())));
        }
        let (mut rows, mut sum) = (AreaRows::within(hall), 0.0);
        for (n, area) in areas.iter().enumerate() {
            let fault = |fault| Err((n, fault));
            if !Area::is_name(&area.name) {
                return fault(AreaFault::Name);
            }
            if areas[..n].iter().any(|other| other.name == area.name) {
                return fault(AreaFault::SameName);
            }
            if !(0.0..=1.0).contains(&area.probability) {
                return fault(AreaFault::Probability);
            }
            sum += area.probability;
            // Decimal fractions that add up to 1 may give a little more.
            if sum > 1.0 + 1e-9 {
                return fault(AreaFault::Sum);
            }
            if !Area::CORNERS.contains(&area.corners.len()) {
                return fault(AreaFault::Corners(area.corners.len()));
            }
            if let Some(corner) = area.corners.iter().find(|corner| !hall.contains(**corner)) {
                return fault(AreaFault::Outside(*corner));
            }
            if let Err((other, cell)) = rows.add(area, n) {
                return fault(AreaFault::Overlap(Arc::clone(&areas[other].name), cell));
            }
        }
        Ok(())
    }
}

/// The cells of numbered areas.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AreaRows {
    first: i32,
    /// For each row from `first` on, the columns of each area with its number.
    rows: Vec<Vec<(RangeInclusive<i32>, usize)>>,
}

impl AreaRows {
    pub(crate) fn within(bounds: Bounds) -> AreaRows {
        AreaRows { first: bounds.least.y, rows: vec![Vec::new(); usize::try_from(bounds.height()).unwrap_or(0)] }
    }

    /// Adds an area within the bounds. Returns the number of its cells. If another area has one of them, returns the
    /// number of that area, and the cell.
    pub(crate) fn add(&mut self, area: &Area, n: usize) -> Result<i32, (usize, Cell)> {
        let mut cells = 0;
        for (y, columns) in area.rows() {
            let row = &mut self.rows[usize::try_from(y - self.first).expect("the area is within the bounds")];
            for columns in columns {
                let (first, last) = (*columns.start(), *columns.end());
                let overlaps = |(other, _): &&(RangeInclusive<i32>, usize)| *other.start() <= last && first <= *other.end();
                if let Some((other, of)) = row.iter().find(overlaps) {
                    return Err((*of, Cell::new(first.max(*other.start()), y)));
                }
                cells += last - first + 1;
                row.push((columns, n));
            }
        }
        Ok(cells)
    }

    /// Returns the number of the area that has this cell; 0 if none has it.
    pub(crate) fn at(&self, cell: Cell) -> usize {
        let row = usize::try_from(cell.y - self.first).ok().and_then(|row| self.rows.get(row));
        row.into_iter().flatten().find(|(columns, _)| columns.contains(&cell.x)).map_or(0, |(_, n)| *n)
    }
}

/// Returns the columns of the row `y` that are within an outline or on it, in disjoint ranges.
fn columns(outline: &[Cell], y: i32) -> Vec<RangeInclusive<i32>> {
    let (mut crossings, mut columns) = (Vec::new(), Vec::new());
    for (n, from) in outline.iter().enumerate() {
        let to = outline[(n + 1) % outline.len()];
        let (low, high) = if from.y <= to.y { (*from, to) } else { (to, *from) };
        if !(low.y..=high.y).contains(&y) {
            continue;
        }
        if low.y == high.y {
            columns.push(low.x.min(high.x)..=low.x.max(high.x));
            continue;
        }
        let (rise, run) = (high.y - low.y, (y - low.y) * (high.x - low.x));
        let (floor, is_whole) = (low.x + run.div_euclid(rise), run.rem_euclid(rise) == 0);
        if is_whole {
            columns.push(floor..=floor);
        }
        if y < high.y {
            // The crossing lies between two columns, or on one.
            crossings.push((f64::from(low.x) + f64::from(run) / f64::from(rise), floor + i32::from(!is_whole), floor));
        }
    }
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
    columns.extend(crossings.chunks_exact(2).map(|pair| pair[0].1..=pair[1].2).filter(|inside| !inside.is_empty()));
    columns.sort_by_key(|range| *range.start());
    let mut merged: Vec<RangeInclusive<i32>> = Vec::new();
    for range in columns {
        match merged.last_mut().filter(|last| *range.start() <= *last.end() + 1) {
            Some(last) => *last = *last.start()..=*last.end().max(range.end()),
            None => merged.push(range),
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::RandomStream;

    const HALL: Bounds = Bounds { least: Cell::new(-2, -2), most: Cell::new(9, 9) };

    fn area(name: &str, probability: f64, corners: &[(i32, i32)]) -> Area {
        Area { name: name.into(), probability, corners: corners.iter().map(|(x, y)| Cell::new(*x, *y)).collect() }
    }

    fn drawn(corners: &[(i32, i32)]) -> Vec<String> {
        let cells: Vec<Cell> = area("a", 0.5, corners).cells().collect();
        (0..5).map(|y| (0..6).map(|x| if cells.contains(&Cell::new(x, y)) { 'x' } else { '.' }).collect()).collect()
    }

    #[test]
    fn an_area_has_the_cells_within_its_outline_and_on_it() {
        assert_eq!(drawn(&[(4, 2), (1, 1)]), ["......", ".xxxx.", ".xxxx.", "......", "......"]);
        assert_eq!(drawn(&[(0, 0), (4, 4), (0, 4)]), ["x.....", "xx....", "xxx...", "xxxx..", "xxxxx."]);
        assert_eq!(drawn(&[(2, 0), (4, 2), (2, 4), (0, 2)]), ["..x...", ".xxx..", "xxxxx.", ".xxx..", "..x..."]);
        assert_eq!(drawn(&[(0, 0), (5, 0), (5, 3), (3, 3), (3, 1), (0, 1)]), ["xxxxxx", "xxxxxx", "...xxx", "...xxx", "......"]);
        assert_eq!(drawn(&[(1, 1), (1, 3), (1, 2)]), ["......", ".x....", ".x....", ".x....", "......"], "a line");
    }

    /// Compares the cells of random polygons with the same polygons, moved and mirrored.
    #[test]
    fn the_cells_do_not_depend_on_place_or_direction() {
        let mut dice = RandomStream::new(1, "areas");
        for _ in 0..300 {
            let mut place = || i32::try_from(dice.below(12)).unwrap();
            let corners: Vec<Cell> = (0..5).map(|_| Cell::new(place(), place())).collect();
            let polygon = |corners: Vec<Cell>| Area { corners: corners.into(), ..area("a", 0.5, &[]) };
            let cells: Vec<Cell> = polygon(corners.clone()).cells().collect();
            assert!(cells.windows(2).all(|pair| (pair[0].y, pair[0].x) < (pair[1].y, pair[1].x)), "{corners:?}");
            assert!(corners.iter().all(|corner| cells.contains(corner)), "{corners:?}");
            let other = polygon(corners.iter().rev().map(|cell| Cell::new(-cell.x, cell.y - 20)).collect());
            let mut back: Vec<Cell> = other.cells().map(|cell| Cell::new(-cell.x, cell.y + 20)).collect();
            back.sort_by_key(|cell| (cell.y, cell.x));
            assert_eq!(cells, back, "{corners:?}");
        }
    }

    #[test]
    fn areas_that_cannot_be_used_are_refused_with_the_reason() {
        let check = |areas: &[Area], expect: &str| {
            let (n, fault) = Area::check(areas, HALL).expect_err(expect);
            assert_eq!(format!("{n}: {fault}"), expect);
        };
        let good = || area("gate 1", 0.6, &[(0, 0), (3, 3)]);
        assert_eq!(Area::check(&[good(), area("gate 2", 0.4, &[(4, 0), (4, 3)])], HALL), Ok(()));
        check(&[good(), area("b", 0.1, &[(3, 3), (5, 5)])], "1: the cell (3, 3) is in the area \"gate 1\" too");
        check(&[good(), area("b", 0.1, &[(3, 3), (10, 5)])], "1: the corner (10, 5) is outside the hall");
        check(
            &[good(), area("b", 0.5, &[(4, 4), (5, 5)])],
            "1: the probabilities of the areas up to this one add up to more than 1",
        );
        check(&[good(), area("gate 1", 0.1, &[(4, 4), (5, 5)])], "1: an earlier area has the same name");
        check(&[area("b", f64::NAN, &[(4, 4), (5, 5)])], "0: the probability is a number from 0 to 1");
        check(&[area("b", 0.5, &[(4, 4)])], "0: the area has 1 corners: give 2 to 32, two for a rectangle");
        for name in ["", " b", "b\n", &"x".repeat(41)] {
            check(&[area(name, 0.5, &[(4, 4), (5, 5)])], "0: the name of an area is one line of 1 to 40 visible characters");
        }
        check(&vec![good(); 10_000], "64: there are 10000 areas: give at most 64");
    }
}
