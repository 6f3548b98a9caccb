//! How the simulated robot gives its memory to the program, and continues from it in the next run. `memory` defines
//! the contents, and `state_file` stores them.

use std::sync::Arc;

use super::super::memory::{Astray, Underway};
use super::{Hall, Sim, SimMemory, SimSettings, Work};

impl Sim {
    /// Makes the robot of an earlier run again, in the same hall, after the program has died. The robot is where it
    /// was, and has halted by itself within half a second. If a step was cut short, it stands between two cells. Its
    /// pose is still that of the last completed order, so recentring brings it back there. Its first reports are
    /// those of a new robot.
    #[must_use]
    pub fn remembering(hall: Arc<Hall>, settings: SimSettings, memory: SimMemory) -> Sim {
        Sim::placed(hall, settings, memory.at_rest(settings.seed))
    }

    /// The state that the robot and its hall would retain if the program died now.
    #[must_use]
    pub fn memory(&self) -> SimMemory {
        let centre = self.centre();
        let motion = match self.task.as_ref().map(|task| &task.work) {
            Some(Work::Drive { motion, .. }) => Some(Underway {
                to: Astray::between(centre, motion.at(self.chassis, motion.ends)),
                left: motion.ends.saturating_sub(self.now.max(motion.began)),
            }),
            Some(Work::Photograph { .. } | Work::Handle { .. }) | None => None,
        };
        SimMemory {
            pose: self.pose,
            outside: self.outside,
            stands: Astray::between(centre, self.body_at(self.now)),
            taken: self.taken,
            motion,
            age: self.before.saturating_add(self.now),
            restarts: self.restarts,
        }
    }

    /// The state to store. Returns `None` if nothing has changed since the last call. The state changes when an order
    /// begins or ends, and when a temperature is reported. Store the state before passing on the reports that follow.
    pub fn poll_memory(&mut self) -> Option<SimMemory> {
        std::mem::take(&mut self.unkept).then(|| self.memory())
    }
}
