//! The yard of the pallet scenario, drawn at random from a seed: walls, obstacles, the pallet with its parcels, the
//! target area, and the starts of the two robots. Every yard can be solved, but the solution is not stored.
//!
//! ```text
//!   # # # # # # # # # #     1, 2  the robots, the first at the cell (0, 0)
//!   # 1 2 . . # . . . #     T     parcels, each on the floor of the pallet
//!   # . . . . . T T T #     D     the target area, where parcels are put down
//!   # . D . . . . . . #
//! ```

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::retrieval::Floor;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::{Cell, Heading, Piece, Revision};
use hallsweep_core::world::hall_map::{HallMap, Mark};
use hallsweep_core::world::keep_out::NOWHERE;
use hallsweep_sim::{Hall, Truth};

/// Maximum number of parcels: three full rows of a pallet. More parcels would take hours of simulated time and show
/// nothing new.
pub const MOST_PARCELS: u32 = 24;

/// Number of parcels in a row.
const ROW: i32 = 8;

/// Number of free rows between two rows of parcels. In these rows, both robots can stand beside each parcel and pass
/// each other.
const AISLE: i32 = 2;

/// Maximum number of draws until a yard can be solved. Each draw has fewer obstacles than the one before, and the
/// last has none.
const DRAWS: u32 = 12;

/// Share of the floor cells that become obstacles in the first draw.
const OBSTACLES: f64 = 0.16;

/// Smallest distance of obstacles from parcels, target area and robots, in cells. Within this distance, both robots
/// have room to turn with a parcel between them.
const CLEAR: i32 = 2;

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the pallet cannot have {0} parcels: give 1 to {MOST_PARCELS}")]
pub struct ParcelsError(pub u32);

/// A yard after it has been drawn. It never changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Yard {
    /// The walls, obstacles and parcels of the yard.
    pub hall: Arc<Hall>,
    pub starts: [BasePose; 2],
    /// Cell where parcels are put down.
    pub target: Place,
    /// Whether robots can leave the yard at home, as in a hall. Yards drawn from a seed have no such way.
    pub way_out: bool,
    /// Parcels with their cells, in the order in which they are fetched.
    pub parcels: Vec<(Piece, Cell)>,
}

impl Yard {
    /// Draws a yard that can be solved.
    ///
    /// # Errors
    /// If `parcels` is 0 or more than `MOST_PARCELS`.
    pub fn new(parcels: u32, seed: u64) -> Result<Yard, ParcelsError> {
        if !(1..=MOST_PARCELS).contains(&parcels) {
            return Err(ParcelsError(parcels));
        }
        let mut random = RandomStream::new(seed, "yard");
        let mut yards = (0..DRAWS).map(|draw| {
            let share = OBSTACLES * f64::from(DRAWS - 1 - draw) / f64::from(DRAWS - 1);
            Plan::draw(parcels, share, &mut random).yard()
        });
        let solvable = yards.find(Yard::can_be_solved);
        Ok(solvable.expect("the last draw has no obstacles, and its pallet and target area are clear on all sides"))
    }

    /// The map before the first move. It contains the starts of the robots and the cells of the parcels.
    #[must_use]
    pub fn known_at_first(&self) -> HallMap {
        let mut map = HallMap::new(Cell::HOME, Revision(0));
        for start in self.starts {
            if let Place::Cell(cell) = start.place {
                map.mark(cell, Mark::Visited, Revision(0));
            }
        }
        for (_, cell) in &self.parcels {
            map.mark(*cell, Mark::Luggage, Revision(0));
        }
        map
    }

    /// Whether the first parcel can be fetched while all other parcels are in place. The robots must be able to do
    /// this from their starts and from the target area. Around the pallet everything is clear, so the robots can then
    /// fetch the other parcels too.
    fn can_be_solved(&self) -> bool {
        let mut map = self.known_at_first();
        let bounds = self.hall.bounds();
        let cells = (bounds.least.y..=bounds.most.y).flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)));
        for cell in cells {
            let mark = match self.hall.truth(cell) {
                Truth::Free => Mark::Visited,
                Truth::Wall => Mark::Wall,
                Truth::Luggage(_) => Mark::Luggage,
            };
            map.mark(cell, mark, Revision(0));
        }
        let target = self.target;
        let freed = BTreeSet::new();
        let floor = Floor { map: &map, way_out: false, freed: &freed, taken: &[], kept_out: &NOWHERE };
        // The places of the two robots after they have put down the first parcel. They may have come from any side.
        let beside = |heading| target.cell().map_or(target, |cell| Place::Cell(cell.ahead(heading)));
        let after = [beside(Heading::North), beside(Heading::South)];
        self.parcels.first().is_some_and(|(_, cell)| {
            let piece = BTreeSet::from([*cell]);
            let floor = Floor { freed: &piece, ..floor };
            [self.starts.map(|start| start.place), after].into_iter().all(|bases| floor.stands(bases, &piece, target).is_some())
        })
    }
}

/// A yard before it becomes a hall. Columns and rows are counted from the north-west corner of the floor.
struct Plan {
    columns: i32,
    rows: i32,
    start: Cell,
    target: Cell,
    parcels: Vec<Cell>,
    obstacles: BTreeSet<Cell>,
}

impl Plan {
    fn draw(parcels: u32, share: f64, random: &mut RandomStream) -> Plan {
        let count = i32::try_from(parcels).unwrap_or(i32::MAX);
        let pallet_rows = (count + ROW - 1) / ROW;
        let mut number = |least: i32, most: i32| {
            let span = u64::try_from(most - least + 1).unwrap_or(1);
            least + i32::try_from(random.below(span)).unwrap_or(0)
        };
        let pallet_height = pallet_rows + (pallet_rows - 1) * AISLE;
        let columns = number(ROW + 11, ROW + 16);
        let rows = number(pallet_height + 5, pallet_height + 9);
        // The robots start in the west and the pallet is in the east. The target area is between them.
        let start = Cell::new(1, number(1, rows - 2));
        let target = Cell::new(number(5, 7), number(2, rows - 3));
        let corner = Cell::new(columns - ROW - 2, number(2, rows - pallet_height - 2));
        let places = (0..count).map(|n| Cell::new(corner.x + n % ROW, corner.y + n / ROW * (1 + AISLE)));
        let mut plan = Plan { columns, rows, start, target, parcels: places.collect(), obstacles: BTreeSet::new() };
        for y in 0..rows {
            for x in 0..columns {
                let cell = Cell::new(x, y);
                let near = |other: Cell| (x - other.x).abs() <= CLEAR && (y - other.y).abs() <= CLEAR;
                let must_be_clear = near(start) || near(target) || plan.parcels.iter().any(|parcel| near(*parcel));
                if random.happens(share) && !must_be_clear {
                    plan.obstacles.insert(cell);
                }
            }
        }
        plan
    }

    fn yard(&self) -> Yard {
        let text = self.to_string();
        let rows: Vec<&str> = text.lines().collect();
        let hall = Hall::from_rows("yard", &rows).expect("a plan has a start, equal rows, and marks that halls have");
        let at = |cell: Cell| Cell::new(cell.x - self.start.x, cell.y - self.start.y);
        let base = |cell: Cell| BasePose { place: Place::Cell(cell), heading: Heading::East };
        Yard {
            starts: [base(Cell::HOME), base(Cell::HOME.ahead(Heading::South))],
            target: Place::Cell(at(self.target)),
            way_out: false,
            parcels: hall.pieces().iter().filter_map(|bag| Some((bag.piece, *bag.cells.first()?))).collect(),
            hall: Arc::new(hall),
        }
    }
}

impl fmt::Display for Plan {
    /// Writes the plan as the rows of a hall. Everything outside the hall is wall.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for y in 0..self.rows {
            for x in 0..self.columns {
                let cell = Cell::new(x, y);
                let mark = if cell == self.start {
                    'S'
                } else if self.parcels.contains(&cell) {
                    'T'
                } else if self.obstacles.contains(&cell) {
                    '#'
                } else {
                    '.'
                };
                write!(f, "{mark}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_yard_has_its_parcels_and_most_have_obstacles() {
        let mut obstacles = 0;
        for seed in 0..60 {
            let parcels = 1 + u32::try_from(seed).unwrap() % MOST_PARCELS;
            let yard = Yard::new(parcels, seed).unwrap();
            assert_eq!(yard.parcels.len(), parcels as usize, "seed {seed}");
            assert_eq!(yard.target.cell().map(|cell| yard.hall.truth(cell)), Some(Truth::Free));
            let bounds = yard.hall.bounds();
            let walls = (bounds.least.y..=bounds.most.y)
                .flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)))
                .filter(|cell| yard.hall.truth(*cell) == Truth::Wall);
            obstacles += usize::from(walls.count() > 5);
        }
        assert!(obstacles > 50, "{obstacles} of 60");
    }

    #[test]
    fn the_same_seed_draws_the_same_yard() {
        assert_eq!(Yard::new(5, 3), Yard::new(5, 3));
        assert_ne!(Yard::new(5, 3), Yard::new(5, 4));
    }

    #[test]
    fn no_parcel_and_too_many_are_refused_in_words() {
        let words = Yard::new(25, 1).unwrap_err().to_string();
        assert_eq!(words, "the pallet cannot have 25 parcels: give 1 to 24");
        assert!(Yard::new(0, 1).is_err());
    }
}
