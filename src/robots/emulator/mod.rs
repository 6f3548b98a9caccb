//! A self-built robot, played by the simulated robot. The robot's end of the line protocol is joined to the simulator
//! by the same kind of link that the program uses. So the simulated robot draws photos, waits and halts as it does in
//! the program.
//!
//! ```text
//!   program ◄── wire, with its faults ──► LineRobot ── orders, halts, the LED ──► simulated robot
//!                                                   ◄─ reports ──────────────────
//! ```

mod connection;
mod faults;
mod wire;

use std::sync::Arc;

use tokio::sync::watch;

use self::connection::Connection;
pub use self::faults::Faults;
use self::wire::Wire;
pub use self::wire::{EmulatorError, End};
use super::sim::{Remote, SimRobot};
use crate::config::RobotSettings;
use crate::runtime::clock::Clock;
use crate::runtime::halt::Halter;
use crate::runtime::link::{RobotLink, Stamped, link};
use hallsweep_core::event::{Photo, RobotEvent};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::robot::RobotId;
use hallsweep_core::units::Epoch;
use hallsweep_drivers::line::{BodyRequest, LineRobot};
pub use hallsweep_drivers::line::{MOST_BYTES, RobotName};
use hallsweep_sim::Hall;

#[derive(Clone, Debug)]
pub struct Emulation {
    pub name: RobotName,
    pub end: End,
    /// Minimum size of photos in bytes, reached by padding after the picture.
    pub photo_bytes: usize,
    pub faults: Faults,
}

/// Plays the robot for one program at a time, until the returned future is dropped. Calls `announce` with the robot's
/// address, including the real port.
pub async fn play(
    hall: Arc<Hall>,
    settings: &RobotSettings,
    emulation: Emulation,
    announce: impl FnOnce(&str),
) -> Result<(), EmulatorError> {
    let clock = Clock::default();
    let (wire, place) = Wire::open(emulation.end.clone()).await?;
    let halter = Halter::new(Epoch(0));
    let (link, side) = link(halter.watch());
    let robot = SimRobot::new(RobotId::discovery(), hall, settings, false);
    // No other robot is in this robot's hall, so nobody else lifts a piece.
    tokio::spawn(robot.adapter(clock, watch::channel(Default::default()).1, Remote::untouched())(side));
    announce(&place);
    let chance = RandomStream::new(settings.seed, "wire");
    let robot = LineRobot::new(emulation.name.clone());
    Emulator { emulation, clock, wire, connection: None, robot, link, halter, chance }.run().await
}

struct Emulator {
    emulation: Emulation,
    clock: Clock,
    wire: Wire,
    connection: Option<Connection>,
    robot: LineRobot,
    link: RobotLink,
    halter: Halter,
    chance: RandomStream,
}

impl Emulator {
    async fn run(mut self) -> Result<(), EmulatorError> {
        loop {
            self.pass_on();
            let is_connected = self.connection.is_some();
            tokio::select! {
                biased;
                stream = self.wire.next(&self.clock, is_connected) => {
                    // A new program replaces the previous one.
                    self.robot.handle_lost();
                    let chance = RandomStream::new(self.chance.number(), "connection");
                    self.connection = Some(Connection::new(stream, self.emulation.faults, chance, self.clock));
                }
                heard = hear(&mut self.connection) => self.heard(heard),
                report = self.link.reports.recv() => match report {
                    Some(report) => self.robot.handle_event(self.padded(report)),
                    None => return Err(EmulatorError::SimulationEnded),
                },
                () = self.clock.reach(self.robot.poll_timeout()) => self.robot.handle_timeout(self.clock.now()),
            }
        }
    }

    fn pass_on(&mut self) {
        while let Some(asked) = self.robot.poll_asked() {
            match asked {
                BodyRequest::Halt => self.halter.halt(),
                BodyRequest::Led(blinks) => drop(self.link.led.send_replace(blinks)),
                BodyRequest::Order(order) => {
                    // Only one order is open at a time, so the channel has room for it.
                    let stamped = Stamped { order, halts: self.link.halts.now().count };
                    let _ = self.link.orders.try_send(stamped);
                }
            }
        }
        let Some(connection) = &mut self.connection else { return };
        while connection.has_room() {
            let Some(bytes) = self.robot.poll_output() else { break };
            connection.say(&bytes);
        }
    }

    fn heard(&mut self, bytes: Option<Vec<u8>>) {
        match bytes {
            Some(bytes) => self.robot.handle_received(&bytes, self.clock.now()),
            None => {
                self.connection = None;
                self.wire.close(&self.clock);
                self.robot.handle_lost();
            }
        }
    }

    /// Pads the photo in a report to the requested size. Programs that read pictures ignore the padding.
    fn padded(&self, report: RobotEvent) -> RobotEvent {
        let RobotEvent::Photo(id, photo) = report else { return report };
        let mut bytes = photo.bytes.to_vec();
        bytes.resize(bytes.len().max(self.emulation.photo_bytes), 0);
        RobotEvent::Photo(id, Photo { bytes: Arc::from(bytes), ..photo })
    }
}

async fn hear(connection: &mut Option<Connection>) -> Option<Vec<u8>> {
    match connection {
        Some(connection) => connection.hear().await,
        None => std::future::pending().await,
    }
}

#[cfg(test)]
mod tests;
