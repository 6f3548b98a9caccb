//! How many filters and topics ever reached the engine that runs now. It forgets none of them until it ends, so that there must be an
//! end to them, and an end to it. Only prints are remembered here, and whoever starts and ends engines stands elsewhere.

use std::collections::HashSet;
use std::hash::{BuildHasher, RandomState};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::limits::{ENGINE_FILTERS, ENGINE_TOPICS, VIEWERS_FILTERS};

/// What may still reach the engine.
#[derive(Debug, Default)]
pub struct Budget {
    /// Nobody outside can know two texts of one print.
    hasher: RandomState,
    spent: Mutex<Spent>,
}

#[derive(Debug, Default)]
struct Spent {
    filters: HashSet<u64>,
    topics: HashSet<u64>,
    is_exhausted: bool,
}

impl Budget {
    /// The print by which something is known again.
    #[must_use]
    pub fn print(&self, of: impl std::hash::Hash) -> u64 {
        self.hasher.hash_one(of)
    }

    /// Whether a filter may reach the engine; if so, it counts.
    #[must_use]
    pub fn admits_filter(&self, filter: &str) -> bool {
        let print = self.print(filter);
        let mut spent = self.spent();
        let admits = admit(&mut spent.filters, print, ENGINE_FILTERS);
        spent.is_exhausted |= !admits;
        admits
    }

    /// The same for somebody who only looks: he may spend a part, and whatever he asks for, nobody needs another engine for it.
    #[must_use]
    pub fn admits_viewers_filter(&self, filter: &str) -> bool {
        let print = self.print(filter);
        admit(&mut self.spent().filters, print, VIEWERS_FILTERS)
    }

    /// Whether a message on the topic of this print may reach the engine; if so, it counts.
    #[must_use]
    pub fn admits_topic(&self, print: u64) -> bool {
        let mut spent = self.spent();
        let admits = admit(&mut spent.topics, print, ENGINE_TOPICS);
        spent.is_exhausted |= !admits;
        admits
    }

    /// Whether something had to be turned away: a new engine is needed.
    #[must_use]
    pub fn is_exhausted(&self) -> bool {
        self.spent().is_exhausted
    }

    /// There is a new engine, which knows nothing yet.
    pub fn renew(&self) {
        *self.spent() = Spent::default();
    }

    fn spent(&self) -> MutexGuard<'_, Spent> {
        self.spent.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn admit(known: &mut HashSet<u64>, print: u64, most: usize) -> bool {
    known.contains(&print) || (known.len() < most && known.insert(print))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_passes_and_what_is_new_does_until_there_is_too_much() {
        let budget = Budget::default();
        for n in 0..ENGINE_FILTERS {
            assert!(budget.admits_filter(&format!("a/{n}")) && budget.admits_filter("a/0"));
        }
        assert!(!budget.is_exhausted());
        assert!(!budget.admits_filter("b") && budget.admits_filter("a/7"));
        assert!(budget.is_exhausted());
        budget.renew();
        assert!(budget.admits_filter("b") && !budget.is_exhausted());
    }

    /// Safety A5.
    #[test]
    fn whoever_only_looks_wears_no_engine_out() {
        let budget = Budget::default();
        let admitted = (0..2 * ENGINE_FILTERS).filter(|n| budget.admits_viewers_filter(&format!("a/{n}"))).count();
        assert_eq!(admitted, VIEWERS_FILTERS);
        assert!(!budget.is_exhausted() && budget.admits_filter("b") && budget.admits_viewers_filter("b"));
    }

    #[test]
    fn topics_are_counted_apart() {
        let budget = Budget::default();
        let admitted = (0..2 * ENGINE_TOPICS).filter(|n| budget.admits_topic(budget.print(n))).count();
        assert_eq!(admitted, ENGINE_TOPICS);
        assert!(budget.is_exhausted() && budget.admits_filter("a"));
    }
}
