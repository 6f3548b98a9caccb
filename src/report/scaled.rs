//! Scales down the photos of a report when all photos together would be too large. Each photo becomes a JPEG, which
//! is made smaller in steps until it is small enough. The originals stay in the journal. Only integer arithmetic is
//! used. So another machine produces the same bytes and confirms the report.

use std::io::Cursor;
use std::sync::{Mutex, PoisonError};

use jpeg_encoder::{ColorType, Encoder};
use png::Transformations;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Maximum length of the longest side of a scaled photo, in pixels. On the printed page this is 150 dots per inch.
const LONGEST: usize = 320;

/// Minimum length of the longest side, in pixels. Nothing can be recognised on a smaller photo.
const SHORTEST: usize = 24;

const QUALITY: u8 = 60;

/// Maximum number of pixels of a photo that is scaled. A larger photo would take too much memory and time.
const MOST_PIXELS: usize = 8 << 20;

/// Held while a photo is scaled. So several reports at once use only one processor, and leave the others free.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Red, green and blue of each pixel, row by row.
struct Pixels {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

/// Scales the photo down to a JPEG of at most `most` bytes. `None` if the file cannot be decoded, or if nothing could
/// be recognised at that size.
pub(super) fn scaled(photo: &[u8], media_type: &str, most: usize) -> Option<Vec<u8>> {
    let _turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let pixels = if media_type == "image/png" { of_png(photo)? } else { of_jpeg(photo)? };
    let mut side = LONGEST.min(pixels.width.max(pixels.height));
    while side >= SHORTEST {
        let small = pixels.within(side);
        let (width, height) = (u16::try_from(small.width).ok()?, u16::try_from(small.height).ok()?);
        let mut jpeg = Vec::new();
        let mut encoder = Encoder::new(&mut jpeg, QUALITY);
        encoder.set_optimized_huffman_tables(true);
        encoder.encode(&small.rgb, width, height, ColorType::Rgb).ok()?;
        if jpeg.len() <= most {
            return Some(jpeg);
        }
        side = side * 3 / 4;
    }
    None
}

fn of_png(photo: &[u8]) -> Option<Pixels> {
    let mut decoder = png::Decoder::new(Cursor::new(photo));
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    let mut reader = decoder.read_info().ok()?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    width.checked_mul(height).filter(|pixels| *pixels <= MOST_PIXELS)?;
    let mut bytes = vec![0; reader.output_buffer_size()?];
    reader.next_frame(&mut bytes).ok()?;
    // Without colours, the first sample of a pixel is its brightness. A second sample is its opacity.
    let samples = reader.output_color_type().0.samples();
    let colours = if samples < 3 { [0, 0, 0] } else { [0, 1, 2] };
    let rgb = bytes.chunks_exact(samples).flat_map(|pixel| colours.map(|colour| pixel[colour])).collect();
    Some(Pixels { width, height, rgb })
}

fn of_jpeg(photo: &[u8]) -> Option<Pixels> {
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(photo), options);
    decoder.decode_headers().ok()?;
    let (width, height) = decoder.dimensions()?;
    width.checked_mul(height).filter(|pixels| *pixels <= MOST_PIXELS)?;
    let rgb = decoder.decode().ok()?;
    (rgb.len() == width * height * 3).then_some(Pixels { width, height, rgb })
}

impl Pixels {
    /// Scales the picture so that its longest side has `side` pixels. Each new pixel is the mean of the pixels that
    /// it covers.
    fn within(&self, side: usize) -> Pixels {
        let longest = self.width.max(self.height);
        let [width, height] = [self.width, self.height].map(|length| (length * side / longest).max(1));
        let mut rgb = Vec::with_capacity(width * height * 3);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let rows = y * self.height / height..(y + 1) * self.height / height;
            let columns = x * self.width / width..(x + 1) * self.width / width;
            let mut sums = [0_usize; 3];
            for row in rows.clone() {
                let (from, to) = (row * self.width + columns.start, row * self.width + columns.end);
                for pixel in self.rgb[from * 3..to * 3].chunks_exact(3) {
                    sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += usize::from(*value));
                }
            }
            rgb.extend(sums.map(|sum| u8::try_from(sum / (rows.len() * columns.len())).unwrap_or(u8::MAX)));
        }
        Pixels { width, height, rgb }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use sha2::{Digest, Sha256};

    use super::*;
    use crate::runtime::archive::hex;

    /// Random pixels of a picture of 160 by 120, which does not compress.
    pub(in crate::report) fn noise(seed: u32) -> Vec<u8> {
        let mut state = seed;
        let mut value = || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state.to_le_bytes()[0]
        };
        (0..160 * 120 * 3).map(|_| value()).collect()
    }

    pub(in crate::report) fn png(
        pixels: &[u8],
        (width, height): (u32, u32),
        colours: png::ColorType,
        depth: png::BitDepth,
    ) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(colours);
        encoder.set_depth(depth);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(pixels).unwrap();
        writer.finish().unwrap();
        bytes
    }

    fn jpeg(pixels: &[u8], (width, height): (u16, u16), colours: ColorType) -> Vec<u8> {
        let mut bytes = Vec::new();
        Encoder::new(&mut bytes, 90).encode(pixels, width, height, colours).unwrap();
        bytes
    }

    /// Reports that were handed over contain these bytes, so no version may change them.
    #[test]
    fn a_photo_is_scaled_to_the_same_bytes_by_every_version() {
        let of = |photo: &[u8], media_type| hex(&Sha256::digest(scaled(photo, media_type, 8170).expect("it can be scaled")));
        let photo = png(&noise(1), (160, 120), png::ColorType::Rgb, png::BitDepth::Eight);
        assert_eq!(of(&photo, "image/png"), "36ad4a0f26156f12a68b7bc735294b2a50d8213c3a0f24838c9722989a50c448");
        assert_eq!(
            of(&jpeg(&noise(1), (160, 120), ColorType::Rgb), "image/jpeg"),
            "190f629d5dd3906f379fef08054434e877d5fdfafe6a8f01053f3e157081db4b"
        );
    }

    #[test]
    fn photos_of_every_kind_fit_and_what_cannot_be_shown_is_none() {
        use png::{BitDepth, ColorType as Colours};
        let (rgb, size) = (noise(7), (160, 120));
        let pngs = [(Colours::Rgb, 3), (Colours::Rgba, 4), (Colours::Grayscale, 1), (Colours::GrayscaleAlpha, 2)]
            .map(|(colours, samples)| png(&rgb.repeat(2)[..160 * 120 * samples], size, colours, BitDepth::Eight));
        let deep = png(&rgb.repeat(2)[..160 * 120 * 6], size, Colours::Rgb, BitDepth::Sixteen);
        for photo in pngs.iter().chain([&deep]) {
            assert!(
                scaled(photo, "image/png", 3000).is_some_and(|small| small.len() <= 3000 && small.starts_with(&[0xff, 0xd8]))
            );
        }
        for (colours, samples) in [(ColorType::Rgb, 3), (ColorType::Luma, 1)] {
            let photo = jpeg(&rgb[..160 * 120 * samples], (160, 120), colours);
            assert!(scaled(&photo, "image/jpeg", 3000).is_some_and(|small| small.len() <= 3000), "{colours:?}");
            assert!(scaled(&photo[..200], "image/jpeg", 3000).is_none());
        }
        assert!(scaled(&pngs[0], "image/png", 100).is_none(), "nothing can be recognised");
        assert!(scaled(b"bag", "image/png", 3000).is_none());
        let huge = png(&vec![0; 4096 * 512], (4096, 4096), Colours::Grayscale, BitDepth::One);
        assert!(scaled(&huge, "image/png", 3000).is_none(), "it would take too much memory");
    }

    #[test]
    fn a_small_pixel_is_the_mean_of_those_it_stands_for() {
        let rgb = [[0; 3], [100; 3], [200, 0, 10], [0, 0, 30]].concat();
        let small = Pixels { width: 4, height: 1, rgb }.within(2);
        assert_eq!((small.width, small.height, small.rgb), (2, 1, vec![50, 50, 50, 100, 0, 20]));
    }
}
