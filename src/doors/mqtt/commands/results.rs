//! Publishes the results of commands on the topics where their senders expect them. The number of awaited results is
//! bounded, and so is the time for each. If there is no room, the result is lost, but the command is still carried
//! out.

use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use serde::Serialize;
use tokio::sync::mpsc;
use tokio::sync::mpsc::error::TrySendError;

use super::super::publication::{Beside, Publication};
use super::super::qak::outgoing;
use super::problem::Problem;
use super::publisher::Publisher;
use crate::api::answer::AnswerJson;
use crate::api::result::ResultJson;
use crate::doors::connection_limits::{Permit, ResultQuota};
use crate::doors::log_throttle::LogThrottle;
use crate::runtime::carry_out::{Done, NotDone};
use hallsweep_core::command::{Accepted, CommandId};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use mqtt_gate::AnswerTo;

/// Maximum number of results awaited at once. The loop's queue has the same size. A STOP beyond this number halts,
/// but gets no result.
const UNDER_WAY: usize = 256;

/// Maximum number of results awaited for viewers, who may only send STOP.
const VIEWERS_UNDER_WAY: usize = 64;

/// Maximum number of answers waiting to be published.
pub const ANSWERS: usize = UNDER_WAY + VIEWERS_UNDER_WAY;

/// Maximum wait for a result, as at the CoAP door.
const PATIENCE: Duration = Duration::from_secs(93);

/// Code of the refusal when a piece has no usable photo.
const NO_PHOTO: &str = "noPhoto";

#[derive(Clone, Debug)]
pub(super) struct Results {
    answers: mpsc::Sender<ResultMessage>,
    under_way: ResultQuota,
    waiting: ResultQuota,
    lost: Arc<LogThrottle>,
}

/// A result that waits to be published. Taking the publication out frees its place.
#[derive(Debug)]
pub struct ResultMessage {
    publication: Publication,
    _permit: Permit,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Reply {
    /// The topic of the result. `None` for a message of the original system: its sender only gets the reason of a
    /// refusal.
    pub(super) topic: Option<String>,
    pub(super) correlation: Option<Bytes>,
    pub(super) id: Option<CommandId>,
    /// The old topic on which an old client is told why its command is refused.
    pub(super) explained: Option<String>,
    /// Whether nothing is published while the piece still waits for its verdict, because everybody may read a result.
    pub(super) is_confidential: bool,
}

impl Reply {
    pub(super) fn confidential(self) -> Reply {
        Reply { is_confidential: true, ..self }
    }

    pub(super) fn is_wanted(&mut self, wanted: Option<AnswerTo<'_>>) {
        if let (Some(topic), Some(wanted)) = (&mut self.topic, wanted) {
            wanted.topic.clone_into(topic);
            self.correlation = wanted.correlation.map(Bytes::copy_from_slice);
        }
    }
}

impl Results {
    pub(super) fn new(answers: mpsc::Sender<ResultMessage>) -> Results {
        let places = || ResultQuota::new(UNDER_WAY, VIEWERS_UNDER_WAY);
        Results { answers, under_way: places(), waiting: places(), lost: Arc::default() }
    }

    /// Reserves a place for the result of one more command of this sender.
    ///
    /// # Errors
    /// If no place is free. The error is the number of commands under way.
    pub(super) fn permit(&self, publisher: &Publisher) -> Result<Permit, usize> {
        self.under_way.take(publisher.is_viewer(), publisher.key())
    }

    /// Waits for the result of a command, for `PATIENCE` at most, and publishes it. Must be called inside a runtime.
    pub(super) fn follow<F>(&self, done: F, reply: Reply, publisher: Publisher, permit: Permit)
    where
        F: Future<Output = Result<Done, NotDone>> + Send + 'static,
    {
        let results = self.clone();
        tokio::spawn(async move {
            match tokio::time::timeout(PATIENCE, done).await {
                Ok(Ok(Done { accepted: Accepted { is_kept_back: true, .. }, .. })) => {}
                Ok(Err(NotDone::Refused(_, Some(piece), _))) if reply.is_confidential && piece.is_pending() => {}
                Ok(Err(NotDone::Gone)) | Err(_) if reply.is_confidential => {}
                Ok(Ok(done)) => results.accepted(&reply, &publisher, &done),
                Ok(Err(not_done)) => results.refused(&reply, &publisher, &not_done.into()),
                Err(_) => results.refused(&reply, &publisher, &Problem::no_answer(PATIENCE)),
            }
            drop(permit);
        });
    }

    /// Publishes a refusal. If there is no topic for it, the refusal is logged.
    pub(super) fn refused(&self, reply: &Reply, publisher: &Publisher, problem: &Problem) {
        match &reply.topic {
            Some(topic) => self.publish(topic, reply, publisher, None, &problem.shape()),
            None => tracing::info!(why = problem.detail(), "a message of an old client was refused"),
        }
        if let Some(topic) = &reply.explained {
            let is_bomb_located = *problem.detail() == *Refused::NotInPhase(PhaseName::BombLocated).to_string();
            let way_out = match problem.code() {
                NO_PHOTO => " (continueExplore takes the photo again)",
                _ if is_bomb_located => " (reachBag fetches the bag)",
                _ => "",
            };
            let why = format!("{}{way_out}", problem.detail());
            let told = outgoing::message(outgoing::why_not(&why), outgoing::ANSWER);
            self.send(Publication::passing(topic.clone(), told), publisher);
        }
    }

    fn accepted(&self, reply: &Reply, publisher: &Publisher, done: &Done) {
        if let Some(topic) = &reply.topic {
            let answer = AnswerJson::new(done.accepted, &done.snapshot);
            self.publish(topic, reply, publisher, Some(answer.revision), &answer);
        }
    }

    fn publish(&self, topic: &str, reply: &Reply, publisher: &Publisher, revision: Option<u64>, said: &impl Serialize) {
        let result = ResultJson { id: reply.id.as_ref().map(CommandId::text), said };
        let payload = serde_json::to_vec(&result).expect("answers and problems are texts, numbers and maps of them");
        let (by, correlation) = (Some(publisher.issuer().who), reply.correlation.clone());
        let beside = Beside { is_json: true, revision, by, correlation };
        self.send(Publication { beside, ..Publication::passing(topic.to_owned(), payload) }, publisher);
    }

    fn send(&self, publication: Publication, publisher: &Publisher) {
        let topic = publication.topic.clone();
        let answer = self
            .waiting
            .take(publisher.is_viewer(), publisher.key())
            .map(|permit| ResultMessage { publication, _permit: permit });
        // A closed channel means that the program is ending, so the result does not count as lost.
        let is_lost = answer.map_or(true, |answer| matches!(self.answers.try_send(answer), Err(TrySendError::Full(_))));
        if is_lost && let Some(lost) = self.lost.one_more() {
            tracing::warn!(topic, lost, "results were not published, because too many results wait to be sent");
        }
    }
}

impl ResultMessage {
    pub fn taken(self) -> Publication {
        self.publication
    }
}
