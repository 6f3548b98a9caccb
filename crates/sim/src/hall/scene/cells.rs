//! Makes a hall from a scene. A cell is as large as the player, and home is the cell where the player stands. The
//! hall contains what the player would meet by driving from cell to cell. Columns and rows are as on the page, with
//! north at the top.
//!
//! ```text
//!   ·───►·───►│#     a cell is free if a step into it can end there;
//!                  otherwise it is the thing that stopped the first step: a wall or a piece of luggage
//! ```
//! Even a very thin thing cannot stand between two free cells. It keeps the player's middle half a player away on
//! both sides, so the blocked strip is at least one cell wide.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::{PLAYER, Scene, StaticObstacle};
use crate::bag::{Bag, BagKind};
use crate::hall::error::HallFault;
use crate::hall::rows::{DrawingRows, sides};
use crate::hall::{Hall, Plan, Truth};
use hallsweep_core::units::{Cell, Piece};
use hallsweep_core::world::hall_map::Bounds;

/// The page's name for the border of the floor.
const BORDER: &str = "floor-border";

#[derive(Clone, Debug, PartialEq)]
pub struct HallOfScene {
    /// The hall. Its home cell is the player's place.
    pub hall: Hall,
    /// Parts of the scene that are not in the hall, in a few words each.
    pub lost: Vec<String>,
}

/// What the player finds when it tries every step from every cell that it can reach.
#[derive(Default)]
struct ReachedCells<'a> {
    free: BTreeSet<Cell>,
    /// Cells that cannot be entered, each with the thing that stopped the first step into it.
    taken: BTreeMap<Cell, &'a str>,
}

impl Scene {
    /// Makes the hall that the player would find. `name` is the name of the hall.
    ///
    /// Fails if the player stands in an obstacle, because the player could then make no step.
    pub fn hall(&self, name: &str) -> Result<HallOfScene, HallFault> {
        let found = self.found()?;
        let pieces = found.pieces();
        let places = || found.free.iter().chain(pieces.iter().flatten()).copied();
        let bounds = places().fold(Bounds::of(Cell::HOME), |bounds, cell| Bounds {
            least: Cell::new(bounds.least.x.min(cell.x), bounds.least.y.min(cell.y)),
            most: Cell::new(bounds.most.x.max(cell.x), bounds.most.y.max(cell.y)),
        });
        let mut plan = drawing(&found, &pieces, bounds)?;
        for bag in &mut plan.bags {
            *bag = Bag::of_kind(BagKind::Box, bag.piece, std::mem::take(&mut bag.cells));
        }
        Ok(HallOfScene { hall: Hall::of(name, plan), lost: self.lost(&found, pieces.len()) })
    }

    fn found(&self) -> Result<ReachedCells<'_>, HallFault> {
        if let Some(name) = self.what_is_at(self.player.x, self.player.z) {
            return Err(HallFault::PlayerStuck(name.to_owned()));
        }
        let mut found = ReachedCells { free: BTreeSet::from([Cell::HOME]), ..ReachedCells::default() };
        let mut waiting = VecDeque::from([Cell::HOME]);
        while let Some(cell) = waiting.pop_front() {
            for next in cell.neighbours() {
                match self.contact(cell, next) {
                    Some(name) => drop(found.taken.entry(next).or_insert(name)),
                    None if found.free.insert(next) => waiting.push_back(next),
                    None => {}
                }
            }
        }
        Ok(found)
    }

    /// The thing that keeps the player's middle away from this point, if there is one.
    fn what_is_at(&self, x: f64, z: f64) -> Option<&str> {
        let is_beyond = x.abs() > self.floor.x / 2.0 || z.abs() > self.floor.z / 2.0;
        let within = |thing: &&StaticObstacle| {
            let [along_x, along_z] = kept_free(thing);
            (along_x.0..=along_x.1).contains(&x) && (along_z.0..=along_z.1).contains(&z)
        };
        self.statics.iter().find(within).map(|thing| thing.name.as_str()).or(is_beyond.then_some(BORDER))
    }

    /// The first thing that the player meets on the way from the middle of one cell to the middle of the next.
    fn contact(&self, from: Cell, to: Cell) -> Option<&str> {
        let turned = from.x == to.x;
        let axes = |[x, z]: [(f64, f64); 2]| if turned { [z, x] } else { [x, z] };
        let place = |cell: Cell| (self.player.x + PLAYER * f64::from(cell.x), self.player.z + PLAYER * f64::from(cell.y));
        let ((from_x, from_z), (to_x, to_z)) = (place(from), place(to));
        let [(begin, end), (across, _)] = axes([(from_x, to_x), (from_z, to_z)]);
        let meets = |thing: &StaticObstacle| {
            let [along, beside] = axes(kept_free(thing));
            let nearest = begin.clamp(along.0, along.1);
            let is_met = (beside.0..=beside.1).contains(&across) && (begin.min(end)..=begin.max(end)).contains(&nearest);
            is_met.then_some((nearest - begin).abs())
        };
        let things = self.statics.iter().filter_map(|thing| Some((meets(thing)?, thing.name.as_str())));
        let edge = if turned { self.floor.z } else { self.floor.x } / 2.0;
        let border = (end.abs() > edge).then_some((edge - begin.abs(), BORDER));
        things.chain(border).min_by(|(first, _), (second, _)| first.total_cmp(second)).map(|(_, name)| name)
    }

    fn lost(&self, found: &ReachedCells<'_>, pieces: usize) -> Vec<String> {
        let met: BTreeSet<&str> = found.taken.values().copied().collect();
        let names: BTreeSet<&str> = found.luggage().map(|(_, name)| name).collect();
        let hidden = self.statics.iter().filter(|thing| !met.contains(thing.name.as_str())).count();
        let counted = [
            (self.moving.len(), "the moving obstacles"),
            (self.sonars.len(), "the sonars of the hall"),
            (pieces, "the names of luggage"),
            (pieces - names.len(), "which pieces of luggage had the same name"),
            (hidden, "the obstacles that the robot cannot meet"),
        ];
        counted.into_iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{what} ({count})")).collect()
    }
}

impl<'a> ReachedCells<'a> {
    fn luggage(&self) -> impl Iterator<Item = (Cell, &'a str)> {
        let is_wall = |name: &str| name.starts_with("wall") || name == BORDER;
        self.taken.iter().filter(move |(_, name)| !is_wall(name)).map(|(cell, name)| (*cell, *name))
    }

    /// The cells of each piece: touching cells with the same name are one piece.
    fn pieces(&self) -> Vec<Vec<Cell>> {
        let mut left: BTreeMap<Cell, &str> = self.luggage().collect();
        let mut pieces = Vec::new();
        while let Some((first, name)) = left.pop_first() {
            let mut cells = vec![first];
            let mut looked_at = 0;
            while let Some(cell) = cells.get(looked_at).copied() {
                looked_at += 1;
                for next in cell.neighbours() {
                    if left.get(&next) == Some(&name) {
                        left.remove(&next);
                        cells.push(next);
                    }
                }
            }
            pieces.push(cells);
        }
        pieces
    }
}

/// The ranges of x and z that this thing blocks for the player's middle.
fn kept_free(thing: &StaticObstacle) -> [(f64, f64); 2] {
    let half = PLAYER / 2.0;
    [(thing.min_x - half, thing.max_x + half), (thing.min_z - half, thing.max_z + half)]
}

fn drawing(found: &ReachedCells<'_>, pieces: &[Vec<Cell>], bounds: Bounds) -> Result<Plan, HallFault> {
    let side = |cells: i32| u64::try_from(cells).unwrap_or(0);
    let size = sides(side(bounds.width()), side(bounds.height()))?;
    let of_piece = |(index, cells): (usize, &Vec<Cell>)| cells.iter().map(move |cell| (*cell, index)).collect::<Vec<_>>();
    let luggage: BTreeMap<Cell, usize> = pieces.iter().enumerate().flat_map(of_piece).collect();
    let mut numbers: BTreeMap<usize, Piece> = BTreeMap::new();
    let mut reading = DrawingRows::default();
    for y in bounds.least.y..=bounds.most.y {
        for cell in (bounds.least.x..=bounds.most.x).map(|x| Cell::new(x, y)) {
            let place = Cell::new(cell.x - bounds.least.x, cell.y - bounds.least.y);
            let square = match luggage.get(&cell) {
                _ if found.free.contains(&cell) => Truth::Free,
                None => Truth::Wall,
                Some(index) => match numbers.get(index) {
                    Some(piece) => Truth::Luggage(reading.extend(*piece, place)),
                    None => Truth::Luggage(*numbers.entry(*index).or_insert(reading.new_piece(place)?)),
                },
            };
            reading.squares.push(square);
        }
    }
    Ok(reading.plan(Cell::new(-bounds.least.x, -bounds.least.y), size))
}
