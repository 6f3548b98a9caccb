//! Watches our retained messages at another broker, on one connection. Anybody who may publish on their topics can
//! replace them. A last will of an earlier connection can replace them too, if it comes late. A subscription to these
//! topics shows when a message was replaced. Then the message is published again. Nothing is sent here.

use std::collections::{HashMap, VecDeque};
use std::hash::{BuildHasher, RandomState};
use std::time::Duration;

use super::super::publication::Publication;
use super::link::IN_FLIGHT;
use crate::doors::update_interval;

/// Minimum time between two repetitions on one topic. Without it, two programs that overwrite each other's messages
/// would flood the broker.
const AGAIN: Duration = Duration::from_secs(1);

#[derive(Debug)]
pub(super) struct Kept {
    topics: HashMap<String, Option<Topic>>,
    /// Whether the broker sends us our own messages, as brokers of MQTT 3.1.1 do.
    has_echo: bool,
    marks: RandomState,
}

#[derive(Debug)]
struct Topic {
    ours: Publication,
    /// Hashes of our messages that the broker has not sent back yet, newest first.
    echoes: VecDeque<u64>,
    /// When to publish our message again. `None` if nobody has replaced it.
    due: Option<Duration>,
    /// Earliest time of the next repetition. The interval is at least `AGAIN`.
    next: Duration,
    is_told: bool,
}

impl Kept {
    pub(super) fn new(topics: Vec<String>, has_echo: bool) -> Kept {
        Kept { topics: topics.into_iter().map(|topic| (topic, None)).collect(), has_echo, marks: RandomState::new() }
    }

    pub(super) fn handle_given(&mut self, publication: &Publication) {
        let Some(topic) = self.topics.get_mut(&publication.topic) else { return };
        let mark = self.marks.hash_one(&publication.payload[..]);
        let fresh =
            || Topic { ours: publication.clone(), echoes: VecDeque::new(), due: None, next: Duration::ZERO, is_told: false };
        let topic = topic.get_or_insert_with(fresh);
        (topic.ours, topic.due) = (publication.clone(), None);
        if self.has_echo {
            // At most `IN_FLIGHT` messages can be under way, so the broker will not send older ones back.
            topic.echoes.truncate(IN_FLIGHT - 1);
            topic.echoes.push_front(mark);
        }
    }

    /// Handles a received message of ours or of others. Returns `None` if its topic is not in `topics`. Otherwise
    /// returns whether others have published there for the first time.
    pub(super) fn handle_heard(&mut self, topic: &str, payload: &[u8], now: Duration) -> Option<bool> {
        let topic = self.topics.get_mut(topic)?;
        // Before our first publication on this topic there is nothing to repeat.
        let Some(topic) = topic else { return Some(false) };
        let mark = self.marks.hash_one(payload);
        let echo = topic.echoes.iter().rposition(|echo| *echo == mark);
        if let Some(place) = echo {
            topic.echoes.truncate(place);
        }
        if echo.is_none() && topic.ours.payload != payload {
            topic.due.get_or_insert(topic.next.max(now));
            return Some(!std::mem::replace(&mut topic.is_told, true));
        }
        if topic.echoes.is_empty() {
            topic.due = None;
        }
        Some(false)
    }

    /// Returns a publication that must be repeated now. Call `handle_given` once it is sent.
    pub(super) fn poll_publication(&mut self, now: Duration) -> Option<Publication> {
        let topic = self.topics.values_mut().flatten().find(|topic| topic.due.is_some_and(|due| due <= now))?;
        topic.due = None;
        topic.next = now + update_interval::for_size(topic.ours.payload.len()).max(AGAIN);
        Some(topic.ours.clone())
    }

    pub(super) fn poll_timeout(&self) -> Option<Duration> {
        self.topics.values().flatten().filter_map(|topic| topic.due).min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Duration = Duration::from_secs(9);

    fn kept(has_echo: bool) -> Kept {
        Kept::new(vec!["a".to_owned(), "b".to_owned()], has_echo)
    }

    fn said(kept: &mut Kept, payload: &'static str) -> Publication {
        let publication = Publication::kept("a".to_owned(), payload);
        kept.handle_given(&publication);
        publication
    }

    #[test]
    fn what_others_say_on_a_topic_of_ours_is_answered_by_what_we_said_there_last() {
        for has_echo in [true, false] {
            let mut kept = kept(has_echo);
            assert_eq!(kept.handle_heard("elsewhere", b"x", START), None);
            assert_eq!(kept.handle_heard("a", b"x", START), Some(false), "what stood there before we came");
            said(&mut kept, "1");
            let ours = said(&mut kept, "2");
            assert_eq!(kept.handle_heard("a", b"x", START), Some(true));
            assert_eq!(kept.poll_timeout(), Some(START));
            assert_eq!(kept.poll_publication(START), Some(ours.clone()));
            kept.handle_given(&ours);
            assert_eq!((kept.poll_publication(START), kept.poll_timeout()), (None, None), "once");
        }
    }

    #[test]
    fn what_we_say_ourselves_comes_back_late_and_is_not_taken_for_that_of_others() {
        let mut kept = kept(true);
        for payload in ["1", "2", "1"] {
            said(&mut kept, payload);
        }
        for (heard, is_theirs) in [("1", false), ("2", false), ("x", true), ("1", false)] {
            assert_eq!(kept.handle_heard("a", heard.as_bytes(), START), Some(is_theirs), "{heard}");
        }
        assert_eq!(kept.poll_timeout(), None, "ours came last");
        assert_eq!(kept.handle_heard("a", b"2", START), Some(false), "others were told of already");
        assert!(kept.poll_publication(START).is_some(), "an old state of ours is not ours any more");
    }

    #[test]
    fn what_is_lost_on_its_way_back_hides_nothing() {
        let mut kept = kept(true);
        (0..200).for_each(|_| drop(said(&mut kept, "lost")));
        assert_eq!(kept.topics["a"].as_ref().map(|topic| topic.echoes.len()), Some(IN_FLIGHT));
        said(&mut kept, "1");
        kept.handle_heard("a", b"1", START);
        assert!(kept.topics["a"].as_ref().is_some_and(|topic| topic.echoes.is_empty()));
        assert_eq!(kept.handle_heard("a", b"lost", START), Some(true));
    }

    /// Safety A5.
    #[test]
    fn two_programs_that_fight_over_a_topic_say_it_once_a_second_and_log_it_once() {
        let (mut kept, mut said_again, mut told) = (kept(false), Vec::new(), 0);
        said(&mut kept, "online");
        for ms in 0..5000 {
            let now = START + Duration::from_millis(ms);
            told += usize::from(kept.handle_heard("a", b"offline", now) == Some(true));
            if let Some(ours) = kept.poll_publication(now) {
                kept.handle_given(&ours);
                said_again.push(ms);
            }
        }
        assert_eq!((said_again, told), (vec![0, 1000, 2000, 3000, 4000], 1));
    }
}
