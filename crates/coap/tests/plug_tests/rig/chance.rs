//! Randomness of the tests that comes back: one seed, and for each purpose numbers of its own by name.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

/// Random numbers for one purpose.
pub(crate) struct Chance(ChaCha8Rng);

impl Chance {
    /// The numbers for `purpose` under `seed`.
    pub(crate) fn new(seed: u64, purpose: &str) -> Chance {
        // FNV-1a: enough to set the purposes apart.
        let mix = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        Chance(ChaCha8Rng::seed_from_u64(seed ^ purpose.bytes().fold(0xcbf2_9ce4_8422_2325, mix)))
    }

    /// A whole number, each as likely.
    pub(crate) fn number(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A number in `0.0..1.0`.
    #[expect(clippy::cast_precision_loss, reason = "53 bits fit a double exactly")]
    pub(crate) fn fraction(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Whether something of this probability happens.
    pub(crate) fn happens(&mut self, probability: f64) -> bool {
        self.fraction() < probability
    }

    /// A whole number below `bound`, which must not be zero.
    pub(crate) fn below(&mut self, bound: u64) -> u64 {
        self.0.next_u64() % bound
    }
}
