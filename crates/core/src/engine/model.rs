//! The resource model: everything that is shown, with a revision for each part. The mission decides which changes are
//! made, and when. This module makes them and counts revisions.

use std::sync::Arc;

use crate::hall::HallId;
use crate::settings::Settings;
use crate::snapshot::log::{Log, Tone};
use crate::snapshot::said::Said;
use crate::units::{Revision, WallTime};
use crate::world::resource::Resource;
use crate::world::temperature::Thermometer;

#[derive(Clone, Debug)]
pub(crate) struct World {
    pub(crate) run: Arc<str>,
    /// Name of this hall in its addresses; `None` for the default hall.
    pub(crate) hall: Option<HallId>,
    pub(crate) thermometer: Thermometer,
    pub(crate) log: Log,
    /// Why nothing can be recorded now, as text from the store.
    pub(crate) store_failure: Option<String>,
    revision: Revision,
    revisions: [Revision; Resource::COUNT],
    /// Whether the current input has already raised the revision. All changes of one input share one revision.
    raised: bool,
}

impl World {
    pub(crate) fn new(run: Arc<str>, settings: &Settings) -> World {
        World {
            run,
            hall: None,
            thermometer: Thermometer::new(settings.threshold, settings.hysteresis),
            log: Log::default(),
            store_failure: None,
            revision: Revision(1),
            revisions: [Revision(1); Resource::COUNT],
            raised: false,
        }
    }

    /// Makes the next change begin a new revision.
    pub(crate) fn turn_page(&mut self) {
        self.raised = false;
    }

    /// Marks a resource as changed, and returns the revision. All changes of one input share one revision.
    pub(crate) fn touch(&mut self, resource: Resource) -> Revision {
        if !self.raised {
            self.revision = self.revision.next();
            self.raised = true;
        }
        self.revisions[resource as usize] = self.revision;
        self.revision
    }

    pub(crate) const fn revision(&self) -> Revision {
        self.revision
    }

    pub(crate) const fn revisions(&self) -> [Revision; Resource::COUNT] {
        self.revisions
    }

    /// Writes a log line. A line of tone `Info` is shown when it is recorded, and any other line is shown at once
    /// (safety R4).
    pub(crate) fn write(&mut self, wall: WallTime, tone: Tone, said: Said) {
        if self.log.write(wall, tone, said) {
            self.touch(Resource::Log);
        }
    }
}
