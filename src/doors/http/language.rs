//! The language of a page. The language switch stores a language in a cookie. Without the cookie, the browser's
//! preferred language is used, otherwise English.

use std::convert::Infallible;

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Redirect, Response};
use serde::Deserialize;

use super::accept::range;
use super::peer::{LetIn, Peer, cookies};
use super::prefix::local;
use super::problem::Problem;
use super::reading::Form;
use crate::access::Caller;
use crate::phrases::Language;

const COOKIE: &str = "hallsweep-language";

/// Lifetime of the language cookie in seconds: a year.
const REMEMBERED_S: u32 = 365 * 24 * 3600;

pub(super) struct Spoken(pub(super) Language);

#[derive(Debug, Deserialize)]
pub(super) struct Choice {
    language: String,
    next: Option<String>,
}

pub(super) struct PageReader {
    pub(super) caller: Caller,
    pub(super) language: Language,
}

impl<S: Send + Sync> FromRequestParts<S> for PageReader {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<PageReader, Problem> {
        let LetIn(caller) = LetIn::from_request_parts(parts, state).await?;
        Ok(PageReader::new(caller, &parts.headers))
    }
}

impl PageReader {
    pub(super) fn new(caller: Caller, headers: &HeaderMap) -> PageReader {
        PageReader { caller, language: spoken(headers) }
    }
}

impl<S: Send + Sync> FromRequestParts<S> for Spoken {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Spoken, Infallible> {
        Ok(Spoken(spoken(&parts.headers)))
    }
}

pub(super) fn spoken(headers: &HeaderMap) -> Language {
    cookies(headers, COOKIE).find_map(Language::tagged).unwrap_or_else(|| asked_for(headers))
}

/// Returns the language with the highest quality in the header `Accept-Language` (RFC 9110, section 12.5.4). Of
/// several with the same quality, the first one wins.
fn asked_for(headers: &HeaderMap) -> Language {
    let values = headers.get_all(header::ACCEPT_LANGUAGE).iter().filter_map(|value| value.to_str().ok());
    let wishes = values.flat_map(|value| value.split(',')).filter_map(range);
    let known = wishes.filter_map(|(tag, quality)| Some((Language::tagged(tag)?, quality))).filter(|(_, quality)| *quality > 0.0);
    let most = known.reduce(|best, next| if next.1 > best.1 { next } else { best });
    most.map_or(Language::English, |(language, _)| language)
}

pub(super) async fn choose(peer: Peer, Form(choice): Form<Choice>) -> Result<Response, Problem> {
    let Some(language) = Language::ALL.into_iter().find(|language| language.tag() == choice.language) else {
        return Err(Problem::unusable("language is en or it".to_owned()));
    };
    let secure = if peer.is_encrypted { "; Secure" } else { "" };
    let cookie = format!("{COOKIE}={}; Max-Age={REMEMBERED_S}; HttpOnly; SameSite=Lax{secure}", language.tag());
    let cookie = HeaderValue::from_str(&cookie).expect("a tag is two letters");
    Ok(([(header::SET_COOKIE, cookie)], Redirect::to(local(choice.next.as_deref()))).into_response())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{app, leads, text};
    use super::*;
    use crate::api::tests::fixture::searching;

    #[track_caller]
    fn check(headers: &[(&'static str, &str)], expect: Language) {
        let headers = headers.iter().map(|(name, value)| (name.parse().unwrap(), value.parse().unwrap()));
        assert_eq!(spoken(&HeaderMap::from_iter(headers)), expect);
    }

    #[test]
    fn the_browser_is_heard_and_the_switch_more() {
        check(&[], Language::English);
        check(&[("accept-language", "it")], Language::Italian);
        check(&[("accept-language", "it-CH, it;q=0.9, en;q=0.8")], Language::Italian);
        check(&[("accept-language", "de, en;q=0.5, it;q=0.6")], Language::Italian);
        check(&[("accept-language", "de;q=1, *;q=0.5")], Language::English);
        check(&[("accept-language", "it;q=0, fr")], Language::English);
        check(&[("accept-language", "it;q=nonsense")], Language::English);
        check(&[("accept-language", "it"), ("cookie", "a=b; hallsweep-language=en")], Language::English);
        check(&[("accept-language", "it"), ("cookie", "hallsweep-language=xx")], Language::Italian);
    }

    #[tokio::test]
    async fn what_programs_read_is_english_whatever_is_asked_for() {
        let app = app(searching());
        let italian = [("accept-language", "it"), ("cookie", "hallsweep-language=it")];
        for path in
            ["/api/v1/state", "/api/v1/log", "/api/v1/missions/1/events", "/api/v1/missions/1/timeline", "/api/v1/luggage/99"]
        {
            let answers = [app.get(path).await, app.send("GET", path, &italian, "").await];
            let [english, asked] = futures_util::future::join_all(answers.map(text)).await.try_into().unwrap();
            assert_eq!(asked, english, "{path}");
        }
        app.refuse(hallsweep_core::refused::Refused::Moving);
        let refused = text(app.send("POST", "/api/v1/commands/start", &italian, "").await).await;
        assert!(refused.contains("the robot is moving: press STOP first"), "{refused}");
        app.refuse(hallsweep_core::refused::Refused::Moving);
        let headers = [italian[0], ("accept", "application/json"), ("content-type", "application/x-www-form-urlencoded")];
        let refused = text(app.send("POST", "/console/start", &headers, "epoch=7").await).await;
        assert!(refused.contains("il robot si muove: prima premere STOP") && refused.contains("\"moving\""), "{refused}");
    }

    #[tokio::test]
    async fn who_keeps_pages_for_others_is_told_that_they_differ() {
        for path in ["/", "/missions", "/missions/1/moment", "/nowhere"] {
            let page = app(searching()).send("GET", path, &[("accept", "text/html")], "").await;
            assert!(page.headers().get_all("vary").iter().any(|vary| vary == "accept-language, cookie"), "{path}");
        }
    }

    #[tokio::test]
    async fn the_switch_is_on_every_page_and_leads_back_to_it() {
        let app = app(searching());
        for (page, leads) in [
            ("/", "/"),
            ("/missions", "/missions"),
            ("/missions?before=2", "/missions?before=2"),
            ("/missions/1", "/missions/1"),
            ("/missions/1?show=all", "/missions/1?show=all"),
            ("/missions/1/moment?at=4", "/missions/1/moment?at=4"),
            ("/missions/1/retrieval", "/missions/1/retrieval"),
            ("/luggage/1", "/luggage/1"),
            ("/laboratory", "/laboratory"),
            ("/nowhere", "/nowhere"),
        ] {
            let shown = text(app.send("GET", page, &[("accept", "text/html")], "").await).await;
            let (_, switch) = shown.split_once("action=\"./language\"").unwrap_or_else(|| panic!("{page} has none: {shown}"));
            let next = switch.split_once("name=\"next\" value=\"").and_then(|(_, next)| next.split('"').next());
            assert_eq!(next, Some(leads), "{page}");
        }
    }

    #[tokio::test]
    async fn the_switch_remembers_and_leads_back_and_nowhere_else() {
        let app = app(searching());
        for (next, leads_to) in [("/missions/1/moment?at=4", "/missions/1/moment?at=4"), ("//elsewhere.example/", "/")] {
            let body = format!("language=it&next={}", next.replace('/', "%2F").replace('?', "%3F").replace('=', "%3D"));
            let answer = app.form("/language", &body).await;
            assert_eq!((answer.status().as_u16(), &*leads(&answer, "/language")), (303, leads_to));
            assert!(answer.headers()["set-cookie"].to_str().unwrap().starts_with("hallsweep-language=it; Max-Age="));
        }
        assert_eq!(app.form("/language", "language=tlh").await.status(), 422);
    }
}
