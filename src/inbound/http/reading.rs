//! Reading what a request carries: JSON bodies, form bodies and numbers in paths, bounded in size and time, every failure a
//! `Problem` in words. What the fields mean stands in `crate::wire::command`.

use std::time::Duration;

use axum::body::Bytes;
use axum::extract::{FromRequest, FromRequestParts, Path, Request};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderValue, header};
use serde::de::DeserializeOwned;

use super::problem::Problem;
use crate::wire::fields::{self, Body, Unread, in_short};

/// The largest body that is read: a command is a few dozen bytes.
pub(super) const BODY_BYTES: usize = 16 * 1024;

/// How long a body may take to arrive.
const BODY_TIME: Duration = Duration::from_secs(5);

/// A JSON body.
pub(super) struct Json<T>(pub(super) T);

/// A JSON body that may be absent; an empty one is the default.
pub(super) struct OptionalJson<T>(pub(super) T);

/// The fields of a form.
pub(super) struct Form<T>(pub(super) T);

/// The number of a thing, from the path.
pub(super) struct Number(pub(super) u64);

impl<S: Send + Sync, T: Body> FromRequest<S> for Json<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<Json<T>, Problem> {
        let (headers, body) = body_of(request).await?;
        if body.is_empty() {
            return Err(Problem::malformed("the body is empty: this command needs JSON, see docs/http.md".to_owned()));
        }
        json(&headers, &body).map(Json)
    }
}

impl<S: Send + Sync, T: Body + Default> FromRequest<S> for OptionalJson<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<OptionalJson<T>, Problem> {
        let (headers, body) = body_of(request).await?;
        let value = if body.is_empty() { T::default() } else { json(&headers, &body)? };
        Ok(OptionalJson(value))
    }
}

impl<S: Send + Sync, T: DeserializeOwned> FromRequest<S> for Form<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Form<T>, Problem> {
        let (headers, body) = body_of(request).await?;
        let mut whole = Request::new(axum::body::Body::from(body));
        *whole.method_mut() = axum::http::Method::POST;
        let form = HeaderMap::from_iter([(header::CONTENT_TYPE, form_type(&headers)?)]);
        *whole.headers_mut() = form;
        let read = axum::Form::<T>::from_request(whole, state).await;
        read.map(|axum::Form(fields)| Form(fields))
            .map_err(|_| Problem::unusable("the form cannot be read: send each of its fields once".to_owned()))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for Number {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Number, Problem> {
        let path = in_short(parts.uri.path());
        let missing = || Problem::not_found(format!("there is nothing at {path}: a number belongs there, as 3"));
        let Path(text) = Path::<String>::from_request_parts(parts, state).await.map_err(|_| missing())?;
        text.parse().map(Number).map_err(|_| missing())
    }
}

async fn body_of(request: Request) -> Result<(HeaderMap, Bytes), Problem> {
    let (parts, body) = request.into_parts();
    let announced = parts.headers.get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if announced.is_some_and(|length| length > BODY_BYTES as u64) {
        return Err(too_large());
    }
    let read = tokio::time::timeout(BODY_TIME, axum::body::to_bytes(body, BODY_BYTES)).await;
    let read = read.map_err(|_| Problem::too_slow(format!("the body did not arrive within {} s", BODY_TIME.as_secs())))?;
    let body = read.map_err(|error| unread(&error))?;
    Ok((parts.headers, body))
}

fn unread(error: &axum::Error) -> Problem {
    let words = error.to_string();
    if words.contains("length limit") { too_large() } else { Problem::malformed(format!("the body could not be read: {words}")) }
}

fn too_large() -> Problem {
    Problem::too_large(format!("the body is larger than {BODY_BYTES} bytes: a command is a few dozen"))
}

fn json<T: Body>(headers: &HeaderMap, body: &[u8]) -> Result<T, Problem> {
    let media = media_type(headers)?.unwrap_or_else(|| "none".to_owned());
    if media != "application/json" && !(media.starts_with("application/") && media.ends_with("+json")) {
        return Err(Problem::wrong_type(format!("the content type is {}: send application/json", in_short(&media))));
    }
    fields::body(body).map_err(|unread| match unread {
        Unread::Malformed(words) => Problem::malformed(words),
        Unread::Unusable(unusable) => unusable.into(),
    })
}

fn form_type(headers: &HeaderMap) -> Result<HeaderValue, Problem> {
    const FORM: &str = "application/x-www-form-urlencoded";
    match media_type(headers)? {
        Some(named) if named != FORM => {
            Err(Problem::wrong_type(format!("the content type is {}: a form is {FORM}", in_short(&named))))
        }
        _ => Ok(HeaderValue::from_static(FORM)),
    }
}

/// The named media type in small letters, without its parameters; text in anything but UTF-8 is not read.
fn media_type(headers: &HeaderMap) -> Result<Option<String>, Problem> {
    let Some(named) = headers.get(header::CONTENT_TYPE) else { return Ok(None) };
    let named = String::from_utf8_lossy(named.as_bytes()).to_ascii_lowercase();
    let mut parts = named.split(';').map(str::trim);
    let media = parts.next().unwrap_or_default().to_owned();
    let charset = parts.find_map(|part| part.strip_prefix("charset=")).map(|charset| charset.trim_matches('"'));
    match charset {
        Some(charset) if charset != "utf-8" && charset != "utf8" => {
            Err(Problem::wrong_type(format!("the charset is {}: send utf-8", in_short(charset))))
        }
        _ => Ok(Some(media)),
    }
}
