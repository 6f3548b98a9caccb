//! Draws the empty hall: tiled floor, walls with skirting, windows and signs, ceiling with strips of light. For each
//! column of the picture, a ray is followed to the first wall. `solid` draws the luggage afterwards.

use super::super::hall::{Hall, Truth};
use super::canvas::Canvas;
use super::font;
use super::space::{HAZE, Paint, Vector, floored, smooth, wrapped};
use super::view::{EYE, HEIGHT, View, WIDTH};
use hallsweep_core::units::Cell;

/// The height of the hall, in cells.
const CEILING: f32 = 6.0;

/// Greatest distance at which walls are drawn, in cells. The haze would hide walls further away.
const FAR: f32 = 120.0;

const FLOOR: Paint = Paint(176.0, 178.0, 180.0);
const GROUT: Paint = Paint(126.0, 128.0, 132.0);
const PLASTER: Paint = Paint(222.0, 220.0, 213.0);
const CONCRETE: Paint = Paint(168.0, 166.0, 162.0);
const SKIRTING: Paint = Paint(70.0, 74.0, 80.0);
const BAND: Paint = Paint(38.0, 84.0, 142.0);
const SKY: Paint = Paint(170.0, 205.0, 236.0);
const GROUND: Paint = Paint(150.0, 160.0, 150.0);
const FRAME: Paint = Paint(92.0, 98.0, 106.0);
const SIGN: Paint = Paint(242.0, 190.0, 24.0);
const INK: Paint = Paint(24.0, 24.0, 26.0);
const CEILING_PAINT: Paint = Paint(190.0, 194.0, 198.0);
const LAMP: Paint = Paint(255.0, 254.0, 246.0);

struct Face {
    /// Distance from the camera in the direction of view, in cells.
    depth: f32,
    /// How much of the wall's colour the haze replaces, 0–1.
    haze: f32,
    /// Position along the wall, in cells.
    along: f32,
    /// Whether the wall runs from north to south. Such walls are drawn a little darker.
    meridian: bool,
    /// Whether the wall is the hall's outer wall rather than a pillar or counter.
    outer: bool,
}

/// Draws floor, walls and ceiling over the whole canvas. It goes row by row, because pixels are stored in this order.
pub(super) fn draw(canvas: &mut Canvas, hall: &Hall, view: &View) {
    let directions: Vec<Vector> = (0..WIDTH).map(|column| view.column(column)).collect();
    let faces: Vec<Face> = directions.iter().map(|direction| walk(hall, view.eye, *direction)).collect();
    for row in 0..HEIGHT {
        let fall = view.fall(row);
        let ground = FloorRow::at(EYE / fall);
        let roof = (EYE - CEILING) / fall;
        for (column, (face, direction)) in faces.iter().zip(&directions).enumerate() {
            let height = EYE - fall * face.depth;
            if height < 0.0 {
                canvas.set(column, row, ground.depth, ground.paint(view.eye + *direction * ground.depth, face.depth));
            } else if height > CEILING {
                canvas.set(column, row, roof, ceiling(view.eye + *direction * roof).mixed(HAZE, haze(roof)));
            } else {
                canvas.set(column, row, face.depth, wall(face, height).mixed(HAZE, face.haze));
            }
        }
    }
}

/// Returns the wall that a ray from the eye meets first. A ray that meets no wall ends after about `FAR` cells.
fn walk(hall: &Hall, eye: Vector, direction: Vector) -> Face {
    let (x, y) = (eye.x + 0.5, eye.y + 0.5);
    let mut cell = Cell::new(whole(x.floor()), whole(y.floor()));
    let step = |d: f32| if d < 0.0 { -1 } else { 1 };
    let first = |place: f32, d: f32| if d < 0.0 { (place - place.floor()) / -d } else { (1.0 + place.floor() - place) / d };
    let (mut next_x, mut next_y) = (first(x, direction.x), first(y, direction.y));
    let (mut depth, mut meridian) = (0.0, false);
    while depth < FAR && hall.truth(cell) != Truth::Wall {
        meridian = next_x < next_y;
        if meridian {
            (depth, next_x) = (next_x, next_x + 1.0 / direction.x.abs());
            cell.x += step(direction.x);
        } else {
            (depth, next_y) = (next_y, next_y + 1.0 / direction.y.abs());
            cell.y += step(direction.y);
        }
    }
    let depth = depth.max(0.01);
    // The position grows from left to right in the picture, so that signs are not mirrored.
    let along = if meridian {
        (y + direction.y * depth) * direction.x.signum()
    } else {
        (x + direction.x * depth) * -direction.y.signum()
    };
    Face { depth, haze: haze(depth), along, meridian, outer: !hall.bounds().contains(cell) }
}

/// The floor in one row of the picture. All points of the row have the same depth. The floor has square tiles of half
/// a cell, with grout between them. The pattern fades with distance, because distant tiles would flicker.
struct FloorRow {
    depth: f32,
    haze: f32,
    /// Width of the grout, in cells, and how strongly it is visible, 0–1.
    grout: (f32, f32),
    tones: f32,
}

impl FloorRow {
    fn at(depth: f32) -> FloorRow {
        let grout = (0.006 + depth * 0.0025, 1.0 - smooth(3.0, 9.0, depth));
        FloorRow { depth, haze: haze(depth), grout, tones: 0.10 * (1.0 - smooth(4.0, 14.0, depth)) }
    }

    fn paint(&self, at: Vector, wall_depth: f32) -> Paint {
        let (u, v) = (wrapped(at.x, 0.5), wrapped(at.y, 0.5));
        let edge = u.min(v).min(0.5 - u).min(0.5 - v);
        let tile = FLOOR.lit(1.0 + (tile_tone(at) - 0.5) * self.tones);
        let (width, plainness) = self.grout;
        let tile = if edge < width { tile.mixed(GROUT, (1.0 - edge / width) * plainness) } else { tile };
        let from_wall = wall_depth - self.depth;
        let tile = if from_wall < 0.5 { tile.lit(0.72 + 0.28 * smooth(0.0, 0.5, from_wall)) } else { tile };
        tile.mixed(HAZE, self.haze)
    }
}

/// A brightness from 0 to 1 that differs between neighbouring tiles.
fn tile_tone(at: Vector) -> f32 {
    let tile = |place: f32| whole(floored(place * 2.0)).cast_unsigned();
    let mixed = tile(at.x).wrapping_mul(0x9e37_79b1) ^ tile(at.y).wrapping_mul(0x85eb_ca77);
    let [.., top] = mixed.wrapping_mul(0xc2b2_ae3d).to_le_bytes();
    f32::from(top) / 255.0
}

fn wall(face: &Face, height: f32) -> Paint {
    let seam = wrapped(face.along, 2.0);
    let paint = if height < 0.2 {
        SKIRTING.lit(if height > 0.18 { 1.4 } else { 1.0 })
    } else if !face.outer {
        pillar(face.along, height)
    } else if height > 1.7 && height < 4.6 {
        window(face.along, height)
    } else if (1.2..1.34).contains(&height) {
        BAND
    } else if seam < 0.025 {
        PLASTER.lit(0.8)
    } else {
        PLASTER.lit(0.94 + 0.03 * height.min(2.0))
    };
    paint.lit(if face.meridian { 0.88 } else { 1.0 })
}

/// The colour of pillars and counters: concrete, with a hazard stripe at the height of a bumper.
fn pillar(along: f32, height: f32) -> Paint {
    let plain = CONCRETE.lit(0.9 + 0.1 * (height * 0.5).min(1.0));
    if (0.34..0.56).contains(&height) {
        if wrapped(along + height, 0.3) < 0.15 { SIGN } else { INK }
    } else if wrapped(along + 0.5, 1.0) < 0.02 || wrapped(height, 2.0) < 0.02 {
        plain.lit(0.8)
    } else {
        plain
    }
}

/// The colour of the outer wall: wide windows, and a sign to the gates between two windows.
fn window(along: f32, height: f32) -> Paint {
    let place = wrapped(along, 5.0);
    if place >= 3.4 {
        return sign(place - 3.4, height);
    }
    let bar = !(0.06..3.34).contains(&place) || (place - 1.7).abs() < 0.04 || !(1.78..4.5).contains(&height);
    if bar {
        FRAME
    } else if height < 2.1 {
        GROUND.mixed(SKY, smooth(1.9, 2.1, height))
    } else {
        SKY.mixed(LAMP, smooth(4.4, 2.1, height) * 0.6)
    }
}

fn sign(across: f32, height: f32) -> Paint {
    if !(0.1..1.5).contains(&across) || !(2.0..2.5).contains(&height) {
        return PLASTER;
    }
    let ink = font::inked("GATES", (across - 0.25) / 0.038, (2.42 - height) / 0.048);
    if ink { INK } else { SIGN }
}

fn ceiling(at: Vector) -> Paint {
    let strip = wrapped(at.x, 4.0);
    if (1.6..2.4).contains(&strip) && wrapped(at.y, 6.0) < 5.2 { LAMP } else { CEILING_PAINT }
}

/// How much of a colour the haze replaces at this distance, 0–1.
fn haze(depth: f32) -> f32 {
    smooth(2.0, 40.0, depth) * 0.85
}

#[expect(clippy::cast_possible_truncation, reason = "halls are a few thousand cells wide, and a cast saturates")]
const fn whole(place: f32) -> i32 {
    place as i32
}
