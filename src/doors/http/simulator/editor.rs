//! The editor of halls as a page. Without scripts it is a text field with the hall file, with buttons to check and
//! use it. With scripts, `editor.js` draws the same hall.

use std::sync::Arc;

use askama::Template;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Redirect, Response};
use serde::Deserialize;

use super::super::console::html;
use super::super::problem::Problem;
use super::super::query::Query;
use super::super::reading::{HALL_BYTES, HallForm, too_large};
use super::{ANOTHER_KEPT, Asker, offered_hall, read_hall};
use crate::api::door;
use crate::api::fields::in_short;
use crate::api::hall_files::{Finding, Found, Place};
use crate::phrases::{Language, Markup, Phrase};
use crate::runtime::simulator::{HallSource, NotSimulated, OtherHall};

#[derive(Template)]
#[template(path = "simulator/editor.html")]
struct EditorPage {
    language: Language,
    toml: String,
    /// The halls that are always offered. The stored halls are in `kept`.
    halls: Vec<String>,
    kept: Vec<String>,
    name: String,
    /// The name under which the opened hall is stored, if it is stored.
    opened: Option<String>,
    /// The stored hall that would be replaced. The page asks for confirmation.
    replaces: Option<String>,
    /// The stored hall that would be deleted. The page asks for confirmation.
    discards: Option<String>,
    bound: Option<String>,
    may_act: bool,
    done: Option<Markup>,
    why: Option<String>,
    /// What a search would not reach in this hall. `None` when the hall was not checked.
    findings: Option<Vec<Finding>>,
}

impl EditorPage {
    fn of(asker: &Asker, toml: String) -> EditorPage {
        let kept = asker.simulator.kept_halls();
        EditorPage {
            language: asker.language,
            toml,
            halls: asker.simulator.halls().into_iter().filter(|name| !kept.contains(name)).collect(),
            kept,
            name: String::new(),
            opened: None,
            replaces: None,
            discards: None,
            bound: asker.bound_in_words(),
            may_act: asker.may_act(),
            done: None,
            why: None,
            findings: None,
        }
    }

    fn opened(self, name: &str) -> EditorPage {
        if !self.kept.iter().any(|kept| kept == name) {
            return self;
        }
        let done = Some(self.language.say("halls-opened").with("name", name).markup());
        EditorPage { name: name.to_owned(), opened: Some(name.to_owned()), done, ..self }
    }

    fn said(&self, finding: &Finding) -> String {
        let text = in_words(self.language, &finding.found);
        let Some(Place { x, y, .. }) = finding.at else { return text.to_string() };
        self.language.say("editor-at").with("x", x).with("y", y).with("text", text).to_string()
    }
}

/// Returns the text of a finding. The script uses the same sentences.
pub(super) fn in_words(language: Language, found: &Found) -> Phrase<'_> {
    let phrase = language.say_of("editor-found", found.code());
    match found {
        Found::PieceUnreached { name } => phrase.with("name", name),
        Found::More { count } => phrase.with("count", count),
        Found::CellUnreached | Found::NoLuggage => phrase,
    }
}

/// `GET simulator/editor`: opens the simulated hall, or one of the offered halls.
pub(in crate::doors::http) async fn editor(asker: Asker, query: Query) -> Result<Response, Problem> {
    query.only(&["hall"])?;
    let page = match query.every("hall").first() {
        Some(name) => EditorPage::of(&asker, offered_hall(&asker, name).await??).opened(name),
        None => {
            let hall = asker.state().hall.clone();
            match NotSimulated::too_large(hall.size.0, hall.size.1).map(Problem::from) {
                Some(problem) => EditorPage { why: Some(asker.in_words(&problem)), ..EditorPage::of(&asker, String::new()) },
                None => EditorPage::of(&asker, hall.toml.to_string()),
            }
        }
    };
    Ok(html(&page).into_response())
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::doors::http) struct Fields {
    toml: String,
    /// The name typed for storing the hall. `opened` is the name under which it is already stored.
    name: String,
    opened: Option<String>,
    /// `act` is the button `check`, `use` or `keep`, if one of these was pressed. Each of the other three fields is a
    /// button with the name of a hall: to replace the hall, to delete it, and to confirm the deletion.
    act: Option<String>,
    replace: Option<String>,
    discard: Option<String>,
    discard_for_good: Option<String>,
}

enum Done {
    Checked(Vec<Finding>),
    Used,
    Kept(String),
    AsksToReplace(String),
    AsksToDiscard(String),
    Discarded(String),
}

/// `POST simulator/editor`: carries out the pressed button. The text in the field stays, even after a refusal.
pub(in crate::doors::http) async fn act(asker: Asker, HallForm(mut fields): HallForm<Fields>) -> Response {
    // Browsers send line ends as CRLF.
    fields.toml = fields.toml.replace("\r\n", "\n");
    let done = acted(&asker, &fields).await;
    let Fields { toml, name, opened, .. } = fields;
    let page = EditorPage { name, opened, ..EditorPage::of(&asker, toml) };
    let said = |id, name: &str| Some(asker.language.say(id).with("name", name).markup());
    match done {
        Ok(Done::Checked(findings)) => html(&EditorPage { findings: Some(findings), ..page }).into_response(),
        Ok(Done::Used) => Redirect::to("/simulator").into_response(),
        Ok(Done::Kept(name)) => Redirect::to(&format!("/simulator/editor?hall={name}")).into_response(),
        Ok(Done::AsksToReplace(name)) => {
            let done = said("halls-another-kept", &name);
            (StatusCode::CONFLICT, html(&EditorPage { done, replaces: Some(name), ..page })).into_response()
        }
        Ok(Done::AsksToDiscard(name)) => {
            let done = said("halls-discard-asked", &name);
            html(&EditorPage { done, discards: Some(name), ..page }).into_response()
        }
        Ok(Done::Discarded(name)) => {
            let opened = page.opened.filter(|opened| *opened != name);
            html(&EditorPage { done: said("halls-discarded", &name), opened, ..page }).into_response()
        }
        Err(problem) => {
            let page = EditorPage { why: Some(asker.in_words(&problem)), ..page };
            let mut response = (problem.status(), html(&page)).into_response();
            problem.tell_gate(&mut response);
            response
        }
    }
}

async fn acted(asker: &Asker, fields: &Fields) -> Result<Done, Problem> {
    let simulator = || Arc::clone(&asker.simulator);
    let issuer = || asker.issuer(door::CONSOLE);
    if fields.toml.len() > HALL_BYTES {
        return Err(too_large(HALL_BYTES));
    }
    if let Some(name) = &fields.discard {
        return Ok(Done::AsksToDiscard(in_short(name)));
    }
    if let Some(name) = &fields.discard_for_good {
        Asker::done(simulator().discard(name.clone(), issuer())).await?;
        return Ok(Done::Discarded(name.clone()));
    }
    let act = if fields.replace.is_some() { "keep" } else { fields.act.as_deref().unwrap_or_default() };
    match act {
        "check" => {
            let read = read_hall(&asker.door, "hall.toml".to_owned(), fields.toml.clone().into()).await?;
            Ok(Done::Checked(read.findings))
        }
        "use" => {
            let hall = OtherHall { source: HallSource::Toml(fields.toml.clone()), seed: None };
            Asker::done(simulator().put_down(hall, issuer())).await?;
            Ok(Done::Used)
        }
        "keep" => {
            let name = fields.name.trim().to_owned();
            let may_replace = [&fields.opened, &fields.replace].into_iter().any(|may| may.as_ref() == Some(&name));
            match Asker::done(simulator().keep(name.clone(), fields.toml.clone(), may_replace, issuer())).await {
                Ok(_) => Ok(Done::Kept(name)),
                Err(problem) if problem.code() == ANOTHER_KEPT => Ok(Done::AsksToReplace(name)),
                Err(problem) => Err(problem),
            }
        }
        other => Err(Problem::not_found(format!("the editor has no button {:?}", in_short(other)))),
    }
}
