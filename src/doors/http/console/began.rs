//! Looks up when the present mission began, so that pages can show the elapsed time. The record of missions is read
//! once for each mission, with a time limit. Until the time is known, a page is shown without it.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use super::super::HttpDoor;
use hallsweep_core::units::{MissionId, WallTime};

/// Maximum wait for the record of missions. If the disk does not respond, the page is shown without the elapsed time.
const PATIENCE: Duration = Duration::from_millis(100);

/// Pause before the record is read again after a failure.
const AGAIN: Duration = Duration::from_secs(5);

#[derive(Debug, Default)]
pub(in crate::doors::http) struct Began(Mutex<Lookup>);

#[derive(Clone, Copy, Debug, Default)]
struct Lookup {
    mission: MissionId,
    began: Option<WallTime>,
    asked: Option<Duration>,
}

/// Returns when this mission began. Returns `None` before the first mission, and while the record cannot be read.
pub(super) async fn began(door: &HttpDoor, mission: MissionId) -> Option<WallTime> {
    let now = door.process.clock.now().since_start;
    let known = {
        let mut known = door.hall.began.0.lock().unwrap_or_else(PoisonError::into_inner);
        if known.mission != mission {
            *known = Lookup { mission, ..Lookup::default() };
        }
        let is_due = mission != MissionId(0) && known.asked.is_none_or(|asked| now.saturating_sub(asked) >= AGAIN);
        if known.began.is_some() || !is_due {
            return known.began;
        }
        known.asked = Some(now);
        &door.hall.began.0
    };
    let found = tokio::time::timeout(PATIENCE, door.hall.archive.look_up(move |archive| archive.mission(mission)));
    let began = found.await.ok()?.ok()??.began;
    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
    if known.mission == mission {
        known.began = Some(began);
    }
    Some(began)
}
