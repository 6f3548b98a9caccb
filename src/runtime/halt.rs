//! The halt that bypasses every queue (safety S1): a count that anyone may raise and that every writer towards a robot looks at
//! before it begins an order. A stop also raises the epoch. What a halt means for the mission is the core's business.

use std::time::Duration;

use tokio::sync::watch;

use super::figures::Figures;
use hallsweep_core::units::Epoch;

/// So long the answer to a stop waits until the stop is written down: a disk that is well takes a thousandth of it, and one that
/// hangs must not keep an operator from hearing that the robot was halted.
const NOTING: Duration = Duration::from_millis(100);

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
pub struct Halter {
    halts: watch::Sender<Halts>,
    /// The last stop that is written down; `None` while nobody can.
    noted: watch::Sender<Option<Epoch>>,
    figures: Figures,
}

impl Halter {
    pub fn new(epoch: Epoch) -> Halter {
        let halts = watch::Sender::new(Halts { count: 0, epoch });
        Halter { halts, noted: watch::Sender::new(None), figures: Figures::default() }
    }

    /// Somebody's stop: halts every robot now; returns the epoch this stop has made.
    pub fn stop(&self) -> Epoch {
        let mut raised = Epoch(0);
        self.figures.raise_stop();
        self.halts.send_modify(|halts| {
            *halts = Halts { count: halts.count + 1, epoch: halts.epoch.next() };
            raised = halts.epoch;
        });
        raised
    }

    /// Halts every robot now, whatever holds them.
    pub fn halt(&self) {
        self.halts.send_modify(|halts| halts.count += 1);
    }

    /// What the program counts, stops among it.
    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    /// Where a writer, or the core's loop, learns of halts.
    pub fn watch(&self) -> HaltWatch {
        HaltWatch { all: self.halts.subscribe(), own: None }
    }

    /// Says up to which epoch stops are written down where they outlive the program; `None` when they cannot be just now.
    pub fn note(&self, noted: Option<Epoch>) {
        self.noted.send_replace(noted);
    }

    /// Waits until the stop of this epoch is written down: a moment at most, and not at all when nobody can.
    pub async fn until_noted(&self, epoch: Epoch) {
        let mut noted = self.noted.subscribe();
        let done = noted.wait_for(|noted| noted.is_none_or(|noted| noted >= epoch));
        // The stop has acted; one that is not written down in time is written down later.
        let _ = tokio::time::timeout(NOTING, done).await;
    }
}

/// Sees halts as they are raised: those of all robots, and of one robot alone those that the core raises for it.
#[derive(Clone, Debug)]
pub struct HaltWatch {
    all: watch::Receiver<Halts>,
    own: Option<watch::Receiver<u64>>,
}

impl HaltWatch {
    /// The same for one robot, which is halted by this count too.
    pub fn of_one(self, own: watch::Receiver<u64>) -> HaltWatch {
        HaltWatch { own: Some(own), ..self }
    }

    pub fn now(&self) -> Halts {
        let Halts { count, epoch } = *self.all.borrow();
        Halts { count: count + self.own.as_ref().map_or(0, |own| *own.borrow()), epoch }
    }

    /// Waits until a halt is raised that was not yet seen here; never ends when nobody can raise one any more.
    pub async fn raised(&mut self) -> Halts {
        let HaltWatch { all, own } = self;
        tokio::select! {
            biased;
            () = changed(all) => {}
            () = async { match own { Some(own) => changed(own).await, None => std::future::pending().await } } => {}
        }
        // Both are seen: what comes from here on is news.
        let Halts { count, epoch } = *all.borrow_and_update();
        Halts { count: count + own.as_mut().map_or(0, |own| *own.borrow_and_update()), epoch }
    }
}

/// Waits for a change; never ends when none can come any more.
async fn changed<T>(watch: &mut watch::Receiver<T>) {
    if watch.changed().await.is_err() {
        std::future::pending::<()>().await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S1, S4: the answer waits for the writing, never for long, and not when nobody can write.
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
