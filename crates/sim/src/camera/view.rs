//! The position of the camera, the direction of each pixel, and the pixel of each point.
//!
//! The camera is not tilted. Instead, the lens is shifted: the horizon is above the middle of the picture, but
//! upright lines stay upright. So the distance to a wall can be computed once for each column.

use super::super::drive::BodyPose;
use super::space::{Vector, vector};

pub(super) const WIDTH: usize = 640;
pub(super) const HEIGHT: usize = 480;

/// The row of the horizon, in pixels.
pub(super) const HORIZON: f32 = 188.0;

/// The focal length for a photo of a thing in the next cell, in pixels. It gives a wide-angle view, like a robot's
/// camera.
const FOCAL: f32 = 310.0;

/// The height of the camera, in cells: 0.4 m in a hall of half-metre cells.
pub(super) const EYE: f32 = 0.8;

/// Distance of the camera behind the robot's middle, in cells. Its mast is at the rear edge.
const BEHIND: f32 = 0.40;

/// A camera in the hall. All lengths are in cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub(super) eye: Vector,
    forward: Vector,
    right: Vector,
    /// Focal length in pixels.
    focal: f32,
}

impl View {
    #[expect(clippy::cast_possible_truncation, reason = "a picture is drawn in single precision")]
    /// Makes the view of a robot's camera. The camera zooms, so that a thing `away` cells ahead looks as large as a
    /// thing in the next cell.
    pub(super) fn of(body: BodyPose, cell_m: f64, away: u16) -> View {
        let (dx, dy) = body.ahead();
        let forward = vector(dx as f32, dy as f32, 0.0);
        let middle = vector((body.x_m / cell_m) as f32, (body.y_m / cell_m) as f32, EYE);
        let focal = FOCAL * (f32::from(away) + BEHIND) / (1.0 + BEHIND);
        View { eye: middle - forward * BEHIND, forward, right: vector(-forward.y, forward.x, 0.0), focal }
    }

    /// The horizontal direction of a column, as a vector that goes one cell forward.
    pub(super) fn column(&self, column: usize) -> Vector {
        self.forward + self.right * ((as_float(column) + 0.5 - as_float(WIDTH) / 2.0) / self.focal)
    }

    pub(super) fn column_step(&self) -> Vector {
        self.right * (1.0 / self.focal)
    }

    /// How far the line of sight of a row falls for each cell forward, in cells.
    pub(super) fn fall(&self, row: usize) -> f32 {
        (as_float(row) + 0.5 - HORIZON) / self.focal
    }

    /// The direction of a pixel, as a vector that goes one cell forward.
    pub(super) fn pixel(&self, column: usize, row: usize) -> Vector {
        let level = self.column(column);
        vector(level.x, level.y, -self.fall(row))
    }

    /// The direction towards the lamp that lights the luggage. The lamp is above the robot's left shoulder.
    pub(super) fn lamp(&self) -> Vector {
        (vector(0.0, 0.0, 0.85) - self.forward * 0.62 - self.right * 0.5).unit()
    }

    pub(super) fn depth(&self, point: Vector) -> f32 {
        (point - self.eye).dot(self.forward)
    }

    /// The column and row of a point in the picture, with fractions. `None` if the point is not ahead of the camera.
    pub(super) fn project(&self, point: Vector) -> Option<(f32, f32)> {
        let depth = self.depth(point);
        let scale = self.focal / depth;
        let column = as_float(WIDTH) / 2.0 + (point - self.eye).dot(self.right) * scale;
        (depth > 0.05).then_some((column, HORIZON + (self.eye.z - point.z) * scale))
    }
}

#[expect(clippy::cast_precision_loss, reason = "pictures are a few hundred pixels wide")]
pub(super) const fn as_float(pixel: usize) -> f32 {
    pixel as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::{Cell, Heading, Pose};

    #[test]
    fn what_stands_further_away_is_as_large_on_a_photo_of_it() {
        let body = BodyPose::centred(Pose { cell: Cell::HOME, heading: Heading::East }, 0.5);
        let on_photo = |away: u16| {
            let view = View::of(body, 0.5, away);
            let middle = view.eye + view.forward * (BEHIND + f32::from(away));
            let corners = [middle + view.right * 0.3, middle - view.right * 0.3 - vector(0.0, 0.0, 0.6)];
            corners.map(|corner| view.project(corner).expect("it is ahead"))
        };
        let near = on_photo(1);
        for away in 2..=7 {
            for ((column, row), (near_column, near_row)) in on_photo(away).into_iter().zip(near) {
                assert!((column - near_column).abs() < 0.01 && (row - near_row).abs() < 0.01, "{away} cells away");
            }
        }
    }
}
