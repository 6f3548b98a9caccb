//! What the router sends: messages, and answers to what the gate asked. Anything else is not it.

use std::sync::atomic::Ordering;

use bytes::{Buf, Bytes, BytesMut};

use super::{ClientConnection, Ended};
use crate::frame::{Frame, Kind, frame};
use crate::limits::PROGRAM_PACKET;
use crate::packet::publish::{self, Publish};
use crate::packet::{Qos, ack, write};
use crate::subscriber_lag::weight;

/// A message that goes out at QoS 1 is longer by its id than it was at QoS 0, and its length may need a byte more.
const LONGEST: usize = PROGRAM_PACKET + 3;

enum ForClient<'a> {
    AsItIs,
    /// A message that had to be padded, or that it may know.
    Changed(Publish<'a>, bool),
    /// A long message, of which this came, and which it may know.
    Parcel(Publish<'a>, Bytes, bool),
    Nothing,
}

impl ClientConnection {
    /// All whole packets from the head of what the router sent. What goes to the client as it is, goes in runs.
    pub(super) fn router_packets(&mut self, bytes: &mut BytesMut) -> Result<(), Ended> {
        let (mut read, mut run, mut came) = (0, 0, 0);
        let outcome = loop {
            let frame = match frame(&bytes[read..], LONGEST) {
                Ok(None) => break Ok(()),
                Err(wrong) => break Err(Ended::RouterMalformed(wrong)),
                Ok(Some(frame)) => frame,
            };
            let end = read + frame.length;
            let for_client = match self.for_client(&frame, &bytes[read..end], &mut came) {
                Ok(for_client) => for_client,
                Err(ended) => break Err(ended),
            };
            if !matches!(for_client, ForClient::AsItIs) {
                self.to_client.end().extend_from_slice(&bytes[run..read]);
                run = end;
            }
            match for_client {
                ForClient::AsItIs => {}
                ForClient::Changed(publish, is_duplicate) => {
                    write::publish_again(self.to_client.end(), &publish, is_duplicate);
                }
                ForClient::Parcel(publish, payload, is_duplicate) => {
                    write::publish_head_again(self.to_client.end(), &publish, payload.len(), is_duplicate);
                    self.to_client.share(payload);
                }
                ForClient::Nothing => {
                    if let Err(ended) = self.answered(&frame, &bytes[read + frame.head..end]) {
                        break Err(ended);
                    }
                }
            }
            read = end;
        };
        self.to_client.end().extend_from_slice(&bytes[run..read.max(run)]);
        bytes.advance(read.max(run));
        if came > 0 {
            self.lag_guard.lag().came(came);
            self.broker.came.fetch_add(1, Ordering::Relaxed);
            self.quiet_at = None;
        }
        outcome
    }

    /// What of this is for the client; its id is noted, and what it counts.
    fn for_client<'a>(&mut self, frame: &Frame, packet: &'a [u8], came: &mut i64) -> Result<ForClient<'a>, Ended> {
        if frame.kind != Kind::Publish {
            return Ok(ForClient::Nothing);
        }
        let (publish, label) = publish::read_padded(frame, packet).map_err(Ended::RouterMalformed)?;
        let length = label.map_or(publish.payload.len(), |label| usize::try_from(label.length).unwrap_or(usize::MAX));
        *came += weight(publish.topic.len(), length);
        let lag = self.lag_guard.lag();
        let parcel = label.and_then(|label| lag.parcel(label));
        let is_seen = self.broker.rights.may_see(self.principal, publish.topic) && parcel.is_some() == label.is_some();
        let payload = parcel.as_deref().unwrap_or(publish.payload);
        let number = label.map(|label| label.number);
        let is_duplicate = match publish.qos {
            Qos::Zero => {
                number.inspect(|number| lag.received(*number));
                false
            }
            Qos::One => {
                let print = is_seen.then(|| self.broker.budget.print((publish.topic, payload)));
                self.outstanding.sent((publish.id, number), print)?
            }
            Qos::Two => return Err(Ended::Router("a message of QoS 2, for which nobody has asked")),
        };
        Ok(match (is_seen, parcel) {
            (false, _) => ForClient::Nothing,
            (true, Some(payload)) => ForClient::Parcel(publish, payload, is_duplicate),
            (true, None) if is_duplicate || frame.flags & publish::PADDED != 0 => ForClient::Changed(publish, is_duplicate),
            (true, None) => ForClient::AsItIs,
        })
    }

    /// What is not for the client as it is.
    fn answered(&mut self, frame: &Frame, body: &[u8]) -> Result<(), Ended> {
        match frame.kind {
            Kind::Publish => self.acknowledge(),
            Kind::Suback => self.subscribed(ack::read_suback(body).map_err(Ended::RouterMalformed)?.1)?,
            Kind::Unsuback => self.unsubscribed()?,
            Kind::Pingresp => self.is_pinged = false,
            Kind::Connect
            | Kind::Connack
            | Kind::Puback
            | Kind::Pubrec
            | Kind::Pubrel
            | Kind::Pubcomp
            | Kind::Subscribe
            | Kind::Unsubscribe
            | Kind::Pingreq
            | Kind::Disconnect => return Err(Ended::Router("an answer to what it was not asked")),
        }
        Ok(())
    }
}
