//! Threads that each run a loop of their own (safety S7). So urgent work on one thread never waits for work on
//! another. `app` decides what runs on which thread.

use std::io;
use std::sync::mpsc;
use std::time::Duration;

use tokio::runtime::{Builder, Handle};
use tokio::sync::oneshot;

/// Time after which work on an ending thread (drawing a photo, writing a file) is abandoned.
const LEFT_BEHIND: Duration = Duration::from_millis(200);

/// A thread that runs nothing but its tasks; dropping it ends the thread and its tasks.
#[derive(Debug)]
pub struct Thread {
    handle: Handle,
    end: Option<oneshot::Sender<()>>,
    ended: mpsc::Receiver<()>,
}

impl Thread {
    /// Starts a thread. The system shows `name`, which has at most 15 bytes.
    pub fn start(name: &str) -> io::Result<Thread> {
        let runtime = Builder::new_current_thread().enable_all().build()?;
        let handle = runtime.handle().clone();
        let (end, asked) = oneshot::channel();
        let (last, ended) = mpsc::channel();
        std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            // The thread also ends if its owner has disappeared without asking it to end.
            let _ = runtime.block_on(asked);
            runtime.shutdown_timeout(LEFT_BEHIND);
            drop(last);
        })?;
        Ok(Thread { handle, end: Some(end), ended })
    }

    pub const fn handle(&self) -> &Handle {
        &self.handle
    }
}

impl Drop for Thread {
    fn drop(&mut self) {
        if let Some(end) = self.end.take() {
            let _ = end.send(());
        }
        // Nothing is ever sent on this channel. The channel closes when the thread has ended. A thread that hangs is
        // abandoned after this time.
        let _ = self.ended.recv_timeout(2 * LEFT_BEHIND);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_run_on_it_by_its_name_until_it_is_dropped() {
        let thread = Thread::start("hear").expect("the system gives a thread");
        let (tell, told) = mpsc::channel();
        let (held, is_dropped) = oneshot::channel::<()>();
        thread.handle().spawn(async move {
            let _ = tell.send(std::thread::current().name().map(str::to_owned));
            std::future::pending::<()>().await;
            drop(held);
        });
        assert_eq!(told.recv(), Ok(Some("hear".to_owned())));
        drop(thread);
        assert!(is_dropped.blocking_recv().is_err(), "its task ended with it");
    }
}
