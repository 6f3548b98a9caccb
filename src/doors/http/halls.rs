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
use super::{HallDoor, HttpDoor, Process};
use crate::access::Caller;
use crate::api::address::address;
use crate::api::halls::{HallJson, HallListJson};
use crate::doors::connection_limits::ConnectionBudget;
use hallsweep_core::hall::HallId;
use hallsweep_core::units::Epoch;

/// All halls of the process. Cheap to clone; all clones have the same halls.
#[derive(Clone)]
pub struct Halls {
    pub(super) process: Arc<Process>,
    default: Arc<HallDoor>,
    default_id: HallId,
    all: Arc<RwLock<BTreeMap<HallId, Arc<HallDoor>>>>,
}

impl Halls {
    /// Creates the table of halls. This door leads to the default hall.
    pub(super) fn of(default: HttpDoor, default_id: HallId) -> Halls {
        let all = Arc::new(RwLock::new(BTreeMap::from([(default_id.clone(), Arc::clone(&default.hall))])));
        Halls { process: default.process, default: default.hall, default_id, all }
    }

    pub fn add(&self, id: HallId, hall: HallDoor) {
        self.all.write().unwrap_or_else(PoisonError::into_inner).insert(id, Arc::new(hall));
    }

    pub(super) fn at(self, port: u16, budget: ConnectionBudget) -> Halls {
        Halls { process: Arc::new(self.process.at(port, budget)), ..self }
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
