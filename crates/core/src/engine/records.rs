//! Luggage and verdicts that are not stored yet. Nothing about them is shown, answered or acted on before they are
//! stored (safety V3).

use std::sync::Arc;

use super::Engine;
use super::mission::{Deciding, Recording};
use super::outbox::WaitingAnswer;
use crate::command::Verdict;
use crate::event::Photo;
use crate::mission::{Input, InputContext};
use crate::refused::Refused;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::state::{Inspection, Phase, Stage};
use crate::units::{LuggageId, Seq};
use crate::world::hall_map::Mark;
use crate::world::luggage::{Luggage, PhotoState};
use crate::world::resource::Resource;

impl Engine {
    pub(super) fn retake(&mut self, context: &InputContext) {
        if let Some(id) = context.luggage {
            self.set_stage(Stage::RetakingPhoto(id));
        }
    }

    pub(super) fn record_piece(&mut self, context: &InputContext) {
        let Phase::Inspecting(Inspection { cell, piece, pose, .. }) = *self.state.phase.underlying() else { return };
        let id = self.state.last_luggage.next();
        let photo = photo_of(context);
        let state = PhotoState::after(None, &photo);
        let taken = self.now.wall;
        let luggage = Luggage {
            id,
            cell,
            pose,
            taken,
            first_taken: taken,
            photo: state,
            seen_from: Vec::new(),
            verdict: None,
            unsure: Vec::new(),
            judged: Vec::new(),
            truth: None,
            piece,
            secured: None,
            clock_set_ms: 0,
        };
        self.send_record(luggage, photo);
        self.set_stage(Stage::Recording(id));
    }

    /// Records a new photo of a known piece. If the photo failed, an older photo stays valid.
    pub(super) fn record_retake(&mut self, context: &InputContext) {
        let Some(Stage::RetakingPhoto(id)) = self.stage() else { return };
        self.end_photo(id);
        let Some(known) = self.state.luggage.get(id) else { return };
        if context.photo.is_none() && known.has_photo() {
            self.world.write(self.now.wall, Tone::Warning, Said::PhotoStays(id));
            return;
        }
        let photo = photo_of(context);
        let state = PhotoState::after(Some(&known.photo), &photo);
        let later = Luggage { pose: self.state.pose, taken: self.now.wall, photo: state, ..Luggage::clone(known) };
        let luggage = known.photographed_again(&later);
        self.send_record(luggage, photo);
    }

    fn send_record(&mut self, luggage: Luggage, photo: Result<Photo, String>) {
        let fact = Fact::Luggage { record: Arc::new(luggage), photo: photo.ok() };
        let (wall, seq) = (self.now.wall, self.outbox.record(self.now.wall, fact.clone()));
        self.mission.recording.push(Recording { seq, wall, fact });
    }

    /// Asks the operator about a piece whose record is stored. The question has its own entry, and the piece is shown
    /// when that entry is stored too (`on_record.shown`).
    pub(super) fn ask_operator(&mut self, context: &InputContext) {
        let Some(luggage) = context.luggage.and_then(|id| self.state.luggage.get(id)).map(Arc::clone) else { return };
        self.mark(luggage.cell, Mark::Luggage);
        self.set_stage(Stage::AwaitingVerdict(luggage.id));
    }

    /// Sends a verdict to the store. A danger replaces a verdict of safe that is not stored yet (safety V1).
    pub(super) fn record_verdict(&mut self, context: &InputContext) {
        let (Some(luggage), Some(verdict), Some(issuer)) = (context.luggage, context.verdict, &context.issuer) else { return };
        let who = Arc::clone(&issuer.who);
        let (note, hot) = (context.note.clone(), context.hot);
        let replaced = self.mission.deciding.iter().position(|deciding| deciding.luggage == luggage);
        let judged = match replaced.map(|place| self.mission.deciding.remove(place)) {
            Some(replaced) => replaced.judged,
            None => self.publish_judgements(luggage),
        };
        let fact = Fact::Verdict { luggage, verdict, who: Arc::clone(&who), note: note.clone(), hot };
        let seq = self.outbox.record(self.now.wall, fact);
        self.outbox.defer(luggage, seq);
        self.mission.deciding.push(Deciding { seq, wall: self.now.wall, luggage, verdict, who, note, hot, judged });
    }

    /// Handles the report that all entries up to `seq` are stored. Everything that waited for these entries happens
    /// now, in order.
    pub(super) fn kept(&mut self, seq: Seq) {
        self.outbox.keep(seq);
        self.show_kept();
        let (kept, waiting): (Vec<Recording>, _) =
            std::mem::take(&mut self.mission.recording).into_iter().partition(|recording| recording.seq <= seq);
        self.mission.recording = waiting;
        for recording in kept {
            self.keep_record(&recording);
        }
        let (kept, waiting) = std::mem::take(&mut self.mission.deciding).into_iter().partition(|deciding| deciding.seq <= seq);
        self.mission.deciding = waiting;
        for deciding in kept {
            self.decide_piece(deciding);
        }
        self.answer_due();
    }

    fn keep_record(&mut self, Recording { fact, wall, .. }: &Recording) {
        let Fact::Luggage { record, .. } = fact else { return };
        let (id, cell) = (record.id, record.cell);
        let has_photo = record.has_photo();
        let is_known = self.state.luggage.get(id).is_some();
        self.world.touch(Resource::Mission);
        self.state.follow(fact, *wall, self.world.revision());
        let said = if is_known { Said::PhotographedAgain(id) } else { Said::Found { luggage: id, cell, has_photo } };
        self.world.write(self.now.wall, Tone::Info, said);
        if !is_known {
            self.feed(Input::LuggageRecorded, &InputContext { luggage: Some(id), ..InputContext::default() });
        }
    }

    fn decide_piece(&mut self, Deciding { wall, luggage, verdict, who, note, hot, judged, .. }: Deciding) {
        if self.state.luggage.get(luggage).is_none() {
            return;
        }
        self.world.touch(Resource::Mission);
        for judgement in judged {
            self.judges.forget(&judgement);
            self.world.write(self.now.wall, Tone::Info, Said::fact(&Fact::Judged(Box::new(judgement.clone()))));
            self.state.follow(&Fact::Judged(Box::new(judgement)), wall, self.world.revision());
        }
        let fact = Fact::Verdict { luggage, verdict, who, note, hot };
        if self.is_for_two(Some(verdict)) {
            self.world.write(self.now.wall, Tone::Info, Said::fact(&fact));
        }
        self.state.follow(&fact, wall, self.world.revision());
        self.reveal(false);
        let input = match verdict {
            Verdict::Safe => Input::SafeRecorded,
            Verdict::Danger => Input::DangerRecorded,
        };
        self.feed(input, &InputContext { luggage: Some(luggage), verdict: Some(verdict), ..InputContext::default() });
    }

    fn answer_due(&mut self) {
        for waiting in self.outbox.due() {
            if waiting.verdict.is_some() && !waiting.decided && !self.outbox.is_kept() {
                // The consequences of the verdict are shown together with the verdict.
                self.outbox.wait(WaitingAnswer { seq: self.outbox.written(), decided: true, ..waiting });
                continue;
            }
            self.answer_kept(waiting);
        }
    }

    fn answer_kept(&mut self, waiting: WaitingAnswer) {
        let stands = waiting.luggage.and_then(|id| self.verdict_kept(id));
        let answer = match (waiting.luggage, waiting.verdict, stands) {
            (Some(luggage), Some(given), Some(verdict)) if given != verdict => Err(Refused::Decided { luggage, verdict }),
            _ => Ok(self.accepted(waiting.luggage)),
        };
        if let Err(refused) = &answer {
            self.world.write(self.now.wall, Tone::Warning, Said::Overtaken(refused.clone()));
        }
        self.send_answer(waiting.ticket, answer);
    }

    /// Handles a failure of the store. Verdicts that are not stored yet are withdrawn, but a danger among them still
    /// raises an alarm. Senders whose commands may be lost get a refusal.
    pub(super) fn withdraw_unkept(&mut self) {
        for deciding in std::mem::take(&mut self.mission.deciding) {
            if deciding.verdict == Verdict::Danger {
                self.alarm_unrecorded(deciding.luggage);
            }
        }
        self.withdraw_judgements();
        for waiting in self.outbox.give_up() {
            if waiting.decided {
                self.answer_kept(waiting);
                continue;
            }
            let refused = if waiting.verdict.is_some() { Refused::StoreDown } else { Refused::NotKept };
            self.send_answer(waiting.ticket, Err(refused));
        }
    }

    /// Handles the report that the store works again. Entries that it may have lost are recorded once more, except
    /// withdrawn verdicts.
    pub(super) fn record_anew(&mut self) {
        let wall = self.now.wall;
        self.outbox.repeat_commands();
        self.record_state();
        self.show_from(self.outbox.written());
        for mut recording in std::mem::take(&mut self.mission.recording) {
            // The state is recorded before this record, so the record must not lack what has happened meanwhile.
            if let Fact::Luggage { record, .. } = &mut recording.fact
                && let Some(known) = self.state.luggage.get(record.id)
            {
                *record = Arc::new(known.photographed_again(record));
            }
            recording.seq = self.outbox.record(wall, recording.fact.clone());
            self.mission.recording.push(recording);
        }
        self.keep_back_anew();
    }

    pub(super) fn verdict_kept(&self, id: LuggageId) -> Option<Verdict> {
        self.state.luggage.get(id)?.verdict.as_ref().map(|decision| decision.verdict)
    }
}

fn photo_of(context: &InputContext) -> Result<Photo, String> {
    context.photo.clone().ok_or_else(|| context.words.clone().unwrap_or_else(|| "no photo arrived".to_owned()))
}
