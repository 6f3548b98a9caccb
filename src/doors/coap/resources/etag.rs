//! Tags of representations (ETag; RFC 7252, section 5.10.6).

use std::hash::Hasher;

use coap_endpoint::ETag;

/// Returns the tag of these parts. It is the same in every run and on every machine.
pub(super) fn tag(parts: &[&[u8]]) -> ETag {
    let mut hasher = Fnv::default();
    for part in parts {
        hasher.write(&(part.len() as u64).to_be_bytes());
        hasher.write(part);
    }
    ETag::new(&hasher.finish().to_be_bytes()).expect("a number of 64 bits is eight bytes")
}

/// FNV-1a of 64 bits. The standard library does not promise that its own hash stays the same.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Fnv {
        Fnv(0xCBF2_9CE4_8422_2325)
    }
}

impl Hasher for Fnv {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
        }
    }
}
