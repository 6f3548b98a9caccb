//! Reading what a request carries: JSON bodies, form bodies and numbers in paths, bounded in size and time, every failure a
//! `Problem` in words. What the fields mean stands in `crate::wire::command`.

use std::time::Duration;

use axum::body::Bytes;
use axum::extract::{FromRequest, FromRequestParts, Path, Request};
use axum::http::request::Parts;
use axum::http::{HeaderMap, header};
use serde::de::DeserializeOwned;

use super::problem::Problem;

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

impl<S: Send + Sync, T: DeserializeOwned> FromRequest<S> for Json<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<Json<T>, Problem> {
        let (headers, body) = body_of(request).await?;
        if body.is_empty() {
            return Err(Problem::malformed("the body is empty: this command needs JSON, see docs/http.md".to_owned()));
        }
        json(&headers, &body).map(Json)
    }
}

impl<S: Send + Sync, T: DeserializeOwned + Default> FromRequest<S> for OptionalJson<T> {
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
        read.map(|axum::Form(fields)| Form(fields)).map_err(|rejection| Problem::unusable(rejection.body_text()))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for Number {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Number, Problem> {
        let path = parts.uri.path().to_owned();
        let missing = || Problem::not_found(format!("there is nothing at {path}: a number belongs there, as 3"));
        let Path(text) = Path::<String>::from_request_parts(parts, state).await.map_err(|_| missing())?;
        text.parse().map(Number).map_err(|_| missing())
    }
}

async fn body_of(request: Request) -> Result<(HeaderMap, Bytes), Problem> {
    let (parts, body) = request.into_parts();
    let read = tokio::time::timeout(BODY_TIME, axum::body::to_bytes(body, BODY_BYTES)).await;
    let read = read.map_err(|_| Problem::too_slow(format!("the body did not arrive within {} s", BODY_TIME.as_secs())))?;
    let body = read.map_err(|error| unread(&error))?;
    Ok((parts.headers, body))
}

fn unread(error: &axum::Error) -> Problem {
    let words = error.to_string();
    if words.contains("length limit") {
        Problem::too_large(format!("the body is larger than {BODY_BYTES} bytes: a command is a few dozen"))
    } else {
        Problem::malformed(format!("the body could not be read: {words}"))
    }
}

fn json<T: DeserializeOwned>(headers: &HeaderMap, body: &[u8]) -> Result<T, Problem> {
    let named = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or("none");
    let media = named.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
    if media != "application/json" && !(media.starts_with("application/") && media.ends_with("+json")) {
        return Err(Problem::wrong_type(format!("the content type is {named}: send application/json")));
    }
    serde_json::from_slice(body).map_err(|error| {
        if error.is_data() {
            Problem::unusable(format!("the JSON does not fit this command: {error}"))
        } else {
            Problem::malformed(format!("the body is not JSON: {error}"))
        }
    })
}

fn form_type(headers: &HeaderMap) -> Result<axum::http::HeaderValue, Problem> {
    let form = axum::http::HeaderValue::from_static("application/x-www-form-urlencoded");
    match headers.get(header::CONTENT_TYPE) {
        None => Ok(form),
        Some(named) if named.as_bytes().starts_with(form.as_bytes()) => Ok(form),
        Some(named) => {
            let named = String::from_utf8_lossy(named.as_bytes()).into_owned();
            Err(Problem::wrong_type(format!("the content type is {named}: a form is {form:?}")))
        }
    }
}
