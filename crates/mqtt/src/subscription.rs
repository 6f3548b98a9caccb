//! The filters of one subscriber, with the terms granted for each. `readers` finds the filters that match a topic.
//! `subscriber` has the messages that wait for the subscriber.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::filter::{self, Shared};
use super::grant::Grant;
use super::limits::{FILTER_BYTES, FILTERS};
use super::readers::Readers;
use super::rights::Scope;
use super::subscriber::Subscriber;

/// A subscriber and its filters. Dropping the value removes the filters.
#[derive(Debug)]
pub(crate) struct Subscription {
    subscriber: Arc<Subscriber>,
    readers: Arc<Readers>,
    held: BTreeMap<Arc<str>, Grant>,
    /// Total size of the filters in bytes.
    bytes: usize,
}

impl Subscription {
    pub(crate) fn new(readers: &Arc<Readers>) -> Subscription {
        Subscription { subscriber: Arc::default(), readers: Arc::clone(readers), held: BTreeMap::new(), bytes: 0 }
    }

    pub(crate) fn subscriber(&self) -> &Arc<Subscriber> {
        &self.subscriber
    }

    pub(crate) fn held(&self) -> &BTreeMap<Arc<str>, Grant> {
        &self.held
    }

    /// Sets the topics that exist for the subscriber from now on. Messages that wait already are judged when they go
    /// out.
    pub(crate) fn set_scope(&self, scope: Scope) {
        self.subscriber.set_scope(scope);
        if !self.held.is_empty() {
            self.readers.note_change();
        }
    }

    /// Whether the subscriber may hold this filter: it already holds the filter, or there is room within
    /// `FILTERS` and `FILTER_BYTES`.
    pub(crate) fn has_room(&self, filter: &str) -> bool {
        let (count, bytes) = (self.held.len() + 1, self.bytes + filter.len());
        self.held.contains_key(filter) || (count <= FILTERS && bytes <= FILTER_BYTES)
    }

    /// Adds a filter. From now on this subscriber gets the matching messages. If the filter is shared, each message
    /// goes to one member of the group.
    pub(crate) fn hold(&mut self, filter: &str, grant: Grant) -> Arc<str> {
        let name: Arc<str> = Arc::from(filter);
        if self.held.insert(Arc::clone(&name), grant).is_none() {
            self.bytes += name.len();
        }
        match filter::shared(&name) {
            None => self.readers.enter(&name, None, &self.subscriber, grant),
            Some(Shared { group, filter }) => self.readers.enter(&Arc::from(filter), Some(group), &self.subscriber, grant),
        }
        name
    }

    pub(crate) fn strike(&mut self, filter: &str) -> bool {
        if self.held.remove(filter).is_none() {
            return false;
        }
        self.bytes -= filter.len();
        self.strike_out(filter);
        true
    }

    fn strike_out(&self, filter: &str) {
        match filter::shared(filter) {
            None => self.readers.strike(filter, None, &self.subscriber),
            Some(Shared { group, filter }) => self.readers.strike(filter, Some(group), &self.subscriber),
        }
    }
}

impl Drop for Subscription {
    fn drop(&mut self) {
        for filter in self.held.keys() {
            self.strike_out(filter);
        }
        self.subscriber.go();
    }
}
