//! The state of one connection: whether the broker has greeted us and accepted the subscription, the missing
//! acknowledgements, the received messages, and the deadlines. The caller reports the events and the time. Nothing is
//! sent here.

use std::collections::HashMap;
use std::hash::{BuildHasher, RandomState};
use std::time::Duration;

use super::inflight::Inflight;
use super::lost::Lost;
use super::times::Times;

#[derive(Debug)]
pub(super) struct Conversation {
    stage: ConversationStage,
    times: Times,
    pub(super) inflight: Inflight,
    /// For each packet id, a hash of the last message with that id. Few ids are in use.
    heard: HashMap<u16, u64>,
    marks: RandomState,
}

/// How far the connection has come. The first two stages have a deadline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ConversationStage {
    Greeting(Duration),
    Subscribing(Duration),
    Open,
}

impl Conversation {
    pub(super) fn new(times: &Times, now: Duration) -> Conversation {
        Conversation {
            stage: ConversationStage::Greeting(now + times.greeting),
            times: *times,
            inflight: Inflight::default(),
            heard: HashMap::new(),
            marks: RandomState::new(),
        }
    }

    /// Whether the broker has greeted the client and answered its subscription.
    pub(super) fn is_open(&self) -> bool {
        self.stage == ConversationStage::Open
    }

    pub(super) fn has_room(&self) -> bool {
        self.is_open() && self.inflight.has_room()
    }

    pub(super) fn handle_greeted(&mut self, now: Duration) {
        self.stage = ConversationStage::Subscribing(now + self.times.greeting);
    }

    /// Call this when the broker has answered a subscription. Returns whether an answer was expected.
    pub(super) fn handle_subscribed(&mut self) -> bool {
        let is_due = matches!(self.stage, ConversationStage::Subscribing(_));
        if is_due {
            self.stage = ConversationStage::Open;
        }
        is_due
    }

    /// Whether this message was received before on this connection, and sent again because our acknowledgement was
    /// late. The packet id does not prove it, because brokers reuse ids. The duplicate flag does not prove it,
    /// because NATS also sets it if its first attempt failed. So both are checked, and the contents are compared. A
    /// message without an id (QoS 0) is never repeated.
    pub(super) fn is_repeated(&mut self, id: u16, is_duplicate: bool, said: (&str, &[u8])) -> bool {
        let mark = self.marks.hash_one(said);
        id != 0 && self.heard.insert(id, mark) == Some(mark) && is_duplicate
    }

    /// Call this when the time returned by [`Conversation::poll_timeout`] may have come. Earlier calls do no harm.
    ///
    /// # Errors
    /// When the broker has been silent for too long.
    pub(super) fn handle_timeout(&mut self, now: Duration) -> Result<(), Lost> {
        match self.stage {
            ConversationStage::Greeting(until) | ConversationStage::Subscribing(until) if now >= until => {
                return Err(Lost::NoGreeting(self.times.greeting));
            }
            ConversationStage::Greeting(_) | ConversationStage::Subscribing(_) | ConversationStage::Open => {}
        }
        if self.settling_until().is_some_and(|until| now >= until) {
            return Err(Lost::NoAcknowledgement(self.times.acknowledgement));
        }
        Ok(())
    }

    pub(super) fn poll_timeout(&self) -> Option<Duration> {
        let stage = match self.stage {
            ConversationStage::Greeting(until) | ConversationStage::Subscribing(until) => Some(until),
            ConversationStage::Open => None,
        };
        [stage, self.settling_until()].into_iter().flatten().min()
    }

    fn settling_until(&self) -> Option<Duration> {
        self.inflight.owed_since().map(|since| since + self.times.acknowledgement)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doors::mqtt::publication::Publication;

    const START: Duration = Duration::from_secs(50);

    fn conversation() -> (Conversation, Times) {
        let times = Times::default();
        (Conversation::new(&times, START), times)
    }

    fn open() -> (Conversation, Times) {
        let (mut conversation, times) = conversation();
        conversation.handle_greeted(START);
        assert!(conversation.handle_subscribed());
        assert!(!conversation.handle_subscribed(), "once");
        (conversation, times)
    }

    #[test]
    fn a_broker_that_does_not_greet_or_does_not_answer_the_subscription_is_given_up() {
        let (mut waiting, times) = conversation();
        let late = START + times.greeting;
        assert_eq!(waiting.poll_timeout(), Some(late));
        assert!(waiting.handle_timeout(late - Duration::from_millis(1)).is_ok());
        assert!(matches!(waiting.handle_timeout(late), Err(Lost::NoGreeting(_))));
        waiting.handle_greeted(late - Duration::from_millis(1));
        assert!(waiting.handle_timeout(late).is_ok() && !waiting.has_room());
        assert!(matches!(waiting.handle_timeout(late + times.greeting), Err(Lost::NoGreeting(_))));
        assert!(waiting.handle_subscribed());
        assert!(waiting.has_room() && waiting.poll_timeout().is_none());
        assert!(waiting.handle_timeout(late + 9 * times.greeting).is_ok());
    }

    #[test]
    fn a_broker_that_acknowledges_nothing_is_given_up_and_one_that_acknowledges_slowly_is_not() {
        let (mut conversation, times) = open();
        for id in 1..=3 {
            conversation.inflight.handle_given(Publication::passing("a".to_owned(), "1"), START);
            conversation.inflight.handle_sent(id);
        }
        let almost = times.acknowledgement - Duration::from_millis(1);
        conversation.inflight.handle_acknowledged(1, START + almost);
        assert!(conversation.handle_timeout(START + 2 * almost).is_ok());
        let late = START + almost + times.acknowledgement;
        assert_eq!(conversation.poll_timeout(), Some(late));
        assert!(matches!(conversation.handle_timeout(late), Err(Lost::NoAcknowledgement(_))));
        assert_eq!(conversation.inflight.into_unacknowledged().len(), 2);
    }

    #[test]
    fn only_a_duplicate_of_what_was_heard_is_repeated() {
        let (mut conversation, _) = open();
        let (start, stop) = (("command", &b"start"[..]), ("command", &b"stop"[..]));
        assert!(!conversation.is_repeated(7, true, start), "it was lost the first time");
        assert!(conversation.is_repeated(7, true, start));
        assert!(!conversation.is_repeated(7, false, start), "the id is used again");
        assert!(!conversation.is_repeated(7, true, stop), "something else is said");
        assert!(!conversation.is_repeated(0, true, start) && !conversation.is_repeated(0, true, start), "without an id");
    }
}
