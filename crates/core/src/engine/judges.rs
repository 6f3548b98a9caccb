//! Verdicts of safe by two judges. The answer of the first judge is kept back: it is stored apart from the journal, and
//! nothing that can be seen changes. It becomes public in the same page as the verdict, so nobody else can know before
//! that anybody has answered. A danger never waits.

use std::mem;

use super::Engine;
use crate::command::{Accepted, Verdict};
use crate::effect::KeptBack;
use crate::mission::InputContext;
use crate::refused::Refused;
use crate::settings::SafeBy;
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
    /// Whether a judge other than this sender has answered about the piece. Senders without a key have the same name,
    /// so they count as one judge.
    pub(super) fn has_other_than(&self, context: &InputContext) -> bool {
        let own = context.issuer.as_ref().map(|issuer| issuer.key());
        self.about(context.luggage).any(|answer| Some(answer.judgement.issuer.key()) != own)
    }

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

impl Engine {
    /// Keeps the answer of a first judge back. An equal answer of the same judge is on record already.
    pub(super) fn keep_back(&mut self, context: &InputContext) {
        let (Some(luggage), Some(verdict), Some(issuer)) = (context.luggage, context.verdict, &context.issuer) else { return };
        if self.judges.about(Some(luggage)).next().is_some() {
            return;
        }
        let (issuer, note, wall) = (issuer.clone(), context.note.clone(), self.now.wall);
        let judgement = Judgement { luggage, verdict, issuer, note, hot: context.hot, wall };
        let answers = self.judges.judgements().cloned().chain([judgement.clone()]).collect();
        let list = self.judges.next(answers);
        self.judges.answers.push(Answer { judgement, number: list.number, is_stored: false });
        self.outbox.keep_back(list);
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
            let answers = self.judges.judgements().cloned().collect();
            let list = self.judges.next(answers);
            self.outbox.keep_back(list);
        }
    }

    /// Continues after a restart. Answers about pieces that have got a verdict are on record already. If one judge is
    /// enough now, or the mission is over, the others are recorded.
    pub(super) fn recall_judgements(&mut self, kept_back: Vec<Judgement>) {
        let is_pending =
            |judgement: &Judgement| self.state.luggage.get(judgement.luggage).is_some_and(|piece| piece.is_pending());
        let answers = kept_back.into_iter().filter(is_pending);
        self.judges.answers = answers.map(|judgement| Answer { judgement, number: 0, is_stored: true }).collect();
        if self.settings.rules.safe_by == SafeBy::One {
            self.publish_all_judgements();
        }
    }

    /// Whether a command must leave no trace: a *safe* about a piece that waits for two judges, if it is kept back or
    /// refused. A trace would tell others what its sender thinks of the piece.
    pub(super) fn is_secret(&self, context: &InputContext, is_kept_back: bool, is_refused: bool) -> bool {
        let is_about_two = self.settings.rules.safe_by == SafeBy::Two && context.verdict == Some(Verdict::Safe);
        let piece = context.luggage.and_then(|id| self.state.luggage.get(id));
        is_kept_back || is_about_two && is_refused && piece.is_some_and(|piece| piece.is_pending())
    }
}
