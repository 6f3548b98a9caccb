//! A search without a mission round it: strategy, grid and the truth of a hall, move by move. It is what `explore` does, less
//! everything that takes no moves.

use hallsweep_core::command::Move;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::grid::{Grid, Square};
use hallsweep_core::search::outlook::Gait;
use hallsweep_core::search::scored::{Candidate, choose};
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::weights::Weights;
use hallsweep_core::search::{NextGoal, Objective, Search, Sensing, View};
use hallsweep_core::units::{Cell, Heading, Pose};
use hallsweep_core::world::hall_map::Bounds;
use hallsweep_sim::{Hall, Truth};

/// What a cell really is, laid out for speed.
#[derive(Clone, Debug)]
pub struct Ground {
    bounds: Bounds,
    width: i32,
    /// 0 free, 1 wall, 2 luggage; a rim of walls round it.
    squares: Vec<u8>,
    /// Cells that can be reached, home included.
    pub reachable: usize,
    /// Luggage that can be touched.
    pub touchable: usize,
    /// For each cell whether it can be reached, or touched.
    within: Vec<u8>,
}

impl Ground {
    /// The ground of a hall.
    pub fn of(hall: &Hall) -> Ground {
        let bounds = hall.bounds().grown(1);
        let width = bounds.width();
        let mut squares = Vec::new();
        for y in bounds.least.y..=bounds.most.y {
            for x in bounds.least.x..=bounds.most.x {
                squares.push(match hall.truth(Cell::new(x, y)) {
                    Truth::Free => 0,
                    Truth::Wall => 1,
                    Truth::Luggage(_) => 2,
                });
            }
        }
        let mut ground = Ground { bounds, width, within: vec![0; squares.len()], squares, reachable: 0, touchable: 0 };
        ground.flood();
        ground
    }

    fn flood(&mut self) {
        let mut border = vec![Cell::HOME];
        let home = self.place(Cell::HOME);
        self.within[home] = 1;
        while let Some(cell) = border.pop() {
            self.reachable += 1;
            for next in cell.neighbours() {
                let place = self.place(next);
                if self.within[place] != 0 {
                    continue;
                }
                match self.squares[place] {
                    0 => {
                        self.within[place] = 1;
                        border.push(next);
                    }
                    2 => {
                        self.within[place] = 2;
                        self.touchable += 1;
                    }
                    _ => {}
                }
            }
        }
    }

    /// How many cells it is laid out with.
    pub fn size(&self) -> usize {
        self.squares.len()
    }

    /// The number of a cell.
    pub fn place(&self, cell: Cell) -> usize {
        ((cell.y - self.bounds.least.y) * self.width + cell.x - self.bounds.least.x) as usize
    }

    /// 0 free, 1 wall, 2 luggage.
    pub fn at(&self, cell: Cell) -> u8 {
        if self.bounds.contains(cell) { self.squares[self.place(cell)] } else { 1 }
    }

    /// All cells that can be reached or touched.
    pub fn cells(&self) -> Vec<Cell> {
        let bounds = self.bounds;
        (bounds.least.y..=bounds.most.y)
            .flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)))
            .filter(|cell| self.within(*cell) != 0)
            .collect()
    }

    /// 1 reachable, 2 luggage that can be touched.
    pub fn within(&self, cell: Cell) -> u8 {
        if self.bounds.contains(cell) { self.within[self.place(cell)] } else { 0 }
    }
}

/// How far a walk has come.
#[derive(Clone, Debug)]
pub struct Walk {
    /// What is known.
    pub grid: Grid,
    /// Where the robot stands.
    pub pose: Pose,
    /// How it came there.
    pub gait: Gait,
    /// Cells driven, quarter turns, bumps.
    pub moves: [u64; 3],
    /// Cells visited.
    pub visited: usize,
    /// Pieces touched.
    pub touched: usize,
    /// The sum over the pieces touched of the moves before.
    pub touch_sum: u64,
    /// The sum over cells entered or touched of the moves before.
    pub enter_sum: u64,
    /// The cells seen ahead; 0: bump only.
    pub sonar: u8,
    /// A hash of what is known.
    pub hash: u64,
}

fn mix(cell: Cell, salt: u64) -> u64 {
    let mut x = (cell.x as u32 as u64) << 32 | cell.y as u32 as u64;
    x = x.wrapping_add(salt).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^ x >> 32
}

impl Walk {
    /// A robot at home.
    pub fn new(ground: &Ground, sonar: u8) -> Walk {
        let mut grid = Grid::with_room_for(ground.bounds);
        grid.set(Cell::HOME, Square::Visited);
        let mut walk = Walk {
            grid,
            pose: Pose::START,
            gait: Gait::default(),
            moves: [0; 3],
            visited: 1,
            touched: 0,
            touch_sum: 0,
            enter_sum: 0,
            sonar,
            hash: 0,
        };
        walk.look(ground);
        walk
    }

    /// All moves, one unit each.
    pub fn total(&self) -> u64 {
        self.moves.iter().sum()
    }

    /// A number for what is known and where the robot stands.
    pub fn state(&self) -> u64 {
        self.hash ^ mix(self.pose.cell, 77 + self.pose.heading as u64)
    }

    /// Makes one move; false when it met an obstacle.
    pub fn make(&mut self, ground: &Ground, step: Move) -> bool {
        self.gait = self.gait.after(step);
        match step {
            Move::TurnLeft => self.turn(self.pose.heading.left(), ground),
            Move::TurnRight => self.turn(self.pose.heading.right(), ground),
            _ => {
                let ahead = self.pose.ahead();
                if ground.at(ahead) != 0 {
                    self.moves[2] += 1;
                    self.meet(ground, ahead, self.pose.heading);
                    return false;
                }
                self.moves[0] += 1;
                self.pose.cell = ahead;
                if self.grid.at(ahead) != Square::Visited {
                    self.grid.set(ahead, Square::Visited);
                    self.hash ^= mix(ahead, 2);
                    self.visited += 1;
                    self.enter_sum += self.total();
                }
                self.look(ground);
            }
        }
        true
    }

    fn turn(&mut self, heading: Heading, ground: &Ground) {
        self.moves[1] += 1;
        self.pose.heading = heading;
        self.look(ground);
    }

    fn block(&mut self, cell: Cell) {
        if self.grid.at(cell) != Square::Obstacle {
            self.grid.set(cell, Square::Obstacle);
            self.hash ^= mix(cell, 3);
        }
    }

    fn meet(&mut self, ground: &Ground, cell: Cell, heading: Heading) {
        if self.grid.at(cell) == Square::Obstacle {
            return;
        }
        self.block(cell);
        if ground.at(cell) == 2 {
            self.touched += 1;
            self.touch_sum += self.total();
            self.enter_sum += self.total();
            return;
        }
        for side in [heading.left(), heading.right()] {
            let mut here = cell.ahead(heading.opposite());
            loop {
                here = here.ahead(side);
                if ground.at(here) != 0 || ground.at(here.ahead(heading)) != 1 {
                    break;
                }
                self.block(here.ahead(heading));
            }
        }
    }

    /// The front sonar, where there is one.
    fn look(&mut self, ground: &Ground) {
        let mut cell = self.pose.cell;
        for away in 0..self.sonar {
            cell = cell.ahead(self.pose.heading);
            if ground.at(cell) == 0 {
                if self.grid.at(cell) == Square::Unknown {
                    self.grid.set(cell, Square::Seen);
                    self.hash ^= mix(cell, 5);
                }
            } else {
                if away == 0 {
                    self.meet(ground, cell, self.pose.heading);
                }
                break;
            }
        }
    }

    /// What a strategy sees.
    pub fn view(&self, costs: Costs, objective: Objective) -> View<'_> {
        let sensing = if self.sonar > 0 { Sensing::Sonar } else { Sensing::Bump };
        View { grid: &self.grid, pose: self.pose, gait: self.gait, costs, objective, sensing }
    }

    /// Chooses the next entry by these weights; `None` when nothing is left.
    pub fn choose(
        &self,
        ways: &mut Ways,
        costs: Costs,
        weights: &Weights,
        slack: i32,
        seen: impl FnMut(Candidate),
    ) -> Option<(Cell, Vec<Move>)> {
        choose(&self.view(costs, Objective::Cover), ways, weights, slack, seen)
    }

    /// Goes a way into an unknown cell, as far as nothing is in the way. With sonar it ends as soon as the cell proves blocked.
    pub fn enter(&mut self, ground: &Ground, (cell, route): &(Cell, Vec<Move>)) {
        for step in route {
            if self.grid.at(*cell) == Square::Obstacle || !self.make(ground, *step) {
                return;
            }
        }
    }

    /// Goes home.
    pub fn go_home(&mut self, ground: &Ground, ways: &mut Ways, costs: Costs) {
        for step in ways.way_over_visited(&self.grid, costs, self.pose, Cell::HOME).expect("the robot came from home") {
            self.make(ground, step);
        }
    }

    /// The whole search with these weights.
    pub fn run(ground: &Ground, sonar: u8, ways: &mut Ways, costs: Costs, weights: &Weights) -> Walk {
        let mut walk = Walk::new(ground, sonar);
        while let Some(visit) = walk.choose(ways, costs, weights, 0, |_| ()) {
            walk.enter(ground, &visit);
        }
        walk.go_home(ground, ways, costs);
        walk
    }

    /// The whole search by this strategy.
    pub fn search(ground: &Ground, sonar: u8, ways: &mut Ways, costs: Costs, objective: Objective, mut search: Search) -> Walk {
        let mut walk = Walk::new(ground, sonar);
        loop {
            match search.next(&walk.view(costs, objective), ways) {
                NextGoal::Visit(cell, route) if route.is_empty() => walk.dare(ground, ways, costs, cell),
                NextGoal::Visit(cell, route) => walk.enter(ground, &(cell, route)),
                NextGoal::GoHome => walk.go_home(ground, ways, costs),
                NextGoal::Finished => break,
            }
        }
        walk.go_home(ground, ways, costs);
        walk
    }

    /// To a cell as if everything unknown were free; until it is visited, blocked or out of reach.
    fn dare(&mut self, ground: &Ground, ways: &mut Ways, costs: Costs, cell: Cell) {
        while !matches!(self.grid.at(cell), Square::Visited | Square::Obstacle) {
            let Some(route) = ways.way_over_unknown(&self.grid, costs, self.pose, cell).filter(|route| !route.is_empty()) else {
                return;
            };
            self.enter(ground, &(cell, route));
        }
    }
}
