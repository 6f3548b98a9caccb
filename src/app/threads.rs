//! Who runs on a thread of his own (safety S7): the core's loop, the robot's link, and what each door hears; and the gate of our own
//! MQTT broker, where one thread passes messages on sooner than several that wake each other. Everything else that a door does runs on
//! the ordinary threads, where it may be busy.

use super::AppError;
use crate::runtime::threads::Thread;

/// The threads; all of them end when this is dropped.
pub(super) struct Threads {
    pub(super) core: Thread,
    pub(super) robot: Thread,
    pub(super) http: Thread,
    pub(super) coap: Thread,
    pub(super) mqtt: Thread,
    pub(super) gate: Thread,
}

impl Threads {
    /// Starts all of them.
    ///
    /// # Errors
    /// `AppError::System`: the system does not give so many.
    pub(super) fn start() -> Result<Threads, AppError> {
        let start = |name| Thread::start(name).map_err(AppError::System);
        Ok(Threads {
            core: start("core")?,
            robot: start("robot")?,
            http: start("hear-http")?,
            coap: start("hear-coap")?,
            mqtt: start("hear-mqtt")?,
            gate: start("mqtt-gate")?,
        })
    }
}
