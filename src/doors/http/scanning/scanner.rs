//! Follows the requests of a connection byte by byte: where a head ends, what it names and who sends it, how long its body is,
//! and where the next head begins. It is lenient, because a STOP with a fault is still a STOP; for a request that hyper accepts,
//! both find the same length. It reads no socket, stores little however long a head is, and decides nothing.

use super::body::Chunks;
use super::head::{BodyLength, Head, HeadReader};
use super::names;

/// Maximum number of bytes stored of a body that may say STOP. Of a body that is longer than any allowed one, only the beginning
/// is searched.
const BODY: usize = 16 * 1024;

/// The part of a request that is complete.
#[derive(Debug, PartialEq, Eq)]
pub enum Heard {
    /// A head, with what it names and who sends it.
    Head(Head),
    /// The body of the last request. A request without a body has no such end.
    Body,
}

#[derive(Debug)]
pub struct Scanner {
    head: HeadReader,
    at: ScannerState,
    heads: u64,
    said: BodyStart,
}

/// The beginning of a body that may say STOP; empty for any other body.
#[derive(Debug, Default)]
struct BodyStart {
    is_kept: bool,
    bytes: Vec<u8>,
}

#[derive(Debug)]
enum ScannerState {
    Head,
    /// Number of bytes of a body that are to come.
    Body(u64),
    Chunks(Chunks),
    /// It is unknown where the next request begins; hyper ends such a connection.
    Lost,
}

impl Scanner {
    /// The scanner before the first byte; `cookie` is the name of the cookies with a session.
    pub fn new(cookie: &str) -> Scanner {
        Scanner { head: HeadReader::new(cookie), at: ScannerState::Head, heads: 0, said: BodyStart::default() }
    }

    /// Reads up to the first byte that completes a part, and returns the number of bytes.
    pub fn take(&mut self, bytes: &[u8]) -> (usize, Option<Heard>) {
        let mut taken = 0;
        while let Some(&byte) = bytes.get(taken) {
            let heard = match &mut self.at {
                ScannerState::Head => {
                    let passed = self.head.passes_by(&bytes[taken..]);
                    if passed > 0 {
                        taken += passed;
                        continue;
                    }
                    taken += 1;
                    self.head.push(byte).map(|head| self.begin_body(head))
                }
                ScannerState::Body(left) => {
                    let here = usize::try_from(*left).unwrap_or(usize::MAX).min(bytes.len() - taken);
                    self.said.keep(&bytes[taken..taken + here]);
                    taken += here;
                    *left -= here as u64;
                    (*left == 0).then_some(Heard::Body)
                }
                ScannerState::Chunks(chunks) => {
                    let (here, ended) = chunks.take(&bytes[taken..], |data| self.said.keep(data));
                    taken += here;
                    match ended {
                        Some(Ok(())) => Some(Heard::Body),
                        Some(Err(())) => {
                            // The byte may not belong to a chunk.
                            self.said.keep(&bytes[taken - 1..taken]);
                            self.at = ScannerState::Lost;
                            None
                        }
                        None => None,
                    }
                }
                ScannerState::Lost => {
                    self.said.keep(&bytes[taken..]);
                    return (bytes.len(), None);
                }
            };
            if let Some(heard) = heard {
                if heard == Heard::Body {
                    self.at = ScannerState::Head;
                }
                return (taken, Some(heard));
            }
        }
        (taken, None)
    }

    /// Number of complete heads since the connection began.
    pub fn heads(&self) -> u64 {
        self.heads
    }

    /// Whether the next byte belongs to a head.
    pub fn is_between(&self) -> bool {
        matches!(self.at, ScannerState::Head)
    }

    /// Whether the first byte of a head cannot begin a method: no server waits for the end of that.
    pub fn is_no_request(&self) -> bool {
        matches!(self.at, ScannerState::Head) && self.head.is_no_method()
    }

    /// The stored part of the last request's body, if that may say STOP.
    pub fn said(&self) -> &[u8] {
        &self.said.bytes
    }

    fn begin_body(&mut self, head: Head) -> Heard {
        self.heads += 1;
        self.said = BodyStart { is_kept: names::says_by_body(&head.method, &head.path).is_some(), bytes: Vec::new() };
        self.at = match head.body {
            BodyLength::Known(0) => ScannerState::Head,
            BodyLength::Known(length) => ScannerState::Body(length),
            BodyLength::Chunked => ScannerState::Chunks(Chunks::default()),
            BodyLength::Unknown => ScannerState::Lost,
        };
        Heard::Head(head)
    }
}

impl BodyStart {
    fn keep(&mut self, bytes: &[u8]) {
        if self.is_kept {
            let room = BODY.saturating_sub(self.bytes.len());
            self.bytes.extend_from_slice(&bytes[..bytes.len().min(room)]);
        }
    }
}

#[cfg(test)]
#[path = "scanner_tests.rs"]
mod tests;
