//! A search without a mission, move by move: strategy, known cells, and the true hall. Its moves are those of a
//! mission in which the operator declares everything safe. A walk takes a hundredth of the time of such a mission.

use std::sync::Arc;

use hallsweep_core::command::Move;
use hallsweep_core::search::Gait;
use hallsweep_core::search::areas::AreaPlan;
use hallsweep_core::search::costs::{Costs, STEP};
use hallsweep_core::search::grid::{Grid, Square};
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::{NextGoal, Objective, Search, Terms, View};
use hallsweep_core::units::{Cell, Heading, Pose};
use hallsweep_sim::Truth;
use hallsweep_sim::headless::Moves;

use crate::Ground;

/// The total cost of these moves, in steps.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "no search makes 2^53 moves")]
pub fn cost(moves: Moves, costs: Costs) -> f64 {
    let units = |moves: u64, each: u32| moves as f64 * f64::from(each);
    let sum = units(moves.steps, STEP) + units(moves.turns, costs.turn) + units(moves.bumps, costs.bump);
    sum / f64::from(STEP)
}

#[derive(Clone, Debug)]
pub struct Walk {
    terms: Terms,
    pub areas: Option<Arc<AreaPlan>>,
    pub grid: Grid,
    pub pose: Pose,
    gait: Gait,
    pub moves: Moves,
    pub visited: usize,
    pub found: usize,
    /// Sum over all found pieces of luggage: the number of moves before the piece was found.
    pub found_after: u64,
    /// Number of cells and pieces whose content is known.
    pub known: usize,
    /// Sum over all known cells and pieces: the number of moves before the content became known. If the cell had
    /// contained a piece, the piece would have been found at that moment.
    pub known_after: u64,
    /// Each cell and piece, with the cost in steps after which it became known. `None` if the caller does not need them.
    pub known_at: Option<Vec<(Cell, f64)>>,
    /// All cells in which the robot stood, in order. `None` if the caller does not need them.
    pub trail: Option<Vec<Cell>>,
    /// Whether the search decides again as soon as anything new is seen.
    pub heeds_news: bool,
    /// Whether a new obstacle was met or seen since the last decision of the search.
    has_met: bool,
    /// Whether the sonar has seen anything new since the last decision of the search.
    has_news: bool,
    /// A hash of everything that is known.
    print: u64,
}

impl Walk {
    #[must_use]
    pub fn new(ground: &Ground, terms: Terms) -> Walk {
        let mut grid = Grid::with_room_for(ground.bounds());
        grid.set(Cell::HOME, Square::Visited);
        let (pose, gait, moves) = (Pose::START, Gait::default(), Moves::default());
        Walk {
            terms,
            areas: None,
            grid,
            pose,
            gait,
            moves,
            visited: 1,
            found: 0,
            found_after: 0,
            known: 1,
            known_after: 0,
            known_at: None,
            trail: None,
            heeds_news: true,
            has_met: false,
            has_news: false,
            print: 0,
        }
    }

    #[must_use]
    pub fn view(&self) -> View<'_> {
        View {
            grid: &self.grid,
            pose: self.pose,
            gait: self.gait,
            terms: self.terms,
            areas: self.areas.as_deref().map(AreaPlan::focus),
        }
    }

    /// A hash of the known cells and the pose. Two walks through the same hall with the same hash continue in the
    /// same way, except for effects of their last moves (`gait`).
    #[must_use]
    pub fn state(&self) -> u64 {
        self.print ^ mixed(self.pose.cell, 64 + self.pose.heading as u64)
    }

    /// Whether this cell still has to be visited or seen. To find luggage, seeing the cell is enough.
    #[must_use]
    pub fn is_left(&self, cell: Cell) -> bool {
        match self.grid.at(cell) {
            Square::Visited => false,
            Square::Seen => self.terms.objective == Objective::Cover,
            Square::Unknown | Square::Obstacle | Square::Target | Square::Luggage | Square::KeptOut => true,
        }
    }

    /// The cost of the moves so far, in steps.
    #[must_use]
    pub fn cost(&self) -> f64 {
        cost(self.moves, self.terms.costs)
    }

    /// Makes the whole search from here, until nothing is left to search and the robot is at home.
    pub fn finish(&mut self, ground: &Ground, ways: &mut Ways, mut search: Search) {
        self.heeds_news = search.strategy().heeds_news();
        loop {
            let goal = search.next(&self.view(), ways);
            if !self.follow(ground, ways, goal) {
                return;
            }
        }
    }

    /// Carries out the goal that a strategy has set. Returns false after the end of the search, when the robot is at
    /// home.
    pub fn follow(&mut self, ground: &Ground, ways: &mut Ways, goal: NextGoal) -> bool {
        match goal {
            NextGoal::Visit(cell, route) => {
                self.enter(ground, cell, &route);
                if !(self.heeds_news && self.has_news) {
                    self.dare(ground, ways, cell);
                }
            }
            NextGoal::GoHome => self.go_home(ground, ways),
            NextGoal::Finished => {
                self.go_home(ground, ways);
                return false;
            }
        }
        true
    }

    /// Makes the moves of `route` towards a cell. It stops early if something is in the way or a new obstacle is
    /// seen. If `heeds_news` is set, it also stops when anything new is seen.
    pub fn enter(&mut self, ground: &Ground, cell: Cell, route: &[Move]) {
        (self.has_met, self.has_news) = (false, false);
        for step in route {
            if self.grid.at(cell).is_settled() || !self.make(ground, *step) || self.has_met || self.heeds_news && self.has_news {
                return;
            }
        }
    }

    /// Drives home, over visited cells only.
    pub fn go_home(&mut self, ground: &Ground, ways: &mut Ways) {
        let way = ways.way_over_visited(&self.grid, self.terms.costs, self.pose, Cell::HOME);
        for step in way.expect("the robot came from home, and nothing has moved since") {
            self.make(ground, step);
        }
    }

    /// Drives towards a cell as if all unknown cells were free. It ends when the content of the cell is known or when
    /// the cell cannot be reached. After each new obstacle, the route is planned again.
    fn dare(&mut self, ground: &Ground, ways: &mut Ways, cell: Cell) {
        while self.grid.at(cell) != Square::Visited && !self.grid.at(cell).is_settled() {
            let way = ways.way_over_unknown(&self.grid, self.terms.costs, self.pose, cell);
            let Some(way) = way.filter(|way| !way.is_empty()) else { return };
            self.enter(ground, cell, &way);
            if self.heeds_news && self.has_news {
                return;
            }
        }
    }

    /// Makes one move. Returns false if it met an obstacle.
    fn make(&mut self, ground: &Ground, step: Move) -> bool {
        match step {
            Move::TurnLeft => self.turn(self.pose.heading.left()),
            Move::TurnRight => self.turn(self.pose.heading.right()),
            Move::Forward | Move::Backward | Move::NudgeLeft | Move::NudgeRight => {
                let ahead = self.pose.ahead();
                if ground.at(ahead) != Truth::Free {
                    self.moves.bumps += 1;
                    self.meet(ground, self.pose.cell);
                    return false;
                }
                self.step_into(ahead);
            }
        }
        self.gait = self.gait.after(step);
        self.look_ahead(ground);
        true
    }

    fn turn(&mut self, heading: Heading) {
        self.moves.turns += 1;
        self.pose.heading = heading;
    }

    fn step_into(&mut self, cell: Cell) {
        self.moves.steps += 1;
        self.pose.cell = cell;
        if let Some(trail) = &mut self.trail {
            trail.push(cell);
        }
        if self.grid.at(cell) != Square::Visited {
            self.learn(cell, Square::Visited);
            self.visited += 1;
        }
    }

    fn learn(&mut self, cell: Cell, square: Square) {
        if square != Square::Obstacle && self.grid.at(cell) == Square::Unknown {
            self.known += 1;
            self.known_after += self.moves.total();
            let cost = self.cost();
            self.known_at.iter_mut().for_each(|known| known.push((cell, cost)));
        }
        self.grid.set(cell, square);
        self.print ^= mixed(cell, square as u64);
    }

    /// Recognises the obstacle ahead of `before`. If the obstacle is a wall, the whole straight wall that can be seen
    /// becomes known.
    fn meet(&mut self, ground: &Ground, before: Cell) {
        let cell = before.ahead(self.pose.heading);
        if self.grid.at(cell).is_settled() {
            return;
        }
        self.has_met = true;
        let is_wall = ground.at(cell) == Truth::Wall;
        self.learn(cell, if is_wall { Square::Obstacle } else { Square::Luggage });
        if !is_wall {
            self.found += 1;
            self.found_after += self.moves.total();
            return;
        }
        for side in [self.pose.heading.left(), self.pose.heading.right()] {
            let mut before = before.ahead(side);
            while ground.at(before) == Truth::Free && ground.at(before.ahead(self.pose.heading)) == Truth::Wall {
                let wall = before.ahead(self.pose.heading);
                if !self.grid.at(wall).is_settled() {
                    self.learn(wall, Square::Obstacle);
                }
                before = before.ahead(side);
            }
        }
    }

    /// Looks ahead with the front sonar. Without a sonar, its range is 0 cells.
    fn look_ahead(&mut self, ground: &Ground) {
        let mut cell = self.pose.cell;
        for _ in 0..self.terms.sonar_cells {
            let before = cell;
            cell = cell.ahead(self.pose.heading);
            let is_free = ground.at(cell) == Truth::Free;
            self.has_news |= self.grid.at(cell) == Square::Unknown;
            if !is_free {
                self.meet(ground, before);
                return;
            }
            if self.grid.at(cell) == Square::Unknown {
                self.learn(cell, Square::Seen);
            }
        }
    }
}

/// A hash of one fact about a cell. The hash of several facts is the XOR of their hashes.
fn mixed(cell: Cell, salt: u64) -> u64 {
    let place = (u64::from(cell.x.cast_unsigned()) << 32) | u64::from(cell.y.cast_unsigned());
    let mut x = place.wrapping_add(salt.wrapping_mul(0x2545_F491_4F6C_DD1D)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^ (x >> 32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::family::{Family, hall};
    use hallsweep_core::command::Strategy;
    use hallsweep_core::rng::RandomStream;
    use hallsweep_core::settings::Settings;
    use hallsweep_sim::headless::{Verdicts, explore};
    use hallsweep_sim::{Camera, SimSettings};

    const BUMP: Terms = Terms { objective: Objective::Cover, sonar_cells: 0, costs: Costs::EVEN };

    #[test]
    fn every_strategy_visits_all_that_can_be_reached_in_every_family_and_comes_home() {
        let mut ways = Ways::default();
        for (n, family) in (0..).zip(Family::ALL) {
            for strategy in Strategy::ALL {
                for sonar_cells in [0, 1, 3] {
                    let ground = Ground::of(&hall(family, 17, 13, &mut RandomStream::new(n, "walk")));
                    let mut walk = Walk::new(&ground, Terms { sonar_cells, ..BUMP });
                    walk.finish(&ground, &mut ways, strategy.begin());
                    let of = format!("{family:?} by {}, sonar {sonar_cells}", strategy.name());
                    assert_eq!((walk.visited, walk.found), (ground.reachable, ground.touchable), "{of}");
                    assert_eq!(walk.pose.cell, Cell::HOME, "{of}");
                    // The robot does not look ahead before its first move, so one bump is possible even with a sonar.
                    assert!(if sonar_cells == 0 { walk.moves.bumps > 0 } else { walk.moves.bumps <= 1 }, "{of}");
                }
            }
        }
    }

    /// These halls are too large for a search over all pairs of cell and heading. So some routes are long.
    #[test]
    fn large_halls_are_covered_too() {
        let mut ways = Ways::default();
        for (family, side) in [(Family::Luggage(0.1), 220), (Family::Maze, 181)] {
            let ground = Ground::of(&hall(family, side, side, &mut RandomStream::new(1, "large")));
            for strategy in [Strategy::Auto, Strategy::Frontier, Strategy::Columns] {
                let mut walk = Walk::new(&ground, BUMP);
                walk.finish(&ground, &mut ways, strategy.begin());
                let of = format!("{family:?} by {}", strategy.name());
                assert_eq!((walk.visited, walk.found), (ground.reachable, ground.touchable), "{of}");
                assert_eq!(walk.pose.cell, Cell::HOME, "{of}");
            }
        }
    }

    /// A walk must make the same moves as a mission in which the operator declares everything safe.
    #[test]
    fn a_walk_makes_the_moves_of_a_mission() {
        let mut ways = Ways::default();
        for (n, family) in (0..).zip(Family::ALL) {
            for strategy in Strategy::ALL {
                for sonar_cells in [0, 1, 3] {
                    let hall = Arc::new(hall(family, 14, 11, &mut RandomStream::new(n, "mission")));
                    let objective = Objective::ALL[usize::try_from(n % 2).unwrap()];
                    let costs = Costs::weighed(1.0, 1.5, 1.0).unwrap();
                    let mut walk = Walk::new(&Ground::of(&hall), Terms { objective, sonar_cells, costs });
                    walk.finish(&Ground::of(&hall), &mut ways, strategy.begin());
                    let sim = SimSettings { sonar_cells, ..SimSettings::new(n, Camera::Stub) };
                    let settings = Settings { objective, sonar_cells, costs: Some(costs), ..Settings::default() };
                    let mission = explore(&hall, sim, settings, strategy, Verdicts::AllSafe, |_| {});
                    let of = format!("{family:?} by {}, sonar {sonar_cells}", strategy.name());
                    assert_eq!(walk.moves, mission.moves, "{of}");
                    assert!(mission.complete && mission.home, "{of}");
                }
            }
        }
    }

    #[test]
    fn costs_weigh_moves_against_a_step() {
        let moves = Moves { steps: 10, turns: 4, bumps: 2 };
        assert_eq!(cost(moves, Costs::EVEN), 16.0);
        assert_eq!(cost(moves, Costs::weighed(2.0, 3.0, 1.0).unwrap()), 10.0 + 6.0 + 1.0);
    }
}
