//! The only file that names every door (HTTP, CoAP, MQTT). It binds the ports, joins the core, the robots, the
//! store and the doors, and ends them in order. The parts are in their own folders; `robots` decides which robots
//! exist, and `threads` decides which threads exist.
//!
//! ```text
//!   signal ─► halt ─► the doors drain their requests ─► the loop ends ─► each robot's task ends with its channel
//! ```

use std::net::TcpListener;
use std::time::Duration;

use tokio::sync::{mpsc, watch};

use crate::access;
use crate::config::Settings;
use crate::doors::coap::Resources;
use crate::doors::connection_limits::ConnectionBudget;
use crate::doors::http;
use crate::doors::listeners::Listeners;
pub use crate::robots::Adapter;
use crate::runtime::threads::Thread;

mod coap;
mod data_folder;
mod elsewhere;
mod emulator;
mod entry;
mod error;
mod exercise;
mod hall;
mod mqtt;
mod ports;
mod signals;
mod threads;

pub use emulator::emulate;
pub use entry::FirstAccess;
use entry::Opened;
pub use error::{AppError, Port};
use hall::{Hall, OpenHall, PreparedHall};
use mqtt::{Mqtt, MqttHall};
use ports::Ports;
pub use ports::{BoundPort, Doors, raise_descriptors};
use threads::Threads;

/// Maximum wait for the links to the robots before requests are answered.
const FIRST_LINK: Duration = Duration::from_secs(2);

/// Time after which unfinished work, such as drawing a photo, is abandoned at the end of the program.
const LEFT_BEHIND: Duration = Duration::from_millis(200);

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
    let default = PreparedHall::new(&settings.hall, mqtt::note(settings));
    let further = settings.further_halls.iter().map(|hall| PreparedHall::new(hall, None));
    let halls = std::iter::once(default).chain(further).collect::<Result<_, _>>()?;
    let runtime = threads::ordinary().map_err(AppError::System)?;
    let served = runtime.block_on(serve_halls(settings, halls, robot, announce));
    runtime.shutdown_timeout(LEFT_BEHIND);
    served
}

async fn serve_halls(
    settings: &Settings,
    halls: Vec<PreparedHall>,
    mut robot: Option<Adapter>,
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

    let unusable = entry::unusable(settings);
    let opened = halls.into_iter().map(|hall| hall.open(unusable.clone())).collect::<Result<Vec<OpenHall>, _>>()?;
    // The keys are opened last, when nothing else can prevent the start. So a key that is created is also shown to
    // the user.
    let access = entry::access(settings)?;
    settings.halls().try_for_each(|hall| entry::check_judges(settings, &hall.name, hall.core.rules.safe_by, &access))?;
    let Opened { http: access, mqtt: mqtt_access, entry } = access;
    let mut halls = Vec::new();
    for (of, hall) in settings.halls().zip(opened) {
        let id = (!halls.is_empty()).then(|| of.name.clone());
        halls.push(hall.start(id, robot.take(), &threads).await);
    }
    find_robots(&halls).await;

    let hall = &halls[0];
    let ending = watch::Sender::new(false);
    let resources = || Resources::new(hall.handle.clone(), hall.reader.clone(), settings.old_clients.manual_driving);
    let coap = coap::open(coap, &threads.coap, resources, secret, hall.handle.watch(), ending.subscribe())?;
    let mqtt_ports = listeners(mqtt, &threads.mqtt)?;
    let mut mqtt_halls = settings.halls().zip(&halls).map(|(of, hall)| MqttHall {
        name: of.name.clone(),
        handle: hall.handle.clone(),
        archive: hall.reader.clone(),
        safe_by: of.core.rules.safe_by,
    });
    let default = mqtt_halls.next().expect("the default hall is first");
    let further = mqtt_halls.collect();
    let mqtt = Mqtt::open(settings, mqtt_ports, mqtt_access, &threads, budget, default, further, ending.subscribe())?;
    let http = listeners(http, &threads.http)?;
    let http_halls = http::Halls::new(settings.hall.name.clone(), hall.door(), access, mqtt.as_ref().and_then(Mqtt::hall));
    for (of, hall) in settings.halls().zip(&halls).skip(1) {
        http_halls.add(of.name.clone(), hall.door());
    }
    announce(doors, &entry);
    let [coap_at, mqtt_at] = [doors.coap, doors.mqtt].map(|place| place.map(|place| tracing::field::display(place.at)));
    tracing::info!(http = %doors.http.at, coap = coap_at, mqtt = mqtt_at, halls = halls.len(), descriptors, "serving");

    let mut signal = None;
    let shutdown = async {
        let mut loop_ended = loop_ended(&halls);
        tokio::select! {
            name = signalled => {
                tracing::info!(signal = name, "ending");
                signal = Some(name);
            }
            _ = loop_ended.recv() => {}
        }
        halls.iter().for_each(|hall| hall.halt(signal));
        ending.send_replace(true);
    };
    http::serve(http, http_halls, front, shutdown).await;
    for coap in coap {
        // The CoAP door ends within bounded time, and logs a failure itself.
        let _ = coap.await;
    }
    if let Some(mqtt) = mqtt {
        mqtt.ended().await;
    }
    let mut is_in_order = signal.is_some();
    for hall in halls {
        is_in_order &= hall.ended().await.is_ok();
    }
    if is_in_order { Ok(()) } else { Err(AppError::LoopEnded) }
}

/// Waits for the links to the robots, so that START works as soon as the address is printed. If a robot cannot be
/// reached, its hall starts without it.
async fn find_robots(halls: &[Hall]) {
    let linked = async {
        for hall in halls {
            hall.linked().await;
        }
    };
    if tokio::time::timeout(FIRST_LINK, linked).await.is_err() {
        halls.iter().for_each(Hall::warn_of_missing_robot);
    }
}

/// Returns a channel that gets a value when the loop of a hall has ended by itself, which only a mistake in hallsweep
/// causes. The program ends then, so that its next start continues with what is on record.
fn loop_ended(halls: &[Hall]) -> mpsc::Receiver<()> {
    let (tell, told) = mpsc::channel(1);
    for hall in halls {
        let (handle, tell) = (hall.handle.clone(), tell.clone());
        tokio::spawn(async move {
            handle.ended().await;
            // The first value is enough.
            let _ = tell.try_send(());
        });
    }
    told
}

fn listeners(bound: Vec<TcpListener>, thread: &Thread) -> Result<Listeners, AppError> {
    let _on_it = thread.handle().enter();
    Listeners::new(bound).map_err(AppError::System)
}
