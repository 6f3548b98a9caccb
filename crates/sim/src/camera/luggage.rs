//! The solids of each kind of luggage (suitcase, backpack, box …), in the size and colour of the piece.
//!
//! Lengths are in cells of half a metre. A piece on one cell is at most 0.76 long and wide. Each further cell adds 1
//! to its length.

use super::super::bag::{Bag, BagKind};
use super::solid::{Shape, Solid, Surface};
use super::space::{Paint, Vector, vector};

const RUBBER: Paint = Paint(34.0, 34.0, 37.0);
const STEEL: Paint = Paint(176.0, 180.0, 186.0);
const BRASS: Paint = Paint(220.0, 182.0, 84.0);
const RED_WIRE: Paint = Paint(226.0, 32.0, 32.0);
const YELLOW_WIRE: Paint = Paint(250.0, 214.0, 40.0);
const LABEL: Paint = Paint(240.0, 240.0, 236.0);

#[derive(Debug)]
pub(super) struct Model {
    pub(super) solids: Vec<Solid>,
    /// Half the size of the model's footprint on the floor: to the right, to the front.
    pub(super) foot: (f32, f32),
}

/// Adds the device of a test piece: a taped pipe, a small box and two wires between them. It is on both broad sides, so
/// from the narrow sides it may be hidden.
pub(super) fn add_device(model: &mut Model) {
    for side in [-1.0, 1.0_f32] {
        let depth = model.solids.iter().map(|solid| reach(&solid.shape, side)).fold(0.0, f32::max);
        let y = side * (depth + 0.03);
        let mut add = |shape, surface, paint| model.solids.push(Solid { shape, surface, paint });
        let pipe = |from: f32, to: f32, radius| Shape::Rod { from: vector(from, y, 0.2), to: vector(to, y, 0.2), radius };
        add(pipe(-0.2, 0.06, 0.045), Surface::Metal, STEEL);
        for band in [-0.15, 0.01] {
            add(pipe(band - 0.015, band + 0.015, 0.052), Surface::Plain, RUBBER);
        }
        let (middle, half) = (vector(0.18, y, 0.3), vector(0.06, 0.035, 0.05));
        add(Shape::Block { middle, half, radius: 0.01 }, Surface::Plain, RUBBER);
        for (start, end, paint) in [(-0.08, 0.14, RED_WIRE), (0.04, 0.2, YELLOW_WIRE)] {
            let (from, bend) = (vector(start, y, 0.24), vector((start + end) / 2.0, y, 0.38));
            add(Shape::Rod { from, to: bend, radius: 0.012 }, Surface::Plain, paint);
            add(Shape::Rod { from: bend, to: vector(end, y, 0.34), radius: 0.012 }, Surface::Plain, paint);
        }
    }
}

/// How far a shape extends to the front (`side` 1) or to the back (`side` −1), at the height of a device.
fn reach(shape: &Shape, side: f32) -> f32 {
    let (least_z, depth) = match shape {
        Shape::Block { middle, half, .. } => (middle.z - half.z, side * middle.y + half.y),
        Shape::Rod { from, to, radius } => (from.z.min(to.z), (side * from.y).max(side * to.y) + radius),
    };
    if least_z < 0.35 { depth } else { 0.0 }
}

#[expect(clippy::cast_possible_truncation, reason = "a picture is drawn in single precision")]
pub(super) fn model(bag: &Bag, cells: f32) -> Model {
    let paint = Paint(f32::from(bag.colour.red), f32::from(bag.colour.green), f32::from(bag.colour.blue));
    let piece = Making { paint, height: (bag.height_m / 0.5) as f32, longer: cells - 1.0, solids: Vec::new() };
    match bag.kind {
        BagKind::Suitcase => piece.suitcase(),
        BagKind::Backpack => piece.backpack(),
        BagKind::Trolley => piece.trolley(),
        BagKind::Duffel => piece.duffel(),
        BagKind::Box => piece.carton(),
        BagKind::Handbag => piece.handbag(),
    }
}

struct Making {
    paint: Paint,
    height: f32,
    longer: f32,
    solids: Vec<Solid>,
}

impl Making {
    fn block(&mut self, middle: Vector, half: Vector, radius: f32, surface: Surface, paint: Paint) {
        let most = half.x.min(half.y).min(half.z) * 0.98;
        self.solids.push(Solid { shape: Shape::Block { middle, half, radius: radius.min(most) }, surface, paint });
    }

    fn rod(&mut self, from: Vector, to: Vector, radius: f32, surface: Surface, paint: Paint) {
        self.solids.push(Solid { shape: Shape::Rod { from, to, radius }, surface, paint });
    }

    /// Adds a handle: an arch of rods, `rise` high, between two points of equal height.
    fn arch(&mut self, from: Vector, to: Vector, rise: f32, radius: f32, paint: Paint) {
        const PARTS: u8 = 8;
        let point = |part: u8| {
            let angle = std::f32::consts::PI * f32::from(part) / f32::from(PARTS);
            let share = 0.5 - 0.5 * angle.cos();
            from + (to - from) * share + vector(0.0, 0.0, rise * angle.sin())
        };
        for part in 0..PARTS {
            self.rod(point(part), point(part + 1), radius, Surface::Plain, paint);
        }
    }

    fn finish(self, x: f32, y: f32) -> Model {
        Model { solids: self.solids, foot: (x, y) }
    }

    fn wheels(&mut self, x: f32, y: f32) {
        for (side, front) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let middle = vector(side * (x - 0.06), front * (y - 0.05), 0.045);
            self.block(middle, vector(0.035, 0.045, 0.045), 0.03, Surface::Plain, RUBBER);
        }
    }

    fn telescope(&mut self, base: f32, behind: f32) {
        let (x, top) = (0.13, self.height - 0.03);
        for side in [-x, x] {
            self.rod(vector(side, behind, base), vector(side, behind, top), 0.014, Surface::Metal, STEEL);
        }
        self.rod(vector(-x - 0.02, behind, top), vector(x + 0.02, behind, top), 0.03, Surface::Plain, RUBBER);
    }

    fn suitcase(mut self) -> Model {
        let (x, y, top) = (0.35 + self.longer / 2.0, 0.19, self.height * 0.84);
        let (middle, half) = ((top + 0.07) / 2.0, (top - 0.07) / 2.0);
        self.block(vector(0.0, 0.0, middle), vector(x, y, half), 0.085, Surface::Shell, self.paint);
        self.wheels(x, y);
        self.telescope(top - 0.02, -0.1);
        self.arch(vector(-0.12, 0.06, top - 0.01), vector(0.12, 0.06, top - 0.01), 0.07, 0.02, RUBBER);
        self.block(vector(x, 0.0, middle + 0.1), vector(0.025, 0.03, 0.13), 0.02, Surface::Plain, RUBBER);
        for side in [-1.0, 1.0] {
            self.block(vector(0.0, side * y, top - 0.2), vector(0.075, 0.012, 0.03), 0.008, Surface::Metal, STEEL);
        }
        self.finish(x, y)
    }

    fn trolley(mut self) -> Model {
        let (x, y, top) = (0.32 + self.longer / 2.0, 0.19, self.height * 0.78);
        let (middle, half) = ((top + 0.06) / 2.0, (top - 0.06) / 2.0);
        self.block(vector(0.0, 0.0, middle), vector(x, y, half), 0.05, Surface::Cloth, self.paint);
        for side in [-1.0, 1.0] {
            let lower = vector(0.0, side * (y + 0.02), middle - half * 0.38);
            self.block(lower, vector(x * 0.84, 0.06, half * 0.48), 0.04, Surface::Cloth, self.paint.lit(1.25));
            let upper = vector(0.0, side * (y + 0.005), middle + half * 0.48);
            self.block(upper, vector(x * 0.84, 0.045, half * 0.28), 0.035, Surface::Cloth, self.paint.lit(1.25));
        }
        self.wheels(x, y);
        self.telescope(top - 0.02, -0.08);
        self.arch(vector(-0.11, 0.03, top - 0.01), vector(0.11, 0.03, top - 0.01), 0.06, 0.02, RUBBER);
        self.rod(vector(0.1, 0.1, top + 0.02), vector(0.15, 0.21, top - 0.14), 0.008, Surface::Plain, LABEL);
        self.block(vector(0.16, y + 0.075, top - 0.24), vector(0.05, 0.006, 0.085), 0.005, Surface::Plain, LABEL);
        self.finish(x, y + 0.04)
    }

    fn backpack(mut self) -> Model {
        let (x, y, h) = (0.29 + self.longer / 2.0, 0.17, self.height - 0.06);
        self.block(vector(0.0, 0.0, h / 2.0), vector(x, y, h / 2.0), 0.16, Surface::Plain, self.paint);
        self.block(vector(0.0, 0.13, h * 0.30), vector(x * 0.78, 0.11, h * 0.24), 0.08, Surface::Cloth, self.paint.lit(0.72));
        self.block(vector(0.0, 0.12, h * 0.69), vector(x * 0.66, 0.08, h * 0.12), 0.06, Surface::Cloth, self.paint.lit(0.82));
        for side in [-1.0, 1.0] {
            self.block(vector(side * x, 0.0, h * 0.26), vector(0.06, 0.11, h * 0.2), 0.055, Surface::Plain, self.paint.lit(0.6));
            self.rod(vector(side * 0.13, -y, h * 0.92), vector(side * 0.17, -y - 0.06, h * 0.6), 0.038, Surface::Plain, RUBBER);
            self.rod(vector(side * 0.17, -y - 0.06, h * 0.6), vector(side * 0.23, -y, h * 0.12), 0.03, Surface::Plain, RUBBER);
            self.rod(
                vector(side * x * 0.92, 0.12, h * 0.5),
                vector(side * x * 0.6, 0.2, h * 0.53),
                0.014,
                Surface::Plain,
                RUBBER,
            );
        }
        let zip = h * 0.83;
        self.rod(vector(-x * 0.7, 0.15, zip), vector(x * 0.7, 0.15, zip), 0.014, Surface::Metal, STEEL);
        self.arch(vector(-0.07, -0.06, h - 0.02), vector(0.07, -0.06, h - 0.02), 0.09, 0.02, RUBBER);
        self.finish(x + 0.03, y + 0.06)
    }

    fn duffel(mut self) -> Model {
        let (x, h) = (0.38 + self.longer / 2.0, self.height * 0.86);
        let y = (h * 0.48).min(0.34);
        self.block(vector(0.0, 0.0, h / 2.0), vector(x, y, h / 2.0), y * 0.92, Surface::Roll, self.paint);
        let strap = 0.42 * x;
        for side in [-1.0, 1.0] {
            let foot = h * 0.8;
            let (from, to) = (vector(-strap, side * y * 0.72, foot), vector(strap, side * y * 0.72, foot));
            self.arch(from, to, self.height - foot, 0.024, RUBBER);
            self.block(vector(side * x, 0.0, h * 0.56), vector(0.02, 0.1, 0.025), 0.015, Surface::Plain, RUBBER);
        }
        self.block(
            vector(0.0, y * 0.98, h * 0.45),
            vector(strap * 0.7, 0.03, h * 0.2),
            0.025,
            Surface::Cloth,
            self.paint.lit(0.78),
        );
        self.finish(x - 0.06, y * 0.8)
    }

    fn carton(mut self) -> Model {
        let (x, y, z) = (0.36 + self.longer / 2.0, 0.30, self.height / 2.0);
        self.block(vector(0.0, 0.0, z), vector(x, y, z), 0.012, Surface::Board, self.paint);
        self.finish(x, y)
    }

    fn handbag(mut self) -> Model {
        let (x, y, h) = (0.27 + self.longer / 2.0, 0.12, self.height * 0.62);
        self.block(vector(0.0, 0.0, h / 2.0), vector(x, y, h / 2.0), 0.09, Surface::Plain, self.paint);
        for side in [-1.0, 1.0] {
            let flap = vector(0.0, side * (y - 0.005), h * 0.71);
            self.block(flap, vector(x * 0.97, 0.03, h * 0.27), 0.03, Surface::Cloth, self.paint.lit(0.78));
            self.block(vector(0.0, side * (y + 0.03), h * 0.44), vector(0.035, 0.012, 0.03), 0.01, Surface::Metal, BRASS);
            let foot = h * 0.9;
            let (from, to) = (vector(-x * 0.62, side * 0.06, foot), vector(x * 0.62, side * 0.06, foot));
            self.arch(from, to, self.height - foot, 0.018, self.paint.lit(0.6));
            for end in [-0.62, 0.62] {
                self.block(vector(end * x, side * 0.075, foot), vector(0.022, 0.022, 0.03), 0.015, Surface::Metal, BRASS);
            }
        }
        self.finish(x, y)
    }
}
