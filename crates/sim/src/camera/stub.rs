//! The smallest picture that still tells bags apart: two pixels, the bag's colour and its number. For runs in which
//! nobody looks at the photos.

use super::super::hall::{Hall, Truth};
use super::encode::png;
use hallsweep_core::units::Cell;

/// A picture of what is in the cell `subject`.
pub(super) fn picture(hall: &Hall, subject: Cell) -> Vec<u8> {
    let [number, colour] = match hall.truth(subject) {
        Truth::Luggage(piece) => {
            let [_, high, middle, low] = piece.0.to_be_bytes();
            let colour = hall.bag(piece).map_or([0; 3], |bag| [bag.colour.red, bag.colour.green, bag.colour.blue]);
            [[high, middle, low], colour]
        }
        Truth::Wall => [[0; 3], [0xd0; 3]],
        Truth::Free => [[0; 3], [0x80; 3]],
    };
    png(2, 1, &[colour, number].concat())
}
