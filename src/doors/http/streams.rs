//! Endless answers open at once, the console's and the interface's together: how many there may be, and how many of them one key.
//! What is sent in them is not here.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::access::{Access, Caller, Role};

/// Where keys tell people apart, one key has one in so many of all streams,
const PARTS: usize = 4;

/// and one in so many is kept for operators, who may not be there yet.
const KEPT: usize = 8;

/// The streams that are open. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct Streams {
    most: usize,
    open: Arc<Mutex<HashMap<Arc<str>, Open>>>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Open {
    number: usize,
    is_operator: bool,
}

/// One open stream; another may be opened when this is dropped.
pub(super) struct Stream {
    who: Arc<str>,
    streams: Streams,
}

impl Streams {
    /// So many, none of them open.
    pub(super) fn new(most: usize) -> Streams {
        Streams { most, open: Arc::default() }
    }

    /// How many there may be.
    pub(super) const fn most(&self) -> usize {
        self.most
    }

    /// Opens one for somebody; `None` when he has his share, or nobody can have one more.
    pub(super) fn open(&self, caller: &Caller, access: &Access) -> Option<Stream> {
        let (who, is_operator) = (caller.name(), caller.role() == Role::Operator);
        let most = self.most;
        let mut open = self.all();
        let of = |these: &dyn Fn(&Open) -> bool| open.values().filter(|open| these(open)).map(|open| open.number).sum::<usize>();
        let is_free = of(&|_| true) < most;
        let has_share = match access {
            Access::Open => true,
            Access::Keys(_) => {
                let own = open.get(&who).map_or(0, |open| open.number);
                own < most / PARTS && (is_operator || of(&|open| !open.is_operator) < most - most / KEPT)
            }
        };
        if !is_free || !has_share {
            return None;
        }
        let his = open.entry(Arc::clone(&who)).or_default();
        *his = Open { number: his.number + 1, is_operator };
        drop(open);
        Some(Stream { who, streams: self.clone() })
    }

    fn all(&self) -> MutexGuard<'_, HashMap<Arc<str>, Open>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        let mut open = self.streams.all();
        if let Some(his) = open.get_mut(&self.who) {
            his.number -= 1;
            if his.number == 0 {
                open.remove(&self.who);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::STREAMS;
    use super::*;
    use crate::access::{Keyring, Keys};

    /// Safety S9.
    #[test]
    fn one_key_has_its_share_and_some_streams_are_kept_for_operators() {
        let mut keys = Keys::first().unwrap();
        let names: Vec<String> = (0..4).map(|number| format!("viewer{number}")).collect();
        for name in &names {
            keys.add(name, Role::Viewer).unwrap();
        }
        let caller = |name: &str| Caller::Known(keys.check(keys.named(name).unwrap().token.reveal()).unwrap());
        let access = Access::Keys(Keyring::of(keys.clone()));
        let streams = Streams::new(STREAMS);
        let all = |name: &str| std::iter::from_fn(|| streams.open(&caller(name), &access)).take(1000).collect::<Vec<_>>();
        let viewers: Vec<_> = names.iter().map(|name| all(name)).collect();
        let counts: Vec<usize> = viewers.iter().map(Vec::len).collect();
        assert_eq!(counts, [64, 64, 64, 32], "a fourth each, and an eighth is kept");
        assert_eq!(all("operator").len(), 32);
        drop(viewers);
        assert_eq!(all("viewer0").len(), 64, "what is closed is free");
        assert!(streams.all().is_empty());
    }

    #[test]
    fn where_nobody_signs_in_there_are_no_shares() {
        let streams = Streams::new(STREAMS);
        let open: Vec<_> = std::iter::from_fn(|| streams.open(&Caller::Here, &Access::Open)).take(1000).collect();
        assert_eq!(open.len(), STREAMS);
    }
}
