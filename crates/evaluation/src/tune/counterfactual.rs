//! Learns from trying other choices. At a decision of a search, a cell is entered that differs from the chosen cell.
//! The search then continues with the same policy, and the costs of both searches are compared. Such a trial is
//! called a counterfactual.
//!
//! ```text
//!   a walk   ──●────●────●────●────●────●──  its decisions
//!                   └ forced ─●────●────●    until the horizon, or until it meets a state of the walk
//!                                       └ cost of the rest here, minus cost of the rest of the walk at its horizon
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

/// An alternative is tried only if its score is at most this much above the best score, in thousandths of a step.
const SLACK: i32 = 2500;

/// Greatest difference between real and predicted cost that one trial may contribute, in steps.
const MOST: f64 = 40.0;

/// Greatest absolute value of a weight in the tables, in thousandths of a step.
const MOST_ROW: f64 = 5000.0;

/// Number of moments taken from each walk. The real remaining cost is known at each moment, and the estimate is
/// fitted to this cost.
const LOOKS: usize = 12;

#[derive(Clone, Copy, Debug)]
pub struct Round {
    /// The number of the round. Every round uses other halls.
    pub number: u64,
    pub halls: usize,
    /// Number of steps for which each trial is followed.
    pub horizon: f64,
    /// Share of the decisions at which an alternative is tried.
    pub tried: f64,
    pub ridge: f64,
    /// Share of the computed change that is applied to the weights.
    pub taken: f64,
}

#[derive(Clone, Debug)]
pub struct Learnt {
    pub weights: Weights,
    pub tried: usize,
    /// The mean square error of the scores over all samples so far, before and after this round.
    pub missed: (f64, f64),
}

/// The trials of all rounds so far. Each round computes its change of the weights from all of them.
#[derive(Debug)]
pub struct Lessons<'a> {
    task: &'a Task,
    /// One weight for each number that describes the rest of a hall. The weighted sum is the estimated cost of
    /// searching the rest.
    worth: Vec<f64>,
    /// One sample for each trial. The target of a sample is the difference between the real costs of the two choices,
    /// minus the difference between their scores without the weights. The numbers of a sample say where the features
    /// (outlooks) of the two choices differ.
    samples: Vec<Sample>,
}

/// The state of a walk at one decision, or at its end.
struct Moment {
    walk: Walk,
    /// The lowest score of all candidates, in thousandths of a step.
    way: i32,
    /// Number of cells and pieces of luggage that are still unknown.
    unknown: f64,
}

/// A trial before the cost of its remaining search has been estimated.
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
    /// Learns the cost of searching the rest of a hall. It makes walks with these weights through `halls` halls.
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

    /// Tries alternatives in new halls, and changes the weights to fit the trials of all rounds so far.
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

    /// Returns the best next cell with its route. Afterwards, `candidates` contains all candidates with a score close
    /// to the best.
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

    /// Makes a whole walk. Returns its state at every decision, at the end of the search, and at home. `seen` is
    /// called with the candidates of each decision.
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

    /// The cost so far, and the weight of each further step. If luggage must be found soon, this weight is the number
    /// of cells and pieces that are still unknown.
    #[expect(clippy::cast_precision_loss, reason = "a training hall is small")]
    fn account(&self, moment: &Moment) -> (f64, f64) {
        match self.task.terms.objective {
            Objective::Cover => (moment.walk.cost(), 1.0),
            Objective::Find => (moment.walk.known_after as f64 + moment.unknown * moment.walk.cost(), moment.unknown),
        }
    }

    /// Describes the rest of the hall at random moments of a walk, together with the real cost of that rest.
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

    /// Enters the cell `other` instead of the chosen cell, and continues the search. Ends when the search meets a
    /// later state of the original walk, when the horizon is reached, or when the robot is home.
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

    /// Describes the rest of the hall at this moment. The description is empty if everything is known and the robot
    /// is home.
    fn rest_unless_home(&mut self, moment: &Moment) -> Rest {
        let is_home = moment.unknown == 0.0 && moment.walk.pose.cell == Cell::HOME;
        if is_home { Rest::new() } else { self.rest(moment) }
    }
}

/// Returns the best candidate and an alternative. In half of the cases the alternative is the second-best candidate,
/// because the decision is hardest between close candidates.
fn fork(candidates: &[Candidate], dice: &mut RandomStream) -> Option<(Candidate, Candidate)> {
    let mut sorted: Vec<&Candidate> = candidates.iter().collect();
    sorted.sort_by_key(|candidate| candidate.score);
    let (chosen, others) = sorted.split_first()?;
    let n = if dice.below(2) == 0 { 0 } else { below(others.len().max(1), dice) };
    Some(((*chosen).clone(), (**others.get(n)?).clone()))
}

/// The differences between two outlooks: first the rows of the tables, then the linear part.
fn differences(other: &Outlook, chosen: &Outlook) -> Vec<(u32, f32)> {
    let rows = other.rows.iter().zip(chosen.rows).filter(|(a, b)| **a != *b);
    let linear = (ROWS as u32..).zip(other.linear.iter().zip(chosen.linear)).filter(|(_, (a, b))| **a != *b);
    let rows = rows.flat_map(|(a, b)| [(*a, 1.0), (b, -1.0)]);
    rows.chain(linear.map(|(n, (a, b))| (n, f32::from(*a - b) / 1000.0))).collect()
}
