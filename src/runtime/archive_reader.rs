//! Reading the archive from the doors: where blocking is allowed, so many at once, and never for long. All doors share one
//! bound. What is read stands in `archive`.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::Semaphore;

use super::archive::{Archive, Unreadable};

/// So many questions are put to the archive at once, each on a thread of its own: more than a disk answers faster, and far fewer
/// than there are threads, which photos and the robot's state file need as well. The others wait,
const LOOKS: usize = 8;

/// and nobody for longer than this, the reading itself included: a disk that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(10);

/// The doors' way into the archive. Cheap to clone; the clones share the bound.
#[derive(Clone)]
pub struct ArchiveReader {
    archive: Arc<dyn Archive>,
    looks: Arc<Semaphore>,
}

impl ArchiveReader {
    pub fn new(archive: Arc<dyn Archive>) -> ArchiveReader {
        ArchiveReader { archive, looks: Arc::new(Semaphore::new(LOOKS)) }
    }

    /// The archive itself, for whoever walks over a whole mission on a thread of his own, and says himself how many do so at once.
    pub fn archive(&self) -> Arc<dyn Archive> {
        Arc::clone(&self.archive)
    }

    /// Looks something up. Must be called inside a runtime.
    pub async fn look_up<T: Send + 'static>(
        &self,
        read: impl FnOnce(&dyn Archive) -> Result<T, Unreadable> + Send + 'static,
    ) -> Result<T, Unreadable> {
        let (archive, looks) = (Arc::clone(&self.archive), Arc::clone(&self.looks));
        let answer = async {
            let turn = looks.acquire_owned().await.map_err(|_| ended())?;
            // The place is given back when the reading has ended, also when nobody waits for it any more.
            let reading = tokio::task::spawn_blocking(move || (read(&*archive), turn));
            reading.await.map_err(|_| ended())?.0
        };
        let hangs = || Unreadable("the disk does not answer: look after it, and ask again later".to_owned());
        tokio::time::timeout(PATIENCE, answer).await.unwrap_or_else(|_| Err(hangs()))
    }
}

/// The reading panicked.
fn ended() -> Unreadable {
    Unreadable("a mistake in hallsweep ended the reading; its log says more".to_owned())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::runtime::archive::{At, Happened, Head, MissionRecord, NoTake, PastMoment, Sound, Span};
    use hallsweep_core::event::Photo;
    use hallsweep_core::state::PersistentState;
    use hallsweep_core::units::{LuggageId, MissionId, Seq};
    use hallsweep_core::world::luggage::Luggage;

    /// There is nothing in it.
    struct Empty;

    impl Archive for Empty {
        fn photo(&self, _: LuggageId) -> Result<Option<Photo>, Unreadable> {
            Ok(None)
        }

        fn take(&self, _: LuggageId, _: u32) -> Result<Option<Photo>, NoTake> {
            Ok(None)
        }

        fn luggage(&self, _: LuggageId) -> Result<Option<Luggage>, Unreadable> {
            Ok(None)
        }

        fn missions(&self, _: Option<MissionId>, _: usize) -> Result<Vec<MissionRecord>, Unreadable> {
            Ok(Vec::new())
        }

        fn mission(&self, _: MissionId) -> Result<Option<MissionRecord>, Unreadable> {
            Ok(None)
        }

        fn state(&self, _: MissionId) -> Result<Option<Sound<PersistentState>>, Unreadable> {
            Ok(None)
        }

        fn moments(&self, _: MissionId, _: &[At]) -> Result<Vec<PastMoment>, Unreadable> {
            Ok(Vec::new())
        }

        fn timeline(&self, _: MissionId, _: Span, _: usize) -> Result<Vec<Happened>, Unreadable> {
            Ok(Vec::new())
        }

        fn entries(&self, _: MissionId, _: Span, _: usize) -> Result<Vec<Happened>, Unreadable> {
            Ok(Vec::new())
        }

        fn lines(&self, _: MissionId, _: Span, _: usize) -> Result<Vec<(Seq, String)>, Unreadable> {
            Ok(Vec::new())
        }

        fn head(&self, _: MissionId, _: Seq) -> Result<Option<Head>, Unreadable> {
            Ok(None)
        }

        fn retrieval(&self, _: MissionId, _: usize) -> Result<Vec<Happened>, Unreadable> {
            Ok(Vec::new())
        }
    }

    fn reader() -> ArchiveReader {
        ArchiveReader::new(Arc::new(Empty))
    }

    /// Safety A5.
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

    /// Safety A5: a disk that hangs takes the places there are, and whoever waits for one is told so.
    #[tokio::test(start_paused = true)]
    async fn nobody_waits_for_ever() {
        let reader = reader();
        let all = Arc::clone(&reader.looks).acquire_many_owned(LOOKS as u32).await.unwrap();
        let refused = reader.clone().look_up(|_| Ok(())).await.unwrap_err();
        assert!(refused.to_string().contains("the disk does not answer"), "{refused}");
        drop(all);
        assert!(reader.look_up(|_| Ok(())).await.is_ok(), "it goes on when the disk answers again");
    }

    /// Safety A7: a mistake ends this reading, and gives its place back.
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
