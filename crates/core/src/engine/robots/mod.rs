//! The robots by their ids, with their capabilities, open orders and own holds. One of them searches. `state` has the
//! places of all robots. Other modules decide what the robots are to do.

mod controller;

use crate::robot::RobotId;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

pub(crate) use self::controller::RobotController;
use crate::arm::ArmState;
use crate::event::Ahead;
use crate::hold::{Hold, Holds};
use crate::units::WallTime;

#[derive(Clone, Debug, Default)]
pub(crate) struct Robot {
    pub(crate) controller: RobotController,
    /// Whether the robot is away from the place where its last completed order ended.
    pub(crate) off_centre: bool,
    /// The last reading of the sonar, in centimetres. `None` if nothing was in range, or before the first reading.
    pub(crate) sonar_cm: Option<u16>,
    /// What will be ahead of the robot at the end of the current order.
    pub(crate) ahead: Option<Ahead>,
    /// The holds of this robot alone. The holds of the robot that searches are among the holds of the mission.
    pub(crate) holds: Holds,
    /// The last reported state of the arm; the default for a robot without an arm.
    pub(crate) arm: ArmState,
    /// Whether the robot has reported its arm since the start of the program and since the last loss of its link.
    pub(crate) arm_is_heard: bool,
    /// Number of consecutive orders that the robot failed to carry out.
    pub(crate) failures: u32,
    /// The reason why the robot cannot be reached, if known; `None` while it can be reached.
    pub(crate) unreached: Option<Arc<str>>,
    pub(crate) unreached_since: Option<WallTime>,
}

#[derive(Clone, Debug)]
pub(crate) struct Robots {
    searching: (RobotId, Robot),
    others: BTreeMap<RobotId, Robot>,
}

impl Robots {
    pub(crate) fn of(searching: RobotId) -> Robots {
        Robots { searching: (searching, Robot::default()), others: BTreeMap::new() }
    }

    /// Adds a robot. It counts as unreached at first. If `is_awaited`, the robot also waits for a START.
    pub(crate) fn add(&mut self, id: RobotId, is_awaited: bool) {
        if id != self.searching.0 {
            let holds = std::iter::once(Hold::RobotLink).chain(is_awaited.then_some(Hold::AwaitingStart)).collect();
            self.others.entry(id).or_insert_with(|| Robot { holds, ..Robot::default() });
        }
    }

    pub(crate) const fn searching_id(&self) -> &RobotId {
        &self.searching.0
    }

    pub(crate) const fn searching(&self) -> &Robot {
        &self.searching.1
    }

    pub(crate) const fn searching_mut(&mut self) -> &mut Robot {
        &mut self.searching.1
    }

    pub(crate) fn get(&self, id: &RobotId) -> Option<&Robot> {
        if *id == self.searching.0 { Some(&self.searching.1) } else { self.others.get(id) }
    }

    pub(crate) fn get_mut(&mut self, id: &RobotId) -> Option<&mut Robot> {
        if *id == self.searching.0 { Some(&mut self.searching.1) } else { self.others.get_mut(id) }
    }

    /// Returns the robot that searches, then the other robots by their names.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&RobotId, &Robot)> {
        std::iter::once((&self.searching.0, &self.searching.1)).chain(&self.others)
    }

    /// Makes the other robots wait for START. This is called when a hold of all robots begins during a mission, so
    /// that no robot moves when that hold ends. Returns whether at least one robot did not wait before.
    pub(crate) fn others_wait(&mut self) -> bool {
        self.others.values_mut().fold(false, |any, robot| any | robot.holds.raise(Hold::AwaitingStart))
    }

    /// Ends the wait for START of the robots that do not search. Returns whether any of them waited.
    pub(crate) fn release(&mut self) -> bool {
        self.others.values_mut().fold(false, |any, robot| any | robot.holds.release())
    }

    pub(crate) fn ids(&self) -> Vec<RobotId> {
        self.iter().map(|(id, _)| id.clone()).collect()
    }

    /// Whether any robot may still be moving although it was told to halt (safety S8).
    pub(crate) fn are_halting(&self) -> bool {
        self.iter().any(|(_, robot)| robot.controller.is_halting())
    }

    pub(crate) fn moving(&self) -> Vec<RobotId> {
        self.iter().filter(|(_, robot)| robot.controller.is_moving()).map(|(id, _)| id.clone()).collect()
    }

    /// Returns the next time at which a robot's open order counts as unanswered.
    pub(crate) fn due(&self) -> Option<Duration> {
        self.iter().filter_map(|(_, robot)| robot.controller.due()).min()
    }

    pub(crate) fn overdue(&self, since_start: Duration) -> Option<RobotId> {
        let is_late = |robot: &Robot| robot.controller.due().is_some_and(|due| due <= since_start);
        self.iter().find(|(_, robot)| is_late(robot)).map(|(id, _)| id.clone())
    }
}
