//! A bounded number of permits for requests, with a share for each key, and some reserved for keys that have few, so that nobody
//! goes without because of others (safety S9). Without a permit a request is refused; the rules by which somebody gives way
//! instead are in `http::places`, `mqtt::seats` and `vestibule`.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The number of permits, and the maximum for one key.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) most: usize,
    pub(super) of_one_key: usize,
    /// Number of permits reserved for keys that have few.
    pub(super) kept: usize,
    /// Number of permits below which a key has few; its share does not apply then.
    pub(super) few: usize,
}

/// All permits. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct Shares(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    limits: Limits,
    taken: Mutex<InUse>,
}

#[derive(Debug, Default)]
struct InUse {
    all: usize,
    /// Number of permits of each key that has any.
    by_key: HashMap<Arc<str>, usize>,
}

/// One permit, returned when this is dropped.
#[derive(Debug)]
pub(super) struct Permit {
    shares: Shares,
    key: Option<Arc<str>>,
}

impl Shares {
    pub(super) fn new(limits: Limits) -> Shares {
        Shares(Arc::new(Shared { limits, taken: Mutex::default() }))
    }

    pub(super) fn most(&self) -> usize {
        self.0.limits.most
    }

    /// Takes a permit for the owner of this key; without a key there are no shares.
    ///
    /// # Errors
    /// The number of permits taken of those that the key may have, when there is none.
    pub(super) fn take(&self, key: Option<Arc<str>>) -> Result<Permit, usize> {
        let Limits { most, of_one_key, kept, few } = self.0.limits;
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
        Ok(Permit { shares: self.clone(), key })
    }

    /// Whether no key is remembered.
    #[cfg(test)]
    pub(super) fn knows_nobody(&self) -> bool {
        self.taken().by_key.is_empty()
    }

    fn taken(&self) -> MutexGuard<'_, InUse> {
        self.0.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Permit {
    fn drop(&mut self) {
        let mut taken = self.shares.taken();
        taken.all -= 1;
        let Some((key, own)) = self.key.as_ref().and_then(|key| Some((key, taken.by_key.get_mut(key)?))) else { return };
        *own -= 1;
        if *own == 0 {
            taken.by_key.remove(key);
        }
    }
}
