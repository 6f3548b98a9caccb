//! A subject: a path and a query in a format, and the versions of the things that it shows. Several observers share a
//! subject. `knowledge` stores what was sent to each observer.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::format::Format;
use super::knowledge::Thing;
use super::request::Request;
use super::response::Response;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct ObserverId(pub(super) u64);

/// The parts of a request that two observers of one subject have in common.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Target {
    path: Vec<String>,
    queries: Vec<String>,
    accept: Option<Format>,
}

#[derive(Debug)]
pub(super) struct Subject {
    /// The request of the first observer.
    pub(super) request: Arc<Request>,
    pub(super) things: Vec<Thing>,
    /// Counts the changes of all things of the subject. The versions of `Thing` come from this counter.
    changes: u64,
    pub(super) observers: BTreeSet<ObserverId>,
}

impl Target {
    pub(super) fn of(request: &Request) -> Target {
        Target { path: request.path.clone(), queries: request.queries.clone(), accept: request.accept }
    }
}

impl Subject {
    /// Creates a subject without things; `take` adds them.
    pub(super) fn new(request: &Request) -> Subject {
        Subject { request: Arc::new(request.clone()), things: Vec::new(), changes: 0, observers: BTreeSet::new() }
    }

    /// Takes the present state. Returns whether any thing has changed, so that observers have to be notified.
    pub(super) fn take(&mut self, things: Vec<Arc<Response>>) -> bool {
        let before = self.changes;
        self.things.truncate(things.len());
        for (place, response) in things.into_iter().enumerate() {
            let is_news = self.things.get(place).is_none_or(|thing| thing.differs_from(&response));
            self.changes += u64::from(is_news);
            let changes = self.changes;
            match self.things.get_mut(place) {
                Some(thing) => *thing = Thing { response, version: if is_news { changes } else { thing.version } },
                None => self.things.push(Thing { response, version: changes }),
            }
        }
        self.changes > before
    }
}
