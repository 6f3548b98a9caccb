//! The halt that bypasses every queue (safety S1): a count that anyone may raise and that every writer towards a robot looks at
//! before it begins an order. A stop also raises the epoch. What a halt means for the mission is the core's business.

use tokio::sync::watch;

use crate::core::units::Epoch;

/// How often the robots were halted, for whatever reason, and in which epoch of stops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Halts {
    /// Raised by every halt: an order sent before it must not begin.
    pub count: u64,
    /// Raised by every stop.
    pub epoch: Epoch,
}

/// Halts the robots. Cheap to clone; works whatever the other channels hold.
#[derive(Clone, Debug)]
pub struct Halter(watch::Sender<Halts>);

impl Halter {
    /// A halter at the epoch the core begins with.
    #[must_use]
    pub fn new(epoch: Epoch) -> Halter {
        Halter(watch::Sender::new(Halts { count: 0, epoch }))
    }

    /// Somebody's stop: halts every robot now; returns the epoch this stop has made.
    pub fn stop(&self) -> Epoch {
        let mut raised = Epoch(0);
        self.0.send_modify(|halts| {
            *halts = Halts { count: halts.count + 1, epoch: halts.epoch.next() };
            raised = halts.epoch;
        });
        raised
    }

    /// The core's halt, for whatever holds the robot: halts every robot now.
    pub fn halt(&self) {
        self.0.send_modify(|halts| halts.count += 1);
    }

    /// Where a writer, or the core's loop, learns of halts.
    #[must_use]
    pub fn watch(&self) -> HaltWatch {
        HaltWatch(self.0.subscribe())
    }
}

/// Sees halts as they are raised.
#[derive(Clone, Debug)]
pub struct HaltWatch(watch::Receiver<Halts>);

impl HaltWatch {
    /// The halts so far.
    #[must_use]
    pub fn now(&self) -> Halts {
        *self.0.borrow()
    }

    /// Waits until a halt is raised that was not yet seen here; never ends when nobody can raise one any more.
    pub async fn raised(&mut self) -> Halts {
        if self.0.changed().await.is_err() {
            std::future::pending::<()>().await;
        }
        *self.0.borrow_and_update()
    }
}
