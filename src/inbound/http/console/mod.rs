//! The operator's console: one page, rendered here and kept fresh by `live`, whose every button is a plain form. It works
//! without a script; the script only saves the reloading. What may be done is the core's business: the page shows its refusals.

mod acts;
mod hall;
mod live;
mod parts;
mod view;

use askama::Template;
use axum::Router;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{Html, IntoResponse, Redirect, Response};
use axum::routing::{get, post};

use super::Door;
use super::accept::preferred;
use super::give::Done;
use super::problem::Problem;
use super::reading::{Form, Number};
use crate::core::command;
use crate::core::units::LuggageId;
use crate::wire::answer::AnswerJson;
use acts::{ACTS, Fields};
use parts::Page;
use view::{View, Why};

/// The page, its forms, the pages that ask once more, and the stream that keeps it fresh.
pub(super) fn routes() -> Router<Door> {
    let pages = Router::new()
        .route("/", get(page))
        .route("/console/live", get(live::live))
        .route("/console/confirm/danger/{id}", get(confirm_danger))
        .route("/console/confirm/reset", get(confirm_reset));
    ACTS.into_iter()
        .fold(pages, |router, act| {
            let route =
                move |State(door): State<Door>, headers: HeaderMap, form: Form<Fields>| post_act(door, headers, act, form);
            router.route(&format!("/console/{act}"), post(route))
        })
        // STOP reads nothing of what was sent: nothing that is wrong with it may keep it from halting the robot.
        .route(
            "/console/stop",
            post(|State(door): State<Door>, headers: HeaderMap| post_act(door, headers, "stop", Form(Fields::default()))),
        )
}

/// The page again, with the reason in words beside the button that was pressed.
pub(super) fn refused_page(door: &Door, button: &str, problem: &Problem) -> Response {
    let why = Why::new(button, problem.detail());
    (problem.status(), whole(door, Some(why))).into_response()
}

async fn page(State(door): State<Door>) -> Html<String> {
    whole(&door, None)
}

async fn post_act(door: Door, headers: HeaderMap, act: &'static str, Form(fields): Form<Fields>) -> Response {
    let done = match fields.command(act) {
        Ok((command, epoch)) => door.give(command::Door::Console, command, epoch).await,
        Err(problem) => Err(problem),
    };
    let by_script = preferred(&headers, &["text/html", "application/json"]) == Some("application/json");
    let mut response = match done {
        Ok(Done { accepted, snapshot }) if by_script => axum::Json(AnswerJson::new(accepted, &snapshot)).into_response(),
        Ok(_) => Redirect::to("/").into_response(),
        Err(problem) if by_script => problem.into_response(),
        Err(problem) => refused_page(&door, &fields.button(act), &problem),
    };
    response.headers_mut().append(header::VARY, HeaderValue::from_static("accept"));
    response
}

async fn confirm_danger(State(door): State<Door>, Number(id): Number) -> Response {
    let snapshot = door.handle.snapshot();
    match snapshot.luggage(LuggageId(id)) {
        Some(luggage) => html(&parts::Confirm::danger(luggage)).into_response(),
        None => {
            (StatusCode::NOT_FOUND, whole(&door, Some(Why::new("page", &format!("there is no luggage #{id}"))))).into_response()
        }
    }
}

async fn confirm_reset() -> Html<String> {
    html(&parts::Confirm::reset())
}

fn whole(door: &Door, why: Option<Why>) -> Html<String> {
    let snapshot = door.handle.snapshot();
    let view = View { snapshot: &snapshot, hall: &door.hall, why };
    html(&Page::new(&view))
}

fn html(template: &impl Template) -> Html<String> {
    Html(template.render().expect("the console's templates only write strings, which does not fail"))
}

/// Proxies are not to hold a stream back.
const UNBUFFERED: (HeaderName, &str) = (HeaderName::from_static("x-accel-buffering"), "no");
