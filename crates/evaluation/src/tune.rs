//! Finds the weights of the score: the linear part by cross-entropy, the tables by regression on counterfactuals.
//!
//! ```text
//!   cross-entropy: candidates round a mean ─► each over the same fresh halls ─► the mean and spread of the best ─► again
//!   counterfactuals: at random decisions one alternative is forced and the policy followed on, for a horizon; what is left then is
//!     estimated by a control variate that knows the hall. Ridge regression of (difference of cost − difference of score) on the
//!     differences of rows ─► a better policy ─► again
//! ```

use std::collections::HashMap;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use hallsweep_core::command::Move;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::grid::Square;
use hallsweep_core::search::outlook::{LINEAR, Outlook, ROWS};
use hallsweep_core::search::scored::Candidate;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::weights::Weights;
use hallsweep_core::units::Cell;

use crate::family::{Family, hall};
use crate::walk::{Ground, Walk};

/// What is tuned for.
#[derive(Clone, Copy, Debug)]
pub struct Task {
    /// Whether luggage is to be found soon rather than the hall covered in few moves.
    pub find: bool,
    /// Cells seen ahead.
    pub sonar: u8,
    /// What moves cost.
    pub costs: Costs,
    /// The side of the halls, least and most.
    pub side: (usize, usize),
    /// The families, with how many of a hundred halls are of each.
    pub mix: &'static [(u64, Family)],
}

impl Task {
    /// A training hall.
    pub fn ground(&self, seed: u64) -> Ground {
        let mut dice = RandomStream::new(seed, "tune");
        loop {
            let mut draw = dice.below(100);
            let family = self
                .mix
                .iter()
                .find(|(share, _)| {
                    let hit = draw < *share;
                    draw = draw.saturating_sub(*share);
                    hit
                })
                .map_or(Family::Luggage(0.1), |(_, family)| *family);
            let span = (self.side.1 - self.side.0 + 1) as u64;
            let mut side = || self.side.0 + dice.below(span) as usize;
            let (columns, lines) = (side(), side());
            let ground = Ground::of(&hall(family, columns, lines, &mut dice));
            if ground.reachable * 3 > columns * lines {
                return ground;
            }
        }
    }

    /// What a whole walk costs, per reachable cell.
    pub fn price(&self, ground: &Ground, walk: &Walk) -> f64 {
        let cells = ground.reachable as f64;
        if self.find {
            walk.enter_sum as f64 / (ground.reachable + ground.touchable) as f64 / cells
        } else {
            self.weighed(walk) / cells
        }
    }

    fn weighed(&self, walk: &Walk) -> f64 {
        let Costs { step, turn, bump } = self.costs;
        let sum = walk.moves[0] * u64::from(step) + walk.moves[1] * u64::from(turn) + walk.moves[2] * u64::from(bump);
        sum as f64 / f64::from(step)
    }
}

/// Works on `count` things in parallel; the results in their order.
pub fn parallel<R: Send>(count: usize, threads: usize, work: impl Fn(usize, &mut Ways) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let mut all: Vec<Option<R>> = (0..count).map(|_| None).collect();
    let parts: Vec<Vec<(usize, R)>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                scope.spawn(|| {
                    let (mut ways, mut done) = (Ways::default(), Vec::new());
                    loop {
                        let n = next.fetch_add(1, Ordering::Relaxed);
                        if n >= count {
                            return done;
                        }
                        done.push((n, work(n, &mut ways)));
                    }
                })
            })
            .collect();
        workers.into_iter().map(|worker| worker.join().expect("a worker does not panic")).collect()
    });
    for (n, result) in parts.into_iter().flatten() {
        all[n] = Some(result);
    }
    all.into_iter().map(|result| result.expect("every number was taken once")).collect()
}

/// Cross-entropy over the linear part.
pub fn cross_entropy(task: &Task, start: &Weights, generations: u64, seed: u64, mut told: impl FnMut(u64, f64)) -> Weights {
    const CANDIDATES: usize = 44;
    const BEST: usize = 10;
    const HALLS: u64 = 24;
    let mut mean: Vec<f64> = start.linear.iter().map(|w| f64::from(*w)).collect();
    let mut spread = vec![700.0; LINEAR];
    let mut dice = RandomStream::new(seed, "cross-entropy");
    for generation in 0..generations {
        let candidates: Vec<Weights> = (0..CANDIDATES)
            .map(|n| {
                let mut weights = start.clone();
                for i in 0..LINEAR {
                    let away = if n == 0 { 0.0 } else { dice.normal(spread[i]) };
                    weights.linear[i] = (mean[i] + away) as i32;
                }
                weights
            })
            .collect();
        let grounds: Vec<Ground> = (0..HALLS).map(|n| task.ground(seed * 1_000_003 + generation * 1000 + n)).collect();
        let prices = parallel(CANDIDATES, 2, |n, ways| {
            let price = |ground: &Ground| task.price(ground, &Walk::run(ground, task.sonar, ways, task.costs, &candidates[n]));
            grounds.iter().map(price).sum::<f64>() / HALLS as f64
        });
        let mut order: Vec<usize> = (0..CANDIDATES).collect();
        order.sort_by(|a, b| prices[*a].total_cmp(&prices[*b]));
        for i in 0..LINEAR {
            let best: Vec<f64> = order[..BEST].iter().map(|n| f64::from(candidates[*n].linear[i])).collect();
            let middle = best.iter().sum::<f64>() / BEST as f64;
            let deviation = (best.iter().map(|w| (w - middle).powi(2)).sum::<f64>() / BEST as f64).sqrt();
            mean[i] = 0.3 * mean[i] + 0.7 * middle;
            spread[i] = (0.3 * spread[i] + 0.7 * deviation).max(40.0);
        }
        told(generation, order[..BEST].iter().map(|n| prices[*n]).sum::<f64>() / BEST as f64);
    }
    let mut weights = start.clone();
    for i in 0..LINEAR {
        weights.linear[i] = mean[i] as i32;
    }
    weights
}

/// How many numbers describe what is left of a hall.
const REST: usize = 20;

/// What is left of a hall: the numbers above, and how often each neighbourhood of an unvisited cell is there.
type Rest = Vec<(u32, f32)>;

/// The neighbourhoods that are turned or mirrored images of each other have one number.
static CLASSES: LazyLock<Vec<u16>> = LazyLock::new(|| {
    const ROUND: [(i32, i32); 8] = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)];
    let digit = |code: usize, place: usize| code / 3usize.pow(place as u32) % 3;
    (0..6561usize)
        .map(|code| {
            let mut least = usize::MAX;
            for turn in 0..4 {
                for mirror in [false, true] {
                    let image = (0..8).fold(0, |sum, place| {
                        let from = if mirror { (8 - place) % 8 } else { place };
                        sum + digit(code, (from + 2 * turn) % 8) * 3usize.pow(place as u32)
                    });
                    least = least.min(image);
                }
            }
            let _ = ROUND;
            least as u16
        })
        .collect()
});

/// What is left of a hall, by somebody who knows it.
fn rest(ground: &Ground, walk: &Walk, cells: &[Cell], way: i32, space: &mut Space) -> Rest {
    let mut rest = [0.0f32; REST];
    let mut patterns: Vec<u32> = Vec::new();
    space.begin(ground);
    let open = |cell: Cell| ground.within(cell) == 1 && walk.grid.at(cell) != Square::Visited;
    let mut parts: Vec<Vec<Cell>> = Vec::new();
    for cell in cells {
        if ground.within(*cell) == 2 {
            rest[5] += f32::from(u8::from(walk.grid.at(*cell) == Square::Unknown));
            continue;
        }
        if !open(*cell) {
            continue;
        }
        let around = cell.neighbours().into_iter().filter(|c| open(*c)).count();
        rest[around] += 1.0;
        let round = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)];
        let code = round.into_iter().rev().fold(0usize, |sum, (dx, dy)| {
            let next = Cell::new(cell.x + dx, cell.y + dy);
            let kind = if ground.at(next) != 0 { 2 } else { usize::from(walk.grid.at(next) == Square::Visited) };
            sum * 3 + kind
        });
        patterns.push(REST as u32 + u32::from(CLASSES[code]));
        if space.take(ground, *cell) {
            let mut part = vec![*cell];
            let mut done = 0;
            while done < part.len() {
                for next in part[done].neighbours() {
                    if open(next) && space.take(ground, next) {
                        part.push(next);
                    }
                }
                done += 1;
            }
            parts.push(part);
        }
    }
    let apart = |a: Cell, b: Cell| (a.x - b.x).abs() + (a.y - b.y).abs();
    for (n, part) in parts.iter().enumerate() {
        let class = match part.len() {
            1 => 9,
            2 => 10,
            3..=4 => 11,
            5..=8 => 12,
            9..=20 => 13,
            21..=60 => 14,
            _ => 15,
        };
        rest[class] += 1.0;
        if part.len() <= 20 {
            let near = parts
                .iter()
                .enumerate()
                .filter(|(m, _)| *m != n)
                .flat_map(|(_, other)| other.iter().map(|c| apart(*c, part[0])))
                .min();
            let near = near.unwrap_or(0) as f32;
            rest[16] += near;
            rest[17] += near.sqrt();
            rest[18] += f32::from(u8::from(near <= 3.0));
        }
    }
    rest[6] = way as f32 / 1000.0;
    rest[7] = (walk.pose.cell.x.abs() + walk.pose.cell.y.abs()) as f32 / 10.0;
    rest[8] = 1.0;
    rest[19] = if parts.is_empty() { 1.0 } else { 0.0 };
    let mut all: Rest = (0..).zip(rest).filter(|(_, x)| *x != 0.0).collect();
    patterns.sort_unstable();
    for pattern in patterns {
        match all.last_mut() {
            Some((last, count)) if *last == pattern => *count += 1.0,
            _ => all.push((pattern, 1.0)),
        }
    }
    all
}

/// One less the other, each weighed.
fn less(a: &Rest, by: f64, b: &Rest, other: f64) -> Rest {
    let mut out: Rest = Vec::new();
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        let (x, y) = (a.get(i).map_or(u32::MAX, |t| t.0), b.get(j).map_or(u32::MAX, |t| t.0));
        let mut value = 0.0;
        if x <= y {
            value += f64::from(a[i].1) * by;
            i += 1;
        }
        if y <= x {
            value -= f64::from(b[j].1) * other;
            j += 1;
        }
        if value != 0.0 {
            out.push((x.min(y), value as f32));
        }
    }
    out
}

/// Which cells a flood has taken.
#[derive(Default)]
struct Space {
    taken: Vec<u32>,
    round: u32,
}

impl Space {
    fn begin(&mut self, ground: &Ground) {
        self.taken.resize(ground.size(), 0);
        self.round += 1;
    }

    fn take(&mut self, ground: &Ground, cell: Cell) -> bool {
        let place = ground.place(cell);
        std::mem::replace(&mut self.taken[place], self.round) != self.round
    }
}

/// One decision of a run.
struct Moment {
    walk: Walk,
    way: i32,
    unknown: f64,
}

/// One forced alternative: the difference of what it cost by its horizon, of what was left then, of the scores, and where the rows differ.
struct Sample {
    cost: f32,
    rest: Rest,
    score: f32,
    rows: Vec<(u32, f32)>,
}

impl Sample {
    fn target(&self, value: &[f64]) -> f64 {
        let left: f64 = self.rest.iter().map(|(n, x)| f64::from(*x) * value[*n as usize]).sum();
        (f64::from(self.cost) + left - f64::from(self.score)).clamp(-40.0, 40.0)
    }
}

/// One round of counterfactuals over some halls, and the fit.
pub struct Round {
    /// How many halls.
    pub halls: usize,
    /// Which.
    pub seed: u64,
    /// For so many moves an alternative is followed.
    pub horizon: f64,
    /// Of a hundred decisions so many are tried otherwise.
    pub tried: u64,
    /// The stiffness of the fit.
    pub ridge: f64,
    /// How much of the fit is taken over.
    pub taken: f64,
}

const SLACK: i32 = 2500;

type Visit = (Cell, Vec<Move>);

fn first_of(walk: &Walk, task: &Task, weights: &Weights, ways: &mut Ways, candidates: &mut Vec<Candidate>) -> Option<Visit> {
    candidates.clear();
    let best = walk.choose(ways, task.costs, weights, SLACK, |candidate| candidates.push(candidate));
    if best.is_some() {
        let least = candidates.iter().map(|c| c.score).min().unwrap_or(0);
        candidates.retain(|c| c.score <= least + SLACK);
    }
    best
}

/// Whether these are two entries, not one.
fn differ(a: &Candidate, b: &Candidate) -> bool {
    (a.cell, a.heading) != (b.cell, b.heading)
}

/// The way to a candidate.
fn visit_of(walk: &Walk, task: &Task, weights: &Weights, ways: &mut Ways, other: &Candidate) -> Visit {
    let view = walk.view(task.costs, hallsweep_core::search::Objective::Cover);
    hallsweep_core::search::scored::visit(&view, ways, other).unwrap_or_else(|| {
        let _ = weights;
        (other.cell, Vec::new())
    })
}

/// What a run costs that has come so far: what is spent, and how what is left weighs.
fn account(task: &Task, moment: &Moment) -> (f64, f64) {
    let cost = task.weighed(&moment.walk);
    if task.find { (moment.walk.enter_sum as f64 + moment.unknown * cost, moment.unknown) } else { (cost, 1.0) }
}

/// A training hall, and who knows it.
struct Course<'a> {
    task: &'a Task,
    weights: &'a Weights,
    ground: Ground,
    cells: Vec<Cell>,
    space: Space,
}

impl<'a> Course<'a> {
    fn new(task: &'a Task, weights: &'a Weights, seed: u64) -> Course<'a> {
        let ground = task.ground(seed);
        Course { task, weights, cells: ground.cells(), ground, space: Space::default() }
    }

    fn moment(&self, walk: &Walk, candidates: &[Candidate]) -> Moment {
        let way = candidates.iter().map(|c| c.score).min().unwrap_or(0);
        let unknown = self.ground.reachable + self.ground.touchable - walk.visited - walk.touched;
        Moment { walk: walk.clone(), way, unknown: unknown as f64 }
    }

    fn rest(&mut self, moment: &Moment) -> Rest {
        rest(&self.ground, &moment.walk, &self.cells, moment.way, &mut self.space)
    }

    fn first(&self, walk: &Walk, ways: &mut Ways, candidates: &mut Vec<Candidate>) -> Option<Visit> {
        first_of(walk, self.task, self.weights, ways, candidates)
    }

    /// Every decision of a whole run, and its end. `seen` looks on.
    fn run(&self, ways: &mut Ways, mut seen: impl FnMut(usize, &Walk, &[Candidate])) -> Vec<Moment> {
        let (mut walk, mut moments, mut candidates) = (Walk::new(&self.ground, self.task.sonar), Vec::new(), Vec::new());
        while let Some(best) = self.first(&walk, ways, &mut candidates) {
            seen(moments.len(), &walk, &candidates);
            moments.push(self.moment(&walk, &candidates));
            walk.enter(&self.ground, &best);
        }
        moments.push(self.moment(&walk, &[]));
        walk.go_home(&self.ground, ways, self.task.costs);
        moments.push(self.moment(&walk, &[]));
        moments
    }
}

/// The control variate of a policy: what is left of a hall, from whole runs.
pub fn value_of(task: &Task, weights: &Weights, halls: usize, seed: u64) -> Vec<f64> {
    const LOOKS: u64 = 12;
    let rests: Vec<Vec<(f32, Rest)>> = parallel(halls, 2, |n, ways| {
        let seed = seed * 1_000_003 + n as u64;
        let mut dice = RandomStream::new(seed, "value");
        let mut course = Course::new(task, weights, seed);
        let moments = course.run(ways, |_, _, _| ());
        let (end, _) = account(task, &moments[moments.len() - 1]);
        let mut rests = Vec::new();
        for _ in 0..LOOKS {
            let moment = &moments[dice.below(moments.len() as u64 - 1) as usize];
            let (before, weight) = account(task, moment);
            if weight > 0.0 {
                rests.push((((end - before) / weight) as f32, course.rest(moment)));
            }
        }
        rests
    });
    ridge(&rests.into_iter().flatten().collect::<Vec<_>>(), REST + 6561, 30.0, 100)
}

fn learn(task: &Task, round: &Round, weights: &Weights, n: usize, ways: &mut Ways) -> Vec<Sample> {
    let seed = round.seed * 1_000_003 + n as u64;
    let mut dice = RandomStream::new(seed, "counterfactual");
    let mut course = Course::new(task, weights, seed);
    let mut forks: Vec<(usize, Candidate, Candidate)> = Vec::new();
    let moments = course.run(ways, |at, _, candidates| {
        if dice.below(100) < round.tried && candidates.len() > 1 {
            let chosen = candidates.iter().min_by_key(|c| c.score).cloned().expect("the best was weighed");
            let mut others: Vec<&Candidate> = candidates.iter().filter(|c| differ(c, &chosen)).collect();
            others.sort_by_key(|c| c.score);
            // Half of the time the one that comes next: where it is close, it matters.
            let n = if dice.below(2) == 0 { 0 } else { dice.below(others.len().max(1) as u64) as usize };
            if let Some(other) = others.get(n) {
                forks.push((at, chosen, (*other).clone()));
            }
        }
    });
    let places: HashMap<u64, usize> = moments.iter().enumerate().rev().map(|(n, moment)| (moment.walk.state(), n)).collect();
    let end = moments.len() - 1;
    let mut candidates = Vec::new();
    let mut samples = Vec::new();
    for (at, chosen, other) in forks {
        let before = &moments[at];
        let until = task.weighed(&before.walk) + round.horizon;
        let mut walk = before.walk.clone();
        let visit = visit_of(&walk, task, weights, ways, &other);
        walk.enter(&course.ground, &visit);
        let (here, base, is_met) = loop {
            if let Some(met) = places.get(&walk.state()).filter(|met| **met > at) {
                break (course.moment(&walk, &[]), &moments[*met], true);
            }
            // What the chosen one came to at the horizon.
            let base = || moments[at..].iter().find(|moment| task.weighed(&moment.walk) >= until).unwrap_or(&moments[end]);
            let Some(best) = course.first(&walk, ways, &mut candidates) else {
                walk.go_home(&course.ground, ways, task.costs);
                break (course.moment(&walk, &[]), base(), false);
            };
            if task.weighed(&walk) >= until {
                break (course.moment(&walk, &candidates), base(), false);
            }
            walk.enter(&course.ground, &best);
        };
        let ((spent, left), (base_spent, base_left)) = (account(task, &here), account(task, base));
        let (_, scale) = account(task, before);
        if scale <= 0.0 {
            continue;
        }
        let rest = if is_met {
            Vec::new()
        } else {
            let is_end = |moment: &Moment| moment.walk.total() == moments[end].walk.total() && moment.unknown == 0.0;
            let of = |moment: &Moment, course: &mut Course<'_>| if is_end(moment) { Vec::new() } else { course.rest(moment) };
            let (a, b) = (of(&here, &mut course), of(base, &mut course));
            less(&a, left / scale, &b, base_left / scale)
        };
        samples.push(Sample {
            cost: ((spent - base_spent) / scale) as f32,
            rest,
            score: (f64::from(other.score - chosen.score) / 1000.0) as f32,
            rows: differences(&other.outlook, &chosen.outlook),
        });
    }
    samples
}

/// Where two outlooks differ; the linear part stands behind the rows.
fn differences(other: &Outlook, chosen: &Outlook) -> Vec<(u32, f32)> {
    let mut rows = Vec::new();
    for (a, b) in other.rows.iter().zip(chosen.rows) {
        if *a != b {
            rows.push((*a, 1.0));
            rows.push((b, -1.0));
        }
    }
    for (n, (a, b)) in (ROWS as u32..).zip(other.linear.iter().zip(chosen.linear)) {
        if *a != b {
            rows.push((n, f32::from(*a - b) / 1000.0));
        }
    }
    rows
}

/// What a round of counterfactuals came to.
pub struct Fit {
    /// The better weights.
    pub weights: Weights,
    /// How many counterfactuals there were.
    pub samples: usize,
    /// The mean square of what the score missed, before and after.
    pub missed: (f64, f64),
}

/// Better weights after a round of counterfactuals.
pub fn regress(task: &Task, round: &Round, weights: &Weights, value: &[f64], kept: &mut Vec<(f32, f32, Vec<(u32, f32)>)>) -> Fit {
    let fresh = parallel(round.halls, 2, |n, ways| learn(task, round, weights, n, ways));
    let before = kept.len();
    // What is kept is the difference of cost, and of the way alone: every round fits all of them anew.
    kept.extend(fresh.into_iter().flatten().map(|sample| {
        let worth: f64 = sample.rows.iter().map(|(row, x)| weight_of(weights, *row) * f64::from(*x)).sum();
        let target = sample.target(value) + f64::from(sample.score);
        (target as f32, (f64::from(sample.score) - worth) as f32, sample.rows)
    }));
    let fresh = kept.len() - before;
    let samples: Vec<(f32, Vec<(u32, f32)>)> = kept
        .iter()
        .map(|(target, way, rows)| {
            let worth: f64 = rows.iter().map(|(row, x)| weight_of(weights, *row) * f64::from(*x)).sum();
            (target - way - worth as f32, rows.clone())
        })
        .collect();
    let size = ROWS + LINEAR;
    let fit = ridge(&samples, size, round.ridge, 60);
    let count = samples.len() as f64;
    let before = samples.iter().map(|(target, _)| f64::from(*target).powi(2)).sum::<f64>() / count;
    let missed = |(target, rows): &(f32, Vec<(u32, f32)>)| {
        f64::from(*target) - rows.iter().map(|(row, x)| fit[*row as usize] * f64::from(*x)).sum::<f64>()
    };
    let after = samples.iter().map(|sample| missed(sample).powi(2)).sum::<f64>() / count;
    let mut better = weights.clone();
    for (row, change) in better.rows.iter_mut().zip(&fit) {
        *row = (f64::from(*row) + change * 1000.0 * round.taken).clamp(-5000.0, 5000.0) as i16;
    }
    for (weight, change) in better.linear.iter_mut().zip(&fit[ROWS..]) {
        *weight += (change * 1000.0 * round.taken) as i32;
    }
    Fit { weights: better, samples: fresh, missed: (before, after) }
}

fn weight_of(weights: &Weights, row: u32) -> f64 {
    let row = row as usize;
    let weight = weights.rows.get(row).map_or_else(|| weights.linear[row - ROWS], |weight| i32::from(*weight));
    f64::from(weight) / 1000.0
}

/// Ridge regression by conjugate gradients.
fn ridge(samples: &[(f32, Vec<(u32, f32)>)], size: usize, stiffness: f64, steps: usize) -> Vec<f64> {
    let apply = |v: &[f64]| -> Vec<f64> {
        let mut out: Vec<f64> = v.iter().map(|x| x * stiffness).collect();
        for (_, rows) in samples {
            let sum: f64 = rows.iter().map(|(row, x)| v[*row as usize] * f64::from(*x)).sum();
            for (row, x) in rows {
                out[*row as usize] += sum * f64::from(*x);
            }
        }
        out
    };
    let mut b = vec![0.0; size];
    for (target, rows) in samples {
        for (row, x) in rows {
            b[*row as usize] += f64::from(*target) * f64::from(*x);
        }
    }
    // The diagonal as preconditioner: some numbers are counts of hundreds, some are ones.
    let mut diagonal = vec![stiffness; size];
    for (_, rows) in samples {
        for (row, x) in rows {
            diagonal[*row as usize] += f64::from(*x).powi(2);
        }
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut x, mut r) = (vec![0.0; size], b);
    let mut z: Vec<f64> = r.iter().zip(&diagonal).map(|(r, d)| r / d).collect();
    let mut p = z.clone();
    let mut norm = dot(&r, &z);
    let first = norm;
    for _ in 0..steps {
        if norm < first * 1e-7 {
            break;
        }
        let q = apply(&p);
        let alpha = norm / dot(&p, &q);
        for i in 0..size {
            x[i] += alpha * p[i];
            r[i] -= alpha * q[i];
            z[i] = r[i] / diagonal[i];
        }
        let next = dot(&r, &z);
        let beta = next / norm;
        for i in 0..size {
            p[i] = z[i] + beta * p[i];
        }
        norm = next;
    }
    x
}

/// What a policy comes to over some halls: mean and 95 % interval.
pub fn mean(prices: &[f64]) -> (f64, f64) {
    let n = prices.len() as f64;
    let mean = prices.iter().sum::<f64>() / n;
    let deviation = (prices.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    (mean, 1.96 * deviation / n.sqrt())
}
