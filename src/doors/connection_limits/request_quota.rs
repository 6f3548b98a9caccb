//! Places for what somebody has asked for: so many at once, of which one key has its share, and some are kept for keys that have few, so
//! that nobody goes without because of others (safety S9). Whoever finds none is refused; where somebody gives way instead stands in
//! `http::places`, `session_limits` and `pending_connections`.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// How many places there are, and how many of them a key may have.
#[derive(Clone, Copy, Debug)]
pub(in crate::doors) struct Limits {
    pub(in crate::doors) most: usize,
    pub(in crate::doors) of_one_key: usize,
    /// So many are kept for keys that have few,
    pub(in crate::doors) kept: usize,
    /// which is less than so many: they have no share yet.
    pub(in crate::doors) few: usize,
}

/// All places. Cheap to clone.
#[derive(Clone, Debug)]
pub(in crate::doors) struct Shares(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    limits: Limits,
    taken: Mutex<InUse>,
}

#[derive(Debug, Default)]
struct InUse {
    all: usize,
    /// Of these, by each key that has any.
    by_key: HashMap<Arc<str>, usize>,
}

/// One place; free again when this is dropped.
#[derive(Debug)]
pub(in crate::doors) struct Permit {
    shares: Shares,
    key: Option<Arc<str>>,
}

impl Shares {
    pub(in crate::doors) fn new(limits: Limits) -> Shares {
        Shares(Arc::new(Shared { limits, taken: Mutex::default() }))
    }

    /// How many there are.
    pub(in crate::doors) fn most(&self) -> usize {
        self.0.limits.most
    }

    /// A place for whoever has shown this key; where nobody shows one there are no shares.
    ///
    /// # Errors
    /// How many are taken of those that he may have, when there is none.
    pub(in crate::doors) fn take(&self, key: Option<Arc<str>>) -> Result<Permit, usize> {
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
        let mut taken = self.shares.taken();
        taken.all -= 1;
        let Some((key, own)) = self.key.as_ref().and_then(|key| Some((key, taken.by_key.get_mut(key)?))) else { return };
        *own -= 1;
        if *own == 0 {
            taken.by_key.remove(key);
        }
    }
}
