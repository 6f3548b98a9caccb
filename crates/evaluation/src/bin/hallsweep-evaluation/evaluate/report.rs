//! Writes the result of a comparison for people: as tables and as a drawing.

use super::{Answer, Measure, Question};
use hallsweep_core::command::Strategy;
use hallsweep_core::search::Terms;
use hallsweep_evaluation::areas::Gain;
use hallsweep_evaluation::calibrate::Bin;
use hallsweep_evaluation::compare::{Contest, Entrant, Estimate, against as differences, decisions, over};
use hallsweep_evaluation::drawing::{self, Band, Dot};
use hallsweep_evaluation::family::Family;
use hallsweep_evaluation::time_left::Held;

pub(super) fn asked(terms: Terms) -> String {
    let goal = terms.objective.name();
    let sensing = if terms.sonar_cells == 0 { "bump".to_owned() } else { format!("sonar of {}", terms.sonar_cells) };
    format!("goal {goal} · {sensing} · costs {}", terms.costs)
}

pub(super) const fn head(measure: Measure) -> &'static str {
    match measure {
        Measure::MovesPerCell => "moves per cell",
        Measure::ToAPiece => "to a piece",
        Measure::StepsOverBound => "steps/bound",
        Measure::Seconds => "seconds",
    }
}

/// The table of `docs/search.md`. It has a line per comparison and a column per strategy. One more column has the
/// mean of `auto` minus `frontier` over all halls.
pub(super) fn rows(answers: &[Answer], entrants: &[Entrant]) -> String {
    let place = |strategy| entrants.iter().position(|entrant| *entrant == Entrant::Strategy(strategy));
    let pair = place(Strategy::Auto).zip(place(Strategy::Frontier));
    let mut table = vec![["halls", "asked", "measured"].map(str::to_owned).to_vec()];
    table[0].extend(entrants.iter().map(|entrant| entrant.name().to_owned()).chain(["auto minus frontier".to_owned()]));
    for Answer { question, trials } in answers {
        let Question { contest, measure } = question;
        let mut line = vec![contest.halls.to_string(), asked(contest.terms), head(*measure).to_owned()];
        line.extend(trials.iter().map(|trials| shown(over(trials, *measure))));
        line.push(shown(pair.and_then(|(auto, frontier)| differences(&trials[auto], &trials[frontier], *measure))));
        table.push(line);
    }
    let halls = answers.first().map_or(0, |answer| answer.question.contest.halls.count());
    format!("{}\n\nMeans of {halls} halls each, with their 95 % intervals.", aligned(&table))
}

pub(super) fn time_left(held: &[(Family, Held)]) -> String {
    let mut table = vec![["halls", "range shown", "range correct", "\"at least\" correct"].map(str::to_owned).to_vec()];
    let percent = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |share| format!("{:.0} %", share * 100.0));
    table.extend(held.iter().map(|(family, held)| {
        vec![family.to_string(), percent(Some(held.with_most)), percent(held.within), percent(held.at_least)]
    }));
    format!("{}\n\nShares of the time that searches took, in halls of 12x9 to 50x50 cells.", aligned(&table))
}

/// A table that compares the probabilities that this build states with what was found.
pub(super) fn bins(bins: &[Bin]) -> String {
    let percent = |share: f64| format!("{:.1} %", share * 100.0);
    let mut table = vec![["passes", "stated", "found"].map(str::to_owned).to_vec()];
    table.extend(bins.iter().map(|bin| vec![bin.passes.to_string(), percent(bin.stated), percent(bin.found)]));
    aligned(&table)
}

pub(super) fn areas(gains: &[((&str, u8), Gain)], count: u32, seed: u64) -> String {
    let head = ["halls", "sonar", "without areas", "with areas", "ratio", "ratio of the whole search"];
    let mut table = vec![head.map(str::to_owned).to_vec()];
    table.extend(gains.iter().map(|((halls, sonar_cells), gain)| {
        let mut line = vec![(*halls).to_owned(), sonar_cells.to_string()];
        line.extend([gain.to_bomb[0], gain.to_bomb[1], gain.ratio, gain.whole].map(|estimate| estimate.to_string()));
        line
    }));
    format!(
        "{}\n\nExpected cost until the bomb is found, in steps: means of {count} halls each, with their 95 % intervals.\n\
         These halls have seed {seed}. The choice of areas was tuned with halls of seed 1.",
        aligned(&table)
    )
}

pub(super) fn blocks(answers: &[Answer], entrants: &[Entrant], against: Option<usize>) -> String {
    let blocks: Vec<String> = answers.iter().map(|answer| block(answer, entrants, against)).collect();
    blocks.join("\n\n")
}

fn block(answer: &Answer, entrants: &[Entrant], against: Option<usize>) -> String {
    let Answer { question, trials } = answer;
    let contest = &question.contest;
    let mut columns: Vec<String> = ["strategy"].into_iter().chain(Measure::ALL.map(head)).map(str::to_owned).collect();
    columns.extend(["decision p50", "p99", "worst"].map(str::to_owned));
    let judged = question.measure;
    if let Some(other) = against {
        columns.push(format!("{} minus {}", head(judged), entrants[other].name()));
    }
    let mut table = vec![columns];
    for (entrant, mine) in entrants.iter().zip(trials) {
        let mut line = vec![entrant.name().to_owned()];
        line.extend(Measure::ALL.map(|measure| shown(over(mine, measure))));
        line.extend(decisions(mine).map(|time| format!("{:.1} µs", time.as_secs_f64() * 1e6)));
        if let Some(other) = against {
            line.push(shown(differences(mine, &trials[other], judged)));
        }
        table.push(line);
    }
    let count = contest.halls.count();
    let halls = if count == 1 { "one hall".to_owned() } else { format!("{count} halls") };
    let [cells, free] = answer.reach();
    let reach = format!("{cells} of {free} free cells can be reached from the start");
    format!("{} · {halls} · {}\n{reach}\n{}", contest.halls, asked(contest.terms), aligned(&table))
}

pub(super) fn plot(answers: &[Answer], entrants: &[Entrant]) -> String {
    let bands: Vec<Band> = answers
        .iter()
        .map(|Answer { question, trials }| {
            let Question { contest: Contest { halls, terms, .. }, measure, .. } = question;
            let dot = |(entrant, trials): (&Entrant, &Vec<_>)| {
                Some(Dot { name: entrant.name().to_owned(), estimate: over(trials, *measure)? })
            };
            let title = format!("{halls} · {} · {}", asked(*terms), head(*measure));
            Band { title, dots: entrants.iter().zip(trials).filter_map(dot).collect() }
        })
        .collect();
    drawing::plot("Strategies side by side: the mean and its 95 % interval, smaller is better", &bands)
}

fn shown(estimate: Option<Estimate>) -> String {
    estimate.map_or_else(|| "-".to_owned(), |estimate| estimate.to_string())
}

fn aligned(table: &[Vec<String>]) -> String {
    let columns = table.first().map_or(0, Vec::len);
    let width = |column: usize| table.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |line: &Vec<String>| {
        let cells: Vec<String> = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        cells.join("  ").trim_end().to_owned()
    };
    table.iter().map(line).collect::<Vec<_>>().join("\n")
}
