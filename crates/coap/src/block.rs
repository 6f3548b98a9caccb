//! Splits bodies into blocks and joins blocks into bodies (RFC 7959). A block of an answer is a slice of the body and
//! needs no memory of its own. The blocks of a request are joined in bounded memory. This file does not decide which
//! message carries a block.

use std::net::SocketAddr;
use std::ops::Range;
use std::time::Duration;

use hashlink::LinkedHashMap;

use super::code::{Code, Method};
use super::exchange::is_over;
use super::limits::{ASSEMBLIES, BLOCK, BODY};
use super::network::is_this_machine;
use super::response::Response;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Block {
    /// The number of the block, at most 20 bits long.
    pub(super) number: u32,
    pub(super) more: bool,
    /// 0 to 6. A block has 2^(`exponent` + 4) bytes.
    pub(super) exponent: u8,
}

impl Block {
    /// The first block, of the largest size.
    pub(super) const FIRST: Block = Block { number: 0, more: false, exponent: (BLOCK / 16).ilog2() as u8 };

    /// Decodes the value of a block option. Returns `None` for the reserved exponent 7.
    pub(super) fn of(value: u32) -> Option<Block> {
        let exponent = (value & 7) as u8;
        (exponent < 7).then_some(Block { number: value >> 4, more: value & 8 != 0, exponent })
    }

    pub(super) fn value(self) -> u32 {
        (self.number << 4) | (u32::from(self.more) << 3) | u32::from(self.exponent)
    }

    /// Size in bytes of every block except the last, which may be shorter.
    pub(super) const fn size(self) -> usize {
        16 << self.exponent
    }

    /// Returns this block of a body of `length` bytes, with the right `more` flag, and its range of bytes. `None` if
    /// the block begins after the end of the body. An empty body has one block.
    pub(super) fn within(self, length: usize) -> Option<(Block, Range<usize>)> {
        let start = self.size().checked_mul(usize::try_from(self.number).ok()?)?;
        if start > 0 && start >= length {
            return None;
        }
        let end = length.min(start + self.size());
        Some((Block { more: end < length, ..self }, start..end))
    }
}

#[derive(Debug, PartialEq, Eq)]
pub(super) enum Taken {
    Whole(Vec<u8>),
    More,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct BodyKey {
    pub(super) peer: SocketAddr,
    pub(super) method: Method,
    pub(super) path: Vec<String>,
    pub(super) queries: Vec<String>,
    /// The values of Request-Tag (RFC 9175, section 3).
    pub(super) tags: Vec<Vec<u8>>,
}

/// Bodies whose last block has not arrived yet. Bodies from other machines have a separate limit.
#[derive(Debug, Default)]
pub(super) struct Assemblies {
    here: Bodies,
    beyond: Bodies,
}

type Bodies = LinkedHashMap<BodyKey, (Duration, Vec<u8>)>;

impl Assemblies {
    pub(super) fn count(&self) -> usize {
        self.here.len() + self.beyond.len()
    }

    /// Adds a block to its body. The error is 4.00 for a block that is not full although more blocks follow, 4.08 if
    /// an earlier block is missing, and 4.13 for a body that is too large.
    pub(super) fn take(&mut self, key: BodyKey, block: Block, bytes: &[u8], now: Duration) -> Result<Taken, Response> {
        let bodies = if is_this_machine(key.peer.ip()) { &mut self.here } else { &mut self.beyond };
        let before = bodies.remove(&key).filter(|(since, _)| !is_over(*since, now)).map(|(_, body)| body);
        let mut body = if block.number == 0 { Vec::new() } else { before.unwrap_or_default() };
        if bytes.len() > block.size() || (block.more && bytes.len() < block.size()) {
            return Err(Response::refusal(Code::BAD_REQUEST, "every block but the last must have the size in its option"));
        }
        let start = usize::try_from(block.number).unwrap_or(usize::MAX).saturating_mul(block.size());
        if start.saturating_add(bytes.len()) > BODY {
            return Err(too_large());
        }
        // A repetition of the latest block under another message id changes nothing.
        if start < body.len() && block.more && body[start..] == *bytes {
            bodies.insert(key, (now, body));
            return Ok(Taken::More);
        }
        if start != body.len() {
            return Err(Response::refusal(Code::INCOMPLETE, "a block is missing: send the body again from the first block"));
        }
        body.extend_from_slice(bytes);
        if !block.more {
            return Ok(Taken::Whole(body));
        }
        bodies.insert(key, (now, body));
        while bodies.len() > ASSEMBLIES || bodies.front().is_some_and(|(_, (since, _))| is_over(*since, now)) {
            bodies.pop_front();
        }
        Ok(Taken::More)
    }
}

pub(super) fn too_large() -> Response {
    Response::refusal(Code::TOO_LARGE, format!("the body is larger than {BODY} bytes: a command has a few dozen"))
}

#[cfg(test)]
mod tests {
    use super::super::limits::EXCHANGE_LIFETIME;
    use super::*;

    fn key() -> BodyKey {
        BodyKey {
            peer: "127.0.0.1:1".parse().unwrap(),
            method: Method::Put,
            path: Vec::new(),
            queries: Vec::new(),
            tags: Vec::new(),
        }
    }

    fn block(number: u32, more: bool) -> Block {
        Block { number, more, exponent: 0 }
    }

    #[test]
    fn a_block_of_twenty_bits_is_read_and_written() {
        let last = Block { number: (1 << 20) - 1, more: true, exponent: 2 };
        assert_eq!(Block::of(last.value()), Some(last));
        assert_eq!(Block::of(7), None);
    }

    #[test]
    fn a_body_is_cut_without_gaps_and_nothing_is_past_its_end() {
        for length in [0, 1, 15, 16, 17, 100_000] {
            let mut end = 0;
            for number in 0.. {
                let Some((cut, range)) = block(number, false).within(length) else { break };
                assert_eq!((range.start, cut.more), (end, range.end < length));
                end = range.end;
            }
            assert_eq!(end, length);
        }
        assert_eq!(Block { number: u32::MAX >> 12, more: false, exponent: 6 }.within(100), None);
    }

    #[test]
    fn a_body_is_put_together_in_order() {
        let mut bodies = Assemblies::default();
        assert_eq!(bodies.take(key(), block(0, true), &[1; 16], Duration::ZERO), Ok(Taken::More));
        let whole = bodies.take(key(), block(1, false), &[2; 3], Duration::ZERO).unwrap();
        assert_eq!(whole, Taken::Whole([&[1; 16][..], &[2; 3]].concat()));
        assert_eq!(bodies.count(), 0);
    }

    #[test]
    fn a_gap_an_old_beginning_and_too_much_are_refused() {
        let mut bodies = Assemblies::default();
        let code = |taken: Result<Taken, Response>| taken.unwrap_err().code;
        assert_eq!(code(bodies.take(key(), block(1, true), &[1; 16], Duration::ZERO)), Code::INCOMPLETE);
        assert_eq!(bodies.take(key(), block(0, true), &[1; 16], Duration::ZERO), Ok(Taken::More));
        let late = EXCHANGE_LIFETIME + Duration::from_secs(1);
        assert_eq!(code(bodies.take(key(), block(1, false), &[1; 16], late)), Code::INCOMPLETE);
        assert_eq!(code(bodies.take(key(), block(0, true), &[1; 15], Duration::ZERO)), Code::BAD_REQUEST);
        assert_eq!(code(bodies.take(key(), block(1024, false), &[1; 16], Duration::ZERO)), Code::TOO_LARGE);
    }

    #[test]
    fn no_more_bodies_are_kept_than_there_is_room_for() {
        let mut bodies = Assemblies::default();
        for port in 1..=500 {
            let key = BodyKey { peer: format!("127.0.0.1:{port}").parse().unwrap(), ..key() };
            assert_eq!(bodies.take(key, block(0, true), &[1; 16], Duration::ZERO), Ok(Taken::More));
        }
        assert_eq!(bodies.count(), ASSEMBLIES);
    }
}
