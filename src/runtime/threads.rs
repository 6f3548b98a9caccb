//! Threads that have a loop of their own (safety S7), so that what is urgent there never waits behind what is busy elsewhere. What
//! runs on which of them is the app's business.

use std::io;
use std::sync::mpsc;
use std::time::Duration;

use tokio::runtime::{Builder, Handle};
use tokio::sync::oneshot;

/// What is still busy so long after a thread is to end (a photo being drawn, a file being written) is left behind.
const LEFT_BEHIND: Duration = Duration::from_millis(200);

/// A thread on which tasks run, and nothing else; it ends when this is dropped, and so do its tasks.
#[derive(Debug)]
pub struct Thread {
    handle: Handle,
    end: Option<oneshot::Sender<()>>,
    ended: mpsc::Receiver<()>,
}

impl Thread {
    /// Starts a thread; `name`, of at most 15 bytes, is what the system shows.
    pub fn start(name: &str) -> io::Result<Thread> {
        let runtime = Builder::new_current_thread().enable_all().build()?;
        let handle = runtime.handle().clone();
        let (end, asked) = oneshot::channel();
        let (last, ended) = mpsc::channel();
        std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            // It is also over when whoever could ask for its end is gone.
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
        // Nothing is ever sent; one that hangs is not waited for.
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
