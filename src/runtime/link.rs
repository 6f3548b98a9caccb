//! The port to one robot. Every adapter, the simulated one too, holds one end. How an adapter speaks to its robot is its own
//! business.
//!
//! ```text
//!   the loop ── orders, stamped with the halts so far ──► adapter     (bounded queue)
//!            ── whether the LED blinks ─────────────────►             (latest state)
//!   anyone  ── halts ───────────────────────────────────►             (a count that passes every queue)
//!   the loop ◄─ reports ──────────────────────────────────            (bounded queue)
//! ```

use tokio::sync::{mpsc, watch};

use super::halt::HaltWatch;
use hallsweep_core::effect::Order;
use hallsweep_core::event::RobotEvent;

/// Orders under way to a robot: one is open at a time, and a few may have been voided before the adapter took them.
pub const ORDERS: usize = 8;

/// Reports under way from a robot: a burst of sonar readings and an answer.
pub const REPORTS: usize = 64;

/// An order, and how many halts there had been when it was sent: after a further one it must not begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped {
    pub order: Order,
    pub halts: u64,
}

impl Stamped {
    /// Whether it is a motion that must not begin any more, now that there have been so many halts (safety S6).
    pub const fn is_void(&self, halts: u64) -> bool {
        self.halts < halts && self.order.action.is_motion()
    }
}

/// The loop's end of the link.
#[derive(Debug)]
pub struct RobotLink {
    pub orders: mpsc::Sender<Stamped>,
    /// Whether its LED is to blink.
    pub led: watch::Sender<bool>,
    pub reports: mpsc::Receiver<RobotEvent>,
    /// How often the core has halted this robot; `halts` counts them with those of all robots.
    pub halt: watch::Sender<u64>,
    pub halts: HaltWatch,
}

/// The adapter's end of the link. The adapter halts whenever `halts` is raised and answers the order under way with `Halted`; an
/// order stamped with fewer halts than there have been it answers with `Halted` without beginning it.
#[derive(Debug)]
pub struct RobotSide {
    pub orders: mpsc::Receiver<Stamped>,
    pub led: watch::Receiver<bool>,
    pub reports: mpsc::Sender<RobotEvent>,
    pub halts: HaltWatch,
}

/// Both ends of a new link, halted with all robots by `halts`.
pub fn link(halts: HaltWatch) -> (RobotLink, RobotSide) {
    let (orders, orders_in) = mpsc::channel(ORDERS);
    let (led, led_in) = watch::channel(false);
    let (reports_out, reports) = mpsc::channel(REPORTS);
    let (halt, own) = watch::channel(0);
    let halts = halts.of_one(own);
    let side = RobotSide { orders: orders_in, led: led_in, reports: reports_out, halts: halts.clone() };
    (RobotLink { orders, led, reports, halt, halts }, side)
}
