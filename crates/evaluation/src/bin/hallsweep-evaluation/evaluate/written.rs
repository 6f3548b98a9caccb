//! Writes the result of a comparison for programs: JSON with means and intervals, and CSV with one line per search.

use std::fmt::Write;

use serde::Serialize;

use super::{Answer, Measure};
use hallsweep_evaluation::compare::{Contest, Entrant, Estimate, Halls, Trial, against as differences, decisions, over};

#[derive(Serialize)]
struct EvaluationJson<'a> {
    comparisons: Vec<ComparisonJson<'a>>,
}

#[derive(Serialize)]
struct ComparisonJson<'a> {
    halls: String,
    count: usize,
    /// Total number of reachable cells in all halls.
    cells: usize,
    /// Total number of free cells in all halls.
    free_cells: usize,
    /// Null for a hall that is not random.
    seed: Option<u64>,
    goal: &'static str,
    sonar_cells: u8,
    costs: String,
    strategies: Vec<StrategyJson<'a>>,
}

#[derive(Serialize)]
struct StrategyJson<'a> {
    strategy: &'a str,
    complete: bool,
    #[serde(flatten)]
    measured: MeasuresJson,
    decision_us: DecisionJson,
    /// Mean difference from the strategy of `--against`, hall by hall.
    #[serde(skip_serializing_if = "Option::is_none")]
    more_than: Option<DifferenceJson<'a>>,
}

#[derive(Serialize)]
struct DifferenceJson<'a> {
    strategy: &'a str,
    #[serde(flatten)]
    measured: MeasuresJson,
}

/// The measures. A measure is null if it cannot be taken in any of the halls.
#[derive(Serialize)]
struct MeasuresJson {
    moves_per_cell: Option<EstimateJson>,
    moves_to_a_piece_per_cell: Option<EstimateJson>,
    steps_over_bound: Option<EstimateJson>,
    seconds: Option<EstimateJson>,
}

#[derive(Serialize)]
struct EstimateJson {
    mean: f64,
    /// Half the width of the 95 % confidence interval.
    interval: f64,
    count: usize,
}

#[derive(Serialize)]
struct DecisionJson {
    p50: f64,
    p99: f64,
    worst: f64,
}

/// Returns one JSON object on one line.
pub(super) fn json(answers: &[Answer], entrants: &[Entrant], against: Option<usize>) -> String {
    let comparisons = answers.iter().map(|answer| comparison(answer, entrants, against)).collect();
    serde_json::to_string(&EvaluationJson { comparisons }).expect("figures are numbers and strings, which JSON can hold")
}

fn comparison<'a>(answer: &Answer, entrants: &'a [Entrant], against: Option<usize>) -> ComparisonJson<'a> {
    let Contest { halls, terms, .. } = &answer.question.contest;
    let seed = if let Halls::Random { seed, .. } = halls { Some(*seed) } else { None };
    let [cells, free_cells] = answer.reach();
    let strategy = |(entrant, mine): (&'a Entrant, &Vec<Trial>)| {
        let [p50, p99, worst] = decisions(mine).map(|time| time.as_secs_f64() * 1e6);
        let more_than = against.map(|other| DifferenceJson {
            strategy: entrants[other].name(),
            measured: measures(|measure| differences(mine, &answer.trials[other], measure)),
        });
        StrategyJson {
            strategy: entrant.name(),
            complete: mine.iter().all(|trial| trial.complete),
            measured: measures(|measure| over(mine, measure)),
            decision_us: DecisionJson { p50, p99, worst },
            more_than,
        }
    };
    ComparisonJson {
        halls: halls.to_string(),
        count: halls.count(),
        cells,
        free_cells,
        seed,
        goal: terms.objective.name(),
        sonar_cells: terms.sonar_cells,
        costs: terms.costs.to_string(),
        strategies: entrants.iter().zip(&answer.trials).map(strategy).collect(),
    }
}

fn measures(of: impl Fn(Measure) -> Option<Estimate>) -> MeasuresJson {
    let json =
        |measure| of(measure).map(|Estimate { mean, half_width, count }| EstimateJson { mean, interval: half_width, count });
    MeasuresJson {
        moves_per_cell: json(Measure::MovesPerCell),
        moves_to_a_piece_per_cell: json(Measure::ToAPiece),
        steps_over_bound: json(Measure::StepsOverBound),
        seconds: json(Measure::Seconds),
    }
}

const CSV_HEAD: &str = "halls,hall,seed,goal,sonar_cells,step_cost,turn_cost,bump_cost,strategy,cells,free_cells,steps,turns,bumps,moves_per_cell,\
                        moves_to_a_piece_per_cell,steps_over_bound,seconds,complete,decisions,decision_p50_us,decision_p99_us,\
                        decision_worst_us\n";

/// Returns a header line and one line per search. A field without a value is empty.
pub(super) fn csv(answers: &[Answer], entrants: &[Entrant]) -> String {
    let mut out = CSV_HEAD.to_owned();
    for Answer { question, trials } in answers {
        for (entrant, trials) in entrants.iter().zip(trials) {
            for (number, trial) in trials.iter().enumerate() {
                let _ = writeln!(out, "{}", csv_line(&question.contest, number, entrant, trial));
            }
        }
    }
    out
}

fn csv_line(contest: &Contest, number: usize, entrant: &Entrant, trial: &Trial) -> String {
    let Contest { halls, terms, .. } = contest;
    let seed = if let Halls::Random { seed, .. } = halls { seed.to_string() } else { String::new() };
    let to_a_piece = trial.to_a_piece.map_or_else(String::new, |moves| moves.to_string());
    let [p50, p99, worst] = decisions(std::slice::from_ref(trial)).map(|time| time.as_secs_f64() * 1e6);
    format!(
        "{},{number},{seed},{},{},{},{},{},{},{},{},{},{},{to_a_piece},{},{},{},{},{p50},{p99},{worst}",
        quoted(&halls.to_string()),
        terms.objective.name(),
        terms.sonar_cells,
        terms.costs,
        quoted(entrant.name()),
        trial.cells,
        trial.free_cells,
        trial.moves.steps,
        trial.moves.turns,
        trial.moves.bumps,
        trial.moves_per_cell,
        trial.steps_over_bound,
        trial.seconds,
        trial.complete,
        trial.decisions_ns.len(),
    )
}

/// Quotes a CSV field if necessary (RFC 4180).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field.to_owned() }
}
