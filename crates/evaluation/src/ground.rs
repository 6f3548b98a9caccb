//! A copy of the true hall on which walks are fast to compute. The copy also contains which cells a robot can reach.

use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::Bounds;
use hallsweep_sim::{Hall, Truth};

/// The cells of a hall and one row of wall around them.
#[derive(Clone, Debug)]
pub struct Ground {
    bounds: Bounds,
    squares: Vec<Truth>,
    /// For each cell, whether the robot can reach it. For luggage, whether the robot can touch it.
    within: Vec<bool>,
    /// Number of cells that can be reached, home included.
    pub reachable: usize,
    /// Number of free cells, reachable or not.
    pub free: usize,
    /// Number of cells of luggage beside a reachable cell.
    pub touchable: usize,
}

impl Ground {
    #[must_use]
    pub fn of(hall: &Hall) -> Ground {
        let bounds = hall.bounds().grown(1);
        let rows = (bounds.least.y..=bounds.most.y).flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)));
        let squares: Vec<Truth> = rows.map(|cell| hall.truth(cell)).collect();
        let free = squares.iter().filter(|truth| **truth == Truth::Free).count();
        let mut ground = Ground { bounds, within: vec![false; squares.len()], squares, reachable: 0, free, touchable: 0 };
        ground.flood();
        ground
    }

    fn flood(&mut self) {
        let mut border = vec![Cell::HOME];
        let home = self.place(Cell::HOME);
        self.within[home] = true;
        while let Some(cell) = border.pop() {
            self.reachable += 1;
            for next in cell.neighbours() {
                let place = self.place(next);
                if !self.within[place] {
                    self.within[place] = self.squares[place] != Truth::Wall;
                    match self.squares[place] {
                        Truth::Free => border.push(next),
                        Truth::Luggage(_) => self.touchable += 1,
                        Truth::Wall => {}
                    }
                }
            }
        }
    }

    /// The rectangle of all cells, including the wall around the hall.
    #[must_use]
    pub const fn bounds(&self) -> Bounds {
        self.bounds
    }

    #[must_use]
    pub fn at(&self, cell: Cell) -> Truth {
        if self.bounds.contains(cell) { self.squares[self.place(cell)] } else { Truth::Wall }
    }

    /// Whether the robot can reach this cell, or can touch it if it is luggage.
    #[must_use]
    pub fn is_within(&self, cell: Cell) -> bool {
        self.bounds.contains(cell) && self.within[self.place(cell)]
    }

    /// All cells that the robot can reach or touch, row by row.
    #[must_use]
    pub fn cells(&self) -> Vec<Cell> {
        let Bounds { least, most } = self.bounds;
        let all = (least.y..=most.y).flat_map(|y| (least.x..=most.x).map(move |x| Cell::new(x, y)));
        all.filter(|cell| self.is_within(*cell)).collect()
    }

    /// Number of cells, including the wall around the hall.
    #[must_use]
    pub(crate) const fn size(&self) -> usize {
        self.squares.len()
    }

    /// The index of a cell. Cells are counted row by row from the north-west corner, including the wall around the
    /// hall.
    pub(crate) fn place(&self, cell: Cell) -> usize {
        let place = (cell.y - self.bounds.least.y) * self.bounds.width() + cell.x - self.bounds.least.x;
        usize::try_from(place).expect("a cell inside the rectangle has a place")
    }
}
