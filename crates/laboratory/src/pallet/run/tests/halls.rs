//! Tests of the pair in unexplored halls. The same trees fetch a bag and bring it to the container outside. The
//! results are compared with a search that tries every way.

use std::collections::BTreeSet;

use super::super::*;
use super::slips;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::Heading;
use hallsweep_sim::{Hall, Truth};

/// A hall with one bag. The pair stands outside, and the container is at the entrance.
fn hall_with_bag(seed: u64, share: f64) -> Yard {
    let mut random = RandomStream::new(seed, "hall");
    let (columns, rows) = (5 + random.below(6), 4 + random.below(6));
    let bag = (random.below(columns - 2) + 1, random.below(rows - 1) + 1);
    let mark = |x: u64, y: u64, random: &mut RandomStream| match (x, y) {
        (0, 0) => 'S',
        at if at == bag => 'a',
        _ if random.happens(share) => '#',
        _ => '.',
    };
    let drawn: Vec<String> = (0..rows).map(|y| (0..columns).map(|x| mark(x, y, &mut random)).collect()).collect();
    let hall = Hall::from_rows("hall", &drawn.iter().map(String::as_str).collect::<Vec<_>>()).unwrap();
    let outside = BasePose { place: Place::ENTRANCE, heading: Heading::South };
    let parcels = hall.pieces().iter().map(|bag| (bag.piece, bag.cells[0])).collect();
    Yard { hall: Arc::new(hall), starts: [outside; 2], target: Place::ENTRANCE, way_out: true, parcels }
}

/// Whether the bag can be fetched at all. Every way of the two robots with the bag through the true hall is tried.
fn can_be_fetched(yard: &Yard) -> bool {
    let bag = Place::Cell(yard.parcels[0].1);
    let free = |place: &Place| match place {
        Place::Cell(cell) => yard.hall.truth(*cell) == Truth::Free || *place == bag,
        Place::Outside(_) => true,
    };
    // The cells that one base can reach alone while the other base stands at `other`.
    let reached = |other: Option<Place>| {
        let mut known = BTreeSet::from([Place::ENTRANCE]);
        let mut border = vec![Place::ENTRANCE];
        while let Some(place) = border.pop() {
            let next = place.neighbours(true).filter(|next| free(next) && *next != bag && Some(*next) != other);
            border.extend(next.filter(|next| known.insert(*next)));
        }
        known
    };
    let beside: Vec<Place> = bag.neighbours(true).filter(|place| free(place) && place.cell().is_some()).collect();
    let mut known: BTreeSet<[Place; 3]> = BTreeSet::new();
    for first in &beside {
        for second in beside.iter().filter(|second| *second != first) {
            if reached(None).contains(first) && reached(Some(*first)).contains(second) {
                known.extend([[*first, bag, *second], [*second, bag, *first]]);
            }
        }
    }
    let mut border: Vec<[Place; 3]> = known.iter().copied().collect();
    while let Some([one, parcel, two]) = border.pop() {
        if parcel == Place::ENTRANCE {
            return true;
        }
        let ahead = one.neighbours(true).filter(|to| free(to) && *to != parcel && *to != two).map(|to| [to, one, parcel]);
        let back = two.neighbours(true).filter(|to| free(to) && *to != parcel && *to != one).map(|to| [parcel, two, to]);
        border.extend(ahead.chain(back).filter(|train| known.insert(*train)).collect::<Vec<_>>());
    }
    false
}

#[test]
fn the_same_trees_fetch_a_bag_from_any_hall_where_there_is_a_way_and_name_the_fault_where_there_is_none() {
    let (mut fetched, mut faults) = (0, 0);
    for seed in 0..300 {
        let yard = hall_with_bag(seed, 0.22);
        let expected = can_be_fetched(&yard);
        let mut run = PalletRun::of(yard, seed, if seed % 3 == 0 { slips(&[(1, 1)]) } else { Asked::default() });
        let mut random = RandomStream::new(seed, "kills");
        let mut kills = 4;
        while run.advance(|_| {}) {
            if kills > 0 && random.happens(0.02) {
                kills -= 1;
                run.restart();
                run.start();
            }
        }
        let figures = run.figures();
        assert_eq!(figures.fault.is_none(), expected, "seed {seed}: {figures:?}");
        assert_eq!(figures.delivered == 1, expected, "seed {seed}");
        if expected { fetched += 1 } else { faults += 1 }
    }
    assert!(fetched > 100 && faults > 50, "{fetched} fetched, {faults} not");
}
