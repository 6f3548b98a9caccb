//! Messages that go out to one client: how they are written, and those that it has not acknowledged yet, which go out again in the next
//! connection of its session (section 4.4). Which go out, and when, is decided elsewhere.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::frame::Kind;
use crate::limits::{SHARED, WINDOW, WINDOW_BYTES};
use crate::message::Message;
use crate::outbox::Outbox;
use crate::packet::{Qos, write};

/// What a client has not acknowledged, the oldest first.
#[derive(Debug, Default)]
pub(super) struct Unacknowledged {
    sent: VecDeque<Sent>,
    last_id: u16,
    /// How many of them were sent because they were kept.
    kept: usize,
    /// What they take.
    bytes: usize,
}

#[derive(Debug)]
struct Sent {
    id: u16,
    qos: Qos,
    why: Why,
    /// `None`: the client has it, and is to say that it knows that (PUBCOMP).
    message: Option<Arc<Message>>,
}

/// Why a message goes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Why {
    /// It was published just now.
    Published,
    /// It is kept, and the client asked for what is; only that is marked as such.
    Kept,
    /// It is kept, and the client has missed it.
    Missed,
}

impl Unacknowledged {
    /// Whether more may go out that is to be acknowledged.
    pub(super) fn has_window(&self) -> bool {
        self.sent.len() < WINDOW && self.bytes < WINDOW_BYTES
    }

    /// How many bytes the messages take, which others may have as well.
    pub(super) const fn bytes(&self) -> usize {
        self.bytes
    }

    /// Gives them all up; the stamp of the oldest, if there was one.
    pub(super) fn clear(&mut self) -> Option<u64> {
        let given_up = std::mem::take(self);
        given_up.sent.iter().filter_map(|sent| Some(sent.message.as_ref()?.stamp)).min()
    }

    /// How many of those that were sent because they were kept are not acknowledged.
    pub(super) const fn kept(&self) -> usize {
        self.kept
    }

    pub(super) fn send(&mut self, message: &Arc<Message>, qos: Qos, why: Why, out: &mut Outbox) {
        let id = if qos == Qos::Zero { 0 } else { self.next_id() };
        write(message, (qos, id), why, false, out);
        if qos > Qos::Zero {
            self.kept += usize::from(why != Why::Published);
            self.bytes += message.cost();
            self.sent.push_back(Sent { id, qos, why, message: Some(Arc::clone(message)) });
        }
    }

    /// In a new connection all goes out again.
    pub(super) fn resend(&self, out: &mut Outbox) {
        for Sent { id, qos, why, message } in &self.sent {
            match message {
                Some(message) => write(message, (*qos, *id), *why, true, out),
                None => write::ack(out.end(), Kind::Pubrel, *id),
            }
        }
    }

    /// The client has this one, whichever of the answers to one of its QoS this is: PUBACK, or PUBCOMP. What it was not sent does not matter.
    pub(super) fn acknowledged(&mut self, id: u16, kind: Kind) {
        let is_meant = |sent: &Sent| sent.id == id && (kind == Kind::Puback) == (sent.qos == Qos::One);
        if let Some(sent) = self.sent.iter().position(is_meant).and_then(|place| self.sent.remove(place)) {
            self.kept -= usize::from(sent.why != Why::Published);
            self.bytes -= sent.message.map_or(0, |message| message.cost());
        }
    }

    /// The client has this one of QoS 2, and is told that it need not remember that any longer.
    pub(super) fn received(&mut self, id: u16, out: &mut Outbox) {
        if let Some(sent) = self.sent.iter_mut().find(|sent| sent.id == id && sent.qos == Qos::Two) {
            self.bytes -= sent.message.take().map_or(0, |message| message.cost());
        }
        write::ack(out.end(), Kind::Pubrel, id);
    }

    /// The next id that no other message has.
    fn next_id(&mut self) -> u16 {
        loop {
            self.last_id = self.last_id % u16::MAX + 1;
            if self.sent.iter().all(|sent| sent.id != self.last_id) {
                return self.last_id;
            }
        }
    }
}

fn write(message: &Arc<Message>, (qos, id): (Qos, u16), why: Why, is_duplicate: bool, out: &mut Outbox) {
    let (topic, payload) = (message.topic().as_bytes(), message.payload());
    let head = write::PublishHead { topic, qos, id, retain: why == Why::Kept, is_duplicate };
    if payload.len() < SHARED {
        return head.with(out.end(), payload);
    }
    head.before(out.end(), payload.len());
    out.share(message.shared_payload());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_that_is_in_use_is_not_given_twice() {
        let (mut unacknowledged, mut out) = (Unacknowledged::default(), Outbox::default());
        let message = Arc::new(Message::new(Arc::from("a"), b"x", Qos::One, 0, &Arc::default()));
        for _ in 0..3 {
            unacknowledged.send(&message, Qos::One, Why::Published, &mut out);
        }
        unacknowledged.acknowledged(2, Kind::Puback);
        unacknowledged.last_id = u16::MAX;
        for expected in [2, 4] {
            unacknowledged.send(&message, Qos::One, Why::Published, &mut out);
            assert_eq!(unacknowledged.last_id, expected);
        }
    }
}
