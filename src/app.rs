//! The only file that names every adapter: opens the hall, binds the port, joins core, robot, store and door, and ends them
//! in order. What each of them does is not here, and which threads there are stands in `threads`.
//!
//! ```text
//!   signal ─► halt ─► the doors drain their requests ─► the loop ends ─► the robot's task ends with its channel
//! ```

use std::future::Future;
use std::net::TcpListener;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;
use tokio::task::JoinHandle;

use crate::access;
use crate::config::{self, Settings};
use crate::doors::coap::Resources;
use crate::doors::http::{self, Door};
use crate::doors::listeners::Listeners;
use crate::doors::room::Room;
use crate::robots::sim;
use crate::runtime::archive_reader::Reader;
use crate::runtime::clock::Clock;
use crate::runtime::halt::Halter;
use crate::runtime::handle::Handle;
use crate::runtime::link::{RobotSide, link};
use crate::runtime::task::{Course, Task};
use crate::runtime::threads::Thread;
use crate::storage::stops;
use hallsweep_core::engine::{Engine, Recalled};
use hallsweep_core::event::RobotId;
use hallsweep_core::mission::Hold;
use hallsweep_core::units::Epoch;
use hallsweep_sim::{Camera, Hall, SimSettings, Speed};

mod coap;
mod descriptors;
mod elsewhere;
mod entry;
mod error;
mod kept;
mod mqtt;
mod ports;
mod signals;
mod threads;

pub use entry::Entry;
use entry::Opened;
pub use error::AppError;
use kept::Kept;
use mqtt::Mqtt;
use ports::Ports;
pub use ports::{Doors, Place, Port};
use threads::Threads;

/// What is still busy this long after everything has ended (a photo being drawn) is left behind.
const LEFT_BEHIND: Duration = Duration::from_millis(200);

/// So long the robot is waited for before requests are answered.
const FIRST_LINK: Duration = Duration::from_secs(2);

/// What stands between the program and a robot: it takes the adapter's end of the link, and runs until the loop's end is gone.
pub type Adapter = Box<dyn FnOnce(RobotSide) -> Pin<Box<dyn Future<Output = ()> + Send>> + Send>;

/// Serves until SIGINT or SIGTERM. `announce` is told where, with the real ports, and how one gets in, as soon as requests are
/// answered.
///
/// # Errors
/// A hall or keys that cannot be read, a port that cannot be had, a system that refuses, or a loop that ended by itself.
pub fn serve(settings: &Settings, announce: impl FnOnce(Doors, &Entry)) -> Result<(), AppError> {
    serve_with(settings, None, announce)
}

/// The same with another robot than the simulated one: what is measured at a robot's port is measured behind the real doors.
///
/// # Errors
/// As for `serve`.
pub fn serve_robot(settings: &Settings, robot: Adapter, announce: impl FnOnce(Doors, &Entry)) -> Result<(), AppError> {
    serve_with(settings, Some(robot), announce)
}

fn serve_with(settings: &Settings, robot: Option<Adapter>, announce: impl FnOnce(Doors, &Entry)) -> Result<(), AppError> {
    let simulation = simulation(settings, Camera::Rendered)?;
    let runtime = threads::ordinary().map_err(AppError::System)?;
    let served = runtime.block_on(serve_hall(settings, simulation, robot, announce));
    runtime.shutdown_timeout(LEFT_BEHIND);
    served
}

/// The hall of the settings and the robot that lives in it.
///
/// # Errors
/// `AppError::Hall`: the setting that names the hall, and file and line of what is wrong with it.
pub fn simulation(settings: &Settings, camera: Camera) -> Result<(Arc<Hall>, SimSettings), AppError> {
    let (name, origin) = (settings.hall.clone(), settings.hall_origin.clone());
    let hall = Hall::named_or_file(&settings.hall).map_err(|error| AppError::Hall { name, origin, error })?;
    let robot = &settings.robot;
    let sim = SimSettings {
        unknown_rate: robot.unknown_rate,
        photo_failure_rate: robot.photo_failure_rate,
        sonar_noise_cm: robot.sonar_noise_cm,
        ..SimSettings::new(robot.seed, camera)
    };
    Ok((Arc::new(hall), sim))
}

async fn serve_hall(
    settings: &Settings,
    (hall, sim): (Arc<Hall>, SimSettings),
    robot: Option<Adapter>,
    announce: impl FnOnce(Doors, &Entry),
) -> Result<(), AppError> {
    let mut front = entry::front(&settings.http)?;
    let threads = Threads::start()?;
    let descriptors = descriptors::raise();
    let room = Room::of(descriptors);
    front.room = room;
    let Ports { http, coap, mqtt, doors } = Ports::bind(settings)?;
    let signalled = signals::listen().map_err(AppError::System)?;
    let secret = access::chance()?;

    let kept = Kept::open(settings, &hall, entry::unusable(settings))?;
    // Only now, when nothing else can refuse the start: a key that is made is also shown.
    let Opened { http: access, mqtt: mqtt_access, entry } = entry::access(settings)?;
    let halter = Halter::new(kept.epoch());
    let reader = Reader::new(Arc::clone(&kept.archive));
    let (course, coursed) = watch::channel(Course::default());
    let (handle, mut task) = start(settings, (Arc::clone(&hall), sim, robot), kept, (&halter, coursed), &threads).await;
    find_robot(&handle).await;
    let ending = watch::Sender::new(false);
    let resources = || Resources::new(handle.clone(), reader.clone(), settings.old_clients.manual_driving);
    let coap = coap::open(coap, &threads.coap, resources, (secret, handle.watch(), ending.subscribe()))?;
    let mqtt_ports = listeners(mqtt, &threads.mqtt)?;
    let mqtt_at = doors.mqtt.map(|place| place.at);
    let mqtt_ways = (mqtt_ports, mqtt_at, mqtt_access, (&threads, room));
    let mqtt = Mqtt::open(settings, mqtt_ways, handle.clone(), reader.clone(), ending.subscribe()).await?;
    let http = listeners(http, &threads.http)?;
    let door = Door::new(handle, reader, hall.name(), access).with_cells_of(hall.cell_m());
    let door = door.with_mqtt(mqtt.as_ref().and_then(Mqtt::hall));
    announce(doors, &entry);
    let [coap_at, mqtt_at] = [doors.coap, doors.mqtt].map(|place| place.map(|place| tracing::field::display(place.at)));
    tracing::info!(http = %doors.http.at, coap = coap_at, mqtt = mqtt_at, hall = hall.name(), descriptors, "serving");

    let mut ended = None;
    let shutdown = async {
        tokio::select! {
            signal = signalled => {
                tracing::info!(signal, "ending");
                // The core first, so that it gives no order after the halt.
                course.send_modify(|course| course.ended_by = Some(signal));
            }
            end = &mut task => ended = Some(end),
        }
        halter.halt();
        ending.send_replace(true);
    };
    http::serve(http, door, front, shutdown).await;
    for coap in coap {
        // Its end is bounded; how it ended was said already.
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

/// Ports that are waited for on this thread.
fn listeners(bound: Vec<TcpListener>, thread: &Thread) -> Result<Listeners, AppError> {
    let _on_it = thread.handle().enter();
    Listeners::new(bound).map_err(AppError::System)
}

/// Waits until the robot is linked, so that whoever reads where to find the program can press START at once. One that cannot be
/// reached is no reason not to serve.
async fn find_robot(handle: &Handle) {
    let mut states = handle.watch();
    let linked = states.wait_for(|state| !state.mission.holds.contains(&Hold::RobotLink));
    if tokio::time::timeout(FIRST_LINK, linked).await.is_err() {
        tracing::warn!("the robot has not been reached yet");
    }
}

/// Starts the robot and the loop.
async fn start(
    settings: &Settings,
    (hall, sim, other): (Arc<Hall>, SimSettings, Option<Adapter>),
    mut kept: Kept,
    (halter, course): (&Halter, watch::Receiver<Course>),
    threads: &Threads,
) -> (Handle, JoinHandle<()>) {
    let clock = Clock::default();
    let in_doubt = kept.stop_in_doubt();
    if let Some(stops) = kept.stops.take() {
        threads.core.handle().spawn(stops::follow(stops, halter.clone()));
    }
    let mut engine = engine(settings, kept.recalled.take(), halter.watch().now().epoch, &clock);
    if let Some(words) = &in_doubt {
        tracing::warn!(words, "the robot is held");
        engine.note_damage(words, clock.now());
    }
    let (link, side) = link(halter.watch());
    let (robot, mut diary) = match kept.robot(hall, sim) {
        Ok((robot, diary)) => (Some(robot), diary),
        Err(lost) => {
            tracing::error!(lost, "nobody knows where the simulated robot was left: it is not started");
            (None, None)
        }
    };
    if kept.elsewhere && !elsewhere::put_down(&mut engine, &mut *kept.store, &link, halter, &clock).await {
        // The old one stays, so that robot and map are in the same hall at the next start as well.
        diary = None;
    }
    let on = threads.robot.handle();
    match (other, robot) {
        (Some(adapter), _) => drop(on.spawn(adapter(side))),
        (None, Some(robot)) => drop(on.spawn(sim::run(robot, side, clock, speed(settings.robot.speed), diary))),
        // The link stays down, and nobody is told that its adapter has ended.
        (None, None) => drop(on.spawn(async move { side.reports.closed().await })),
    }
    let (handle, task) = Task::new(engine, [(RobotId::discovery(), link)], kept.store, clock, halter.clone());
    (handle, threads.core.handle().spawn(task.run(course)))
}

/// The core as it was, or as it is at the very first start.
fn engine(settings: &Settings, recalled: Option<Recalled>, epoch: Epoch, clock: &Clock) -> Engine {
    let (run, now) = (run_id(clock), clock.now());
    let mut engine = match recalled {
        Some(recalled) => Engine::recall(settings.core, run, recalled, now),
        None => {
            let mut engine = Engine::new(settings.core, settings.strategy, run);
            engine.open_journal(now);
            engine
        }
    };
    // A stop that the record does not know of is heard now; one that it knows of changes nothing.
    engine.handle_halt(epoch, now);
    for sensor in &settings.sensors {
        engine.watch_sensor(Arc::clone(sensor), settings.sensor_silence, now);
    }
    engine
}

/// Tells this run's revisions from those of any other: the millisecond in which it began.
fn run_id(clock: &Clock) -> Arc<str> {
    format!("{:x}", clock.now().wall.unix_ms).into()
}

const fn speed(speed: config::Speed) -> Speed {
    match speed {
        config::Speed::Times(factor) => Speed::Times(factor),
        config::Speed::Max => Speed::Max,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_speed_that_can_be_set_is_one_the_simulator_knows() {
        assert_eq!((config::Speed::SLOWEST, config::Speed::FASTEST), (Speed::SLOWEST, Speed::FASTEST));
    }
}
