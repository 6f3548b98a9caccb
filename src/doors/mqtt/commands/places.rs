//! Places for results: of a command under way, or of an answer that waits to be published. Each key has a share, some places are
//! reserved for keys that have few, and viewers have places of their own, so that nobody is left without a result because of
//! others (safety S9). Callers decide what happens without a place.

use super::publisher::Publisher;
use crate::doors::shares::{Limits, Permit, Shares};

/// Share of one key among the places of operators, or of viewers: one in this many.
const PARTS: usize = 2;

/// Share of places reserved for keys that have few: one in this many.
const KEPT: usize = 4;

/// Number of places below which a key has few.
const FEW: usize = 8;

/// Places for operators, and for viewers. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct ResultPlaces {
    operators: Shares,
    viewers: Shares,
}

impl ResultPlaces {
    /// Creates this many places for operators, and for viewers.
    pub(super) fn new(operators: usize, viewers: usize) -> ResultPlaces {
        let shares = |most| Shares::new(Limits { most, of_one_key: most / PARTS, kept: most / KEPT, few: FEW });
        ResultPlaces { operators: shares(operators), viewers: shares(viewers) }
    }

    /// A place for this sender's next command.
    ///
    /// # Errors
    /// The number of places taken of those the sender may use, when none is free.
    pub(super) fn take(&self, publisher: &Publisher) -> Result<Permit, usize> {
        if publisher.is_viewer() { &self.viewers } else { &self.operators }.take(publisher.key())
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{here, operator, viewer};
    use super::*;

    const MOST: usize = 256;
    const VIEWERS: usize = 64;

    /// As many places as this sender can get.
    fn all(places: &ResultPlaces, publisher: &Publisher) -> Vec<Permit> {
        std::iter::from_fn(|| places.take(publisher).ok()).collect()
    }

    /// Safety S9.
    #[test]
    fn one_key_has_half_and_whoever_has_few_gets_places_though_others_take_all_they_can() {
        let places = ResultPlaces::new(MOST, VIEWERS);
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
        let places = ResultPlaces::new(MOST, VIEWERS);
        let viewers = all(&places, &viewer());
        assert_eq!(viewers.len(), 32);
        let alone = ResultPlaces::new(MOST, VIEWERS);
        assert_eq!(all(&places, &operator("panel")).len(), all(&alone, &operator("panel")).len());
        let _all = (0..MOST).filter_map(|n| places.take(&operator(&n.to_string())).ok()).collect::<Vec<_>>();
        drop(viewers);
        assert_eq!(all(&places, &viewer()).len(), 32);
    }

    #[test]
    fn where_nobody_shows_a_key_there_are_no_shares_and_a_place_that_is_left_is_free() {
        let places = ResultPlaces::new(MOST, VIEWERS);
        for _ in 0..3 {
            assert_eq!(all(&places, &here()).len(), MOST);
            assert_eq!(all(&places, &operator("panel")).len(), 128);
        }
        assert!(places.operators.knows_nobody(), "nothing is remembered of who has none");
    }
}
