//! Encodes a picture as PNG. What is in it is none of this file's business.

use png::{BitDepth, ColorType, Compression, Encoder};

/// A PNG of `width` × `height` pixels, three bytes each.
pub(super) fn png(width: u32, height: u32, pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header().expect("a header of a valid size can be written to memory");
    writer.write_image_data(pixels).expect("three bytes are given for every pixel");
    writer.finish().expect("memory can be written to");
    bytes
}
