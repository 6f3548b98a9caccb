//! The bytes that wait to be sent to one client, in order. Some belong to this client alone. Others are payloads of
//! long messages, which all receivers share. Buffers that grew large are released when their bytes have been sent.
//! The limits of the outbox are not decided here.

use std::collections::VecDeque;
use std::io::IoSlice;

use bytes::{Buf, Bytes, BytesMut};

/// Maximum size of the empty buffer retained for later use, in bytes.
const ROOM: usize = 16 * 1024;

/// Approximate size of the pieces in which small messages wait, in bytes. A single buffer would grow by doubling, and
/// most of it would be empty.
const CHUNK: usize = 16 * 1024;

/// A piece with less free space than this, in bytes, is not written to any more.
const SPARE: usize = 2 * 1024;

/// The bytes that wait for one client. Send them in order through [`Buf`]: `advance` drops the bytes that were sent.
#[derive(Debug, Default)]
pub struct Outbox {
    /// Complete pieces, which go out first.
    before: VecDeque<Piece>,
    /// Size of `before` in bytes.
    length: usize,
    /// Bytes of `before` that no other client shares.
    own: usize,
    /// The piece that is being written, which goes out last.
    last: BytesMut,
}

#[derive(Debug)]
struct Piece {
    bytes: Bytes,
    is_own: bool,
}

impl Outbox {
    /// The buffer to append to; its contents are sent last. A full buffer is first appended to the complete pieces,
    /// so no buffer grows large.
    pub fn end(&mut self) -> &mut BytesMut {
        if self.last.len() > CHUNK - SPARE {
            self.seal();
            self.last = BytesMut::with_capacity(CHUNK);
        }
        &mut self.last
    }

    /// Appends bytes without a copy: other clients share them.
    pub(crate) fn share(&mut self, bytes: Bytes) {
        self.seal();
        self.length += bytes.len();
        if !bytes.is_empty() {
            self.before.push_back(Piece { bytes, is_own: false });
        }
    }

    fn seal(&mut self) {
        let bytes = self.last.split().freeze();
        self.own += bytes.len();
        self.length += bytes.len();
        if !bytes.is_empty() {
            self.before.push_back(Piece { bytes, is_own: true });
        }
    }

    /// Number of waiting bytes, including bytes that other clients share.
    #[must_use]
    pub fn len(&self) -> usize {
        self.length + self.last.len()
    }

    /// Number of waiting bytes that no other client shares.
    pub(crate) fn own(&self) -> usize {
        self.own + self.last.len()
    }

    /// Whether no bytes wait, own or shared.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Drops all waiting bytes. If a part of a packet was sent before, do not send another packet afterwards.
    pub fn clear(&mut self) {
        *self = Outbox::default();
    }
}

impl Buf for Outbox {
    fn remaining(&self) -> usize {
        self.len()
    }

    fn chunk(&self) -> &[u8] {
        self.before.front().map_or(&self.last[..], |piece| &piece.bytes[..])
    }

    fn chunks_vectored<'a>(&'a self, slices: &mut [IoSlice<'a>]) -> usize {
        let last = (!self.last.is_empty()).then_some(&self.last[..]);
        let chunks = self.before.iter().map(|piece| &piece.bytes[..]).chain(last);
        slices.iter_mut().zip(chunks).map(|(slice, chunk)| *slice = IoSlice::new(chunk)).count()
    }

    fn advance(&mut self, mut count: usize) {
        while count > 0
            && let Some(piece) = self.before.front_mut()
        {
            let gone = count.min(piece.bytes.len());
            piece.bytes.advance(gone);
            count -= gone;
            self.length -= gone;
            if piece.is_own {
                self.own -= gone;
            }
            if piece.bytes.is_empty() {
                self.before.pop_front();
            }
        }
        self.last.advance(count);
        // Releases a large buffer that has been sent. `capacity` does not tell its size, since it leaves out the sent
        // bytes.
        if self.last.is_empty() && self.last.try_reclaim(ROOM + 1) {
            self.last = BytesMut::new();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_goes_out_in_order_in_whatever_pieces_it_is_taken() {
        let shared = Bytes::from(vec![b'x'; 5]);
        for step in 1..=17 {
            let mut outbox = Outbox::default();
            outbox.end().extend_from_slice(b"one");
            outbox.share(shared.clone());
            outbox.share(shared.clone());
            outbox.end().extend_from_slice(b"four");
            assert_eq!((outbox.len(), outbox.own()), (17, 7));
            let mut got = Vec::new();
            while !outbox.is_empty() {
                let chunk = outbox.chunk();
                let taken = chunk.len().min(step);
                got.extend_from_slice(&chunk[..taken]);
                outbox.advance(taken);
            }
            assert_eq!((String::from_utf8_lossy(&got), outbox.own()), ("onexxxxxxxxxxfour".into(), 0));
        }
    }

    #[test]
    fn more_than_one_piece_goes_out_at_once() {
        let mut outbox = Outbox::default();
        outbox.end().extend_from_slice(b"one");
        outbox.share(Bytes::from_static(b"two"));
        outbox.end().extend_from_slice(b"three");
        let mut slices = [IoSlice::new(&[]); 5];
        let count = outbox.chunks_vectored(&mut slices);
        assert_eq!(slices[..count].iter().map(|slice| &**slice).collect::<Vec<_>>(), [&b"one"[..], b"two", b"three"]);
        outbox.advance(4);
        assert_eq!((outbox.chunk(), outbox.len(), outbox.own()), (&b"wo"[..], 7, 5));
        outbox.advance(7);
        assert!(outbox.is_empty() && outbox.chunk().is_empty());
    }

    #[test]
    fn small_messages_have_little_room_for_nothing() {
        let mut outbox = Outbox::default();
        (0..10_000).for_each(|_| outbox.end().extend_from_slice(&[7; 30]));
        assert_eq!((outbox.len(), outbox.own()), (300_000, 300_000));
        let last = outbox.last.capacity();
        let rooms = outbox.before.into_iter().map(|piece| piece.bytes.try_into_mut().expect("nobody else has it").capacity());
        assert!(rooms.sum::<usize>() + last <= 300_000 * 5 / 4);
    }

    /// A long message takes no memory after it was sent.
    #[test]
    fn the_room_of_what_has_gone_out_is_given_back() {
        let mut outbox = Outbox::default();
        outbox.end().extend_from_slice(&[7; 2 * ROOM]);
        outbox.advance(2 * ROOM - 1);
        assert!(outbox.end().len() == 1);
        outbox.advance(1);
        assert!(!outbox.end().try_reclaim(1));
        outbox.end().extend_from_slice(&[7; 64]);
        outbox.advance(64);
        assert!(outbox.end().try_reclaim(64), "a little is kept for what comes");
    }
}
