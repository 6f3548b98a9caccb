//! The threads (safety S7). Each of these has a thread of its own: the core's loop, the link to the robot, the
//! reading of each door, and the gate of our own MQTT broker. In the gate one thread passes messages on sooner than
//! several threads that wake each other. All other work of the doors runs on the ordinary threads. The ordinary
//! threads may be busy. They have a lower priority, which matters when there are too few processors for all threads.

use std::io;

use tokio::runtime::{Builder, Runtime};

use super::AppError;
use crate::runtime::threads::Thread;

/// Difference in nice value between the ordinary threads and the others. While both kinds have work, an ordinary
/// thread gets a third of the time that one of the other threads gets.
#[cfg(target_os = "linux")]
const NICER: i32 = 5;

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

pub(super) fn ordinary() -> io::Result<Runtime> {
    Builder::new_multi_thread().enable_all().on_thread_start(stand_back).build()
}

/// Lowers the priority of this thread below the priority of the threads that a STOP needs. Works only on Linux: on
/// other systems priorities apply to whole programs.
fn stand_back() {
    #[cfg(target_os = "linux")]
    {
        use rustix::process::{getpriority_process, setpriority_process};
        if let Err(error) = getpriority_process(None).and_then(|before| setpriority_process(None, before + NICER)) {
            tracing::debug!(%error, "an ordinary thread has as much right to the machine as those that hear");
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use rustix::process::getpriority_process;

    use super::*;

    /// Safety S7.
    #[test]
    fn ordinary_threads_stand_back_behind_those_that_hear() {
        const NICEST: i32 = 19;
        let threads = Threads::start().expect("the system gives threads");
        let ordinary = ordinary().expect("the system gives more");
        let own = || async { getpriority_process(None).expect("the system says") };
        let before = getpriority_process(None).expect("the system says");
        let of = |on: &tokio::runtime::Handle| ordinary.block_on(on.spawn(own())).expect("it says");
        let Threads { core, robot, http, coap, mqtt, gate } = &threads;
        assert!([core, robot, http, coap, mqtt, gate].iter().all(|thread| of(thread.handle()) == before));
        assert_eq!(of(ordinary.handle()), (before + NICER).min(NICEST));
        let blocking = ordinary.spawn_blocking(|| getpriority_process(None).expect("the system says"));
        assert_eq!(ordinary.block_on(blocking).expect("it says"), (before + NICER).min(NICEST));
    }
}
