//! Helpers for tests of this door: its resources, a loop with a script, an archive with one past piece, and requests
//! from this machine. The loop answers commands from the script and publishes the snapshots of the test. It does not
//! simulate a mission.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use tokio::sync::watch;

use super::super::application::{Application, Reply};
use super::Resources;
use crate::api::tests::fixture::piece;
use crate::runtime::archive::Unreadable;
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::tests::obedient::{Noted, Script, obedient};
use crate::runtime::tests::partial_archive::PartialArchive;
use crate::runtime::tests::within::within;
use coap_endpoint::{Answer, Conditions, Method, Request};
use hallsweep_core::command;
use hallsweep_core::event::Photo;
use hallsweep_core::refused::Refused;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Cell, LuggageId};
use hallsweep_core::world::luggage::Luggage;

pub(super) const PAST: u64 = 70;

pub(super) const UNREADABLE: u64 = 99;

pub(super) struct TestApp {
    pub(super) resources: Resources,
    pub(super) publish: watch::Sender<Arc<Snapshot>>,
    refuse: Arc<Mutex<Option<Refused>>>,
    pub(super) given: Arc<Mutex<Vec<command::Request>>>,
    noted: Arc<Mutex<Vec<Noted>>>,
    pub(super) photos_read: Arc<AtomicUsize>,
}

struct Pictures(Arc<AtomicUsize>);

impl PartialArchive for Pictures {
    fn photo(&self, luggage: LuggageId) -> Result<Option<Photo>, Unreadable> {
        self.0.fetch_add(1, Ordering::SeqCst);
        let photo = Photo { bytes: Arc::from(*b"\x89PNG"), media_type: "image/png" };
        Ok((luggage.0 <= PAST).then_some(photo))
    }

    fn luggage(&self, luggage: LuggageId) -> Result<Option<Luggage>, Unreadable> {
        match luggage.0 {
            PAST => Ok(Some((*piece(PAST, Cell::HOME, None)).clone())),
            UNREADABLE => Err(Unreadable("the disk is on strike".to_owned())),
            _ => Ok(None),
        }
    }
}

/// Starts an app in this state. Its loop accepts everything until told to refuse. Old clients may not drive. Must be
/// called inside a runtime.
pub(super) fn app(snapshot: Snapshot) -> TestApp {
    driven_app(snapshot, false)
}

pub(super) fn driven_app(snapshot: Snapshot, manual_driving: bool) -> TestApp {
    let (handle, script) = obedient(snapshot);
    let photos_read = Arc::new(AtomicUsize::new(0));
    let archive = ArchiveReader::new(Arc::new(Pictures(Arc::clone(&photos_read))));
    let Script { publish, refuse, given, noted } = script;
    TestApp { resources: Resources::new(handle, archive, manual_driving), publish, refuse, given, noted, photos_read }
}

impl TestApp {
    pub(super) async fn ask(&self, request: Request) -> Answer {
        match self.resources.answer(&request) {
            Reply::Now(answer) => answer,
            Reply::Later(answer) => within("the answer", answer).await,
        }
    }

    pub(super) async fn said(&self, request: Request) -> (String, String) {
        let response = self.ask(request).await.response;
        (response.code.to_string(), String::from_utf8_lossy(&response.body).into_owned())
    }

    pub(super) fn last(&self) -> command::Request {
        self.given.lock().unwrap().last().cloned().expect("a command was given")
    }

    /// Returns the last refusal recorded since the last call: the sender, the command, and the reason.
    pub(super) async fn noted(&self) -> Option<Noted> {
        // Lets the loop run first.
        tokio::task::yield_now().await;
        self.noted.lock().unwrap().pop()
    }

    pub(super) fn refuse(&self, refused: Refused) {
        *self.refuse.lock().unwrap() = Some(refused);
    }
}

pub(super) fn get(path: &str) -> Request {
    request(Method::Get, path, "")
}

pub(super) fn put(path: &str, payload: &str) -> Request {
    request(Method::Put, path, payload)
}

pub(super) fn post(path: &str, payload: &str) -> Request {
    request(Method::Post, path, payload)
}

pub(super) fn request(method: Method, path: &str, payload: &str) -> Request {
    let (path, query) = path.split_once('?').unwrap_or((path, ""));
    Request {
        peer: "127.0.0.1:40000".parse().unwrap(),
        method,
        path: path.split('/').skip(1).map(str::to_owned).collect(),
        queries: query.split('&').filter(|query| !query.is_empty()).map(str::to_owned).collect(),
        format: None,
        accept: None,
        conditions: Conditions::default(),
        payload: payload.as_bytes().to_vec(),
    }
}
