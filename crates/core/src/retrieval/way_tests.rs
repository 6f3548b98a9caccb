//! Tests of the ways of the pair, with drawings and against an independent search.

use std::collections::{BTreeSet, VecDeque};

use super::*;
use crate::rng::RandomStream;
use crate::units::Revision;
use crate::world::keep_out::NOWHERE;

/// A hall from a drawing: `.` is visited, `?` unknown, `#` wall, `b` the piece, `o` another piece. The first cell is
/// (0, 0), home.
struct Drawn {
    map: HallMap,
    piece: BTreeSet<Cell>,
}

fn draw(rows: &[&str]) -> Drawn {
    let mut drawn = Drawn { map: HallMap::new(Cell::HOME, Revision(1)), piece: BTreeSet::new() };
    for (y, row) in (0..).zip(rows) {
        for (x, letter) in (0..).zip(row.chars()) {
            let mark = match letter {
                '.' => Mark::Visited,
                '#' => Mark::Wall,
                'b' | 'o' => Mark::Luggage,
                _ => Mark::Unknown,
            };
            drawn.map.mark(Cell::new(x, y), mark, Revision(1));
            if letter == 'b' {
                drawn.piece.insert(Cell::new(x, y));
            }
        }
    }
    drawn
}

fn walled(rows: &[&str]) -> Drawn {
    let mut drawn = draw(rows);
    let (width, height) = (rows[0].len() as i32, rows.len() as i32);
    for n in -1..=width.max(height) {
        for cell in [Cell::new(n, -1), Cell::new(n, height), Cell::new(-1, n), Cell::new(width, n)] {
            drawn.map.mark(cell, Mark::Wall, Revision(1));
        }
    }
    drawn
}

const OUT: [Place; 2] = [Place::ENTRANCE; 2];

fn at(x: i32, y: i32) -> Place {
    Place::Cell(Cell::new(x, y))
}

impl Drawn {
    fn floor(&self) -> Floor<'_> {
        Floor { map: &self.map, way_out: true, freed: &self.piece, taken: &[], kept_out: &NOWHERE }
    }

    fn fetch(&self) -> Option<(Stands, Vec<Train>)> {
        let floor = self.floor();
        let stands = floor.stands(OUT, &self.piece, Place::ENTRANCE)?;
        let train = Train { bases: stands.bases.map(Place::Cell), parcel: Place::Cell(stands.grip) };
        Some((stands, floor.carry(train, Place::ENTRANCE).expect("a stand is chosen from which there is a way")))
    }
}

#[test]
fn a_piece_in_the_open_is_fetched_the_shortest_way() {
    let (stands, way) = walled(&["....", "....", "..b.", "...."]).fetch().expect("there is room all round it");
    assert_eq!(stands.grip, Cell::new(2, 2));
    assert_eq!(way.len(), 5, "four cells to home and one out");
    assert_eq!(way.last().map(|train| train.parcel), Some(Place::ENTRANCE));
    assert_eq!(
        way.last().map(|train| train.bases.into_iter().collect::<BTreeSet<_>>()),
        Some([Place::Outside(2), at(0, 0)].into())
    );
}

#[test]
fn a_piece_in_a_corner_is_lifted_from_both_sides_of_the_corner() {
    let (stands, _) = walled(&["...", "...", "..b"]).fetch().expect("two sides are free");
    assert_eq!(BTreeSet::from(stands.bases), BTreeSet::from([Cell::new(1, 2), Cell::new(2, 1)]));
}

#[test]
fn a_piece_with_one_free_side_cannot_be_fetched() {
    assert_eq!(walled(&["...", "##.", "##b"]).fetch(), None);
    assert_eq!(walled(&["...", "##?", "##b"]).fetch(), None);
}

#[test]
fn srm1_goes_to_the_far_side_where_it_would_bar_the_way() {
    // Both places are at the end of one lane, so the first base there goes further in.
    let (stands, _) =
        walled(&[".....", "####.", "##b..", "##..#"]).fetch().expect("the far side is reached by way of the near one");
    assert_eq!(stands.bases, [Cell::new(2, 3), Cell::new(3, 2)]);
}

#[test]
fn a_piece_is_carried_through_a_lane_and_round_its_corners() {
    let drawn = walled(&["..####", "#.####", "#.....", "####..", "####b.", "######"]);
    let (_, way) = drawn.fetch().expect("the lane is wide enough for a train");
    assert!(way.windows(2).all(|pair| pair[0].parcel.is_beside(pair[1].parcel)));
}

#[test]
fn what_a_piece_stands_on_is_free_once_it_is_lifted() {
    let (_, way) = walled(&[".bb..", ".#...", "....."]).fetch().expect("it is lifted at its far end");
    assert!(way.iter().any(|train| train.parcel == at(1, 0)), "backwards for a step, then over its own cells");
    assert_eq!(way.len(), 5);
}

#[test]
fn unknown_cells_are_taken_to_be_free_but_not_for_a_short_cut() {
    let drawn = walled(&["..b", ".#?", "..."]);
    assert!(drawn.fetch().is_some());
    let around = walled(&[".....", ".###.", ".?#..", "....."]);
    let floor = around.floor();
    assert!(!floor.approach(at(0, 0), at(0, 3)).expect("a way").contains(&at(1, 2)));
    let short = draw(&["....", ".??.", "...."]);
    let way = short.floor().approach(at(0, 1), at(3, 1)).expect("a way");
    assert_eq!(way.len(), 5, "round two cells of which nothing is known");
}

#[test]
fn nobody_walks_through_somebody_else() {
    let drawn = walled(&["...", "#.#", "..."]);
    let floor = Floor { taken: &[at(1, 1)], ..drawn.floor() };
    assert_eq!(floor.approach(at(0, 0), at(0, 2)), None);
    assert_eq!(floor.approach(at(0, 0), at(1, 1)), None);
    assert!(drawn.floor().approach(Place::ENTRANCE, at(0, 2)).is_some());
}

#[test]
fn without_a_way_out_a_parcel_is_carried_from_cell_to_cell() {
    let drawn = draw(&["......", ".b....", "......"]);
    let floor = Floor { way_out: false, ..drawn.floor() };
    let stands = floor.stands([at(0, 0), at(0, 2)], &drawn.piece, at(4, 1)).expect("a way");
    let train = Train { bases: stands.bases.map(Place::Cell), parcel: Place::Cell(stands.grip) };
    assert_eq!(floor.carry(train, at(4, 1)).map(|way| way.len()), Some(3));
    assert_eq!(floor.stands([at(0, 0), at(0, 2)], &drawn.piece, Place::ENTRANCE), None);
}

/// Whether the piece can be fetched at all. It tries every pair of places that the two bases can reach, one after the
/// other. From each pair it tries every train that can follow, until one has its parcel outside. It uses nothing of
/// the code above, but works on the letters of drawings.
fn can_be_fetched(rows: &[Vec<char>]) -> bool {
    type Spot = (i32, i32);
    const HOME: Spot = (0, 0);
    /// Places outside, one and two steps from home.
    const GATE: Spot = (1000, 0);
    const FAR: Spot = (1001, 0);
    let letter = |(x, y): Spot| {
        let row = usize::try_from(y).ok().and_then(|y| rows.get(y));
        row.and_then(|row| row.get(usize::try_from(x).ok()?)).copied().unwrap_or('#')
    };
    let next = |spot: Spot| -> Vec<Spot> {
        match spot {
            GATE => vec![HOME, FAR],
            FAR => vec![GATE],
            (x, y) => {
                let mut all = vec![(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)];
                all.extend((spot == HOME).then_some(GATE));
                all
            }
        }
    };
    let is_out = |spot: Spot| spot == GATE || spot == FAR;
    let reach = |barred: Option<Spot>| {
        let mut seen = BTreeSet::from([GATE]);
        let mut queue = VecDeque::from([GATE]);
        while let Some(here) = queue.pop_front() {
            for spot in next(here) {
                let open = is_out(spot) || (letter(spot) == '.' && Some(spot) != barred);
                if open && seen.insert(spot) {
                    queue.push_back(spot);
                }
            }
        }
        seen
    };
    let mut trains = VecDeque::new();
    for (y, row) in (0..).zip(rows) {
        for (x, _) in (0..).zip(row).filter(|(_, letter)| **letter == 'b') {
            for one in next((x, y)).into_iter().filter(|one| reach(None).contains(one) && !is_out(*one)) {
                let second = reach(Some(one));
                let others = next((x, y)).into_iter().filter(|two| *two != one && second.contains(two) && !is_out(*two));
                trains.extend(others.map(|two| (one, (x, y), two)));
            }
        }
    }
    let mut seen: BTreeSet<_> = trains.iter().copied().collect();
    while let Some((one, parcel, two)) = trains.pop_front() {
        if parcel == GATE {
            return true;
        }
        let free = |spot: &Spot| is_out(*spot) || matches!(letter(*spot), '.' | 'b');
        let off = |spot: &Spot| ![one, parcel, two].contains(spot);
        let by_one = next(one).into_iter().filter(|to| free(to) && off(to)).map(|to| (to, one, parcel));
        let by_two = next(two).into_iter().filter(|to| free(to) && off(to)).map(|to| (parcel, two, to));
        for train in by_one.chain(by_two).collect::<Vec<_>>() {
            if seen.insert(train) {
                trains.push_back(train);
            }
        }
    }
    false
}

#[test]
fn in_random_halls_a_way_is_found_exactly_where_there_is_one() {
    let mut random = RandomStream::new(7, "halls of a pair");
    let (mut with, mut without) = (0, 0);
    for _ in 0..4000 {
        let (width, height) = (3 + random.below(6) as usize, 3 + random.below(6) as usize);
        let density = random.fraction() * 0.6;
        let mut letter = || if random.happens(density) { '#' } else { '.' };
        let mut rows: Vec<Vec<char>> = (0..height).map(|_| (0..width).map(|_| letter()).collect()).collect();
        rows[0][0] = '.';
        let (x, y) = (1 + random.below(width as u64 - 1) as usize, random.below(height as u64) as usize);
        rows[y][x] = 'b';
        if x + 1 < width && random.happens(0.4) {
            rows[y][x + 1] = 'b';
        }
        let lines: Vec<String> = rows.iter().map(|row| row.iter().collect()).collect();
        let drawn = walled(&lines.iter().map(String::as_str).collect::<Vec<_>>());
        let expect = can_be_fetched(&rows);
        assert_eq!(drawn.fetch().is_some(), expect, "{}", lines.join("\n"));
        if expect { with += 1 } else { without += 1 }
    }
    assert!(with > 500 && without > 500, "both are tried: {with} and {without}");
}
