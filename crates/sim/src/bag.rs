//! A piece of luggage in a simulated hall: its cells, kind, colour and height, and whether it is dangerous. What the
//! robot and the operator know about the piece is not stored here.

use std::sync::Arc;

use hallsweep_core::units::{Cell, Piece};

#[derive(Clone, Debug, PartialEq)]
pub struct Bag {
    /// The number by which the camera recognises the piece. Numbers start at 1, in reading order of the drawing.
    pub piece: Piece,
    /// Name of the piece for people, such as `red suitcase`.
    pub name: Arc<str>,
    pub kind: BagKind,
    pub colour: Colour,
    /// The cells that the piece covers, in map coordinates, sorted by row, then by column. There is at least one.
    pub cells: Vec<Cell>,
    pub height_m: f64,
    pub dangerous: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BagKind {
    Suitcase,
    Backpack,
    Trolley,
    Duffel,
    Box,
    Handbag,
}

impl BagKind {
    pub(crate) const ALL: [BagKind; 6] =
        [BagKind::Suitcase, BagKind::Backpack, BagKind::Trolley, BagKind::Duffel, BagKind::Box, BagKind::Handbag];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            BagKind::Suitcase => "suitcase",
            BagKind::Backpack => "backpack",
            BagKind::Trolley => "trolley",
            BagKind::Duffel => "duffel",
            BagKind::Box => "box",
            BagKind::Handbag => "handbag",
        }
    }

    pub(crate) fn named(name: &str) -> Option<BagKind> {
        BagKind::ALL.into_iter().find(|kind| kind.name() == name)
    }

    pub(crate) const fn usual_height_m(self) -> f64 {
        match self {
            BagKind::Suitcase => 0.70,
            BagKind::Backpack => 0.52,
            BagKind::Trolley => 0.56,
            BagKind::Duffel => 0.32,
            BagKind::Box => 0.40,
            BagKind::Handbag => 0.30,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Colour {
    pub red: u8,
    pub green: u8,
    pub blue: u8,
}

impl Colour {
    /// The colours that a hall file can name.
    pub(crate) const NAMED: [(&'static str, Colour); 13] = [
        ("red", Colour::new(0xb8, 0x22, 0x2a)),
        ("orange", Colour::new(0xd9, 0x74, 0x1c)),
        ("yellow", Colour::new(0xd8, 0xb4, 0x2a)),
        ("green", Colour::new(0x2f, 0x7d, 0x43)),
        ("teal", Colour::new(0x1f, 0x86, 0x86)),
        ("blue", Colour::new(0x24, 0x4f, 0x9e)),
        ("navy", Colour::new(0x22, 0x2f, 0x58)),
        ("purple", Colour::new(0x6a, 0x3a, 0x8c)),
        ("pink", Colour::new(0xcc, 0x5c, 0x8c)),
        ("brown", Colour::new(0x7a, 0x4e, 0x2c)),
        ("tan", Colour::new(0xb0, 0x82, 0x4a)),
        ("grey", Colour::new(0x78, 0x7c, 0x82)),
        ("black", Colour::new(0x26, 0x27, 0x2b)),
    ];

    pub(crate) const fn new(red: u8, green: u8, blue: u8) -> Colour {
        Colour { red, green, blue }
    }

    /// Reads a colour name or `#rrggbb`. Returns `None` for any other text.
    pub(crate) fn parse(text: &str) -> Option<Colour> {
        let named = Colour::NAMED.into_iter().find(|(name, _)| *name == text).map(|(_, colour)| colour);
        named.or_else(|| Colour::from_hex(text.strip_prefix('#')?))
    }

    pub(crate) fn nearest_name(self) -> &'static str {
        let distance = |other: Colour| -> u32 {
            let part = |a: u8, b: u8| u32::from(a.abs_diff(b)).pow(2);
            part(self.red, other.red) + part(self.green, other.green) + part(self.blue, other.blue)
        };
        Colour::NAMED.into_iter().min_by_key(|(_, colour)| distance(*colour)).map_or("grey", |(name, _)| name)
    }

    fn from_hex(digits: &str) -> Option<Colour> {
        let plain = digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        let [_, red, green, blue] = plain.then(|| u32::from_str_radix(digits, 16).ok())??.to_be_bytes();
        Some(Colour { red, green, blue })
    }
}

impl Bag {
    /// Makes a piece that has no description in its file, such as a piece of a benchmark map. The piece's number
    /// determines kind and colour, so that neighbouring pieces differ.
    pub(crate) fn plain(piece: Piece, cells: Vec<Cell>) -> Bag {
        Bag::of_kind(BagKind::ALL[pick(piece, BagKind::ALL.len(), 1)], piece, cells)
    }

    pub(crate) fn of_kind(kind: BagKind, piece: Piece, cells: Vec<Cell>) -> Bag {
        let (colour_name, colour) = Colour::NAMED[pick(piece, Colour::NAMED.len(), 5)];
        let name = format!("{colour_name} {}", kind.name()).into();
        Bag { piece, name, kind, colour, cells, height_m: kind.usual_height_m(), dangerous: false }
    }
}

/// Returns an index below `count`, computed from the piece's number.
fn pick(piece: Piece, count: usize, stride: usize) -> usize {
    usize::try_from(piece.0).unwrap_or(0).wrapping_mul(stride) % count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_is_a_name_or_six_hexadecimal_digits() {
        assert_eq!(Colour::parse("#b8222a"), Colour::parse("red"));
        assert_eq!(Colour::parse("#10fF00"), Some(Colour::new(0x10, 0xff, 0)));
        for wrong in ["", "#", "#12345", "#1234567", "#+12345", "reddish", "#gggggg"] {
            assert_eq!(Colour::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn the_nearest_name_of_a_named_colour_is_its_own() {
        for (name, colour) in Colour::NAMED {
            assert_eq!(colour.nearest_name(), name);
        }
    }

    #[test]
    fn plain_pieces_next_to_each_other_look_different() {
        let bag = |number| Bag::plain(Piece(number), vec![]);
        assert_ne!(bag(1).kind, bag(2).kind);
        assert_ne!(bag(1).colour, bag(2).colour);
    }
}
