//! Handles received datagrams: each becomes a request for the application or is answered without the application.
//! `outward` sends the answers.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use super::block::{Block, BodyKey, Taken, too_large};
use super::code::{Code, Method};
use super::exchange::{KnownMessage, MessageKey};
use super::limits::{BODY, OPEN, PATIENCE, REFUSED};
use super::message::{Incoming, MessageKind, Received, Token, empty, parse};
use super::network::is_this_machine;
use super::options::{self, ParsedRequest};
use super::reliable::About;
use super::reply::ReplyOptions;
use super::request::Request;
use super::response::Response;
use super::{Endpoint, ExchangeId, Open, RefusedRequest, lenient};

#[derive(Clone, Copy, Debug)]
pub(super) struct ReplyTo {
    pub(super) key: MessageKey,
    pub(super) kind: MessageKind,
    pub(super) token: Token,
    /// The classes of answers that the sender does not want, as bits (RFC 7967).
    pub(super) no_response: u32,
}

impl ReplyTo {
    /// Whether the sender wants an answer with this code. The code 2.31, which asks for the next block, is always
    /// wanted.
    pub(super) fn is_wanted(self, code: Code) -> bool {
        code == Code::CONTINUE || self.no_response & (1 << (code.class().max(1) - 1)) == 0
    }
}

impl Endpoint {
    /// Handles a datagram from the network. Afterwards, fetch the results with the `poll_…` functions.
    pub fn handle_datagram(&mut self, peer: SocketAddr, bytes: &[u8], now: Duration) {
        self.guard.received(peer, bytes.len());
        match parse(bytes) {
            Received::Nothing => {}
            Received::Malformed(kind, id) => self.take_malformed(MessageKey::of(peer, id, bytes), kind, bytes, now),
            Received::Ack(id) => self.take_acknowledgement(peer, id, now),
            Received::Rst(id) => self.take_rejection(peer, id, now),
            Received::Request(incoming) => {
                let key = MessageKey::of(peer, incoming.id, bytes);
                self.take_request(key, incoming, bytes, now);
            }
        }
    }

    /// Answers a malformed message with a reset if it is a CON. An urgent request in the message still takes effect,
    /// unless the same message was handled before.
    fn take_malformed(&mut self, key: MessageKey, kind: MessageKind, bytes: &[u8], now: Duration) {
        let is_new = self.exchanges.known(key, now).is_none();
        if let Some(urgent) = self.urgent_in(key.peer, bytes).filter(|_| is_new) {
            let exchange = self.open_exchange(key, true, now);
            self.exchanges.acts_again_when_undone(key);
            self.exchanges.answered(key, &[]);
            self.asked.push_back((exchange, urgent));
        }
        if kind == MessageKind::Con {
            self.transmit(key.peer, empty(MessageKind::Rst, key.id), now);
        }
    }

    /// Finds an urgent request in a datagram, even if the datagram is malformed.
    pub(super) fn urgent_in(&self, peer: SocketAddr, bytes: &[u8]) -> Option<Request> {
        lenient::requests(peer, bytes).find(self.is_urgent)
    }

    fn open_exchange(&mut self, key: MessageKey, is_command: bool, now: Duration) -> ExchangeId {
        self.counted += 1;
        let exchange = ExchangeId(self.counted);
        self.exchanges.open(key, exchange, is_command, now);
        exchange
    }

    fn take_acknowledgement(&mut self, peer: SocketAddr, id: u16, now: Duration) {
        let Some((sent, once)) = self.reliable.settled(peer, id) else { return };
        self.guard.heard_us(peer, now);
        if let About::Notification(observer, thing, version) = sent.about {
            // After a retransmission it is unknown which copy was acknowledged, so no round-trip time is measured
            // (Karn's rule).
            let away = once.then(|| now.saturating_sub(sent.first));
            self.observers.acknowledged(observer, thing, version, away, now);
        }
        self.go_on(peer, now);
    }

    /// Handles a reset: the sender rejects a message of ours. The sender no longer observes, or no longer wants the
    /// answer.
    fn take_rejection(&mut self, peer: SocketAddr, id: u16, now: Duration) {
        let on_its_way = self.reliable.settled(peer, id).map(|(sent, _)| sent.about);
        let observer = match on_its_way {
            Some(About::Notification(observer, ..)) => Some(observer),
            Some(About::Answer) => None,
            None => self.observers.told_by(peer, id),
        };
        if let Some(observer) = observer {
            self.forget(peer, observer);
        }
        self.go_on(peer, now);
    }

    fn take_request(&mut self, key: MessageKey, incoming: Incoming, bytes: &[u8], now: Duration) {
        let (peer, no_response) = (key.peer, options::no_response(&incoming.packet));
        let reply_to = ReplyTo { key, kind: incoming.kind, token: incoming.token, no_response };
        match self.exchanges.known(reply_to.key, now).cloned() {
            Some(KnownMessage::Answered(datagram)) if datagram.is_empty() => return,
            Some(KnownMessage::Answered(datagram)) => {
                self.transmit(peer, datagram, now);
                return;
            }
            Some(KnownMessage::Open(exchange)) => return self.acknowledge_open(reply_to, exchange, now),
            None => {}
        }
        if self.guard.is_too_much(peer, now) {
            let words = "too many requests: wait a second";
            let response = Response { max_age: Some(1), ..Response::refusal(Code::TOO_MANY_REQUESTS, words) };
            return self.reply(reply_to, &response, None, now);
        }
        let is_safe = Method::of(incoming.code).is_some_and(Method::is_safe);
        let asked = (!is_safe).then(|| options::asked(&incoming));
        let is_command = is_this_machine(peer.ip()) && !is_safe;
        let exchange = self.open_exchange(reply_to.key, is_command, now);
        let response = match options::read(peer, incoming) {
            Ok(read) => return self.take_read(reply_to, exchange, read, now),
            Err(response) => response,
        };
        let (response, asked) = match self.urgent_in(peer, bytes) {
            // Only the effect of the request is recorded. A recorded refusal would read as if nothing had been done.
            Some(urgent) => {
                self.exchanges.acts_again_when_undone(reply_to.key);
                self.asked.push_back((exchange, urgent));
                let words = format!("refused: {}; {}", self.took_effect, String::from_utf8_lossy(&response.body));
                (Response { body: words.into_bytes().into(), ..response }, None)
            }
            None => (response, asked),
        };
        // A message that needs no acknowledgement is ignored when it has an unknown critical option (RFC 7252,
        // section 5.4.1).
        if reply_to.kind == MessageKind::Non && response.code == Code::BAD_OPTION {
            self.note(peer, asked, &response);
            return self.exchanges.answered(reply_to.key, &[]);
        }
        self.refuse(reply_to, asked, response, None, now);
    }

    fn take_read(&mut self, reply_to: ReplyTo, exchange: ExchangeId, mut read: ParsedRequest, now: Duration) {
        if let Some(echo) = &read.echo {
            self.guard.echoed(reply_to.key.peer, echo, now);
        }
        let later = read.block2.filter(|block| read.block1.is_none() && block.number > 0 && !read.request.method.is_safe());
        let is_urgent = (self.is_urgent)(&read.request);
        if is_urgent || read.block1.is_some_and(|block| block.more) {
            // Whether a body in blocks is urgent is known only at its last block. To repeat an urgent body, the
            // sender has to repeat all its blocks. So each block must be handled again after an undo.
            self.exchanges.acts_again_when_undone(reply_to.key);
        }
        let undone = self.exchanges.undone;
        if let Some(block) =
            later.filter(|block| !is_urgent || self.long_answers.is_next(&body_key(&read.request, &[]), *block, undone, now))
        {
            return self.read_on(reply_to, &read, block, now);
        }
        if is_urgent {
            return self.ask(reply_to, exchange, read, now);
        }
        if read.request.method == Method::Get && read.observe != Some(1) && self.observes_on(reply_to, &read, now) {
            return;
        }
        match self.whole(&mut read, now) {
            Ok(true) => {}
            Ok(false) => {
                let more = read.block1.map(|block| Block { more: true, ..block });
                return self.reply(reply_to, &Response::new(Code::CONTINUE), more, now);
            }
            Err(response) => {
                let asked = format!("{} {}", read.request.method.name(), read.request.path_text());
                return self.refuse(reply_to, Some(asked), response, read.block1, now);
            }
        }
        let is_get = read.request.method == Method::Get;
        if is_get && read.observe == Some(0) && !self.guard.is_proved(reply_to.key.peer, now) {
            return self.challenge(reply_to, now);
        }
        if (self.is_urgent)(&read.request) {
            self.exchanges.acts_again_when_undone(reply_to.key);
        }
        self.ask(reply_to, exchange, read, now);
    }

    /// Refuses a request without passing it to the application. If the request asked for a change, the answer begins
    /// with `refused: `.
    fn refuse(&mut self, reply_to: ReplyTo, asked: Option<String>, response: Response, block1: Option<Block>, now: Duration) {
        let words = String::from_utf8_lossy(&response.body).into_owned();
        let worded = if asked.is_some() { format!("refused: {words}").into_bytes().into() } else { Arc::clone(&response.body) };
        self.note(reply_to.key.peer, asked, &response);
        self.reply(reply_to, &Response { body: worded, ..response }, block1, now);
    }

    /// Stores a refused request for a change, so that the application can record it. Does so only if the sender is on
    /// this machine and fewer than `REFUSED` refusals are stored.
    fn note(&mut self, peer: SocketAddr, asked: Option<String>, response: &Response) {
        let Some(asked) = asked.filter(|_| is_this_machine(peer.ip()) && self.refused.len() < REFUSED) else { return };
        let words = String::from_utf8_lossy(&response.body).into_owned();
        self.refused.push_back(RefusedRequest { peer, asked, words });
    }

    /// Answers a request for a later block of a body whose first block was sent as a notification. Returns false for
    /// any other request.
    fn observes_on(&mut self, reply_to: ReplyTo, read: &ParsedRequest, now: Duration) -> bool {
        let Some(block) = read.block2.filter(|block| block.number > 0) else {
            if read.observe.is_none() {
                self.observers.read_anew(&read.request);
            }
            return false;
        };
        let Some(begun) = self.observers.read_on(&read.request, block, now) else { return false };
        let shape = ReplyOptions { block2: Some(block), wants_size: read.wants_size, ..ReplyOptions::default() };
        self.send_reply(reply_to, &begun, &shape, now);
        true
    }

    fn read_on(&mut self, reply_to: ReplyTo, read: &ParsedRequest, block: Block, now: Duration) {
        let shape = ReplyOptions { block2: Some(block), wants_size: read.wants_size, ..ReplyOptions::default() };
        if let Some(answer) = self.long_answers.read(&body_key(&read.request, &[]), block, now) {
            return self.send_reply(reply_to, &answer, &shape, now);
        }
        let words = "the rest of the answer is not stored: repeat the request from its first block";
        self.reply(reply_to, &Response::refusal(Code::INCOMPLETE, words), None, now);
    }

    /// Adds this block to the request's body. Returns whether the body is complete. If so, `read.request` now
    /// contains the whole body.
    fn whole(&mut self, read: &mut ParsedRequest, now: Duration) -> Result<bool, Response> {
        let request = &mut read.request;
        if request.payload.len() > BODY || read.size1.is_some_and(|size| size as usize > BODY) {
            return Err(too_large());
        }
        let Some(block) = read.block1.filter(|_| request.method != Method::Get) else { return Ok(true) };
        let key = body_key(request, &read.request_tags);
        match self.assemblies.take(key, block, &request.payload, now)? {
            Taken::More => Ok(false),
            Taken::Whole(body) => {
                request.payload = body;
                Ok(true)
            }
        }
    }

    fn ask(&mut self, reply_to: ReplyTo, exchange: ExchangeId, read: ParsedRequest, now: Duration) {
        let ParsedRequest { request, etags, observe, block1, block2, wants_size, .. } = read;
        let is_get = request.method == Method::Get;
        let open = Open {
            reply_to,
            is_acknowledged: false,
            is_get,
            observe,
            request: (is_get && observe == Some(0)).then(|| Box::new(request.clone())),
            kept_as: (!request.method.is_safe()).then(|| Box::new(body_key(&request, &[]))),
            undone: self.exchanges.undone,
            etags,
            block1: block1.filter(|_| !is_get),
            block2,
            wants_size,
        };
        self.open.insert(exchange, open);
        if reply_to.kind == MessageKind::Con {
            self.patience.insert(exchange, now + PATIENCE);
        }
        if let Some((given_up, _)) = (self.open.len() > OPEN).then(|| self.open.pop_first()).flatten() {
            self.patience.remove(&given_up);
        }
        self.asked.push_back((exchange, request));
    }

    fn acknowledge_open(&mut self, reply_to: ReplyTo, exchange: ExchangeId, now: Duration) {
        let Some(open) = self.open.get_mut(&exchange).filter(|_| reply_to.kind == MessageKind::Con) else { return };
        open.is_acknowledged = true;
        self.patience.remove(&exchange);
        self.acknowledge(reply_to.key, now);
    }
}

/// The key of the blocks of a request's body. A long answer to the request is stored under the same key.
fn body_key(request: &Request, tags: &[Vec<u8>]) -> BodyKey {
    BodyKey {
        peer: request.peer,
        method: request.method,
        path: request.path.clone(),
        queries: request.queries.clone(),
        tags: tags.to_vec(),
    }
}
