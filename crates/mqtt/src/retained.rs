//! The kept messages of the whole broker: the last one of each topic that was to be kept, bounded in number and bytes, for all and for
//! each key. The router knows none of them. Who may put one here, and how they come to a subscriber, stands in `connection`.

use std::collections::{BTreeMap, HashMap};
use std::ops::Bound;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bytes::Bytes;

use super::budget::Payer;
use super::filter::{Next, look, stem};
use super::limits::{
    KEPT, KEPT_BYTES, KEPT_COST, KEPT_LITTLE, KEPT_LITTLE_BYTES, KEPT_RESERVE, KEPT_RESERVE_BYTES, KEPT_SHARE, KEPT_SHARE_BYTES,
    PROGRAM_KEPT, PROGRAM_KEPT_BYTES,
};
use super::packet::Qos;

#[derive(Debug, Default)]
pub(crate) struct Retained {
    shelf: Mutex<Shelf>,
    /// That of the latest one.
    stamp: AtomicU64,
    /// The bytes of all payloads that anybody has still.
    alive: Arc<AtomicUsize>,
}

/// A payload, counted for as long as anybody has it.
struct Counted {
    payload: Box<[u8]>,
    alive: Arc<AtomicUsize>,
}

#[derive(Debug, PartialEq, Eq)]
pub(crate) struct RetainedMessage {
    pub(crate) topic: Arc<str>,
    pub(crate) payload: Bytes,
    pub(crate) qos: Qos,
    /// Later ones have higher ones.
    stamp: u64,
}

/// How far what is kept for one filter was gone through. Topics that come and go meanwhile do not matter.
#[derive(Debug)]
pub(crate) struct Walk {
    filter: Arc<str>,
    /// Only what was kept after this.
    since: u64,
    /// The next topic is this one or a later one; `None`: there is none.
    from: Option<String>,
}

#[derive(Debug, Default)]
struct Shelf {
    kept: BTreeMap<Arc<str>, Entry>,
    /// What each key keeps; it has no line here when that is nothing.
    shares: HashMap<Arc<str>, Used>,
    clients: Used,
    program: Used,
    /// The bytes of all payloads here.
    payloads: usize,
}

#[derive(Debug)]
struct Entry {
    kept: Arc<RetainedMessage>,
    payer: Payer,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Used {
    count: usize,
    bytes: usize,
}

impl Retained {
    #[cfg(test)]
    pub(crate) fn keep(&self, payer: &Payer, topic: &str, payload: &[u8], qos: Qos) -> bool {
        self.keep_shared(payer, topic, self.share(payload), qos)
    }

    /// Keeps a message, which others may have as well, in the place of the one that was there; an empty one takes that away. Whether
    /// there was room: without it nothing is kept there any more, since what was is not so now.
    pub(crate) fn keep_shared(&self, payer: &Payer, topic: &str, payload: Bytes, qos: Qos) -> bool {
        let mut shelf = self.shelf();
        shelf.remove(topic);
        if payload.is_empty() {
            return true;
        }
        // Whoever reads it without the lock does so to know what came later, and that has a higher one in any case.
        let stamp = self.stamp.fetch_add(1, Ordering::AcqRel) + 1;
        let topic: Arc<str> = Arc::from(topic);
        shelf.put(payer, RetainedMessage { topic, payload, qos, stamp })
    }

    /// The next one of a walk, which goes on for no more steps than there are left; without one it is over, or they are used up.
    pub(crate) fn next(&self, walk: &mut Walk, steps: &mut usize) -> Option<Arc<RetainedMessage>> {
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
                    if entry.kept.stamp > walk.since {
                        return Some(Arc::clone(&entry.kept));
                    }
                }
            }
        }
        None
    }

    /// What is kept from now on is later than this.
    pub(crate) fn stamp(&self) -> u64 {
        self.stamp.load(Ordering::Acquire)
    }

    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.shelf().kept.len()
    }

    pub(crate) fn bytes(&self) -> usize {
        let shelf = self.shelf();
        shelf.clients.bytes + shelf.program.bytes
    }

    /// How many bytes of payloads wait for clients that have not read them, and are not kept, or not any more.
    pub(crate) fn beside(&self) -> usize {
        let kept = self.shelf().payloads;
        self.alive.load(Ordering::Relaxed).saturating_sub(kept)
    }

    /// A payload that several may have; it counts until nobody has it.
    pub(crate) fn share(&self, payload: &[u8]) -> Bytes {
        self.alive.fetch_add(payload.len(), Ordering::Relaxed);
        Bytes::from_owner(Counted { payload: payload.into(), alive: Arc::clone(&self.alive) })
    }

    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl AsRef<[u8]> for Counted {
    fn as_ref(&self) -> &[u8] {
        &self.payload
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.alive.fetch_sub(self.payload.len(), Ordering::Relaxed);
    }
}

impl RetainedMessage {
    fn cost(&self) -> usize {
        KEPT_COST + self.topic.len() + self.payload.len()
    }
}

impl Walk {
    /// From the first one on, of those that were kept after this stamp.
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
        let Some(Entry { kept, payer }) = self.kept.remove(topic) else { return };
        let bytes = kept.cost();
        self.payloads -= kept.payload.len();
        self.pool(&payer).take_off(bytes);
        if let Payer::Key { name, .. } = &payer
            && let Some(share) = self.shares.get_mut(name)
        {
            share.take_off(bytes);
            if share.count == 0 {
                self.shares.remove(name);
            }
        }
    }

    /// Whether there was room in the pool, and in the payer's share of it.
    fn put(&mut self, payer: &Payer, kept: RetainedMessage) -> bool {
        let bytes = kept.cost();
        let share = match payer {
            Payer::Program | Payer::Anybody => Used::default(),
            Payer::Key { name, .. } => self.shares.get(name).copied().unwrap_or_default(),
        };
        let (count_most, bytes_most) = match payer {
            Payer::Program => (PROGRAM_KEPT, PROGRAM_KEPT_BYTES),
            Payer::Key { .. } if !share.has_room(bytes, KEPT_LITTLE, KEPT_LITTLE_BYTES) => {
                (KEPT - KEPT_RESERVE, KEPT_BYTES - KEPT_RESERVE_BYTES)
            }
            Payer::Anybody | Payer::Key { .. } => (KEPT, KEPT_BYTES),
        };
        if !self.pool(payer).has_room(bytes, count_most, bytes_most) || !share.has_room(bytes, KEPT_SHARE, KEPT_SHARE_BYTES) {
            return false;
        }
        self.payloads += kept.payload.len();
        self.pool(payer).add(bytes);
        if let Payer::Key { name, .. } = payer {
            self.shares.entry(Arc::clone(name)).or_default().add(bytes);
        }
        self.kept.insert(Arc::clone(&kept.topic), Entry { kept: Arc::new(kept), payer: payer.clone() });
        true
    }

    const fn pool(&mut self, payer: &Payer) -> &mut Used {
        match payer {
            Payer::Program => &mut self.program,
            Payer::Anybody | Payer::Key { .. } => &mut self.clients,
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
