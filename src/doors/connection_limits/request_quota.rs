//! Limits the number of open requests. Each key has a share. A part is reserved for keys with few open requests, so
//! that nobody is refused because of others (safety S9). Beyond the quota a request is refused. `StreamQuota` and
//! `ResultQuota` are built from `RequestQuota`.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::access::{Access, Caller, Role};

#[derive(Clone, Copy, Debug)]
pub(in crate::doors) struct QuotaLimits {
    pub(in crate::doors) most: usize,
    pub(in crate::doors) of_one_key: usize,
    /// Part of `most` that only keys with few open requests may use.
    pub(in crate::doors) kept: usize,
    /// A key has few open requests if it has fewer than this number.
    pub(in crate::doors) few: usize,
}

#[derive(Clone, Debug)]
pub(in crate::doors) struct RequestQuota(Arc<Counted>);

#[derive(Debug)]
struct Counted {
    limits: QuotaLimits,
    taken: Mutex<InUse>,
}

#[derive(Debug, Default)]
struct InUse {
    all: usize,
    /// Number of open requests of each key. Keys without open requests have no entry, so the table stays small.
    by_key: HashMap<Arc<str>, usize>,
}

/// The permit for one request. The request counts until this value is dropped.
#[derive(Debug)]
pub(in crate::doors) struct Permit {
    quota: RequestQuota,
    key: Option<Arc<str>>,
}

impl RequestQuota {
    pub(in crate::doors) fn new(limits: QuotaLimits) -> RequestQuota {
        RequestQuota(Arc::new(Counted { limits, taken: Mutex::default() }))
    }

    /// Admits one more request with this key. Requests without a key have no share, and may use the whole quota.
    ///
    /// # Errors
    /// The request is refused. If the share of the key is used up, the error is the number of open requests of the
    /// key. If the quota is used up, it is the number of all open requests.
    pub(in crate::doors) fn take(&self, key: Option<Arc<str>>) -> Result<Permit, usize> {
        let QuotaLimits { most, of_one_key, kept, few } = self.0.limits;
        let mut taken = self.taken();
        let own = key.as_ref().and_then(|key| taken.by_key.get(key)).copied().unwrap_or(0);
        let has_few = key.is_none() || own < few;
        let kept = if has_few { 0 } else { kept };
        if !has_few && own >= of_one_key {
            return Err(own);
        }
        if taken.all + kept >= most {
            return Err(taken.all);
        }
        taken.all += 1;
        if let Some(key) = &key {
            taken.by_key.insert(Arc::clone(key), own + 1);
        }
        drop(taken);
        Ok(Permit { quota: self.clone(), key })
    }

    /// Whether the table has no entries. Entries of keys without open requests must not stay.
    #[cfg(test)]
    pub(in crate::doors) fn knows_nobody(&self) -> bool {
        self.taken().by_key.is_empty()
    }

    fn taken(&self) -> MutexGuard<'_, InUse> {
        self.0.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Permit {
    fn drop(&mut self) {
        let mut taken = self.quota.taken();
        taken.all -= 1;
        let Some((key, own)) = self.key.as_ref().and_then(|key| Some((key, taken.by_key.get_mut(key)?))) else { return };
        *own -= 1;
        if *own == 0 {
            taken.by_key.remove(key);
        }
    }
}

/// Limits the open streams of the HTTP door, for the console and the API together. A key may have a fourth of all
/// streams. An eighth is reserved for operators, who may connect later. Cheap to clone.
#[derive(Clone, Debug)]
pub(in crate::doors) struct StreamQuota {
    all: RequestQuota,
    viewers: RequestQuota,
}

pub(in crate::doors) struct OpenStream {
    _of_all: Permit,
    _of_viewers: Option<Permit>,
}

impl StreamQuota {
    pub(in crate::doors) fn new(most: usize) -> StreamQuota {
        let quota = |all| RequestQuota::new(QuotaLimits { most: all, of_one_key: most / 4, kept: 0, few: 0 });
        StreamQuota { all: quota(most), viewers: quota(most - most / 8) }
    }

    pub(in crate::doors) fn most(&self) -> usize {
        self.all.0.limits.most
    }

    /// Opens a stream. Returns `None` if the share of the caller or the whole quota is used up.
    pub(in crate::doors) fn open(&self, caller: &Caller, access: &Access) -> Option<OpenStream> {
        let key = access.key_of(caller);
        let is_viewer = key.is_some() && caller.role() != Role::Operator;
        let of_viewers = if is_viewer { Some(self.viewers.take(None).ok()?) } else { None };
        Some(OpenStream { _of_all: self.all.take(key).ok()?, _of_viewers: of_viewers })
    }
}

/// Limits the results of MQTT commands that are not published yet. Operators and viewers have separate quotas. A key
/// may have half of its quota. A fourth is reserved for keys with fewer than eight open results. Cheap to clone.
#[derive(Clone, Debug)]
pub(in crate::doors) struct ResultQuota {
    operators: RequestQuota,
    viewers: RequestQuota,
}

impl ResultQuota {
    pub(in crate::doors) fn new(operators: usize, viewers: usize) -> ResultQuota {
        let quota = |most| RequestQuota::new(QuotaLimits { most, of_one_key: most / 2, kept: most / 4, few: 8 });
        ResultQuota { operators: quota(operators), viewers: quota(viewers) }
    }

    /// Admits the result of one more command with this key.
    ///
    /// # Errors
    /// The result is refused. If the share of the key is used up, the error is the number of open results of the key.
    /// If the quota is used up, it is the number of all open results.
    pub(in crate::doors) fn take(&self, is_viewer: bool, key: Option<Arc<str>>) -> Result<Permit, usize> {
        if is_viewer { &self.viewers } else { &self.operators }.take(key)
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
            keys.add(name, Role::Viewer, None).unwrap();
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

    const MOST: usize = 256;
    const VIEWERS: usize = 64;

    /// Whether the sender is a viewer, and the name of the sender's key.
    type Sender<'a> = (bool, Option<&'a str>);

    const VIEWER: Sender<'_> = (true, Some("screen"));
    const HERE: Sender<'_> = (false, None);

    fn operator(key: &str) -> Sender<'_> {
        (false, Some(key))
    }

    fn take(quota: &ResultQuota, (is_viewer, key): Sender<'_>) -> Result<Permit, usize> {
        quota.take(is_viewer, key.map(Arc::from))
    }

    /// Takes permits for this sender until one is refused, and returns them.
    fn all(quota: &ResultQuota, sender: Sender<'_>) -> Vec<Permit> {
        std::iter::from_fn(|| take(quota, sender).ok()).collect()
    }

    /// Safety S9.
    #[test]
    fn one_key_has_half_and_whoever_has_few_gets_results_though_others_take_all_they_can() {
        let quota = ResultQuota::new(MOST, VIEWERS);
        let greedy = all(&quota, operator("greedy"));
        let second = all(&quota, operator("second"));
        assert_eq!((greedy.len(), second.len()), (128, 64), "a fourth is kept");
        assert_eq!(take(&quota, operator("greedy")).unwrap_err(), 128);
        assert_eq!(take(&quota, operator("second")).unwrap_err(), 192);
        let few: Vec<_> = ["a", "b", "c", "d", "e", "f", "g", "h"].iter().map(|key| all(&quota, operator(key)).len()).collect();
        assert_eq!(few, [8; 8], "all that is kept, if it were kept for ever");
    }

    /// Safety S9.
    #[test]
    fn viewers_and_operators_take_no_results_of_each_other() {
        let quota = ResultQuota::new(MOST, VIEWERS);
        let viewers = all(&quota, VIEWER);
        assert_eq!(viewers.len(), 32);
        let alone = ResultQuota::new(MOST, VIEWERS);
        assert_eq!(all(&quota, operator("panel")).len(), all(&alone, operator("panel")).len());
        let _all = (0..MOST).filter_map(|n| take(&quota, operator(&n.to_string())).ok()).collect::<Vec<_>>();
        drop(viewers);
        assert_eq!(all(&quota, VIEWER).len(), 32);
    }

    #[test]
    fn where_nobody_shows_a_key_there_are_no_shares_and_a_permit_that_is_dropped_is_free() {
        let quota = ResultQuota::new(MOST, VIEWERS);
        for _ in 0..3 {
            assert_eq!(all(&quota, HERE).len(), MOST);
            assert_eq!(all(&quota, operator("panel")).len(), 128);
        }
        assert!(quota.operators.knows_nobody(), "nothing is remembered of who has none");
    }
}
