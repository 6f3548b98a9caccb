//! Photos of the simulated robot. A photo takes time, may be developed outside the simulator, and may fail. `camera`
//! draws the picture.

use std::sync::Arc;

use super::super::camera::Exposure;
use super::{Sim, SimTask, Work};
use hallsweep_core::effect::{Order, Stamp};
use hallsweep_core::event::{Photo, RobotEvent};
use hallsweep_core::units::{Now, OrderId};

#[derive(Debug)]
pub(super) enum Film {
    /// The simulator itself develops the photo at the end of the photo's time.
    Here(Exposure),
    Away,
    Developed(Photo),
}

impl Sim {
    /// Takes the current photo out of the simulator, to be developed elsewhere, since drawing takes milliseconds. The
    /// order stays open until `handle_photo` is called.
    pub fn take_exposure(&mut self) -> Option<(OrderId, Exposure)> {
        let Some(SimTask { order, work: Work::Photograph { film, .. }, .. }) = &mut self.task else { return None };
        let Film::Here(exposure) = film else { return None };
        let taken = (*order, exposure.clone());
        *film = Film::Away;
        Some(taken)
    }

    /// Accepts a photo that was developed elsewhere. If its order is no longer open, the photo is dropped.
    pub fn handle_photo(&mut self, order: OrderId, photo: Photo, now: Now) {
        match &mut self.task {
            Some(SimTask { order: open, work: Work::Photograph { film, .. }, .. }) if *open == order => {
                *film = Film::Developed(photo)
            }
            Some(_) | None => {}
        }
        self.pass_to(now.since_start);
    }

    #[must_use]
    pub const fn is_developing(&self) -> bool {
        matches!(self.task, Some(SimTask { work: Work::Photograph { film: Film::Away, .. }, .. }))
    }

    pub(super) fn begin_photo(&mut self, order: Order, stamp: Stamp) {
        let exposure = Exposure::new(Arc::clone(&self.hall), self.settings.camera, self.body, self.pose, stamp);
        self.begin(order, Work::Photograph { ends: self.now + self.settings.photo, film: Film::Here(exposure) });
    }

    pub(super) fn deliver(&mut self, order: OrderId, film: Film) {
        let photo = match film {
            Film::Here(exposure) => exposure.develop(),
            Film::Developed(photo) => photo,
            Film::Away => return,
        };
        self.events.push_back(if self.faults.camera_fails || self.failures.happens(self.settings.photo_failure_rate) {
            RobotEvent::PhotoFailed(order, "the shutter did not open: take the photo again".to_owned())
        } else {
            RobotEvent::Photo(order, photo)
        });
    }
}
