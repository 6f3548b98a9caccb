//! The editor of halls as a page. Without scripts it is a text field with the hall file, which can be checked and used; with them `editor.js`
//! draws the same text.

use std::sync::Arc;

use askama::Template;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Redirect, Response};
use serde::Deserialize;

use super::super::console::html;
use super::super::problem::Problem;
use super::super::query::Query;
use super::super::reading::HallForm;
use super::{Asker, offered_hall, read_hall};
use crate::api::door;
use crate::api::fields::in_short;
use crate::api::hall_files::{Finding, Found, Place};
use crate::phrases::{Language, Markup, Phrase};
use crate::runtime::simulator::{HallSource, OtherHall};

#[derive(Template)]
#[template(path = "simulator/editor.html")]
struct Page {
    language: Language,
    toml: String,
    /// The halls that are always offered, and those that are kept.
    halls: Vec<String>,
    kept: Vec<String>,
    /// Under which name this one is kept, or is to be.
    name: String,
    /// Whether it was kept under this name when it was opened.
    is_opened: bool,
    /// Whether another hall is kept under the name, which was asked to give way.
    gives_way: bool,
    bound: Option<String>,
    may_act: bool,
    /// What was done, in words.
    done: Option<Markup>,
    /// What is wrong with it, in words.
    why: Option<String>,
    /// What a search would not come to; `None` when it was not checked.
    findings: Option<Vec<Finding>>,
}

impl Page {
    fn of(asker: &Asker, toml: String) -> Page {
        let kept = asker.simulator.kept_halls();
        Page {
            language: asker.language,
            toml,
            halls: asker.simulator.halls().into_iter().filter(|name| !kept.contains(name)).collect(),
            kept,
            name: String::new(),
            is_opened: false,
            gives_way: false,
            bound: asker.bound_in_words(),
            may_act: asker.may_act(),
            done: None,
            why: None,
            findings: None,
        }
    }

    /// The same of a hall that is kept, if one is under this name.
    fn opened(self, name: &str) -> Page {
        if !self.kept.iter().any(|kept| kept == name) {
            return self;
        }
        let done = Some(self.language.say("halls-opened").with("name", name).markup());
        Page { name: name.to_owned(), is_opened: true, done, ..self }
    }

    fn said(&self, finding: &Finding) -> String {
        let text = in_words(self.language, &finding.found);
        let Some(Place { column, row }) = finding.at else { return text.to_string() };
        self.language.say("editor-at").with("column", column + 1).with("row", row + 1).with("text", text).to_string()
    }
}

/// As the script says it too.
pub(super) fn in_words(language: Language, found: &Found) -> Phrase<'_> {
    let phrase = language.say_of("editor-found", found.code());
    match found {
        Found::PieceUnreached { name } => phrase.with("name", name),
        Found::More { count } => phrase.with("count", count),
        Found::CellUnreached | Found::NoLuggage => phrase,
    }
}

/// `GET simulator/editor`: the hall that is simulated, or one that is offered.
pub(in crate::doors::http) async fn editor(asker: Asker, query: Query) -> Result<Response, Problem> {
    query.only(&["hall"])?;
    let page = match query.every("hall").first() {
        Some(name) => Page::of(&asker, offered_hall(&asker, name).await??).opened(name),
        None => Page::of(&asker, asker.state().hall.toml.to_string()),
    };
    Ok(html(&page).into_response())
}

#[derive(Debug, Deserialize)]
pub(in crate::doors::http) struct Fields {
    act: String,
    toml: String,
    /// The name to keep it under, and the one under which it was kept when it was opened.
    name: Option<String>,
    opened: Option<String>,
}

/// What becomes of a press.
enum Done {
    Checked(Vec<Finding>),
    Used,
    Kept,
    /// A hall is kept no more, and this was it.
    Discarded(String),
    /// Another hall is kept under the name.
    Another,
}

/// `POST simulator/editor`
pub(in crate::doors::http) async fn act(asker: Asker, HallForm(mut fields): HallForm<Fields>) -> Response {
    // Browsers send text with the line ends of old terminals.
    fields.toml = fields.toml.replace("\r\n", "\n");
    let name = fields.name.as_deref().unwrap_or_default().trim().to_owned();
    let done = acted(&asker, &fields, &name).await;
    let is_opened = fields.opened.as_deref() == Some(&*name);
    let page = Page { name: name.clone(), is_opened, ..Page::of(&asker, fields.toml) };
    let language = asker.language;
    match done {
        Ok(Done::Checked(findings)) => html(&Page { findings: Some(findings), ..page }).into_response(),
        Ok(Done::Used) => Redirect::to("/simulator").into_response(),
        Ok(Done::Kept) => Redirect::to(&format!("/simulator/editor?hall={name}")).into_response(),
        Ok(Done::Discarded(toml)) => {
            let done = Some(language.say("halls-discarded").with("name", &name).markup());
            html(&Page { toml, done, is_opened: false, ..page }).into_response()
        }
        Ok(Done::Another) => {
            let why = Some(language.say("halls-another-kept").with("name", &name).to_string());
            (StatusCode::CONFLICT, html(&Page { why, gives_way: true, ..page })).into_response()
        }
        Err(problem) => {
            let page = Page { why: Some(asker.in_words(&problem)), ..page };
            let mut response = (problem.status(), html(&page)).into_response();
            problem.tell_gate(&mut response);
            response
        }
    }
}

async fn acted(asker: &Asker, Fields { act, toml, opened, .. }: &Fields, name: &str) -> Result<Done, Problem> {
    let simulator = || Arc::clone(&asker.simulator);
    let issuer = || asker.issuer(door::CONSOLE);
    match act.as_str() {
        "check" => {
            let read = read_hall(&asker.door, "hall.toml".to_owned(), toml.as_bytes().to_vec()).await?;
            Ok(Done::Checked(read.findings))
        }
        "use" => {
            let hall = OtherHall { source: HallSource::Toml(toml.clone()), seed: None };
            Asker::done(simulator().put_down(hall, issuer())).await?;
            Ok(Done::Used)
        }
        "keep" if opened.as_deref() != Some(name) && simulator().kept_halls().iter().any(|kept| kept == name) => {
            Ok(Done::Another)
        }
        "keep" | "replace" => {
            Asker::done(simulator().keep(name.to_owned(), toml.clone(), issuer())).await?;
            Ok(Done::Kept)
        }
        "discard" => {
            let was = offered_hall(asker, name).await?.unwrap_or_default();
            Asker::done(simulator().discard(name.to_owned(), issuer())).await?;
            Ok(Done::Discarded(was))
        }
        other => Err(Problem::not_found(format!("the editor has no button {:?}", in_short(other)))),
    }
}
