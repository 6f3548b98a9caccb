//! The transition table as Markdown, for `docs/mission-table.md` and `hallsweep table`.

use super::rule::{Rule, To};
use super::table::{InputRow, row};
use super::{Input, rules};
use crate::phase::PhaseName;

/// The whole table: what is the same in every phase, then a section per phase with a line per input. Inputs that change
/// nothing are gathered at the end of each section.
#[must_use]
pub fn table_markdown() -> String {
    let mut text = String::from(
        "# The transition table\n\n\
         Printed from `crates/core/src/mission/table/` by `hallsweep table`; a test holds the two together. For every phase and every\n\
         input the first rule that applies decides. What is the same in every phase, or in all but driving, comes first, and once.\n\
         Before the table is asked, a movement command (START, BACK HOME, RETRIEVE, move, goto) that carries an epoch older than the\n\
         last stop's is refused as outdated. Raising a hold during a mission also raises `awaitingStart`.\n",
    );
    text.push_str(&section("in every phase", |input| match row(input) {
        InputRow::Everywhere(rules) => Some(rules),
        InputRow::Halting { .. } | InputRow::ByPhase(_) => None,
    }));
    text.push_str(&section("in every phase but driving", |input| match row(input) {
        InputRow::Halting { elsewhere, .. } => Some(elsewhere),
        InputRow::Everywhere(_) | InputRow::ByPhase(_) => None,
    }));
    for phase in PhaseName::ALL {
        let own = |input| match row(input) {
            InputRow::Everywhere(_) => None,
            InputRow::Halting { elsewhere, .. } => Some(rules(phase, input)).filter(|rules| *rules != elsewhere),
            InputRow::ByPhase(_) => Some(rules(phase, input)),
        };
        text.push_str(&section(&format!("{}: {}", phase.name(), phase.in_words()), own));
    }
    text
}

fn section(title: &str, cell: impl Fn(Input) -> Option<&'static [Rule]>) -> String {
    let mut text = format!("\n## {title}\n\n| input | what follows |\n|---|---|\n");
    let mut idle = Vec::new();
    for input in Input::COMMANDS.into_iter().chain(Input::EVENTS) {
        let Some(cell) = cell(input) else { continue };
        if cell == [Rule::Go(To::Stay, &[])] {
            idle.push(input.in_words());
        } else {
            let lines: Vec<String> = cell.iter().map(|rule| rule_in_words(*rule)).collect();
            text.push_str(&format!("| {} | {} |\n", input.in_words(), lines.join("; ")));
        }
    }
    if !idle.is_empty() {
        text.push_str(&format!("\nChanges nothing here: {}.\n", idle.join(", ")));
    }
    text
}

fn rule_in_words(rule: Rule) -> String {
    match rule {
        Rule::RefuseIf(bar) => format!("refused if {}", bar.in_words()),
        Rule::RefuseIfThen(bar, acts) => format!("refused if {} (but {})", bar.in_words(), acts_in_words(acts)),
        Rule::When(case, to, acts) => format!("when {}: {}", case.in_words(), outcome(to, acts)),
        Rule::Go(to, acts) => outcome(to, acts),
        Rule::Never(bar) => format!("refused: {}", bar.in_words()),
        Rule::AsInterrupted => "as in the interrupted phase, which stays interrupted".to_owned(),
    }
}

fn outcome(to: To, acts: &[super::Act]) -> String {
    let to = match to {
        To::Stay => None,
        To::Phase(phase) => Some(format!("→ **{}**", phase.name())),
        To::Interrupted => Some("→ the interrupted phase".to_owned()),
    };
    let acts = (!acts.is_empty()).then(|| acts_in_words(acts));
    let parts: Vec<String> = [to, acts].into_iter().flatten().collect();
    if parts.is_empty() { "accepted, nothing changes".to_owned() } else { parts.join(", ") }
}

fn acts_in_words(acts: &[super::Act]) -> String {
    acts.iter().map(|act| act.in_words()).collect::<Vec<_>>().join(", ")
}
