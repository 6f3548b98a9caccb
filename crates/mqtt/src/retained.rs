//! The retained messages of the broker: the latest one of each topic. Their number and bytes are bounded, in
//! total and for each key. `connection` decides who may retain a message, and sends the messages to subscribers.

use std::collections::{BTreeMap, HashMap};
use std::ops::Bound;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::filter::{Next, look, stem};
use super::limits::{
    KEPT, KEPT_BYTES, KEPT_LITTLE, KEPT_LITTLE_BYTES, KEPT_RESERVE, KEPT_RESERVE_BYTES, KEPT_SHARE, KEPT_SHARE_BYTES,
    PROGRAM_KEPT, PROGRAM_KEPT_BYTES,
};
use super::message::Message;
use super::rights::Payer;

#[derive(Debug, Default)]
pub(crate) struct Retained {
    shelf: Mutex<Shelf>,
    /// The stamp of the message that was retained last; 0 if none was.
    stamp: AtomicU64,
}

/// Progress through the retained messages that match one filter. Topics may be added and removed meanwhile.
#[derive(Debug)]
pub(crate) struct Walk {
    filter: Arc<str>,
    /// Only messages with a higher stamp are found.
    since: u64,
    /// The first topic that was not examined yet; `None` if all topics were examined.
    from: Option<String>,
}

/// Minimum time between two searches for expired messages. Such a search goes through all messages.
const BETWEEN_LOOKS: Duration = Duration::from_secs(1);

#[derive(Debug, Default)]
struct Shelf {
    kept: BTreeMap<Arc<str>, RetainedEntry>,
    /// The use of each key's share; keys without messages have no entry.
    shares: HashMap<Arc<str>, Used>,
    clients: Used,
    program: Used,
    /// How often the program has the room `PROGRAM_KEPT` and `PROGRAM_KEPT_BYTES`; 0 counts as 1.
    program_room: usize,
    /// No message expires before this time.
    first_over: Option<Duration>,
    /// No search for expired messages before this time.
    looks_at: Duration,
}

#[derive(Debug)]
struct RetainedEntry {
    message: Arc<Message>,
    /// The position of this message: later messages have higher stamps.
    stamp: u64,
    payer: Payer,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Used {
    count: usize,
    bytes: usize,
}

impl Retained {
    /// Retains a message in place of the topic's earlier one, or only removes the earlier one if the payload is
    /// empty. Returns whether there was room. Without room the topic retains nothing, because the earlier message is
    /// out of date.
    pub(crate) fn keep(&self, payer: &Payer, message: &Arc<Message>, now: Duration) -> bool {
        let mut shelf = self.shelf();
        shelf.remove(message.topic());
        if message.payload().is_empty() || message.is_over(now) {
            return true;
        }
        // Other threads read the stamp without the lock, and later look for messages with higher stamps. A message
        // that is retained after such a read always has a higher stamp.
        let stamp = self.stamp.fetch_add(1, Ordering::AcqRel) + 1;
        let entry = RetainedEntry { message: Arc::clone(message), stamp, payer: payer.clone() };
        match shelf.put(entry) {
            Ok(()) => true,
            Err(entry) => shelf.clear(now) && shelf.put(entry).is_ok(),
        }
    }

    /// The next message of a walk; it examines at most `steps` topics. `None` if the walk is over or no steps are
    /// left.
    pub(crate) fn next(&self, walk: &mut Walk, steps: &mut usize, now: Duration) -> Option<Arc<Message>> {
        let shelf = self.shelf();
        while *steps > 0 {
            let from = walk.from.take()?;
            *steps -= 1;
            let (topic, entry) = shelf.kept.range::<str, _>((Bound::Included(from.as_str()), Bound::Unbounded)).next()?;
            match look(&walk.filter, topic) {
                Next::Nowhere => return None,
                Next::From(later) => walk.from = Some(later),
                Next::Here => {
                    walk.from = Some(format!("{topic}\0"));
                    if entry.stamp > walk.since && !entry.message.is_over(now) {
                        return Some(Arc::clone(&entry.message));
                    }
                }
            }
        }
        None
    }

    /// A stamp that is lower than the stamp of any message retained from now on.
    pub(crate) fn stamp(&self) -> u64 {
        self.stamp.load(Ordering::Acquire)
    }

    pub(crate) fn set_program_room(&self, times: usize) {
        self.shelf().program_room = times;
    }

    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.shelf().kept.len()
    }

    /// Size of all retained messages in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let shelf = self.shelf();
        shelf.clients.bytes + shelf.program.bytes
    }

    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Walk {
    /// A walk over the messages that match the filter and have a higher stamp than `since`.
    pub(crate) fn new(filter: Arc<str>, since: u64) -> Walk {
        let from = Some(stem(&filter).to_owned());
        Walk { filter, since, from }
    }

    pub(crate) fn filter(&self) -> &str {
        &self.filter
    }

    pub(crate) const fn is_over(&self) -> bool {
        self.from.is_none()
    }
}

impl Shelf {
    fn remove(&mut self, topic: &str) {
        let Some(RetainedEntry { message, payer, .. }) = self.kept.remove(topic) else { return };
        let bytes = message.cost();
        self.pool(&payer).take_off(bytes);
        if let Payer::Key(name) = &payer
            && let Some(share) = self.shares.get_mut(name)
        {
            share.take_off(bytes);
            if share.count == 0 {
                self.shares.remove(name);
            }
        }
    }

    /// Removes expired messages, at most once in `BETWEEN_LOOKS`. Returns whether there were any.
    fn clear(&mut self, now: Duration) -> bool {
        if now < self.looks_at || self.first_over.is_none_or(|first| first > now) {
            return false;
        }
        // To search all messages is expensive, and to store an expired message a little longer is cheap.
        self.looks_at = now + BETWEEN_LOOKS;
        let over: Vec<_> =
            self.kept.values().filter(|entry| entry.message.is_over(now)).map(|entry| entry.message.shared_topic()).collect();
        over.iter().for_each(|topic| self.remove(topic));
        self.first_over = self.kept.values().filter_map(|entry| entry.message.expires_at()).min();
        !over.is_empty()
    }

    /// Stores a message if there is room both in total and in the share of its key; otherwise returns the message.
    fn put(&mut self, entry: RetainedEntry) -> Result<(), RetainedEntry> {
        let bytes = entry.message.cost();
        let share = match &entry.payer {
            Payer::Program | Payer::Anybody => Used::default(),
            Payer::Key(name) => self.shares.get(name).copied().unwrap_or_default(),
        };
        let (count_most, bytes_most) = match &entry.payer {
            Payer::Program => {
                let times = self.program_room.max(1);
                (times * PROGRAM_KEPT, times * PROGRAM_KEPT_BYTES)
            }
            Payer::Key(_) if !share.has_room(bytes, KEPT_LITTLE, KEPT_LITTLE_BYTES) => {
                (KEPT - KEPT_RESERVE, KEPT_BYTES - KEPT_RESERVE_BYTES)
            }
            Payer::Anybody | Payer::Key(_) => (KEPT, KEPT_BYTES),
        };
        if !self.pool(&entry.payer).has_room(bytes, count_most, bytes_most)
            || !share.has_room(bytes, KEPT_SHARE, KEPT_SHARE_BYTES)
        {
            return Err(entry);
        }
        self.first_over = [self.first_over, entry.message.expires_at()].into_iter().flatten().min();
        self.pool(&entry.payer).add(bytes);
        if let Payer::Key(name) = &entry.payer {
            self.shares.entry(Arc::clone(name)).or_default().add(bytes);
        }
        self.kept.insert(entry.message.shared_topic(), entry);
        Ok(())
    }

    const fn pool(&mut self, payer: &Payer) -> &mut Used {
        match payer {
            Payer::Program => &mut self.program,
            Payer::Anybody | Payer::Key(_) => &mut self.clients,
        }
    }
}

impl Used {
    const fn has_room(self, bytes: usize, count_most: usize, bytes_most: usize) -> bool {
        self.count < count_most && self.bytes + bytes <= bytes_most
    }

    const fn add(&mut self, bytes: usize) {
        self.count += 1;
        self.bytes += bytes;
    }

    const fn take_off(&mut self, bytes: usize) {
        self.count -= 1;
        self.bytes -= bytes;
    }
}

#[cfg(test)]
#[path = "retained_tests.rs"]
mod tests;
