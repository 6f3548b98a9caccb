//! Places for results: of a command that is under way, or of an answer that waits to be published. Each key has a share of them,
//! some are kept for keys that have few, and viewers have places of their own, so that nobody has no result because of others
//! (safety S9). What is done where there is no place is said elsewhere.

use std::sync::Arc;

use super::request_quota::{Permit, QuotaLimits, RequestQuota};

/// Of all places of operators, or of viewers, one key has one in so many,
const PARTS: usize = 2;

/// and one in so many is kept for keys that have few,
const KEPT: usize = 4;

/// which is less than so many.
const FEW: usize = 8;

/// Places for those who act, and for those who only look. Cheap to clone.
#[derive(Clone, Debug)]
pub(in crate::doors) struct ResultQuota {
    operators: RequestQuota,
    viewers: RequestQuota,
}

impl ResultQuota {
    /// So many, and so many for viewers beside them.
    pub(in crate::doors) fn new(operators: usize, viewers: usize) -> ResultQuota {
        let shares = |most| RequestQuota::new(QuotaLimits { most, of_one_key: most / PARTS, kept: most / KEPT, few: FEW });
        ResultQuota { operators: shares(operators), viewers: shares(viewers) }
    }

    /// A place for the next command of whoever has shown this key.
    ///
    /// # Errors
    /// How many of those he may use are taken, when there is none.
    pub(in crate::doors) fn take(&self, is_viewer: bool, key: Option<Arc<str>>) -> Result<Permit, usize> {
        if is_viewer { &self.viewers } else { &self.operators }.take(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOST: usize = 256;
    const VIEWERS: usize = 64;

    /// Whether it is a viewer, and the name of its key.
    type Sender<'a> = (bool, Option<&'a str>);

    const VIEWER: Sender<'_> = (true, Some("screen"));
    const HERE: Sender<'_> = (false, None);

    fn operator(key: &str) -> Sender<'_> {
        (false, Some(key))
    }

    fn take(places: &ResultQuota, (is_viewer, key): Sender<'_>) -> Result<Permit, usize> {
        places.take(is_viewer, key.map(Arc::from))
    }

    /// As many places as this sender gets.
    fn all(places: &ResultQuota, sender: Sender<'_>) -> Vec<Permit> {
        std::iter::from_fn(|| take(places, sender).ok()).collect()
    }

    /// Safety S9.
    #[test]
    fn one_key_has_half_and_whoever_has_few_gets_places_though_others_take_all_they_can() {
        let places = ResultQuota::new(MOST, VIEWERS);
        let greedy = all(&places, operator("greedy"));
        let second = all(&places, operator("second"));
        assert_eq!((greedy.len(), second.len()), (128, 64), "a fourth is kept");
        assert_eq!(take(&places, operator("greedy")).unwrap_err(), 128);
        assert_eq!(take(&places, operator("second")).unwrap_err(), 192);
        let few: Vec<_> = ["a", "b", "c", "d", "e", "f", "g", "h"].iter().map(|key| all(&places, operator(key)).len()).collect();
        assert_eq!(few, [8; 8], "all that is kept, if it were kept for ever");
    }

    /// Safety S9.
    #[test]
    fn viewers_and_operators_take_no_places_of_each_other() {
        let places = ResultQuota::new(MOST, VIEWERS);
        let viewers = all(&places, VIEWER);
        assert_eq!(viewers.len(), 32);
        let alone = ResultQuota::new(MOST, VIEWERS);
        assert_eq!(all(&places, operator("panel")).len(), all(&alone, operator("panel")).len());
        let _all = (0..MOST).filter_map(|n| take(&places, operator(&n.to_string())).ok()).collect::<Vec<_>>();
        drop(viewers);
        assert_eq!(all(&places, VIEWER).len(), 32);
    }

    #[test]
    fn where_nobody_shows_a_key_there_are_no_shares_and_a_place_that_is_left_is_free() {
        let places = ResultQuota::new(MOST, VIEWERS);
        for _ in 0..3 {
            assert_eq!(all(&places, HERE).len(), MOST);
            assert_eq!(all(&places, operator("panel")).len(), 128);
        }
        assert!(places.operators.knows_nobody(), "nothing is remembered of who has none");
    }
}
