//! Verdicts of safe by two judges. The answer of the first judge is kept back: it is stored apart from the journal, and
//! nothing that can be seen changes. It becomes public in the same page as the verdict. Until then, nobody else can know
//! that anybody has answered. A danger never waits.

use std::mem;

use super::Engine;
use crate::asked::Asked;
use crate::command::{Accepted, Command, Issuer, Verdict};
use crate::effect::KeptBack;
use crate::mission::InputContext;
use crate::refused::Refused;
use crate::settings::{HotRule, SafeBy};
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::units::{LuggageId, Ticket};
use crate::world::luggage::Judgement;

/// The answers that are kept back, and the senders who wait until theirs is stored.
#[derive(Clone, Debug, Default)]
pub(super) struct Judges {
    answers: Vec<Answer>,
    /// Number of the last list of answers that was sent to the store.
    number: u64,
    waiting: Vec<(u64, Ticket, LuggageId)>,
}

#[derive(Clone, Debug)]
struct Answer {
    judgement: Judgement,
    /// Number of the list with which this answer was first sent to the store.
    number: u64,
    is_stored: bool,
}

impl Judges {
    fn about(&self, luggage: Option<LuggageId>) -> impl Iterator<Item = &Answer> {
        self.answers.iter().filter(move |answer| Some(answer.judgement.luggage) == luggage)
    }

    pub(super) fn forget(&mut self, judgement: &Judgement) {
        self.answers.retain(|answer| answer.judgement != *judgement);
    }

    fn next(&mut self, answers: Vec<Judgement>) -> KeptBack {
        self.number += 1;
        KeptBack { number: self.number, answers }
    }

    fn judgements(&self) -> impl Iterator<Item = &Judgement> {
        self.answers.iter().map(|answer| &answer.judgement)
    }
}

/// Whether a text may be a verdict, also one that is written wrongly, or in the words of an old client.
#[must_use]
pub fn tells_of_verdict(text: &str) -> bool {
    let text = text.to_ascii_lowercase();
    ["safe", "verdict", "afterphoto"].iter().any(|word| text.contains(word))
}

impl Engine {
    /// Whether the answer of another judge counts. Different persons with one key are one judge.
    pub(super) fn is_second_judge(&self, context: &InputContext) -> bool {
        let own = context.issuer.as_ref().map(|issuer| issuer.key());
        self.counted(context.luggage).any(|judgement| Some(judgement.issuer.key()) != own)
    }

    /// Whether this sender has answered already, so that a bare *safe* of the same sender repeats that answer.
    pub(super) fn has_answered(&self, context: &InputContext) -> bool {
        let own = context.issuer.as_ref().map(|issuer| issuer.key());
        self.counted(context.luggage).any(|judgement| Some(judgement.issuer.key()) == own)
    }

    /// The answers that count: about the present photo, and complete if the rules ask for that.
    fn counted(&self, luggage: Option<LuggageId>) -> impl Iterator<Item = &Judgement> {
        let taken = luggage.and_then(|id| self.state.luggage.get(id)).map(|piece| piece.taken);
        let needs_hot = self.settings.rules.hot == HotRule::Required;
        let counts = move |judgement: &&Judgement| Some(judgement.taken) == taken && (!needs_hot || judgement.hot.is_complete());
        self.judges.about(luggage).map(|answer| &answer.judgement).filter(counts)
    }

    /// Keeps the answer of a first judge back. It replaces an earlier answer of the same judge, unless it adds nothing.
    pub(super) fn keep_back(&mut self, context: &InputContext) {
        let (Some(luggage), Some(verdict), Some(issuer)) = (context.luggage, context.verdict, &context.issuer) else { return };
        let Some(taken) = self.state.luggage.get(luggage).map(|piece| piece.taken) else { return };
        let (issuer, note, wall) = (issuer.clone(), context.note.clone(), self.now.wall);
        let (id, is_bare) = (context.id.clone(), context.is_bare);
        let judgement = Judgement { luggage, verdict, issuer, note, hot: context.hot, wall, taken, id, is_bare };
        let is_own = |other: &Judgement| other.luggage == luggage && other.issuer.key() == judgement.issuer.key();
        let says_the_same =
            |other: &Judgement| (&other.note, other.hot, other.taken) == (&judgement.note, judgement.hot, judgement.taken);
        let adds_nothing = |other: &Judgement| {
            let is_bare_word = judgement.note.is_none() && judgement.hot.is_empty() && other.taken == taken;
            is_own(other) && (is_bare_word || says_the_same(other))
        };
        if self.judges.judgements().any(adds_nothing) {
            return;
        }
        self.judges.answers.retain(|answer| !is_own(&answer.judgement));
        let answers = self.judges.judgements().cloned().chain([judgement.clone()]).collect();
        let list = self.judges.next(answers);
        self.judges.answers.push(Answer { judgement, number: list.number, is_stored: false });
        self.outbox.keep_back(list);
    }

    /// Withdraws the answer of a judge who is unsure now. Returns whether there was one.
    pub(super) fn take_back(&mut self, luggage: LuggageId, judge: &Issuer) -> bool {
        let is_own = |other: &Judgement| other.luggage == luggage && other.issuer.key() == judge.key();
        let is_there = self.judges.judgements().any(is_own);
        if is_there {
            self.judges.answers.retain(|answer| !is_own(&answer.judgement));
            self.store_judgements();
        }
        is_there
    }

    pub(super) fn answer_when_kept_back(&mut self, ticket: Ticket, context: &InputContext) {
        let Some(luggage) = context.luggage else { return };
        let unstored = self.judges.about(Some(luggage)).find(|answer| !answer.is_stored).map(|answer| answer.number);
        match unstored {
            Some(number) => self.judges.waiting.push((number, ticket, luggage)),
            None => self.answer_kept_back(ticket, luggage),
        }
    }

    fn answer_kept_back(&mut self, ticket: Ticket, luggage: LuggageId) {
        let accepted = Accepted { is_kept_back: true, ..self.accepted(Some(luggage)) };
        self.send_answer(ticket, Ok(accepted));
    }

    pub(super) fn judgements_kept(&mut self, number: u64) {
        for answer in &mut self.judges.answers {
            answer.is_stored |= answer.number <= number;
        }
        let (due, waiting) = mem::take(&mut self.judges.waiting).into_iter().partition(|(waits_for, ..)| *waits_for <= number);
        self.judges.waiting = waiting;
        for (_, ticket, luggage) in due {
            self.answer_kept_back(ticket, luggage);
        }
    }

    /// Records the answers about this piece in front of its verdict. Returns them, because they count only once the
    /// page is stored.
    pub(super) fn publish_judgements(&mut self, luggage: LuggageId) -> Vec<Judgement> {
        let judged: Vec<Judgement> = self.judges.about(Some(luggage)).map(|answer| answer.judgement.clone()).collect();
        if judged.is_empty() {
            return judged;
        }
        for judgement in &judged {
            // A repeat with this id stays a repeat after a restart.
            if let Some(id) = &judgement.id {
                let (issuer, asked) = (judgement.issuer.clone(), Asked::Command(judgement.command()));
                let (id, luggage) = (Some(id.clone()), Some(luggage));
                self.outbox.record(self.now.wall, Fact::Command { issuer, id, asked, epoch: None, luggage, refused: None });
            }
            self.outbox.record(self.now.wall, Fact::Judged(Box::new(judgement.clone())));
        }
        let left = self.judges.judgements().filter(|judgement| judgement.luggage != luggage).cloned().collect();
        let list = self.judges.next(left);
        self.outbox.keep_back(list);
        judged
    }

    /// Records all answers, because their pieces will not get a verdict any more.
    pub(super) fn publish_all_judgements(&mut self) {
        let pieces: Vec<LuggageId> = self.judges.judgements().map(|judgement| judgement.luggage).collect();
        for luggage in pieces {
            for judgement in self.publish_judgements(luggage) {
                self.judges.forget(&judgement);
                let fact = Fact::Judged(Box::new(judgement));
                self.world.write(self.now.wall, Tone::Info, Said::fact(&fact));
                self.state.follow(&fact, self.now.wall, self.world.revision());
            }
        }
    }

    /// Takes the answers back that are not stored yet, because the store has failed.
    pub(super) fn withdraw_judgements(&mut self) {
        self.judges.answers.retain(|answer| answer.is_stored);
        for (_, ticket, _) in mem::take(&mut self.judges.waiting) {
            self.send_answer(ticket, Err(Refused::StoreDown));
        }
    }

    /// Stores the answers once more, after the store has failed.
    pub(super) fn keep_back_anew(&mut self) {
        if self.judges.number > 0 {
            self.store_judgements();
        }
    }

    fn store_judgements(&mut self) {
        let answers = self.judges.judgements().cloned().collect();
        let list = self.judges.next(answers);
        self.outbox.keep_back(list);
    }

    /// Continues after a restart. Answers about pieces that have got a verdict are on record already, and answers from
    /// another journal are about other pieces. A judge who was unsure later has taken the answer back. If one judge is
    /// enough now, the others are recorded.
    pub(super) fn recall_judgements(&mut self, kept_back: Vec<Judgement>) {
        let is_awaited = |judgement: &Judgement| {
            let piece = self.state.luggage.get(judgement.luggage);
            piece.is_some_and(|piece| {
                let key = judgement.issuer.key();
                let is_taken_back =
                    piece.unsure.iter().any(|doubt| Issuer::key_of(&doubt.who) == &*key && doubt.wall >= judgement.wall);
                let is_of_piece = piece.is_pending() && piece.first_taken <= judgement.taken;
                is_of_piece && !is_taken_back && !piece.judged.contains(judgement)
            })
        };
        let answers = kept_back.into_iter().filter(is_awaited);
        self.judges.answers = answers.map(|judgement| Answer { judgement, number: 0, is_stored: true }).collect();
        if self.settings.rules.safe_by == SafeBy::One {
            self.publish_all_judgements();
        }
    }

    /// Whether a command must leave no trace: a *safe* about a piece that waits for two judges, if it is kept back or
    /// refused. A trace would tell others what its sender thinks of the piece.
    pub(super) fn is_secret(&self, context: &InputContext, is_kept_back: bool, is_refused: bool) -> bool {
        is_kept_back || self.is_for_two(context.verdict) && is_refused && self.is_about_two(context.luggage)
    }

    /// Whether this piece waits for two judges.
    pub(super) fn is_about_two(&self, luggage: Option<LuggageId>) -> bool {
        let is_pending = luggage.and_then(|id| self.state.luggage.get(id)).is_some_and(|piece| piece.is_pending());
        is_pending && self.settings.rules.safe_by == SafeBy::Two
    }

    /// Whether a request that a door has refused may be an answer to a piece that waits for two judges. The doors do
    /// not understand such a request, so its words decide.
    #[must_use]
    pub fn may_be_answer(&self, asked: &Asked, refused: &Refused) -> bool {
        let tells = match asked {
            Asked::Command(Command::Verdict { verdict, .. }) => *verdict == Verdict::Safe,
            Asked::Words(words) => tells_of_verdict(words) || tells_of_verdict(&refused.to_string()),
            Asked::Many { last, .. } => return self.may_be_answer(last, refused),
            Asked::Command(_) | Asked::Stops { .. } | Asked::Simulated(_) => false,
        };
        tells && self.settings.rules.safe_by == SafeBy::Two && self.state.luggage.pending().next().is_some()
    }

    /// Whether this verdict needs two judges.
    pub(super) fn is_for_two(&self, verdict: Option<Verdict>) -> bool {
        self.settings.rules.safe_by == SafeBy::Two && verdict == Some(Verdict::Safe)
    }

    /// Whether the figures may count this command. A count of verdicts would tell that somebody has answered.
    #[must_use]
    pub fn is_counted(&self, command: &Command) -> bool {
        self.settings.rules.safe_by == SafeBy::One || !matches!(command, Command::Verdict { .. })
    }
}
