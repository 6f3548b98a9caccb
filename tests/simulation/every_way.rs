//! Whether a pair can fetch a piece, found by exhaustive search in the true hall: both bases move step by step to
//! where they can lift the piece, then the train moves to the container. This search shares no code with that of the
//! pair.
//!
//! Assumptions: a base fills one cell. To lift, each base stands on its own free cell beside the same cell of the
//! piece. When loaded, base, parcel and base follow one another like a train. Pair and container wait before home.

use std::collections::HashSet;

use hallsweep_core::units::{Cell, Piece};
use hallsweep_sim::{Hall, Truth};

/// Place of a base or of the parcel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Spot {
    In(i32, i32),
    /// The place before the entrance, and the place beyond it, where the leading base stands when the parcel is
    /// before the entrance.
    Before,
    Beyond,
}

const HOME: Spot = Spot::In(0, 0);

struct Search<'a> {
    hall: &'a Hall,
    piece: Piece,
    /// Whether the piece is off the floor.
    lifted: bool,
}

/// Whether the pair can reach the piece and bring it to the container.
pub(crate) fn can_be_fetched(hall: &Hall, piece: Piece) -> bool {
    let standing = Search { hall, piece, lifted: false };
    let lifted = Search { hall, piece, lifted: true };
    let stands = standing.stands();
    let begin = hall.pieces().iter().filter(|bag| bag.piece == piece).flat_map(|bag| bag.cells.iter()).flat_map(|grip| {
        let beside = beside(Spot::In(grip.x, grip.y));
        let both = |[one, two]: &[Spot; 2]| one != two && beside.contains(one) && beside.contains(two);
        stands.iter().filter(|pair| both(pair)).map(|[one, two]| [*one, Spot::In(grip.x, grip.y), *two]).collect::<Vec<_>>()
    });
    lifted.arrives(begin.collect())
}

impl Search<'_> {
    fn is_free(&self, spot: Spot) -> bool {
        let Spot::In(x, y) = spot else { return true };
        match self.hall.truth(Cell::new(x, y)) {
            Truth::Free => true,
            Truth::Wall => false,
            Truth::Luggage(piece) => self.lifted && piece == self.piece,
        }
    }

    fn next(&self, spot: Spot) -> impl Iterator<Item = Spot> {
        beside(spot).into_iter().filter(|next| self.is_free(*next))
    }

    /// Every pair of places that the two bases can reach; each step moves one base.
    fn stands(&self) -> HashSet<[Spot; 2]> {
        let mut known = HashSet::from([[Spot::Before; 2]]);
        let mut border = vec![[Spot::Before; 2]];
        while let Some([one, two]) = border.pop() {
            let steps = self.next(one).map(|to| [to, two]).chain(self.next(two).map(|to| [one, to]));
            let apart = |[one, two]: &[Spot; 2]| one != two || !matches!(one, Spot::In(..));
            let fresh: Vec<_> = steps.filter(apart).filter(|pair| !known.contains(pair)).collect();
            border.extend(fresh.into_iter().filter(|pair| known.insert(*pair)));
        }
        known
    }

    /// Whether any of these trains can bring its parcel to the container; either end may lead.
    fn arrives(&self, begin: Vec<[Spot; 3]>) -> bool {
        let mut known: HashSet<[Spot; 3]> = begin.iter().copied().collect();
        let mut border = begin;
        while let Some(train) = border.pop() {
            let [one, parcel, two] = train;
            if parcel == Spot::Before {
                return true;
            }
            let ahead = self.next(one).map(|to| [to, one, parcel]);
            let back = self.next(two).map(|to| [parcel, two, to]);
            let clear = |next: &[Spot; 3]| !train.contains(&next[0]) || !train.contains(&next[2]);
            border.extend(ahead.chain(back).filter(clear).filter(|next| known.insert(*next)).collect::<Vec<_>>());
        }
        false
    }
}

fn beside(spot: Spot) -> Vec<Spot> {
    match spot {
        Spot::In(x, y) => [(x, y - 1), (x + 1, y), (x, y + 1), (x - 1, y)]
            .map(|(x, y)| Spot::In(x, y))
            .into_iter()
            .chain((spot == HOME).then_some(Spot::Before))
            .collect(),
        Spot::Before => vec![HOME, Spot::Beyond],
        Spot::Beyond => vec![Spot::Before],
    }
}

#[test]
fn what_can_be_fetched_is_found_by_trying() {
    for (rows, expected, why) in [
        (&["S..", ".a.", "..."][..], true, "there is room all round"),
        (&["S.", ".a"], true, "it is lifted from the two open sides of its corner"),
        (&["S.", "a."], true, "one of them stands at home"),
        (&["Sa."], false, "nobody comes behind it"),
        (&["S...", "###.", "..a."], false, "it stands in the only way to its other side"),
        (&["S...", "....", "#aa#", "#..#"], false, "each of its cells has one open side that can be come to"),
        (&["S...", "....", ".aa#", "#..#"], true, "one of its cells has two"),
        (&["S...", "...T", "..Ta"], false, "other luggage stands round it"),
        (&["###..", "#S...", "#.T.b", "#...."], true, "home is in the middle"),
    ] {
        let hall = Hall::from_rows("drawn", rows).unwrap();
        let last = hall.pieces().last().unwrap().piece;
        assert_eq!(can_be_fetched(&hall, last), expected, "{why}: {rows:?}");
    }
}
