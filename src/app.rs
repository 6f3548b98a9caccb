//! The only file that names every door (HTTP, CoAP, MQTT). It binds the ports, joins the core, the robots, the
//! store and the doors, and ends them in order. The parts are in their own folders; `robots` decides which robots
//! exist, and `threads` decides which threads exist.
//!
//! ```text
//!   signal ─► halt ─► the doors drain their requests ─► the loop ends ─► each robot's task ends with its channel
//! ```

use std::collections::BTreeMap;
use std::net::TcpListener;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;
use tokio::task::JoinHandle;

use crate::access;
use crate::config::{HallSettings, Settings};
use crate::doors::coap::Resources;
use crate::doors::connection_limits::ConnectionBudget;
use crate::doors::http::{self, HttpDoor};
use crate::doors::listeners::Listeners;
pub use crate::robots::Adapter;
use crate::robots::{Adapters, Robots};
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::clock::Clock;
use crate::runtime::halt::Halter;
use crate::runtime::handle::Handle;
use crate::runtime::link::link;
use crate::runtime::simulator::Simulator;
use crate::runtime::task::{Course, Task};
use crate::runtime::threads::Thread;
use crate::storage::stops;
use hallsweep_core::engine::{Engine, Recalled};
use hallsweep_core::hold::Hold;
use hallsweep_core::robot::RobotId;
use hallsweep_core::state::Venue;
use hallsweep_core::units::Epoch;

mod coap;
mod data_folder;
mod elsewhere;
mod emulator;
mod entry;
mod error;
mod exercise;
mod mqtt;
mod ports;
mod signals;
mod threads;

use data_folder::DataFolder;
pub use emulator::emulate;
pub use entry::FirstAccess;
use entry::Opened;
pub use error::{AppError, Port};
use mqtt::Mqtt;
use ports::Ports;
pub use ports::{BoundPort, Doors, raise_descriptors};
use threads::Threads;

/// Time after which unfinished work, such as drawing a photo, is abandoned at the end of the program.
const LEFT_BEHIND: Duration = Duration::from_millis(200);

/// Maximum wait for the link to the robot before requests are answered.
const FIRST_LINK: Duration = Duration::from_secs(2);

/// Serves until SIGINT, SIGTERM or SIGHUP. As soon as requests are answered, calls `announce` with the ports in
/// use and the way to sign in.
pub fn serve(settings: &Settings, announce: impl FnOnce(Doors, &FirstAccess)) -> Result<(), AppError> {
    serve_with(settings, None, announce)
}

/// Like `serve`, but `robot` replaces the searching robot of the settings. So a benchmark can measure when orders
/// reach the robot, while its requests use the real doors.
pub fn serve_robot(settings: &Settings, robot: Adapter, announce: impl FnOnce(Doors, &FirstAccess)) -> Result<(), AppError> {
    serve_with(settings, Some(robot), announce)
}

fn serve_with(settings: &Settings, robot: Option<Adapter>, announce: impl FnOnce(Doors, &FirstAccess)) -> Result<(), AppError> {
    let settings = &Settings { hall: exercise::settled(&settings.hall)?, ..settings.clone() };
    let robots = Robots::of(&settings.hall)?;
    let notes = data_folder::write_out_old(&settings.hall).into_iter().chain(mqtt::note(settings)).collect();
    let runtime = threads::ordinary().map_err(AppError::System)?;
    let served = runtime.block_on(serve_hall(settings, robots, robot, notes, announce));
    runtime.shutdown_timeout(LEFT_BEHIND);
    served
}

async fn serve_hall(
    settings: &Settings,
    mut robots: Robots,
    robot: Option<Adapter>,
    notes: Vec<String>,
    announce: impl FnOnce(Doors, &FirstAccess),
) -> Result<(), AppError> {
    let mut front = entry::front(&settings.http)?;
    let threads = Threads::start()?;
    let descriptors = raise_descriptors(ports::DESCRIPTORS);
    let budget = ConnectionBudget::of(descriptors);
    front.budget = budget;
    let Ports { http, coap, mqtt, doors } = Ports::bind(settings)?;
    let signalled = signals::listen().map_err(AppError::System)?;
    let secret = access::chance()?;

    let mut kept = DataFolder::open(&settings.hall, &mut robots, entry::unusable(settings), notes)?;
    kept.are_tests_known = exercise::check(&settings.hall, &kept)?;
    // The keys are opened last, when nothing else can prevent the start. So a key that is created is also shown to
    // the user.
    let opened = entry::access(settings)?;
    entry::check_judges(settings, &opened)?;
    let Opened { http: access, mqtt: mqtt_access, entry } = opened;
    let halter = Halter::new(kept.epoch());
    let reader = ArchiveReader::new(Arc::clone(&kept.archive));
    let Venue { name: hall, cell_m, is_reckoned, robots: team, .. } = robots.venue();
    let (course, coursed) = watch::channel(Course::default());
    let (handle, mut task, simulator) = start(&settings.hall, robots, robot, kept, &halter, coursed, &threads).await;
    find_robot(&handle).await;
    let ending = watch::Sender::new(false);
    let resources = || Resources::new(handle.clone(), reader.clone(), settings.old_clients.manual_driving);
    let coap = coap::open(coap, &threads.coap, resources, secret, handle.watch(), ending.subscribe())?;
    let mqtt_ports = listeners(mqtt, &threads.mqtt)?;
    let mqtt =
        Mqtt::open(settings, mqtt_ports, mqtt_access, &threads, budget, handle.clone(), reader.clone(), ending.subscribe())?;
    let http = listeners(http, &threads.http)?;
    let door =
        HttpDoor::new(handle, reader, &hall, access).with_cells_of(cell_m).with_robots(team).with_settings(settings.hall.core);
    let door = door.with_reckoning(is_reckoned).with_evacuation_of(settings.hall.evacuation_m);
    let door = door.with_simulator(simulator);
    let door = door.with_mqtt(mqtt.as_ref().and_then(Mqtt::hall));
    announce(doors, &entry);
    let [coap_at, mqtt_at] = [doors.coap, doors.mqtt].map(|place| place.map(|place| tracing::field::display(place.at)));
    tracing::info!(http = %doors.http.at, coap = coap_at, mqtt = mqtt_at, hall = &*hall, descriptors, "serving");

    let mut ended = None;
    let shutdown = async {
        tokio::select! {
            signal = signalled => {
                tracing::info!(signal, "ending");
                // The core is told first, so that it gives no order after the halt.
                course.send_modify(|course| course.ended_by = Some(signal));
            }
            end = &mut task => ended = Some(end),
        }
        halter.halt();
        ending.send_replace(true);
    };
    http::serve(http, door, front, shutdown).await;
    for coap in coap {
        // The CoAP door ends within bounded time, and logs a failure itself.
        let _ = coap.await;
    }
    if let Some(mqtt) = mqtt {
        mqtt.ended().await;
    }
    let by_itself = ended.is_some();
    course.send_modify(|course| course.is_over = true);
    let end = match ended {
        Some(end) => end,
        None => task.await,
    };
    if by_itself || end.is_err() { Err(AppError::LoopEnded) } else { Ok(()) }
}

fn listeners(bound: Vec<TcpListener>, thread: &Thread) -> Result<Listeners, AppError> {
    let _on_it = thread.handle().enter();
    Listeners::new(bound).map_err(AppError::System)
}

/// Waits for the link to the robot, so that START works as soon as the address is printed. If the robot cannot be
/// reached, the program starts without it.
async fn find_robot(handle: &Handle) {
    let mut states = handle.watch();
    let linked = states.wait_for(|state| !state.mission.holds.contains(&Hold::RobotLink));
    if tokio::time::timeout(FIRST_LINK, linked).await.is_err() {
        tracing::warn!("the robot has not been reached yet");
    }
}

/// Starts the core and the robots. `other` replaces the searching robot of the settings.
async fn start(
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
