//! For tests of this door. It has a loop that answers commands as the test says, and publishes the snapshots of the
//! test. It also has a client that calls the router without a socket. There is no real mission.

mod bilingual;
mod past;

use std::net::Ipv4Addr;
use std::sync::{Arc, Mutex};

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::http::{Request, Response, StatusCode};
use serde_json::Value;
use tokio::sync::watch;
use tower_service::Service;

use super::peer::Peer;
use super::prefix::root;
use super::{HallDoor, Halls, Hosts, HttpDoor, router};
use crate::access::{Access, Keyring, Keys, OPERATOR, Role};
use crate::api::tests::fixture::exported;
use crate::runtime::archive::{At, Happened, MissionRecord, NoTake, PastMoment, Sound, Unreadable};
use crate::runtime::archive_reader::ArchiveReader;
pub(super) use crate::runtime::tests::obedient::Noted;
use crate::runtime::tests::obedient::{Script, obedient};
use crate::runtime::tests::partial_archive::PartialArchive;
use crate::runtime::tests::within::within;
use hallsweep_core::command;
use hallsweep_core::event::Photo;
use hallsweep_core::hall::HallId;
use hallsweep_core::refused::Refused;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{LuggageId, MissionId, Seq};

pub(super) struct TestApp {
    pub(super) door: HttpDoor,
    pub(super) publish: watch::Sender<Arc<Snapshot>>,
    pub(super) refuse: Arc<Mutex<Option<Refused>>>,
    pub(super) given: Arc<Mutex<Vec<command::Request>>>,
    pub(super) noted: Arc<Mutex<Vec<Noted>>>,
}

struct Pictures;

impl PartialArchive for Pictures {
    fn photo(&self, _: LuggageId) -> Result<Option<Photo>, Unreadable> {
        Ok(Some(Photo { bytes: Arc::from(*b"\x89PNG"), media_type: "image/png" }))
    }

    /// Returns a photo. From the second photo on, the bytes of a photo contain its number.
    fn take(&self, luggage: LuggageId, take: u32) -> Result<Option<Photo>, NoTake> {
        if take > 1 {
            Ok(Some(Photo { bytes: Arc::from(take.to_string().as_bytes()), media_type: "image/png" }))
        } else {
            Ok(self.photo(luggage)?)
        }
    }

    fn missions(&self) -> Vec<MissionRecord> {
        past::missions().into()
    }

    fn mission(&self, mission: MissionId) -> Result<Option<MissionRecord>, Unreadable> {
        if mission == past::UNREADABLE {
            return Err(Unreadable("the disk is on strike".to_owned()));
        }
        Ok(past::missions().into_iter().find(|record| record.id == mission))
    }

    fn state(&self, mission: MissionId) -> Option<Sound<PersistentState>> {
        (mission == MissionId(1)).then(past::state).map(|of| Sound { of, damage: vec![past::DAMAGE.to_owned()] })
    }

    fn moments(&self, mission: MissionId, at: &[At]) -> Vec<PastMoment> {
        let moments: Option<Vec<PastMoment>> = at.iter().map(|at| past::moment(*at)).collect();
        moments.filter(|_| mission == MissionId(1)).unwrap_or_default()
    }

    fn entries(&self, mission: MissionId) -> Vec<Happened> {
        if mission == MissionId(1) { past::entries() } else { Vec::new() }
    }

    fn lines(&self, mission: MissionId, happened: Vec<Happened>) -> Vec<(Seq, String)> {
        exported(mission, happened)
    }

    fn is_on_timeline(&self, (_, entry): &Happened) -> bool {
        entry.as_ref().map_or(true, |entry| !matches!(entry.fact, Fact::Pose(_)))
    }

    fn retrieval(&self, mission: MissionId) -> Vec<Happened> {
        if mission == MissionId(1) { past::retrieval() } else { Vec::new() }
    }
}

pub(super) fn present_mission() -> MissionRecord {
    let [present, _] = past::missions();
    present
}

/// Creates an app in this state, with a door that requires no keys. Its loop accepts every command until the test
/// makes it refuse. Must be called inside a tokio runtime.
pub(super) fn app(snapshot: Snapshot) -> TestApp {
    guarded_app(snapshot, Access::Open)
}

pub(super) fn guarded_app(snapshot: Snapshot, access: Access) -> TestApp {
    let (handle, Script { publish, refuse, given, noted }) = obedient(snapshot);
    let hall = HallDoor::new(handle, ArchiveReader::new(Arc::new(Pictures)), "airport");
    let door = Halls::new(main_hall(), hall, access, None).default();
    TestApp { door, publish, refuse, given, noted }
}

pub(super) struct Tokens {
    pub(super) operator: String,
    pub(super) viewer: String,
}

/// Returns keys for an operator and for a viewer named `lobby`.
pub(super) fn keys() -> (Keyring, Tokens) {
    let mut keys = Keys::first().unwrap();
    let viewer = keys.add("lobby", Role::Viewer, None).unwrap().token.reveal().to_owned();
    let operator = keys.named(OPERATOR).unwrap().token.reveal().to_owned();
    (Keyring::of(keys).unwrap(), Tokens { operator, viewer })
}

/// Name of the default hall.
fn main_hall() -> HallId {
    HallId::new("main").expect("a plain name")
}

impl TestApp {
    pub(super) fn halls(&self) -> Halls {
        Halls::of(self.door.clone(), main_hall())
    }

    /// Fails if the door was cloned before.
    pub(super) fn hall_mut(&mut self) -> &mut HallDoor {
        Arc::get_mut(&mut self.door.hall).expect("nobody else has this hall")
    }

    pub(super) async fn send(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> Response<Body> {
        let mut request = Request::builder().method(method).uri(path);
        if !headers.iter().any(|(name, _)| *name == "host") {
            request = request.header("host", "localhost");
        }
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let peer = Peer { address: Ipv4Addr::LOCALHOST.into(), is_encrypted: false };
        let request = request.extension(peer).body(Body::from(body.to_owned())).unwrap();
        let mut router: Router = router(&self.halls(), Hosts::new(false, &[]));
        within("the head of the answer", router.call(request)).await.unwrap()
    }

    pub(super) async fn get(&self, path: &str) -> Response<Body> {
        self.send("GET", path, &[], "").await
    }

    /// Returns a page. Fails if the page does not exist.
    pub(super) async fn page(&self, path: &str) -> String {
        let response = self.get(path).await;
        assert_eq!(response.status(), 200, "{path}");
        text(response).await
    }

    pub(super) async fn json(&self, method: &str, path: &str, body: &str) -> (StatusCode, Value) {
        let headers: &[(&str, &str)] = if body.is_empty() { &[] } else { &[("content-type", "application/json")] };
        read(self.send(method, path, headers, body).await).await
    }

    pub(super) async fn form(&self, path: &str, body: &str) -> Response<Body> {
        self.send("POST", path, &[("content-type", "application/x-www-form-urlencoded")], body).await
    }

    pub(super) fn last(&self) -> command::Request {
        self.given.lock().unwrap().last().cloned().expect("a command was given")
    }

    pub(super) fn refuse(&self, refused: Refused) {
        *self.refuse.lock().unwrap() = Some(refused);
    }
}

pub(super) async fn read(response: Response<Body>) -> (StatusCode, Value) {
    let status = response.status();
    let text = text(response).await;
    (status, serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error} in {text:?}")))
}

pub(super) fn leads(answer: &Response<Body>, asked: &str) -> String {
    let to = answer.headers().get("location").map_or("", |to| to.to_str().unwrap());
    let path = to.strip_prefix(&root(asked.split('?').next().unwrap_or_default()));
    format!("/{}", path.unwrap_or_else(|| panic!("from {asked} {to:?} does not lead from the root")))
}

pub(super) async fn text(response: Response<Body>) -> String {
    let bytes = within("the end of the answer", to_bytes(response.into_body(), usize::MAX)).await.unwrap();
    String::from_utf8(bytes.to_vec()).unwrap()
}
