//! Places for results: of a command that is under way, or of an answer that waits to be published. Each key has a share of them,
//! some are kept for keys that have few, and viewers have places of their own, so that nobody has no result because of others
//! (safety S9). What is done where there is no place is said elsewhere.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::sender::CommandSender;

/// Of all places of operators, or of viewers, one key has one in so many,
const PARTS: usize = 2;

/// and one in so many is kept for keys that have few,
const KEPT: usize = 4;

/// which is less than so many.
const FEW: usize = 8;

/// Places for those who act, and for those who only look. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct Places(Arc<Mutex<Taken>>);

#[derive(Debug)]
struct Taken {
    operators: Room,
    viewers: Room,
}

#[derive(Debug)]
struct Room {
    most: usize,
    taken: usize,
    /// Of these, by each key that has any.
    keys: HashMap<Arc<str>, usize>,
}

/// One place; free again when it is dropped.
#[derive(Debug)]
pub(super) struct Place {
    places: Places,
    is_viewers: bool,
    key: Option<Arc<str>>,
}

impl Places {
    /// So many, and so many for viewers beside them.
    pub(super) fn new(operators: usize, viewers: usize) -> Places {
        let room = |most| Room { most, taken: 0, keys: HashMap::new() };
        Places(Arc::new(Mutex::new(Taken { operators: room(operators), viewers: room(viewers) })))
    }

    /// A place for this sender's next command.
    ///
    /// # Errors
    /// How many of those he may use are taken, when there is none.
    pub(super) fn take(&self, sender: &CommandSender) -> Result<Place, usize> {
        let (is_viewers, key) = (sender.is_viewer(), sender.key());
        self.taken().room(is_viewers).take(key.as_ref())?;
        Ok(Place { places: self.clone(), is_viewers, key })
    }

    fn taken(&self) -> MutexGuard<'_, Taken> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Taken {
    const fn room(&mut self, is_viewers: bool) -> &mut Room {
        if is_viewers { &mut self.viewers } else { &mut self.operators }
    }
}

impl Room {
    /// Takes one, where no key was shown none's share.
    fn take(&mut self, key: Option<&Arc<str>>) -> Result<(), usize> {
        let own = key.and_then(|key| self.keys.get(key)).copied().unwrap_or(0);
        let has_more_than_few = key.is_some() && own >= FEW;
        if has_more_than_few && own >= self.most / PARTS {
            return Err(own);
        }
        let kept = if has_more_than_few { self.most / KEPT } else { 0 };
        if self.taken + kept >= self.most {
            return Err(self.taken);
        }
        self.taken += 1;
        if let Some(key) = key {
            self.keys.insert(Arc::clone(key), own + 1);
        }
        Ok(())
    }

    fn give_back(&mut self, key: Option<&Arc<str>>) {
        self.taken -= 1;
        let Some((key, own)) = key.and_then(|key| Some((key, self.keys.get_mut(key)?))) else { return };
        *own -= 1;
        if *own == 0 {
            self.keys.remove(key);
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.taken().room(self.is_viewers).give_back(self.key.as_ref());
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{here, operator, viewer};
    use super::*;

    const MOST: usize = 256;
    const VIEWERS: usize = 64;

    /// As many places as this sender gets.
    fn all(places: &Places, sender: &CommandSender) -> Vec<Place> {
        std::iter::from_fn(|| places.take(sender).ok()).collect()
    }

    /// Safety S9.
    #[test]
    fn one_key_has_half_and_whoever_has_few_gets_places_though_others_take_all_they_can() {
        let places = Places::new(MOST, VIEWERS);
        let greedy = all(&places, &operator("greedy"));
        let second = all(&places, &operator("second"));
        assert_eq!((greedy.len(), second.len()), (128, 64), "a fourth is kept");
        assert_eq!(places.take(&operator("greedy")).unwrap_err(), 128);
        assert_eq!(places.take(&operator("second")).unwrap_err(), 192);
        let few: Vec<_> = ["a", "b", "c", "d", "e", "f", "g", "h"].iter().map(|key| all(&places, &operator(key)).len()).collect();
        assert_eq!(few, [8; 8], "all that is kept, if it were kept for ever");
    }

    /// Safety S9.
    #[test]
    fn viewers_and_operators_take_no_places_of_each_other() {
        let places = Places::new(MOST, VIEWERS);
        let viewers = all(&places, &viewer());
        assert_eq!(viewers.len(), 32);
        let alone = Places::new(MOST, VIEWERS);
        assert_eq!(all(&places, &operator("panel")).len(), all(&alone, &operator("panel")).len());
        let _all = (0..MOST).filter_map(|n| places.take(&operator(&n.to_string())).ok()).collect::<Vec<_>>();
        drop(viewers);
        assert_eq!(all(&places, &viewer()).len(), 32);
    }

    #[test]
    fn where_nobody_shows_a_key_there_are_no_shares_and_a_place_that_is_left_is_free() {
        let places = Places::new(MOST, VIEWERS);
        for _ in 0..3 {
            assert_eq!(all(&places, &here()).len(), MOST);
            assert_eq!(all(&places, &operator("panel")).len(), 128);
        }
        assert!(places.taken().operators.keys.is_empty(), "nothing is remembered of who has none");
    }
}
