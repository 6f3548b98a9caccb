//! Random halls by family: what a strategy is tuned and measured on.

use hallsweep_core::rng::RandomStream;
use hallsweep_sim::Hall;

/// A kind of random hall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Family {
    /// Luggage in each cell with this chance.
    Luggage(f64),
    /// Luggage along the walls and in the corners only.
    Walls,
    /// Closed rooms that nobody can come into, and loose luggage.
    Islands,
    /// Alcoves along the walls, one cell wide.
    Pockets,
    /// Corridors between blocks of wall.
    Corridors,
    /// A maze of corridors one cell wide.
    Maze,
}

/// A hall of this family: rows of `.`, `#`, `T` and one `S`.
pub fn rows(family: Family, columns: usize, lines: usize, dice: &mut RandomStream) -> Vec<String> {
    let mut drawn = vec![vec!['.'; columns]; lines];
    match family {
        Family::Luggage(share) => strew(&mut drawn, share, dice),
        Family::Walls => line_walls(&mut drawn, dice),
        Family::Islands => {
            strew(&mut drawn, 0.1, dice);
            enclose(&mut drawn, dice);
        }
        Family::Pockets => {
            for _ in 0..columns * lines / 40 {
                let (x, y) = (place(columns, dice), place(lines, dice));
                let ways = [(0, 1), (1, 0), (0, -1), (-1, 0)];
                let open = dice.below(4) as usize;
                for (n, (dx, dy)) in ways.into_iter().enumerate() {
                    if n != open {
                        put(&mut drawn, x as i64 + dx, y as i64 + dy, 'T');
                    }
                }
            }
        }
        Family::Corridors => {
            let (bx, by) = (2 + dice.below(4) as usize, 2 + dice.below(4) as usize);
            let gap = 1 + dice.below(3) as usize;
            for (y, row) in drawn.iter_mut().enumerate() {
                for (x, square) in row.iter_mut().enumerate() {
                    if x % (bx + gap) >= gap && y % (by + gap) >= gap {
                        *square = '#';
                    }
                }
            }
            strew(&mut drawn, 0.03, dice);
        }
        Family::Maze => maze(&mut drawn, dice),
    }
    drawn[0][0] = 'S';
    drawn.into_iter().map(|row| row.into_iter().collect()).collect()
}

/// The same as a hall.
pub fn hall(family: Family, columns: usize, lines: usize, dice: &mut RandomStream) -> Hall {
    let rows = rows(family, columns, lines, dice);
    Hall::from_rows("random", &rows.iter().map(String::as_str).collect::<Vec<_>>()).expect("a drawn hall is sound")
}

fn place(most: usize, dice: &mut RandomStream) -> usize {
    usize::try_from(dice.below(most as u64)).unwrap_or(0)
}

fn put(drawn: &mut [Vec<char>], x: i64, y: i64, mark: char) {
    let square = usize::try_from(y).ok().and_then(|y| drawn.get_mut(y)).zip(usize::try_from(x).ok());
    if let Some(square) = square.and_then(|(row, x)| row.get_mut(x)) {
        *square = mark;
    }
}

fn strew(drawn: &mut [Vec<char>], share: f64, dice: &mut RandomStream) {
    for square in drawn.iter_mut().flatten() {
        if dice.happens(share) && *square == '.' {
            *square = 'T';
        }
    }
}

fn line_walls(drawn: &mut [Vec<char>], dice: &mut RandomStream) {
    let (lines, columns) = (drawn.len(), drawn[0].len());
    for y in 0..lines {
        for x in 0..columns {
            let away = x.min(y).min(columns - 1 - x).min(lines - 1 - y);
            let corner = x.min(columns - 1 - x) < 4 && y.min(lines - 1 - y) < 4;
            let chance = if corner {
                0.4
            } else if away == 0 {
                0.3
            } else {
                0.0
            };
            if dice.happens(chance) {
                drawn[y][x] = 'T';
            }
        }
    }
}

fn enclose(drawn: &mut [Vec<char>], dice: &mut RandomStream) {
    let (lines, columns) = (drawn.len(), drawn[0].len());
    for _ in 0..columns * lines / 150 {
        let (w, h) = (3 + place(4, dice), 3 + place(4, dice));
        if columns < w + 4 || lines < h + 4 {
            continue;
        }
        let (x, y) = (2 + place(columns - w - 3, dice), 2 + place(lines - h - 3, dice));
        for dy in 0..h {
            for dx in 0..w {
                let edge = dx == 0 || dy == 0 || dx == w - 1 || dy == h - 1;
                drawn[y + dy][x + dx] = if edge { 'T' } else { '.' };
            }
        }
    }
}

/// Depth first through a lattice of rooms.
fn maze(drawn: &mut [Vec<char>], dice: &mut RandomStream) {
    let (lines, columns) = (drawn.len(), drawn[0].len());
    drawn.iter_mut().flatten().for_each(|square| *square = '#');
    drawn[0][0] = '.';
    let mut way = vec![(0usize, 0usize)];
    while let Some((x, y)) = way.last().copied() {
        let open: Vec<(i64, i64)> = [(2, 0), (-2, 0), (0, 2), (0, -2)]
            .into_iter()
            .filter(|(dx, dy)| {
                let (x, y) = (x as i64 + dx, y as i64 + dy);
                (0..columns as i64).contains(&x) && (0..lines as i64).contains(&y) && drawn[y as usize][x as usize] == '#'
            })
            .collect();
        if open.is_empty() {
            way.pop();
            continue;
        }
        let (dx, dy) = open[place(open.len(), dice)];
        put(drawn, x as i64 + dx / 2, y as i64 + dy / 2, '.');
        put(drawn, x as i64 + dx, y as i64 + dy, '.');
        way.push(((x as i64 + dx) as usize, (y as i64 + dy) as usize));
    }
}
