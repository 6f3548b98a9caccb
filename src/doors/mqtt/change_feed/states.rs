//! Publishes the state topics: each resource in the JSON of the HTTP door, or an excerpt if that JSON is too large. A
//! resource is published after each change, at a limited rate. Only its newest state is published.

use std::convert::identity;
use std::time::Duration;

use crate::api::excerpt::excerpt;
use crate::api::resources::{Form, ResourceKind};
use crate::doors::update_interval;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Revision;
use hallsweep_core::world::resource::Resource;

/// Minimum time between two messages about one resource. After a large message the pause is longer. Ten messages a
/// second are enough to watch, and do not fill a slow line.
const PACE: Duration = Duration::from_millis(100);

#[derive(Default)]
pub(super) struct States([Said; Resource::COUNT]);

#[derive(Clone, Copy, Default)]
struct Said {
    /// The published revision; `None` before the first publication and after `renew`.
    revision: Option<Revision>,
    next: Duration,
}

impl States {
    /// Returns when the state of a resource is due, or `None` if its present state is published.
    pub(super) fn due(&self, resource: Resource, snapshot: &Snapshot) -> Option<Duration> {
        let said = self.0[resource as usize];
        (said.revision != Some(ResourceKind::Of(resource).revision(snapshot))).then_some(said.next)
    }

    pub(super) fn take(&mut self, resource: Resource, snapshot: &Snapshot, now: Duration) -> Vec<u8> {
        let shown = ResourceKind::Of(resource);
        let state = excerpt(resource, snapshot).unwrap_or_else(|| shown.written(0, Form::Json, snapshot, identity));
        let hall = snapshot.map.known_bounds();
        let cells = usize::try_from(i64::from(hall.width()) * i64::from(hall.height())).unwrap_or(usize::MAX);
        // The coverage is short, but the work for it grows with the hall.
        let size = if resource == Resource::Coverage { cells } else { state.len() };
        let next = now + update_interval::for_size(size).max(PACE);
        self.0[resource as usize] = Said { revision: Some(shown.revision(snapshot)), next };
        state
    }

    /// Makes every state due again. The rate limit still holds.
    pub(super) fn renew(&mut self) {
        for said in &mut self.0 {
            said.revision = None;
        }
    }
}
