//! The areas of a hall, as a search needs them: the area of each cell, the order, and the areas that are closed. A
//! *region* is an area, or the rest of the hall. `focus` chooses the regions that are searched next.

use std::sync::Arc;

use super::forecast::Extent;
use super::grid::Grid;
use crate::units::{Bounds, Cell};
use crate::world::areas::{Area, AreaRows};
use crate::world::coverage::{FURTHEST, Sensor, Views};

/// What a search needs to know about areas.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaPlan {
    /// Probability and number of cells of the rest and of each area. The size of the rest is not known.
    pub(super) regions: Vec<(f64, f64)>,
    /// The cells of each area, with its number in `regions`.
    pub(super) rows: AreaRows,
    pub(crate) bounds: Bounds,
    /// The areas that a person wants searched first.
    pub(super) order: Vec<usize>,
    /// One bit for each region that is not closed.
    pub(super) open: u128,
    /// The probability that a look from afar misses a piece.
    pub(super) missed: f64,
}

/// The regions from which a strategy may choose.
#[derive(Clone, Copy, Debug)]
pub struct Focus<'a> {
    pub(super) plan: &'a AreaPlan,
    pub(super) wanted: u128,
}

impl AreaPlan {
    /// Returns `None` if there are no areas.
    #[must_use]
    pub fn new(areas: &[Area], order: &[Arc<str>], is_closed: impl Fn(&str) -> bool, sensor: Sensor) -> Option<AreaPlan> {
        let mut corners = areas.iter().flat_map(|area| area.corners.iter().copied());
        let bounds = corners.next().map(Bounds::of)?;
        let bounds = corners.fold(bounds, Bounds::including);
        let (mut rows, mut regions, mut open) = (AreaRows::within(bounds), vec![(1.0, 0.0)], 1);
        for (n, area) in (1..).zip(areas) {
            let cells = rows.add(area, n).expect("the areas of a hall are checked when they are read");
            regions[0].0 = f64::max(regions[0].0 - area.probability, 0.0);
            regions.push((area.probability, f64::from(cells)));
            open |= u128::from(!is_closed(&area.name)) << n;
        }
        let place = |name: &Arc<str>| areas.iter().position(|area| area.name == *name).map(|n| n + 1);
        let order = order.iter().filter_map(place).filter(|n| open >> n & 1 == 1).collect();
        let afar = Views { bits: 1 << (sensor.cells.clamp(1, FURTHEST) - 1), minute: 0 };
        let missed = sensor.detection(afar).map_or(0.0, |detection| 1.0 - detection);
        Some(AreaPlan { regions, rows, bounds, order, open, missed })
    }

    #[must_use]
    pub const fn focus(&self) -> Focus<'_> {
        Focus { plan: self, wanted: self.open }
    }

    #[must_use]
    pub fn is_closed(&self, cell: Cell) -> bool {
        self.open >> self.rows.at(cell) & 1 == 0
    }

    /// The probability that the bomb is in this cell of a hall.
    #[must_use]
    pub fn probability(&self, cell: Cell, hall: Bounds) -> f64 {
        let (probability, cells) = self.regions[self.rows.at(cell)];
        probability / if cells > 0.0 { cells } else { self.rest(hall).max(1.0) }
    }

    /// Number of cells of the rest of a hall.
    fn rest(&self, hall: Bounds) -> f64 {
        let areas = self.regions.iter().map(|(_, cells)| cells).sum::<f64>();
        f64::from(hall.width()) * f64::from(hall.height()) - areas
    }

    /// The probability that the bomb is in one cell of each region, before the search.
    pub(super) fn densities(&self, grid: &Grid) -> Vec<f64> {
        let mut densities: Vec<f64> = self.regions.iter().map(|(probability, cells)| probability / cells).collect();
        let highest = (1..densities.len()).filter(|n| self.open >> n & 1 == 1).map(|n| densities[n]).fold(0.0, f64::max);
        let Extent { inside, is_closed, .. } = Extent::of(grid);
        let hall = inside.including(self.bounds.least).including(self.bounds.most);
        let (size, hall) = (self.rest(hall), f64::from(hall.width()) * f64::from(hall.height()));
        // A small rest may be only walls, and while the ends of the hall are not known, each side may be twice as long.
        // Within this uncertainty, the rest counts as being as dense as the densest area.
        densities[0] = if size < hall / 20.0 {
            highest
        } else {
            let most = if is_closed { size } else { size + 3.0 * hall };
            highest.clamp(self.regions[0].0 / most, self.regions[0].0 / size)
        };
        densities
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::RandomStream;

    fn area(name: &str, probability: f64, corners: &[(i32, i32)]) -> Area {
        Area { name: name.into(), probability, corners: corners.iter().map(|(x, y)| Cell::new(*x, *y)).collect() }
    }

    fn plan(areas: &[Area], sensor: Sensor) -> AreaPlan {
        AreaPlan::new(areas, &[], |_| false, sensor).expect("there are areas")
    }

    #[test]
    fn each_cell_is_in_the_area_that_has_it() {
        let mut dice = RandomStream::new(1, "regions");
        for _ in 0..200 {
            let mut corner = |x: i32| (x + i32::try_from(dice.below(9)).unwrap(), i32::try_from(dice.below(20)).unwrap() - 10);
            let west = area("west", 0.2, &[corner(-9), corner(-9), corner(-9), corner(-9), corner(-9)]);
            let east = area("east", 0.3, &[corner(0), corner(0)]);
            let plan = plan(&[west.clone(), east.clone()], Sensor::default());
            let all = (-12..12).flat_map(|y| (-12..12).map(move |x| Cell::new(x, y)));
            for cell in all {
                let has = |area: &Area| area.cells().any(|of| of == cell);
                let region = if has(&west) { 1 } else { 2 * usize::from(has(&east)) };
                assert_eq!(plan.rows.at(cell), region, "{cell} of {west:?} and {east:?}");
            }
            let sizes = [&west, &east].map(|area| area.cells().count());
            assert_eq!([1, 2].map(|n| plan.regions[n].1 as usize), sizes);
        }
    }
}
