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
use axum::middleware::from_fn;
use tokio::sync::{Semaphore, watch};

pub use guard::Hosts;
pub use halls::{HallDoor, Halls};
use lines::Lines;
pub use mqtt::{CarriedConnection, Hall, IncomingConnection};
pub use serve::{Front, serve};
pub use tls::{Tls, TlsError};

use crate::access::{Access, Attempts};
use crate::doors::connection_limits::StreamQuota;
use crate::runtime::clock::Clock;

/// Maximum number of open event streams, those of the console included. It is enough for every screen of a site, and
/// limits the cost that strangers can cause.
pub const STREAMS: usize = 256;

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
    let routes = guard::guarded(routes::routes(halls), hosts, halls);
    // A layer of a router runs after the route is found, and the layer here decides which path is looked for.
    Router::new().fallback_service(routes).layer(from_fn(halls::enter))
}
