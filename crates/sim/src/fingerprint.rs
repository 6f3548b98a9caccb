//! A checksum that distinguishes halls by their content, and finds damage in stored text. It protects against
//! mistakes, not against attacks: FNV-1a is not cryptographic.

use super::bag::Bag;
use super::hall::{Hall, Truth};
use hallsweep_core::units::{Cell, Piece};

/// The 64-bit FNV-1a hash. Unlike the standard library's hashes, it is the same on every machine and in every
/// version.
pub(super) struct Fingerprint(u64);

impl Fingerprint {
    pub(super) fn of(text: &str) -> u64 {
        Fingerprint::new().with(text.as_bytes()).0
    }

    const fn new() -> Fingerprint {
        Fingerprint(0xcbf2_9ce4_8422_2325)
    }

    fn with(self, bytes: &[u8]) -> Fingerprint {
        Fingerprint(bytes.iter().fold(self.0, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)))
    }

    fn number(self, number: u64) -> Fingerprint {
        self.with(&number.to_le_bytes())
    }

    fn cell(self, cell: Cell) -> Fingerprint {
        self.with(&cell.x.to_le_bytes()).with(&cell.y.to_le_bytes())
    }

    fn truth(self, truth: Truth) -> Fingerprint {
        match truth {
            Truth::Free => self.with(b"."),
            Truth::Wall => self.with(b"#"),
            Truth::Luggage(Piece(piece)) => self.with(b"a").with(&piece.to_le_bytes()),
        }
    }

    /// Adds a piece without its cells, because the cells are already in the drawing.
    fn bag(self, bag: &Bag) -> Fingerprint {
        let colour = [bag.colour.red, bag.colour.green, bag.colour.blue, u8::from(bag.dangerous)];
        self.with(bag.kind.name().as_bytes()).with(&colour).number(bag.height_m.to_bits())
    }
}

impl Hall {
    /// The fingerprint of everything that a robot can meet: floor, luggage, temperature. Name and description of the
    /// hall are left out.
    pub(super) fn fingerprint(&self) -> u64 {
        let bounds = self.bounds();
        let sized = Fingerprint::new().number(self.cell_m().to_bits()).cell(bounds.least).cell(bounds.most);
        let rows = bounds.least.y..=bounds.most.y;
        let cells = rows.flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)));
        let drawn = cells.fold(sized, |print, cell| print.truth(self.truth(cell)));
        let packed = self.pieces().iter().fold(drawn, Fingerprint::bag);
        let keys = self.curve().map_or(&[][..], |curve| curve.keys());
        keys.iter().fold(packed, |print, (at, degrees)| print.number(at.to_bits()).number(degrees.degrees().to_bits())).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn print(text: &str) -> u64 {
        Hall::parse("test.toml", text).unwrap().fingerprint()
    }

    const PLAIN: &str =
        "name = \"a\"\ndrawing = \"\"\"\nS.a\n\"\"\"\n[[luggage]]\nmark = \"a\"\nkind = \"box\"\ncolour = \"red\"\n";

    #[test]
    fn whatever_a_robot_can_meet_counts_and_words_do_not() {
        let plain = print(PLAIN);
        assert_eq!(plain, print(PLAIN));
        assert_eq!(plain, print(&PLAIN.replace("name = \"a\"", "name = \"b\"\ndescription = \"other words\"")));
        let others = [
            PLAIN.replace("S.a", "S..a"),
            PLAIN.replace("S.a", "S#a"),
            PLAIN.replace("box", "duffel"),
            PLAIN.replace("red", "blue"),
            format!("{PLAIN}dangerous = true\n"),
            format!("{PLAIN}[[temperature]]\nat_s = 0\ncelsius = 20.0\n"),
            format!("cell_m = 0.6\n{PLAIN}"),
        ];
        for other in others {
            assert_ne!(plain, print(&other), "{other}");
        }
    }

    #[test]
    fn the_fingerprint_is_the_same_in_every_version_of_the_program() {
        assert_eq!(Fingerprint::of("a"), 0xaf63_dc4c_8601_ec8c, "the published value of FNV-1a");
    }
}
