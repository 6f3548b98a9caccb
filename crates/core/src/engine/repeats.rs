//! Commands that are repeated with the same id get the same answer and are not carried out again, even after a
//! restart. STOP is an exception: it halts each time (`stops`).

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::asked::Asked;
use crate::command::{Accepted, Command, CommandId, Issuer, Request};
use crate::refused::{OTHER_CONTENT, RefusalKind, Refused};
use crate::state::fact::{Entry, Fact};
use crate::units::{Epoch, LuggageId, Ticket};
use crate::world::luggage::Judgement;

/// Maximum number of ids that are remembered. No client has as many unanswered commands. At the limit, the sender
/// with the most ids (by name and address) loses its oldest id. A flood from one address therefore removes no id of
/// another sender.
pub const IDS: usize = 1024;

/// The sender, and its id for the command. Two senders may use the same id.
type Key = (Arc<str>, CommandId);

type IdOwner = (Arc<str>, Arc<str>);

#[derive(Clone, Debug, Default)]
pub(super) struct Repeats {
    known: BTreeMap<Key, Repeat>,
    ids: BTreeMap<IdOwner, BTreeMap<u64, CommandId>>,
    /// The senders, ordered by their number of ids. Among senders with equally many ids, the one with the oldest id
    /// comes last.
    ranks: BTreeMap<(usize, Reverse<u64>), IdOwner>,
    open: BTreeMap<Ticket, Key>,
    noted: u64,
}

#[derive(Clone, Debug)]
struct Repeat {
    content: Content,
    outcome: Outcome,
    /// The address that first sent the command.
    from: Arc<str>,
    /// The number of the id. Later ids have higher numbers.
    number: u64,
}

/// The request, and the epoch that the sender named. Two commands with equal content count as the same command.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Content {
    asked: Asked,
    epoch: Option<Epoch>,
}

#[derive(Clone, Debug)]
pub(super) enum Outcome {
    Open(Ticket),
    Answered(Result<Accepted, Refused>),
    /// The command was accepted before a restart of the program. The value is the piece that the command was about.
    Before(Option<LuggageId>),
}

pub(super) enum IdUse<'a> {
    New,
    Other,
    Same(&'a Outcome),
}

impl Repeats {
    pub(super) fn look_up(&self, who: &Arc<str>, id: &CommandId, content: &Content) -> IdUse<'_> {
        match self.known.get(&(Arc::clone(who), id.clone())) {
            None => IdUse::New,
            Some(repeat) if repeat.content != *content => IdUse::Other,
            Some(repeat) => IdUse::Same(&repeat.outcome),
        }
    }

    pub(super) fn note(&mut self, issuer: &Issuer, id: &CommandId, content: Content, outcome: Outcome) {
        if outcome.is_to_be_tried_again() {
            return;
        }
        let key = (issuer.key(), id.clone());
        self.forget(&key);
        if let Outcome::Open(ticket) = outcome {
            self.open.insert(ticket, key.clone());
        }
        let (from, number) = (Arc::clone(&issuer.from), self.noted);
        self.noted += 1;
        self.change_ids((Arc::clone(&key.0), Arc::clone(&from)), |ids| ids.insert(number, key.1.clone()));
        self.known.insert(key, Repeat { content, outcome, from, number });
        if self.known.len() > IDS {
            self.give_one_up();
        }
    }

    fn give_one_up(&mut self) {
        let most = self.ranks.last_key_value().and_then(|(_, sender)| Some((sender, self.ids.get(sender)?)));
        let oldest = most.and_then(|((who, _), ids)| Some((Arc::clone(who), ids.first_key_value()?.1.clone())));
        if let Some(key) = oldest {
            self.forget(&key);
        }
    }

    fn forget(&mut self, key: &Key) {
        if let Some(Repeat { from, number, .. }) = self.known.remove(key) {
            self.change_ids((Arc::clone(&key.0), from), |ids| ids.remove(&number));
        }
    }

    fn change_ids(&mut self, sender: IdOwner, change: impl FnOnce(&mut BTreeMap<u64, CommandId>) -> Option<CommandId>) {
        let rank = |ids: &BTreeMap<u64, CommandId>| ids.first_key_value().map(|(oldest, _)| (ids.len(), Reverse(*oldest)));
        let ids = self.ids.entry(sender.clone()).or_default();
        if let Some(before) = rank(ids) {
            self.ranks.remove(&before);
        }
        change(ids);
        match rank(ids) {
            Some(rank) => drop(self.ranks.insert(rank, sender)),
            None => drop(self.ids.remove(&sender)),
        }
    }

    pub(super) fn answer(&mut self, ticket: Ticket, answer: &Result<Accepted, Refused>) {
        let Some(key) = self.open.remove(&ticket) else { return };
        // The id of this command may have been forgotten and then used for another command.
        let is_its = |repeat: &&mut Repeat| matches!(repeat.outcome, Outcome::Open(open) if open == ticket);
        let Some(repeat) = self.known.get_mut(&key).filter(is_its) else { return };
        repeat.outcome = Outcome::Answered(answer.clone());
        if repeat.outcome.is_to_be_tried_again() {
            self.forget(&key);
        }
    }

    /// Remembers the answer of a judge that is kept back.
    pub(super) fn recall_judgement(&mut self, judgement: &Judgement) {
        let Some(id) = &judgement.id else { return };
        let content = Content { asked: Asked::Command(judgement.command()), epoch: None };
        self.note(&judgement.issuer, id, content, Outcome::Before(Some(judgement.luggage)));
    }

    pub(super) fn recall(&mut self, entries: &[Entry]) {
        for Entry { fact, .. } in entries {
            if let Fact::Command { issuer, id: Some(id), asked, luggage, refused, epoch } = fact {
                // If a command was refused because it contradicts an earlier command, the id still belongs to the
                // earlier command. A STOP never uses an id.
                let contradicted = refused.as_ref().is_some_and(|refused| refused.code() == OTHER_CONTENT);
                if contradicted || *asked == Asked::Command(Command::Stop) {
                    continue;
                }
                let outcome = match refused {
                    Some(refused) => Outcome::Answered(Err(refused.clone())),
                    None => Outcome::Before(*luggage),
                };
                let content = Content { asked: asked.clone(), epoch: *epoch };
                self.note(issuer, id, content, outcome);
            }
        }
    }
}

impl Content {
    pub(super) fn of(request: &Request) -> Content {
        Content { asked: Asked::Command(request.command.clone()), epoch: request.epoch }
    }
}

impl Outcome {
    /// Whether the sender was told to try again. If so, a command with the same id is a new attempt, and not a
    /// repeat.
    fn is_to_be_tried_again(&self) -> bool {
        matches!(self, Outcome::Answered(Err(refused)) if refused.kind() == RefusalKind::Unavailable)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Door;

    fn issuer(who: &str, from: &str) -> Issuer {
        Issuer { door: Door("http"), who: who.into(), from: from.into() }
    }

    fn id(n: usize) -> CommandId {
        CommandId::new(&format!("id-{n}")).expect("a short name")
    }

    fn asked(words: &str) -> Content {
        Content { asked: Asked::Words(words.to_owned()), epoch: None }
    }

    #[test]
    fn the_oldest_ids_give_way() {
        let mut repeats = Repeats::default();
        for n in 0..=IDS {
            repeats.note(&issuer("operator", "127.0.0.1"), &id(n), asked("START"), Outcome::Before(None));
        }
        assert!(matches!(repeats.look_up(&"operator".into(), &id(0), &asked("START")), IdUse::New));
        assert!(matches!(repeats.look_up(&"operator".into(), &id(1), &asked("START")), IdUse::Same(_)));
        assert!(matches!(repeats.look_up(&"operator".into(), &id(1), &asked("RESET")), IdUse::Other));
        assert!(matches!(repeats.look_up(&"somebody".into(), &id(1), &asked("RESET")), IdUse::New));
    }

    /// Safety S4, A5: without authentication, all senders have the same name but different addresses.
    #[test]
    fn nobodys_flood_makes_the_ids_of_another_forgotten() {
        for (name, address) in [("operator", "127.0.0.7"), ("anna", "127.0.0.1")] {
            let mut repeats = Repeats::default();
            (0..9).for_each(|n| repeats.note(&issuer("operator", "127.0.0.1"), &id(n), asked("START"), Outcome::Before(None)));
            (9..9 * IDS).for_each(|n| repeats.note(&issuer(name, address), &id(n), asked("RETRIEVE"), Outcome::Before(None)));
            assert!((0..9).all(|n| matches!(repeats.look_up(&"operator".into(), &id(n), &asked("START")), IdUse::Same(_))));
            let ids = || repeats.ids.values().map(BTreeMap::len);
            assert_eq!((repeats.known.len(), ids().sum(), repeats.ranks.len()), (IDS, IDS, ids().count()));
        }
    }

    /// Of several addresses with equally many ids, the one with the oldest id loses it.
    #[test]
    fn among_equals_the_oldest_gives_way() {
        let mut repeats = Repeats::default();
        let mut note = |n: usize| {
            repeats.note(
                &issuer("operator", &format!("127.0.{}.{}", n / 256, n % 256)),
                &id(n),
                asked("START"),
                Outcome::Before(None),
            );
            (0..=n)
                .filter(|n| matches!(repeats.look_up(&"operator".into(), &id(*n), &asked("START")), IdUse::New))
                .collect::<Vec<_>>()
        };
        (0..IDS).for_each(|n| assert!(note(n).is_empty()));
        assert_eq!((note(IDS), note(IDS + 1)), (vec![0], vec![0, 1]));
    }

    #[test]
    fn an_id_whose_sender_was_told_to_try_again_is_free() {
        let mut repeats = Repeats::default();
        let anna = issuer("anna", "192.0.2.7");
        repeats.note(&anna, &id(0), asked("START"), Outcome::Open(Ticket(1)));
        repeats.answer(Ticket(1), &Err(Refused::StoreDown));
        assert!(matches!(repeats.look_up(&anna.who, &id(0), &asked("RESET")), IdUse::New));
        assert_eq!((repeats.known.len(), repeats.ids.len(), repeats.ranks.len()), (0, 0, 0));
    }

    /// A journal of another version may hold requests as text.
    #[test]
    fn words_that_are_no_command_are_the_same_as_themselves_alone() {
        let mut repeats = Repeats::default();
        let anna = issuer("anna", "192.0.2.7");
        repeats.note(&anna, &id(0), asked("safe #1 and #2"), Outcome::Before(None));
        assert!(matches!(repeats.look_up(&anna.who, &id(0), &asked("safe #1 and #2")), IdUse::Same(_)));
        assert!(matches!(repeats.look_up(&anna.who, &id(0), &asked("safe #1")), IdUse::Other));
    }

    /// A journal may hold an id twice, if the id was forgotten in between.
    #[test]
    fn an_id_that_comes_twice_takes_one_place() {
        let mut repeats = Repeats::default();
        for from in ["192.0.2.7", "192.0.2.8"] {
            repeats.note(&issuer("anna", from), &id(0), asked("START"), Outcome::Before(None));
        }
        assert_eq!((repeats.known.len(), repeats.ids.len(), repeats.ranks.len()), (1, 1, 1));
    }

    #[test]
    fn an_id_that_was_given_up_and_used_again_gets_no_answer_of_the_first() {
        let mut repeats = Repeats::default();
        let anna = issuer("anna", "192.0.2.7");
        let refused = Err(Refused::Moving);
        repeats.note(&anna, &id(0), asked("START"), Outcome::Open(Ticket(1)));
        (1..=IDS).for_each(|n| repeats.note(&anna, &id(n), asked("START"), Outcome::Before(None)));
        repeats.note(&anna, &id(0), asked("RESET"), Outcome::Open(Ticket(2)));
        repeats.answer(Ticket(1), &refused);
        let outcome = |repeats: &Repeats| match repeats.look_up(&anna.who, &id(0), &asked("RESET")) {
            IdUse::Same(outcome) => format!("{outcome:?}"),
            IdUse::New | IdUse::Other => panic!("it is known"),
        };
        assert_eq!(outcome(&repeats), "Open(Ticket(2))");
        repeats.answer(Ticket(2), &refused);
        assert_eq!((outcome(&repeats), repeats.open.len()), ("Answered(Err(Moving))".to_owned(), 0));
    }
}
