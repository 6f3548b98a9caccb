//! The resource model itself: everything that is shown, with a revision for each part.
//! What may change it, and when, is the mission's business; here changes are only made and counted.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::alarm::Alarm;
use super::hall_map::HallMap;
use super::log::{Log, Tone};
use super::luggage::Luggage;
use super::resource::Resource;
use super::robot::{RobotState, RobotView};
use super::temperature::Thermometer;
use crate::event::Piece;
use crate::settings::Settings;
use crate::units::{AlarmId, Cell, LuggageId, Pose, Revision, WallTime};

/// What is known.
#[derive(Clone, Debug)]
pub struct World {
    /// Which run of the program this is.
    pub run: Arc<str>,
    /// The robot that searches.
    pub robot: RobotView,
    /// The hall.
    pub map: HallMap,
    /// The luggage of this mission.
    pub luggage: BTreeMap<LuggageId, Arc<Luggage>>,
    /// The pieces the camera would know again: those on record of whatever stands on the map.
    pub pieces: BTreeSet<Piece>,
    /// The temperature.
    pub thermometer: Thermometer,
    /// The alarms, oldest first.
    pub alarms: Vec<Arc<Alarm>>,
    /// The latest log lines.
    pub log: Log,
    /// Why nothing can be put on record just now, as the store says it.
    pub store_failure: Option<String>,
    last_alarm: AlarmId,
    revision: Revision,
    revisions: [Revision; Resource::COUNT],
    /// Whether the input being handled has raised the revision already: all its changes make one revision.
    raised: bool,
}

impl World {
    /// A robot at home in a hall of which nothing is known.
    #[must_use]
    pub fn new(run: Arc<str>, settings: &Settings) -> World {
        let robot = RobotView {
            state: RobotState::Stopped,
            halting: false,
            pose: Pose::START,
            off_centre: false,
            sonar_cm: None,
            led_blinking: false,
        };

        World {
            run,
            robot,
            map: HallMap::new(Cell::HOME, Revision(1)),
            luggage: BTreeMap::new(),
            pieces: BTreeSet::new(),
            thermometer: Thermometer::new(settings.threshold, settings.hysteresis),
            alarms: Vec::new(),
            log: Log::default(),
            store_failure: None,
            last_alarm: AlarmId(0),
            revision: Revision(1),
            revisions: [Revision(1); Resource::COUNT],
            raised: false,
        }
    }

    /// The next change begins a new revision.
    pub fn turn_page(&mut self) {
        self.raised = false;
    }

    /// Notes that a resource has changed; returns the revision of the change.
    pub fn touch(&mut self, resource: Resource) -> Revision {
        if !self.raised {
            self.revision = self.revision.next();
            self.raised = true;
        }
        self.revisions[resource as usize] = self.revision;
        self.revision
    }

    /// How often anything has changed.
    #[must_use]
    pub const fn revision(&self) -> Revision {
        self.revision
    }

    /// For each resource the revision of its last change.
    #[must_use]
    pub const fn revisions(&self) -> [Revision; Resource::COUNT] {
        self.revisions
    }

    /// Writes a log line: a warning at once, what follows from a command or a find when that is on record (safety R4).
    pub fn write(&mut self, wall: WallTime, tone: Tone, text: String) {
        if self.log.write(wall, tone, text) {
            self.touch(Resource::Log);
        }
    }

    /// Raises an alarm; `None` when the same one is already there and not yet seen.
    pub fn alarm(&mut self, wall: WallTime, luggage: Option<LuggageId>, text: &str) -> Option<AlarmId> {
        if self.alarms.iter().any(|alarm| alarm.acknowledged.is_none() && alarm.luggage == luggage && alarm.text == text) {
            return None;
        }
        self.last_alarm = self.last_alarm.next();
        let alarm = Alarm { id: self.last_alarm, raised: wall, text: text.to_owned(), luggage, acknowledged: None };
        self.alarms.push(Arc::new(alarm));
        self.touch(Resource::Alarms);
        Some(self.last_alarm)
    }

    /// The number of the last alarm.
    #[must_use]
    pub const fn last_alarm(&self) -> AlarmId {
        self.last_alarm
    }

    /// The alarms as they were before a restart.
    pub fn take_up_alarms(&mut self, alarms: Vec<Arc<Alarm>>, last: AlarmId) {
        (self.alarms, self.last_alarm) = (alarms, last);
    }

    /// Whether the robot stands in the middle of its home cell.
    #[must_use]
    pub fn is_home(&self) -> bool {
        self.robot.pose.cell == Cell::HOME && !self.robot.off_centre
    }
}
