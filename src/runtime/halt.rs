//! The halt, which bypasses every queue (safety S1). It is a count that anyone may raise. Every robot's adapter
//! checks the count before it begins a motion. A stop also raises the epoch. The core decides what a halt means for
//! the mission.

use std::time::Duration;

use tokio::sync::watch;

use super::figures::Figures;
use hallsweep_core::units::Epoch;

/// Maximum time for which the answer to a stop waits for the record on disk. A healthy disk takes a thousandth of
/// this time. A disk that hangs must not delay the answer that the robot was halted.
const NOTING: Duration = Duration::from_millis(100);

/// Number of halts so far, for any reason, and the epoch, which each stop raises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Halts {
    /// Raised by every halt. A motion that was ordered before the halt must not begin.
    pub count: u64,
    pub epoch: Epoch,
}

/// Halts the robots. Cheap to clone; works even when all other channels are full.
#[derive(Clone, Debug)]
pub struct Halter {
    halts: watch::Sender<Halts>,
    /// The epoch of the last stop on disk; `None` while nothing can be written.
    noted: watch::Sender<Option<Epoch>>,
    figures: Figures,
}

impl Halter {
    pub fn new(epoch: Epoch) -> Halter {
        let halts = watch::Sender::new(Halts { count: 0, epoch });
        Halter { halts, noted: watch::Sender::new(None), figures: Figures::default() }
    }

    /// Halts every robot now, and raises the epoch. Returns the new epoch: commands from earlier epochs are outdated.
    pub fn stop(&self) -> Epoch {
        let mut raised = Epoch(0);
        self.figures.raise_stop();
        self.halts.send_modify(|halts| {
            *halts = Halts { count: halts.count + 1, epoch: halts.epoch.next() };
            raised = halts.epoch;
        });
        raised
    }

    /// Halts every robot now. The epoch is not raised, unlike after a STOP.
    pub fn halt(&self) {
        self.halts.send_modify(|halts| halts.count += 1);
    }

    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    pub fn watch(&self) -> HaltWatch {
        HaltWatch { all: self.halts.subscribe(), own: None }
    }

    /// Reports the epoch up to which stops are on disk, where they survive the end of the program. `None` while they
    /// cannot be written.
    pub fn note(&self, noted: Option<Epoch>) {
        self.noted.send_replace(noted);
    }

    /// Waits until the stop of this epoch is on disk, but at most for `NOTING`. Does not wait while nothing can be
    /// written.
    pub async fn until_noted(&self, epoch: Epoch) {
        let mut noted = self.noted.subscribe();
        let done = noted.wait_for(|noted| noted.is_none_or(|noted| noted >= epoch));
        // The stop has acted already. If the record is late, it is still written.
        let _ = tokio::time::timeout(NOTING, done).await;
    }
}

/// Receives halts as they are raised: halts for all robots, and halts that the core raises for one robot.
#[derive(Clone, Debug)]
pub struct HaltWatch {
    all: watch::Receiver<Halts>,
    own: Option<watch::Receiver<u64>>,
}

impl HaltWatch {
    pub fn of_one(self, own: watch::Receiver<u64>) -> HaltWatch {
        HaltWatch { own: Some(own), ..self }
    }

    pub fn now(&self) -> Halts {
        let Halts { count, epoch } = *self.all.borrow();
        Halts { count: count + self.own.as_ref().map_or(0, |own| *own.borrow()), epoch }
    }

    /// Waits for the next halt, and returns the halts so far. Never returns if no halt can be raised any more.
    pub async fn raised(&mut self) -> Halts {
        let HaltWatch { all, own } = self;
        tokio::select! {
            biased;
            () = changed(all) => {}
            () = async { match own { Some(own) => changed(own).await, None => std::future::pending().await } } => {}
        }
        // Both counts are marked as seen, so that only later halts are new.
        let Halts { count, epoch } = *all.borrow_and_update();
        Halts { count: count + own.as_mut().map_or(0, |own| *own.borrow_and_update()), epoch }
    }
}

async fn changed<T>(watch: &mut watch::Receiver<T>) {
    if watch.changed().await.is_err() {
        std::future::pending::<()>().await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S1, S4: the answer waits for the record, but never for long. While nothing can be written, it does not
    /// wait.
    #[tokio::test(start_paused = true)]
    async fn a_stop_waits_a_moment_for_being_written_down() {
        let halter = Halter::new(Epoch(4));
        let waits = async |epoch| tokio::time::timeout(NOTING / 2, halter.until_noted(epoch)).await.is_err();
        assert!(!waits(Epoch(5)).await, "nobody writes it down");
        halter.note(Some(Epoch(4)));
        assert!(!waits(Epoch(4)).await);
        assert!(waits(Epoch(5)).await);
        let ends = tokio::time::timeout(NOTING * 2, halter.until_noted(Epoch(5))).await;
        assert!(ends.is_ok(), "and not for ever");
        halter.note(Some(Epoch(6)));
        assert!(!waits(Epoch(5)).await);
        halter.note(None);
        assert!(!waits(Epoch(7)).await);
    }
}
