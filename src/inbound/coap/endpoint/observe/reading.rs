//! How an observer reads to its end what it was told of in a first block only: as it was then, whatever becomes of it meanwhile.
//! When it is told the next thing is decided in `observe`.

use std::sync::Arc;
use std::time::Duration;

use super::super::block::Block;
use super::super::request::Request;
use super::super::response::Response;
use super::{Observer, ObserverId, Observers, Target};

impl Observers {
    /// What an observer was told of in a first block, for the further block that it asks for: as it was then, whatever has become
    /// of it. `None` when this peer observes nothing of the kind.
    pub(in super::super) fn read_on(&mut self, request: &Request, block: Block, now: Duration) -> Option<Arc<Response>> {
        let id = self.observer_of(request)?;
        let observer = self.observers.get_mut(&id)?;
        let begun = Arc::clone(observer.begun.as_ref()?);
        if block.within(begun.body.len()).is_none_or(|(block, _)| !block.more) {
            observer.is_reading = false;
            self.schedule(id, now);
        }
        Some(begun)
    }

    /// A peer begins to read from the first block, apart from what it observes.
    pub(in super::super) fn read_anew(&mut self, request: &Request) {
        let observer = self.observer_of(request).and_then(|id| self.observers.get_mut(&id));
        if let Some(observer) = observer {
            observer.begun = None;
        }
    }

    /// The peer's observation of just this.
    fn observer_of(&self, request: &Request) -> Option<ObserverId> {
        let is_this = |id: &ObserverId| {
            let subject = self.observers.get(id).and_then(|observer| self.subjects.get(&observer.subject));
            subject.is_some_and(|subject| Target::of(&subject.request) == Target::of(request))
        };
        self.of_peer(request.peer).find(is_this)
    }
}

impl Observer {
    /// It is sent the first block of this, or all of it.
    pub(super) fn begin(&mut self, response: &Arc<Response>) {
        self.is_reading = Block { exponent: self.exponent, ..Block::FIRST }.size() < response.body.len();
        if self.is_reading {
            self.begun = Some(Arc::clone(response));
        }
    }
}
