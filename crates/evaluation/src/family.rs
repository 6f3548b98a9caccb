//! Families of random halls, in which strategies are tuned and measured.

use std::fmt;
use std::str::FromStr;

use hallsweep_core::rng::RandomStream;
use hallsweep_sim::Hall;

use crate::Ground;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Family {
    /// Each cell has luggage with this probability.
    Luggage(f64),
    /// Luggage along the walls and in the corners only.
    Walls,
    /// Closed rooms that cannot be entered, and luggage at random places.
    Islands,
    /// Alcoves along the walls, one cell wide.
    Pockets,
    /// Corridors of 1 to 3 cells between blocks of wall.
    Corridors,
    /// A maze of corridors one cell wide.
    Maze,
}

impl Family {
    /// All families. Random luggage appears with four densities, of which the first is 0.
    pub const ALL: [Family; 9] = [
        Family::Luggage(0.0),
        Family::Luggage(0.05),
        Family::Luggage(0.1),
        Family::Luggage(0.2),
        Family::Walls,
        Family::Islands,
        Family::Pockets,
        Family::Corridors,
        Family::Maze,
    ];

    /// Estimates how many pieces a hall has at most. The estimate is 5 % above the expected number, and few halls
    /// have more.
    #[must_use]
    #[expect(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a hall is small")]
    pub(crate) fn most_pieces(self, cells: usize) -> usize {
        let share = match self {
            Family::Luggage(share) => share,
            Family::Islands => 0.1,
            Family::Walls | Family::Pockets | Family::Corridors | Family::Maze => 0.03,
        };
        (share * cells as f64 * 1.05) as usize
    }
}

/// Largest share of luggage that a user can request, in percent. With more luggage, hardly any cell could be reached.
const MOST_LUGGAGE: u8 = 30;

/// The families with a fixed name. Any other name is the percentage of cells with luggage, such as `luggage-10`.
const NAMED: [(&str, Family); 6] = [
    ("empty", Family::Luggage(0.0)),
    ("walls", Family::Walls),
    ("islands", Family::Islands),
    ("pockets", Family::Pockets),
    ("corridors", Family::Corridors),
    ("maze", Family::Maze),
];

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (NAMED.iter().find(|(_, family)| family == self), self) {
            (Some((name, _)), _) => f.write_str(name),
            (None, Family::Luggage(share)) => write!(f, "luggage-{:.0}", share * 100.0),
            (None, other) => unreachable!("{other:?} has a name"),
        }
    }
}

impl FromStr for Family {
    type Err = ();

    fn from_str(written: &str) -> Result<Family, ()> {
        if let Some((_, family)) = NAMED.into_iter().find(|(name, _)| *name == written) {
            return Ok(family);
        }
        let share: u8 = written.strip_prefix("luggage-").and_then(|share| share.parse().ok()).ok_or(())?;
        if (1..=MOST_LUGGAGE).contains(&share) { Ok(Family::Luggage(f64::from(share) / 100.0)) } else { Err(()) }
    }
}

/// Maximum number of draws of a hall. The last hall is used even if too few of its cells can be reached.
const DRAWN: usize = 1000;

/// Draws a hall of this family. A new hall is drawn until more than a third of the cells can be reached, but at most
/// `DRAWN` halls. A hall in which luggage blocks the way out of home would leave nothing to search.
#[must_use]
pub fn hall(family: Family, columns: usize, lines: usize, dice: &mut RandomStream) -> Hall {
    let mut hall = drawn(family, columns, lines, dice);
    for _ in 1..DRAWN {
        if Ground::of(&hall).reachable * 3 > columns * lines {
            break;
        }
        hall = drawn(family, columns, lines, dice);
    }
    hall
}

/// Draws one hall of this family. Home is in its north-west corner.
fn drawn(family: Family, columns: usize, lines: usize, dice: &mut RandomStream) -> Hall {
    let mut drawing = Drawing { columns, lines, squares: vec!['.'; columns * lines] };
    match family {
        Family::Luggage(share) => drawing.strew(share, dice),
        Family::Walls => drawing.line_walls(dice),
        Family::Islands => {
            drawing.strew(0.1, dice);
            drawing.enclose(dice);
        }
        Family::Pockets => drawing.fold(dice),
        Family::Corridors => {
            drawing.block(dice);
            drawing.strew(0.03, dice);
        }
        Family::Maze => drawing.carve(dice),
    }
    drawing.squares[0] = 'S';
    let rows: Vec<String> = drawing.squares.chunks(columns).map(|row| row.iter().collect()).collect();
    Hall::from_rows("random", &rows.iter().map(String::as_str).collect::<Vec<_>>())
        .expect("a hall is drawn by the rules of drawings")
}

/// A hall while it is drawn. `.` is free, `#` is a wall, `T` is luggage.
struct Drawing {
    columns: usize,
    lines: usize,
    squares: Vec<char>,
}

impl Drawing {
    fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let columns = self.columns;
        (0..self.lines).flat_map(move |y| (0..columns).map(move |x| (x, y)))
    }

    fn at(&mut self, (x, y): (usize, usize)) -> &mut char {
        &mut self.squares[y * self.columns + x]
    }

    fn beside(&self, (x, y): (usize, usize), (dx, dy): (isize, isize)) -> Option<(usize, usize)> {
        let (x, y) = (x.checked_add_signed(dx)?, y.checked_add_signed(dy)?);
        (x < self.columns && y < self.lines).then_some((x, y))
    }

    fn strew(&mut self, share: f64, dice: &mut RandomStream) {
        for square in &mut self.squares {
            if dice.happens(share) && *square == '.' {
                *square = 'T';
            }
        }
    }

    fn line_walls(&mut self, dice: &mut RandomStream) {
        for (x, y) in self.places() {
            let (across, down) = (x.min(self.columns - 1 - x), y.min(self.lines - 1 - y));
            let share = match (across.max(down), across.min(down)) {
                (0..4, _) => 0.25,
                (_, 0) => 0.2,
                _ => 0.0,
            };
            if dice.happens(share) {
                *self.at((x, y)) = 'T';
            }
        }
    }

    fn enclose(&mut self, dice: &mut RandomStream) {
        for _ in 0..self.squares.len() / 150 {
            let (w, h) = (3 + below(4, dice), 3 + below(4, dice));
            if self.columns < w + 4 || self.lines < h + 4 {
                continue;
            }
            let (x, y) = (2 + below(self.columns - w - 3, dice), 2 + below(self.lines - h - 3, dice));
            for (dx, dy) in (0..h).flat_map(|dy| (0..w).map(move |dx| (dx, dy))) {
                let is_edge = dx == 0 || dy == 0 || dx == w - 1 || dy == h - 1;
                *self.at((x + dx, y + dy)) = if is_edge { 'T' } else { '.' };
            }
        }
    }

    fn fold(&mut self, dice: &mut RandomStream) {
        for _ in 0..self.squares.len() / 40 {
            let middle = (below(self.columns, dice), below(self.lines, dice));
            let open = below(4, dice);
            for (_, away) in [(0, 1), (1, 0), (0, -1), (-1, 0)].into_iter().enumerate().filter(|(n, _)| *n != open) {
                if let Some(place) = self.beside(middle, away) {
                    *self.at(place) = 'T';
                }
            }
        }
    }

    fn block(&mut self, dice: &mut RandomStream) {
        let (across, down, gap) = (2 + below(4, dice), 2 + below(4, dice), 1 + below(3, dice));
        for (x, y) in self.places() {
            if x % (across + gap) >= gap && y % (down + gap) >= gap {
                *self.at((x, y)) = '#';
            }
        }
    }

    /// Makes a maze by a depth-first walk. Its rooms are two cells apart, and the wall between two joined rooms is
    /// opened.
    fn carve(&mut self, dice: &mut RandomStream) {
        self.squares.fill('#');
        *self.at((0, 0)) = '.';
        let mut way = vec![(0, 0)];
        while let Some(here) = way.last().copied() {
            let ways = [(2, 0), (-2, 0), (0, 2), (0, -2)];
            let is_closed =
                |away: &(isize, isize)| self.beside(here, *away).is_some_and(|(x, y)| self.squares[y * self.columns + x] == '#');
            let closed: Vec<(isize, isize)> = ways.into_iter().filter(is_closed).collect();
            let Some((dx, dy)) = closed.get(below(closed.len(), dice)).copied() else {
                way.pop();
                continue;
            };
            for away in [(dx / 2, dy / 2), (dx, dy)] {
                let place = self.beside(here, away).expect("a closed room is inside, and so is what lies before it");
                *self.at(place) = '.';
            }
            way.push(self.beside(here, (dx, dy)).expect("a closed room is inside"));
        }
    }
}

pub(crate) fn below(bound: usize, dice: &mut RandomStream) -> usize {
    usize::try_from(dice.below(bound as u64)).expect("it is below a usize")
}
