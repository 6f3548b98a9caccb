//! The checksums of the line protocol: CRC-16 for a line (CCITT, initial value `FFFF`), CRC-32 for a photo (the one
//! of zip). Both are computed bit by bit, without a table, as on a microcontroller.

/// The checksum of a line. NMEA 0183 uses the exclusive or of all letters instead. It would not notice the loss of
/// two equal letters, as in `w 77 990`.
pub(super) fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xffff, |crc, byte| {
        (0..8).fold(crc ^ (u16::from(*byte) << 8), |crc, _| if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x1021 })
    })
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Crc32(u32);

impl Crc32 {
    pub(super) const fn new() -> Crc32 {
        Crc32(u32::MAX)
    }

    pub(super) fn add(&mut self, bytes: &[u8]) {
        self.0 = bytes.iter().fold(self.0, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 0 { crc >> 1 } else { (crc >> 1) ^ 0xedb8_8320 })
        });
    }

    pub(super) const fn value(self) -> u32 {
        !self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_give_what_their_catalogue_says_of_the_usual_text() {
        assert_eq!(crc16(b"123456789"), 0x29b1);
        let mut crc = Crc32::new();
        crc.add(b"1234");
        crc.add(b"56789");
        assert_eq!(crc.value(), 0xcbf4_3926);
    }

    #[test]
    fn two_equal_letters_that_are_lost_are_missed() {
        assert_ne!(crc16(b"w 7 1990"), crc16(b"w 7 10"));
    }
}
