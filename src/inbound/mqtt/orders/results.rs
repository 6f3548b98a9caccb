//! What became of commands, published where their senders look for it: so many waited for at once, and none for ever. A channel
//! that is full loses a result and nothing else; the commands themselves are given elsewhere.

use std::sync::Arc;
use std::time::Duration;

use serde::Serialize;
use tokio::sync::mpsc::error::TrySendError;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};

use super::super::publication::Publication;
use super::super::qak::outgoing;
use super::problem::Problem;
use crate::core::command::CommandId;
use crate::inbound::seldom::Seldom;
use crate::runtime::carry_out::{Done, NotDone};
use crate::wire::answer::AnswerJson;
use crate::wire::result::ResultJson;

/// Commands whose results are waited for at once: as many as the loop's queue holds. A STOP beyond them halts, and has no result.
pub const UNDER_WAY: usize = 256;

/// Nobody waits longer for a result: as long as at the CoAP door.
const PATIENCE: Duration = Duration::from_secs(93);

/// What is refused because there is no photo to judge by.
const NO_PHOTO: &str = "noPhoto";

/// Where results go, and the places of those that are waited for. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct Results {
    answers: mpsc::Sender<Publication>,
    places: Arc<Semaphore>,
    lost: Arc<Seldom>,
}

/// Where one result goes.
#[derive(Clone, Debug)]
pub(super) struct Reply {
    /// The topic; `None` for messages of the original system, which are answered by no message.
    pub(super) topic: Option<String>,
    /// The command's own name.
    pub(super) id: Option<CommandId>,
    /// Where an old client is told why not.
    pub(super) explained: Option<String>,
}

impl Results {
    /// Results go to `answers`.
    pub(super) fn new(answers: mpsc::Sender<Publication>) -> Results {
        Results { answers, places: Arc::new(Semaphore::new(UNDER_WAY)), lost: Arc::default() }
    }

    /// A place for one command more; `None` when there is none.
    pub(super) fn place(&self) -> Option<OwnedSemaphorePermit> {
        Arc::clone(&self.places).try_acquire_owned().ok()
    }

    /// Waits for what becomes of a command, and publishes it. Must be called inside a runtime.
    pub(super) fn follow<F>(&self, done: F, reply: Reply, place: OwnedSemaphorePermit)
    where
        F: Future<Output = Result<Done, NotDone>> + Send + 'static,
    {
        let results = self.clone();
        tokio::spawn(async move {
            match tokio::time::timeout(PATIENCE, done).await {
                Ok(Ok(done)) => results.accepted(&reply, &done),
                Ok(Err(not_done)) => results.refused(&reply, &not_done.into()),
                Err(_) => results.refused(&reply, &Problem::no_answer(PATIENCE)),
            }
            drop(place);
        });
    }

    /// Publishes why something was refused; of what has no result it is said in the program's log.
    pub(super) fn refused(&self, reply: &Reply, problem: &Problem) {
        match &reply.topic {
            Some(topic) => self.publish(topic, reply, problem.shape()),
            None => tracing::info!(why = problem.detail(), "a message of an old client was refused"),
        }
        if let Some(topic) = &reply.explained {
            let way_out = if problem.shape().code == NO_PHOTO { " (continueExplore takes it again)" } else { "" };
            let why = format!("{}{way_out}", problem.detail());
            self.send(topic, outgoing::message(outgoing::why_not(&why), outgoing::ANSWER).into_bytes());
        }
    }

    fn accepted(&self, reply: &Reply, done: &Done) {
        if let Some(topic) = &reply.topic {
            self.publish(topic, reply, &AnswerJson::new(done.accepted, &done.snapshot));
        }
    }

    fn publish(&self, topic: &str, reply: &Reply, said: &impl Serialize) {
        let result = ResultJson { id: reply.id.as_ref().map(CommandId::text), said };
        let payload = serde_json::to_vec(&result).expect("answers and problems are texts, numbers and maps of them");
        self.send(topic, payload);
    }

    fn send(&self, topic: &str, payload: Vec<u8>) {
        let sent = self.answers.try_send(Publication::passing(topic.to_owned(), payload));
        if let Err(TrySendError::Full(_)) = sent
            && let Some(lost) = self.lost.one_more()
        {
            tracing::warn!(topic, lost, "results are not published, because as many as there is room for wait to be sent");
        }
    }
}
