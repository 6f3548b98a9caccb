//! Commands in words, as they stand in the log and in the journal.

use super::InputContext;
use crate::command::{Command, Door, Issuer, Move};
use crate::world::temperature::OPERATOR;

/// What is asked, in words: two commands with the same words are the same command.
#[must_use]
pub fn in_words(command: &Command) -> String {
    let (input, context) = InputContext::of(command, &Issuer::operator(Door::Local), None);
    format!("{}{}", input.in_words(), context.in_words())
}

impl InputContext {
    /// What the command is about, for the log: ` #3`, ` (1, 2)`, or nothing.
    #[must_use]
    pub fn in_words(&self) -> String {
        let luggage = self.luggage.map(|id| format!(" #{id}"));
        let cell = self.cell.map(|cell| format!(" {cell}"));
        let step = self.step.map(|step| format!(" {}", step_in_words(step)));
        let alarm = self.alarm.map(|id| format!(" {id}"));
        let strategy = self.strategy.map(|strategy| format!(" {}", strategy.name()));
        let named = |source: &str| if source == OPERATOR { String::new() } else { format!(" {source}") };
        let reading = self.reading.as_ref().map(|(source, celsius)| format!("{} {} °C", named(source), celsius.degrees()));
        [luggage, cell, step, alarm, strategy, reading].into_iter().flatten().collect()
    }
}

const fn step_in_words(step: Move) -> &'static str {
    match step {
        Move::Forward => "forward",
        Move::Backward => "backward",
        Move::TurnLeft => "left",
        Move::TurnRight => "right",
        Move::NudgeLeft => "a little left",
        Move::NudgeRight => "a little right",
    }
}
