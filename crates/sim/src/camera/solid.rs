//! Draws solids (boxes with round edges, rods with round ends). A ray is cast through every pixel that a solid may
//! cover. `luggage` has the solids of a piece of luggage, and `surface` has the look of their surfaces.

use super::canvas::{Canvas, Frame};
use super::space::{Paint, Vector, smooth, vector};
use super::view::{EYE, HORIZON, View, as_float};

/// A shape with its surface. Coordinates are right, front and up, from the middle of the piece's foot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    pub(super) shape: Shape,
    pub(super) surface: Surface,
    pub(super) paint: Paint,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Surface {
    /// One colour, dull.
    Plain,
    /// One colour, shiny.
    Metal,
    /// Ribbed hard plastic with a zip round the middle.
    Shell,
    /// Cloth with a seam along the edges of its broad sides.
    Cloth,
    /// Cloth with dark ends, straps round it and a zip on top.
    Roll,
    /// Brown board with tape and print.
    Board,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// A box: its middle, half its size, and the radius of its rounded edges.
    Block {
        middle: Vector,
        half: Vector,
        radius: f32,
    },
    Rod {
        from: Vector,
        to: Vector,
        radius: f32,
    },
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    pub(super) foot: Vector,
    /// Cosine and sine of the piece's angle about the vertical axis.
    pub(super) turn: (f32, f32),
}

impl Placement {
    fn to_hall(self, point: Vector) -> Vector {
        self.foot + point.turned(self.turn)
    }

    fn direction_to_piece(self, direction: Vector) -> Vector {
        direction.turned((self.turn.0, -self.turn.1))
    }

    fn to_piece(self, point: Vector) -> Vector {
        self.direction_to_piece(point - self.foot)
    }
}

/// Draws a solid. Pixels that already show something nearer are left as they are. `number` is the solid's number, by
/// which outlines are found and softened.
pub(super) fn draw(canvas: &mut Canvas, view: &View, place: Placement, solid: &Solid, number: u16) {
    let (least, most) = solid.shape.bounds();
    let corners = corners(least, most).map(|corner| place.to_hall(corner));
    if corners.iter().all(|corner| view.depth(*corner) < 0.1) {
        return;
    }
    let eye = place.to_piece(view.eye);
    let light = place.direction_to_piece(view.lamp());
    let frame = Frame::around(view, corners);
    let step = place.direction_to_piece(view.column_step());
    for row in frame.rows.0..frame.rows.1 {
        let first = place.direction_to_piece(view.pixel(frame.columns.0, row));
        for column in frame.columns.0..frame.columns.1 {
            // The ray vector goes one cell forward. So the multiple of this vector at which the ray hits is also the
            // depth in cells.
            let ray = first + step * as_float(column - frame.columns.0);
            let Some(depth) = solid.shape.hit(eye, ray).filter(|depth| *depth < canvas.depth(column, row)) else { continue };
            let paint = solid.surface.seen(solid, eye + ray * depth, ray.unit(), light, depth);
            canvas.set_solid(column, row, depth, paint, number);
        }
    }
}

/// Darkens the floor under and around a piece. `half` is half the size of its foot. Call it before any solid is
/// drawn.
pub(super) fn draw_shadow(canvas: &mut Canvas, view: &View, place: Placement, half: (f32, f32)) {
    const REACH: f32 = 0.4;
    let (x, y) = (half.0 + REACH, half.1 + REACH);
    let corners = [(-x, -y), (-x, y), (x, -y), (x, y)].map(|(x, y)| place.to_hall(vector(x, y, 0.0)));
    if corners.iter().all(|corner| view.depth(*corner) < 0.1) {
        return;
    }
    for (column, row) in Frame::around(view, corners).pixels() {
        if as_float(row) < HORIZON {
            continue;
        }
        let depth = EYE / view.fall(row);
        if (canvas.depth(column, row) - depth).abs() > 1e-3 {
            continue;
        }
        let at = place.to_piece(view.eye + view.pixel(column, row) * depth);
        let beside = vector((at.x.abs() - half.0).max(0.0), (at.y.abs() - half.1).max(0.0), 0.0).length();
        canvas.light(column, row, 1.0 - 0.62 * (1.0 - smooth(0.0, REACH, beside)));
    }
}

fn corners(least: Vector, most: Vector) -> [Vector; 8] {
    std::array::from_fn(|n| {
        let pick = |bit: usize, a: f32, b: f32| if n >> bit & 1 == 0 { a } else { b };
        vector(pick(0, least.x, most.x), pick(1, least.y, most.y), pick(2, least.z, most.z))
    })
}

impl Shape {
    fn bounds(&self) -> (Vector, Vector) {
        match *self {
            Shape::Block { middle, half, .. } => (middle - half, middle + half),
            Shape::Rod { from, to, radius } => {
                let r = vector(radius, radius, radius);
                let least = vector(from.x.min(to.x), from.y.min(to.y), from.z.min(to.z));
                let most = vector(from.x.max(to.x), from.y.max(to.y), from.z.max(to.z));
                (least - r, most + r)
            }
        }
    }

    /// Distance to the shape along a direction, as a multiple of the direction vector. `None` if the ray misses the
    /// shape.
    fn hit(&self, eye: Vector, direction: Vector) -> Option<f32> {
        match *self {
            Shape::Block { middle, half, radius } => hit_block(eye - middle, direction, half, radius),
            Shape::Rod { from, to, radius } => hit_rod(eye, direction, from, to, radius),
        }
        .filter(|way| *way > 0.0)
    }

    pub(super) fn normal(&self, point: Vector) -> Vector {
        match *self {
            Shape::Block { middle, half, radius } => {
                let (at, core) = (point - middle, half.each(|side| side - radius));
                let beyond = |place: f32, core: f32| (place.abs() - core).max(0.0) * place.signum();
                vector(beyond(at.x, core.x), beyond(at.y, core.y), beyond(at.z, core.z)).unit()
            }
            Shape::Rod { from, to, .. } => {
                let axis = to - from;
                let along = ((point - from).dot(axis) / axis.dot(axis)).clamp(0.0, 1.0);
                (point - from - axis * along).unit()
            }
        }
    }
}

/// Intersects a ray with a box. Near the edges of the box, the ray is intersected with the rounding in the octant
/// that it hits. The formulas are from Inigo Quilez's collection.
fn hit_block(eye: Vector, direction: Vector, half: Vector, radius: f32) -> Option<f32> {
    let span = |place: f32, d: f32, half: f32| {
        let (a, b) = ((-half - place) / d, (half - place) / d);
        (a.min(b), a.max(b))
    };
    let (x, y, z) = (span(eye.x, direction.x, half.x), span(eye.y, direction.y, half.y), span(eye.z, direction.z, half.z));
    let (enters, leaves) = (x.0.max(y.0).max(z.0), x.1.min(y.1).min(z.1));
    if enters > leaves || leaves < 0.0 {
        return None;
    }
    let met = eye + direction * enters;
    let core = half.each(|side| side - radius);
    let beyond = vector(met.x.abs() - core.x, met.y.abs() - core.y, met.z.abs() - core.z);
    if beyond.x.max(beyond.y).min(beyond.y.max(beyond.z)).min(beyond.z.max(beyond.x)) < 0.0 {
        return Some(enters);
    }
    let half_body = |up: f32| {
        let mirrored = |v: Vector| vector(v.x * met.x.signum(), v.y * met.y.signum(), v.z * up);
        hit_rounding(mirrored(eye), mirrored(direction), core, radius)
    };
    let up = met.z.signum();
    let near = half_body(up);
    // A ray can enter a flat box above its middle and hit the rounding below the middle. So the lower half may be
    // tried too.
    if near.is_some_and(|way| (eye.z + direction.z * way) * up > -core.z) {
        return near;
    }
    [near, half_body(-up)].into_iter().flatten().min_by(f32::total_cmp)
}

/// Intersects a ray with the three rounded edges and the rounded corner of the first octant.
fn hit_rounding(eye: Vector, d: Vector, core: Vector, radius: f32) -> Option<f32> {
    let o = eye - core;
    let corner = root(d.dot(d), o.dot(d), o.dot(o) - radius * radius);
    let edge = |a: f32, b: f32, c: f32, place: f32, direction: f32, core: f32| {
        root(a, b, c - radius * radius).filter(|way| *way > 0.0 && (place + direction * way).abs() < core)
    };
    let along_x = edge(d.y * d.y + d.z * d.z, o.y * d.y + o.z * d.z, o.y * o.y + o.z * o.z, eye.x, d.x, core.x);
    let along_y = edge(d.z * d.z + d.x * d.x, o.z * d.z + o.x * d.x, o.z * o.z + o.x * o.x, eye.y, d.y, core.y);
    let along_z = edge(d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y, o.x * o.x + o.y * o.y, eye.z, d.z, core.z);
    [corner, along_x, along_y, along_z].into_iter().flatten().min_by(f32::total_cmp)
}

/// Returns the smaller root of a t² + 2 b t + c = 0.
fn root(a: f32, b: f32, c: f32) -> Option<f32> {
    let h = b * b - a * c;
    (h > 0.0).then(|| (-b - h.sqrt()) / a)
}

fn hit_rod(eye: Vector, direction: Vector, from: Vector, to: Vector, radius: f32) -> Option<f32> {
    let (axis, start) = (to - from, eye - from);
    let (length, along, begin) = (axis.dot(axis), axis.dot(direction), axis.dot(start));
    let square = direction.dot(direction);
    let a = length * square - along * along;
    let b = length * direction.dot(start) - begin * along;
    let c = length * start.dot(start) - begin * begin - radius * radius * length;
    let way = root(a, b, c)?;
    let place = begin + way * along;
    if place > 0.0 && place < length {
        return Some(way);
    }
    let end = if place <= 0.0 { start } else { eye - to };
    root(square, direction.dot(end), end.dot(end) - radius * radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(shape: Shape, eye: Vector, direction: Vector, expect: Option<f32>) {
        match (shape.hit(eye, direction), expect) {
            (Some(found), Some(expect)) => assert!((found - expect).abs() < 1e-4, "{found}"),
            (found, expect) => assert_eq!(found, expect),
        }
    }

    #[test]
    fn a_ray_meets_faces_rounded_edges_and_nothing_beside() {
        let block = Shape::Block { middle: vector(0.0, 0.0, 0.0), half: vector(1.0, 1.0, 1.0), radius: 0.5 };
        let east = vector(1.0, 0.0, 0.0);
        check(block, vector(-3.0, 0.0, 0.0), east, Some(2.0));
        check(block, vector(-3.0, 0.75, 0.0), east, Some(2.5 - 0.1875f32.sqrt()));
        check(block, vector(-3.0, 0.95, 0.95), east, None);
        check(block, vector(-3.0, 1.1, 0.0), east, None);
        check(block, vector(3.0, 0.0, 0.0), east, None);
    }

    #[test]
    fn a_ray_meets_a_rod_at_its_side_and_at_its_round_end() {
        let rod = Shape::Rod { from: vector(0.0, 0.0, 0.0), to: vector(0.0, 0.0, 2.0), radius: 0.5 };
        check(rod, vector(-3.0, 0.0, 1.0), vector(1.0, 0.0, 0.0), Some(2.5));
        check(rod, vector(-3.0, 0.0, 2.3), vector(1.0, 0.0, 0.0), Some(2.6));
        check(rod, vector(-3.0, 0.0, 2.6), vector(1.0, 0.0, 0.0), None);
    }
}
