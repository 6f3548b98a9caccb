//! One exchange of a client, from its first message to the last block of the answer. Message ids, acknowledgements and
//! retransmissions are not here.

use std::time::Duration;

use coap_endpoint::Code;

use super::ask::Ask;
use super::observation::Observation;
use crate::rig::message::{Message, option};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// An answer with its whole body.
    Answered { code: Code, body: Vec<u8>, last: Message },
    /// Nobody answered.
    Silence,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    Send(Message),
    Done,
}

#[derive(Clone, Debug)]
pub(crate) struct Trip {
    pub(crate) message: Message,
    pub(crate) due: Duration,
    pub(crate) wait: Duration,
    pub(crate) tries: u32,
    /// It was acknowledged, and the answer comes separately.
    pub(crate) is_acknowledged: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct Exchange {
    pub(crate) ask: Ask,
    pub(crate) trip: Option<Trip>,
    pub(crate) outcome: Option<Outcome>,
    pub(crate) observation: Option<Observation>,
    /// The token of the observation for whose notification it fetches further blocks.
    pub(crate) fetches_for: Option<Vec<u8>>,
    pub(crate) body: Vec<u8>,
    etag: Option<Vec<u8>>,
    sent_bytes: usize,
}

impl Exchange {
    pub(crate) fn new(ask: Ask) -> Exchange {
        Exchange {
            ask,
            trip: None,
            outcome: None,
            observation: None,
            fetches_for: None,
            body: Vec::new(),
            etag: None,
            sent_bytes: 0,
        }
    }

    pub(crate) fn first(&mut self, token: &[u8]) -> Message {
        (self.sent_bytes, self.body, self.etag) = (0, Vec::new(), None);
        let mut message = self.ask.head(0, token);
        if self.ask.observes {
            message = message.observe(0);
        }
        if self.ask.is_early {
            message = message.block2((0, false, self.ask.exponent));
        }
        if self.ask.payload.len() > self.ask.size() { self.upload(token) } else { message.payload(&self.ask.payload) }
    }

    fn upload(&mut self, token: &[u8]) -> Message {
        let start = self.sent_bytes;
        let end = self.ask.payload.len().min(start + self.ask.size());
        let number = u32::try_from(start / self.ask.size()).expect("a short body");
        let more = end < self.ask.payload.len();
        let mut message = self.ask.head(0, token).block1((number, more, self.ask.exponent));
        if self.ask.is_early && !more {
            message = message.block2((0, false, self.ask.exponent));
        }
        message.payload(&self.ask.payload[start..end])
    }

    pub(crate) fn takes(&mut self, answer: &Message, token: &[u8]) -> Step {
        if answer.code == Code::CONTINUE {
            let (number, _, exponent) = answer.block(option::BLOCK1).expect("2.31 says which block it continues");
            self.sent_bytes = (self.sent_bytes + self.ask.size()).min(self.ask.payload.len());
            assert!(number < 1 << 20 && exponent <= self.ask.exponent, "{answer:?}");
            self.ask.exponent = exponent;
            return Step::Send(self.upload(token));
        }
        match answer.block(option::BLOCK2) {
            Some((number, more, exponent)) => self.takes_block(answer, number, more, exponent, token),
            None => self.finish(answer, answer.payload.clone()),
        }
    }

    fn takes_block(&mut self, answer: &Message, number: u32, more: bool, exponent: u8, token: &[u8]) -> Step {
        let etag = answer.values(option::ETAG).first().map(|tag| tag.to_vec());
        let is_another = !self.body.is_empty() && self.etag != etag;
        self.etag = etag;
        let start = usize::try_from(number).expect("20 bits") << (exponent + 4);
        if is_another || start != self.body.len() {
            // The body changed while it was read, so reading starts again.
            self.body.clear();
            return Step::Send(self.download(0, exponent, token));
        }
        self.body.extend_from_slice(&answer.payload);
        if !more {
            let body = std::mem::take(&mut self.body);
            return self.finish(answer, body);
        }
        assert_eq!(answer.payload.len(), 16 << exponent, "a block that is followed by more is full: {answer:?}");
        Step::Send(self.download(self.body.len(), exponent.min(self.ask.exponent), token))
    }

    /// A request for the block that begins at this byte.
    pub(crate) fn download(&self, start: usize, exponent: u8, token: &[u8]) -> Message {
        let number = u32::try_from(start >> (exponent + 4)).expect("a short body");
        self.ask.head(0, token).block2((number, false, exponent))
    }

    fn finish(&mut self, answer: &Message, body: Vec<u8>) -> Step {
        self.outcome = Some(Outcome::Answered { code: answer.code, body, last: answer.clone() });
        Step::Done
    }
}
