//! The kept messages of the whole broker: the last one of each topic that was to be kept, bounded in number and bytes. The engine knows
//! none of them. Who may put one here, and how they come to a subscriber, stands in the turnstile.

use std::collections::BTreeMap;
use std::ops::Bound;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bytes::Bytes;

use super::filter::{matches, stem};
use super::limits::{KEPT, KEPT_BYTES, KEPT_COST, KEPT_OURS, KEPT_OURS_BYTES};
use super::packet::Qos;

/// The kept messages.
#[derive(Debug, Default)]
pub struct Retained(Mutex<Shelf>);

/// A kept message.
#[derive(Debug, PartialEq, Eq)]
pub struct Kept {
    /// Where it was published.
    pub topic: Arc<str>,
    /// What.
    pub payload: Bytes,
    /// And at what QoS.
    pub qos: Qos,
}

#[derive(Debug, Default)]
struct Shelf {
    kept: BTreeMap<Arc<str>, Arc<Kept>>,
    bytes: usize,
}

impl Retained {
    /// Keeps a message in the place of the one that was there; an empty one takes that away. Whether there was room: without it
    /// nothing is kept there any more, since what was is not so now.
    pub fn keep(&self, topic: &str, payload: &[u8], qos: Qos) -> bool {
        self.keep_within((topic, payload, qos), KEPT, KEPT_BYTES)
    }

    /// The same for what the program itself says, for which there is room however much others have kept.
    pub fn keep_ours(&self, topic: &str, payload: &[u8], qos: Qos) -> bool {
        self.keep_within((topic, payload, qos), KEPT + KEPT_OURS, KEPT_BYTES + KEPT_OURS_BYTES)
    }

    fn keep_within(&self, (topic, payload, qos): (&str, &[u8], Qos), most: usize, most_bytes: usize) -> bool {
        let mut shelf = self.shelf();
        let freed = shelf.kept.get(topic).map_or(0, |old| cost(old.topic.len(), old.payload.len()));
        if payload.is_empty() {
            shelf.kept.remove(topic);
            shelf.bytes -= freed;
            return true;
        }
        let bytes = shelf.bytes - freed + cost(topic.len(), payload.len());
        let has_room = bytes <= most_bytes && (freed > 0 || shelf.kept.len() < most);
        if has_room {
            let topic: Arc<str> = Arc::from(topic);
            let message = Kept { topic: Arc::clone(&topic), payload: Bytes::copy_from_slice(payload), qos };
            shelf.kept.insert(topic, Arc::new(message));
            shelf.bytes = bytes;
        } else if shelf.kept.remove(topic).is_some() {
            shelf.bytes -= freed;
        }
        has_room
    }

    /// At most so many of those that a filter matches, in the order of their topics, from behind a topic on.
    #[must_use]
    pub fn matching(&self, filter: &str, behind: Option<&str>, most: usize) -> Vec<Arc<Kept>> {
        let shelf = self.shelf();
        if !filter.contains(['+', '#']) {
            return shelf.kept.get(filter).filter(|_| behind.is_none()).cloned().into_iter().collect();
        }
        let stem = stem(filter);
        let from = behind.map_or(Bound::Included(stem), Bound::Excluded);
        let near = shelf.kept.range::<str, _>((from, Bound::Unbounded)).take_while(|(topic, _)| topic.starts_with(stem));
        near.filter(|(topic, _)| matches(filter, topic)).take(most).map(|(_, kept)| Arc::clone(kept)).collect()
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.shelf().kept.len()
    }

    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

const fn cost(topic: usize, payload: usize) -> usize {
    KEPT_COST + topic + payload
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topics(retained: &Retained, filter: &str) -> Vec<String> {
        retained.matching(filter, None, usize::MAX).iter().map(|kept| kept.topic.to_string()).collect()
    }

    #[test]
    fn the_last_of_each_topic_is_kept_and_an_empty_one_takes_it_away() {
        let retained = Retained::default();
        for (topic, payload) in [("a", "1"), ("a/b", "2"), ("a", "3"), ("ab", "4"), ("b/a", "5")] {
            assert!(retained.keep(topic, payload.as_bytes(), Qos::One));
        }
        assert_eq!(topics(&retained, "a/#"), ["a", "a/b"]);
        assert_eq!(topics(&retained, "+"), ["a", "ab"]);
        assert_eq!(topics(&retained, "#"), ["a", "a/b", "ab", "b/a"]);
        assert_eq!(&retained.matching("a", None, 1)[0].payload[..], b"3");
        assert!(retained.keep("a", b"", Qos::Zero) && retained.keep("never", b"", Qos::Zero));
        assert_eq!(topics(&retained, "#"), ["a/b", "ab", "b/a"]);
    }

    #[test]
    fn it_is_gone_through_piece_by_piece() {
        let retained = Retained::default();
        for n in 0..100 {
            assert!(retained.keep(&format!("a/{n:02}/b"), b"x", Qos::Zero));
        }
        let mut behind: Option<Arc<str>> = None;
        let mut seen = 0;
        while let Some(last) = retained.matching("a/+/b", behind.as_deref(), 7).last() {
            seen += retained.matching("a/+/b", behind.as_deref(), 7).len();
            behind = Some(Arc::clone(&last.topic));
        }
        assert_eq!(seen, 100);
        assert!(retained.matching("a/00/b", Some("a/00/b"), 7).is_empty());
    }

    #[test]
    fn there_is_an_end_to_their_number_and_what_is_there_can_still_change() {
        let retained = Retained::default();
        let kept = (0..KEPT + 10).filter(|n| retained.keep(&format!("a/{n}"), b"x", Qos::Zero)).count();
        assert_eq!((kept, retained.count()), (KEPT, KEPT));
        assert!(retained.keep("a/0", b"y", Qos::Zero) && !retained.keep("b", b"y", Qos::Zero));
        assert!(retained.keep("a/0", b"", Qos::Zero) && retained.keep("b", b"y", Qos::Zero));
    }

    #[test]
    fn there_is_an_end_to_their_bytes() {
        let retained = Retained::default();
        let mebibyte = vec![7; 1 << 20];
        let kept = (0..40).filter(|n| retained.keep(&format!("a/{n}"), &mebibyte, Qos::Zero)).count();
        assert_eq!(kept, 31);
        assert!(retained.keep("a/0", b"x", Qos::Zero) && retained.keep("b", &mebibyte, Qos::Zero));
        for n in 0..40 {
            assert!(retained.keep(&format!("a/{n}"), b"", Qos::Zero));
        }
        assert!(retained.keep("b", b"", Qos::Zero));
        assert_eq!((retained.count(), retained.shelf().bytes), (0, 0));
    }

    /// Safety A5.
    #[test]
    fn what_the_program_says_has_room_whatever_others_have_kept_and_what_has_none_is_not_kept_as_it_was() {
        let retained = Retained::default();
        let mebibyte = vec![0; 1024 * 1024];
        let kept = (0..40).filter(|n| retained.keep(&format!("a/{n}"), &mebibyte, Qos::Zero)).count();
        assert!(kept < 40 && !retained.keep("a/39", b"more", Qos::Zero) || kept >= 31);
        assert!(retained.keep_ours("state", &mebibyte, Qos::One) && retained.keep_ours("state", b"newer", Qos::One));
        assert!(!retained.keep("a/0", &vec![0; 4 * mebibyte.len()], Qos::Zero));
        assert!(retained.matching("a/0", None, 1).is_empty(), "what it said before is not so any more");
    }
}
