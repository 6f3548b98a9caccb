//! Random halls for the tests; one seed determines size, home, luggage, pockets and islands.

use std::sync::Arc;

use hallsweep_core::rng::RandomStream;
use hallsweep_sim::Hall;

/// Hall of up to `most` × `most` cells: 0–20 % luggage, pieces of one or several cells, some walls, pockets behind
/// them, unreachable islands, and home in the north-west corner or anywhere.
pub(crate) fn random(seed: u64, most: u64) -> Arc<Hall> {
    let mut dice = RandomStream::new(seed, "random hall");
    let side = |dice: &mut RandomStream| 1 + dice.below(most).max(dice.below(most)) as usize;
    let (width, height) = (side(&mut dice), side(&mut dice));
    let (luggage, walls) = (dice.fraction() * 0.2, dice.fraction() * 0.1);
    let mut rows: Vec<Vec<char>> = (0..height).map(|_| (0..width).map(|_| cell(&mut dice, luggage, walls)).collect()).collect();
    for _ in 0..dice.below(4) {
        room(&mut dice, &mut rows);
    }
    for letter in ('a'..='z').take(dice.below(5) as usize) {
        large_piece(&mut dice, &mut rows, letter);
    }
    let home = if dice.below(2) == 0 { (0, 0) } else { (dice.below(height as u64) as usize, dice.below(width as u64) as usize) };
    clear_letter(&mut rows, home);
    rows[home.0][home.1] = 'S';
    let rows: Vec<String> = rows.into_iter().map(String::from_iter).collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    Arc::new(Hall::from_rows(&format!("random-{seed}"), &rows).expect("the tests draw sound halls"))
}

fn cell(dice: &mut RandomStream, luggage: f64, walls: f64) -> char {
    let draw = dice.fraction();
    if draw < luggage {
        'T'
    } else if draw < luggage + walls {
        '#'
    } else {
        '.'
    }
}

/// Draws a piece of two to six cells.
fn large_piece(dice: &mut RandomStream, rows: &mut [Vec<char>], letter: char) {
    let (left, top) = (dice.below(rows[0].len() as u64) as usize, dice.below(rows.len() as u64) as usize);
    let (right, bottom) = (left + 1 + dice.below(2) as usize, top + dice.below(2) as usize);
    let whole = bottom < rows.len() && right < rows[0].len();
    if whole && rows[top..=bottom].iter().all(|row| row[left..=right].iter().all(|mark| !mark.is_ascii_lowercase())) {
        for row in &mut rows[top..=bottom] {
            row[left..=right].fill(letter);
        }
    }
}

/// Removes the piece on the cell of home completely, because removing only that cell would split it.
fn clear_letter(rows: &mut [Vec<char>], (y, x): (usize, usize)) {
    let letter = rows[y][x];
    for mark in rows.iter_mut().flatten().filter(|mark| **mark == letter && letter.is_ascii_lowercase()) {
        *mark = '.';
    }
}

/// Walls around a rectangle; half of the rectangles have a door. Those with a door are pockets, the others islands.
fn room(dice: &mut RandomStream, rows: &mut [Vec<char>]) {
    let (height, width) = (rows.len(), rows[0].len());
    let (left, top) = (dice.below(width as u64) as usize, dice.below(height as u64) as usize);
    let (right, bottom) =
        ((left + 2 + dice.below(6) as usize).min(width - 1), (top + 2 + dice.below(6) as usize).min(height - 1));
    rows[top][left..=right].fill('#');
    rows[bottom][left..=right].fill('#');
    for row in rows.iter_mut().take(bottom + 1).skip(top) {
        row[left] = '#';
        row[right] = '#';
    }
    if dice.below(2) == 0 {
        rows[top][left + (right - left) / 2] = '.';
    }
}
