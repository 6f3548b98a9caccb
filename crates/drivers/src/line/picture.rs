//! A photo whose bytes are coming: so many of them, with one CRC-32 over all. Lines are read again behind them.

use std::sync::Arc;
use std::time::Duration;

use super::crc::Crc32;
use hallsweep_core::event::Photo;

/// The longest photo that is taken, in bytes: more than any camera of a microcontroller makes.
pub const MOST_BYTES: u32 = 4 << 20;

/// How a file of this kind begins, and its media type.
const KINDS: [(&[u8], &str); 2] = [(b"\x89PNG\r\n\x1a\n", "image/png"), (&[0xff, 0xd8, 0xff], "image/jpeg")];

#[derive(Debug)]
pub(super) struct Picture {
    /// Whether anybody still waits for it.
    pub(super) is_wanted: bool,
    /// By then it is here, or will not be.
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

    /// Takes those of these bytes that belong to it; how many they were.
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

    /// The photo, or why it is none.
    pub(super) fn developed(self) -> Result<Photo, String> {
        if !self.is_whole() {
            return Err(format!("only {} of {} bytes of the photo came: take it again", self.come, self.length));
        }
        if self.crc.value() != self.expected {
            return Err("the photo was damaged on its way: take it again".to_owned());
        }
        let kind = KINDS.into_iter().find(|(begins, _)| self.bytes.starts_with(begins));
        let (_, media_type) = kind.ok_or("the photo is neither PNG nor JPEG: let the robot send one of these")?;
        Ok(Photo { bytes: Arc::from(self.bytes), media_type })
    }
}

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

    #[test]
    fn its_media_type_is_as_its_bytes_say() {
        for (bytes, media_type) in [(&b"\x89PNG\r\n\x1a\nrest"[..], "image/png"), (b"\xff\xd8\xff\xe0", "image/jpeg")] {
            let length = u32::try_from(bytes.len()).expect("it is short");
            assert_eq!(developed(bytes, length, crc(bytes)).map(|photo| photo.media_type), Ok(media_type));
        }
    }

    #[test]
    fn what_is_no_whole_picture_is_none() {
        let good = b"\xff\xd8\xff\xe0";
        for (bytes, length, expected, words) in [
            (&good[..], 5, crc(good), "only 4 of 5 bytes"),
            (good, 4, 0, "damaged"),
            (b"text", 4, crc(b"text"), "neither PNG nor JPEG"),
        ] {
            let why = developed(bytes, length, expected).expect_err("it is none");
            assert!(why.contains(words), "{why}");
        }
    }

    #[test]
    fn what_follows_it_is_left_and_what_nobody_wants_is_not_kept() {
        let mut picture = Picture::new(3, 0, false, Duration::MAX);
        assert_eq!((picture.take(b"ab"), picture.take(b"cdone 1")), (2, 1));
        assert!(picture.is_whole() && picture.bytes.is_empty());
    }
}
