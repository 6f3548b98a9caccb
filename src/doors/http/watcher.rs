//! The state as one open stream sees it: always the newest snapshot, never a queue. A slow reader misses intermediate
//! states. When the program ends, all streams end at once. `events` and the console's `live` decide what is sent.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;

use super::HttpDoor;
use super::problem::Problem;
use crate::access::Caller;
use crate::doors::connection_limits::OpenStream;
use hallsweep_core::snapshot::Snapshot;

/// Interval at which the reader's right to read is checked again.
const STILL_KNOWN: Duration = Duration::from_millis(250);

/// An open stream. Its place among the streams is freed when this value is dropped.
pub(super) struct Watcher {
    snapshots: watch::Receiver<Arc<Snapshot>>,
    closing: watch::Receiver<bool>,
    door: HttpDoor,
    caller: Caller,
    _stream: OpenStream,
}

pub(super) enum Wake {
    Changed(Arc<Snapshot>),
    Quiet,
    /// The program is ending, or the reader is no longer admitted.
    Closed,
}

impl Watcher {
    pub(super) fn open(door: &HttpDoor, caller: Caller) -> Result<(Watcher, Arc<Snapshot>), Problem> {
        let stream = door
            .process
            .streams
            .open(&caller, &door.process.access)
            .ok_or_else(|| Problem::too_many_streams(door.process.streams.most()))?;
        let mut snapshots = door.hall.handle.watch();
        let first = Arc::clone(&snapshots.borrow_and_update());
        let watcher =
            Watcher { snapshots, closing: door.process.closing.subscribe(), door: door.clone(), caller, _stream: stream };
        Ok((watcher, first))
    }

    /// Waits for the next newer state and returns it. Returns `Quiet` if no state comes within `quiet`. It waits at
    /// least `pause`, so that a fast robot does not flood the reader.
    pub(super) async fn next(&mut self, pause: Duration, quiet: Duration) -> Wake {
        let Watcher { snapshots, closing, door, caller, .. } = self;
        let newer = async {
            tokio::time::sleep(pause).await;
            snapshots.changed().await.map(|()| Arc::clone(&snapshots.borrow_and_update()))
        };
        // The reader is no longer admitted when the key was replaced or removed, or when the session has ended.
        let shut_out = async {
            while door.process.still_knows(caller) {
                tokio::time::sleep(STILL_KNOWN).await;
            }
        };
        tokio::select! {
            biased;
            () = closed(closing) => Wake::Closed,
            () = shut_out => Wake::Closed,
            newer = tokio::time::timeout(quiet, newer) => match newer {
                Ok(Ok(snapshot)) => Wake::Changed(snapshot),
                Ok(Err(_)) => Wake::Closed,
                Err(_) => Wake::Quiet,
            },
        }
    }
}

pub(super) async fn closed(closing: &mut watch::Receiver<bool>) {
    drop(closing.wait_for(|closing| *closing).await);
}
