//! Maps in MovingAI's format, with all its letters and both its types: a maze, a town of blocks and yards, and caves
//! with water, swamp and trees. The maps are generated from a seed and parsed like any file.

use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::Bounds;
use hallsweep_evaluation::Ground;
use hallsweep_evaluation::family::{Family, hall};
use hallsweep_sim::{Hall, Truth};

/// Letters of a map; all letters of one constant mean the same to a robot.
const FREE: [char; 3] = ['.', 'G', 'S'];
const SHUT: [char; 3] = ['@', 'O', 'W'];
const TREE: char = 'T';

/// Name, type and side in cells of each map.
pub(crate) const MAPS: [(&str, &str, usize); 6] = [
    ("maze", "octile", 1024),
    ("maze", "octile-corner", 512),
    ("town", "octile", 1024),
    ("town", "octile-corner", 512),
    ("caves", "octile", 1024),
    ("caves", "octile-corner", 512),
];

/// Ground of a map, parsed from its text. If home is in an enclosed corner, the next seed is tried.
pub(crate) fn ground(name: &str, kind: &str, side: usize) -> Ground {
    let draws = (0..).map(|seed| {
        let mut dice = RandomStream::new(seed, name);
        let cells = match name {
            "maze" => maze(side, &mut dice),
            "town" => town(side, &mut dice),
            _ => caves(side, &mut dice),
        };
        let text = written(kind, &cells);
        Ground::of(&Hall::parse("foreign.map", &text).expect("it is written as the format says"))
    });
    draws.into_iter().find(|ground| ground.reachable * 4 > side * side).expect("some draw leaves home open")
}

/// Writes cells as a map file. A map of type `octile-corner` has a height per corner, and one row and column more.
fn written(kind: &str, cells: &[Vec<char>]) -> String {
    let more = usize::from(kind == "octile-corner");
    let (height, width) = (cells.len() + more, cells[0].len() + more);
    let mut text = format!("type {kind}\nheight {height}\nwidth {width}\nmap\n");
    for _ in 0..height * more {
        text.extend(std::iter::repeat_n('0', width));
        text.push('\n');
    }
    for row in cells.iter().map(Some).chain(std::iter::repeat_n(None, more)) {
        match row {
            Some(row) => text.extend(row.iter().copied().chain(std::iter::repeat_n('@', more))),
            None => text.extend(std::iter::repeat_n('@', width)),
        }
        text.push('\n');
    }
    text
}

fn maze(side: usize, dice: &mut RandomStream) -> Vec<Vec<char>> {
    let hall = hall(Family::Maze, side, side, dice);
    let Bounds { least, most } = hall.bounds();
    let mut cell = |x: i32, y: i32| one_of(if hall.truth(Cell::new(x, y)) == Truth::Free { FREE } else { SHUT }, dice);
    (least.y..=most.y).map(|y| (least.x..=most.x).map(|x| cell(x, y)).collect()).collect()
}

/// Streets three cells wide around blocks of houses; some blocks have a yard with a gate, and there are a few trees.
fn town(side: usize, dice: &mut RandomStream) -> Vec<Vec<char>> {
    const BLOCK: usize = 16;
    const STREET: usize = 3;
    let blocks = side.div_ceil(BLOCK);
    let yards: Vec<bool> = (0..blocks * blocks).map(|_| dice.below(2) == 0).collect();
    let mut cell = |x: usize, y: usize| {
        let (across, down) = (x % BLOCK, y % BLOCK);
        let is_street = across < STREET || down < STREET;
        let inside = |place: usize| (STREET + 3..BLOCK - 3).contains(&place);
        let has_yard = yards[y / BLOCK * blocks + x / BLOCK];
        let is_yard = has_yard && inside(across) && (inside(down) || down < BLOCK / 2);
        match dice.below(40) {
            0 if is_street || is_yard => TREE,
            _ if is_street || is_yard => one_of(FREE, dice),
            _ => one_of(SHUT, dice),
        }
    };
    (0..side).map(|y| (0..side).map(|x| cell(x, y)).collect()).collect()
}

/// Caves by a cellular automaton: in each of five rounds, a cell becomes rock when most of its neighbours are rock.
fn caves(side: usize, dice: &mut RandomStream) -> Vec<Vec<char>> {
    let mut rock: Vec<Vec<bool>> = (0..side).map(|_| (0..side).map(|_| dice.below(100) < 42).collect()).collect();
    for _ in 0..5 {
        let is_rock = |x: usize, y: usize| {
            let around = (y.saturating_sub(1)..=y + 1).flat_map(|y| (x.saturating_sub(1)..=x + 1).map(move |x| (x, y)));
            let is_rock = |(x, y): (usize, usize)| rock.get(y).and_then(|row| row.get(x)).copied().unwrap_or(true);
            around.filter(|place| is_rock(*place)).count() >= 5
        };
        rock = (0..side).map(|y| (0..side).map(|x| is_rock(x, y)).collect()).collect();
    }
    let mut letter = |is_rock: bool| match dice.below(30) {
        _ if is_rock => one_of(SHUT, dice),
        0 => TREE,
        _ => one_of(FREE, dice),
    };
    rock.into_iter().map(|row| row.into_iter().map(&mut letter).collect()).collect()
}

fn one_of(letters: [char; 3], dice: &mut RandomStream) -> char {
    letters[usize::try_from(dice.below(3)).expect("it is below three")]
}
