//! An honest client, sans-IO: it retransmits, acknowledges and rejects as the RFCs say, observes by the freshness rule,
//! registers again when its state is out of date, and puts blocks together both ways.

pub(crate) mod ask;
pub(crate) mod exchange;
pub(crate) mod observation;

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::net::SocketAddr;
use std::time::Duration;

use crate::rig::chance::Chance;
use coap_endpoint::{Code, Method};

use super::message::{Kind, Message, option};
use ask::Ask;
use exchange::{Exchange, Outcome, Step, Trip};

/// How long a client waits for a separate answer that was promised.
const PROMISED: Duration = Duration::from_secs(120);

/// Retransmissions (RFC 7252, section 4.8).
const MAX_RETRANSMIT: u32 = 4;

pub(crate) struct Client {
    pub(crate) address: SocketAddr,
    pub(crate) seen: Vec<(Duration, Message)>,
    /// Every message that was sent, retransmissions included.
    pub(crate) sent: Vec<(Duration, Message)>,
    /// Switched off: it neither receives nor sends.
    pub(crate) is_off: bool,
    exchanges: BTreeMap<Vec<u8>, Exchange>,
    /// The replies to the endpoint's messages, which may come again.
    replies: HashMap<u16, (Duration, Kind)>,
    out: VecDeque<Message>,
    chance: Chance,
    next_id: u16,
    next_token: u32,
    /// When something is due next; cached, as it is asked for often.
    due: Option<Duration>,
}

impl Client {
    pub(crate) fn new(address: SocketAddr, seed: u64) -> Client {
        let mut chance = Chance::new(seed, &format!("client {address}"));
        let next_id = u16::try_from(chance.below(1 << 16)).expect("16 bits");
        Client {
            address,
            seen: Vec::new(),
            sent: Vec::new(),
            is_off: false,
            exchanges: BTreeMap::new(),
            replies: HashMap::new(),
            out: VecDeque::new(),
            chance,
            next_id,
            next_token: 1,
            due: None,
        }
    }

    pub(crate) fn ask(&mut self, ask: Ask, now: Duration) -> Vec<u8> {
        let token = self.next_token.to_be_bytes().to_vec();
        self.next_token += 1;
        let mut exchange = Exchange::new(ask);
        let message = exchange.first(&token);
        self.exchanges.insert(token.clone(), exchange);
        self.post(&token, message, now);
        token
    }

    pub(crate) fn outcome(&self, token: &[u8]) -> Option<&Outcome> {
        self.exchanges.get(token).and_then(|exchange| exchange.outcome.as_ref())
    }

    pub(crate) fn held(&self, token: &[u8]) -> Option<&[u8]> {
        self.exchanges.get(token)?.observation.as_ref()?.held.as_deref()
    }

    /// Every state that an observation held, in order.
    pub(crate) fn states(&self, token: &[u8]) -> Vec<String> {
        let observation = self.exchanges.get(token).and_then(|exchange| exchange.observation.as_ref());
        let states = observation.map_or(&[][..], |observation| &observation.states);
        states.iter().map(|(_, state)| String::from_utf8_lossy(state).into_owned()).collect()
    }

    /// Forgets an observation without a message; the next notification is rejected.
    pub(crate) fn forget(&mut self, token: &[u8]) {
        self.exchanges.remove(token);
        self.note_due();
    }

    /// Ends an observation with Observe 1.
    pub(crate) fn cancel(&mut self, token: &[u8], now: Duration) {
        let exchange = self.exchanges.get_mut(token).expect("an observation that was begun");
        exchange.observation = None;
        exchange.ask.observes = false;
        let message = exchange.ask.head(0, token).observe(1);
        self.post(token, message, now);
    }

    pub(crate) fn poll_transmit(&mut self, now: Duration) -> Option<Vec<u8>> {
        let message = self.out.pop_front()?;
        let bytes = message.encoded();
        self.sent.push((now, message));
        Some(bytes)
    }

    pub(crate) const fn poll_timeout(&self) -> Option<Duration> {
        self.due
    }

    pub(crate) fn handle_datagram(&mut self, bytes: &[u8], now: Duration) {
        let message = Message::decoded(bytes);
        self.seen.push((now, message.clone()));
        match message.kind {
            Kind::Ack if message.code == Code::EMPTY => self.acknowledged(message.id, now),
            Kind::Ack => self.answered(&message, now),
            Kind::Rst => self.rejected(message.id),
            Kind::Con | Kind::Non => self.told(&message, now),
        }
        self.note_due();
    }

    pub(crate) fn handle_timeout(&mut self, now: Duration) {
        let tokens: Vec<Vec<u8>> = self.exchanges.keys().cloned().collect();
        for token in tokens {
            self.repeat(&token, now);
            self.register_again(&token, now);
        }
        self.note_due();
    }

    fn post(&mut self, token: &[u8], message: Message, now: Duration) {
        let message = Message { id: self.next_id, ..message };
        self.next_id = self.next_id.wrapping_add(1);
        let wait = Duration::from_secs(2).mul_f64(1.0 + self.chance.fraction() / 2.0);
        let trip = Trip { message: message.clone(), due: now + wait, wait, tries: 0, is_acknowledged: false };
        self.exchanges.get_mut(token).expect("it is an exchange of ours").trip = Some(trip);
        self.out.push_back(message);
        self.note_due();
    }

    fn acknowledged(&mut self, id: u16, now: Duration) {
        let trips = self.exchanges.values_mut().filter_map(|exchange| exchange.trip.as_mut());
        for trip in trips.filter(|trip| trip.message.id == id && !trip.is_acknowledged) {
            trip.is_acknowledged = true;
            trip.due = now + PROMISED;
        }
    }

    fn rejected(&mut self, id: u16) {
        let of_this = |exchange: &&mut Exchange| exchange.trip.as_ref().is_some_and(|trip| trip.message.id == id);
        for exchange in self.exchanges.values_mut().filter(of_this) {
            exchange.trip = None;
            exchange.outcome = Some(Outcome::Silence);
        }
    }

    /// Handles a CON or NON of the endpoint: acknowledges or rejects it where needed, and takes it once.
    fn told(&mut self, message: &Message, now: Duration) {
        let before = self.replies.get(&message.id).filter(|(at, _)| now < *at + Duration::from_secs(247)).map(|(_, kind)| *kind);
        let is_known = self.exchanges.get(&message.token).is_some_and(|exchange| {
            exchange.trip.is_some() || exchange.observation.as_ref().is_some_and(|observation| !observation.is_over)
        });
        let reply = before.unwrap_or(if is_known { Kind::Ack } else { Kind::Rst });
        self.replies.insert(message.id, (now, reply));
        // An unknown NON is rejected as well: a server learns by it that nobody observes any more (RFC 7641, section
        // 3.6).
        if message.kind == Kind::Con || reply == Kind::Rst {
            self.out.push_back(Message::empty(reply, message.id));
        }
        if before.is_none() && is_known {
            self.answered(message, now);
        }
    }

    fn answered(&mut self, message: &Message, now: Duration) {
        let token = message.token.clone();
        let Some(exchange) = self.exchanges.get_mut(&token) else { return };
        let is_stale = message.kind == Kind::Ack && exchange.trip.as_ref().is_none_or(|trip| trip.message.id != message.id);
        if is_stale {
            return;
        }
        if exchange.ask.observes {
            return self.notified(message, &token, now);
        }
        if exchange.trip.take().is_none() {
            return;
        }
        match exchange.takes(message, &token) {
            Step::Send(next) => self.post(&token, next, now),
            Step::Done => self.fetched(&token, now),
        }
    }

    fn notified(&mut self, message: &Message, token: &[u8], now: Duration) {
        let exchange = self.exchanges.get_mut(token).expect("it was found before");
        exchange.trip = None;
        let observation = exchange.observation.get_or_insert_default();
        let max_age = message.value(option::MAX_AGE);
        let Some(number) = message.observed() else {
            observation.is_over = true;
            observation.fresh_until = None;
            observation.holds(message.payload.clone(), now);
            exchange.outcome =
                Some(Outcome::Answered { code: message.code, body: message.payload.clone(), last: message.clone() });
            return;
        };
        if !observation.takes(number, now) {
            return;
        }
        observation.believe(max_age, now);
        match message.block(option::BLOCK2) {
            Some((0, true, exponent)) => self.fetch_rest(message, exponent, token, now),
            _ => observation.holds(message.payload.clone(), now),
        }
    }

    fn fetch_rest(&mut self, message: &Message, exponent: u8, token: &[u8], now: Duration) {
        let ask = Ask { observes: false, ..self.exchanges[token].ask.clone() };
        self.exchanges.retain(|_, exchange| exchange.fetches_for.as_deref() != Some(token));
        let own = self.next_token.to_be_bytes().to_vec();
        self.next_token += 1;
        let mut exchange = Exchange::new(ask);
        exchange.fetches_for = Some(token.to_vec());
        let Step::Send(next) = exchange.takes(message, &own) else { return };
        debug_assert!(exponent <= 6);
        self.exchanges.insert(own.clone(), exchange);
        self.post(&own, next, now);
    }

    fn fetched(&mut self, own: &[u8], now: Duration) {
        let exchange = &self.exchanges[own];
        let Some(token) = exchange.fetches_for.clone() else { return };
        let Some(Outcome::Answered { code: Code::CONTENT, body, .. }) = exchange.outcome.clone() else { return };
        self.exchanges.remove(own);
        if let Some(observation) = self.exchanges.get_mut(&token).and_then(|exchange| exchange.observation.as_mut()) {
            observation.holds(body, now);
        }
    }

    fn repeat(&mut self, token: &[u8], now: Duration) {
        let Some(exchange) = self.exchanges.get_mut(token) else { return };
        let Some(trip) = exchange.trip.as_mut().filter(|trip| trip.due <= now) else { return };
        if trip.is_acknowledged || trip.tries >= MAX_RETRANSMIT {
            exchange.trip = None;
            exchange.outcome = Some(Outcome::Silence);
            // A client that wants to observe tries again.
            if exchange.ask.observes {
                exchange.observation.get_or_insert_default().fresh_until = Some(now);
            }
            return;
        }
        trip.tries += 1;
        trip.wait *= 2;
        trip.due = now + trip.wait;
        self.out.push_back(trip.message.clone());
    }

    /// Asks again for a state that is out of date, 5 to 15 seconds later (RFC 7641, section 3.3.1).
    fn register_again(&mut self, token: &[u8], now: Duration) {
        let Some(exchange) = self.exchanges.get_mut(token) else { return };
        let Some(observation) = exchange.observation.as_mut().filter(|observation| !observation.is_over) else { return };
        if exchange.trip.is_some() || observation.fresh_until.is_none_or(|until| now < until + SLACK) {
            return;
        }
        let message = exchange.first(token);
        debug_assert_eq!(message.code, Method::Get.code());
        self.post(token, message, now);
    }

    fn note_due(&mut self) {
        let trips = self.exchanges.values().filter_map(|exchange| exchange.trip.as_ref()).map(|trip| trip.due);
        let idle = self.exchanges.values().filter(|exchange| exchange.trip.is_none());
        let observations = idle.filter_map(|exchange| exchange.observation.as_ref());
        let renewals = observations.filter(|seen| !seen.is_over).filter_map(|seen| seen.fresh_until).map(|until| until + SLACK);
        self.due = trips.chain(renewals).min();
    }
}

/// Time that a client grants a notification beyond Max-Age, as it may be on its way.
const SLACK: Duration = Duration::from_secs(5);
