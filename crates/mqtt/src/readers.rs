//! Who reads what: the filters of all who subscribe, in order, so that those that match a topic are found level by level and nothing
//! else is looked at. What waits for each stands in `subscriber`.

use std::collections::BTreeMap;
use std::ops::Bound;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::packet::Qos;
use super::passage::Router;
use super::subscriber::Subscriber;

/// Who reads something, and how surely it is to reach him at the most.
#[derive(Clone, Debug)]
pub(crate) struct Reader {
    pub(crate) subscriber: Arc<Subscriber>,
    pub(crate) qos: Qos,
}

#[derive(Debug, Default)]
pub(crate) struct Readers {
    /// Raised by every change, so that who looked before looks again.
    generation: AtomicU64,
    held: Mutex<Held>,
    /// Who brings messages to them; `None`: the broker itself.
    router: Option<Box<dyn Router>>,
}

type Held = BTreeMap<Arc<str>, Vec<Reader>>;

impl Readers {
    pub(crate) fn new(router: Option<Box<dyn Router>>) -> Readers {
        Readers { router, ..Readers::default() }
    }

    pub(crate) fn router(&self) -> Option<&dyn Router> {
        self.router.as_deref()
    }

    /// What changes whenever the readers of any topic may have.
    pub(crate) fn generation(&self) -> u64 {
        self.generation.load(Ordering::Acquire)
    }

    /// Those who get what is published on this topic: each once, at the best of his filters that match (section 3.3.5).
    pub(crate) fn of(&self, topic: &str) -> Vec<Reader> {
        let levels: Vec<&str> = topic.split('/').collect();
        let mut found = Vec::new();
        collect(&self.held(), &mut String::with_capacity(topic.len() + 2), &levels, &mut found);
        found.sort_unstable_by_key(|reader| (Arc::as_ptr(&reader.subscriber), std::cmp::Reverse(reader.qos)));
        found.dedup_by(|one, other| Arc::ptr_eq(&one.subscriber, &other.subscriber));
        found
    }

    pub(crate) fn enter(&self, filter: &Arc<str>, subscriber: &Arc<Subscriber>, qos: Qos) {
        let mut held = self.held();
        let readers = held.entry(Arc::clone(filter)).or_default();
        match readers.iter_mut().find(|reader| Arc::ptr_eq(&reader.subscriber, subscriber)) {
            Some(reader) if reader.qos == qos => return,
            Some(reader) => reader.qos = qos,
            None => {
                readers.push(Reader { subscriber: Arc::clone(subscriber), qos });
                if let Some(router) = &self.router {
                    router.subscribe(filter, subscriber);
                }
            }
        }
        self.generation.fetch_add(1, Ordering::Release);
    }

    pub(crate) fn strike(&self, filter: &str, subscriber: &Arc<Subscriber>) {
        let mut held = self.held();
        let Some(readers) = held.get_mut(filter) else { return };
        readers.retain(|reader| !Arc::ptr_eq(&reader.subscriber, subscriber));
        if readers.is_empty() {
            held.remove(filter);
        }
        if let Some(router) = &self.router {
            router.unsubscribe(filter, subscriber);
        }
        self.generation.fetch_add(1, Ordering::Release);
    }

    fn held(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Those whose filters begin with these levels, which end with a slash, and match the others of a topic.
fn collect(held: &Held, above: &mut String, levels: &[&str], found: &mut Vec<Reader>) {
    let Some((level, below)) = levels.split_first() else { return };
    let length = above.len();
    let is_hidden = length == 0 && level.starts_with('$');
    if !is_hidden {
        add(held, above, "#", found);
    }
    let words = [Some(*level), Some("+").filter(|_| !is_hidden)];
    for word in words.into_iter().flatten() {
        above.push_str(word);
        if below.is_empty() {
            add(held, above, "", found);
            add(held, above, "/#", found);
        } else {
            above.push('/');
            let mut from = held.range::<str, _>((Bound::Included(above.as_str()), Bound::Unbounded));
            if from.next().is_some_and(|(filter, _)| filter.starts_with(above.as_str())) {
                collect(held, above, below, found);
            }
        }
        above.truncate(length);
    }
}

fn add(held: &Held, above: &mut String, end: &str, found: &mut Vec<Reader>) {
    let length = above.len();
    above.push_str(end);
    found.extend(held.get(above.as_str()).into_iter().flatten().cloned());
    above.truncate(length);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::filter::matches;
    use crate::filter::tests::{level, some_filter};

    proptest! {
        /// Going level by level finds exactly what comparing with each finds.
        #[test]
        fn those_are_found_whose_filters_match(
            filters in prop::collection::btree_set(some_filter(), 0..40),
            levels in prop::collection::vec(level(), 1..5),
        ) {
            let (readers, topic) = (Readers::default(), levels.join("/"));
            let all: Vec<(String, Arc<Subscriber>)> = filters.into_iter().map(|filter| (filter, Arc::default())).collect();
            for (filter, subscriber) in &all {
                readers.enter(&Arc::from(filter.as_str()), subscriber, Qos::One);
            }
            let found = readers.of(&topic);
            for (filter, subscriber) in &all {
                let count = found.iter().filter(|reader| Arc::ptr_eq(&reader.subscriber, subscriber)).count();
                prop_assert_eq!(count, usize::from(matches(filter, &topic)), "{} {}", filter, topic);
            }
        }
    }

    #[test]
    fn whoever_holds_several_filters_that_match_is_a_reader_once_at_the_best_of_them() {
        let (readers, one, other) = (Readers::default(), Arc::default(), Arc::default());
        for (filter, subscriber, qos) in
            [("a/#", &one, Qos::Zero), ("a/+", &one, Qos::Zero), ("a/+", &one, Qos::One), ("b", &other, Qos::One)]
        {
            readers.enter(&Arc::from(filter), subscriber, qos);
        }
        let best = |topic: &str| readers.of(topic).iter().map(|reader| reader.qos).collect::<Vec<_>>();
        assert_eq!(best("a/x"), [Qos::One]);
        let before = readers.generation();
        readers.strike("a/+", &one);
        assert!(readers.generation() > before && best("a/x") == [Qos::Zero]);
        readers.strike("a/#", &one);
        assert_eq!((readers.of("a/x").len(), readers.of("b").len()), (0, 1));
        readers.strike("b", &other);
        assert!(readers.held().is_empty());
    }
}
