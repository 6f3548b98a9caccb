//! Reads the archive for the doors, on threads that may block. The doors together may run only a limited number of
//! queries at once, and each query has a time limit. The queries are listed in `archive`.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::Semaphore;

use super::archive::{Archive, Unreadable};

/// Maximum number of queries at once, each on a thread of its own; further queries wait. More threads would not be
/// faster on one disk, and other work (photos, the robot's state file) needs threads as well.
const LOOKS: usize = 8;

/// Maximum time of a query, including the wait for its turn. A disk that takes longer is treated as hanging.
const PATIENCE: Duration = Duration::from_secs(10);

/// The doors' access to the archive. Cheap to clone; all clones share the limit.
#[derive(Clone)]
pub struct ArchiveReader {
    archive: Arc<dyn Archive>,
    looks: Arc<Semaphore>,
}

impl ArchiveReader {
    pub fn new(archive: Arc<dyn Archive>) -> ArchiveReader {
        ArchiveReader { archive, looks: Arc::new(Semaphore::new(LOOKS)) }
    }

    /// The archive itself, for a caller that reads a whole mission on a thread of its own. The caller must limit the
    /// number of such threads.
    pub fn archive(&self) -> Arc<dyn Archive> {
        Arc::clone(&self.archive)
    }

    /// Runs a query and returns its result. Must be called inside a runtime.
    pub async fn look_up<T: Send + 'static>(
        &self,
        read: impl FnOnce(&dyn Archive) -> Result<T, Unreadable> + Send + 'static,
    ) -> Result<T, Unreadable> {
        let (archive, looks) = (Arc::clone(&self.archive), Arc::clone(&self.looks));
        let answer = async {
            let turn = looks.acquire_owned().await.map_err(|_| ended())?;
            // The permit is returned when the query ends, even if its caller has gone away.
            let reading = tokio::task::spawn_blocking(move || (read(&*archive), turn));
            reading.await.map_err(|_| ended())?.0
        };
        let hangs = || Unreadable("the disk does not answer: check the disk, then try again".to_owned());
        tokio::time::timeout(PATIENCE, answer).await.unwrap_or_else(|_| Err(hangs()))
    }
}

/// The error for a query that panicked.
fn ended() -> Unreadable {
    Unreadable("a mistake in hallsweep ended the reading; its log says more".to_owned())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::runtime::tests::partial_archive::PartialArchive;

    struct Empty;

    impl PartialArchive for Empty {}

    fn reader() -> ArchiveReader {
        ArchiveReader::new(Arc::new(Empty))
    }

    /// Safety A5: only a few queries run at once, and the others get their turn.
    #[tokio::test]
    async fn only_a_few_read_at_once_and_the_others_have_their_turn() {
        let shared = reader();
        let (reading, most) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
        let looks: Vec<_> = (0..5 * LOOKS)
            .map(|_| {
                let (reader, reading, most) = (shared.clone(), Arc::clone(&reading), Arc::clone(&most));
                tokio::spawn(async move {
                    let looked = reader.look_up(move |_| {
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

    /// Safety A5: if the disk hangs, queries hold all permits. A caller that waits for a permit gets an error.
    #[tokio::test(start_paused = true)]
    async fn nobody_waits_for_ever() {
        let reader = reader();
        let all = Arc::clone(&reader.looks).acquire_many_owned(LOOKS as u32).await.unwrap();
        let refused = reader.clone().look_up(|_| Ok(())).await.unwrap_err();
        assert!(refused.to_string().contains("the disk does not answer"), "{refused}");
        drop(all);
        assert!(reader.look_up(|_| Ok(())).await.is_ok(), "it goes on when the disk answers again");
    }

    /// Safety A7: a query that panics ends only itself, and returns its permit.
    #[tokio::test]
    async fn a_reading_that_panics_ends_itself_alone() {
        let reader = reader();
        for _ in 0..2 * LOOKS {
            let ended = reader.look_up::<()>(|_| panic!("a mistake")).await.unwrap_err();
            assert!(ended.to_string().contains("a mistake in hallsweep"), "{ended}");
        }
        assert!(reader.look_up(|_| Ok(())).await.is_ok());
    }
}
