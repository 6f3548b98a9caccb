//! Reads the images from which halls are made, row by row. PGM and PNG are recognised by their first bytes.
//! `occupancy` decides how light a pixel must be to count as floor.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits, Reader, Transformations};

use super::error::HallFault;
use super::pgm::Pgm;
use super::pixel::{Pixel, sides};

pub(super) const MAX_IMAGE_BYTES: u64 = 64 << 20;

/// Maximum memory for reading a PNG, in bytes, not counting the file itself. It is enough for some rows of the widest
/// image.
const PNG_BYTES: usize = 16 << 20;

const PNG_BEGIN: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The first bytes of a BMP image. `map_server` reads BMP, but this program refuses it with its own message.
const BMP_BEGIN: &[u8] = b"BM";

pub(super) enum Image<'a> {
    Pgm(Pgm<'a>),
    Png(Box<Reader<Cursor<&'a [u8]>>>),
}

impl<'a> Image<'a> {
    pub(super) fn begins(bytes: &[u8]) -> bool {
        Pgm::begins(bytes) || bytes.starts_with(PNG_BEGIN)
    }

    pub(super) fn open(bytes: &'a [u8]) -> Result<Image<'a>, HallFault> {
        if Pgm::begins(bytes) {
            return Pgm::open(bytes).map(Image::Pgm);
        }
        if !bytes.starts_with(PNG_BEGIN) {
            return Err(if bytes.starts_with(BMP_BEGIN) { HallFault::Bmp } else { HallFault::NoImage });
        }
        let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: PNG_BYTES });
        decoder.set_transformations(Transformations::EXPAND);
        let broken = |error: png::DecodingError| HallFault::Png(error.to_string());
        let header = decoder.read_header_info().map_err(broken)?;
        sides(header.width.into(), header.height.into())?;
        // The rows of an interlaced image are stored in seven passes, so it cannot be read row by row.
        if header.interlaced {
            return Err(HallFault::Png("it is interlaced".to_owned()));
        }
        decoder.read_info().map(|reader| Image::Png(Box::new(reader))).map_err(broken)
    }

    /// Numbers of columns and rows.
    pub(super) fn size(&self) -> (u32, u32) {
        match self {
            Image::Pgm(image) => (image.width, image.height),
            Image::Png(reader) => (reader.info().width, reader.info().height),
        }
    }

    pub(super) fn next_row(&mut self, row: &mut Vec<Pixel>) -> Result<(), HallFault> {
        match self {
            Image::Pgm(image) => image.next_row(row),
            Image::Png(reader) => png_row(reader, row),
        }
    }
}

fn png_row(reader: &mut Reader<Cursor<&[u8]>>, row: &mut Vec<Pixel>) -> Result<(), HallFault> {
    let (colour, depth) = reader.output_color_type();
    let read = reader.next_row().map_err(|error| HallFault::Png(error.to_string()))?;
    let bytes = read.as_ref().map_or(&[][..], |row| row.data());
    let sample_bytes = if depth == BitDepth::Sixteen { 2 } else { 1 };
    let white = if depth == BitDepth::Sixteen { 65535.0 } else { 255.0 };
    let samples: Vec<f64> = bytes
        .chunks(sample_bytes)
        .map(|sample| sample.iter().fold(0.0, |value, byte| value * 256.0 + f64::from(*byte)))
        .collect();
    row.clear();
    row.extend(samples.chunks(colour.samples()).map(|samples| match (colour, samples) {
        (ColorType::GrayscaleAlpha | ColorType::Rgba, [colours @ .., alpha]) => {
            Pixel { shade: mean(colours) / white, alpha: Some(alpha / white) }
        }
        (_, colours) => Pixel { shade: mean(colours) / white, alpha: None },
    }));
    Ok(())
}

fn mean(colours: &[f64]) -> f64 {
    let count = u32::try_from(colours.len()).unwrap_or(1);
    colours.iter().sum::<f64>() / f64::from(count.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(colour: ColorType, depth: BitDepth, width: u32, bytes: &[u8]) -> Vec<u8> {
        let height = u32::try_from(bytes.len()).unwrap() / (width * colour.samples() as u32 * depth as u32 / 8);
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(bytes).unwrap();
        file
    }

    fn first_row(bytes: &[u8]) -> Result<Vec<(f64, Option<f64>)>, String> {
        let mut row = Vec::new();
        Image::open(bytes).and_then(|mut image| image.next_row(&mut row)).map_err(|fault| fault.to_string())?;
        Ok(row.iter().map(|pixel| (pixel.shade, pixel.alpha)).collect())
    }

    #[test]
    fn a_png_of_any_colours_says_how_light_its_pixels_are() {
        let eight = BitDepth::Eight;
        assert_eq!(first_row(&png(ColorType::Grayscale, eight, 2, &[0, 51])), Ok(vec![(0.0, None), (0.2, None)]));
        assert_eq!(first_row(&png(ColorType::Rgb, eight, 1, &[51, 102, 153])), Ok(vec![(0.4, None)]));
        assert_eq!(first_row(&png(ColorType::Rgba, eight, 1, &[51, 102, 153, 51])), Ok(vec![(0.4, Some(0.2))]));
        assert_eq!(first_row(&png(ColorType::GrayscaleAlpha, eight, 1, &[102, 255])), Ok(vec![(0.4, Some(1.0))]));
        assert_eq!(first_row(&png(ColorType::Grayscale, BitDepth::Sixteen, 1, &[0x33, 0x33])), Ok(vec![(0.2, None)]));
        assert_eq!(first_row(&png(ColorType::Grayscale, BitDepth::Two, 4, &[0b00_01_10_11])).unwrap().len(), 4);
    }

    /// The checksum of a chunk (PNG, annex D).
    fn checksum(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |sum, byte| {
            (0..8).fold(sum ^ u32::from(*byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 })
        })
    }

    #[test]
    fn an_interlaced_or_endless_png_is_refused() {
        let header = |place: usize, byte: u8| {
            let mut file = png(ColorType::Grayscale, BitDepth::Eight, 2, &[0, 51]);
            file[place] = byte;
            let sum = checksum(&file[12..29]).to_be_bytes();
            file[29..33].copy_from_slice(&sum);
            file
        };
        assert!(first_row(&header(16, 0)).is_ok());
        let said = first_row(&header(28, 1)).unwrap_err();
        assert_eq!(said, "this PNG image cannot be read (it is interlaced): save it again without interlacing, or as PGM");
        let said = first_row(&header(16, 1)).unwrap_err();
        assert_eq!(said, "an image of 16777218 × 1 pixels is too large: at most 16384 × 16384 pixels are read");
    }

    #[test]
    fn what_is_no_image_or_a_broken_one_is_refused() {
        assert_eq!(first_row(b"GIF89a").unwrap_err(), "this image cannot be read: save it as PGM (P5 or P2) or PNG");
        let bmp = "BMP images are not supported: convert the image to PNG or PGM, and name the new file in `image`";
        assert_eq!(first_row(b"BM\x46\0\0\0\0\0\0\0").unwrap_err(), bmp);
        assert!(first_row(b"P6 1 1 255\n...").unwrap_err().starts_with("this image cannot be read"), "colours are PNG's");
        let whole = png(ColorType::Grayscale, BitDepth::Eight, 40, &[7; 1600]);
        for length in [8, 20, 33, 45] {
            let said = first_row(&whole[..length]).unwrap_err();
            assert!(said.starts_with("this PNG image cannot be read ("), "{said}");
        }
    }
}
