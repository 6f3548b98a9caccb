//! All operations for programs at this door. Most come from the tables of commands, resources, map files and old
//! words; the others are listed below. A test fails if a route under `/api/v1` is missing here, or if an operation
//! here has no route.

use axum::http::Method;
use serde_json::{Value, json};

use super::super::laboratory::asked::{LONGEST_S, MOST_FAULTS, MOST_PARCELS, USUAL_PARCELS, USUAL_S, USUAL_SEED};
use super::super::metrics;
use super::super::missions::{EVENTS, MISSIONS, MOST_MISSIONS, RECEIPTS};
use super::super::query::MOST;
use super::operation::Subject::{Commands, Laboratory, Map, Missions, OldClients, Program, Simulator, State};
use super::operation::{Operation, Subject};
use crate::api::answer::AnswerJson;
use crate::api::changes::ChangesJson;
use crate::api::commands::{self, COMMANDS, CommandKind, Methods};
use crate::api::hall_files::ReadHall;
use crate::api::halls::HallListJson;
use crate::api::map::MapJson;
use crate::api::map_files::FILES;
use crate::api::mission_record::{EventListJson, MissionListJson, MissionWholeJson, MomentJson};
use crate::api::old_clients;
use crate::api::problem::ProblemKind;
use crate::api::receipt::ReceiptListJson;
use crate::api::replay::ReplayJson;
use crate::api::resources::{self, Form, RESOURCES};
use crate::api::retrieval_record::RetrievalRecordJson;
use crate::api::robot::RobotBySettingsJson;
use crate::api::schemas::Schemas;
use crate::api::simulator::{ChangeBody, HallBody, SimulatorJson};
use crate::phrases::Language;
use hallsweep_core::command::Command;
use hallsweep_laboratory::pallet::{Mishap, PalletJson};
use hallsweep_laboratory::roomba::RoombaJson;

const JSON: &str = "application/json";
const TEXT: &str = "text/plain";

pub(super) fn all(schemas: &mut Schemas) -> Vec<Operation> {
    let mut all: Vec<Operation> = COMMANDS.iter().map(|row| command(row, schemas)).collect();
    all.extend(RESOURCES.iter().map(|row| resource(row, schemas)));
    all.extend(files());
    all.extend(old_words(schemas));
    all.extend(state(schemas));
    all.extend(missions(schemas));
    all.extend(simulator(schemas));
    all.extend(laboratory(schemas));
    all.extend(program());
    all
}

fn get(path: &'static str, id: &'static str, subject: Subject, summary: &'static str) -> Operation {
    Operation::new(Method::GET, path, id, subject, summary)
}

fn text() -> Value {
    json!({"type": "string"})
}

fn number(least: u64, most: u64) -> Value {
    json!({"type": "integer", "minimum": least, "maximum": most})
}

fn usual(mut schema: Value, usual: impl Into<Value>) -> Value {
    schema["default"] = usual.into();
    schema
}

fn command(row: &'static commands::CommandRow, schemas: &mut Schemas) -> Operation {
    let method = if row.methods == Methods::Put { Method::PUT } else { Method::POST };
    let answer = schemas.sent::<AnswerJson>();
    let operation = Operation::new(method, format!("/api/v1{}", row.path), row.name, Commands, row.title)
        .answers(JSON, answer)
        .once(row.kind == CommandKind::Stop);
    let operation = match schemas.body(row.kind) {
        Some(body) => operation.takes(&[JSON], body, row.needs_body()),
        None => operation,
    };
    // The request may name a sensor that the settings do not have, or an area that the hall does not have.
    use CommandKind::{CloseArea, OrderAreas, SearchAgain, Temperature};
    let names_something = matches!(row.kind, SearchAgain | OrderAreas | CloseArea | Temperature);
    if names_something { operation.also(&[ProblemKind::NotFound]) } else { operation }
}

fn resource(row: &'static resources::ResourceRow, schemas: &mut Schemas) -> Operation {
    let id = format!("get{}{}", row.name[..1].to_ascii_uppercase(), &row.name[1..]);
    let operation = Operation::new(Method::GET, format!("/api/v1{}", row.path), id, State, row.title).tagged();
    let Some(json) = schemas.resource(row.kind) else {
        let take = ("take", "Number of the photo, counted from 1; the newest photo if absent.", number(1, MOST));
        let pictures =
            operation.asked(take.0, take.1, take.2).answers("image/png", Value::Null).answers("image/jpeg", Value::Null);
        return pictures;
    };
    let operation = operation.answers(JSON, json);
    if row.forms.contains(&Form::Text) { operation.answers(TEXT, text()) } else { operation }
}

fn files() -> impl Iterator<Item = Operation> {
    FILES.iter().map(|row| {
        let ending = row.name.rsplit('.').next().unwrap_or(row.name);
        let media_type = row.media_type.split(';').next().unwrap_or(row.media_type);
        let id = format!("getMap{}{}", ending[..1].to_ascii_uppercase(), &ending[1..]);
        let is_text = media_type.starts_with("text/") || media_type == "application/toml";
        let holds = if is_text { text() } else { Value::Null };
        Operation::new(Method::GET, format!("/api/v1/map/{}", row.name), id, Map, row.title).tagged().answers(media_type, holds)
    })
}

fn old_words(schemas: &mut Schemas) -> Vec<Operation> {
    let answer = schemas.sent::<AnswerJson>();
    let words = old_clients::ROWS.iter().flat_map(|row| row.posts);
    let operation = |word: &&'static str| {
        let (path, id) = (format!("/{word}"), format!("old{}{}", word[..1].to_ascii_uppercase(), &word[1..]));
        Operation::new(Method::POST, path, id, OldClients, format!("`{word}`"))
            .answers(JSON, answer.clone())
            .once(old_clients::posted(word) == Ok(Command::Stop))
    };
    words.map(operation).collect()
}

fn state(schemas: &mut Schemas) -> Vec<Operation> {
    // Adds the schema for the data of an event, for programs that read the stream.
    let _ = schemas.sent::<ChangesJson>();
    let events = "The state, then every change, as server-sent events: `snapshot` carries a `State`, `changes` carries \
                  `Changes`. After a break, send `Last-Event-ID` to receive only what changed since.";
    let robots = schemas.sent::<Vec<RobotBySettingsJson>>();
    let last = "`id` of the last event that the client received.";
    vec![
        get("/api/v1/halls", "getHalls", State, "The halls that the key of the request sees")
            .answers(JSON, schemas.sent::<HallListJson>()),
        get("/api/v1/robots", "getRobots", State, "All robots, each with its kind and address").tagged().answers(JSON, robots),
        get("/api/v1/events", "getEvents", State, events)
            .told("Last-Event-ID", last, text())
            .answers("text/event-stream", text()),
    ]
}

fn missions(schemas: &mut Schemas) -> Vec<Operation> {
    let list = |name: &'static str, id: &'static str, what: &'static str, events: Value| {
        get(name, id, Missions, what)
            .asked("after", "Number of an entry; the list begins after this entry.", usual(number(0, MOST), 0))
            .asked("limit", "Maximum number of events.", usual(number(1, EVENTS), EVENTS))
            .tagged()
            .answers(JSON, events)
    };
    let events = schemas.sent::<EventListJson>();
    let of = |path, id, what| get(path, id, Missions, what).tagged();
    let language = || json!({"type": "string", "enum": Language::ALL.map(Language::tag)});
    let spoken = "Language; if absent, chosen by `Accept-Language`.";
    let file = |path, id, what| get(path, id, Missions, what);
    vec![
        get("/api/v1/missions", "getMissions", Missions, "All missions, the newest first")
            .asked("before", "Number of a mission; the list begins with the mission before.", number(1, MOST))
            .asked("limit", "Maximum number of missions.", usual(number(1, MOST_MISSIONS), MISSIONS))
            .tagged()
            .answers(JSON, schemas.sent::<MissionListJson>()),
        of("/api/v1/missions/{id}", "getMissionRecord", "One mission with its luggage and its map")
            .answers(JSON, schemas.sent::<MissionWholeJson>()),
        of("/api/v1/missions/{id}/moment", "getMissionMoment", "A mission as it was after one of its entries, or after the last")
            .asked("at", "Number of the entry; the last entry if absent.", number(1, MOST))
            .answers(JSON, schemas.sent::<MomentJson>()),
        list("/api/v1/missions/{id}/events", "getMissionEvents", "All events of a mission, oldest first", events.clone()),
        list("/api/v1/missions/{id}/timeline", "getMissionTimeline", "The events of a mission that its timeline shows", events),
        of("/api/v1/missions/{id}/map", "getMissionMap", "The known part of the hall in a mission")
            .answers(JSON, schemas.sent::<MapJson>())
            .answers(TEXT, text()),
        of("/api/v1/missions/{id}/retrieval", "getMissionRetrieval", "The retrieval of a mission, tick by tick")
            .answers(JSON, schemas.sent::<RetrievalRecordJson>()),
        of("/api/v1/missions/{id}/receipts", "getMissionReceipts", "The receipts for hand-overs of a mission, oldest first")
            .asked("after", "Number of an entry; the list begins after this entry.", usual(number(0, MOST), 0))
            .asked("limit", "Maximum number of receipts.", usual(number(1, RECEIPTS), RECEIPTS))
            .answers(JSON, schemas.sent::<ReceiptListJson>()),
        file("/missions/{id}/report", "getMissionReport", "The report of a mission, as a page to save")
            .asked("language", spoken, language())
            .answers("text/html", text()),
        file("/missions/{id}/record.jsonl", "getMissionRecordLines", "All entries of a mission, one line of JSON each")
            .answers("application/jsonl", text())
            .also(&[ProblemKind::Unusable]),
        file("/missions/{id}/record.csv", "getMissionRecordTable", "All entries of a mission, as a table")
            .asked("language", spoken, language())
            .answers("text/csv", text()),
    ]
}

fn simulator(schemas: &mut Schemas) -> Vec<Operation> {
    use ProblemKind::{Conflict, NotFound};
    let now = schemas.sent::<SimulatorJson<'static>>();
    let of = |method, path, id, what| Operation::new(method, path, id, Simulator, what);
    let after = |operation: Operation| operation.answers(JSON, now.clone()).also(&[Conflict, NotFound]);
    let toml = |path, id, what| of(Method::GET, path, id, what).answers("application/toml", text()).also(&[Conflict, NotFound]);
    // The description names two media types, but a hall file is accepted with any media type.
    const FILE: &[&str] = &["application/octet-stream", "application/toml"];
    vec![
        of(Method::GET, "/api/v1/simulator", "getSimulator", "Simulator state")
            .answers(JSON, now.clone())
            .also(&[Conflict, NotFound]),
        after(of(Method::PUT, "/api/v1/simulator", "changeSimulator", "Change the speed, the pause or the faults")).takes(
            &[JSON],
            schemas.taken::<ChangeBody>(),
            true,
        ),
        after(of(Method::POST, "/api/v1/simulator/step", "stepSimulator", "Simulate one step while the simulator is paused")),
        toml("/api/v1/simulator/hall", "getSimulatorHall", "The simulated hall"),
        after(of(Method::PUT, "/api/v1/simulator/hall", "chooseSimulatorHall", "Move the robots to another hall")).takes(
            &[JSON],
            schemas.taken::<HallBody>(),
            true,
        ),
        toml("/api/v1/simulator/halls/{name}", "getOfferedHall", "An offered hall"),
        after(of(Method::PUT, "/api/v1/simulator/halls/{name}", "keepHall", "Store a hall under a name")).takes(
            FILE,
            text(),
            true,
        ),
        after(of(Method::DELETE, "/api/v1/simulator/halls/{name}", "discardHall", "Delete a stored hall")),
        of(Method::POST, "/api/v1/simulator/hall/check", "checkHall", "Check a hall file of any format, without any change")
            .asked("name", "Name of the file; the extension decides the format.", usual(text(), "hall.toml"))
            .answers(JSON, schemas.sent::<ReadHall>())
            .takes(FILE, text(), true)
            .also(&[Conflict, NotFound]),
    ]
}

fn laboratory(schemas: &mut Schemas) -> Vec<Operation> {
    let names =
        Mishap::ALL.map(Mishap::name).into_iter().filter(|name| *name != Mishap::Absent.name()).collect::<Vec<_>>().join("|");
    let fault = json!({"type": "string", "pattern": format!("^(({names})(@[1-{MOST_PARCELS}])?|{})$", Mishap::Absent.name())});
    let faults = json!({"type": "array", "maxItems": MOST_FAULTS, "items": fault});
    let of = |path, id, what| {
        get(path, id, Laboratory, what).asked("seed", "Seed of the random numbers.", usual(number(0, u64::MAX), USUAL_SEED))
    };
    vec![
        of("/api/v1/laboratory/roomba", "getRoomba", "The Roomba as state machine and as behaviour tree")
            .asked("seconds", "Duration of each run, in seconds.", usual(number(1, LONGEST_S), USUAL_S))
            .answers(JSON, schemas.sent::<RoombaJson>()),
        of("/api/v1/laboratory/pallet", "getPallet", "The pallet scenario, with every tick of its trees")
            .asked("parcels", "Number of parcels on the pallet.", usual(number(1, MOST_PARCELS), USUAL_PARCELS))
            .asked("fault", "Faults to simulate, with the number of the parcel, as `NAME@PARCEL`.", faults)
            .answers(JSON, schemas.sent::<PalletJson<ReplayJson>>()),
    ]
}

fn program() -> Vec<Operation> {
    let description = json!({"type": "object"});
    vec![
        get("/healthz", "getHealth", Program, "`ok` and the revision, while the main loop runs").answers(TEXT, text()),
        get("/metrics", "getMetrics", Program, "Figures of the program for Prometheus")
            .answers(metrics::FORMATS[0], text())
            .answers(metrics::FORMATS[1], text()),
        get("/api/v1/openapi.json", "getDescription", Program, "This OpenAPI description").tagged().answers(JSON, description),
    ]
}
