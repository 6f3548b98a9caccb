//! How many filters and topics ever reached the engine that runs now. It forgets none of them until it ends, so that there must be an
//! end to them, and an end to it. Each key has a share of them, viewers together a part, and the program itself what it needs. Only
//! prints are remembered here, and whoever starts and ends engines stands elsewhere.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasher, RandomState};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::limits::{ENGINE_FILTERS, ENGINE_TOPICS, SHARE_FILTERS, SHARE_TOPICS, VIEWERS_FILTERS, VIEWERS_SHARE, VIEWERS_TOPICS};
use super::rights::Tier;

/// At whose cost something is kept, or shown to the engine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Payer {
    /// The program itself.
    House,
    /// Somebody where nobody signs in: no share can be told from another.
    Anybody,
    /// Whoever has this key.
    Key {
        /// Its name.
        name: Arc<str>,
        /// How large a share it has.
        tier: Tier,
    },
}

/// What may still reach the engine.
#[derive(Debug, Default)]
pub struct Budget {
    /// Nobody outside can know two texts of one print.
    hasher: RandomState,
    filters: Mutex<Spent>,
    topics: Mutex<Spent>,
}

/// What the engine has seen, and at whose cost: whoever named it first.
#[derive(Debug, Default)]
struct Spent {
    known: HashSet<u64>,
    /// By those who are not the program itself,
    guests: usize,
    /// by viewers among them,
    viewers: usize,
    /// and by each key.
    keys: HashMap<Arc<str>, usize>,
    is_exhausted: bool,
}

/// The most there may be: of all guests, of all viewers, of an operator's key and of a viewer's.
struct Most {
    guests: usize,
    viewers: usize,
    operators_key: usize,
    viewers_key: usize,
}

const FILTERS: Most = Most {
    guests: ENGINE_FILTERS,
    viewers: VIEWERS_FILTERS,
    operators_key: SHARE_FILTERS,
    viewers_key: SHARE_FILTERS / VIEWERS_SHARE,
};

const TOPICS: Most = Most {
    guests: ENGINE_TOPICS,
    viewers: VIEWERS_TOPICS,
    operators_key: SHARE_TOPICS,
    viewers_key: SHARE_TOPICS / VIEWERS_SHARE,
};

impl Budget {
    /// The print by which something is known again.
    #[must_use]
    pub fn print(&self, of: impl std::hash::Hash) -> u64 {
        self.hasher.hash_one(of)
    }

    /// Whether a filter may reach the engine; if so, it counts.
    #[must_use]
    pub fn admits_filter(&self, payer: &Payer, filter: &str) -> bool {
        spent(&self.filters).admits(payer, self.print(filter), &FILTERS)
    }

    /// Whether a message on this topic may reach the engine; if so, it counts.
    #[must_use]
    pub fn admits_topic(&self, payer: &Payer, topic: &[u8]) -> bool {
        spent(&self.topics).admits(payer, self.print(topic), &TOPICS)
    }

    /// Whether all there is was used up: a new engine is needed. One key alone never does that.
    #[must_use]
    pub fn is_exhausted(&self) -> bool {
        spent(&self.filters).is_exhausted || spent(&self.topics).is_exhausted
    }

    /// There is a new engine, which knows nothing yet.
    pub fn renew(&self) {
        *spent(&self.filters) = Spent::default();
        *spent(&self.topics) = Spent::default();
    }
}

impl Spent {
    fn admits(&mut self, payer: &Payer, print: u64, most: &Most) -> bool {
        if self.known.contains(&print) {
            return true;
        }
        let admits = match payer {
            Payer::House => true,
            Payer::Anybody => self.has_room(most),
            Payer::Key { name, tier } => {
                let own = self.keys.get(name).copied().unwrap_or_default();
                match tier {
                    Tier::Full => own < most.operators_key && self.has_room(most),
                    // Whatever they ask for, nobody needs another engine for it.
                    Tier::Limited => own < most.viewers_key && self.viewers < most.viewers && self.guests < most.guests,
                }
            }
        };
        if admits {
            self.known.insert(print);
            self.count(payer);
        }
        admits
    }

    const fn has_room(&mut self, most: &Most) -> bool {
        let has_room = self.guests < most.guests;
        self.is_exhausted |= !has_room;
        has_room
    }

    fn count(&mut self, payer: &Payer) {
        self.guests += usize::from(*payer != Payer::House);
        if let Payer::Key { name, tier } = payer {
            self.viewers += usize::from(*tier == Tier::Limited);
            *self.keys.entry(Arc::clone(name)).or_default() += 1;
        }
    }
}

fn spent(spent: &Mutex<Spent>) -> MutexGuard<'_, Spent> {
    spent.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str, tier: Tier) -> Payer {
        Payer::Key { name: Arc::from(name), tier }
    }

    fn filters(budget: &Budget, payer: &Payer, first: &str) -> usize {
        (0..2 * ENGINE_FILTERS).filter(|n| budget.admits_filter(payer, &format!("{first}/{n}"))).count()
    }

    fn topics(budget: &Budget, payer: &Payer, first: &str, count: usize) -> usize {
        (0..count).filter(|n| budget.admits_topic(payer, format!("{first}/{n}").as_bytes())).count()
    }

    #[test]
    fn what_is_known_passes_and_what_is_new_does_until_there_is_too_much() {
        let budget = Budget::default();
        for n in 0..ENGINE_FILTERS {
            assert!(budget.admits_filter(&Payer::Anybody, &format!("a/{n}")) && budget.admits_filter(&Payer::Anybody, "a/0"));
        }
        assert!(!budget.is_exhausted());
        assert!(!budget.admits_filter(&Payer::Anybody, "b") && budget.admits_filter(&Payer::Anybody, "a/7"));
        assert!(budget.is_exhausted() && budget.admits_filter(&Payer::House, "b"), "the program itself is never refused");
        budget.renew();
        assert!(budget.admits_filter(&Payer::Anybody, "c") && !budget.is_exhausted());
    }

    /// Safety A5 and S9.
    #[test]
    fn viewers_have_a_part_and_wear_no_engine_out() {
        let budget = Budget::default();
        let viewer = |n: usize| key(&format!("viewer{n}"), Tier::Limited);
        assert_eq!(filters(&budget, &viewer(0), "0"), SHARE_FILTERS / VIEWERS_SHARE, "one of them has a share of that");
        let all: usize = (0..20).map(|n| filters(&budget, &viewer(n), &n.to_string())).sum();
        assert_eq!(all, VIEWERS_FILTERS);
        let named: usize = (0..20).map(|n| topics(&budget, &viewer(n), &n.to_string(), 4_000)).sum();
        assert_eq!(named, VIEWERS_TOPICS);
        let operator = key("operator", Tier::Full);
        assert!(!budget.is_exhausted() && budget.admits_filter(&operator, "b") && budget.admits_topic(&operator, b"b"));
        assert!(budget.admits_filter(&viewer(0), "b"), "what the engine knows costs nothing");
    }

    /// Safety A5 and S9.
    #[test]
    fn one_key_uses_its_own_share_up_and_nothing_else() {
        let budget = Budget::default();
        let (greedy, modest) = (key("greedy", Tier::Full), key("modest", Tier::Full));
        assert_eq!((filters(&budget, &greedy, "a"), topics(&budget, &greedy, "a", 75_000)), (SHARE_FILTERS, SHARE_TOPICS));
        assert!(!budget.is_exhausted());
        assert_eq!((filters(&budget, &modest, "b"), topics(&budget, &modest, "b", 75_000)), (SHARE_FILTERS, SHARE_TOPICS));
    }

    #[test]
    fn topics_are_counted_apart() {
        let budget = Budget::default();
        assert_eq!(topics(&budget, &Payer::Anybody, "a", 2 * ENGINE_TOPICS), ENGINE_TOPICS);
        assert!(budget.is_exhausted() && budget.admits_filter(&Payer::Anybody, "a"));
    }
}
