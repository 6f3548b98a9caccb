//! Commands that come again under the same id: answered as before and not carried out again, also after a restart.
//! A STOP is never taken for a repeat: it halts each time.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use crate::core::command::{Accepted, CommandId, Issuer, Refusal, RefusalKind, Refused};
use crate::core::effect::{Entry, Fact};
use crate::core::mission::Input;
use crate::core::refused::OTHER_CONTENT;
use crate::core::units::{Epoch, LuggageId, Ticket};

/// So many ids are remembered: more than any client has under way. Of more the oldest of whoever has most of them is given up, by name
/// and address, so that nobody's flood makes the ids of another forgotten.
pub const IDS: usize = 1024;

/// Who sent it, and its name for the command: two people may use the same.
type Key = (Arc<str>, CommandId);

/// The ids that were used.
#[derive(Clone, Debug, Default)]
pub(super) struct Repeats {
    known: BTreeMap<Key, Repeat>,
    /// Oldest first, each with the address it came from.
    order: VecDeque<(Key, Arc<str>)>,
}

#[derive(Clone, Debug)]
struct Repeat {
    content: String,
    outcome: Outcome,
}

/// What became of a command.
#[derive(Clone, Debug)]
pub(super) enum Outcome {
    /// It waits for its record.
    Open(Ticket),
    /// It was answered.
    Answered(Result<Accepted, Refused>),
    /// It was accepted before the program was started again; the piece it was about.
    Before(Option<LuggageId>),
}

/// What is known of an id.
pub(super) enum Known<'a> {
    /// Nothing.
    New,
    /// It stands for another command.
    Other,
    /// It stands for this one.
    Same(&'a Outcome),
}

impl Repeats {
    /// What is known of this id, sent with this content.
    pub(super) fn look_up(&self, who: &Arc<str>, id: &CommandId, content: &str) -> Known<'_> {
        match self.known.get(&(Arc::clone(who), id.clone())) {
            None => Known::New,
            Some(repeat) if repeat.content != content => Known::Other,
            Some(repeat) => Known::Same(&repeat.outcome),
        }
    }

    /// Notes what became of a command.
    pub(super) fn note(&mut self, issuer: &Issuer, id: &CommandId, content: &str, outcome: Outcome) {
        let key = (Arc::clone(&issuer.who), id.clone());
        let repeat = Repeat { content: content.to_owned(), outcome };
        if repeat.is_to_be_tried_again() {
            return;
        }
        if self.known.insert(key.clone(), repeat).is_none() {
            self.order.push_back((key, Arc::clone(&issuer.from)));
        }
        if self.order.len() > IDS {
            self.give_one_up();
        }
    }

    fn give_one_up(&mut self) {
        let mut counts: BTreeMap<(&str, &str), usize> = BTreeMap::new();
        for ((who, _), from) in &self.order {
            *counts.entry((who, from)).or_default() += 1;
        }
        let most = counts.values().max();
        let oldest = self.order.iter().position(|((who, _), from)| counts.get(&(&**who, &**from)) == most);
        if let Some((key, _)) = oldest.and_then(|oldest| self.order.remove(oldest)) {
            self.known.remove(&key);
        }
    }

    /// The command with this ticket was answered.
    pub(super) fn answer(&mut self, ticket: Ticket, answer: &Result<Accepted, Refused>) {
        let open = self.known.values_mut().find(|repeat| matches!(repeat.outcome, Outcome::Open(open) if open == ticket));
        if let Some(repeat) = open {
            repeat.outcome = Outcome::Answered(answer.clone());
            if repeat.is_to_be_tried_again() {
                self.known.retain(|_, repeat| !repeat.is_to_be_tried_again());
                self.order.retain(|(key, _)| self.known.contains_key(key));
            }
        }
    }

    /// Takes up what the journal says of the commands before a restart.
    pub(super) fn recall(&mut self, entries: &[Entry]) {
        for Entry { fact, .. } in entries {
            if let Fact::Command { issuer, id: Some(id), command, luggage, refused, epoch } = fact {
                // One that contradicted the first of its name was no use of the name, and a STOP never is.
                let contradicted = refused.as_ref().is_some_and(|refusal| refusal.code == OTHER_CONTENT);
                if contradicted || command == Input::Stop.in_words() {
                    continue;
                }
                let outcome = refused.as_ref().map_or(Outcome::Before(*luggage), before);
                self.note(issuer, id, &content(command, *epoch), outcome);
            }
        }
    }
}

/// What makes two commands the same: their words, and the epoch that their sender said it saw.
pub(super) fn content(words: &str, epoch: Option<Epoch>) -> String {
    epoch.map_or_else(|| words.to_owned(), |epoch| format!("{words} in epoch {epoch}"))
}

impl Repeat {
    /// Whether the sender was told to try again: then the same id is another attempt, and not a repeat.
    fn is_to_be_tried_again(&self) -> bool {
        matches!(&self.outcome, Outcome::Answered(Err(refused)) if refused.kind() == RefusalKind::Unavailable)
    }
}

fn before(refusal: &Refusal) -> Outcome {
    Outcome::Answered(Err(Refused::Before(refusal.clone())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::command::Door;

    fn issuer(who: &str, from: &str) -> Issuer {
        Issuer { door: Door::Http, who: who.into(), from: from.into() }
    }

    fn id(n: usize) -> CommandId {
        CommandId::new(&format!("id-{n}")).expect("a short name")
    }

    #[test]
    fn the_oldest_ids_give_way() {
        let mut repeats = Repeats::default();
        for n in 0..=IDS {
            repeats.note(&issuer("operator", "127.0.0.1"), &id(n), "START", Outcome::Before(None));
        }
        assert!(matches!(repeats.look_up(&"operator".into(), &id(0), "START"), Known::New));
        assert!(matches!(repeats.look_up(&"operator".into(), &id(1), "START"), Known::Same(_)));
        assert!(matches!(repeats.look_up(&"operator".into(), &id(1), "RESET"), Known::Other));
        assert!(matches!(repeats.look_up(&"somebody".into(), &id(1), "RESET"), Known::New));
    }

    /// Safety S4, A5: where nobody signs in all have one name, and still an address of their own.
    #[test]
    fn nobodys_flood_makes_the_ids_of_another_forgotten() {
        for (name, address) in [("operator", "127.0.0.7"), ("anna", "127.0.0.1")] {
            let mut repeats = Repeats::default();
            (0..9).for_each(|n| repeats.note(&issuer("operator", "127.0.0.1"), &id(n), "START", Outcome::Before(None)));
            (9..9 * IDS).for_each(|n| repeats.note(&issuer(name, address), &id(n), "RETRIEVE", Outcome::Before(None)));
            assert!((0..9).all(|n| matches!(repeats.look_up(&"operator".into(), &id(n), "START"), Known::Same(_))));
            assert_eq!((repeats.order.len(), repeats.known.len()), (IDS, IDS));
        }
    }
}
