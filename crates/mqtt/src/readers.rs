//! The filters of all subscribers, sorted. The filters that match a topic are found level by level, without looking
//! at other filters. `subscriber` has the messages that wait for each subscriber.

use std::collections::BTreeMap;
use std::ops::Bound;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::grant::Grant;
use super::message::SubscriberId;
use super::routed_delivery::Router;
use super::subscriber::{Subscriber, TopicReader};

#[derive(Clone, Debug, Default)]
pub(crate) struct TopicReaders {
    /// Readers that all get the message.
    pub(crate) each: Vec<TopicReader>,
    /// Groups with a shared subscription; one reader of each group gets the message.
    pub(crate) groups: Vec<Vec<TopicReader>>,
}

#[derive(Debug, Default)]
pub(crate) struct Readers {
    /// Increased by every change, so that cached results are looked up again.
    generation: AtomicU64,
    held: Mutex<Held>,
    /// Increased with each message for groups, so that their members take turns.
    turns: AtomicUsize,
    /// Delivers messages to the readers; `None` if the broker delivers them itself.
    router: Option<Box<dyn Router>>,
}

#[derive(Clone, Debug)]
struct Holder {
    subscriber: Arc<Subscriber>,
    group: Option<Box<str>>,
    grant: Grant,
}

type Held = BTreeMap<Arc<str>, Vec<Holder>>;

impl TopicReaders {
    pub(crate) fn is_empty(&self) -> bool {
        self.each.is_empty() && self.groups.is_empty()
    }

    pub(crate) fn all(&self) -> impl Iterator<Item = &TopicReader> {
        self.each.iter().chain(self.groups.iter().flatten())
    }
}

impl Holder {
    fn is(&self, subscriber: &Arc<Subscriber>, group: Option<&str>) -> bool {
        Arc::ptr_eq(&self.subscriber, subscriber) && self.group.as_deref() == group
    }

    fn reader(&self) -> TopicReader {
        let options = self.grant.options;
        let (subscriber, ids) = (Arc::clone(&self.subscriber), self.grant.ids());
        TopicReader { subscriber, qos: options.qos, as_published: options.as_published, ids }
    }
}

impl Readers {
    pub(crate) fn new(router: Option<Box<dyn Router>>) -> Readers {
        Readers { router, ..Readers::default() }
    }

    pub(crate) fn router(&self) -> Option<&dyn Router> {
        self.router.as_deref()
    }

    /// A number that changes whenever the readers of any topic, or the rights, may have changed.
    pub(crate) fn generation(&self) -> u64 {
        self.generation.load(Ordering::Acquire)
    }

    /// Makes all cached readers and rights outdated.
    pub(crate) fn note_change(&self) {
        self.generation.fetch_add(1, Ordering::Release);
    }

    /// The readers of a topic. Each reader occurs once, on the best terms of its matching filters (section 3.3.5). A
    /// filter with No Local does not match messages that its own subscriber published. A subscriber for which the
    /// topic does not exist is no reader, and no member of a group. So nobody waits for it, or loses a turn to it.
    pub(crate) fn of(&self, topic: &str, publisher: Option<SubscriberId>) -> TopicReaders {
        let levels: Vec<&str> = topic.split('/').collect();
        let is_left_out = |holder: &Holder| {
            let is_own = holder.grant.options.no_local && publisher == Some(holder.subscriber.id());
            is_own || !holder.subscriber.may_read(topic)
        };
        let mut found = TopicReaders::default();
        collect(&self.held(), &mut String::with_capacity(topic.len() + 2), &levels, &mut |holders| {
            let mut groups: Vec<(&str, Vec<TopicReader>)> = Vec::new();
            for holder in holders.iter().filter(|holder| !is_left_out(holder)) {
                let Some(name) = holder.group.as_deref() else {
                    found.each.push(holder.reader());
                    continue;
                };
                match groups.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, group)) => group.push(holder.reader()),
                    None => groups.push((name, vec![holder.reader()])),
                }
            }
            found.groups.extend(groups.into_iter().map(|(_, group)| group));
        });
        merge(&mut found.each);
        found
    }

    /// Chooses one reader of each group, in turns. A connected reader that keeps up is preferred, then any connected
    /// reader, then any reader.
    pub(crate) fn in_turn<'a>(&self, groups: &'a [Vec<TopicReader>]) -> impl Iterator<Item = &'a TopicReader> {
        let turn = if groups.is_empty() { 0 } else { self.turns.fetch_add(1, Ordering::Relaxed) };
        groups.iter().filter_map(move |group| {
            let in_turn = || (0..group.len()).map(|place| &group[(turn + place) % group.len()]);
            let keeps_up = |reader: &&TopicReader| reader.subscriber.is_here() && !reader.subscriber.lags();
            in_turn().find(keeps_up).or_else(|| in_turn().find(|reader| reader.subscriber.is_here())).or_else(|| in_turn().next())
        })
    }

    pub(crate) fn enter(&self, filter: &Arc<str>, group: Option<&str>, subscriber: &Arc<Subscriber>, grant: Grant) {
        let mut held = self.held();
        let holders = held.entry(Arc::clone(filter)).or_default();
        match holders.iter_mut().find(|holder| holder.is(subscriber, group)) {
            Some(holder) if holder.grant == grant => return,
            Some(holder) => holder.grant = grant,
            None => {
                holders.push(Holder { subscriber: Arc::clone(subscriber), group: group.map(Box::from), grant });
                if let Some(router) = self.router.as_ref().filter(|_| group.is_none()) {
                    router.subscribe(filter, subscriber);
                }
            }
        }
        self.note_change();
    }

    pub(crate) fn strike(&self, filter: &str, group: Option<&str>, subscriber: &Arc<Subscriber>) {
        let mut held = self.held();
        let Some(holders) = held.get_mut(filter) else { return };
        holders.retain(|holder| !holder.is(subscriber, group));
        if holders.is_empty() {
            held.remove(filter);
        }
        if let Some(router) = self.router.as_ref().filter(|_| group.is_none()) {
            router.unsubscribe(filter, subscriber);
        }
        self.note_change();
    }

    fn held(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Merges the entries of a reader with several matching filters into one: the highest QoS, and all subscription ids
/// (MQTT 5, section 3.3.4).
fn merge(readers: &mut Vec<TopicReader>) {
    readers.sort_unstable_by_key(|reader| Arc::as_ptr(&reader.subscriber));
    readers.dedup_by(|other, one| {
        let is_same = Arc::ptr_eq(&one.subscriber, &other.subscriber);
        if is_same {
            one.qos = one.qos.max(other.qos);
            one.as_published |= other.as_published;
            let ids = one.ids.iter().chain(&other.ids).flat_map(|ids| ids.iter().copied());
            one.ids = Some(ids.collect::<Arc<[u32]>>()).filter(|ids| !ids.is_empty());
        }
        is_same
    });
}

/// Finds the holders of filters that match a topic. Such a filter begins with `above`, which ends with a slash. Its
/// other levels match `levels`, the rest of the topic.
fn collect(held: &Held, above: &mut String, levels: &[&str], found: &mut dyn FnMut(&[Holder])) {
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

fn add(held: &Held, above: &mut String, end: &str, found: &mut dyn FnMut(&[Holder])) {
    let length = above.len();
    above.push_str(end);
    if let Some(holders) = held.get(above.as_str()) {
        found(holders);
    }
    above.truncate(length);
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;
    use crate::filter::matches;
    use crate::filter::tests::{level, some_filter};
    use crate::limits::LAG_BYTES;
    use crate::message::{Draft, Message};
    use crate::packet::Qos;
    use crate::packet::filters::Options;
    use crate::subscriber::Delivery;
    use crate::subscription::Subscription;

    proptest! {
        /// The search level by level finds exactly what a comparison with each filter finds.
        #[test]
        fn those_are_found_whose_filters_match(
            filters in prop::collection::btree_set(some_filter(), 0..40),
            levels in prop::collection::vec(level(), 1..5),
        ) {
            let (readers, topic) = (Readers::default(), levels.join("/"));
            let all: Vec<(String, Arc<Subscriber>)> = filters.into_iter().map(|filter| (filter, Arc::default())).collect();
            for (filter, subscriber) in &all {
                readers.enter(&Arc::from(filter.as_str()), None, subscriber, Grant::at(Qos::One));
            }
            let found = readers.of(&topic, None).each;
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
            readers.enter(&Arc::from(filter), None, subscriber, Grant::at(qos));
        }
        let best = |topic: &str| readers.of(topic, None).each.iter().map(|reader| reader.qos).collect::<Vec<_>>();
        assert_eq!(best("a/x"), [Qos::One]);
        let before = readers.generation();
        readers.strike("a/+", None, &one);
        assert!(readers.generation() > before && best("a/x") == [Qos::Zero]);
        readers.strike("a/#", None, &one);
        assert_eq!((readers.of("a/x", None).each.len(), readers.of("b", None).each.len()), (0, 1));
        readers.strike("b", None, &other);
        assert!(readers.held().is_empty());
    }

    /// Two filters of one subscriber match, with different options. The subscriber gets the RETAIN flag if one of
    /// them asks for it, and the ids of both subscriptions.
    #[test]
    fn whoever_holds_several_filters_gets_what_any_of_them_promises_and_all_their_numbers() {
        let (readers, one): (_, Arc<Subscriber>) = (Readers::default(), Arc::default());
        let grant =
            |as_published, no_local, id| Grant { options: Options { as_published, no_local, ..Options::at(Qos::One) }, id };
        for (filter, grant) in
            [("a/#", grant(true, false, Some(7))), ("a/+", grant(false, true, None)), ("a/x", grant(false, true, Some(9)))]
        {
            readers.enter(&Arc::from(filter), None, &one, grant);
        }
        let of = |publisher| {
            let found = readers.of("a/x", publisher).each;
            let mut ids: Vec<u32> = found[0].ids.iter().flat_map(|ids| ids.iter().copied()).collect();
            ids.sort_unstable();
            (found.len(), found[0].as_published, ids)
        };
        assert_eq!(of(None), (1, true, vec![7, 9]));
        assert_eq!(of(Some(one.id())), (1, true, vec![7]), "his own does not come by those that leave it out");
        readers.strike("a/#", None, &one);
        assert!(readers.of("a/x", Some(one.id())).is_empty() && !readers.of("a/x", None).is_empty());
    }

    #[test]
    fn of_a_group_one_who_is_here_has_his_turn() {
        let readers = Arc::new(Readers::default());
        let mut members: Vec<Subscription> = (0..3).map(|_| Subscription::new(&readers)).collect();
        members.iter_mut().for_each(|member| drop(member.hold("$share/g/a/+", Grant::at(Qos::One))));
        members[0].hold("$share/h/a/+", Grant::at(Qos::One));
        members[0].hold("$share/g/a/#", Grant::at(Qos::One));
        members[0].hold("a/b", Grant::at(Qos::One));
        let found = readers.of("a/b", None);
        let mut sizes: Vec<usize> = found.groups.iter().map(Vec::len).collect();
        sizes.sort_unstable();
        assert_eq!((found.each.len(), sizes), (1, vec![1, 1, 3]));
        let group = found.groups.iter().find(|group| group.len() == 3).unwrap();
        let groups = [group.clone(), group.clone()];
        let turns = |count: usize| {
            let mut chosen = [BTreeSet::new(), BTreeSet::new()];
            for _ in 0..count {
                let readers = readers.in_turn(&groups).map(|reader| Arc::as_ptr(&reader.subscriber));
                chosen.iter_mut().zip(readers).for_each(|(chosen, reader)| chosen.extend([reader]));
            }
            assert_eq!(chosen[0].len(), chosen[1].len(), "in every group that reads it");
            chosen[0].len()
        };
        assert_eq!(turns(3), 3, "each has his turn");
        let behind = Message::new(Draft::plain("x", &vec![0; LAG_BYTES], Qos::One), 0, &Arc::default());
        let reader = TopicReader { qos: Qos::One, ..group[0].clone() };
        let put = |reader: &TopicReader| reader.subscriber.put(Delivery::of(&Arc::new(behind), reader), || true);
        put(&reader);
        assert_eq!(turns(9), 2, "nor has who does not keep up");
        reader.subscriber.next(true);
        members[1].subscriber().go_away(true);
        assert_eq!(turns(9), 2, "who is away has none");
        members.iter().for_each(|member| member.subscriber().go_away(true));
        assert_eq!(turns(3), 3, "all are away: it waits for one of them");
        members[0].strike("$share/g/a/+");
        assert_eq!(readers.of("a/b", None).groups.iter().map(Vec::len).max(), Some(2));
        drop(members);
        assert!(readers.of("a/b", None).is_empty());
    }
}
