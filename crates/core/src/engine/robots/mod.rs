//! The robots by their ids: capabilities, open orders, holds of their own. One of them searches. The places of all
//! robots are part of `state`. What a mission wants of the robots is not decided here.

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
    /// Whether the robot stands away from where its last completed order left it.
    pub(crate) off_centre: bool,
    /// `None` beyond the sonar's range, or before the first reading.
    pub(crate) sonar_cm: Option<u16>,
    /// What will be ahead of the robot once the order under way is done.
    pub(crate) ahead: Option<Ahead>,
    /// The holds of this robot alone. The holds of the robot that searches are among the holds of the mission.
    pub(crate) holds: Holds,
    /// The arm as last reported; the default for a robot without an arm.
    pub(crate) arm: ArmState,
    /// Whether the robot has reported its arm since the program began or the link was lost.
    pub(crate) arm_is_heard: bool,
    /// Number of consecutive orders that the robot failed to carry out.
    pub(crate) failures: u32,
    /// Why the robot cannot be reached, while that is so and a reason is known.
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

    /// Adds a robot, which counts as unreached at first. If `is_awaited`, the robot also waits for a START.
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

    /// The robot that searches, then the other robots by their names.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&RobotId, &Robot)> {
        std::iter::once((&self.searching.0, &self.searching.1)).chain(&self.others)
    }

    /// Makes the other robots wait for START, so that none of them moves when a hold of all robots ends. Called when
    /// such a hold begins during a mission. Returns whether the wait is new to any robot.
    pub(crate) fn others_wait(&mut self) -> bool {
        self.others.values_mut().fold(false, |any, robot| any | robot.holds.raise(Hold::AwaitingStart))
    }

    /// A START was accepted: robots that waited for it may move. Returns whether any robot waited.
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

    /// The next time at which a robot's open order counts as unanswered.
    pub(crate) fn due(&self) -> Option<Duration> {
        self.iter().filter_map(|(_, robot)| robot.controller.due()).min()
    }

    pub(crate) fn overdue(&self, since_start: Duration) -> Option<RobotId> {
        let is_late = |robot: &Robot| robot.controller.due().is_some_and(|due| due <= since_start);
        self.iter().find(|(_, robot)| is_late(robot)).map(|(id, _)| id.clone())
    }
}
