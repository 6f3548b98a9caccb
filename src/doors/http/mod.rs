//! The HTTP door: JSON under `/api/v1`, the operator's console at `/`, and the routes of the old console. It converts
//! requests to commands, and snapshots to answers. It decides nothing about the mission.

mod accept;
mod assets;
mod command;
mod console;
mod etag;
mod events;
mod gate;
mod guard;
mod halls;
mod hearing;
mod laboratory;
mod language;
mod lines;
mod map_files;
mod metrics;
mod missions;
mod mqtt;
mod old;
mod openapi;
mod peer;
mod prefix;
mod problem;
mod query;
mod reading;
mod reads;
mod reports;
mod routes;
pub mod scanning;
mod serve;
mod sign_in;
mod simulator;
#[cfg(test)]
mod testing;
mod tls;
mod watcher;

use std::net::IpAddr;
use std::sync::Arc;

use axum::Router;
use axum::http::Request;
use tokio::sync::{Semaphore, watch};

pub use guard::Hosts;
pub use halls::Halls;
use lines::Lines;
pub use mqtt::{CarriedConnection, Hall, IncomingConnection};
pub use serve::{Front, serve};
pub use tls::{Tls, TlsError};

use crate::access::{Access, Attempts};
use crate::doors::connection_limits::{ConnectionBudget, StreamQuota};
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::clock::Clock;
use crate::runtime::handle::Handle;
use crate::runtime::simulator::Simulator;
use hallsweep_core::hall::HallId;
use hallsweep_core::settings::Settings;
use hallsweep_core::state::Participant;

/// Maximum number of open event streams, those of the console included. It is enough for every screen of a site, and
/// limits the cost that strangers can cause.
pub const STREAMS: usize = 256;

/// Default distance that people must keep from a bomb, in metres. The settings have the same default.
const EVACUATION_M: f64 = 100.0;

/// The door as one request uses it: what the process has, and the hall that the request names.
#[derive(Clone)]
struct HttpDoor {
    process: Arc<Process>,
    hall: Arc<HallDoor>,
}

/// What all halls share.
#[derive(Clone)]
struct Process {
    streams: StreamQuota,
    laboratory: laboratory::Laboratory,
    closing: watch::Sender<bool>,
    clock: Clock,
    access: Access,
    attempts: Arc<Attempts>,
    strangers: Arc<Lines>,
    cookie: Arc<str>,
    mqtt: Option<Hall>,
    /// Has one permit, so that uploaded halls are read one after the other (safety S7).
    uploads: Arc<Semaphore>,
}

impl Process {
    fn new(access: Access, mqtt: Option<Hall>) -> Process {
        Process {
            streams: StreamQuota::new(STREAMS),
            laboratory: laboratory::Laboratory::default(),
            closing: watch::Sender::new(false),
            clock: Clock::default(),
            access,
            attempts: Arc::default(),
            strangers: Arc::default(),
            cookie: sign_in::cookie_name(0),
            mqtt,
            uploads: Arc::new(Semaphore::new(1)),
        }
    }

    /// Sets the port and the budget of the door. The port becomes part of the cookie's name. Browsers ignore ports, so
    /// several instances on one host would otherwise share a cookie.
    fn at(&self, port: u16, budget: ConnectionBudget) -> Process {
        let streams = StreamQuota::new(budget.scaled(STREAMS));
        Process { cookie: sign_in::cookie_name(port), streams, ..self.clone() }
    }
}

/// What this door needs of one hall.
pub struct HallDoor {
    /// Name of the hall in its addresses; `None` for the default hall.
    id: Option<HallId>,
    handle: Handle,
    archive: ArchiveReader,
    name: Arc<str>,
    map_files: map_files::MapFiles,
    reports: reports::Reports,
    /// Side length of a cell in metres, if it is known.
    cell_m: Option<f64>,
    /// Whether the positions on the map come from driving times alone, without measured distances.
    is_reckoned: bool,
    /// Distance from a bomb that people must keep, in metres.
    evacuation_m: f64,
    robots: Arc<[Participant]>,
    began: console::Began,
    timelines: console::Timelines,
    /// Settings of the mission. They contain the temperature threshold.
    settings: Settings,
    /// The simulator, if the searching robot is simulated.
    simulator: Option<Arc<dyn Simulator>>,
}

impl HallDoor {
    /// Creates the door of a hall. `name` is the name of the hall on the page, unless a simulator reports another name.
    pub fn new(handle: Handle, archive: ArchiveReader, name: &str) -> HallDoor {
        HallDoor {
            id: handle.snapshot().hall.clone(),
            handle,
            archive,
            name: Arc::from(name),
            map_files: map_files::MapFiles::default(),
            reports: reports::Reports::default(),
            cell_m: None,
            is_reckoned: false,
            evacuation_m: EVACUATION_M,
            robots: Arc::default(),
            began: console::Began::default(),
            timelines: console::Timelines::default(),
            settings: Settings::default(),
            simulator: None,
        }
    }

    fn id(&self) -> Option<&HallId> {
        self.id.as_ref()
    }

    pub fn with_simulator(self, simulator: Option<Arc<dyn Simulator>>) -> HallDoor {
        HallDoor { simulator, ..self }
    }

    /// Sets the side length of the hall's cells in metres, if it is known.
    pub fn with_cells_of(self, cell_m: Option<f64>) -> HallDoor {
        HallDoor { cell_m, ..self }
    }

    /// Sets whether the robot knows its position from driving times alone.
    pub fn with_reckoning(self, is_reckoned: bool) -> HallDoor {
        HallDoor { is_reckoned, ..self }
    }

    /// Sets the distance that people must keep from a bomb, in metres.
    pub fn with_evacuation_of(self, evacuation_m: f64) -> HallDoor {
        HallDoor { evacuation_m, ..self }
    }

    /// Sets the robots. The searching robot is the first one.
    pub fn with_robots(self, robots: Arc<[Participant]>) -> HallDoor {
        HallDoor { robots, ..self }
    }

    pub fn with_settings(self, settings: Settings) -> HallDoor {
        HallDoor { settings, ..self }
    }

    /// Returns the name of the hall, and the side length of its cells in metres if it is known.
    fn place(&self) -> (Arc<str>, Option<f64>) {
        match &self.simulator {
            Some(simulator) => {
                let state = simulator.watch();
                let hall = &state.borrow().hall;
                (Arc::clone(&hall.name), Some(hall.cell_m))
            }
            None => (Arc::clone(&self.name), self.cell_m),
        }
    }
}

impl Halls {
    /// Creates the table with the default hall alone.
    pub fn new(default_id: HallId, default: HallDoor, access: Access, mqtt: Option<Hall>) -> Halls {
        Halls::of(HttpDoor { process: Arc::new(Process::new(access, mqtt)), hall: Arc::new(default) }, default_id)
    }
}

/// Stores in a request the address that it comes from, and whether it was encrypted. For tests that call the router
/// directly. In the program, `hearing::connection_task` does this.
pub fn coming_from<B>(mut request: Request<B>, address: IpAddr, is_encrypted: bool) -> Request<B> {
    request.extensions_mut().insert(peer::Peer { address, is_encrypted });
    request
}

/// Returns all routes behind the guard, for all halls. Every request must contain its `Peer`, as `coming_from` stores
/// it.
pub fn router(halls: &Halls, hosts: Hosts) -> Router {
    routes::entered(guard::guarded(routes::routes(halls), hosts, halls))
}
