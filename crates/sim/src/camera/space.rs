//! Points, directions and colours of the picture, in single precision.

use std::ops::{Add, Mul, Sub};

/// A point or a direction. `x` points to the east of the hall or to the right of a piece. `y` points to the south or
/// to the piece's front. `z` points up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vector {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) z: f32,
}

pub(super) const fn vector(x: f32, y: f32, z: f32) -> Vector {
    Vector { x, y, z }
}

impl Vector {
    pub(super) fn dot(self, other: Vector) -> f32 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    pub(super) fn length(self) -> f32 {
        self.dot(self).sqrt()
    }

    pub(super) fn unit(self) -> Vector {
        self * (1.0 / self.length().max(1e-9))
    }

    pub(super) fn each(self, change: impl Fn(f32) -> f32) -> Vector {
        vector(change(self.x), change(self.y), change(self.z))
    }

    /// Turns the vector about the vertical axis, by the angle with this cosine and sine.
    pub(super) fn turned(self, (cos, sin): (f32, f32)) -> Vector {
        vector(cos * self.x - sin * self.y, sin * self.x + cos * self.y, self.z)
    }
}

impl Add for Vector {
    type Output = Vector;
    fn add(self, other: Vector) -> Vector {
        vector(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl Sub for Vector {
    type Output = Vector;
    fn sub(self, other: Vector) -> Vector {
        vector(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<f32> for Vector {
    type Output = Vector;
    fn mul(self, factor: f32) -> Vector {
        vector(self.x * factor, self.y * factor, self.z * factor)
    }
}

/// A colour. Its parts are 0–255, but may leave this range while colours are mixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Paint(pub(super) f32, pub(super) f32, pub(super) f32);

/// The colour of the haze, into which distant things fade.
pub(super) const HAZE: Paint = Paint(206.0, 214.0, 222.0);

impl Paint {
    /// Multiplies the colour by `factor`. A factor above 1 makes it lighter, a factor below 1 darker.
    pub(super) fn lit(self, factor: f32) -> Paint {
        Paint(self.0 * factor, self.1 * factor, self.2 * factor)
    }

    pub(super) fn mixed(self, other: Paint, share: f32) -> Paint {
        let mix = |a: f32, b: f32| a + (b - a) * share;
        Paint(mix(self.0, other.0), mix(self.1, other.1), mix(self.2, other.2))
    }

    /// Converts to bytes. Parts outside 0–255 become 0 or 255.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast from float to byte saturates")]
    pub(super) const fn bytes(self) -> [u8; 3] {
        [self.0 as u8, self.1 as u8, self.2 as u8]
    }

    pub(super) fn from_bytes(bytes: [u8; 3]) -> Paint {
        let [red, green, blue] = bytes.map(f32::from);
        Paint(red, green, blue)
    }
}

/// Rises smoothly from 0 to 1 while `at` goes from `from` to `to`.
pub(super) fn smooth(from: f32, to: f32, at: f32) -> f32 {
    let share = ((at - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// The remainder of `at` divided by `period`, 0–`period`, also for a negative `at`.
pub(super) fn wrapped(at: f32, period: f32) -> f32 {
    at - floored(at / period) * period
}

/// The greatest whole number that is not above `place`. It converts through an integer, because `f32::floor` is a
/// function call on plain x86-64. A picture would need half a million such calls.
#[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "places in a hall are a few thousand at most")]
pub(super) fn floored(place: f32) -> f32 {
    let cut = place as i32 as f32;
    if cut > place { cut - 1.0 } else { cut }
}
