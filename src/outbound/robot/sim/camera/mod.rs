//! The simulated camera: from where the robot really stands to an encoded picture.
//! When a photo is taken, and whether it fails, is decided by the simulator.

mod encode;
mod stub;

use std::sync::Arc;

use super::drive::BodyPose;
use super::hall::Hall;
use super::settings::Camera;
use crate::core::effect::Stamp;
use crate::core::event::Photo;
use crate::core::units::{Cell, Pose};

/// A photo that has been taken and not yet developed: all it takes to draw it, on whatever thread.
#[derive(Clone, Debug)]
#[expect(dead_code, reason = "the rendered camera comes with the next commit and reads the body and the stamp")]
pub struct Exposure {
    hall: Arc<Hall>,
    camera: Camera,
    body: BodyPose,
    subject: Cell,
    stamp: Stamp,
}

impl Exposure {
    pub(super) fn new(hall: Arc<Hall>, camera: Camera, body: BodyPose, pose: Pose, stamp: Stamp) -> Exposure {
        Exposure { hall, camera, body, subject: pose.ahead(), stamp }
    }

    /// Draws and encodes the picture: some 20 ms of arithmetic for a rendered one.
    #[must_use]
    pub fn develop(&self) -> Photo {
        let bytes = match self.camera {
            Camera::Rendered | Camera::Stub => stub::picture(&self.hall, self.subject),
        };
        Photo { bytes: bytes.into(), media_type: "image/png" }
    }
}
