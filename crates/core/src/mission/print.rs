//! The transition table as Markdown, for `docs/mission-table.md` and `hallsweep table`.

use super::rule::{Rule, To};
use super::table::{InputRow, row};
use super::{Input, rules};
use crate::phase::PhaseName;

/// Returns the whole table: first the inputs that are the same in every phase, then a section for each phase with a
/// line for each input. Inputs that change nothing are listed at the end of each section.
#[must_use]
pub fn table_markdown() -> String {
    let mut text = String::from(
        "# The transition table\n\n\
         Printed from `crates/core/src/mission/table/` by `hallsweep table`; a test compares the two. For every phase and every\n\
         input the first rule that applies decides. The rules of every phase, and of every phase but driving, come first.\n\
         A single word in code type, such as `operator`, is a hold. A phase in bold type after an arrow is the next phase.\n\
         A movement command (START, BACK HOME, RETRIEVE, move, goto) with an epoch older than the last stop's is refused as\n\
         outdated before these rules apply. Raising a hold during a mission also raises `awaitingStart`.\n",
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
            let has_others = cell.len() > 1;
            let lines: Vec<String> = cell.iter().map(|rule| rule_in_words(*rule, has_others)).collect();
            text.push_str(&format!("| {} | {} |\n", input.in_words(), lines.join("; ")));
        }
    }
    if !idle.is_empty() {
        text.push_str(&format!("\nThese inputs change nothing here: {}.\n", idle.join(", ")));
    }
    text
}

/// Returns the text of a rule. `has_others` is true if the cell of this rule has more than one rule.
fn rule_in_words(rule: Rule, has_others: bool) -> String {
    match rule {
        Rule::RefuseIf(bar) => format!("refused if {}", bar.in_words()),
        Rule::RefuseIfThen(bar, acts) => format!("refused if {} (but still {})", bar.in_words(), acts_in_words(acts)),
        Rule::When(case, to, acts) => format!("when {}: {}", case.in_words(), outcome(to, acts)),
        Rule::Go(to, acts) if has_others => format!("otherwise {}", outcome(to, acts)),
        Rule::Go(to, acts) => outcome(to, acts),
        Rule::Never(bar) if has_others => format!("otherwise refused: {}", bar.in_words()),
        Rule::Never(bar) => format!("refused: {}", bar.in_words()),
        Rule::AsInterrupted => "the rules of the interrupted phase apply, and the present phase continues".to_owned(),
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
