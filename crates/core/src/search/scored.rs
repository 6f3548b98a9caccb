//! The tuned score. It chooses the unknown cell with the lowest sum of the way there and the worth of its
//! surroundings. The weights come from `hallsweep-evaluation tune`.

use super::costs::in_thousandths;
use super::entries::{CellEntry, Visit, best_entry};
use super::outlook::{Looking, Outlook};
use super::view::View;
use super::ways::Ways;
use super::weights::Weights;
use crate::command::Move;
use crate::units::{Cell, Heading};

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    let weights = Weights::shipped(view.terms, view.grid.census().terrain());
    let looking = Looking::of(view);
    best_entry(view, ways, weights.least, |entry| weights.worth(&looking.at(entry)))
}

#[derive(Clone, Debug)]
pub struct Candidate {
    pub cell: Cell,
    pub heading: Heading,
    /// The cost of the way plus the worth of the surroundings, in thousandths of a step.
    pub score: i32,
    pub outlook: Outlook,
}

/// Returns the entry with the lowest score by these weights, and the moves that enter it. `seen` is called for every
/// entry that was weighed. These include all entries with a score up to `slack` above the lowest score.
pub fn choose(
    view: &View<'_>,
    ways: &mut Ways,
    weights: &Weights,
    slack: i32,
    mut seen: impl FnMut(Candidate),
) -> Option<(Cell, Vec<Move>)> {
    let looking = Looking::of(view);
    let visit = best_entry(view, ways, weights.least.saturating_sub(slack), |entry: &CellEntry| {
        let outlook = looking.at(entry);
        let worth = weights.worth(&outlook);
        let score = in_thousandths(entry.at.cost) + worth;
        seen(Candidate { cell: view.grid.cell(entry.target), heading: entry.at.heading, score, outlook });
        worth
    });
    visit.map(|Visit { cell, route }| (cell, route))
}

pub fn visit(view: &View<'_>, ways: &mut Ways, candidate: &Candidate) -> Option<(Cell, Vec<Move>)> {
    let mut found = false;
    let at = view.grid.spot(candidate.cell.ahead(candidate.heading.opposite()));
    ways.spread(view.grid, view.terms.costs, view.pose, |here| {
        found |= here.spot == at && here.heading == candidate.heading;
        if found { 0 } else { u32::MAX }
    });
    let mut route = found.then(|| ways.way_to(view.grid, (at, candidate.heading)))?;
    route.push(Move::Forward);
    Some((candidate.cell, route))
}
