//! Sends a command and waits for its effect, for every door. The result is the answer with a state that contains the
//! effect, or the refusal. A refusal comes with the record of the piece that the command was about. Each door decides
//! how a client sees the result.

use std::sync::Arc;
use std::time::Duration;

use super::handle::{Gone, Handle};
use hallsweep_core::command::{Accepted, LuggageRef, Request};
use hallsweep_core::hall::HallId;
use hallsweep_core::refused::Refused;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::luggage::Luggage;

/// Maximum wait for the state that contains the effect of an accepted command. The loop publishes this state before
/// it answers, so normally there is no wait.
const SEEN_TIME: Duration = Duration::from_millis(500);

#[derive(Clone, Debug)]
pub struct Done {
    pub accepted: Accepted,
    /// State with the answer's revision or a later one. If no such state comes in time, this is the newest known
    /// state.
    pub snapshot: Arc<Snapshot>,
}

#[derive(Clone, Debug)]
pub enum NotDone {
    /// The core refused the command. If the command was about a known piece of luggage, the second value is the
    /// record of this piece. The third value is the hall as in `Snapshot::hall`.
    Refused(Refused, Option<Arc<Luggage>>, Option<HallId>),
    Gone,
}

impl Handle {
    /// Sends a command immediately, as `give` does. The future waits for the result. A stop is carried out even if
    /// the future is dropped. Must be called inside a runtime.
    #[must_use = "the command is given; what became of it is said by the future"]
    pub fn carry_out(&self, request: Request) -> impl Future<Output = Result<Done, NotDone>> + Send + use<> {
        let about = request.command.luggage();
        let given = self.give(request);
        let handle = self.clone();
        async move {
            match given.await {
                Ok(Ok(accepted)) => Ok(Done { accepted, snapshot: handle.seen(accepted).await }),
                Ok(Err(refused)) => Err(NotDone::Refused(refused, handle.record(about), handle.snapshot().hall.clone())),
                Err(Gone) => Err(NotDone::Gone),
            }
        }
    }

    async fn seen(&self, accepted: Accepted) -> Arc<Snapshot> {
        let mut watch = self.watch();
        let contains = |snapshot: &Arc<Snapshot>| snapshot.revision >= accepted.revision;
        // An accepted command stays accepted even if the loop has ended or is slow. In this case the newest known
        // state is returned.
        let _ = tokio::time::timeout(SEEN_TIME, async { watch.wait_for(contains).await.map(|_| ()) }).await;
        self.snapshot()
    }

    fn record(&self, about: Option<LuggageRef>) -> Option<Arc<Luggage>> {
        let snapshot = self.snapshot();
        match about? {
            LuggageRef::Id(id) => snapshot.luggage(id).cloned(),
            LuggageRef::Pending => snapshot.pending().cloned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use tokio::sync::{mpsc, watch};

    use super::*;
    use crate::runtime::halt::Halter;
    use crate::runtime::handle::{COMMANDS, Envelope};
    use hallsweep_core::command::{Command, Door, Issuer};
    use hallsweep_core::engine::Engine;
    use hallsweep_core::settings::Settings;
    use hallsweep_core::units::{Epoch, LuggageId, Revision};

    /// A handle to a loop that answers one command with `answer`. After a while, the loop publishes a state with the
    /// revision `published`.
    fn answering(answer: Result<Accepted, Refused>, published: Revision) -> Handle {
        let (commands, mut envelopes) = mpsc::channel(COMMANDS);
        let mut engine = Engine::new(Settings::default(), Default::default(), "test".into());
        let (publish, snapshots) = watch::channel(engine.snapshot());
        tokio::spawn(async move {
            let Some(Envelope::Command(_, asks)) = envelopes.recv().await else { return };
            let _ = asks.send(answer);
            tokio::time::sleep(SEEN_TIME / 2).await;
            publish.send_modify(|state| *state = Arc::new(Snapshot { revision: published, ..Snapshot::clone(state) }));
            publish.closed().await;
        });
        Handle::new(commands, snapshots, Halter::new(Epoch(0)))
    }

    fn accepted(revision: u64) -> Result<Accepted, Refused> {
        Ok(Accepted { revision: Revision(revision), epoch: Epoch(0), luggage: None, is_kept_back: false })
    }

    fn start() -> Request {
        Request::new(Command::Start, Issuer::operator(Door::LOCAL))
    }

    #[tokio::test(start_paused = true)]
    async fn the_state_that_comes_with_an_answer_contains_its_effect() {
        let done = answering(accepted(70), Revision(71)).carry_out(start()).await.expect("accepted");
        assert_eq!((done.accepted.revision, done.snapshot.revision), (Revision(70), Revision(71)));
    }

    #[tokio::test(start_paused = true)]
    async fn an_accepted_command_is_accepted_although_its_state_does_not_come() {
        let done = answering(accepted(70), Revision(69)).carry_out(start()).await.expect("accepted");
        assert_eq!(done.snapshot.revision, Revision(69));
    }

    #[tokio::test(start_paused = true)]
    async fn a_refusal_and_an_end_are_told_apart() {
        let refused = Refused::UnknownLuggage(LuggageId(9));
        let not_done = answering(Err(refused.clone()), Revision(1)).carry_out(start()).await.expect_err("refused");
        assert!(matches!(not_done, NotDone::Refused(said, None, None) if said == refused));
        let (commands, _) = mpsc::channel(COMMANDS);
        let gone = Handle::new(commands, answering(accepted(1), Revision(1)).watch(), Halter::new(Epoch(0)));
        assert!(matches!(gone.carry_out(start()).await, Err(NotDone::Gone)));
    }
}
