//! Compares a file with the report that the journal yields now, and remembers the first byte that differs.

use std::io::{self, Read, Write};

/// Number of bytes that are shown of each text, from the difference on.
const SHOWN: usize = 48;

/// The first difference between a file and the expected bytes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("difference at byte {byte}, in line {line}: the file has {has}, and the journal has {wants}")]
pub struct Difference {
    /// Position of the difference, counted from 1.
    pub byte: u64,
    pub line: u64,
    /// The file's bytes from this place on, in quotes; `no more text` if the file ends here.
    pub has: String,
    pub wants: String,
}

/// Receives the expected bytes, and compares them with the file.
pub struct Comparison<R> {
    file: R,
    byte: u64,
    line: u64,
    difference: Option<Difference>,
}

impl<R: Read> Comparison<R> {
    pub fn new(file: R) -> Comparison<R> {
        Comparison { file, byte: 1, line: 1, difference: None }
    }

    /// Returns the first difference, if any. A file that is longer than the expected bytes differs too. The outer
    /// error means that the file could not be read.
    pub fn finish(mut self) -> io::Result<Result<(), Difference>> {
        if self.difference.is_none() {
            let more = self.read(SHOWN)?;
            if !more.is_empty() {
                self.differ(&more, &[]);
            }
        }
        Ok(self.difference.map_or(Ok(()), Err))
    }

    fn read(&mut self, most: usize) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.file.by_ref().take(most as u64).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    fn differ(&mut self, has: &[u8], wants: &[u8]) {
        self.difference = Some(Difference { byte: self.byte, line: self.line, has: shown(has), wants: shown(wants) });
    }
}

impl<R: Read> Write for Comparison<R> {
    fn write(&mut self, wanted: &[u8]) -> io::Result<usize> {
        if self.difference.is_some() {
            // Bytes after the first difference do not matter.
            return Ok(wanted.len());
        }
        let there = self.read(wanted.len())?;
        let alike = there.iter().zip(wanted).take_while(|(there, wanted)| there == wanted).count();
        self.byte += alike as u64;
        self.line += wanted[..alike].iter().filter(|byte| **byte == b'\n').count() as u64;
        if alike < wanted.len() {
            self.differ(&there[alike..], &wanted[alike..]);
        }
        Ok(wanted.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn shown(bytes: &[u8]) -> String {
    if bytes.is_empty() {
        return "no more text".to_owned();
    }
    format!("{:?}", String::from_utf8_lossy(&bytes[..bytes.len().min(SHOWN)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compare(file: &str, parts: &[&str]) -> Result<(), Difference> {
        let mut comparison = Comparison::new(file.as_bytes());
        parts.iter().for_each(|part| comparison.write_all(part.as_bytes()).unwrap());
        comparison.finish().unwrap()
    }

    #[test]
    fn the_first_byte_that_differs_is_named_with_its_line() {
        assert_eq!(compare("one\ntwo\n", &["one\n", "two", "\n"]), Ok(()));
        let at =
            |byte, line, has: &str, wants: &str| Err(Difference { byte, line, has: has.to_owned(), wants: wants.to_owned() });
        assert_eq!(compare("one\ntwa\n", &["one\nt", "wo\n", "x"]), at(7, 2, "\"a\\n\"", "\"o\\n\""));
        assert_eq!(compare("one\n", &["one\n", "two"]), at(5, 2, "no more text", "\"two\""));
        assert_eq!(compare("one\ntwo", &["one\n"]), at(5, 2, "\"two\"", "no more text"));
        assert_eq!(compare("", &["one"]), at(1, 1, "no more text", "\"one\""));
    }
}
