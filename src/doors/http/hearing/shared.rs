//! State of one connection. The hearing thread and the task that answers share it.

use std::collections::BTreeMap;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::watch;

use crate::runtime::carry_out::{Done, NotDone};
use hallsweep_core::hall::HallId;
use hallsweep_core::units::Epoch;

/// Maximum number of STOPs of one connection that wait until hyper reads their requests. Each takes some 1.5 KiB. A
/// further STOP is also carried out at once, and a second time by the handler of its request.
pub(super) const STOP_OUTCOMES: usize = 128;

/// The result of a STOP. The STOP was carried out when its request was read.
pub(in crate::doors::http) type StopOutcome = Pin<Box<dyn Future<Output = Result<Done, NotDone>> + Send>>;

/// The STOP that was found in a request, or may still be found in its body. The handler of the request takes it.
#[derive(Clone)]
pub(in crate::doors::http) struct Pressed {
    pub(super) shared: Arc<ConnectionState>,
    pub(super) number: u64,
}

/// The epoch of the named hall in which the head of a request was read. If a STOP raises the epoch after that, the
/// request is outdated, even if it is carried out much later (safety S4).
#[derive(Clone, PartialEq, Eq)]
pub(in crate::doors::http) struct Arrived {
    /// `None` for the default hall.
    pub(in crate::doors::http) hall: Option<HallId>,
    pub(in crate::doors::http) epoch: Epoch,
}

pub(super) struct ConnectionState {
    stop_outcomes: Mutex<BTreeMap<u64, StopOutcome>>,
    /// Epochs in which requests arrived. Each key is the number of the first request of that hall and epoch.
    epochs: Mutex<BTreeMap<u64, Arrived>>,
    /// Whether an answer has switched the connection to WebSocket. This answer is the last one.
    pub(super) is_handed_over: watch::Sender<bool>,
    /// Whether an endless answer, such as an event stream, has begun.
    pub(super) is_endless: watch::Sender<bool>,
}

impl Pressed {
    pub(in crate::doors::http) fn take(&self) -> Option<StopOutcome> {
        self.shared.stop_outcomes().remove(&self.number)
    }

    pub(in crate::doors::http) fn is_there(&self) -> bool {
        self.shared.stop_outcomes().contains_key(&self.number)
    }
}

impl ConnectionState {
    pub(super) fn new() -> Arc<ConnectionState> {
        Arc::new(ConnectionState {
            stop_outcomes: Mutex::default(),
            epochs: Mutex::default(),
            is_handed_over: watch::Sender::default(),
            is_endless: watch::Sender::default(),
        })
    }

    /// Records the epoch in which the head of this request was read.
    pub(super) fn came(&self, number: u64, arrived: Arrived) {
        let mut epochs = self.epochs();
        // If there are too many epochs, later requests get the last recorded one. No request then counts as newer
        // than it is.
        if epochs.len() < STOP_OUTCOMES && epochs.values().next_back() != Some(&arrived) {
            epochs.insert(number, arrived);
        }
    }

    pub(super) fn arrived(&self, number: u64) -> Option<Arrived> {
        let mut epochs = self.epochs();
        let (first, arrived) = epochs.range(..=number).next_back().map(|(first, arrived)| (*first, arrived.clone()))?;
        *epochs = epochs.split_off(&first);
        Some(arrived)
    }

    fn epochs(&self) -> MutexGuard<'_, BTreeMap<u64, Arrived>> {
        self.epochs.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn keep(&self, number: u64, given: StopOutcome) {
        let mut stop_outcomes = self.stop_outcomes();
        if stop_outcomes.len() < STOP_OUTCOMES {
            stop_outcomes.insert(number, given);
        }
    }

    /// Whether the outcome of a STOP waits for the handler of its request.
    pub(super) fn has_heard(&self) -> bool {
        !self.stop_outcomes().is_empty()
    }

    pub(super) fn is_handed_over(&self) -> bool {
        *self.is_handed_over.borrow()
    }

    pub(super) async fn handed_over(&self) {
        let mut is_handed_over = self.is_handed_over.subscribe();
        // This object owns the sender, so the channel stays open.
        drop(is_handed_over.wait_for(|is_handed_over| *is_handed_over).await);
    }

    /// Removes the STOPs of earlier requests that their handlers did not take.
    pub(super) fn forget_before(&self, number: u64) {
        let mut stop_outcomes = self.stop_outcomes();
        let later = stop_outcomes.split_off(&number);
        *stop_outcomes = later;
    }

    pub(super) fn stop_outcomes(&self) -> MutexGuard<'_, BTreeMap<u64, StopOutcome>> {
        self.stop_outcomes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
