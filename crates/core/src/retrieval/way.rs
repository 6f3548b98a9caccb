//! Ways for the pair: ways of one base alone, ways of both bases with a parcel between them, and the places from
//! which they lift it. `steer` has the turns of a base. Other modules decide what happens if there is no way.
//!
//! ```text
//!   a train is led by one of its bases; the others follow, each to where the one before it was:
//!
//!   . . . . .                    . 1 . . .
//!   . 1 P 2 .   ─ 1 leads north ►  . P 2 . .
//! ```
//!
//! A search begins at the fixed place, which is mostly the end of the way. One search then answers for all places at
//! the other end. Unknown cells are assumed to be free, as in the search of the hall. A way through known cells is
//! preferred to a way that is a little shorter. A robot that meets an obstacle asks again.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use crate::place::Place;
use crate::units::Cell;
use crate::world::hall_map::{Bounds, HallMap, Mark};
use crate::world::keep_out::KeepOut;

/// The cost of a step into a cell in which no robot has been, as a multiple of other steps. A parcel that may explode
/// is carried round such cells, unless the detour is long.
const UNKNOWN: u32 = 5;

/// Number of cells that a way may lead beyond the known area. With this margin, a train has room to turn at any
/// corner of the area.
const MARGIN: i32 = 4;

#[derive(Clone, Copy, Debug)]
pub struct Floor<'a> {
    pub map: &'a HallMap,
    /// Whether a way leads from home to the places outside.
    pub way_out: bool,
    /// The cells of the piece, which are free once it is lifted.
    pub freed: &'a BTreeSet<Cell>,
    /// Places that no base may enter, because robots stand there.
    pub taken: &'a [Place],
    /// The rings of other bombs, which no base enters.
    pub kept_out: &'a KeepOut,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Train {
    /// The places of SRM1 and of SRM2. Both are beside the parcel, and they are not the same.
    pub bases: [Place; 2],
    pub parcel: Place,
}

impl Train {
    /// Returns the train after one base has led one step into a place, and the others have followed.
    fn step(self, leader: usize, to: Place) -> Train {
        let mut bases = [self.parcel; 2];
        bases[leader] = to;
        Train { bases, parcel: self.bases[leader] }
    }

    /// Returns the base that leads from this train to the next train, and the place to which it goes.
    #[must_use]
    pub fn leader(self, next: Train) -> (usize, Place) {
        let leader = usize::from(next.bases[1] != self.parcel);
        (leader, next.bases[leader])
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stands {
    /// The cell of the piece at which it is gripped and carried. Both bases stand beside this cell.
    pub grip: Cell,
    /// The cells of the two bases, in the order in which the bases were given.
    pub bases: [Cell; 2],
}

impl Floor<'_> {
    /// Returns the places on a base's way from `from` to `to`, without the first and with the last; `None` if there
    /// is no way.
    #[must_use]
    pub fn approach(&self, from: Place, to: Place) -> Option<Vec<Place>> {
        if from == to {
            return Some(Vec::new());
        }
        self.cost(to)?;
        let area = self.area([from, to]);
        let next = |here, steps: &mut Vec<_>| {
            steps.extend(self.next_places(area, here).map(|place| (place, self.cost(place).unwrap_or(1))));
        };
        self.costs_of_a_base(area, to, |place| place == from).way(area, from, |place| place == to, next)
    }

    /// Returns the places from which to lift a piece that covers these cells. Each base can get to its place from its
    /// place in `bases`, the first base first. Both can then carry the piece to `drop`, and the total way is the
    /// shortest. `None` if the known map has no such places.
    #[must_use]
    pub fn stands(&self, bases: [Place; 2], piece: &BTreeSet<Cell>, drop: Place) -> Option<Stands> {
        let area = self.area(bases.into_iter().chain([drop]).chain(piece.iter().copied().map(Place::Cell)));
        let carrying = self.costs_of_a_train(area, drop, |_| false);
        // Only a train may enter the cells of the piece. A single base may not.
        let standing = Floor { freed: &BTreeSet::new(), ..*self };
        let taken = self.taken_too(bases[1]);
        let first = Floor { taken: &taken, ..standing }.costs_of_a_base(area, bases[0], |_| false);
        let mut best: Option<(u32, Stands)> = None;
        for train in trains(piece).filter(|train| train.bases.iter().all(|base| standing.cost(*base).is_some())) {
            let (Some(approach), Some(way)) = (first.at(area, train.bases[0]), carrying.at(area, train)) else { continue };
            let sofar = approach.saturating_add(way);
            if best.is_some_and(|(least, _)| sofar >= least) {
                continue;
            }
            let taken = self.taken_too(train.bases[0]);
            let Some(second) = (Floor { taken: &taken, ..standing }).approach(bases[1], train.bases[1]) else { continue };
            let whole = sofar.saturating_add(u32::try_from(second.len()).unwrap_or(u32::MAX));
            let cells = [train.parcel, train.bases[0], train.bases[1]].map(Place::cell);
            if let [Some(grip), Some(one), Some(two)] = cells
                && best.is_none_or(|(least, _)| whole < least)
            {
                best = Some((whole, Stands { grip, bases: [one, two] }));
            }
        }
        best.map(|(_, stands)| stands)
    }

    /// Returns the trains on the way from this train to a train whose parcel is at `drop`, without the first; `None`
    /// if there is no way.
    #[must_use]
    pub fn carry(&self, train: Train, drop: Place) -> Option<Vec<Train>> {
        let area = self.area(train.bases.into_iter().chain([train.parcel, drop]));
        let next = |here: Train, steps: &mut Vec<_>| {
            let entered = |next: Train| self.cost(here.leader(next).1).unwrap_or(1);
            steps.extend(self.next_trains(area, here).map(|next| (next, entered(next))));
        };
        self.costs_of_a_train(area, drop, |one| one == train).way(area, train, |train| train.parcel == drop, next)
    }

    fn taken_too(&self, place: Place) -> Vec<Place> {
        let in_hall = place.cell().map(Place::Cell);
        self.taken.iter().copied().chain(in_hall).collect()
    }

    /// Returns the area of all known cells and the cells among these places, with a margin.
    fn area(&self, places: impl IntoIterator<Item = Place>) -> Bounds {
        let cells = places.into_iter().filter_map(Place::cell);
        cells.fold(self.map.known_bounds().including(Cell::HOME), Bounds::including).grown(MARGIN)
    }

    /// Returns the cost of a step to this place; `None` if nobody can enter it.
    fn cost(&self, place: Place) -> Option<u32> {
        let Place::Cell(cell) = place else { return self.way_out.then_some(1) };
        if self.taken.contains(&place) || self.kept_out.contains(cell) {
            return None;
        }
        match self.map.at(cell) {
            _ if self.freed.contains(&cell) => Some(1),
            Mark::Visited => Some(1),
            Mark::Unknown | Mark::Seen => Some(UNKNOWN),
            Mark::Wall | Mark::Luggage | Mark::NotInspected => None,
        }
    }

    fn next_places(&self, area: Bounds, place: Place) -> impl Iterator<Item = Place> {
        let inside = move |next: &Place| next.cell().is_none_or(|cell| area.contains(cell));
        place.neighbours(self.way_out).filter(inside).filter(|next| self.cost(*next).is_some())
    }

    /// Returns the trains one step away, with either base as the leader. No base enters a place of its own train, not
    /// even the place that the last base is just leaving.
    fn next_trains(&self, area: Bounds, train: Train) -> impl Iterator<Item = Train> {
        let clear = move |to: &Place| *to != train.parcel && !train.bases.contains(to);
        [0, 1].into_iter().flat_map(move |leader| {
            self.next_places(area, train.bases[leader]).filter(clear).map(move |to| train.step(leader, to))
        })
    }

    fn costs_of_a_base(&self, area: Bounds, to: Place, is_enough: impl Fn(Place) -> bool) -> Costs {
        Costs::search(area, [to], is_enough, |here, steps| {
            let entered = self.cost(here).unwrap_or(1);
            steps.extend(self.next_places(area, here).map(|place| (place, entered)));
        })
    }

    /// Searches from `drop` to all trains. A train can drive every step backwards, so each way that was found from
    /// `drop` can also be used towards `drop`.
    fn costs_of_a_train(&self, area: Bounds, drop: Place, is_enough: impl Fn(Train) -> bool) -> Costs {
        let free = |place: &Place| self.cost(*place).is_some();
        let beside: Vec<Place> = drop.neighbours(self.way_out).filter(free).collect();
        let pairs = beside.iter().flat_map(|one| beside.iter().map(move |two| [*one, *two])).filter(|[one, two]| one != two);
        let begin = pairs.filter(|_| free(&drop)).map(|bases| Train { bases, parcel: drop });
        Costs::search(area, begin, is_enough, |here: Train, steps| {
            steps.extend(self.next_trains(area, here).map(|train| (train, self.cost(train.leader(here).1).unwrap_or(1))));
        })
    }
}

fn trains(piece: &BTreeSet<Cell>) -> impl Iterator<Item = Train> {
    piece.iter().flat_map(move |grip| {
        let beside = move || grip.neighbours().into_iter().filter(|cell| !piece.contains(cell)).map(Place::Cell);
        let pairs = beside().flat_map(move |one| beside().map(move |two| [one, two])).filter(|[one, two]| one != two);
        pairs.map(|bases| Train { bases, parcel: Place::Cell(*grip) })
    })
}

trait Node: Copy {
    const SHARE: usize;
    fn number(self, area: Bounds) -> usize;
    fn of_number(number: usize, area: Bounds) -> Self;
}

const OUTSIDE: usize = Place::FURTHEST as usize;

/// Numbers the places outside first, then the cells row by row.
impl Node for Place {
    const SHARE: usize = 1;

    fn number(self, area: Bounds) -> usize {
        match self {
            Place::Outside(steps) => usize::from(steps.clamp(1, Place::FURTHEST)) - 1,
            Place::Cell(cell) => {
                let row = i64::from(cell.y - area.least.y) * i64::from(area.width());
                OUTSIDE + usize::try_from(row + i64::from(cell.x - area.least.x)).expect("the area holds the cell")
            }
        }
    }

    fn of_number(number: usize, area: Bounds) -> Place {
        let whole = i64::try_from(number).expect("the number of cells of an area fits into an i64");
        match whole - i64::from(Place::FURTHEST) {
            cell @ 0.. => {
                let width = i64::from(area.width());
                let narrow = |number: i64| i32::try_from(number).expect("a side of an area is an i32");
                Place::Cell(Cell::new(area.least.x + narrow(cell % width), area.least.y + narrow(cell / width)))
            }
            _ => Place::Outside(u8::try_from(number + 1).expect("the few places outside come first")),
        }
    }
}

/// Number of sides of a parcel on which a base can stand: the four directions, and outside the entrance one step
/// further from home or one step nearer.
const SIDES: usize = 6;
const OUTWARDS: usize = 4;
const INWARDS: usize = 5;

impl Node for Train {
    const SHARE: usize = SIDES * SIDES;

    fn number(self, area: Bounds) -> usize {
        let [one, two] = self.bases.map(|base| side(self.parcel, base));
        (self.parcel.number(area) * SIDES + one) * SIDES + two
    }

    fn of_number(number: usize, area: Bounds) -> Train {
        let parcel = Place::of_number(number / Train::SHARE, area);
        let bases = [number / SIDES % SIDES, number % SIDES].map(|side| at_side(parcel, side));
        Train { bases, parcel }
    }
}

/// Returns the side of `of` on which `other` is, with the numbers of `SIDES`.
fn side(of: Place, other: Place) -> usize {
    match (of, other) {
        (Place::Cell(of), Place::Cell(other)) => of.neighbours().iter().position(|cell| *cell == other).unwrap_or(0),
        (Place::Cell(_), Place::Outside(_)) => OUTWARDS,
        (Place::Outside(of), Place::Outside(other)) if other > of => OUTWARDS,
        (Place::Outside(_), Place::Cell(_) | Place::Outside(_)) => INWARDS,
    }
}

fn at_side(of: Place, side: usize) -> Place {
    match of {
        Place::Cell(cell) => cell.neighbours().get(side).map_or(Place::ENTRANCE, |cell| Place::Cell(*cell)),
        Place::Outside(steps) if side == OUTWARDS => Place::Outside(steps + 1),
        Place::Outside(1) => Place::Cell(Cell::HOME),
        Place::Outside(steps) => Place::Outside(steps.saturating_sub(1)),
    }
}

/// The lowest cost from every place, or every train, of an area back to the beginning of a search.
struct Costs(Vec<u32>);

impl Costs {
    const NONE: u32 = u32::MAX;

    /// Searches from `begin`, and stops at the first node for which `is_enough` holds. The costs from that node back
    /// to `begin` are then known. `next` adds the steps from a node.
    fn search<N: Node>(
        area: Bounds,
        begin: impl IntoIterator<Item = N>,
        is_enough: impl Fn(N) -> bool,
        next: impl Fn(N, &mut Vec<(N, u32)>),
    ) -> Costs {
        let cells = i64::from(area.width()) * i64::from(area.height());
        let places = usize::try_from(cells).expect("an area has a positive size") + OUTSIDE;
        let mut costs = vec![Costs::NONE; places * N::SHARE];
        let (mut open, mut steps) = (BinaryHeap::new(), Vec::new());
        for node in begin {
            costs[node.number(area)] = 0;
            open.push(Reverse((0, node.number(area))));
        }
        while let Some(Reverse((cost, number))) = open.pop() {
            if costs[number] != cost {
                continue;
            }
            let here = N::of_number(number, area);
            if is_enough(here) {
                break;
            }
            next(here, &mut steps);
            for (node, step) in steps.drain(..) {
                let (whole, known) = (cost.saturating_add(step), &mut costs[node.number(area)]);
                if whole < *known {
                    *known = whole;
                    open.push(Reverse((whole, node.number(area))));
                }
            }
        }
        Costs(costs)
    }

    fn at<N: Node>(&self, area: Bounds, node: N) -> Option<u32> {
        self.0.get(node.number(area)).copied().filter(|cost| *cost != Costs::NONE)
    }

    /// Returns the way from `from` to a beginning of the search. It always takes the node with the lowest cost,
    /// including the step to that node.
    fn way<N: Node>(
        &self,
        area: Bounds,
        from: N,
        is_end: impl Fn(N) -> bool,
        next: impl Fn(N, &mut Vec<(N, u32)>),
    ) -> Option<Vec<N>> {
        let (mut way, mut here, mut steps) = (Vec::new(), from, Vec::new());
        self.at(area, from)?;
        while !is_end(here) {
            let rest = |node: N, step: u32| self.at(area, node).map_or(Costs::NONE, |rest| rest.saturating_add(step));
            next(here, &mut steps);
            (here, _) = steps.drain(..).min_by_key(|(node, step)| rest(*node, *step))?;
            way.push(here);
        }
        Some(way)
    }
}

#[cfg(test)]
#[path = "way_tests.rs"]
mod tests;
