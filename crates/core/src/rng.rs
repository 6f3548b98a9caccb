//! Reproducible random numbers from one seed. Each named purpose has its own stream. Drawing more numbers for one
//! purpose does not change the numbers for another purpose.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

#[derive(Clone, Debug)]
pub struct RandomStream(ChaCha8Rng);

impl RandomStream {
    #[must_use]
    pub fn new(seed: u64, purpose: &str) -> RandomStream {
        RandomStream(ChaCha8Rng::seed_from_u64(seed ^ fnv1a(purpose)))
    }

    pub fn number(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Returns a number in `0.0..1.0`.
    #[expect(clippy::cast_precision_loss, reason = "53 bits fit a double exactly")]
    pub fn fraction(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn happens(&mut self, probability: f64) -> bool {
        self.fraction() < probability
    }

    /// Returns a whole number below `bound`, which must not be zero.
    pub fn below(&mut self, bound: u64) -> u64 {
        self.0.next_u64() % bound.max(1)
    }

    /// Returns an approximately normal number with mean 0 and the given deviation: the sum of twelve uniform draws.
    pub fn normal(&mut self, deviation: f64) -> f64 {
        let sum: f64 = (0..12).map(|_| self.fraction()).sum();
        (sum - 6.0) * deviation
    }
}

/// Returns the FNV-1a hash of a text. It is good enough to distinguish random streams and behaviour trees.
pub(crate) fn fnv1a(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_and_purpose_draw_the_same_numbers() {
        let draw = |seed, purpose| RandomStream::new(seed, purpose).number();
        assert_eq!(draw(7, "sonar"), draw(7, "sonar"));
        assert_ne!(draw(7, "sonar"), draw(7, "camera"));
        assert_ne!(draw(7, "sonar"), draw(8, "sonar"));
    }

    #[test]
    fn a_fraction_stays_below_one() {
        let mut stream = RandomStream::new(1, "test");
        assert!((0..10_000).all(|_| (0.0..1.0).contains(&stream.fraction())));
    }
}
