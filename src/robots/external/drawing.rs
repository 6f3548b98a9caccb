//! The drawing in place of a photo, for a robot that has no camera.

use hallsweep_core::event::Photo;
use hallsweep_drivers::Subject;
use hallsweep_sim::camera;

pub(super) fn draw(subject: &Subject) -> Photo {
    camera::plan(subject.stamp, subject.name.as_deref())
}
