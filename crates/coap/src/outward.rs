//! Sends answers, notifications and retransmissions. Received datagrams are handled in `inward`.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use super::block::Block;
use super::code::Code;
use super::exchange::MessageKey;
use super::inward::ReplyTo;
use super::limits::PEERS;
use super::message::{MessageKind, Outgoing, Token, empty};
use super::observe::{Notification, Registration};
use super::reliable::{About, Late, Sent};
use super::reply::{self, ReplyOptions};
use super::response::{Answer, Response};
use super::subject::ObserverId;
use super::{Endpoint, Open, Transmit};

impl Endpoint {
    pub(super) fn answer(&mut self, mut open: Open, answer: Answer, now: Duration) {
        let observe = self.observe(&mut open, &answer, now);
        let is_shown = |thing: &&Arc<Response>| thing.body == answer.response.body;
        // The answer that starts an observation is valid until the next notification, as each notification is.
        let watched = answer.observed.iter().find(is_shown).filter(|_| observe.is_some());
        let mut response = Arc::clone(watched.unwrap_or(&answer.response));
        if open.is_get && response.code == Code::CONTENT && response.tag.is_some_and(|tag| open.etags.contains(&tag)) {
            let (tag, max_age) = (response.tag, response.max_age);
            response = Arc::new(Response { tag, max_age, ..Response::new(Code::VALID) });
        }
        let block = open.block2.unwrap_or(Block::FIRST);
        if let Some(key) = open.kept_as.take().filter(|_| response.body.len() > block.size()) {
            self.long_answers.keep(*key, Arc::clone(&response), block, open.undone, now);
        }
        let Open { reply_to, is_acknowledged, block1, block2, wants_size, .. } = open;
        let shape = ReplyOptions { block1, block2, wants_size, observe, echo: None };
        if !is_acknowledged {
            return self.send_reply(reply_to, &response, &shape, now);
        }
        if reply_to.is_wanted(response.code) {
            let mut message = reply::message(reply_to.token, &response, &shape);
            if !self.guard.has_room(reply_to.key.peer, message.length(), now) {
                message = self.challenging(reply_to, now);
            }
            self.send_separately(reply_to.key.peer, message, now);
        }
    }

    /// Answers a request without the application.
    pub(super) fn reply(&mut self, reply_to: ReplyTo, response: &Response, block1: Option<Block>, now: Duration) {
        self.send_reply(reply_to, response, &ReplyOptions { block1, ..ReplyOptions::default() }, now);
    }

    /// Answers 4.01 with an Echo option: the peer has to prove first that it receives what is sent to its address
    /// (RFC 9175, section 2.3).
    pub(super) fn challenge(&mut self, reply_to: ReplyTo, now: Duration) {
        let (kind, id) = self.head_of_reply(reply_to);
        let bytes = self.challenging(reply_to, now).datagram(kind, id);
        self.exchanges.answered(reply_to.key, &bytes);
        self.transmit(reply_to.key.peer, bytes, now);
    }

    fn challenging(&self, reply_to: ReplyTo, now: Duration) -> Outgoing {
        let peer = reply_to.key.peer;
        let shape = ReplyOptions { echo: Some(self.guard.echo(peer, now)), ..ReplyOptions::default() };
        let message = |words: &str| {
            let response = Response::refusal(Code::UNAUTHORIZED, words);
            reply::message(reply_to.token, &response, &shape)
        };
        let worded = message("send the Echo option back");
        if self.guard.has_room(peer, worded.length(), now) { worded } else { message("") }
    }

    /// The type and id of a reply. The reply to a CON is its acknowledgement. Any other reply is a NON with a new id.
    fn head_of_reply(&mut self, reply_to: ReplyTo) -> (MessageKind, u16) {
        match reply_to.kind {
            MessageKind::Con => (MessageKind::Ack, reply_to.key.id),
            MessageKind::Non | MessageKind::Ack | MessageKind::Rst => (MessageKind::Non, self.next_id(reply_to.key.peer)),
        }
    }

    /// Sends an observer its last message, without waiting for an acknowledgement.
    pub(super) fn bid_farewell(&mut self, peer: SocketAddr, token: Token, farewell: &Response) {
        let id = self.next_id(peer);
        let message = reply::message(token, farewell, &ReplyOptions::default());
        self.send_to_observer(peer, message.datagram(MessageKind::Non, id));
    }

    pub(super) fn forget(&mut self, peer: SocketAddr, observer: ObserverId) {
        self.reliable.withdraw(peer, observer);
        self.observers.remove(observer);
    }

    /// Sends the next waiting answer to this peer, unless another message to it is still on its way. If no answer
    /// waits, schedules the peer's observers.
    pub(super) fn go_on(&mut self, peer: SocketAddr, now: Duration) {
        if self.reliable.is_busy(peer) {
            return;
        }
        match self.reliable.next(peer) {
            Some(message) => {
                self.send_confirmable(peer, message, About::Answer, now);
            }
            None => self.observers.wake(peer, now),
        }
    }

    /// Acknowledges requests whose answer takes longer than `PATIENCE`, before their senders repeat them.
    pub(super) fn acknowledge_slow(&mut self, now: Duration) {
        while let Some((exchange, _)) = self.patience.first_key_value().filter(|(_, due)| **due <= now) {
            let exchange = *exchange;
            self.patience.remove(&exchange);
            let Some(open) = self.open.get_mut(&exchange) else { continue };
            open.is_acknowledged = true;
            let key = open.reply_to.key;
            self.acknowledge(key, now);
        }
    }

    /// Repeats messages that were not acknowledged in time. A repeated notification has the newest state.
    pub(super) fn repeat_late(&mut self, now: Duration) {
        while let Some(late) = self.reliable.late(now) {
            match late {
                Late::Again(peer, sent) => self.repeat(peer, sent, now),
                Late::GivenUp(peer, sent) => {
                    if let About::Notification(..) = sent.about {
                        // A peer that has not acknowledged any repetition is gone, so all its observations end.
                        let gone: Vec<ObserverId> = self.observers.of_peer(peer).collect();
                        gone.into_iter().for_each(|observer| self.observers.remove(observer));
                    }
                    self.go_on(peer, now);
                }
            }
        }
    }

    pub(super) fn notify_due(&mut self, now: Duration) {
        while let Some(observer) = self.observers.due(now) {
            if let Some(notification) = self.observers.notification(observer, now) {
                self.notify(observer, &notification, now);
            }
        }
    }

    fn notify(&mut self, observer: ObserverId, notification: &Notification, now: Duration) {
        let peer = notification.peer;
        let on_its_way = self.reliable.about(peer);
        let is_its_own = matches!(on_its_way, Some(About::Notification(whose, ..)) if whose == observer);
        if is_its_own || (notification.confirm && on_its_way.is_some()) {
            // The observer gets its turn later, in `go_on`, when no message to the peer is on its way any more.
            return;
        }
        let message = message_of(notification);
        if notification.sequence.is_none() {
            self.observers.remove(observer);
            return self.send_separately(peer, message, now);
        }
        if notification.confirm {
            let about = About::Notification(observer, notification.thing, notification.version);
            let id = self.send_confirmable(peer, message, about, now);
            return self.observers.told(observer, notification, id, now);
        }
        let id = self.next_id(peer);
        self.send_to_observer(peer, message.datagram(MessageKind::Non, id));
        self.observers.told(observer, notification, id, now);
    }

    fn repeat(&mut self, peer: SocketAddr, sent: Sent, now: Duration) {
        let newer = match sent.about {
            About::Notification(observer, thing, version) => {
                self.observers.newer(observer, thing, version, now).map(|newer| (observer, newer))
            }
            About::Answer => None,
        };
        let Some((observer, newer)) = newer else { return self.send_about(peer, sent.about, sent.bytes, now) };
        let id = self.next_id(peer);
        let bytes = message_of(&newer).datagram(MessageKind::Con, id);
        let about = if newer.sequence.is_some() {
            self.observers.told(observer, &newer, id, now);
            About::Notification(observer, newer.thing, newer.version)
        } else {
            self.observers.remove(observer);
            About::Answer
        };
        self.reliable.replace(peer, id, about, bytes.clone());
        self.send_about(peer, about, bytes, now);
    }

    /// Begins or ends an observation if the request asks for it, and returns the Observe number for its answer.
    fn observe(&mut self, open: &mut Open, answer: &Answer, now: Duration) -> Option<u32> {
        let asks = open.observe.filter(|asks| open.is_get && *asks <= 1)?;
        let ReplyTo { key, kind, token, .. } = open.reply_to;
        let peer = key.peer;
        let known = self.observers.find(peer, token);
        let before = known.and_then(|known| self.observers.acknowledging(known));
        if let Some(known) = known {
            self.forget(peer, known);
            self.go_on(peer, now);
        }
        let is_first_block = open.block2.is_none_or(|block| block.number == 0);
        let request = open.request.take().filter(|_| asks == 0 && is_first_block)?;
        if answer.observed.is_empty() || !answer.response.code.is_success() {
            return None;
        }
        let exponent = open.block2.unwrap_or(Block::FIRST).exponent;
        let is_sure = kind == MessageKind::Con && !open.is_acknowledged;
        if let Some(crowd) = self.observers.crowd(&request)
            && let Some((silent, observer)) = self.reliable.most_silent(|peer| crowd.has(peer))
        {
            self.forget(silent, observer);
            self.go_on(silent, now);
        }
        let registration = Registration { request: &request, token, exponent, shown: &answer.response, is_sure };
        self.observers.register(registration, answer.observed.clone(), before, now)
    }

    pub(super) fn send_reply(&mut self, reply_to: ReplyTo, response: &Response, shape: &ReplyOptions, now: Duration) {
        if !reply_to.is_wanted(response.code) {
            return self.say_nothing(reply_to, now);
        }
        let peer = reply_to.key.peer;
        let (kind, id) = self.head_of_reply(reply_to);
        let bytes = reply::message(reply_to.token, response, shape).datagram(kind, id);
        self.exchanges.answered(reply_to.key, &bytes);
        if self.transmit(peer, bytes, now) {
            return;
        }
        if response.code.is_success() || response.body.is_empty() {
            return self.challenge(reply_to, now);
        }
        // The response is sent without its body, and is then short enough. Its code is more useful than a challenge
        // to a peer that cannot prove its address.
        self.send_reply(reply_to, &Response { max_age: response.max_age, ..Response::new(response.code) }, shape, now);
    }

    /// Suppresses an answer that is not wanted (RFC 7967); a CON gets an empty acknowledgement.
    fn say_nothing(&mut self, reply_to: ReplyTo, now: Duration) {
        if reply_to.kind == MessageKind::Con {
            self.acknowledge(reply_to.key, now);
        } else {
            self.exchanges.answered(reply_to.key, &[]);
        }
    }

    /// Sends an empty acknowledgement. If it is lost, the sender repeats its request, perhaps after the answer was
    /// sent.
    pub(super) fn acknowledge(&mut self, key: MessageKey, now: Duration) {
        let acknowledgement = empty(MessageKind::Ack, key.id);
        self.exchanges.answered(key, &acknowledgement);
        self.transmit(key.peer, acknowledgement, now);
    }

    /// Sends an answer in a separate message when the earlier messages to this peer were acknowledged. If too many
    /// answers wait, sends it at once, without asking for an acknowledgement.
    fn send_separately(&mut self, peer: SocketAddr, message: Outgoing, now: Duration) {
        let is_busy = self.reliable.is_busy(peer);
        if !is_busy && !self.reliable.is_full() {
            self.send_confirmable(peer, message, About::Answer, now);
            return;
        }
        let waits = if is_busy { self.reliable.wait(peer, message) } else { Err(message) };
        if let Err(one_too_many) = waits {
            let id = self.next_id(peer);
            self.transmit(peer, one_too_many.datagram(MessageKind::Non, id), now);
        }
    }

    fn send_confirmable(&mut self, peer: SocketAddr, message: Outgoing, about: About, now: Duration) -> u16 {
        let id = self.next_id(peer);
        let bytes = message.datagram(MessageKind::Con, id);
        self.reliable.sent(peer, id, about, bytes.clone(), now);
        self.send_about(peer, about, bytes, now);
        id
    }

    fn send_about(&mut self, peer: SocketAddr, about: About, bytes: Vec<u8>, now: Duration) {
        match about {
            About::Notification(..) => self.send_to_observer(peer, bytes),
            About::Answer => {
                self.transmit(peer, bytes, now);
            }
        }
    }

    /// Sends a datagram without the guard's limit. An observer proved its address when it registered. It is forgotten
    /// when it no longer acknowledges.
    fn send_to_observer(&mut self, peer: SocketAddr, bytes: Vec<u8>) {
        self.out.push_back(Transmit { peer, bytes });
    }

    /// Sends a datagram if the guard's limit allows it; otherwise drops it and returns false.
    pub(super) fn transmit(&mut self, peer: SocketAddr, bytes: Vec<u8>, now: Duration) -> bool {
        let may = self.guard.lets_out(peer, bytes.len(), now);
        if may {
            self.out.push_back(Transmit { peer, bytes });
        }
        may
    }

    /// The next message id for this peer. Each peer has a counter that starts at a random value, so this peer has not
    /// received the id for a long time.
    fn next_id(&mut self, peer: SocketAddr) -> u16 {
        let id = self.ids.entry(peer).or_insert_with(|| self.chance.number());
        *id = id.wrapping_add(1);
        let id = *id;
        self.ids.to_back(&peer);
        if self.ids.len() > PEERS {
            self.ids.pop_front();
        }
        id
    }
}

fn message_of(notification: &Notification) -> Outgoing {
    let Notification { token, response, exponent, sequence, .. } = notification;
    let whole = response.body.len() <= 16 << exponent;
    let block2 = (!whole).then_some(Block { number: 0, more: false, exponent: *exponent });
    reply::message(*token, response, &ReplyOptions { block2, observe: *sequence, ..ReplyOptions::default() })
}
