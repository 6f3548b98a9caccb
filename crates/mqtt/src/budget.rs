//! How many filters and topics ever reached the router that runs now. It forgets none of them until it ends, so that there must be an
//! end to them, and an end to it. Each key has a share of them, clients of the limited tier together a part, and the program itself what
//! it needs. Only prints are remembered here, and whoever starts and ends routers stands elsewhere.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasher, RandomState};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::limits::{LIMITED_FILTERS, LIMITED_SHARE, LIMITED_TOPICS, ROUTER_FILTERS, ROUTER_TOPICS, SHARE_FILTERS, SHARE_TOPICS};
use super::rights::Tier;

/// At whose cost something is kept, or shown to the router.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Payer {
    Program,
    /// Somebody where nobody signs in: no share can be told from another.
    Anybody,
    Key {
        name: Arc<str>,
        tier: Tier,
    },
}

#[derive(Debug, Default)]
pub(crate) struct Budget {
    /// Nobody outside can know two texts of one print.
    hasher: RandomState,
    filters: Mutex<Spent>,
    topics: Mutex<Spent>,
}

/// What the router has seen, and at whose cost: whoever named it first.
#[derive(Debug, Default)]
struct Spent {
    known: HashSet<u64>,
    /// By those who are not the program itself,
    clients: usize,
    /// by those of the limited tier among them,
    limited: usize,
    /// and by each key.
    keys: HashMap<Arc<str>, usize>,
    is_exhausted: bool,
}

/// The most there may be: of all clients, of all of the limited tier, of a key of the full tier and of one of the limited.
struct Most {
    clients: usize,
    limited: usize,
    full_key: usize,
    limited_key: usize,
}

const FILTERS: Most = Most {
    clients: ROUTER_FILTERS,
    limited: LIMITED_FILTERS,
    full_key: SHARE_FILTERS,
    limited_key: SHARE_FILTERS / LIMITED_SHARE,
};

const TOPICS: Most =
    Most { clients: ROUTER_TOPICS, limited: LIMITED_TOPICS, full_key: SHARE_TOPICS, limited_key: SHARE_TOPICS / LIMITED_SHARE };

impl Budget {
    pub(crate) fn print(&self, of: impl std::hash::Hash) -> u64 {
        self.hasher.hash_one(of)
    }

    /// Whether a filter may reach the router; if so, it counts.
    pub(crate) fn admits_filter(&self, payer: &Payer, filter: &str) -> bool {
        spent(&self.filters).admits(payer, self.print(filter), &FILTERS)
    }

    /// Whether a message on this topic may reach the router; if so, it counts.
    pub(crate) fn admits_topic(&self, payer: &Payer, topic: &[u8]) -> bool {
        spent(&self.topics).admits(payer, self.print(topic), &TOPICS)
    }

    /// Whether all there is was used up: a new router is needed. One key alone never does that.
    pub(crate) fn is_exhausted(&self) -> bool {
        spent(&self.filters).is_exhausted || spent(&self.topics).is_exhausted
    }

    /// How many filters reached the router.
    pub(crate) fn filters(&self) -> usize {
        spent(&self.filters).known.len()
    }

    pub(crate) fn renew(&self) {
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
            Payer::Program => true,
            Payer::Anybody => self.has_room(most),
            Payer::Key { name, tier } => {
                let own = self.keys.get(name).copied().unwrap_or_default();
                match tier {
                    Tier::Full => own < most.full_key && self.has_room(most),
                    // Whatever they ask for, nobody needs another router for it.
                    Tier::Limited => own < most.limited_key && self.limited < most.limited && self.clients < most.clients,
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
        let has_room = self.clients < most.clients;
        self.is_exhausted |= !has_room;
        has_room
    }

    fn count(&mut self, payer: &Payer) {
        self.clients += usize::from(*payer != Payer::Program);
        if let Payer::Key { name, tier } = payer {
            self.limited += usize::from(*tier == Tier::Limited);
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
        (0..2 * ROUTER_FILTERS).filter(|n| budget.admits_filter(payer, &format!("{first}/{n}"))).count()
    }

    fn topics(budget: &Budget, payer: &Payer, first: &str, count: usize) -> usize {
        (0..count).filter(|n| budget.admits_topic(payer, format!("{first}/{n}").as_bytes())).count()
    }

    #[test]
    fn what_is_known_passes_and_what_is_new_does_until_there_is_too_much() {
        let budget = Budget::default();
        for n in 0..ROUTER_FILTERS {
            assert!(budget.admits_filter(&Payer::Anybody, &format!("a/{n}")) && budget.admits_filter(&Payer::Anybody, "a/0"));
        }
        assert!(!budget.is_exhausted() && budget.filters() == ROUTER_FILTERS, "each counts once");
        assert!(!budget.admits_filter(&Payer::Anybody, "b") && budget.admits_filter(&Payer::Anybody, "a/7"));
        assert!(budget.is_exhausted() && budget.admits_filter(&Payer::Program, "b"), "the program itself is never refused");
        budget.renew();
        assert!(budget.admits_filter(&Payer::Anybody, "c") && !budget.is_exhausted());
    }

    #[test]
    fn limited_clients_have_a_part_and_wear_no_router_out() {
        let budget = Budget::default();
        let limited = |n: usize| key(&format!("limited{n}"), Tier::Limited);
        assert_eq!(filters(&budget, &limited(0), "0"), SHARE_FILTERS / LIMITED_SHARE, "one of them has a share of that");
        let all: usize = (0..20).map(|n| filters(&budget, &limited(n), &n.to_string())).sum();
        assert_eq!(all, LIMITED_FILTERS);
        let named: usize = (0..20).map(|n| topics(&budget, &limited(n), &n.to_string(), 4_000)).sum();
        assert_eq!(named, LIMITED_TOPICS);
        let full = key("full", Tier::Full);
        assert!(!budget.is_exhausted() && budget.admits_filter(&full, "b") && budget.admits_topic(&full, b"b"));
        assert!(budget.admits_filter(&limited(0), "b"), "what the router knows costs nothing");
    }

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
        assert_eq!(topics(&budget, &Payer::Anybody, "a", 2 * ROUTER_TOPICS), ROUTER_TOPICS);
        assert!(budget.is_exhausted() && budget.admits_filter(&Payer::Anybody, "a"));
    }
}
