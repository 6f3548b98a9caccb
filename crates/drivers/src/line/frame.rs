//! A line on the wire: a text, `*`, the CRC-16 of the text as four capital hexadecimal digits, and a line feed. The
//! meaning of the texts is in `to_robot` and `from_robot`.

use super::crc::crc16;

/// Longest line that is read, in bytes. The check is included, the line feed is not.
pub const LONGEST: usize = 160;

/// Longest text of a line for the robot, in bytes. With `*` and check, the line has 40 bytes, not counting the line
/// feed.
pub(super) const LONGEST_FOR_ROBOT: usize = 35;

#[must_use]
pub fn framed(text: &str) -> Vec<u8> {
    format!("{text}*{:04X}\n", crc16(text.as_bytes())).into_bytes()
}

/// Finds lines in the received bytes. Invalid lines are skipped and counted.
#[derive(Clone, Debug, Default)]
pub struct LineReader {
    line: Vec<u8>,
    is_too_long: bool,
    passed_over: u64,
}

impl LineReader {
    /// Takes the next byte. If it ends a valid line, returns the text of that line.
    pub fn take(&mut self, byte: u8) -> Option<String> {
        match byte {
            b'\n' => self.end(),
            b'\r' => None,
            _ if self.line.len() == LONGEST => {
                self.is_too_long = true;
                None
            }
            _ => {
                self.line.push(byte);
                None
            }
        }
    }

    #[must_use]
    pub const fn passed_over(&self) -> u64 {
        self.passed_over
    }

    fn clear(&mut self) {
        self.line.clear();
        self.is_too_long = false;
    }

    fn end(&mut self) -> Option<String> {
        let text = if self.is_too_long { None } else { text_of(&self.line) };
        // Both ends sometimes send an empty line, so that the next text begins a new line. An empty line does not
        // count as invalid.
        self.passed_over += u64::from(text.is_none() && !self.line.is_empty());
        self.clear();
        text
    }
}

fn text_of(line: &[u8]) -> Option<String> {
    let line = std::str::from_utf8(line).ok().filter(|line| line.bytes().all(|byte| (b' '..=b'~').contains(&byte)))?;
    // The check begins after the first `*`. If the line feed between two lines is lost, the joined lines are never
    // valid.
    let (text, check) = line.split_once('*')?;
    (check == format!("{:04X}", crc16(text.as_bytes()))).then(|| text.to_owned())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(bytes: &[u8]) -> (Vec<String>, u64) {
        let mut reader = LineReader::default();
        let texts = bytes.iter().filter_map(|byte| reader.take(*byte)).collect();
        (texts, reader.passed_over())
    }

    #[test]
    fn a_line_is_read_with_and_without_a_carriage_return() {
        assert_eq!(framed("w 7 1990"), b"w 7 1990*4F92\n");
        assert_eq!(read(b"w 7 1990*4F92\r\n\n"), (vec!["w 7 1990".to_owned()], 0));
    }

    #[test]
    fn what_is_no_good_line_is_counted_and_passed_over() {
        let good = framed("hello");
        for wrong in [
            &b"hello\n"[..],
            b"hello*\n",
            b"hello*0000\n",
            b"w 7 1990*4f92\n",
            b"w 7 1990*4F92 \n",
            b"w 7 1990*4F92w 7 1990*4F92\n",
            b"\xff\xfe*0000\n",
            &[b'x'; LONGEST + 1].iter().copied().chain(*b"\n").collect::<Vec<u8>>(),
        ] {
            assert_eq!(read(&[wrong, &good].concat()), (vec!["hello".to_owned()], 1), "{}", String::from_utf8_lossy(wrong));
        }
    }

    proptest! {
        #[test]
        fn whatever_comes_the_line_under_way_stays_within_its_bound(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
            let mut reader = LineReader::default();
            for byte in bytes {
                if let Some(text) = reader.take(byte) {
                    prop_assert!(text.len() <= LONGEST);
                }
                prop_assert!(reader.line.len() <= LONGEST);
            }
        }

        #[test]
        fn a_text_that_is_written_is_read_back_whatever_came_before(
            before in prop::collection::vec(any::<u8>(), 0..300),
            text in "[ -)+-~]{1,100}",
        ) {
            let read = read(&[before.as_slice(), b"\n", &framed(&text)].concat()).0;
            prop_assert_eq!(read.last(), Some(&text));
        }
    }
}
