//! Random halls for the tests: size, luggage, pockets and islands all drawn from one seed.

use std::sync::Arc;

use hallsweep::core::rng::Stream;
use hallsweep::outbound::robot::sim::Hall;

/// A hall of up to `most` × `most` cells with 0–20 % luggage, some walls, pockets behind them, and islands nobody can reach.
pub(crate) fn random(seed: u64, most: u64) -> Arc<Hall> {
    let mut dice = Stream::new(seed, "random hall");
    let (width, height) = (1 + dice.below(most), 1 + dice.below(most));
    let (luggage, walls) = (dice.fraction() * 0.2, dice.fraction() * 0.1);
    let mut rows: Vec<Vec<char>> = (0..height).map(|_| (0..width).map(|_| cell(&mut dice, luggage, walls)).collect()).collect();
    for _ in 0..dice.below(4) {
        room(&mut dice, &mut rows);
    }
    // Home is the free cell nearest to the north-west corner: here that corner itself, or what is left of the hall.
    let (y, x) = if dice.below(2) == 0 { (0, 0) } else { (dice.below(height) as usize, dice.below(width) as usize) };
    rows[y][x] = '.';
    let rows: Vec<String> = rows.into_iter().map(String::from_iter).collect();
    hall(&format!("random-{seed}"), &rows)
}

/// A hall from a drawing in the MovingAI manner: `.` free, `@` wall, `T` luggage, each a piece of its own.
pub(crate) fn hall(name: &str, rows: &[String]) -> Arc<Hall> {
    let text = format!("type octile\nheight {}\nwidth {}\nmap\n{}\n", rows.len(), rows[0].len(), rows.join("\n"));
    Arc::new(Hall::parse(&format!("{name}.map"), &text).expect("the tests draw sound halls"))
}

fn cell(dice: &mut Stream, luggage: f64, walls: f64) -> char {
    let draw = dice.fraction();
    if draw < luggage {
        'T'
    } else if draw < luggage + walls {
        '@'
    } else {
        '.'
    }
}

/// Walls round a rectangle, with a door in one of two: a pocket, or an island.
fn room(dice: &mut Stream, rows: &mut [Vec<char>]) {
    let (height, width) = (rows.len() as u64, rows[0].len() as u64);
    let (left, top) = (dice.below(width) as usize, dice.below(height) as usize);
    let (right, bottom) = (
        (left + 2 + dice.below(6) as usize).min(width as usize - 1),
        (top + 2 + dice.below(6) as usize).min(height as usize - 1),
    );
    rows[top][left..=right].fill('@');
    rows[bottom][left..=right].fill('@');
    for row in rows.iter_mut().take(bottom + 1).skip(top) {
        row[left] = '@';
        row[right] = '@';
    }
    if dice.below(2) == 0 {
        rows[top][left + (right - left) / 2] = '.';
    }
}
