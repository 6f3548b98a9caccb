//! The resource model itself: everything that is shown, with a revision for each part.
//! What may change it, and when, is the mission's business; here changes are only made and counted.

use std::sync::Arc;

use super::log::{Log, Tone};
use super::resource::Resource;
use super::temperature::Thermometer;
use crate::settings::Settings;
use crate::units::{Revision, WallTime};

/// What is known.
#[derive(Clone, Debug)]
pub struct World {
    /// Which run of the program this is.
    pub run: Arc<str>,
    /// The temperature.
    pub thermometer: Thermometer,
    /// The latest log lines.
    pub log: Log,
    /// Why nothing can be put on record just now, as the store says it.
    pub store_failure: Option<String>,
    revision: Revision,
    revisions: [Revision; Resource::COUNT],
    /// Whether the input being handled has raised the revision already: all its changes make one revision.
    raised: bool,
}

impl World {
    /// A robot at home in a hall of which nothing is known.
    #[must_use]
    pub fn new(run: Arc<str>, settings: &Settings) -> World {
        World {
            run,
            thermometer: Thermometer::new(settings.threshold, settings.hysteresis),
            log: Log::default(),
            store_failure: None,
            revision: Revision(1),
            revisions: [Revision(1); Resource::COUNT],
            raised: false,
        }
    }

    /// The next change begins a new revision.
    pub fn turn_page(&mut self) {
        self.raised = false;
    }

    /// Notes that a resource has changed; returns the revision of the change.
    pub fn touch(&mut self, resource: Resource) -> Revision {
        if !self.raised {
            self.revision = self.revision.next();
            self.raised = true;
        }
        self.revisions[resource as usize] = self.revision;
        self.revision
    }

    /// How often anything has changed.
    #[must_use]
    pub const fn revision(&self) -> Revision {
        self.revision
    }

    /// For each resource the revision of its last change.
    #[must_use]
    pub const fn revisions(&self) -> [Revision; Resource::COUNT] {
        self.revisions
    }

    /// Writes a log line: a warning at once, what follows from a command or a find when that is on record (safety R4).
    pub fn write(&mut self, wall: WallTime, tone: Tone, text: String) {
        if self.log.write(wall, tone, text) {
            self.touch(Resource::Log);
        }
    }
}
