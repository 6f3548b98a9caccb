//! Handles SUBSCRIBE and UNSUBSCRIBE: which filters a client holds.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{ClientConnection, Ended};
use crate::filter::{self, Shared, Unfit};
use crate::frame::{Malformed, PacketKind};
use crate::grant::Grant;
use crate::limits::{FILTER_BYTES, FILTERS};
use crate::packet::filters::{Filters, Options, RetainHandling};
use crate::packet::reason::Reason;
use crate::packet::{Version, write};

#[derive(Clone, Copy, Debug, thiserror::Error)]
enum NotTaken {
    #[error(transparent)]
    Unfit(#[from] Unfit),
    #[error("a connection may have at most {FILTERS} filters with {FILTER_BYTES} bytes in all")]
    Many,
    #[error("only clients of MQTT 5 can share subscriptions")]
    Shared,
    #[error("this filter may not be shared, or not by this client")]
    Ours,
}

impl NotTaken {
    const fn reason(self) -> Reason {
        match self {
            NotTaken::Unfit(_) => Reason::Filter,
            NotTaken::Many => Reason::Quota,
            NotTaken::Shared | NotTaken::Ours => Reason::SharedSubscriptions,
        }
    }
}

impl ClientConnection {
    pub(super) fn subscribe(&mut self, body: &[u8]) -> Result<(), Ended> {
        let filters = self.few(Filters::of_subscribe(body, self.writer.version()))?;
        let (mut codes, mut accepted, mut words) = (Vec::new(), BTreeMap::new(), String::new());
        for (filter, options) in filters {
            let was_held = self.subscription.held().contains_key(filter);
            let grant = Grant { options, id: filters.subscription_id };
            match self.accept(filter, grant) {
                Ok((name, is_shared)) => {
                    if wants_kept(options, was_held) && !is_shared {
                        accepted.insert(name, grant);
                    }
                    codes.push(options.qos as u8);
                }
                Err(why) => {
                    self.refusals.note(filter.as_bytes(), why, &self.broker.lines, self.now);
                    codes.push(match self.writer.version() {
                        Version::Three => write::REFUSED,
                        Version::Five => why.reason() as u8,
                    });
                    words = why.to_string();
                }
            }
        }
        // Sends the messages that came before the SUBSCRIBE, so that the result does not depend on which packets
        // arrived together.
        self.deliver();
        match self.writer.version() {
            Version::Three => write::suback(self.to_client.end(), filters.id, &codes),
            Version::Five => {
                let words = self.writer.words(&words);
                write::codes_five(self.to_client.end(), PacketKind::Suback, filters.id, &codes, words);
            }
        }
        for (filter, grant) in accepted {
            self.deliveries.start(filter, grant);
        }
        self.deliver();
        Ok(())
    }

    pub(super) fn unsubscribe(&mut self, body: &[u8]) -> Result<(), Ended> {
        let filters = self.few(Filters::of_unsubscribe(body, self.writer.version()))?;
        let mut codes = Vec::new();
        for (filter, _) in filters {
            let was_held = self.subscription.strike(filter);
            if was_held {
                self.deliveries.stop(filter);
            }
            let is_good = filter::share(filter).is_ok_and(|shared| shared.is_some() || filter::filter(filter).is_ok());
            codes.push(match (was_held, is_good) {
                (true, _) => Reason::Success,
                (false, true) => Reason::NoSubscription,
                (false, false) => Reason::Filter,
            } as u8);
        }
        match self.writer.version() {
            Version::Three => write::ack(self.to_client.end(), PacketKind::Unsuback, filters.id),
            Version::Five => write::codes_five(self.to_client.end(), PacketKind::Unsuback, filters.id, &codes, None),
        }
        Ok(())
    }

    /// Logs a packet with too many filters, before its error ends the connection.
    fn few<'a>(&mut self, filters: Result<Filters<'a>, Malformed>) -> Result<Filters<'a>, Ended> {
        if let Err(wrong @ Malformed::ManyFilters) = filters {
            self.refusals.note(b"", wrong, &self.broker.lines, self.now);
        }
        Ok(filters?)
    }

    /// Accepts a filter. If the client holds the filter already, it gets the new options. Returns the filter and
    /// whether it is shared, or why it was refused.
    fn accept(&mut self, filter: &str, grant: Grant) -> Result<(Arc<str>, bool), NotTaken> {
        let shared = filter::share(filter)?;
        match shared {
            None => filter::filter(filter)?,
            Some(_) if self.writer.version() == Version::Three => return Err(NotTaken::Shared),
            Some(Shared { filter, .. }) if !self.broker.may_share(self.tier, filter) => return Err(NotTaken::Ours),
            Some(_) => {}
        }
        if !self.subscription.has_room(filter) {
            return Err(NotTaken::Many);
        }
        Ok((self.subscription.hold(filter, grant), shared.is_some()))
    }
}

const fn wants_kept(options: Options, was_held: bool) -> bool {
    match options.kept {
        RetainHandling::Always => true,
        RetainHandling::New => !was_held,
        RetainHandling::Never => false,
    }
}
