//! One open stream's view of the state: the newest snapshot, never a queue. A slow reader skips what it missed; the end of the
//! program ends every stream at once. `events` and the console's `live` decide what is sent.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;

use super::HttpDoor;
use super::problem::Problem;
use crate::access::Caller;
use crate::doors::connection_limits::OpenStream;
use hallsweep_core::snapshot::Snapshot;

/// Interval at which the reader's right is checked again.
const STILL_KNOWN: Duration = Duration::from_millis(250);

/// An open stream; its permit is returned when it is dropped.
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
    /// The program is ending, or the reader is not admitted any more.
    Closed,
}

impl Watcher {
    pub(super) fn open(door: &HttpDoor, caller: Caller) -> Result<(Watcher, Arc<Snapshot>), Problem> {
        let stream = door.streams.open(&caller, &door.access).ok_or_else(|| Problem::too_many_streams(door.streams.most()))?;
        let mut snapshots = door.handle.watch();
        let first = Arc::clone(&snapshots.borrow_and_update());
        let watcher = Watcher { snapshots, closing: door.closing.subscribe(), door: door.clone(), caller, _stream: stream };
        Ok((watcher, first))
    }

    /// The next newer state, after at least `pause`, so that a fast robot does not flood its reader, and at most `quiet`.
    pub(super) async fn next(&mut self, pause: Duration, quiet: Duration) -> Wake {
        let Watcher { snapshots, closing, door, caller, .. } = self;
        let newer = async {
            tokio::time::sleep(pause).await;
            snapshots.changed().await.map(|()| Arc::clone(&snapshots.borrow_and_update()))
        };
        // The reader is not admitted any more when its key was replaced or removed, or its session is over.
        let shut_out = async {
            while door.still_knows(caller) {
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
