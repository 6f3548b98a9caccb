//! Who reads what: the filters of all who subscribe, in order, so that those that match a topic are found level by level and nothing
//! else is looked at. How far each reader is behind stands in `subscriber_lag`.

use std::collections::BTreeMap;
use std::ops::Bound;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::subscriber_lag::SubscriberLag;

#[derive(Clone, Debug)]
pub(crate) struct Reader {
    pub(crate) lag: Arc<SubscriberLag>,
    /// Whether it is counted what he is owed: he is here, and the router knows of his filter.
    pub(crate) is_owed: bool,
}

#[derive(Debug, Default)]
pub(crate) struct Readers {
    /// Raised by every change, so that who looked before looks again.
    generation: AtomicU64,
    held: Mutex<Held>,
}

type Held = BTreeMap<Arc<str>, Vec<Reader>>;

impl Readers {
    /// What changes whenever the readers of any topic may have.
    pub(crate) fn generation(&self) -> u64 {
        self.generation.load(Ordering::Acquire)
    }

    /// Those who get what is published on this topic: one for each filter of theirs that matches.
    pub(crate) fn of(&self, topic: &str) -> Vec<Reader> {
        let levels: Vec<&str> = topic.split('/').collect();
        let mut found = Vec::new();
        collect(&self.held(), &mut String::with_capacity(topic.len() + 2), &levels, &mut found);
        found
    }

    pub(crate) fn enter(&self, filter: &Arc<str>, lag: &Arc<SubscriberLag>, is_owed: bool) {
        let mut held = self.held();
        let readers = held.entry(Arc::clone(filter)).or_default();
        match readers.iter_mut().find(|reader| Arc::ptr_eq(&reader.lag, lag)) {
            Some(reader) if reader.is_owed == is_owed => return,
            Some(reader) => reader.is_owed = is_owed,
            None => readers.push(Reader { lag: Arc::clone(lag), is_owed }),
        }
        self.generation.fetch_add(1, Ordering::Release);
    }

    pub(crate) fn strike(&self, filter: &str, lag: &Arc<SubscriberLag>) {
        let mut held = self.held();
        let Some(readers) = held.get_mut(filter) else { return };
        readers.retain(|reader| !Arc::ptr_eq(&reader.lag, lag));
        if readers.is_empty() {
            held.remove(filter);
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
            let all: Vec<(String, Arc<SubscriberLag>)> = filters.into_iter().map(|filter| (filter, Arc::default())).collect();
            for (filter, lag) in &all {
                readers.enter(&Arc::from(filter.as_str()), lag, true);
            }
            let found = readers.of(&topic);
            for (filter, lag) in &all {
                let count = found.iter().filter(|reader| Arc::ptr_eq(&reader.lag, lag)).count();
                prop_assert_eq!(count, usize::from(matches(filter, &topic)), "{} {}", filter, topic);
            }
        }
    }

    #[test]
    fn whoever_holds_several_filters_that_match_is_a_reader_for_each() {
        let (readers, one, other) = (Readers::default(), Arc::default(), Arc::default());
        for (filter, lag) in [("a/#", &one), ("a/+", &one), ("a/+", &one), ("b", &other)] {
            readers.enter(&Arc::from(filter), lag, true);
        }
        assert_eq!(readers.of("a/x").len(), 2);
        let before = readers.generation();
        readers.strike("a/+", &one);
        assert!(readers.generation() > before && readers.of("a/x").len() == 1);
        readers.enter(&Arc::from("a/#"), &one, false);
        assert!(!readers.of("a/x")[0].is_owed && readers.generation() > before + 1);
        readers.strike("a/#", &one);
        assert_eq!((readers.of("a/x").len(), readers.of("b").len()), (0, 1));
        readers.strike("b", &other);
        assert!(readers.held().is_empty());
    }
}
