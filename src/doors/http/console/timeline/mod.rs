//! The lines of time of the missions that are looked at: read once from the archive, continued while a mission goes on, and shared by
//! all pages. What stands on one says `line`, how it is drawn `section`.

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
pub(super) use section::{THRESHOLD_Y, id};

/// A line that has not been read to its end sooner is shown as far as it was: the page does not wait for a disk that hangs,
const PATIENCE: Duration = Duration::from_secs(2);

/// and it is not asked again before this.
const AGAIN: Duration = Duration::from_millis(400);

/// So many lines are at hand, the present one included, each language by itself.
const LINES: usize = 8;

/// So many entries are read at a time.
const PAGE: usize = 2000;

/// What is known of them; all pages of a door share it.
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
    /// The line of this mission as far as it can be read now.
    pub(super) async fn of(door: &HttpDoor, mission: MissionId, language: Language) -> Arc<Timeline> {
        let now = door.clock.now();
        let present = door.handle.snapshot().mission.id;
        let (mut line, is_due) = door.timelines.with(|lines| {
            // Those of the present mission, which every page follows, do not give way to old ones that somebody looks at.
            for language in Language::ALL {
                lines.get(&(present, language));
            }
            let new = || Arc::new(Timeline::new(mission, language, Zone::of(now.wall), door.settings.threshold));
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
                    line = door.timelines.keep(longer);
                }
            };
            tokio::time::timeout(PATIENCE, reading).await.is_ok()
        };
        if !is_read {
            tracing::debug!(%mission, "its line of time is not read to its end yet");
        }
        line
    }

    /// The longest line of a mission that is known, this one being known from now on.
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

/// The same line with a page more of what happened; `None` at its end, and where that cannot be read.
async fn read_on(door: &HttpDoor, mission: MissionId, mut line: Arc<Timeline>) -> Option<Arc<Timeline>> {
    if line.is_complete() {
        return None;
    }
    let after = line.last();
    let look = move |archive: &dyn Archive| {
        // What counted as too hot when it began may have been said before.
        let begin = (after == Seq(0)).then(|| archive.moments(mission, &[At::Time(i64::MIN)]).ok()?.pop()).flatten();
        let conditions = begin.and_then(|moment| moment.past.of.state.conditions);
        Ok((conditions, archive.timeline(mission, Span::after(after), PAGE)?))
    };
    let (conditions, further) = door.archive.look_up(look).await.ok()?;
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
