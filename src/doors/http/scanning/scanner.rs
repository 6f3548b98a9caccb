//! Follows the requests of a connection, byte by byte, before anything judges them: where a head ends, what it names and who
//! asks, how long its body is, where the next one begins. It is lenient, because a STOP with a fault is still a STOP; where hyper
//! takes a request, both agree on its length. It reads no socket, keeps little however long a head is, and decides nothing.

use super::body::Chunks;
use super::head::{BodyLength, Head, HeadReader};
use super::names;

/// So much is kept of a body that may say STOP, in bytes: what is longer than any body may be is looked at where it begins.
const BODY: usize = 16 * 1024;

/// What a byte has brought to its end.
#[derive(Debug, PartialEq, Eq)]
pub enum Heard {
    /// A head: what it names and who asks has come.
    Head(Head),
    /// The body of the request whose head was heard last. A request without a body has no such end.
    Body,
}

#[derive(Debug)]
pub struct Scanner {
    head: HeadReader,
    at: ScannerState,
    heads: u64,
    said: BodyStart,
}

/// The beginning of a body that may say STOP, and nothing of any other.
#[derive(Debug, Default)]
struct BodyStart {
    is_kept: bool,
    bytes: Vec<u8>,
}

#[derive(Debug)]
enum ScannerState {
    Head,
    /// So many bytes of a body are to come.
    Body(u64),
    Chunks(Chunks),
    /// Nobody can say where the next request begins, and hyper ends such a connection.
    Lost,
}

impl Scanner {
    /// Before the first byte; `cookie` is the name of the cookies that say who asks.
    pub fn new(cookie: &str) -> Scanner {
        Scanner { head: HeadReader::new(cookie), at: ScannerState::Head, heads: 0, said: BodyStart::default() }
    }

    /// Takes bytes up to the first that brings something to its end, and says how many it took.
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
                            // It may have been no chunk.
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

    /// How many heads have ended.
    pub fn heads(&self) -> u64 {
        self.heads
    }

    /// Whether no body is on its way.
    pub fn is_between(&self) -> bool {
        matches!(self.at, ScannerState::Head)
    }

    /// Whether the first byte of a head is none of any method: no server waits for the end of that.
    pub fn is_no_request(&self) -> bool {
        matches!(self.at, ScannerState::Head) && self.head.is_no_method()
    }

    /// What has come of the body of the request whose head was heard last, if that may say STOP, as far as it is kept.
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
