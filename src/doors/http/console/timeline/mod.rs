//! The timelines of the missions that somebody views. Each timeline is read from the archive once and shared by all
//! pages. While its mission continues, it is extended. `line` decides what is shown, `section` draws it.

mod line;
mod section;

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use hashlink::LruCache;

use super::super::HttpDoor;
use crate::api::time::Zone;
use crate::phrases::Language;
use crate::runtime::archive::{Archive, At, Span};
use hallsweep_core::units::{MissionId, Seq};
pub(super) use line::{LAST, MOST, Scale, Timeline};
pub(super) use section::{THRESHOLD_Y, escaped, id};

/// Maximum wait for a timeline. If the disk does not respond, the page shows an incomplete timeline.
const PATIENCE: Duration = Duration::from_secs(2);

/// Pause before the archive is read again.
const AGAIN: Duration = Duration::from_millis(400);

/// Maximum number of cached timelines. A mission has one timeline for each language. The timelines of the present
/// mission count too.
const LINES: usize = 8;

/// Number of entries read from the archive at a time.
const PAGE: usize = 2000;

#[derive(Debug)]
pub(in crate::doors::http) struct Timelines(Mutex<LruCache<(MissionId, Language), Known>>);

#[derive(Debug)]
struct Known {
    line: Arc<Timeline>,
    asked: Option<Duration>,
}

impl Default for Timelines {
    fn default() -> Timelines {
        Timelines(Mutex::new(LruCache::new(LINES)))
    }
}

impl Timelines {
    /// Returns the timeline as far as it can be read within `PATIENCE`. The next call continues to read.
    pub(super) async fn of(door: &HttpDoor, mission: MissionId, language: Language) -> Arc<Timeline> {
        let now = door.process.clock.now();
        let present = door.hall.handle.snapshot().mission.id;
        let (mut line, is_due) = door.hall.timelines.with(|lines| {
            // Marks the timelines of the present mission as used, because every page shows one. Timelines of old
            // missions must not evict them from the cache.
            for language in Language::ALL {
                lines.get(&(present, language));
            }
            let new = || Arc::new(Timeline::new(mission, language, Zone::of(now.wall), door.hall.settings.threshold));
            let known = lines.entry((mission, language)).or_insert_with(|| Known { line: new(), asked: None });
            let is_due = known.asked.is_none_or(|asked| now.since_start.saturating_sub(asked) >= AGAIN);
            let is_due = is_due && mission != MissionId(0) && !known.line.is_complete();
            if is_due {
                known.asked = Some(now.since_start);
            }
            (Arc::clone(&known.line), is_due)
        });
        let is_read = !is_due || {
            let reading = async {
                while let Some(longer) = read_on(door, mission, Arc::clone(&line)).await {
                    line = door.hall.timelines.keep(longer);
                }
            };
            tokio::time::timeout(PATIENCE, reading).await.is_ok()
        };
        if !is_read {
            tracing::debug!(%mission, "the timeline of the mission is not complete yet");
        }
        line
    }

    /// Stores a timeline in the cache. Two tasks may read the same timeline at once; the longer result stays in the
    /// cache and is returned. A timeline that was evicted in the meantime is not stored again.
    fn keep(&self, line: Arc<Timeline>) -> Arc<Timeline> {
        self.with(|lines| match lines.get_mut(&(line.mission(), line.language())) {
            Some(known) if known.line.last() > line.last() => Arc::clone(&known.line),
            Some(known) => {
                known.line = Arc::clone(&line);
                line
            }
            None => line,
        })
    }

    fn with<T>(&self, use_them: impl FnOnce(&mut LruCache<(MissionId, Language), Known>) -> T) -> T {
        use_them(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Returns the timeline extended by one page of entries. Returns `None` at its end, and when the archive cannot be
/// read.
async fn read_on(door: &HttpDoor, mission: MissionId, mut line: Arc<Timeline>) -> Option<Arc<Timeline>> {
    if line.is_complete() {
        return None;
    }
    let after = line.last();
    let look = move |archive: &dyn Archive| {
        // The temperature threshold that applies at the beginning may have been recorded before the mission.
        let begin = (after == Seq(0)).then(|| archive.moments(mission, &[At::Time(i64::MIN)]).ok()?.pop()).flatten();
        let conditions = begin.and_then(|moment| moment.past.of.state.conditions);
        Ok((conditions, archive.timeline(mission, Span::after(after), PAGE)?))
    };
    let (conditions, further) = door.hall.archive.look_up(look).await.ok()?;
    if further.is_empty() {
        return None;
    }
    let longer = Arc::make_mut(&mut line);
    if let Some(conditions) = conditions {
        longer.under(&conditions);
    }
    longer.extend(&further);
    Some(line)
}
