//! Reproducible random numbers: one secret gives the same numbers in every run, and each purpose has its own series.
//! Do not use these numbers as secrets: `guard` makes the values that must not be guessed.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

#[derive(Clone, Debug)]
pub(super) struct Chance(ChaCha8Rng);

#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose {
    /// The random part of the times between retransmissions (RFC 7252, section 4.2).
    Spread,
    MessageIds,
}

impl Chance {
    pub(super) fn new(seed: u64, purpose: Purpose) -> Chance {
        let mut numbers = ChaCha8Rng::seed_from_u64(seed);
        numbers.set_stream(purpose as u64);
        Chance(numbers)
    }

    /// Returns the next random number in `0.0..1.0`.
    #[expect(clippy::cast_precision_loss, reason = "53 bits fit a double exactly")]
    pub(super) fn fraction(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn number(&mut self) -> u16 {
        (self.0.next_u64() >> 48) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_and_purpose_draw_the_same_numbers() {
        let draw = |seed, purpose| {
            let mut chance = Chance::new(seed, purpose);
            [(); 4].map(|()| chance.number())
        };
        assert_eq!(draw(7, Purpose::Spread), draw(7, Purpose::Spread));
        assert_ne!(draw(7, Purpose::Spread), draw(7, Purpose::MessageIds));
        assert_ne!(draw(7, Purpose::Spread), draw(8, Purpose::Spread));
    }

    #[test]
    fn a_fraction_stays_below_one() {
        let mut chance = Chance::new(1, Purpose::Spread);
        assert!((0..10_000).all(|_| (0.0..1.0).contains(&chance.fraction())));
    }
}
