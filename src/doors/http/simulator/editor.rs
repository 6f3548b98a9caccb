//! The editor of halls as a page. Without scripts it is a text field with the hall file, which can be checked and used; with them `editor.js`
//! draws the same text.

use std::sync::Arc;

use askama::Template;
use axum::response::{IntoResponse, Redirect, Response};
use serde::Deserialize;

use super::super::console::html;
use super::super::problem::Problem;
use super::super::query::Query;
use super::super::reading::HallForm;
use super::{Asker, offered_hall, read_hall};
use crate::api::door;
use crate::api::fields::in_short;
use crate::api::hall_files::{Finding, Found};
use crate::phrases::{Language, Phrase};
use crate::runtime::simulator::{HallSource, OtherHall};

#[derive(Template)]
#[template(path = "simulator/editor.html")]
struct Page {
    language: Language,
    toml: String,
    halls: Vec<String>,
    bound: Option<String>,
    may_act: bool,
    /// What is wrong with it, in words.
    why: Option<String>,
    /// What a search would not come to; `None` when it was not checked.
    findings: Option<Vec<Finding>>,
}

impl Page {
    fn of(asker: &Asker, toml: String) -> Page {
        let (halls, bound, may_act) = (asker.simulator.halls(), asker.bound_in_words(), asker.may_act());
        Page { language: asker.language, toml, halls, bound, may_act, why: None, findings: None }
    }

    fn said(&self, finding: &Finding) -> String {
        let text = in_words(self.language, &finding.found);
        let at = self.language.say("editor-at").with("column", finding.column + 1).with("row", finding.row + 1);
        at.with("text", text).to_string()
    }
}

/// As the script says it too.
pub(super) fn in_words(language: Language, found: &Found) -> Phrase<'_> {
    let phrase = language.say_of("editor-found", found.code());
    match found {
        Found::PieceUnreached { name, x, y } => phrase.with("name", name).with("x", x).with("y", y),
        Found::CellUnreached { x, y } => phrase.with("x", x).with("y", y),
        Found::More { count } => phrase.with("count", count),
        Found::NoLuggage => phrase,
    }
}

/// `GET simulator/editor`: the hall that is simulated, or one that is offered.
pub(in crate::doors::http) async fn editor(asker: Asker, query: Query) -> Result<Response, Problem> {
    query.only(&["hall"])?;
    let toml = match query.every("hall").first() {
        Some(name) => offered_hall(&asker, name).await??,
        None => asker.state().hall.toml.to_string(),
    };
    Ok(html(&Page::of(&asker, toml)).into_response())
}

#[derive(Debug, Deserialize)]
pub(in crate::doors::http) struct Fields {
    act: String,
    toml: String,
}

/// `POST simulator/editor`
pub(in crate::doors::http) async fn use_edited(asker: Asker, HallForm(fields): HallForm<Fields>) -> Response {
    // Browsers send text with the line ends of old terminals.
    let toml = fields.toml.replace("\r\n", "\n");
    match acted(&asker, &fields.act, &toml).await {
        Ok(Some(findings)) => html(&Page { findings: Some(findings), ..Page::of(&asker, toml) }).into_response(),
        Ok(None) => Redirect::to("/simulator").into_response(),
        Err(problem) => {
            let page = Page { why: Some(asker.in_words(&problem)), ..Page::of(&asker, toml) };
            let mut response = (problem.status(), html(&page)).into_response();
            problem.tell_gate(&mut response);
            response
        }
    }
}

/// What was found, or nothing when the hall is used.
async fn acted(asker: &Asker, act: &str, toml: &str) -> Result<Option<Vec<Finding>>, Problem> {
    match act {
        "check" => {
            let read = read_hall(&asker.door, "hall.toml".to_owned(), toml.as_bytes().to_vec()).await?;
            Ok(Some(read.findings))
        }
        "use" => {
            let hall = OtherHall { source: HallSource::Toml(toml.to_owned()), seed: None };
            Asker::done(Arc::clone(&asker.simulator).put_down(hall, asker.issuer(door::CONSOLE))).await?;
            Ok(None)
        }
        other => Err(Problem::not_found(format!("the editor has no button {:?}", in_short(other)))),
    }
}
