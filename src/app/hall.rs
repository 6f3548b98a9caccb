//! One hall that runs: its data folder, its core, its robots, and its simulator. All halls share the threads `core` and
//! `robot`.

use std::collections::BTreeMap;
use std::sync::Arc;

use tokio::sync::watch;
use tokio::task::{JoinError, JoinHandle};

use super::data_folder::{self, DataFolder};
use super::threads::Threads;
use super::{AppError, elsewhere, exercise};
use crate::access;
use crate::config::HallSettings;
use crate::doors::http::HallDoor;
use crate::robots::{Adapter, Adapters, Robots};
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::clock::Clock;
use crate::runtime::halt::Halter;
use crate::runtime::handle::Handle;
use crate::runtime::link::link;
use crate::runtime::simulator::Simulator;
use crate::runtime::task::{Course, Task};
use crate::storage::stops;
use hallsweep_core::engine::{Engine, Recalled};
use hallsweep_core::hall::HallId;
use hallsweep_core::hold::Hold;
use hallsweep_core::robot::RobotId;
use hallsweep_core::state::Venue;
use hallsweep_core::units::Epoch;

/// A hall whose hall file was read. Its data folder is not in use yet.
pub(super) struct PreparedHall {
    settings: HallSettings,
    robots: Robots,
    /// For an operator.
    notes: Vec<String>,
}

/// A hall that can be started: its data folder is open.
pub(super) struct OpenHall {
    settings: HallSettings,
    robots: Robots,
    kept: DataFolder,
}

/// A hall whose core and robots run.
pub(super) struct Hall {
    pub(super) handle: Handle,
    pub(super) reader: ArchiveReader,
    task: JoinHandle<()>,
    settings: HallSettings,
    venue: Venue,
    simulator: Option<Arc<dyn Simulator>>,
    halter: Halter,
    course: watch::Sender<Course>,
}

impl PreparedHall {
    /// Reads the hall, and archives old missions. This happens before any door is open, because no answer of a door may
    /// wait for archiving.
    pub(super) fn new(settings: &HallSettings, notes: Option<String>) -> Result<PreparedHall, AppError> {
        let settings = exercise::settled(settings)?;
        let robots = Robots::of(&settings)?;
        let notes = data_folder::write_out_old(&settings).into_iter().chain(notes).collect();
        Ok(PreparedHall { settings, robots, notes })
    }

    /// Opens the data folder. `keys` is the reason why nobody can sign in, if there is one: then nothing may move.
    pub(super) fn open(self, keys: Option<String>) -> Result<OpenHall, AppError> {
        let PreparedHall { settings, mut robots, notes } = self;
        let mut kept = DataFolder::open(&settings, &mut robots, keys, notes)?;
        kept.are_tests_known = exercise::check(&settings, &kept)?;
        Ok(OpenHall { settings, robots, kept })
    }
}

impl OpenHall {
    /// Starts the core and the robots. `id` is the name of the hall in its addresses, and `None` for the default hall.
    /// `other` replaces the searching robot of the settings.
    pub(super) async fn start(self, id: Option<HallId>, other: Option<Adapter>, threads: &Threads) -> Hall {
        let OpenHall { settings, robots, kept } = self;
        let halter = Halter::new(kept.epoch());
        let reader = ArchiveReader::new(Arc::clone(&kept.archive));
        let venue = robots.venue();
        let (course, coursed) = watch::channel(Course::default());
        let (handle, task, simulator) = start(id, &settings, robots, other, kept, &halter, coursed, threads).await;
        Hall { handle, reader, task, settings, venue, simulator, halter, course }
    }
}

impl Hall {
    pub(super) async fn linked(&self) {
        // If the loop has ended, there is nothing to wait for.
        let _ = self.handle.watch().wait_for(|state| !state.mission.holds.contains(&Hold::RobotLink)).await;
    }

    pub(super) fn warn_of_missing_robot(&self) {
        if self.handle.snapshot().mission.holds.contains(&Hold::RobotLink) {
            tracing::warn!(hall = self.settings.name.name(), "the robot has not been reached yet");
        }
    }

    pub(super) fn door(&self) -> HallDoor {
        let Venue { name, cell_m, is_reckoned, robots, .. } = &self.venue;
        HallDoor::new(self.handle.clone(), self.reader.clone(), name)
            .with_cells_of(*cell_m)
            .with_robots(Arc::clone(robots))
            .with_settings(self.settings.core)
            .with_reckoning(*is_reckoned)
            .with_evacuation_of(self.settings.evacuation_m)
            .with_simulator(self.simulator.clone())
    }

    /// Halts the robots for good. A signal that ends the program is told to the core first, so that it gives no order
    /// after the halt.
    pub(super) fn halt(&self, signal: Option<&'static str>) {
        if signal.is_some() {
            self.course.send_modify(|course| course.ended_by = signal);
        }
        self.halter.halt();
    }

    /// Ends the core, when the doors have ended.
    pub(super) async fn ended(self) -> Result<(), JoinError> {
        self.course.send_modify(|course| course.is_over = true);
        self.task.await
    }
}

async fn start(
    id: Option<HallId>,
    settings: &HallSettings,
    mut robots: Robots,
    other: Option<Adapter>,
    mut kept: DataFolder,
    halter: &Halter,
    course: watch::Receiver<Course>,
    threads: &Threads,
) -> (Handle, JoinHandle<()>, Option<Arc<dyn Simulator>>) {
    let clock = Clock::default();
    let in_doubt = kept.stop_in_doubt();
    if let Some(stops) = kept.stops.take() {
        threads.core.handle().spawn(stops::follow(stops, halter.clone()));
    }
    let mut engine = engine(settings, kept.recalled.take(), halter.watch().now().epoch, &clock);
    if let Some(id) = id {
        engine.name_hall(id);
    }
    for words in in_doubt.iter().chain(&kept.notes) {
        tracing::warn!(words, "an operator should know");
        engine.note(words, clock.now());
    }
    for further in robots.ids().skip(1) {
        engine.add_robot(further.clone(), clock.now());
    }
    let ends = |robot: &RobotId| {
        let (link, side) = link(halter.watch());
        ((robot.clone(), link), side)
    };
    let (links, sides): (Vec<_>, Vec<_>) = robots.ids().map(ends).unzip();
    if kept.elsewhere && !elsewhere::put_down(&mut engine, &mut *kept.store, &links[0].1, halter, &clock).await {
        // The move was not recorded, so the robots must still be in the hall of the map at the next start.
        robots.keep_other_hall();
    }
    engine.note_venue(robots.venue(), clock.now());
    if let Some(truth) = robots.truth() {
        engine.begin_exercise(if kept.are_tests_known { truth } else { BTreeMap::new() }, clock.now());
    }
    let Adapters { all: mut adapters, mut simulator } = robots.adapters(clock);
    if let Some(other) = other {
        adapters[0] = other;
        simulator = None;
    }
    for (adapter, side) in adapters.into_iter().zip(sides) {
        threads.robot.handle().spawn(adapter(side));
    }
    let (handle, task) = Task::new(engine, links, kept.store, clock, halter.clone());
    let simulator = simulator.map(|parts| parts.in_hand_of(handle.clone()));
    (handle, threads.core.handle().spawn(task.run(course)), simulator)
}

fn engine(settings: &HallSettings, recalled: Option<Recalled>, epoch: Epoch, clock: &Clock) -> Engine {
    let now = clock.now();
    // Distinguishes the revisions of this run from the revisions of other runs. It consists of the start time and of
    // random bytes, because the clock may be set back.
    let [a, b, c, d, ..] = access::chance().unwrap_or_default();
    let run = format!("{:x}{:08x}", now.wall.unix_ms, u32::from_be_bytes([a, b, c, d])).into();
    let mut engine = match recalled {
        Some(recalled) => Engine::recall(settings.core, run, recalled, now),
        None => {
            let mut engine = Engine::new(settings.core, settings.strategy, run);
            engine.open_journal(now);
            engine
        }
    };
    // A stop that is missing in the journal takes effect now; a stop that the journal has changes nothing.
    engine.handle_halt(epoch, now);
    for sensor in &settings.sensors {
        engine.watch_sensor(Arc::clone(sensor), settings.sensor_silence, now);
    }
    engine
}
