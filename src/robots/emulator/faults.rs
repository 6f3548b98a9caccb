//! Faults of the wire that can be requested: bytes that are lost, changed or late. A random stream from a seed decides when
//! faults happen.

use std::time::Duration;

use hallsweep_core::rng::RandomStream;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Probability from 0 to 1 that a byte is lost, in each line or in each 16 kB of a photo.
    pub lose: f64,
    /// Probability from 0 to 1 that a byte is changed, in each line or in each 16 kB of a photo.
    pub garble: f64,
    pub delay: Duration,
    pub cut_after: Option<Duration>,
}

impl Faults {
    pub(super) fn befall(&self, piece: &[u8], chance: &mut RandomStream) -> Vec<u8> {
        let mut piece = piece.to_vec();
        if chance.happens(self.garble) && !piece.is_empty() {
            let place = place(&piece, chance);
            piece[place] = chance.number().to_le_bytes()[0];
        }
        if chance.happens(self.lose) && !piece.is_empty() {
            piece.remove(place(&piece, chance));
        }
        piece
    }
}

/// A random place in the piece, which must not be empty.
fn place(piece: &[u8], chance: &mut RandomStream) -> usize {
    usize::try_from(chance.below(piece.len() as u64)).expect("it is less than a length")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_faults_nothing_is_changed_and_with_them_one_byte_is() {
        let mut chance = RandomStream::new(1, "test");
        let piece = [7; 100];
        assert_eq!(Faults::default().befall(&piece, &mut chance), piece);
        let lost = Faults { lose: 1.0, ..Faults::default() }.befall(&piece, &mut chance);
        assert_eq!(lost, [7; 99]);
        let garbled = Faults { garble: 1.0, ..Faults::default() }.befall(&piece, &mut chance);
        assert_eq!((garbled.len(), garbled.iter().filter(|byte| **byte != 7).count()), (100, 1));
        assert_eq!(Faults { lose: 1.0, garble: 1.0, ..Faults::default() }.befall(b"", &mut chance), b"");
    }
}
