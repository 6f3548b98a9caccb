//! Quotas of requests under way: so many at once, of which one key has its share, and some are reserved for keys that have few, so that
//! nobody goes without because of others (safety S9). Beyond the quota a request is refused. The quotas of streams and of results are
//! made of it.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// How many requests may be under way at once.
#[derive(Clone, Copy, Debug)]
pub(in crate::doors) struct QuotaLimits {
    pub(in crate::doors) most: usize,
    pub(in crate::doors) of_one_key: usize,
    /// How many of them are reserved for keys that have few.
    pub(in crate::doors) kept: usize,
    /// A key that has fewer than this has few.
    pub(in crate::doors) few: usize,
}

/// A quota, and what is under way. Cheap to clone.
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
    /// Of these, by each key that has any.
    by_key: HashMap<Arc<str>, usize>,
}

/// The permit of one request, which counts until this is dropped.
#[derive(Debug)]
pub(in crate::doors) struct Permit {
    quota: RequestQuota,
    key: Option<Arc<str>>,
}

impl RequestQuota {
    pub(in crate::doors) fn new(limits: QuotaLimits) -> RequestQuota {
        RequestQuota(Arc::new(Counted { limits, taken: Mutex::default() }))
    }

    pub(in crate::doors) fn most(&self) -> usize {
        self.0.limits.most
    }

    /// Admits a request of whoever has shown this key; without a key there are no shares.
    ///
    /// # Errors
    /// When it is refused, how many are under way of those that he may have.
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

    /// Whether nothing is remembered of any key.
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
