//! Sends messages to one client, and stores the messages that the client has not acknowledged. Those go out again in
//! the next connection of the client's session (section 4.4). `client_writer` writes the packets. This file does not
//! decide which messages go out, and when.

use std::collections::VecDeque;
use std::time::Duration;

use super::client_writer::ClientWriter;
use crate::frame::PacketKind;
use crate::limits::{WINDOW, WINDOW_BYTES};
use crate::outbox::Outbox;
use crate::packet::Qos;
use crate::packet::reason::Reason;
use crate::subscriber::Delivery;

/// Messages that a client has not acknowledged, the oldest first: they go out again in this order (section 4.6).
#[derive(Debug, Default)]
pub(super) struct Unacknowledged {
    /// Messages sent in an earlier connection, and not sent again in this one yet.
    unsent: VecDeque<Sent>,
    sent: VecDeque<Sent>,
    /// Maximum number of messages in `sent`.
    window: usize,
    last_id: u16,
    /// Number of unacknowledged messages that were sent because they were retained.
    kept: usize,
    /// Size in bytes of the unacknowledged messages.
    bytes: usize,
}

#[derive(Debug)]
struct Sent {
    id: u16,
    cause: Cause,
    qos: Qos,
    /// `None` if the client has received the message, and only its PUBCOMP is missing.
    delivery: Option<Delivery>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    Published,
    /// The message was retained. Such messages have a smaller window, `KEPT_UNDER_WAY`.
    Kept,
}

impl Unacknowledged {
    /// Begins a new connection, in which at most `receive_maximum` messages may be unacknowledged. All unacknowledged
    /// messages are to go out again.
    pub(super) fn begin(&mut self, receive_maximum: u16) {
        self.window = WINDOW.min(usize::from(receive_maximum));
        // The messages in `sent` are older than those in `unsent`: the last connection sent the oldest messages
        // first.
        self.sent.append(&mut self.unsent);
        std::mem::swap(&mut self.sent, &mut self.unsent);
    }

    /// Whether another message that needs an acknowledgement may go out. Messages of earlier connections come first.
    pub(super) fn has_window(&self) -> bool {
        self.unsent.is_empty() && self.sent.len() < self.window && self.bytes < WINDOW_BYTES
    }

    /// Size in bytes of the unacknowledged messages. Other clients may share these messages.
    pub(super) const fn bytes(&self) -> usize {
        self.bytes
    }

    /// Drops all messages, and returns the stamp of the oldest one; `None` if there was none.
    pub(super) fn clear(&mut self) -> Option<u64> {
        let given_up = std::mem::take(self);
        let all = given_up.unsent.iter().chain(&given_up.sent);
        all.filter_map(|sent| Some(sent.delivery.as_ref()?.message.stamp)).min()
    }

    pub(super) const fn kept(&self) -> usize {
        self.kept
    }

    /// Sends a message. A message that is longer than the client accepts counts as sent (MQTT 5, section 3.1.2.11.4).
    /// A message on a topic that does not exist for the client is dropped, and leaves no gap in the ids.
    pub(super) fn send(&mut self, delivery: Delivery, cause: Cause, writer: &mut ClientWriter, out: &mut Outbox, now: Duration) {
        if !writer.may_write(delivery.message.topic()) {
            return;
        }
        let id = if delivery.qos == Qos::Zero { 0 } else { self.next_id() };
        let is_said = writer.publish(&delivery, id, false, now, out);
        if is_said && delivery.qos > Qos::Zero {
            self.kept += usize::from(cause == Cause::Kept);
            self.bytes += delivery.message.cost();
            self.sent.push_back(Sent { id, qos: delivery.qos, cause, delivery: Some(delivery) });
        }
    }

    /// Sends messages of earlier connections again, as far as the client's window allows. Since then the client may
    /// have lost the right to read some of them.
    pub(super) fn resend(&mut self, writer: &mut ClientWriter, out: &mut Outbox, now: Duration) {
        while let Some(next) = self.unsent.front() {
            match &next.delivery {
                Some(_) if self.sent.len() >= self.window => return,
                Some(delivery) => {
                    let is_over = delivery.message.is_over(now) || !writer.may_write(delivery.message.topic());
                    if is_over || !writer.publish(delivery, next.id, true, now, out) {
                        self.unsent.pop_front().into_iter().for_each(|sent| self.forget(sent));
                        continue;
                    }
                }
                None => writer.ack(PacketKind::Pubrel, next.id, Reason::Success, "", out),
            }
            self.sent.extend(self.unsent.pop_front());
        }
    }

    /// Handles a PUBACK, which ends a message of QoS 1, or a PUBCOMP, which ends a message of QoS 2. An unknown id is
    /// ignored.
    pub(super) fn acknowledged(&mut self, id: u16, kind: PacketKind) {
        let is_meant = |sent: &Sent| sent.id == id && (kind == PacketKind::Puback) == (sent.qos == Qos::One);
        if let Some(sent) = self.sent.iter().position(is_meant).and_then(|place| self.sent.remove(place)) {
            self.forget(sent);
        }
    }

    /// Handles a PUBREC. Answers with PUBREL, unless the client refused the message. A refused message needs no
    /// further packets.
    pub(super) fn received(&mut self, id: u16, is_refused: bool, writer: &mut ClientWriter, out: &mut Outbox) {
        if is_refused {
            return self.acknowledged(id, PacketKind::Pubcomp);
        }
        let sent = self.sent.iter_mut().find(|sent| sent.id == id && sent.qos == Qos::Two);
        let reason = if sent.is_some() { Reason::Success } else { Reason::UnknownId };
        if let Some(sent) = sent {
            self.bytes -= sent.delivery.take().map_or(0, |delivery| delivery.message.cost());
        }
        writer.ack(PacketKind::Pubrel, id, reason, "", out);
    }

    fn forget(&mut self, sent: Sent) {
        self.kept -= usize::from(sent.cause == Cause::Kept);
        self.bytes -= sent.delivery.map_or(0, |delivery| delivery.message.cost());
    }

    /// Returns the next id that no unacknowledged message has. Ids count from 1, and begin again after 65,535.
    fn next_id(&mut self) -> u16 {
        loop {
            self.last_id = self.last_id % u16::MAX + 1;
            if self.sent.iter().chain(&self.unsent).all(|sent| sent.id != self.last_id) {
                return self.last_id;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::message::{Draft, Message};

    #[test]
    fn an_id_that_is_in_use_is_not_given_twice() {
        let (mut unacknowledged, mut writer, mut out) = (Unacknowledged::default(), ClientWriter::default(), Outbox::default());
        unacknowledged.begin(u16::MAX);
        let message = Arc::new(Message::new(Draft::plain("a", b"x", Qos::One), 0, &Arc::default()));
        let delivery = Delivery { message, qos: Qos::One, retain: false, ids: None };
        let mut send = |unacknowledged: &mut Unacknowledged| {
            unacknowledged.send(delivery.clone(), Cause::Published, &mut writer, &mut out, Duration::ZERO);
        };
        (0..3).for_each(|_| send(&mut unacknowledged));
        unacknowledged.acknowledged(2, PacketKind::Puback);
        unacknowledged.last_id = u16::MAX;
        for expected in [2, 4] {
            send(&mut unacknowledged);
            assert_eq!(unacknowledged.last_id, expected);
        }
    }
}
