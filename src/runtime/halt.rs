//! The halt that bypasses every queue (safety S1): an epoch that anyone may raise and that every writer towards a robot
//! looks at before it writes.

use tokio::sync::watch;

use crate::core::units::Epoch;

/// Raises the epoch. Cheap to clone; works whatever the other channels hold.
#[derive(Clone, Debug)]
pub struct Halter(watch::Sender<Epoch>);

impl Halter {
    /// A halter at the epoch the core begins with.
    #[must_use]
    pub fn new(epoch: Epoch) -> Halter {
        Halter(watch::Sender::new(epoch))
    }

    /// Halts every robot now; returns the epoch this halt has made.
    pub fn halt(&self) -> Epoch {
        let mut raised = Epoch(0);
        self.0.send_modify(|epoch| {
            *epoch = epoch.next();
            raised = *epoch;
        });
        raised
    }

    /// Where a writer, or the core's loop, learns of halts.
    #[must_use]
    pub fn watch(&self) -> HaltWatch {
        HaltWatch(self.0.subscribe())
    }
}

/// Sees halts as they are raised.
#[derive(Clone, Debug)]
pub struct HaltWatch(watch::Receiver<Epoch>);

impl HaltWatch {
    /// The epoch that holds: an order given in an earlier one must not begin.
    #[must_use]
    pub fn epoch(&self) -> Epoch {
        *self.0.borrow()
    }

    /// Waits until a halt is raised that was not yet seen here; returns its epoch, or never when nobody can raise one any more.
    pub async fn raised(&mut self) -> Epoch {
        if self.0.changed().await.is_err() {
            std::future::pending::<()>().await;
        }
        *self.0.borrow_and_update()
    }
}
