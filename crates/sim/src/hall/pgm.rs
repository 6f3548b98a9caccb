//! Reads PGM images (the grey images of netpbm) row by row: P5 has bytes, P2 has digits. Writes P5. The meaning of a
//! grey is not known here.

use super::error::HallFault;
use super::pixel::{Pixel, sides};

#[derive(Debug)]
pub(super) struct Pgm<'a> {
    pub(super) width: u32,
    pub(super) height: u32,
    /// The value of white.
    most: u16,
    /// Whether the pixels are decimal numbers in text (P2). Otherwise they are bytes (P5).
    is_plain: bool,
    rest: &'a [u8],
    rows_read: usize,
}

impl<'a> Pgm<'a> {
    pub(super) fn begins(bytes: &[u8]) -> bool {
        matches!(bytes, [b'P', b'2' | b'5', next, ..] if next.is_ascii_whitespace() || *next == b'#')
    }

    /// Reads the header: magic number, width, height, and the value of white. Comments may stand between these
    /// fields, from `#` to the end of a line.
    pub(super) fn open(bytes: &'a [u8]) -> Result<Pgm<'a>, HallFault> {
        let mut rest = bytes.get(2..).unwrap_or_default();
        let mut number = |what: &str, most: u64| {
            let found = next_number(&mut rest).filter(|value| *value <= most);
            found.ok_or_else(|| HallFault::Pgm(format!("its header has no {what}: it should read `P5 WIDTH HEIGHT LIGHTEST`")))
        };
        let (width, height) = (number("width", u64::MAX)?, number("height", u64::MAX)?);
        let (width, height) = sides(width, height)?;
        let most = number("lightest grey from 1 to 65535", 65535)?;
        let most = u16::try_from(most).ok().filter(|most| *most > 0);
        let most = most.ok_or_else(|| HallFault::Pgm("its lightest grey is 0: give 1 to 65535".to_owned()))?;
        let is_plain = bytes.get(1) == Some(&b'2');
        if !is_plain {
            // One whitespace character ends the header. The pixels follow.
            rest = rest.get(1..).unwrap_or_default();
        }
        Ok(Pgm { width, height, most, is_plain, rest, rows_read: 0 })
    }

    pub(super) fn next_row(&mut self, row: &mut Vec<Pixel>) -> Result<(), HallFault> {
        row.clear();
        for column in 0..self.width as usize {
            let short = HallFault::ShortImage {
                wanted: self.width as usize * self.height as usize,
                found: self.rows_read * self.width as usize + column,
            };
            let value = if self.is_plain { next_number(&mut self.rest) } else { self.next_sample() }.ok_or(short)?;
            if value > u64::from(self.most) {
                return Err(HallFault::PixelTooLight { row: self.rows_read + 1, column: column + 1, value, most: self.most });
            }
            let value = u16::try_from(value).unwrap_or(self.most);
            row.push(Pixel { shade: f64::from(value) / f64::from(self.most), alpha: None });
        }
        self.rows_read += 1;
        Ok(())
    }

    /// Reads one pixel. It has one byte if the value of white fits into a byte, or else two bytes (big-endian).
    fn next_sample(&mut self) -> Option<u64> {
        let (sample, rest) = self.rest.split_at_checked(if self.most < 256 { 1 } else { 2 })?;
        self.rest = rest;
        Some(sample.iter().fold(0, |value, byte| value << 8 | u64::from(*byte)))
    }
}

/// Skips blanks and comments and reads a decimal number. Returns `None` if there is no number, or if the number does
/// not fit into a `u64`.
fn next_number(rest: &mut &[u8]) -> Option<u64> {
    loop {
        *rest = rest.trim_ascii_start();
        if rest.first() != Some(&b'#') {
            break;
        }
        let line = rest.iter().position(|byte| *byte == b'\n' || *byte == b'\r').unwrap_or(rest.len());
        *rest = &rest[line..];
    }
    let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let (number, after) = rest.split_at(digits);
    *rest = after;
    std::str::from_utf8(number).ok()?.parse().ok()
}

/// Writes an image with `width` columns. `pixels` has one byte per pixel, row by row.
pub(super) fn write(width: usize, pixels: &[u8]) -> Vec<u8> {
    let height = pixels.len() / width.max(1);
    let mut bytes = format!("P5\n{width} {height}\n255\n").into_bytes();
    bytes.extend_from_slice(pixels);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shades(bytes: &[u8]) -> Result<Vec<Vec<f64>>, String> {
        let mut image = Pgm::open(bytes).map_err(|fault| fault.to_string())?;
        let mut row = Vec::new();
        (0..image.height)
            .map(|_| {
                image.next_row(&mut row).map_err(|fault| fault.to_string())?;
                Ok(row.iter().map(|pixel| pixel.shade).collect())
            })
            .collect()
    }

    fn check(bytes: &[u8], expect: &str) {
        assert_eq!(shades(bytes).expect_err("this image has a fault"), expect);
    }

    #[test]
    fn bytes_and_digits_say_the_same_with_comments_wherever_they_may_stand() {
        let expect = Ok(vec![vec![0.0, 1.0], vec![0.2, 0.4]]);
        assert_eq!(shades(b"P5\n2 2\n255\n\x00\xff\x33\x66"), expect);
        assert_eq!(shades(b"P5 # by hand\n# 9 9\n2#wide\n2\n#\n255\n\x00\xff\x33\x66and more"), expect);
        assert_eq!(shades(b"P2\n# 9\n2 2 255\n0 255\n#half\n51 102"), expect);
        assert_eq!(shades(b"P2 2 2 5 0 5 1 2\n"), expect, "the lightest grey may be any");
        assert_eq!(shades(b"P5\r2 2\r255\r\x00\xff\x33\x66"), expect);
    }

    #[test]
    fn a_lightest_grey_beyond_a_byte_takes_two_the_greater_first() {
        assert_eq!(shades(b"P5 1 2 65535\n\xff\xff\x33\x33"), Ok(vec![vec![1.0], vec![0.2]]));
        assert_eq!(shades(b"P5 1 1 256\n\x01\x00"), Ok(vec![vec![1.0]]));
        assert_eq!(shades(b"P2 1 1 65535 13107"), Ok(vec![vec![0.2]]));
    }

    #[test]
    fn what_is_wrong_with_an_image_is_said() {
        check(b"P5\n2 2\n255\n\x00\xff\x33", "the image should have 4 pixels, but ends after 3: save it again");
        check(b"P5\n2 2\n300\n\x00\xff\x00", "the image should have 4 pixels, but ends after 1: save it again");
        check(b"P2\n2 2\n255\n0 1 2", "the image should have 4 pixels, but ends after 3: save it again");
        check(b"P2\n2 2\n255\n0 1 2 -3", "the image should have 4 pixels, but ends after 3: save it again");
        check(b"P2\n2 1\n7\n0 8", "pixel 2 of row 1 is 8, but the lightest value is 7: correct this pixel");
        check(b"P5\n1 1\n7\n\x08", "pixel 1 of row 1 is 8, but the lightest value is 7: correct this pixel");
        let header =
            |what| format!("this is not a PGM image: its header has no {what}: it should read `P5 WIDTH HEIGHT LIGHTEST`");
        check(b"P5\n", &header("width"));
        check(b"P5\n3", &header("height"));
        check(b"P5\n3 x", &header("height"));
        check(b"P5\n3 3", &header("lightest grey from 1 to 65535"));
        check(b"P5\n3 3 65536\n", &header("lightest grey from 1 to 65535"));
        check(b"P5\n3 3 0\n", "this is not a PGM image: its lightest grey is 0: give 1 to 65535");
        check(b"P5\n99999999999999999999 3 255\n", &header("width"));
        check(b"P5\n999999999 3 255\n", "an image of 999999999 × 3 pixels is too large: at most 16384 × 16384 pixels are read");
        check(b"P5\n0 3 255\n", "an image of 0 × 3 pixels has no floor: give at least one column and one row");
    }

    #[test]
    fn what_is_written_is_read_again() {
        assert_eq!(shades(&write(2, &[0, 255, 51, 102])), Ok(vec![vec![0.0, 1.0], vec![0.2, 0.4]]));
    }
}
