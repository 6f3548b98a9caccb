//! The pixels of a picture. Each pixel has a depth and the number of the solid (a box or rod) that it shows. The
//! canvas does not know what is drawn on it.

use super::space::Paint;
use super::view::{HEIGHT, View, WIDTH};

#[derive(Debug)]
pub(super) struct Canvas {
    pixels: Vec<[u8; 3]>,
    depths: Vec<f32>,
    solids: Vec<u16>,
}

/// A rectangle of pixels. Both ranges are half-open: the end is not included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) columns: (usize, usize),
    pub(super) rows: (usize, usize),
}

impl Canvas {
    pub(super) fn new() -> Canvas {
        let count = WIDTH * HEIGHT;
        Canvas { pixels: vec![[0; 3]; count], depths: vec![f32::INFINITY; count], solids: vec![0; count] }
    }

    pub(super) fn set(&mut self, column: usize, row: usize, depth: f32, paint: Paint) {
        let place = row * WIDTH + column;
        self.pixels[place] = paint.bytes();
        self.depths[place] = depth;
    }

    /// Draws a pixel of a solid. `solid` is the solid's number, by which `soften_outlines` finds its outline.
    pub(super) fn set_solid(&mut self, column: usize, row: usize, depth: f32, paint: Paint, solid: u16) {
        self.set(column, row, depth, paint);
        self.solids[row * WIDTH + column] = solid;
    }

    pub(super) fn depth(&self, column: usize, row: usize) -> f32 {
        self.depths[row * WIDTH + column]
    }

    /// Multiplies a pixel's colour by `factor`. A factor below 1 darkens the pixel.
    pub(super) fn light(&mut self, column: usize, row: usize, factor: f32) {
        let pixel = &mut self.pixels[row * WIDTH + column];
        *pixel = Paint::from_bytes(*pixel).lit(factor).bytes();
    }

    pub(super) fn paint(&mut self, column: usize, row: usize, paint: Paint) {
        self.pixels[row * WIDTH + column] = paint.bytes();
    }

    pub(super) fn soften_outlines(&mut self) {
        let sharp = self.pixels.clone();
        for row in 1..HEIGHT - 1 {
            for place in row * WIDTH + 1..(row + 1) * WIDTH - 1 {
                let around = [place - 1, place + 1, place - WIDTH, place + WIDTH];
                if around.iter().any(|other| self.solids[*other] != self.solids[place]) {
                    let sum = |part: usize| around.iter().map(|other| u16::from(sharp[*other][part])).sum::<u16>();
                    // The result fits into a byte, because it is a mean: the pixel counts four times, and each of its
                    // four neighbours once.
                    self.pixels[place] =
                        [0, 1, 2].map(|part| ((u16::from(sharp[place][part]) * 4 + sum(part)) / 8).to_le_bytes()[0]);
                }
            }
        }
    }

    /// Returns all pixels, row by row, with three bytes each.
    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.pixels.into_flattened()
    }
}

impl Frame {
    /// The smallest frame in the picture that contains these points. Returns the whole picture if a point is not
    /// ahead of the camera.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the picture before")]
    pub(super) fn around(view: &View, points: impl IntoIterator<Item = super::space::Vector>) -> Frame {
        let (mut least, mut most) = ((f32::INFINITY, f32::INFINITY), (f32::NEG_INFINITY, f32::NEG_INFINITY));
        for point in points {
            let Some((column, row)) = view.project(point) else {
                return Frame { columns: (0, WIDTH), rows: (0, HEIGHT) };
            };
            least = (least.0.min(column), least.1.min(row));
            most = (most.0.max(column), most.1.max(row));
        }
        let within = |place: f32, end: usize| place.clamp(0.0, super::view::as_float(end)) as usize;
        let columns = (within(least.0.floor(), WIDTH), within(most.0.ceil(), WIDTH));
        Frame { columns, rows: (within(least.1.floor(), HEIGHT), within(most.1.ceil(), HEIGHT)) }
    }

    pub(super) fn pixels(self) -> impl Iterator<Item = (usize, usize)> {
        (self.rows.0..self.rows.1).flat_map(move |row| (self.columns.0..self.columns.1).map(move |column| (column, row)))
    }
}
