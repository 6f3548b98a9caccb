//! One connection from beginning to end: passes on received messages, and sends new ones. The parent module decides
//! when to connect again. The rules of a connection are in `conversation`.

use std::time::Duration;

use super::super::commands::IncomingMessage;
use super::super::home_assistant::BIRTH;
use super::super::publication::Publication;
use super::super::topics::HOME_ASSISTANT_STATUS;
use super::Session;
use super::conversation::Conversation;
use super::event::{Event, Heard};
use super::kept::Kept;
use super::lost::Lost;
use super::photos::{self, PhotoReading};
use super::transport::Transport;
use mqtt_gate::AnswerTo;
use mqtt_gate::packet::Version;

pub(super) struct ConnectionTask<'a> {
    session: &'a mut Session,
    transport: Transport,
    pub(super) conversation: Conversation,
    kept: Kept,
    reading: PhotoReading,
}

impl ConnectionTask<'_> {
    pub(super) fn begin(session: &mut Session) -> ConnectionTask<'_> {
        let transport = Transport::new(&session.link, session.offline(), &session.times);
        let conversation = Conversation::new(&session.times, session.clock.now().since_start);
        let kept = Kept::new(session.kept(), session.link.version == Version::Three);
        ConnectionTask { session, transport, conversation, kept, reading: PhotoReading::default() }
    }

    /// Runs until the connection is lost. Safe to cancel.
    pub(super) async fn go_on(&mut self) -> Lost {
        loop {
            if let Err(lost) = self.step().await {
                return lost;
            }
        }
    }

    /// Publishes that the program ends, and waits for the acknowledgement, at most `Times::farewell`.
    pub(super) async fn take_leave(mut self) {
        if self.conversation.is_open() {
            let patience = self.session.times.farewell;
            let _ = tokio::time::timeout(patience, self.last_words()).await;
        }
    }

    async fn step(&mut self) -> Result<(), Lost> {
        self.speak();
        let due = self.poll_timeout();
        let (has_room, clock) = (self.conversation.has_room(), self.session.clock);
        tokio::select! {
            event = self.transport.next() => self.handle_event(event?),
            () = clock.reach(due) => self.handle_timeout(),
            Ok(()) = self.session.states.changed() => {
                self.session.learn();
                Ok(())
            }
            looked = self.reading.done() => {
                photos::show(&mut self.session.changes, looked);
                Ok(())
            }
            Some(answer) = self.session.answers.recv(), if has_room => {
                self.give(answer.taken());
                Ok(())
            }
        }
    }

    /// Publishes new messages while there is room. The remaining messages are polled later, with the newest state at
    /// that time.
    fn speak(&mut self) {
        if self.conversation.is_open() {
            self.reading.begin(&mut self.session.changes, &self.session.archive);
        }
        while self.conversation.has_room() {
            let again = self.kept.poll_publication(self.now());
            let Some(publication) = again.or_else(|| self.session.poll_publication()) else { return };
            self.give(publication);
        }
    }

    fn poll_timeout(&self) -> Option<Duration> {
        let news = || [self.session.changes.poll_timeout(), self.kept.poll_timeout()].into_iter().flatten().min();
        let news = self.conversation.has_room().then(news).flatten();
        [self.conversation.poll_timeout(), news].into_iter().flatten().min()
    }

    /// Passes a message to the MQTT client library. Returns false when the message is too large for the broker, or
    /// when the library has no room.
    fn give(&mut self, publication: Publication) -> bool {
        let is_given = self.transport.publish(&publication);
        if is_given {
            self.kept.handle_given(&publication);
            self.conversation.inflight.handle_given(publication, self.now());
        }
        is_given
    }

    fn now(&self) -> Duration {
        self.session.clock.now().since_start
    }

    fn handle_timeout(&mut self) -> Result<(), Lost> {
        self.conversation.handle_timeout(self.now())
    }

    fn handle_event(&mut self, event: Event) -> Result<(), Lost> {
        let now = self.now();
        match event {
            Event::Heard(said) => self.hear(&said),
            Event::Acknowledged { id, is_refused } => {
                let said = self.conversation.inflight.handle_acknowledged(id, now);
                if let Some(said) = said.filter(|_| is_refused)
                    && let Some(refused) = self.session.refused.one_more()
                {
                    let topic = said.topic;
                    let broker = &self.session.link;
                    tracing::warn!(%broker, topic, refused, "the MQTT broker refused messages; the latest is on this topic");
                }
            }
            Event::Sent(id) => self.conversation.inflight.handle_sent(id),
            Event::Greeted { receive_maximum, .. } => {
                self.conversation.inflight.handle_greeted(receive_maximum);
                self.conversation.handle_greeted(now);
                if !self.transport.subscribe(self.session.filters(), self.session.kept()) {
                    return Err(Lost::Broken("a topic name is not valid in MQTT".to_owned()));
                }
            }
            Event::Subscribed(granted) => self.open(&granted),
            Event::HungUp | Event::Other => {}
        }
        Ok(())
    }

    fn open(&mut self, granted: &[bool]) {
        if !self.conversation.handle_subscribed() {
            return;
        }
        let filters = [self.session.filters(), self.session.kept()].concat();
        for (filter, _) in filters.iter().zip(granted).filter(|(_, is_granted)| !**is_granted) {
            tracing::warn!(broker = %self.session.link, filter, "the MQTT broker refused a subscription");
        }
        self.session.handle_open();
    }

    /// Handles a received message. Retained messages are ignored, because they were sent for an earlier moment.
    /// Repeated messages are ignored too, except for STOP, which is carried out each time.
    fn hear(&mut self, said: &Heard) {
        let (topic, payload) = (said.topic.as_str(), &said.payload[..]);
        let is_repeated = self.conversation.is_repeated(said.id, said.is_duplicate, (topic, payload));
        if said.retain {
            return;
        }
        let now = self.now();
        if let Some(is_news) = self.kept.handle_heard(topic, payload, now) {
            if is_news {
                let broker = &self.session.link;
                tracing::warn!(%broker, topic, "another client overwrote a topic of hallsweep; the message is published again");
            }
            return;
        }
        let session = &mut *self.session;
        if (topic, payload) == (HOME_ASSISTANT_STATUS, BIRTH) {
            return session.changes.handle_birth();
        }
        let wanted = said.answer_to.as_ref().map(|(topic, correlation)| AnswerTo { topic, correlation: correlation.as_deref() });
        let answer_to = session.commands.answer_to(wanted, &session.publisher);
        let heard = IncomingMessage { topic, payload, arrived: None, is_again: false, answer_to };
        // The return value is not needed: `commands` publishes the result itself.
        if is_repeated {
            let _ = session.commands.halts(topic.as_bytes(), payload, answer_to, &session.publisher);
        } else {
            let _ = session.commands.take(&heard, &session.publisher);
        }
    }

    async fn last_words(&mut self) -> Result<(), Lost> {
        while let Some(answer) = self.conversation.has_room().then(|| self.session.answers.try_recv().ok()).flatten() {
            self.give(answer.taken());
        }
        let is_said = self.give(self.session.offline());
        while !self.conversation.inflight.is_settled() {
            let event = self.transport.next().await?;
            self.handle_last(event);
        }
        if !is_said {
            // `offline` was not published. Leaving without a DISCONNECT makes the broker publish it as the last will.
            return Ok(());
        }
        self.transport.hang_up();
        while self.transport.next().await? != Event::HungUp {}
        Ok(())
    }

    /// Handles an event while the program ends. Commands are ignored, and only acknowledgements count.
    fn handle_last(&mut self, event: Event) {
        if let Event::Acknowledged { id, .. } = event {
            let _ = self.conversation.inflight.handle_acknowledged(id, self.now());
        } else if let Event::Sent(id) = event {
            self.conversation.inflight.handle_sent(id);
        }
    }
}
