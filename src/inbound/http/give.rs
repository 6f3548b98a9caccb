//! Giving a command to the core and waiting for its answer, for every route of this door.
//! Who may give it stands in `by`; what the answer looks like is the route's business.

use std::sync::Arc;
use std::time::Duration;

use super::Door;
use super::problem::Problem;
use crate::core::command::{Accepted, Command, LuggageRef, Refused, Request};
use crate::core::world::luggage::Luggage;
use crate::core::world::snapshot::Snapshot;
use crate::runtime::handle::Gone;
use crate::wire::luggage::LuggageJson;

/// How long an accepted command's state is waited for; the loop publishes it before it answers, so this is a bound, not a wait.
const SEEN_TIME: Duration = Duration::from_millis(500);

/// A command that was carried out: its answer, and a state that contains its effect.
pub(super) struct Done {
    pub(super) accepted: Accepted,
    pub(super) snapshot: Arc<Snapshot>,
}

impl Door {
    /// Gives a command and waits for its answer.
    pub(super) async fn give(&self, request: Request) -> Result<Done, Problem> {
        let about = request.command.luggage();
        match self.answer_to(request).await {
            Ok(Ok(accepted)) => Ok(Done { accepted, snapshot: self.seen(accepted).await }),
            Ok(Err(refused)) => Err(self.refusal(&refused, about)),
            Err(Gone) => Err(Problem::closing()),
        }
    }

    /// A stop is seen through in a task of its own, so that a sender who hangs up does not take it back.
    async fn answer_to(&self, request: Request) -> Given {
        let handle = self.handle.clone();
        if request.command != Command::Stop {
            return handle.give(request).await;
        }
        let through = tokio::spawn(async move { handle.give(request).await });
        through.await.unwrap_or(Err(Gone))
    }

    async fn seen(&self, accepted: Accepted) -> Arc<Snapshot> {
        let mut watch = self.handle.watch();
        let contains = |snapshot: &Arc<Snapshot>| snapshot.revision >= accepted.revision;
        // A loop that ended or dawdles is no reason to call an accepted command refused: the newest state is shown then.
        let _ = tokio::time::timeout(SEEN_TIME, async { watch.wait_for(contains).await.map(|_| ()) }).await;
        self.handle.snapshot()
    }

    fn refusal(&self, refused: &Refused, about: Option<LuggageRef>) -> Problem {
        let snapshot = self.handle.snapshot();
        let record: Option<&Arc<Luggage>> = match about {
            Some(LuggageRef::Id(id)) => snapshot.luggage(id),
            Some(LuggageRef::Pending) => snapshot.pending(),
            None => None,
        };
        Problem::refused(refused, record.map(|luggage| LuggageJson::from(&**luggage)))
    }
}

type Given = Result<Result<Accepted, Refused>, Gone>;
