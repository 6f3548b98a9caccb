//! THE TABLE of this door: every route with its method, its required right, and its handler. The router is built from
//! these rows only, and each row has its own gate. Senders who may look get status 404 for an unknown path, and 405
//! for a wrong method. Everyone gets 405 and the allowed methods for a path that requires no right. A test keeps the
//! table in `docs/http.md` equal to this one.

use std::borrow::Cow;

use axum::Router;
use axum::handler::Handler;
use axum::http::{HeaderMap, Method};
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::{MethodFilter, MethodRouter, on};

use super::gate::{Gate, gate};
use super::reading::Number;
use super::{
    Halls, HttpDoor, assets, command, console, events, halls, laboratory, language, map_files, metrics, missions, mqtt, old,
    openapi, problem, reads, reports, sign_in, simulator,
};
use crate::access::Need;
use crate::access::Need::{Act, Nothing, See, Stop};
use crate::api::commands::{self, COMMANDS, CommandKind, Methods, Subject};
use crate::api::map_files::{self as files, FILES};
use crate::api::old_clients::{self, posted};
use crate::api::resources::{self, RESOURCES, ResourceKind};
use hallsweep_core::command::Command;

pub(super) struct RouteRow {
    /// The method of the route. A `GET` route also answers `HEAD`.
    pub(super) method: Method,
    /// The path, in the notation of axum.
    pub(super) path: Cow<'static, str>,
    pub(super) need: Need,
    answers: MethodRouter,
}

/// Returns all routes. Everyone who is signed in may send STOP. A `move` may be a STOP; all other moves require an
/// operator.
pub(super) fn table() -> Vec<RouteRow> {
    let seen = [for_anybody(), resources(), files_of_the_map(), changes_and_past()];
    let rows = seen.into_iter().chain([commands(), page(), laboratory(), simulator(), buttons(), old_console()]);
    rows.flatten().collect()
}

/// Routes that require no right. They are for signing in, tell nothing about the hall, or lead to a door that checks
/// keys itself.
#[rustfmt::skip]
fn for_anybody() -> Vec<RouteRow> {
    vec![
        get("/healthz", Nothing, reads::health),
        get("/sign-in", Nothing, sign_in::page),
        post("/sign-in", Nothing, sign_in::sign_in),
        post("/sign-out", Nothing, sign_in::sign_out),
        post("/language", Nothing, language::choose),
        get("/static/console.css", Nothing, assets::file),
        get("/static/console.js", Nothing, assets::file),
        get("/static/hall.js", Nothing, assets::file),
        get("/static/time.js", Nothing, assets::file),
        get("/static/verdict.css", Nothing, assets::file),
        get("/static/tokens.css", Nothing, assets::file),
        get("/static/shell.css", Nothing, assets::file),
        get("/static/map.css", Nothing, assets::file),
        get("/static/vendor/inter.woff2", Nothing, assets::file),
        get("/static/vendor/icons.svg", Nothing, assets::file),
        get("/static/photo.js", Nothing, assets::file),
        get("/static/areas.js", Nothing, assets::file),
        get("/static/verdict.js", Nothing, assets::file),
        get("/static/attention.js", Nothing, assets::file),
        get("/static/theme.js", Nothing, assets::file),
        get("/static/words.js", Nothing, assets::file),
        get("/static/stop.js", Nothing, assets::file),
        get("/static/bar.js", Nothing, assets::file),
        get("/static/laboratory.css", Nothing, assets::file),
        get("/static/laboratory.js", Nothing, assets::file),
        get("/static/pallet.js", Nothing, assets::file),
        get("/static/replay.js", Nothing, assets::file),
        get("/static/roomba.js", Nothing, assets::file),
        get("/static/simulator.css", Nothing, assets::file),
        get("/static/simulator.js", Nothing, assets::file),
        get("/static/editor.js", Nothing, assets::file),
        get("/static/trees.js", Nothing, assets::file),
        get("/static/vendor/idiomorph.js", Nothing, assets::file),
        get("/static/icon.svg", Nothing, assets::file),
        get("/favicon.ico", Nothing, assets::file),
        get("/mqtt", Nothing, mqtt::mqtt),
        get("/api/v1/openapi.json", Nothing, openapi::description),
    ]
}

fn resources() -> Vec<RouteRow> {
    let row = |row: &'static resources::ResourceRow| {
        let path = format!("/api/v1{}", row.path);
        match row.kind {
            ResourceKind::Photo => get(path, See, reads::photo),
            ResourceKind::Piece => get(path, See, reads::luggage),
            ResourceKind::State | ResourceKind::Strategy | ResourceKind::Of(_) => {
                get(path, See, async move |door: HttpDoor, headers: HeaderMap| reads::resource(row, &door, &headers))
            }
        }
    };
    RESOURCES.iter().map(row).collect()
}

fn files_of_the_map() -> Vec<RouteRow> {
    let row = |row: &'static files::MapFileRow| {
        get(format!("/api/v1/map/{}", row.name), See, async move |door: HttpDoor, headers: HeaderMap| {
            map_files::map_file(row, &door, &headers).await
        })
    };
    FILES.iter().map(row).collect()
}

#[rustfmt::skip]
fn changes_and_past() -> Vec<RouteRow> {
    vec![
        get("/metrics", See, metrics::metrics),
        get(halls::LIST, See, halls::list),
        get("/api/v1/robots", See, reads::robots),
        get("/api/v1/events", See, events::events),
        get("/api/v1/missions", See, missions::list),
        get("/api/v1/missions/{id}", See, missions::mission),
        get("/api/v1/missions/{id}/moment", See, missions::moment),
        get("/api/v1/missions/{id}/events", See, missions::events),
        get("/api/v1/missions/{id}/timeline", See, missions::timeline),
        get("/api/v1/missions/{id}/map", See, missions::map),
        get("/api/v1/missions/{id}/retrieval", See, missions::retrieval),
        get("/api/v1/missions/{id}/receipts", See, missions::receipts),
    ]
}

#[rustfmt::skip]
fn laboratory() -> Vec<RouteRow> {
    vec![
        get("/laboratory", See, laboratory::page),
        get("/api/v1/laboratory/roomba", See, laboratory::roomba),
        get("/api/v1/laboratory/pallet", See, laboratory::pallet),
    ]
}

#[rustfmt::skip]
fn simulator() -> Vec<RouteRow> {
    vec![
        get("/simulator", See, simulator::page),
        post("/simulator/change", Act, simulator::change_by_form),
        post("/simulator/hall", Act, simulator::choose_by_form),
        get("/simulator/editor", See, simulator::editor),
        post("/simulator/editor", Act, simulator::act),
        get("/api/v1/simulator", See, simulator::simulator),
        put("/api/v1/simulator", Act, simulator::change),
        post("/api/v1/simulator/step", Act, simulator::step),
        get("/api/v1/simulator/hall", See, simulator::hall),
        put("/api/v1/simulator/hall", Act, simulator::put_down),
        get("/api/v1/simulator/halls/{name}", See, simulator::offered),
        put("/api/v1/simulator/halls/{name}", Act, simulator::keep),
        delete("/api/v1/simulator/halls/{name}", Act, simulator::discard),
        post("/api/v1/simulator/hall/check", Act, simulator::check),
    ]
}

fn commands() -> Vec<RouteRow> {
    let row = |command: &'static commands::CommandRow| {
        let kind = command.kind;
        let (method, filter) = match command.methods {
            Methods::Post | Methods::PostOrPut => (Method::POST, MethodFilter::POST),
            Methods::Put => (Method::PUT, MethodFilter::PUT),
        };
        let answers = match (kind, command.subject) {
            // The handler reads no body: no fault in a request may prevent it from halting the robot.
            (CommandKind::Stop, _) => on(filter, command::stop),
            (_, Subject::None) => on(filter, move |sender, body| command::command(kind, sender, 0, body)),
            (_, Subject::Luggage | Subject::Alarm) => {
                on(filter, move |sender, Number(number), body| command::command(kind, sender, number, body))
            }
        };
        RouteRow { method, path: format!("/api/v1{}", command.path).into(), need: command.need, answers }
    };
    COMMANDS.iter().map(row).collect()
}

#[rustfmt::skip]
fn page() -> Vec<RouteRow> {
    vec![
        get("/", See, console::page),
        get("/api", See, openapi::page),
        get("/missions", See, console::missions::list),
        get("/missions/{id}", See, console::missions::one),
        get("/missions/{id}/report", See, reports::report),
        get("/missions/{id}/record.jsonl", See, reports::lines),
        get("/missions/{id}/record.csv", See, reports::table),
        get("/missions/{id}/moment", See, console::moments::page),
        get("/missions/{id}/retrieval", See, console::replay::page),
        get("/missions/{id}/receipts", See, console::missions::receipts),
        get("/luggage/{id}", See, console::photo::page),
        get("/console/live", See, console::live),
        get("/console/bar", See, console::bar),
        get("/console/coverage", See, console::coverage),
        get("/console/missions/{id}/moment", See, console::moments::message),
        get("/console/confirm/danger/{id}", Act, console::confirm_danger),
        get("/console/confirm/reset", Act, console::confirm_reset),
        get("/console/confirm/close", Act, console::confirm_close),
        get("/console/confirm/closeArea", Act, console::confirm_close_area),
        get("/console/confirm/handOver", Act, console::confirm_hand_over),
    ]
}

/// The forms of the console's page. Each button of a command has one route. The commands come from the common table.
fn buttons() -> Vec<RouteRow> {
    let row = |command: &'static commands::CommandRow, word: &str| {
        let path = format!("/console/{word}");
        // The handler of STOP reads no form.
        if command.kind == CommandKind::Stop {
            post(path, command.need, console::stop)
        } else {
            post(path, command.need, console::act)
        }
    };
    COMMANDS.iter().flat_map(|command| console::buttons(command).into_iter().map(move |word| row(command, word))).collect()
}

fn old_console() -> Vec<RouteRow> {
    let need = |word: &&str| if posted(word) == Ok(Command::Stop) { Stop } else { Act };
    let posts = old_clients::ROWS.iter().flat_map(|row| row.posts);
    posts.map(|word| post(format!("/{word}"), need(word), old::give)).collect()
}

pub(super) fn routes(halls: &Halls) -> Router {
    let gated = |need| from_fn_with_state(Gate::new(halls.clone(), need), gate);
    let (open, guarded): (Vec<RouteRow>, Vec<RouteRow>) = table().into_iter().partition(|row| row.need == Nothing);
    // For routes that require no right, everyone gets status 405 for a wrong method. For all other routes, only
    // senders who may look get this status. A row that answers wrong methods itself keeps its own answer.
    let with = |router: Router, rows: Vec<RouteRow>, need| {
        let route = |router: Router, row: RouteRow| router.route(&row.path, row.answers.layer(gated(row.need)));
        rows.into_iter().fold(router, route).method_not_allowed_fallback(problem::no_such_method.layer(gated(need)))
    };
    with(with(Router::new(), open, Nothing), guarded, See).fallback(problem::no_such_path.layer(gated(See)))
}

/// Adds the layer that takes the name of a hall out of the path. A layer of a router runs after its route is found, so
/// these routes are the fallback of a router with nothing but the layer.
pub(super) fn entered(guarded: Router) -> Router {
    Router::new().fallback_service(guarded).layer(from_fn(halls::enter))
}

fn get<H: Handler<T, ()>, T: 'static>(path: impl Into<Cow<'static, str>>, need: Need, handler: H) -> RouteRow {
    RouteRow { method: Method::GET, path: path.into(), need, answers: on(MethodFilter::GET, handler) }
}

fn post<H: Handler<T, ()>, T: 'static>(path: impl Into<Cow<'static, str>>, need: Need, handler: H) -> RouteRow {
    RouteRow { method: Method::POST, path: path.into(), need, answers: on(MethodFilter::POST, handler) }
}

fn put<H: Handler<T, ()>, T: 'static>(path: impl Into<Cow<'static, str>>, need: Need, handler: H) -> RouteRow {
    RouteRow { method: Method::PUT, path: path.into(), need, answers: on(MethodFilter::PUT, handler) }
}

fn delete<H: Handler<T, ()>, T: 'static>(path: impl Into<Cow<'static, str>>, need: Need, handler: H) -> RouteRow {
    RouteRow { method: Method::DELETE, path: path.into(), need, answers: on(MethodFilter::DELETE, handler) }
}

#[cfg(test)]
#[path = "routes_tests.rs"]
mod tests;
