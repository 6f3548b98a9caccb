//! The state topics: each resource in the JSON of the HTTP door, when it has changed, and not too often. The newest wins.

use std::time::Duration;

use serde::Serialize;

use crate::api::map::{MapJson, map_revision};
use crate::api::state;
use hallsweep_core::units::Revision;
use hallsweep_core::world::resource::Resource;
use hallsweep_core::world::snapshot::Snapshot;

/// The least time between two states of one resource: ten a second are enough to watch, and do not fill a slow line.
const PACE: Duration = Duration::from_millis(100);

/// What was said of each resource.
#[derive(Default)]
pub(super) struct States([Said; Resource::COUNT]);

#[derive(Clone, Copy, Default)]
struct Said {
    /// Of which revision; `None` when a broker may know nothing.
    revision: Option<Revision>,
    /// Not again before this.
    next: Duration,
}

impl States {
    /// When the state of a resource is due; `None` when it was said as it is.
    pub(super) fn due(&self, resource: Resource, snapshot: &Snapshot) -> Option<Duration> {
        let said = self.0[resource as usize];
        (said.revision != Some(revision(resource, snapshot))).then_some(said.next)
    }

    /// The state of a resource, in JSON.
    pub(super) fn take(&mut self, resource: Resource, snapshot: &Snapshot, now: Duration) -> Vec<u8> {
        self.0[resource as usize] = Said { revision: Some(revision(resource, snapshot)), next: now + PACE };
        payload(resource, snapshot)
    }

    /// Everything is to be said again, at the same pace.
    pub(super) fn renew(&mut self) {
        for said in &mut self.0 {
            said.revision = None;
        }
    }
}

/// When what is shown of a resource last changed: a map shows the robot, too.
fn revision(resource: Resource, snapshot: &Snapshot) -> Revision {
    if resource == Resource::Map { map_revision(snapshot) } else { snapshot.revision_of(resource) }
}

fn payload(resource: Resource, snapshot: &Snapshot) -> Vec<u8> {
    match resource {
        Resource::Mission => json(&state::mission(snapshot)),
        Resource::Robot => json(&state::robot(snapshot)),
        Resource::Map => json(&MapJson::from(snapshot)),
        Resource::Luggage => json(&state::luggage(snapshot)),
        Resource::Temperature => json(&state::temperature(snapshot)),
        Resource::Alarms => json(&state::alarms(snapshot)),
        Resource::Log => json(&state::log_after(snapshot, 0)),
    }
}

/// A shape of the wire in JSON.
pub(super) fn json(shape: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec(shape).expect("the shapes of the wire are texts, numbers, lists and maps, which JSON can hold")
}
