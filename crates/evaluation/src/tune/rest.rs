//! Describes the rest of a hall at the end of a trial, and estimates its cost from the layout of the unvisited cells.
//! The true hall is used for this. The real cost of walking on to the end of the search is not used, because that
//! cost depends mostly on chance.

use std::sync::LazyLock;

use hallsweep_core::search::grid::Square;
use hallsweep_core::units::Cell;
use hallsweep_sim::Truth;

use super::ridge::{self, Sample};
use crate::Ground;
use crate::walk::Walk;

/// Number of numbers that describe the rest, not counting the neighbourhoods.
const PLAIN: usize = 14;

/// Number of different neighbourhoods of a cell. Each of its eight neighbours is unvisited, visited or blocked.
const NEIGHBOURHOODS: usize = 3usize.pow(8);

pub(super) const NUMBERS: usize = PLAIN + NEIGHBOURHOODS;

/// The eight neighbours of a cell, clockwise from the north.
const ROUND: [(i32, i32); 8] = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)];

/// The number of each neighbourhood. Neighbourhoods that are rotated or mirrored images of each other have the same
/// number: the lowest one.
static CLASSES: LazyLock<Vec<u32>> = LazyLock::new(|| {
    let digit = |code: u32, place: u32| code / 3u32.pow(place) % 3;
    let image = |code: u32, turn: u32, is_mirrored: bool| {
        let from = |place: u32| if is_mirrored { 8 - place } else { place } + 2 * turn;
        (0..8).map(|place| digit(code, from(place) % 8) * 3u32.pow(place)).sum()
    };
    let images = |code| (0..4).flat_map(move |turn| [image(code, turn, false), image(code, turn, true)]);
    (0..NEIGHBOURHOODS as u32).map(|code| images(code).min().unwrap_or(code)).collect()
});

/// Description of the rest of a hall: pairs of index and number. Zeros are left out.
pub(super) type Rest = Vec<(u32, f32)>;

/// Describes rests of halls. It is reused, so that its memory need not be allocated again.
#[derive(Debug, Default)]
pub(super) struct Judge {
    taken: Vec<u32>,
    look: u32,
}

impl Judge {
    /// Describes the rest of the hall for a walk. `way` is the lowest score of all cells that could be entered next,
    /// in thousandths of a step.
    #[expect(clippy::cast_precision_loss, reason = "a training hall is small")]
    pub(super) fn rest(&mut self, ground: &Ground, cells: &[Cell], walk: &Walk, way: i32) -> Rest {
        self.taken.resize(ground.size(), 0);
        self.look += 1;
        let is_left = |cell: Cell| ground.at(cell) == Truth::Free && walk.is_left(cell);
        let mut plain = [0.0f32; PLAIN];
        let (mut parts, mut neighbourhoods): (Vec<Vec<Cell>>, Vec<u32>) = (Vec::new(), Vec::new());
        for cell in cells {
            if ground.at(*cell) != Truth::Free {
                plain[0] += f32::from(u8::from(walk.grid.at(*cell) == Square::Unknown));
            } else if is_left(*cell) {
                neighbourhoods.push(PLAIN as u32 + neighbourhood(ground, walk, *cell));
                parts.extend(self.part(ground, *cell, is_left));
            }
        }
        for (n, part) in parts.iter().enumerate() {
            plain[class(part.len())] += 1.0;
            if part.len() <= 20 {
                let others = parts.iter().enumerate().filter(|(m, _)| *m != n).flat_map(|(_, other)| other);
                let away = others.map(|cell| cell.x.abs_diff(part[0].x) + cell.y.abs_diff(part[0].y)).min().unwrap_or(0) as f32;
                plain[8] += away;
                plain[9] += away.sqrt();
                plain[10] += f32::from(u8::from(away <= 3.0));
            }
        }
        plain[11] = way as f32 / 1000.0;
        plain[12] = (walk.pose.cell.x.abs() + walk.pose.cell.y.abs()) as f32 / 10.0;
        plain[13] = 1.0;
        counted(plain, neighbourhoods)
    }

    /// The unvisited cells that are connected with `first`. `None` if `first` belongs to a part that was already
    /// found.
    fn part(&mut self, ground: &Ground, first: Cell, is_left: impl Fn(Cell) -> bool) -> Option<Vec<Cell>> {
        let look = self.look;
        let mut take = |cell: Cell| std::mem::replace(&mut self.taken[ground.place(cell)], look) != look;
        if !take(first) {
            return None;
        }
        let (mut part, mut done) = (vec![first], 0);
        while done < part.len() {
            let next = part[done].neighbours().into_iter().filter(|next| is_left(*next));
            let fresh: Vec<Cell> = next.filter(|next| take(*next)).collect();
            part.extend(fresh);
            done += 1;
        }
        Some(part)
    }
}

/// The index of the number that counts the parts of this size. Similar sizes have the same index.
const fn class(size: usize) -> usize {
    match size {
        0..=1 => 1,
        2 => 2,
        3..=4 => 3,
        5..=8 => 4,
        9..=20 => 5,
        21..=60 => 6,
        _ => 7,
    }
}

fn neighbourhood(ground: &Ground, walk: &Walk, cell: Cell) -> u32 {
    let code = ROUND.into_iter().rev().fold(0, |code, (dx, dy)| {
        let next = Cell::new(cell.x + dx, cell.y + dy);
        let kind = if ground.at(next) != Truth::Free { 2 } else { usize::from(!walk.is_left(next)) };
        code * 3 + kind
    });
    CLASSES[code]
}

fn counted(plain: [f32; PLAIN], mut neighbourhoods: Vec<u32>) -> Rest {
    let mut rest: Rest = (0..).zip(plain).filter(|(_, x)| *x != 0.0).collect();
    neighbourhoods.sort_unstable();
    #[expect(clippy::cast_precision_loss, reason = "a training hall is small")]
    let counts = neighbourhoods.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as f32));
    rest.extend(counts);
    rest
}

/// Learns the weights of the numbers that describe a rest. The samples are taken during whole walks, so their real
/// costs are known.
pub(super) fn worth(samples: &[Sample]) -> Vec<f64> {
    ridge::ridge(samples, NUMBERS, 30.0, 100)
}

#[expect(clippy::cast_possible_truncation, reason = "sums of small numbers need no more digits")]
pub(super) fn difference(a: &Rest, weight_a: f64, b: &Rest, weight_b: f64) -> Rest {
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    let mut all = Rest::new();
    while let Some(n) = [a.peek(), b.peek()].into_iter().flatten().map(|(n, _)| *n).min() {
        let take = |from: &mut std::iter::Peekable<std::slice::Iter<'_, (u32, f32)>>| {
            from.next_if(|(m, _)| *m == n).map_or(0.0, |(_, x)| f64::from(*x))
        };
        all.push((n, (take(&mut a) * weight_a - take(&mut b) * weight_b) as f32));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_of_a_neighbourhood_are_one_class() {
        let code = |digits: [u32; 8]| digits.into_iter().rev().fold(0, |code, digit| code * 3 + digit) as usize;
        let class = |digits| CLASSES[code(digits)];
        assert_eq!(class([1, 0, 0, 2, 0, 0, 0, 0]), class([0, 0, 1, 0, 0, 2, 0, 0]), "turned");
        assert_eq!(class([1, 0, 0, 2, 0, 0, 0, 0]), class([1, 0, 0, 0, 0, 2, 0, 0]), "mirrored");
        assert_ne!(class([1, 0, 0, 2, 0, 0, 0, 0]), class([1, 0, 2, 0, 0, 0, 0, 0]));
        let mut classes = CLASSES.clone();
        classes.sort_unstable();
        classes.dedup();
        assert_eq!(classes.len(), 954, "by Burnside's lemma");
    }

    #[test]
    fn a_difference_weighs_both_sides() {
        let (a, b) = (vec![(0, 1.0), (3, 2.0)], vec![(2, 5.0), (3, 1.0)]);
        assert_eq!(difference(&a, 2.0, &b, 1.0), [(0, 2.0), (2, -5.0), (3, 3.0)]);
    }
}
