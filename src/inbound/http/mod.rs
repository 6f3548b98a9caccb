//! The HTTP door: JSON under `/api/v1`, the operator's console at `/`, the old console's routes. It turns requests into
//! commands and snapshots into answers; it decides nothing about the mission.

mod accept;
mod assets;
mod commands;
mod console;
mod etag;
mod events;
mod give;
mod guard;
mod missions;
mod old;
mod patience;
mod problem;
mod query;
mod reading;
mod reads;
mod serve;
#[cfg(test)]
mod testing;
mod watcher;

use std::sync::Arc;

use axum::Router;
use axum::routing::{get, post, put};
use tokio::sync::{Semaphore, watch};

pub use guard::Hosts;
pub use serve::serve;

use self::problem::Problem;
use crate::runtime::archive::{Archive, Unreadable};
use crate::runtime::clock::Clock;
use crate::runtime::handle::Handle;

/// Streams open at once, the console's and the interface's together: every screen of a site, and a bound on what strangers cost.
pub const STREAMS: usize = 256;

/// What the door needs of the house. Cheap to clone.
#[derive(Clone)]
pub struct Door {
    handle: Handle,
    archive: Arc<dyn Archive>,
    hall: Arc<str>,
    streams: Arc<Semaphore>,
    closing: watch::Sender<bool>,
    clock: Clock,
}

impl Door {
    /// A door to the loop behind `handle`; `hall` is the name on the page.
    #[must_use]
    pub fn new(handle: Handle, archive: Arc<dyn Archive>, hall: &str) -> Door {
        let streams = Arc::new(Semaphore::new(STREAMS));
        Door { handle, archive, hall: Arc::from(hall), streams, closing: watch::Sender::new(false), clock: Clock::default() }
    }

    /// Looks something up in the archive, where blocking is allowed.
    async fn look_up<T: Send + 'static>(
        &self,
        read: impl FnOnce(&dyn Archive) -> Result<T, Unreadable> + Send + 'static,
    ) -> Result<T, Problem> {
        let archive = Arc::clone(&self.archive);
        let read = tokio::task::spawn_blocking(move || read(&*archive)).await;
        read.map_err(|_| Problem::internal())?.map_err(|unreadable| Problem::unreadable(unreadable.to_string()))
    }

    /// Ends every open stream at once, and every one opened from now on.
    pub fn close(&self) {
        self.closing.send_replace(true);
    }
}

/// Every route, with what stands in front of all of them.
pub fn router(door: Door, hosts: Hosts) -> Router {
    let routes = Router::new()
        .nest("/api/v1", api())
        .merge(old::routes())
        .merge(console::routes())
        .merge(assets::routes())
        .route("/healthz", get(reads::health))
        .fallback(problem::no_such_path)
        .method_not_allowed_fallback(problem::no_such_method)
        .with_state(door);
    guard::guarded(routes, hosts)
}

fn api() -> Router<Door> {
    Router::new()
        .route("/state", get(reads::state))
        .route("/map", get(reads::map))
        .route("/luggage", get(reads::luggage_list))
        .route("/luggage/{id}", get(reads::luggage))
        .route("/luggage/{id}/photo", get(reads::photo).post(commands::retake))
        .route("/luggage/{id}/verdict", post(commands::verdict))
        .route("/events", get(events::events))
        .route("/missions", get(missions::list))
        .route("/missions/{id}", get(missions::mission))
        .route("/missions/{id}/events", get(missions::events))
        .route("/missions/{id}/map", get(missions::map))
        .route("/commands/start", post(commands::start))
        .route("/commands/stop", post(commands::stop))
        .route("/commands/backHome", post(commands::back_home))
        .route("/commands/retrieve", post(commands::retrieve))
        .route("/commands/reset", post(commands::reset))
        .route("/commands/move", post(commands::make_move))
        .route("/commands/goto", post(commands::goto))
        .route("/strategy", put(commands::strategy))
        .route("/temperature", put(commands::temperature))
        .route("/alarms/{id}/acknowledge", post(commands::acknowledge))
}
