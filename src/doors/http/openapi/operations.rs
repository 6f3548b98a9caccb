//! Every operation for programs at this door: the operations in the tables of commands, resources, map files and old words, and
//! below them the operations without a table. A test fails if a route under `/api/v1` is missing here, or an operation here has
//! no route.

use axum::http::Method;
use serde_json::{Value, json};

use super::super::laboratory::asked::{LONGEST_S, MOST_FAULTS, MOST_PARCELS, USUAL_PARCELS, USUAL_S, USUAL_SEED};
use super::super::metrics;
use super::super::missions::{EVENTS, MISSIONS, MOST_MISSIONS};
use super::super::query::MOST;
use super::operation::Subject::{Commands, Laboratory, Map, Missions, OldClients, Program, Simulator, State};
use super::operation::{Operation, Subject};
use crate::api::answer::AnswerJson;
use crate::api::changes::ChangesJson;
use crate::api::commands::{self, COMMANDS, CommandKind, Methods};
use crate::api::hall_files::ReadHall;
use crate::api::map::MapJson;
use crate::api::map_files::FILES;
use crate::api::mission_record::{EventListJson, MissionListJson, MissionWholeJson, MomentJson};
use crate::api::old_clients;
use crate::api::problem::ProblemKind;
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
    let operation = match schemas.body(row.takes) {
        Some(body) => operation.takes(&[JSON], body, row.needs_body()),
        None => operation,
    };
    // The settings may not name the sensor.
    if row.kind == CommandKind::Temperature { operation.also(&[ProblemKind::NotFound]) } else { operation }
}

fn resource(row: &'static resources::ResourceRow, schemas: &mut Schemas) -> Operation {
    let id = format!("get{}{}", row.name[..1].to_ascii_uppercase(), &row.name[1..]);
    let operation = Operation::new(Method::GET, format!("/api/v1{}", row.path), id, State, row.title).tagged();
    let Some(json) = schemas.resource(row.kind) else {
        let take = ("take", "Which photo of the piece, counted from 1; the newest where it is absent.", number(1, MOST));
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
    // Adds the schema of the events' data, for programs that read the stream.
    let _ = schemas.sent::<ChangesJson>();
    let events = "The state, then every change: server-sent events `snapshot`, with a `State` as its data, and `changes`, with \
                  `Changes`; after a break `Last-Event-ID` says what is there already.";
    let robots = schemas.sent::<Vec<RobotBySettingsJson>>();
    let last = "The `id` of the last event its sender has.";
    vec![
        get("/api/v1/robots", "getRobots", State, "All robots, each with its kind and address").tagged().answers(JSON, robots),
        get("/api/v1/events", "getEvents", State, events)
            .told("Last-Event-ID", last, text())
            .answers("text/event-stream", text()),
    ]
}

fn missions(schemas: &mut Schemas) -> Vec<Operation> {
    let list = |name: &'static str, id: &'static str, what: &'static str, events: Value| {
        get(name, id, Missions, what)
            .asked("after", "The entry behind which the list begins.", usual(number(0, MOST), 0))
            .asked("limit", "How many at most.", usual(number(1, EVENTS), EVENTS))
            .tagged()
            .answers(JSON, events)
    };
    let events = schemas.sent::<EventListJson>();
    let of = |path, id, what| get(path, id, Missions, what).tagged();
    let language = || json!({"type": "string", "enum": Language::ALL.map(Language::tag)});
    let spoken = "The language; else as `Accept-Language` asks.";
    let file = |path, id, what| get(path, id, Missions, what);
    vec![
        get("/api/v1/missions", "getMissions", Missions, "All missions, the newest first")
            .asked("before", "The mission before which the list begins.", number(1, MOST))
            .asked("limit", "How many at most.", usual(number(1, MOST_MISSIONS), MISSIONS))
            .tagged()
            .answers(JSON, schemas.sent::<MissionListJson>()),
        of("/api/v1/missions/{id}", "getMissionRecord", "One mission with its luggage and its map")
            .answers(JSON, schemas.sent::<MissionWholeJson>()),
        of("/api/v1/missions/{id}/moment", "getMissionMoment", "How it stood after one of its entries, or after its last")
            .asked("at", "The entry.", number(1, MOST))
            .answers(JSON, schemas.sent::<MomentJson>()),
        list("/api/v1/missions/{id}/events", "getMissionEvents", "Everything that happened in it, oldest first", events.clone()),
        list(
            "/api/v1/missions/{id}/timeline",
            "getMissionTimeline",
            "Those of its events that stand on the line of time",
            events,
        ),
        of("/api/v1/missions/{id}/map", "getMissionMap", "Its hall as far as it was known")
            .answers(JSON, schemas.sent::<MapJson>())
            .answers(TEXT, text()),
        of("/api/v1/missions/{id}/retrieval", "getMissionRetrieval", "How its dangerous piece was fetched, tick by tick")
            .answers(JSON, schemas.sent::<RetrievalRecordJson>()),
        file("/missions/{id}/report", "getMissionReport", "Its report, a page to save")
            .asked("language", spoken, language())
            .answers("text/html", text()),
        file("/missions/{id}/record.jsonl", "getMissionRecordLines", "Every entry of its record, a line of JSON each")
            .answers("application/jsonl", text())
            .also(&[ProblemKind::Unusable]),
        file("/missions/{id}/record.csv", "getMissionRecordTable", "The same as a table")
            .asked("language", spoken, language())
            .answers("text/csv", text()),
    ]
}

fn simulator(schemas: &mut Schemas) -> Vec<Operation> {
    use ProblemKind::{Conflict, NotFound};
    let now = schemas.sent::<SimulatorJson<'static>>();
    let of = |method, path, id, what| Operation::new(method, path, id, Simulator, what);
    let after = |operation: Operation| operation.answers(JSON, now.clone()).also(&[Conflict, NotFound]);
    let toml = |path, id, what| of(Method::GET, path, id, what).answers("application/toml", text()).also(&[NotFound]);
    // A hall file is accepted with any media type.
    const FILE: &[&str] = &["application/octet-stream", "application/toml"];
    vec![
        of(Method::GET, "/api/v1/simulator", "getSimulator", "The simulator").answers(JSON, now.clone()).also(&[NotFound]),
        after(of(Method::PUT, "/api/v1/simulator", "changeSimulator", "Change what is named")).takes(
            &[JSON],
            schemas.taken::<ChangeBody>(),
            true,
        ),
        after(of(Method::POST, "/api/v1/simulator/step", "stepSimulator", "One step, while it is paused")),
        toml("/api/v1/simulator/hall", "getSimulatorHall", "The hall that is simulated"),
        after(of(Method::PUT, "/api/v1/simulator/hall", "chooseSimulatorHall", "Put the robots down in another hall")).takes(
            &[JSON],
            schemas.taken::<HallBody>(),
            true,
        ),
        toml("/api/v1/simulator/halls/{name}", "getOfferedHall", "A hall that is offered"),
        after(of(Method::PUT, "/api/v1/simulator/halls/{name}", "keepHall", "Keep a hall under a name")).takes(
            FILE,
            text(),
            true,
        ),
        after(of(Method::DELETE, "/api/v1/simulator/halls/{name}", "discardHall", "Discard a hall that is kept")),
        of(Method::POST, "/api/v1/simulator/hall/check", "checkHall", "Read a hall file of any format; nothing is changed")
            .asked("name", "Its name, whose ending says what format it may be.", usual(text(), "hall.toml"))
            .answers(JSON, schemas.sent::<ReadHall>())
            .takes(FILE, text(), true)
            .also(&[NotFound]),
    ]
}

fn laboratory(schemas: &mut Schemas) -> Vec<Operation> {
    let names =
        Mishap::ALL.map(Mishap::name).into_iter().filter(|name| *name != Mishap::Absent.name()).collect::<Vec<_>>().join("|");
    let fault = json!({"type": "string", "pattern": format!("^(({names})(@[1-{MOST_PARCELS}])?|{})$", Mishap::Absent.name())});
    let faults = json!({"type": "array", "maxItems": MOST_FAULTS, "items": fault});
    let of = |path, id, what| {
        get(path, id, Laboratory, what).asked("seed", "Where its dice begin.", usual(number(0, u64::MAX), USUAL_SEED))
    };
    vec![
        of("/api/v1/laboratory/roomba", "getRoomba", "The Roomba as state machine and as behaviour tree")
            .asked("seconds", "How long each runs.", usual(number(1, LONGEST_S), USUAL_S))
            .answers(JSON, schemas.sent::<RoombaJson>()),
        of("/api/v1/laboratory/pallet", "getPallet", "The pallet scenario, with every tick of its trees")
            .asked("parcels", "How many stand on the pallet.", usual(number(1, MOST_PARCELS), USUAL_PARCELS))
            .asked("fault", "What is to go wrong, and at which parcel.", faults)
            .answers(JSON, schemas.sent::<PalletJson<ReplayJson>>()),
    ]
}

fn program() -> Vec<Operation> {
    let description = json!({"type": "object"});
    vec![
        get("/healthz", "getHealth", Program, "`ok` and the revision, while the program lives").answers(TEXT, text()),
        get("/metrics", "getMetrics", Program, "Its figures, as Prometheus reads them")
            .answers(metrics::FORMATS[0], text())
            .answers(metrics::FORMATS[1], text()),
        get("/api/v1/openapi.json", "getDescription", Program, "This description").tagged().answers(JSON, description),
    ]
}
