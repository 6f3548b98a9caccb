//! A photo whose bytes are arriving. The number of bytes is known, and one CRC-32 checks all of them. After the
//! photo, lines are read again.

use std::sync::Arc;
use std::time::Duration;

use super::crc::Crc32;
use hallsweep_core::event::Photo;

/// Largest photo that is accepted, in bytes. No camera of a microcontroller makes a larger one.
pub const MOST_BYTES: u32 = 4 << 20;

/// A media type and its check. The check says whether a file is a complete picture of this type, as far as possible.
type PictureKind = (fn(&[u8]) -> bool, &'static str);

const KINDS: [PictureKind; 2] = [(is_png, "image/png"), (is_jpeg, "image/jpeg")];

#[derive(Debug)]
pub(super) struct Picture {
    pub(super) is_wanted: bool,
    pub(super) until: Duration,
    length: u32,
    expected: u32,
    come: u32,
    crc: Crc32,
    bytes: Vec<u8>,
}

impl Picture {
    pub(super) const fn new(length: u32, expected: u32, is_wanted: bool, until: Duration) -> Picture {
        Picture { is_wanted, until, length, expected, come: 0, crc: Crc32::new(), bytes: Vec::new() }
    }

    /// Takes as many bytes as belong to the photo, and returns their number.
    pub(super) fn take(&mut self, bytes: &[u8]) -> usize {
        let missing = self.length - self.come;
        let count = bytes.len().min(missing as usize);
        let own = &bytes[..count];
        if self.is_wanted {
            self.crc.add(own);
            self.bytes.extend_from_slice(own);
        }
        self.come += u32::try_from(count).unwrap_or(missing);
        count
    }

    pub(super) const fn is_whole(&self) -> bool {
        self.come == self.length
    }

    pub(super) fn developed(self) -> Result<Photo, String> {
        if !self.is_whole() {
            return Err(format!("only {} of {} bytes of the photo arrived: take the photo again", self.come, self.length));
        }
        if self.crc.value() != self.expected {
            return Err("the photo arrived damaged: take the photo again".to_owned());
        }
        let kind = KINDS.into_iter().find(|(is_one, _)| is_one(&self.bytes));
        let (_, media_type) =
            kind.ok_or("the photo is not a complete PNG or JPEG image: the robot must send one of these formats")?;
        Ok(Photo { bytes: Arc::from(self.bytes), media_type })
    }
}

/// Whether the file is a complete PNG. It must have a width and a height, some image data, and an end (PNG
/// specification, 5.3 and 11.2).
fn is_png(bytes: &[u8]) -> bool {
    let Some(mut rest) = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n") else { return false };
    let (mut is_sized, mut has_data) = (false, false);
    while let Some((length, chunk)) = rest.split_first_chunk::<4>() {
        let length = u32::from_be_bytes(*length) as usize;
        let Some((kind, data)) = chunk.split_first_chunk::<4>() else { return false };
        match kind {
            b"IHDR" => is_sized = length == 13 && are_sides(data.get(..4)) && are_sides(data.get(4..8)),
            b"IDAT" => has_data |= length > 0,
            b"IEND" => return is_sized && has_data,
            _ => {}
        }
        // After the data of a chunk there is a checksum of four bytes.
        let Some(next) = length.checked_add(4).and_then(|next| data.get(next..)) else { return false };
        rest = next;
    }
    false
}

fn are_sides(bytes: Option<&[u8]>) -> bool {
    bytes.is_some_and(|bytes| bytes.iter().any(|byte| *byte != 0))
}

/// Whether the file is a complete JPEG. It must have a frame with a width and a height, a scan after it, and an end
/// (ITU-T T.81, B.1 and B.2).
fn is_jpeg(bytes: &[u8]) -> bool {
    // Cameras of microcontrollers often fill the rest of their buffer with zeros.
    let end = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    let Some(mut rest) = bytes[..end].strip_prefix(&[0xff, 0xd8]).filter(|rest| rest.ends_with(&[0xff, 0xd9])) else {
        return false;
    };
    let mut is_sized = false;
    while let [0xff, kind, high, low, segment @ ..] = rest {
        let length = usize::from(u16::from_be_bytes([*high, *low]));
        match kind {
            // These numbers mark the start of a frame. The exceptions are C4 and CC, which mark tables, and C8, which
            // is reserved.
            0xc0..=0xcf if !matches!(kind, 0xc4 | 0xc8 | 0xcc) => {
                is_sized = are_sides(segment.get(1..3)) && are_sides(segment.get(3..5))
            }
            0xda => return is_sized && segment.len() > length,
            _ => {}
        }
        let Some(next) = length.checked_sub(2).and_then(|next| segment.get(next..)) else { return false };
        rest = next;
    }
    false
}

#[cfg(test)]
pub(super) const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0\x3a\x7e\x9b\x55\0\0\0\x0aIDAT\x78\xda\x63\xa8\x07\0\0\x81\0\x80\
    \x6f\x1c\x0e\x51\0\0\0\0IEND\xae\x42\x60\x82";

#[cfg(test)]
mod tests {
    use super::*;

    fn developed(sent: &[u8], length: u32, expected: u32) -> Result<Photo, String> {
        let mut picture = Picture::new(length, expected, true, Duration::MAX);
        let (first, second) = sent.split_at(sent.len() / 2);
        picture.take(first);
        picture.take(second);
        picture.developed()
    }

    fn crc(bytes: &[u8]) -> u32 {
        let mut crc = Crc32::new();
        crc.add(bytes);
        crc.value()
    }

    const JPEG: &[u8] =
        b"\xff\xd8\xff\xc0\0\x0b\x08\0\x01\0\x01\x01\x01\x11\0\xff\xda\0\x08\x01\x01\0\0\x3f\0\xd2\xcf\x20\xff\xd9\0\0";

    #[test]
    fn its_media_type_is_as_its_bytes_say() {
        for (bytes, media_type) in [(PNG, "image/png"), (JPEG, "image/jpeg")] {
            let length = u32::try_from(bytes.len()).expect("it is short");
            assert_eq!(developed(bytes, length, crc(bytes)).map(|photo| photo.media_type), Ok(media_type));
        }
    }

    /// Safety V2: bytes that are not a complete picture must not be accepted as a photo.
    #[test]
    fn what_is_no_whole_picture_is_none() {
        for (bytes, length, expected, words) in [
            (PNG, 100, crc(PNG), "of 100 bytes"),
            (PNG, u32::try_from(PNG.len()).expect("it is short"), 0, "damaged"),
            (b"text", 4, crc(b"text"), "not a complete PNG or JPEG"),
            (b"\xff\xd8\xff", 3, crc(b"\xff\xd8\xff"), "not a complete PNG or JPEG"),
        ] {
            let why = developed(bytes, length, expected).expect_err("it is none");
            assert!(why.contains(words), "{why}");
        }
        for (picture, needed) in [(PNG, PNG.len() - 4), (JPEG, JPEG.len() - 2)] {
            for length in 1..needed {
                let begun = &picture[..length];
                assert!(developed(begun, u32::try_from(length).expect("it is short"), crc(begun)).is_err(), "{length} bytes");
            }
        }
    }

    #[test]
    fn what_follows_it_is_left_and_what_nobody_wants_is_not_kept() {
        let mut picture = Picture::new(3, 0, false, Duration::MAX);
        assert_eq!((picture.take(b"ab"), picture.take(b"cdone 1")), (2, 1));
        assert!(picture.is_whole() && picture.bytes.is_empty());
    }
}
