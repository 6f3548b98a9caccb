//! Endless answers open at once, the console's and the interface's together: how many there may be, and how many of them one key.
//! What is sent in them is not here.

use super::request_quota::{Permit, QuotaLimits, RequestQuota};
use crate::access::{Access, Caller, Role};

/// Where keys tell people apart, one key has one in so many of all streams,
const PARTS: usize = 4;

/// and one in so many is kept for operators, who may not be there yet.
const KEPT: usize = 8;

/// The streams that are open. Cheap to clone.
#[derive(Clone, Debug)]
pub(in crate::doors) struct StreamQuota {
    all: RequestQuota,
    viewers: RequestQuota,
}

/// One open stream; another may be opened when this is dropped.
pub(in crate::doors) struct OpenStream {
    _of_all: Permit,
    _of_viewers: Option<Permit>,
}

impl StreamQuota {
    /// So many, none of them open.
    pub(in crate::doors) fn new(most: usize) -> StreamQuota {
        let of_these = |all| RequestQuota::new(QuotaLimits { most: all, of_one_key: most / PARTS, kept: 0, few: 0 });
        StreamQuota { all: of_these(most), viewers: of_these(most - most / KEPT) }
    }

    /// How many there may be.
    pub(in crate::doors) fn most(&self) -> usize {
        self.all.most()
    }

    /// Opens one for somebody; `None` when he has his share, or nobody can have one more.
    pub(in crate::doors) fn open(&self, caller: &Caller, access: &Access) -> Option<OpenStream> {
        let key = access.key_of(caller);
        let is_viewer = key.is_some() && caller.role() != Role::Operator;
        let of_viewers = if is_viewer { Some(self.viewers.take(None).ok()?) } else { None };
        Some(OpenStream { _of_all: self.all.take(key).ok()?, _of_viewers: of_viewers })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::{Keyring, Keys};

    const STREAMS: usize = 256;

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
        let streams = StreamQuota::new(STREAMS);
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
        let streams = StreamQuota::new(STREAMS);
        let open: Vec<_> = std::iter::from_fn(|| streams.open(&Caller::Here, &Access::Open)).take(1000).collect();
        assert_eq!(open.len(), STREAMS);
    }
}
