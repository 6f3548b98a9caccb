//! The port to one robot. The loop has one end, and the robot's adapter has the other end; simulated robots have
//! adapters, too. How an adapter talks to its robot is not known here.
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

/// Capacity of the queue of orders. Only one order is open at a time, but a few may have become void before the
/// adapter took them.
pub const ORDERS: usize = 8;

/// Capacity of the queue of reports. It is enough for a burst of sonar readings and an answer.
pub const REPORTS: usize = 64;

/// An order, and the number of halts when it was sent. A motion must not begin after a further halt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped {
    pub order: Order,
    pub halts: u64,
}

impl Stamped {
    /// Whether the order is a motion that must not begin any more, because the robot was halted after the order was
    /// sent (safety S6). `halts` is the present number of halts.
    pub const fn is_void(&self, halts: u64) -> bool {
        self.halts < halts && self.order.action.is_motion()
    }
}

#[derive(Debug)]
pub struct RobotLink {
    pub orders: mpsc::Sender<Stamped>,
    pub led: watch::Sender<bool>,
    pub reports: mpsc::Receiver<RobotEvent>,
    /// Number of times that the core has halted this robot alone. The field `halts` counts these halts and the halts
    /// of all robots.
    pub halt: watch::Sender<u64>,
    pub halts: HaltWatch,
}

/// The adapter's end of the link. When `halts` is raised, the adapter halts, and answers the order under way with
/// `Halted`. A motion that was stamped with fewer halts does not begin, and is answered with `Halted`.
#[derive(Debug)]
pub struct RobotSide {
    pub orders: mpsc::Receiver<Stamped>,
    pub led: watch::Receiver<bool>,
    pub reports: mpsc::Sender<RobotEvent>,
    pub halts: HaltWatch,
}

pub fn link(halts: HaltWatch) -> (RobotLink, RobotSide) {
    let (orders, orders_in) = mpsc::channel(ORDERS);
    let (led, led_in) = watch::channel(false);
    let (reports_out, reports) = mpsc::channel(REPORTS);
    let (halt, own) = watch::channel(0);
    let halts = halts.of_one(own);
    let side = RobotSide { orders: orders_in, led: led_in, reports: reports_out, halts: halts.clone() };
    (RobotLink { orders, led, reports, halt, halts }, side)
}
