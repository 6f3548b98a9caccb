//! The halls of the process, and which of them a request names. The same routes serve every hall:
//!
//! ```text
//!   /missions/4                          the default hall
//!   /halls/south/missions/4              the hall south
//!   /api/v1/commands/start               the default hall
//!   /api/v1/halls/south/commands/start   the hall south
//! ```
//!
//! `enter` takes the name out of the path before the routes see it. The gate decides whether the sender may know of the
//! hall, and only then looks the hall up.

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock};

use axum::Extension;
use axum::extract::{FromRequestParts, Request};
use axum::http::Uri;
use axum::http::request::Parts;
use axum::middleware::Next;
use axum::response::Response;

use super::hearing::Arrived;
use super::peer::LetIn;
use super::problem::Problem;
use super::{HttpDoor, Process, STREAMS, console, map_files, reports, sign_in};
use crate::access::{Access, Caller};
use crate::api::address::address;
use crate::api::halls::{HallJson, HallListJson};
use crate::doors::connection_limits::{ConnectionBudget, StreamQuota};
use crate::doors::http::mqtt::Hall;
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::handle::Handle;
use crate::runtime::simulator::Simulator;
use hallsweep_core::hall::HallId;
use hallsweep_core::settings::Settings;
use hallsweep_core::state::Participant;
use hallsweep_core::units::Epoch;

/// Default distance that people must keep from a bomb, in metres. The settings have the same default.
const EVACUATION_M: f64 = 100.0;

/// What this door needs of one hall.
pub struct HallDoor {
    /// Name of the hall in its addresses; `None` for the default hall.
    id: Option<HallId>,
    pub(super) handle: Handle,
    pub(super) archive: ArchiveReader,
    name: Arc<str>,
    pub(super) map_files: map_files::MapFiles,
    pub(super) reports: reports::Reports,
    /// Side length of a cell in metres, if it is known.
    cell_m: Option<f64>,
    /// Whether the positions on the map come from driving times alone, without measured distances.
    pub(super) is_reckoned: bool,
    /// Distance from a bomb that people must keep, in metres.
    pub(super) evacuation_m: f64,
    pub(super) robots: Arc<[Participant]>,
    pub(super) began: console::Began,
    pub(super) timelines: console::Timelines,
    /// Settings of the mission. They contain the temperature threshold.
    pub(super) settings: Settings,
    /// The simulator, if the searching robot is simulated.
    pub(super) simulator: Option<Arc<dyn Simulator>>,
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

    pub(super) fn id(&self) -> Option<&HallId> {
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
    pub(super) fn place(&self) -> (Arc<str>, Option<f64>) {
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

/// All halls of the process. Cheap to clone; all clones have the same halls.
#[derive(Clone)]
pub struct Halls {
    pub(super) process: Arc<Process>,
    default: Arc<HallDoor>,
    default_id: HallId,
    all: Arc<RwLock<BTreeMap<HallId, Arc<HallDoor>>>>,
}

impl Halls {
    pub fn new(default_id: HallId, default: HallDoor, access: Access, mqtt: Option<Hall>) -> Halls {
        Halls::of(HttpDoor { process: Arc::new(Process::new(access, mqtt)), hall: Arc::new(default) }, default_id)
    }

    /// Creates the table of halls. This door leads to the default hall.
    pub(super) fn of(default: HttpDoor, default_id: HallId) -> Halls {
        let all = Arc::new(RwLock::new(BTreeMap::from([(default_id.clone(), Arc::clone(&default.hall))])));
        Halls { process: default.process, default: default.hall, default_id, all }
    }

    pub fn add(&self, id: HallId, hall: HallDoor) {
        self.all.write().unwrap_or_else(PoisonError::into_inner).insert(id, Arc::new(hall));
    }

    /// Sets the port and the budget of the door. The port becomes part of the cookie's name. Browsers ignore ports, so
    /// several instances on one host would otherwise share a cookie.
    pub(super) fn at(self, port: u16, budget: ConnectionBudget) -> Halls {
        let mut process = Process::clone(&self.process);
        process.cookie = sign_in::cookie_name(port);
        process.streams = StreamQuota::new(budget.scaled(STREAMS));
        Halls { process: Arc::new(process), ..self }
    }

    /// Returns the door of the default hall.
    pub(super) fn default(&self) -> HttpDoor {
        self.door(&self.default)
    }

    /// Returns the door of the hall with this name, or of the default hall. Returns `None` in the same way if there is
    /// no such hall and if this caller must not know of it.
    pub(super) fn seen_by(&self, caller: &Caller, named: Option<&HallId>) -> Option<HttpDoor> {
        let id = Some(named.unwrap_or(&self.default_id)).filter(|id| caller.sees(id))?;
        let all = self.all.read().unwrap_or_else(PoisonError::into_inner);
        all.get(id).map(|hall| self.door(hall))
    }

    /// Returns the present epoch of a hall. An unknown hall has no epoch that a command could be too old for.
    pub(super) fn arrived(&self, hall: Option<HallId>) -> Arrived {
        let all = self.all.read().unwrap_or_else(PoisonError::into_inner);
        let named = all.get(hall.as_ref().unwrap_or(&self.default_id));
        let epoch = named.map_or(Epoch::default(), |hall| hall.handle.epoch());
        Arrived { hall, epoch }
    }

    /// Returns the halls that this caller may know of, sorted by name.
    fn all_seen_by(&self, caller: &Caller) -> Vec<(HallId, Arc<HallDoor>)> {
        let all = self.all.read().unwrap_or_else(PoisonError::into_inner);
        all.iter().filter(|(id, _)| caller.sees(id)).map(|(id, hall)| (id.clone(), Arc::clone(hall))).collect()
    }

    /// Returns the address of a hall for a caller who may not see the default hall.
    pub(super) fn first_seen_by(&self, caller: &Caller) -> Option<String> {
        self.all_seen_by(caller).first().map(|(_, hall)| address(hall.id(), "/"))
    }

    fn door(&self, hall: &Arc<HallDoor>) -> HttpDoor {
        HttpDoor { process: Arc::clone(&self.process), hall: Arc::clone(hall) }
    }

    /// Ends all open streams at once. A stream that is opened later also ends at once.
    pub fn close(&self) {
        self.process.closing.send_replace(true);
    }
}

/// The path of a request before the name of its hall was taken out, and that name.
#[derive(Clone)]
pub(super) struct Entered {
    pub(super) path: String,
    pub(super) hall: Option<HallId>,
}

/// Takes the name of a hall out of the path. `prefix::relative` leads the addresses in the answer back to the hall.
pub(super) async fn enter(mut request: Request, next: Next) -> Response {
    let path = request.uri().path().to_owned();
    let query = request.uri().query().map_or_else(String::new, |query| format!("?{query}"));
    let inner = named(&path).and_then(|(hall, within)| Some((hall, format!("{within}{query}").parse::<Uri>().ok()?)));
    let hall = inner.map(|(hall, uri)| {
        *request.uri_mut() = uri;
        hall
    });
    request.extensions_mut().insert(Entered { path, hall });
    next.run(request).await
}

/// Returns the name of the hall in a path, and the path within that hall.
fn named(path: &str) -> Option<(HallId, String)> {
    let of_a_page = path.strip_prefix("/halls/").map(|rest| ("", rest));
    let (above, rest) = of_a_page.or_else(|| path.strip_prefix("/api/v1/halls/").map(|rest| ("/api/v1", rest)))?;
    let (hall, within) = rest.split_once('/').unwrap_or((rest, ""));
    Some((HallId::new(hall)?, format!("{above}/{within}")))
}

/// Address of the list of halls. It is of no hall, so each key gets the halls that it sees.
pub(super) const LIST: &str = "/api/v1/halls";

/// `GET halls`: the halls that the caller may know of.
pub(super) async fn list(LetIn(caller): LetIn, Extension(halls): Extension<Halls>) -> axum::Json<HallListJson> {
    let hall = |(id, hall): (HallId, Arc<HallDoor>)| HallJson::new(&id, &hall.place().0, &hall.handle.snapshot());
    axum::Json(HallListJson { halls: halls.all_seen_by(&caller).into_iter().map(hall).collect() })
}

/// The door that the gate has stored.
impl<S: Send + Sync> FromRequestParts<S> for HttpDoor {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<HttpDoor, Problem> {
        parts.extensions.get().cloned().ok_or_else(Problem::internal)
    }
}
