//! Rewrites WebSocket frames on their way to the MQTT door (RFC 6455, section 5.2). Each frame of a binary message
//! becomes a message of its own. A STOP in a complete frame then need not wait for the end of its message, which may
//! never come (safety S8). MQTT ignores the boundaries of messages (MQTT 3.1.1, section 6). Frames are not validated
//! here.

/// Bit of a frame's first byte that marks the last frame of a message.
const FIN: u8 = 0x80;
/// Bits of a frame's first byte that contain its opcode.
const OPCODE: u8 = 0x0F;
const CONTINUATION: u8 = 0;
const TEXT: u8 = 1;
const BINARY: u8 = 2;

/// The state of one client's stream of frames, which begins after the head of the request.
#[derive(Debug, Default)]
pub(super) struct Frames {
    at: FrameState,
    /// Whether a binary message has begun and its last frame has not come yet.
    is_in_binary: bool,
}

#[derive(Debug, Default)]
enum FrameState {
    #[default]
    First,
    /// The second byte: the mask bit, and either the length or the size of the length field.
    Second,
    /// Number of length bytes still to come, value of the length bytes so far, and number of mask bytes.
    Length(u8, u64, u64),
    /// Number of mask and payload bytes still to come.
    Rest(u64),
}

impl Frames {
    /// Rewrites the first byte of each frame in the next bytes of the stream.
    pub(super) fn pass(&mut self, mut bytes: &mut [u8]) {
        while let Some((byte, behind)) = std::mem::take(&mut bytes).split_first_mut() {
            let mut passed = 0;
            self.at = match self.at {
                FrameState::First => {
                    self.begin(byte);
                    FrameState::Second
                }
                FrameState::Second => {
                    let mask = if *byte & 0x80 == 0 { 0 } else { 4 };
                    match *byte & 0x7F {
                        126 => FrameState::Length(2, 0, mask),
                        127 => FrameState::Length(8, 0, mask),
                        length => FrameState::Rest(u64::from(length) + mask),
                    }
                }
                FrameState::Length(left, value, mask) => match (left - 1, value << 8 | u64::from(*byte)) {
                    (0, length) => FrameState::Rest(length.saturating_add(mask)),
                    (left, value) => FrameState::Length(left, value, mask),
                },
                FrameState::Rest(left) => {
                    passed = usize::try_from(left - 1).unwrap_or(usize::MAX).min(behind.len());
                    FrameState::Rest(left - 1 - passed as u64)
                }
            };
            if let FrameState::Rest(0) = self.at {
                self.at = FrameState::First;
            }
            bytes = &mut behind[passed..];
        }
    }

    fn begin(&mut self, first: &mut u8) {
        let is_last = *first & FIN != 0;
        match *first & OPCODE {
            BINARY => *first |= FIN,
            CONTINUATION if self.is_in_binary => *first |= FIN | BINARY,
            TEXT => {
                self.is_in_binary = false;
                return;
            }
            _ => return,
        }
        self.is_in_binary = !is_last;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn frame(first: u8, is_masked: bool, length: usize) -> Vec<u8> {
        let mask = if is_masked { 0x80 } else { 0 };
        let long = length as u64;
        let head = match length {
            0..126 => vec![first, mask | long as u8],
            126..0x1_0000 => [&[first, mask | 126][..], &(length as u16).to_be_bytes()].concat(),
            _ => [&[first, mask | 127][..], &long.to_be_bytes()].concat(),
        };
        // The payload consists of bytes that look like the head of a frame.
        [head, vec![BINARY; length + if is_masked { 4 } else { 0 }]].concat()
    }

    /// First bytes of the frames of a stream, before and after rewriting.
    const PLAYS: [(&[u8], &[u8]); 6] = [
        (&[0x02, 0x00, 0x80, 0x82], &[0x82, 0x82, 0x82, 0x82]),
        (&[0x02, 0x89, 0x00, 0x8A, 0x80, 0x80], &[0x82, 0x89, 0x82, 0x8A, 0x82, 0x80]),
        (&[0x01, 0x00, 0x80, 0x02, 0x88], &[0x01, 0x00, 0x80, 0x82, 0x88]),
        (&[0x02, 0x01, 0x80], &[0x82, 0x01, 0x80]),
        (&[0x00, 0x80, 0x42, 0x30], &[0x00, 0x80, 0xC2, 0xB2]),
        (&[0x02, 0x02, 0x00], &[0x82, 0x82, 0x82]),
    ];

    proptest! {
        /// Safety S8.
        #[test]
        fn each_frame_of_a_binary_message_is_a_message_in_whatever_pieces_it_comes(
            play in prop::sample::select(PLAYS.to_vec()),
            shapes in prop::collection::vec((any::<bool>(), prop::sample::select(vec![0_usize, 1, 125, 126, 300, 0xFFFF, 0x1_0000])), 6),
            piece in 1_usize..70_000,
        ) {
            let stream = |firsts: &[u8]| -> Vec<u8> {
                firsts.iter().zip(&shapes).flat_map(|(first, (is_masked, length))| frame(*first, *is_masked, *length)).collect()
            };
            let (mut frames, mut bytes) = (Frames::default(), stream(play.0));
            for piece in bytes.chunks_mut(if piece > 300 { piece } else { piece % 7 + 1 }) {
                frames.pass(piece);
            }
            prop_assert!(bytes == stream(play.1), "{:02x?} {:?}", play.0, shapes);
        }
    }

    /// Safety A7.
    #[test]
    fn a_length_beyond_all_bounds_is_no_end() {
        let mut frames = Frames::default();
        let mut bytes = [&[0x02, 0xFF][..], &[0xFF; 8], &[0x02; 100]].concat();
        frames.pass(&mut bytes);
        assert!(bytes[0] == 0x82 && bytes[10..] == [0x02; 100]);
    }
}
