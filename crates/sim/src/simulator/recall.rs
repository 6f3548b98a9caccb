//! How the simulated robot hands out its memory, and continues from it in the next run of the program. `memory` has the
//! contents, and `state_file` stores them.

use std::sync::Arc;

use super::super::memory::{Astray, Underway};
use super::{Hall, Sim, SimMemory, SimSettings, Work};

impl Sim {
    /// The robot of an earlier run, in the same hall, after the program has died: where it was, halted by itself within
    /// half a second. After a step that was cut short it stands between two cells with the pose of the last completed
    /// order, so that recentring brings it back there. Its first reports are those of a new robot.
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

    /// The state to store, once whenever something has changed: an order began or ended, or the temperature was
    /// reported. Store it before passing on the reports that follow.
    pub fn poll_memory(&mut self) -> Option<SimMemory> {
        std::mem::take(&mut self.unkept).then(|| self.memory())
    }
}
