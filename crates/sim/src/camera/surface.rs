//! The look of a solid's surface: ribs, seams, tape, print, gloss, and the light on it.

use super::font;
use super::solid::{Shape, Solid, Surface};
use super::space::{HAZE, Paint, Vector, smooth, vector, wrapped};

const DARK: Paint = Paint(30.0, 30.0, 33.0);
const TAPE: Paint = Paint(205.0, 186.0, 142.0);
const PRINT: Paint = Paint(150.0, 32.0, 28.0);
const BRASS: Paint = Paint(214.0, 178.0, 90.0);
const GLARE: Paint = Paint(255.0, 255.0, 250.0);

impl Surface {
    /// The visible colour of a point, after lighting and haze.
    pub(super) fn seen(self, solid: &Solid, point: Vector, direction: Vector, light: Vector, depth: f32) -> Paint {
        let normal = solid.shape.normal(point);
        let plain = self.pattern(solid, point, normal);
        let facing = normal.dot(light).max(0.0);
        let ground = 0.66 + 0.34 * smooth(0.0, 0.35, point.z);
        let lit = plain.lit((0.42 + 0.56 * facing + 0.16 * normal.z.max(0.0)) * ground);
        let mirror = direction - normal * (2.0 * normal.dot(direction));
        let glare = mirror.dot(light).max(0.0).powi(16) * self.gloss();
        lit.mixed(GLARE, glare).mixed(HAZE, smooth(3.0, 40.0, depth) * 0.85)
    }

    const fn gloss(self) -> f32 {
        match self {
            Surface::Metal => 0.8,
            Surface::Shell => 0.45,
            Surface::Plain | Surface::Cloth | Surface::Roll | Surface::Board => 0.06,
        }
    }

    fn pattern(self, solid: &Solid, point: Vector, normal: Vector) -> Paint {
        let Shape::Block { middle, half, .. } = solid.shape else { return solid.paint };
        let at = point - middle;
        let share = vector(at.x / half.x, at.y / half.y, at.z / half.z);
        match self {
            Surface::Plain | Surface::Metal => solid.paint,
            Surface::Shell => shell(solid.paint, at, share, normal),
            Surface::Cloth => cloth(solid.paint, share, normal),
            Surface::Roll => roll(solid.paint, at, half, normal),
            Surface::Board => board(solid.paint, at, half, normal),
        }
    }
}

fn shell(paint: Paint, at: Vector, share: Vector, normal: Vector) -> Paint {
    if at.y.abs() < 0.012 {
        return DARK;
    }
    let on_broad_side = normal.y.abs() > 0.5 && share.z.abs() < 0.86 && share.x.abs() < 0.88;
    let rib = wrapped(at.x + 0.03, 0.1);
    if on_broad_side && rib < 0.022 {
        paint.lit(0.66)
    } else if on_broad_side && rib < 0.036 {
        paint.lit(1.22)
    } else {
        paint
    }
}

fn cloth(paint: Paint, share: Vector, normal: Vector) -> Paint {
    let (across, up) = (share.x.abs(), share.z.abs());
    let on_broad_side = normal.y.abs() > 0.55;
    let seam = across.max(up);
    if on_broad_side && (0.80..0.85).contains(&seam) {
        paint.lit(0.45)
    } else if on_broad_side && (0.85..0.87).contains(&seam) {
        paint.lit(1.3)
    } else {
        paint
    }
}

fn roll(paint: Paint, at: Vector, half: Vector, normal: Vector) -> Paint {
    let strap = (at.x.abs() - 0.42 * half.x).abs();
    if strap < 0.045 {
        if strap > 0.036 { paint.lit(0.4) } else { DARK.lit(1.5) }
    } else if at.x.abs() > half.x - 0.1 {
        paint.lit(0.6)
    } else if at.y.abs() < 0.014 && normal.z > 0.8 {
        BRASS
    } else if at.y.abs() < 0.032 && normal.z > 0.8 {
        DARK
    } else {
        paint
    }
}

fn board(paint: Paint, at: Vector, half: Vector, normal: Vector) -> Paint {
    let on_broad_side = normal.y.abs() > 0.5;
    let on_top = normal.z > 0.5;
    if (on_top || on_broad_side && at.z > half.z * 0.52) && at.x.abs() < 0.065 {
        return if on_top && at.x.abs() < 0.004 { TAPE.lit(0.8) } else { TAPE };
    }
    if on_top && at.x.abs() < 0.075 {
        return paint.lit(0.8);
    }
    // The print must be readable from outside. So `across` grows with `x` on the front of the box, but against `x` on
    // its back. The two ends of the box differ in the same way.
    let across = if on_broad_side { at.x * normal.y.signum() } else { -at.y * normal.x.signum() };
    let down = half.z - at.z;
    let printed = font::inked("FRAGILE", (across + 0.26) / 0.0127, (down - half.z * 1.15) / 0.017);
    let arrows = arrow(across + 0.2, at.z + half.z * 0.68) || arrow(across + 0.08, at.z + half.z * 0.68);
    if !on_top && (printed || arrows) { PRINT } else { paint.lit(if on_top { 1.05 } else { 1.0 }) }
}

/// Whether a point belongs to the printed arrow that means *this side up*.
fn arrow(across: f32, up: f32) -> bool {
    let shaft = across.abs() < 0.012 && (-0.06..0.02).contains(&up);
    let head = (0.0..0.06).contains(&up) && across.abs() < (0.06 - up) * 0.7;
    shaft || head
}
