//! The rows of the table in `docs/search.md`. Each has its halls, task and measure.

use hallsweep_core::search::Objective;
use hallsweep_core::search::costs::Costs;

use super::{Contest, Halls, Kind, Measure, Timings};
use crate::family::Family;
use hallsweep_core::search::Terms;

const STEPS: Costs = Costs { turn: 0, bump: 0 };

#[derive(Clone, Debug)]
pub struct Row {
    pub contest: Contest,
    pub measure: Measure,
}

#[must_use]
pub fn rows(count: usize, seed: u64, timings: Timings) -> Vec<Row> {
    let of = |family, (columns, lines): (usize, usize)| Halls::Random { kind: Kind { family, columns, lines }, count, seed };
    let covers = [
        (Family::Luggage(0.0), (10, 8)),
        (Family::Luggage(0.1), (20, 20)),
        (Family::Luggage(0.05), (50, 50)),
        (Family::Luggage(0.1), (50, 50)),
        (Family::Luggage(0.2), (50, 50)),
        (Family::Walls, (50, 50)),
        (Family::Islands, (50, 50)),
        (Family::Luggage(0.1), (100, 100)),
    ];
    let terms = |objective, sonar_cells, costs| Terms { objective, sonar_cells, costs };
    let cover = |sonar_cells, costs| terms(Objective::Cover, sonar_cells, costs);
    let find = |sonar_cells| terms(Objective::Find, sonar_cells, Costs::EVEN);
    let usual = || of(Family::Luggage(0.1), (50, 50));
    let row = |halls, terms, measure| Row { contest: Contest { halls, terms, timings }, measure };
    let covers = covers.map(|(family, size)| row(of(family, size), cover(0, Costs::EVEN), Measure::MovesPerCell));
    let others = [
        row(usual(), cover(1, Costs::EVEN), Measure::MovesPerCell),
        row(usual(), cover(3, Costs::EVEN), Measure::MovesPerCell),
        row(of(Family::Luggage(0.1), (20, 20)), cover(0, STEPS), Measure::StepsOverBound),
        row(usual(), find(0), Measure::ToAPiece),
        row(usual(), find(1), Measure::ToAPiece),
        row(usual(), find(3), Measure::ToAPiece),
    ];
    covers.into_iter().chain(others).collect()
}
