//! Learns from the effect of another choice: one entry is forced, the policy goes on from there, and the costs of both
//! courses are compared.
//!
//! ```text
//!   a walk   ──●────●────●────●────●────●──  its decisions
//!                   └ forced ─●────●────●    until the horizon, or until a state of the walk is met
//!                                       └ what is left here, less what is left of the walk after as many moves
//! ```

use std::collections::HashMap;

use hallsweep_core::command::Move;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::Objective;
use hallsweep_core::search::outlook::Outlook;
use hallsweep_core::search::scored::{Candidate, choose, visit};
use hallsweep_core::search::tables::{LINEAR, ROWS};
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::weights::Weights;
use hallsweep_core::units::Cell;

use super::Task;
use super::rest::{self, Judge, Rest};
use super::ridge::{self, Sample};
use crate::family::below;
use crate::walk::Walk;
use crate::{Ground, parallel};

/// Greatest distance from the best score at which an alternative is tried, in thousandths of a step.
const SLACK: i32 = 2500;

/// Greatest difference that a single counterfactual may make, in steps.
const MOST: f64 = 40.0;

/// Greatest weight of a row of a table, in thousandths of a step.
const MOST_ROW: f64 = 5000.0;

/// Number of moments of each walk from whose real remaining costs the cost of a rest is learnt.
const LOOKS: usize = 12;

#[derive(Clone, Copy, Debug)]
pub struct Round {
    /// The number of the round: every round has halls of its own.
    pub number: u64,
    pub halls: usize,
    /// Steps for which each counterfactual is followed.
    pub horizon: f64,
    /// Share of the decisions that are tried.
    pub tried: f64,
    pub ridge: f64,
    /// Share of the regression's result that is adopted.
    pub taken: f64,
}

#[derive(Clone, Debug)]
pub struct Learnt {
    pub weights: Weights,
    pub tried: usize,
    /// The mean square error of the scores, before and after this round, over all samples so far.
    pub missed: (f64, f64),
}

/// Counterfactuals of all rounds so far: each round fits all of them anew.
#[derive(Debug)]
pub struct Lessons<'a> {
    task: &'a Task,
    /// Weights of the numbers that describe a rest; the weighted sum is its remaining cost.
    worth: Vec<f64>,
    /// One sample for each counterfactual: the target is the difference of costs, less the difference of the ways; the
    /// numbers tell where the outlooks differ.
    samples: Vec<Sample>,
}

/// One decision of a walk, or its end.
struct Moment {
    walk: Walk,
    /// The least score of all candidates, in thousandths of a step.
    way: i32,
    /// Number of cells and pieces still to be found.
    unknown: f64,
}

/// A counterfactual whose remaining cost is not judged yet.
struct Trial {
    cost: f64,
    rest: Rest,
    ways: f64,
    outlooks: Vec<(u32, f32)>,
}

struct Course<'a> {
    task: &'a Task,
    weights: &'a Weights,
    ground: Ground,
    cells: Vec<Cell>,
    judge: Judge,
    candidates: Vec<Candidate>,
}

impl<'a> Lessons<'a> {
    /// Learns what the rest of a hall costs, by walks with these weights through `halls` halls.
    #[must_use]
    pub fn new(task: &'a Task, weights: &Weights, halls: usize) -> Lessons<'a> {
        let rests = parallel::each(halls, |n, ways| {
            let mut course = Course::new(task, weights, "rest", n as u64);
            let moments = course.walk(ways, |_, _| ());
            course.looks_back(&moments, n as u64)
        });
        let samples: Vec<Sample> = rests.into_iter().flatten().collect();
        Lessons { task, worth: rest::worth(&samples), samples: Vec::new() }
    }

    /// Tries alternatives in fresh halls, and fits the counterfactuals of all rounds so far.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "weights are small numbers, bounded here")]
    #[expect(clippy::cast_precision_loss, reason = "nobody waits for 2^53 samples")]
    pub fn learn(&mut self, weights: &Weights, round: &Round) -> Learnt {
        let first = round.number * round.halls as u64;
        let trials = parallel::each(round.halls, |n, ways| {
            Course::new(self.task, weights, "counterfactual", first + n as u64).trials(round, first + n as u64, ways)
        });
        let before = self.samples.len();
        self.samples.extend(trials.into_iter().flatten().map(|trial| {
            let left = ridge::explained(&self.worth, &trial.rest);
            Sample { target: (trial.cost + left - trial.ways) as f32, numbers: trial.outlooks }
        }));
        let now: Vec<f64> = weights.rows.iter().map(|row| f64::from(*row)).chain(weights.linear.map(f64::from)).collect();
        let missed = |sample: &Sample| {
            let by_score = ridge::explained(&now, &sample.numbers) / 1000.0;
            Sample { target: (f64::from(sample.target) - by_score).clamp(-MOST, MOST) as f32, numbers: sample.numbers.clone() }
        };
        let samples: Vec<Sample> = self.samples.iter().map(missed).collect();
        let change = ridge::ridge(&samples, ROWS + LINEAR, round.ridge, 60);
        let square = |explained: &dyn Fn(&Sample) -> f64| {
            samples.iter().map(|sample| (f64::from(sample.target) - explained(sample)).powi(2)).sum::<f64>()
                / samples.len() as f64
        };
        let mut better = weights.clone();
        for (row, change) in better.rows.iter_mut().zip(&change) {
            *row = (f64::from(*row) + change * 1000.0 * round.taken).clamp(-MOST_ROW, MOST_ROW) as i16;
        }
        for (weight, change) in better.linear.iter_mut().zip(&change[ROWS..]) {
            *weight += (change * 1000.0 * round.taken) as i32;
        }
        let missed = (square(&|_| 0.0), square(&|sample| ridge::explained(&change, &sample.numbers)));
        Learnt { weights: better, tried: self.samples.len() - before, missed }
    }
}

impl<'a> Course<'a> {
    fn new(task: &'a Task, weights: &'a Weights, purpose: &str, number: u64) -> Course<'a> {
        let ground = task.ground(purpose, number);
        Course { task, weights, cells: ground.cells(), ground, judge: Judge::default(), candidates: Vec::new() }
    }

    /// The best entry; the candidates near it are in `candidates` afterwards.
    fn choose(&mut self, walk: &Walk, ways: &mut Ways) -> Option<(Cell, Vec<Move>)> {
        self.candidates.clear();
        let best = choose(&walk.view(), ways, self.weights, SLACK, |candidate| self.candidates.push(candidate));
        let least = self.candidates.iter().map(|candidate| candidate.score).min().unwrap_or(0);
        self.candidates.retain(|candidate| candidate.score <= least.saturating_add(SLACK));
        best
    }

    #[expect(clippy::cast_precision_loss, reason = "a training hall is small")]
    fn moment(&self, walk: &Walk) -> Moment {
        let way = self.candidates.iter().map(|candidate| candidate.score).min().unwrap_or(0);
        let unknown = self.ground.reachable + self.ground.touchable - walk.known;
        Moment { walk: walk.clone(), way, unknown: unknown as f64 }
    }

    /// Every decision of a whole walk, then its end, then home. `seen` gets the candidates of each decision.
    fn walk(&mut self, ways: &mut Ways, mut seen: impl FnMut(usize, &[Candidate])) -> Vec<Moment> {
        let (mut walk, mut moments) = (Walk::new(&self.ground, self.task.terms), Vec::new());
        while let Some((cell, route)) = self.choose(&walk, ways) {
            seen(moments.len(), &self.candidates);
            moments.push(self.moment(&walk));
            walk.enter(&self.ground, cell, &route);
        }
        moments.push(self.moment(&walk));
        walk.go_home(&self.ground, ways);
        moments.push(self.moment(&walk));
        moments
    }

    fn rest(&mut self, moment: &Moment) -> Rest {
        self.judge.rest(&self.ground, &self.cells, &moment.walk, moment.way)
    }

    /// The costs so far, and the weight of each further step: to find luggage soon, the number of cells and pieces
    /// still unknown.
    #[expect(clippy::cast_precision_loss, reason = "a training hall is small")]
    fn account(&self, moment: &Moment) -> (f64, f64) {
        match self.task.terms.objective {
            Objective::Cover => (moment.walk.cost(), 1.0),
            Objective::Find => (moment.walk.known_after as f64 + moment.unknown * moment.walk.cost(), moment.unknown),
        }
    }

    /// What was left at random moments of a walk, with its real cost.
    #[expect(clippy::cast_possible_truncation, reason = "costs of a training hall are small")]
    fn looks_back(&mut self, moments: &[Moment], number: u64) -> Vec<Sample> {
        let mut dice = RandomStream::new(self.task.seed ^ number, "looks");
        let (end, _) = self.account(&moments[moments.len() - 1]);
        let mut samples = Vec::new();
        for _ in 0..LOOKS {
            let moment = &moments[below(moments.len() - 1, &mut dice)];
            let (spent, weight) = self.account(moment);
            if weight > 0.0 {
                samples.push(Sample { target: ((end - spent) / weight) as f32, numbers: self.rest(moment) });
            }
        }
        samples
    }

    fn trials(mut self, round: &Round, number: u64, ways: &mut Ways) -> Vec<Trial> {
        let mut dice = RandomStream::new(self.task.seed ^ number, "trials");
        let mut forks: Vec<(usize, Candidate, Candidate)> = Vec::new();
        let moments = self.walk(ways, |at, candidates| {
            if dice.happens(round.tried) {
                forks.extend(fork(candidates, &mut dice).map(|(chosen, other)| (at, chosen, other)));
            }
        });
        let came_by: HashMap<u64, usize> = moments.iter().enumerate().rev().map(|(n, moment)| (moment.walk.state(), n)).collect();
        forks.iter().filter_map(|fork| self.trial(fork, &moments, &came_by, round.horizon, ways)).collect()
    }

    fn trial(
        &mut self,
        (at, chosen, other): &(usize, Candidate, Candidate),
        moments: &[Moment],
        came_by: &HashMap<u64, usize>,
        horizon: f64,
        ways: &mut Ways,
    ) -> Option<Trial> {
        let before = &moments[*at];
        let (_, scale) = self.account(before);
        let until = before.walk.cost() + horizon;
        let (here, met) = self.follow(other, before, until, |state| came_by.get(&state).copied().filter(|met| met > at), ways)?;
        let end = &moments[moments.len() - 1];
        let at_horizon = || moments[*at..].iter().find(|moment| moment.walk.cost() >= until).unwrap_or(end);
        let base = met.map_or_else(at_horizon, |met| &moments[met]);
        let ((spent, left), (base_spent, base_left)) = (self.account(&here), self.account(base));
        let rest = if met.is_some() {
            Rest::new()
        } else {
            let (here, base) = (self.rest_unless_home(&here), self.rest_unless_home(base));
            rest::difference(&here, left / scale, &base, base_left / scale)
        };
        let cost = (spent - base_spent) / scale;
        let worth = |candidate: &Candidate| candidate.score - self.weights.worth(&candidate.outlook);
        let ways = f64::from(worth(other) - worth(chosen)) / 1000.0;
        cost.is_finite().then(|| Trial { cost, rest, ways, outlooks: differences(&other.outlook, &chosen.outlook) })
    }

    /// Enters another cell than the chosen one, and goes on from there until the walk's own course is met, the horizon
    /// is reached, or the robot is home.
    fn follow(
        &mut self,
        other: &Candidate,
        before: &Moment,
        until: f64,
        met: impl Fn(u64) -> Option<usize>,
        ways: &mut Ways,
    ) -> Option<(Moment, Option<usize>)> {
        let mut walk = before.walk.clone();
        let (mut cell, mut route) = visit(&walk.view(), ways, other)?;
        loop {
            walk.enter(&self.ground, cell, &route);
            if let Some(met) = met(walk.state()) {
                return Some((self.moment(&walk), Some(met)));
            }
            match self.choose(&walk, ways) {
                None => {
                    walk.go_home(&self.ground, ways);
                    return Some((self.moment(&walk), None));
                }
                Some(_) if walk.cost() >= until => return Some((self.moment(&walk), None)),
                Some(next) => (cell, route) = next,
            }
        }
    }

    /// The rest that is left at this moment; empty once everything is found and the robot is home.
    fn rest_unless_home(&mut self, moment: &Moment) -> Rest {
        let is_home = moment.unknown == 0.0 && moment.walk.pose.cell == Cell::HOME;
        if is_home { Rest::new() } else { self.rest(moment) }
    }
}

/// The best candidate and another one. Half of the time the other is the next best, because the choice matters where
/// two are close.
fn fork(candidates: &[Candidate], dice: &mut RandomStream) -> Option<(Candidate, Candidate)> {
    let mut sorted: Vec<&Candidate> = candidates.iter().collect();
    sorted.sort_by_key(|candidate| candidate.score);
    let (chosen, others) = sorted.split_first()?;
    let n = if dice.below(2) == 0 { 0 } else { below(others.len().max(1), dice) };
    Some(((*chosen).clone(), (**others.get(n)?).clone()))
}

/// The differences of two outlooks: rows of tables first, then the linear part.
fn differences(other: &Outlook, chosen: &Outlook) -> Vec<(u32, f32)> {
    let rows = other.rows.iter().zip(chosen.rows).filter(|(a, b)| **a != *b);
    let linear = (ROWS as u32..).zip(other.linear.iter().zip(chosen.linear)).filter(|(_, (a, b))| **a != *b);
    let rows = rows.flat_map(|(a, b)| [(*a, 1.0), (b, -1.0)]);
    rows.chain(linear.map(|(n, (a, b))| (n, f32::from(*a - b) / 1000.0))).collect()
}
