//! The HTTP door: JSON under `/api/v1`, the operator's console at `/`, the old console's routes. It turns requests into
//! commands and snapshots into answers; it decides nothing about the mission.

mod accept;
mod assets;
mod by;
mod commands;
mod console;
mod etag;
mod events;
mod gate;
mod give;
mod guard;
mod missions;
mod old;
mod patience;
mod places;
mod problem;
mod query;
mod reading;
mod reads;
mod routes;
mod serve;
mod sign_in;
#[cfg(test)]
mod testing;
mod tls;
mod watcher;

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use tokio::sync::{Semaphore, watch};

pub use gate::Access;
pub use guard::Hosts;
pub use serve::{Front, serve};
pub use tls::{Tls, TlsError};

use self::problem::Problem;
use crate::access::Attempts;
use crate::runtime::archive::{Archive, Unreadable};
use crate::runtime::clock::Clock;
use crate::runtime::handle::Handle;

/// Streams open at once, the console's and the interface's together: every screen of a site, and a bound on what strangers cost.
pub const STREAMS: usize = 256;

/// So many questions are put to the archive at once, each on a thread of its own: more than a disk answers faster, and far fewer
/// than there are threads, which photos and the robot's diary need as well. The others wait,
const LOOKS: usize = 8;

/// and nobody for longer than this, the reading itself included: a disk that takes longer hangs.
const LOOK_PATIENCE: Duration = Duration::from_secs(10);

/// What the door needs of the house. Cheap to clone.
#[derive(Clone)]
pub struct Door {
    handle: Handle,
    archive: Arc<dyn Archive>,
    hall: Arc<str>,
    streams: Arc<Semaphore>,
    looks: Arc<Semaphore>,
    closing: watch::Sender<bool>,
    clock: Clock,
    access: Access,
    attempts: Arc<Attempts>,
}

impl Door {
    /// A door to the loop behind `handle`; `hall` is the name on the page, `access` says who is let in.
    #[must_use]
    pub fn new(handle: Handle, archive: Arc<dyn Archive>, hall: &str, access: Access) -> Door {
        Door {
            handle,
            archive,
            hall: Arc::from(hall),
            streams: Arc::new(Semaphore::new(STREAMS)),
            looks: Arc::new(Semaphore::new(LOOKS)),
            closing: watch::Sender::new(false),
            clock: Clock::default(),
            access,
            attempts: Arc::default(),
        }
    }

    /// Looks something up in the archive, where blocking is allowed.
    async fn look_up<T: Send + 'static>(
        &self,
        read: impl FnOnce(&dyn Archive) -> Result<T, Unreadable> + Send + 'static,
    ) -> Result<T, Problem> {
        let (archive, looks) = (Arc::clone(&self.archive), Arc::clone(&self.looks));
        let answer = async {
            let turn = looks.acquire_owned().await.map_err(|_| Problem::internal())?;
            // The place is given back when the reading has ended, also when nobody waits for it any more.
            let reading = tokio::task::spawn_blocking(move || (read(&*archive), turn));
            let (read, _) = reading.await.map_err(|_| Problem::internal())?;
            read.map_err(|unreadable| Problem::unreadable(unreadable.to_string()))
        };
        tokio::time::timeout(LOOK_PATIENCE, answer).await.unwrap_or_else(|_| {
            Err(Problem::unreadable("the disk does not answer: look after it, and ask again later".to_owned()))
        })
    }

    /// Ends every open stream at once, and every one opened from now on.
    pub fn close(&self) {
        self.closing.send_replace(true);
    }
}

/// Every route, with what stands in front of all of them.
pub fn router(door: &Door, hosts: Hosts) -> Router {
    guard::guarded(routes::routes(door), hosts)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use axum::response::IntoResponse;

    use super::*;

    /// Safety A5.
    #[tokio::test]
    async fn only_a_few_read_at_once_and_the_others_have_their_turn() {
        let house = testing::house(crate::wire::fixture::searching());
        let (reading, most) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
        let looks: Vec<_> = (0..5 * LOOKS)
            .map(|_| {
                let (door, reading, most) = (house.door.clone(), Arc::clone(&reading), Arc::clone(&most));
                tokio::spawn(async move {
                    let looked = door.look_up(move |_| {
                        most.fetch_max(reading.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                        std::thread::sleep(Duration::from_millis(5));
                        reading.fetch_sub(1, Ordering::SeqCst);
                        Ok(())
                    });
                    looked.await.is_ok()
                })
            })
            .collect();
        for look in looks {
            assert!(look.await.unwrap(), "everybody has a turn");
        }
        let most = most.load(Ordering::SeqCst);
        assert!((1..=LOOKS).contains(&most), "{most} read at once");
    }

    /// Safety A5: a disk that hangs takes the places there are, and whoever waits for one is told so.
    #[tokio::test(start_paused = true)]
    async fn nobody_waits_for_ever() {
        let house = testing::house(crate::wire::fixture::searching());
        let all = Arc::clone(&house.door.looks).acquire_many_owned(LOOKS as u32).await.unwrap();
        let refused = house.door.look_up(|_| Ok(())).await.unwrap_err();
        assert_eq!(refused.into_response().status(), 503);
        drop(all);
        assert!(house.door.look_up(|_| Ok(())).await.is_ok(), "it goes on when the disk answers again");
    }
}
