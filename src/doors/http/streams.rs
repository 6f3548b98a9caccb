//! Endless answers of the console and the interface together: their maximum number, and the share of one key. Their contents are
//! not here.

use crate::access::{Access, Caller, Role};
use crate::doors::shares::{Limits, Permit, Shares};

/// With keys, the largest share of all streams for one key: one in this many.
const PARTS: usize = 4;

/// Share of streams reserved for operators, who may not be connected yet: one in this many.
const KEPT: usize = 8;

/// The open streams. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct Streams {
    all: Shares,
    viewers: Shares,
}

/// One open stream; its permit is returned when this is dropped.
pub(super) struct OpenStream {
    _of_all: Permit,
    _of_viewers: Option<Permit>,
}

impl Streams {
    /// Allows `most` streams at once.
    pub(super) fn new(most: usize) -> Streams {
        let of_these = |all| Shares::new(Limits { most: all, of_one_key: most / PARTS, kept: 0, few: 0 });
        Streams { all: of_these(most), viewers: of_these(most - most / KEPT) }
    }

    pub(super) fn most(&self) -> usize {
        self.all.most()
    }

    /// Opens a stream for a caller; `None` when the caller's share or all streams are used.
    pub(super) fn open(&self, caller: &Caller, access: &Access) -> Option<OpenStream> {
        let key = access.key_of(caller);
        let is_viewer = key.is_some() && caller.role() != Role::Operator;
        let of_viewers = if is_viewer { Some(self.viewers.take(None).ok()?) } else { None };
        Some(OpenStream { _of_all: self.all.take(key).ok()?, _of_viewers: of_viewers })
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
        let access = Access::Keys(Keyring::of(keys.clone()).unwrap());
        let streams = Streams::new(STREAMS);
        let all = |name: &str| std::iter::from_fn(|| streams.open(&caller(name), &access)).take(1000).collect::<Vec<_>>();
        let viewers: Vec<_> = names.iter().map(|name| all(name)).collect();
        let counts: Vec<usize> = viewers.iter().map(Vec::len).collect();
        assert_eq!(counts, [64, 64, 64, 32], "a fourth each, and an eighth is kept");
        assert_eq!(all("operator").len(), 32);
        drop(viewers);
        assert_eq!(all("viewer0").len(), 64, "what is closed is free");
        assert!(streams.all.knows_nobody());
    }

    #[test]
    fn where_nobody_signs_in_there_are_no_shares() {
        let streams = Streams::new(STREAMS);
        let open: Vec<_> = std::iter::from_fn(|| streams.open(&Caller::Here, &Access::Open)).take(1000).collect();
        assert_eq!(open.len(), STREAMS);
    }
}
