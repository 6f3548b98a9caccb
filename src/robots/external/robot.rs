//! One external robot before it is started: its protocol, its address, and what the last program knew about it.

use std::path::Path;
use std::time::Duration;

use super::link;
use super::memory_file::MemoryFile;
use super::room::{self, UnusableScene};
use super::wire::{Address, own_address};
use crate::config::{RobotAddress, RobotKind, RobotSettings};
use crate::robots::Adapter;
use crate::runtime::clock::Clock;
use hallsweep_core::robot::RobotId;
use hallsweep_drivers::line::LineDriver;
use hallsweep_drivers::{Dialect, Driver, Room, VirtualRobot};

pub(in crate::robots) struct ExternalRobot {
    id: RobotId,
    kind: ProtocolKind,
    address: Address,
    place: String,
    step: Duration,
    /// The room in the scene file of the robot's page.
    room: Option<Room>,
    remembered: ExternalMemory,
}

#[derive(Clone, Copy)]
enum ProtocolKind {
    Virtual(Dialect),
    /// A robot that knows its own position.
    Line,
}

enum ExternalMemory {
    /// There is no stored position, and no position will be stored.
    Nothing,
    Here(MemoryFile, Option<Box<VirtualRobot>>),
    /// The position of the robot is unknown, for this reason.
    Lost(String),
}

impl ExternalRobot {
    /// Returns `None` for a kind of robot that is part of this program.
    pub(in crate::robots) fn new(id: &RobotId, settings: &RobotSettings) -> Result<Option<ExternalRobot>, UnusableScene> {
        let at = settings.address.to_string();
        let (kind, address) = match (settings.kind, &settings.address) {
            (RobotKind::Sim, _) => return Ok(None),
            (RobotKind::VirtualTcp, _) => (ProtocolKind::Virtual(Dialect::Semicolons), Address::Tcp(at, Some(own_address(id)))),
            (RobotKind::VirtualWs, _) => (ProtocolKind::Virtual(Dialect::Messages), Address::WebSocket(at)),
            (RobotKind::Line, RobotAddress::Device(_)) => (ProtocolKind::Line, Address::Serial(at, settings.baud)),
            (RobotKind::Line, RobotAddress::Network { .. } | RobotAddress::Here) => (ProtocolKind::Line, Address::Tcp(at, None)),
        };
        let (room, step) = match &settings.scene {
            Some(scene) if matches!(kind, ProtocolKind::Virtual(_)) => {
                room::room(id, scene).map(|(room, step)| (Some(room), step))?
            }
            Some(_) | None => (None, settings.step),
        };
        let place = settings.address.place().unwrap_or_default();
        Ok(Some(ExternalRobot { id: id.clone(), kind, address, place, step, room, remembered: ExternalMemory::Nothing }))
    }

    /// The address in words. For a simulated robot, the name of its hall is shown instead.
    pub(in crate::robots) fn place(&self) -> String {
        format!("robot at {}", self.address)
    }

    /// Whether the robot's position is computed from the time that it drives, because no scene file tells where
    /// things are.
    pub(in crate::robots) fn reckons(&self) -> bool {
        matches!(self.kind, ProtocolKind::Virtual(_)) && self.room.is_none()
    }

    pub(in crate::robots) fn recall(&mut self, folder: &Path) {
        let ProtocolKind::Virtual(dialect) = self.kind else { return };
        let whose = format!("a virtual robot at {}", self.place);
        let opened = MemoryFile::open(folder, &self.id, &whose).and_then(|(file, memory)| {
            let read = memory.map(|memory| VirtualRobot::remembering(dialect, self.step, &memory)).transpose();
            let robot = read.map_err(|fault| file.damaged(fault))?;
            Ok((file, robot.map(Box::new)))
        });
        self.remembered = match opened {
            Ok((file, robot)) => ExternalMemory::Here(file, robot),
            Err(lost) => ExternalMemory::Lost(lost.to_string()),
        };
    }

    pub(in crate::robots) fn lost(&self) -> Option<&str> {
        if let ExternalMemory::Lost(lost) = &self.remembered { Some(lost) } else { None }
    }

    /// Makes the adapter. If the position of the robot is unknown, the link stays down, but the adapter counts as
    /// running.
    pub(in crate::robots) fn adapter(self, clock: Clock) -> Adapter {
        let ExternalRobot { id, kind, address, step, room, remembered, .. } = self;
        let (file, known) = match remembered {
            ExternalMemory::Lost(lost) => {
                tracing::error!(robot = %id, lost, "the position of the robot is unknown: hallsweep does not start this robot");
                return Box::new(|side| Box::pin(async move { side.reports.closed().await }));
            }
            ExternalMemory::Here(file, known) => (Some(file), known),
            ExternalMemory::Nothing => (None, None),
        };
        let driver: Box<dyn Driver> = match kind {
            ProtocolKind::Virtual(dialect) => {
                let robot = known.map_or_else(|| VirtualRobot::new(dialect, step), |known| *known);
                Box::new(if let Some(room) = room {
                    robot.in_room(room)
                } else {
                    let ms = step.as_millis();
                    tracing::warn!(robot = %id, "no scene file is set (HALLSWEEP__ROBOT__SCENE): hallsweep assumes {ms} ms per \
                                                 cell");
                    robot
                })
            }
            ProtocolKind::Line => Box::new(LineDriver::new()),
        };
        Box::new(move |side| Box::pin(link::run(id, driver, address, side, clock, file)))
    }
}
