//! What all connections of a broker share. Each part looks after its own lock.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::budget::Budget;
use crate::readers::Readers;
use crate::retained::Retained;
use crate::rights::{Principal, Rights};

/// What all connections of a broker share.
#[derive(Debug)]
pub struct Broker {
    pub(crate) rights: Box<dyn Rights>,
    pub(crate) retained: Retained,
    pub(crate) budget: Budget,
    pub(crate) readers: Arc<Readers>,
    /// How many bytes of messages the router was given of late, counted once for each who reads them.
    pub(crate) fed: AtomicU64,
    /// How many pieces of messages have come out of routers.
    pub(crate) came: AtomicU64,
    pub(crate) parcels: AtomicU64,
}

impl Broker {
    /// A broker at which nothing was said yet.
    #[must_use]
    pub fn new(rights: impl Rights + 'static) -> Broker {
        Broker {
            rights: Box::new(rights),
            retained: Retained::default(),
            budget: Budget::default(),
            readers: Arc::default(),
            fed: AtomicU64::default(),
            came: AtomicU64::default(),
            parcels: AtomicU64::default(),
        }
    }

    /// Whether one may leave a will there: asked before its CONNECT is answered.
    #[must_use]
    pub fn may_leave_will(&self, who: Principal, topic: &str) -> bool {
        self.rights.may_leave_will(who, topic)
    }

    /// Whether the router was shown so many filters or topics that another one is needed.
    #[must_use]
    pub fn is_exhausted(&self) -> bool {
        self.budget.is_exhausted()
    }

    /// How many different filters the router knows: it keeps messages for each, however many read them.
    #[must_use]
    pub fn filters(&self) -> usize {
        self.budget.filters()
    }

    /// There is another router, which knows nothing yet.
    pub fn renew(&self) {
        self.budget.renew();
        self.forget_fed();
    }

    /// How many bytes are kept, or wait for clients that have not read them, each counted once.
    #[must_use]
    pub fn held_bytes(&self) -> usize {
        self.retained.bytes() + self.retained.beside()
    }

    /// What the router was given until now is not counted any more.
    pub fn forget_fed(&self) {
        self.fed.store(0, Ordering::Relaxed);
    }

    /// How many bytes of messages the router was given of late, counted once for each who reads them.
    #[must_use]
    pub fn fed_bytes(&self) -> u64 {
        self.fed.load(Ordering::Relaxed)
    }

    /// How many pieces of messages have come out of routers.
    #[must_use]
    pub fn came(&self) -> u64 {
        self.came.load(Ordering::Relaxed)
    }
}
