//! Reads the contents of a request: JSON bodies, form bodies and numbers in paths. Size and time are limited. Every
//! failure is a `Problem` with a text. `crate::api::command` has the fields.

use std::borrow::Cow;
use std::io::Read;
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::extract::{FromRequest, FromRequestParts, Multipart, Path, Request};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderValue, header};
use bytes::BytesMut;
use flate2::read::GzDecoder;
use futures_util::StreamExt;
use serde::de::DeserializeOwned;

use super::problem::Problem;
use crate::api::commands::Payload;
use crate::api::fields::{self, Body as Fields, Unread, in_short};

/// Maximum size of a body in bytes. A command has only a few dozen bytes.
pub(super) const BODY_BYTES: usize = 16 * 1024;

/// Maximum size of a form in bytes. The names of all areas fit, with every letter as `%F0%9F%9A%AA`.
const FORM_BYTES: usize = 32 * 1024;

/// Maximum size of a hall in bytes, enough for a hall of 250 × 250 cells. A hall and its head together fit into the
/// buffer of `hearing::connection` (`AHEAD`).
pub(super) const HALL_BYTES: usize = 64 * 1024;

/// Maximum size in bytes of a compressed hall file after unpacking. A large image fits.
const UNPACKED_BYTES: u64 = 4 * 1024 * 1024;

/// Maximum size of all fields of a form other than the hall, in bytes.
const BESIDE_HALL: usize = 4 * 1024;

/// Time before the rate of a body is checked for the first time.
const BODY_BEGIN: Duration = Duration::from_secs(2);

/// Minimum rate of a body after `BODY_BEGIN`, in bytes per second. A command is complete or refused within six
/// seconds, a hall within twenty.
const BODY_RATE: usize = 4 * 1024;

pub(super) struct JsonPayload {
    headers: HeaderMap,
    body: Bytes,
}

/// A JSON body that contains a hall, at most `HALL_BYTES` long.
pub(super) struct HallPayload(pub(super) JsonPayload);

/// A hall file as it was sent, at most `HALL_BYTES` long. A larger file can be sent compressed.
pub(super) struct HallFile {
    bytes: Bytes,
    is_packed: bool,
}

pub(super) struct Form<T>(pub(super) T);

/// The fields of a form that contains a hall. The body has at most `HALL_BYTES + BESIDE_HALL` bytes.
pub(super) struct HallForm<T>(pub(super) T);

pub(super) struct Named(pub(super) String);

pub(super) struct Number(pub(super) u64);

impl<S: Send + Sync> FromRequest<S> for JsonPayload {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<JsonPayload, Problem> {
        let (headers, body) = body_of(request, BODY_BYTES).await?;
        Ok(JsonPayload { headers, body })
    }
}

impl<S: Send + Sync> FromRequest<S> for HallPayload {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<HallPayload, Problem> {
        let (headers, body) = body_of(request, HALL_BYTES).await?;
        Ok(HallPayload(JsonPayload { headers, body }))
    }
}

impl<S: Send + Sync> FromRequest<S> for HallFile {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<HallFile, Problem> {
        let (headers, bytes) = body_of(request, HALL_BYTES).await?;
        let coding = headers.get(header::CONTENT_ENCODING).map(|coding| String::from_utf8_lossy(coding.as_bytes()));
        match coding.as_deref() {
            None | Some("identity") => Ok(HallFile { bytes, is_packed: false }),
            Some("gzip") => Ok(HallFile { bytes, is_packed: true }),
            Some(other) => Err(Problem::wrong_format(format!("the content encoding is {}: send gzip, or none", in_short(other)))),
        }
    }
}

impl<S: Send + Sync, T: DeserializeOwned> FromRequest<S> for HallForm<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<HallForm<T>, Problem> {
        let (headers, body) = body_of(request, HALL_BYTES + BESIDE_HALL).await?;
        let is_parts = media_type(&headers)?.is_some_and(|media| media == "multipart/form-data");
        let fields = if is_parts { parts(&headers, body, state).await } else { pairs(&headers, body, state).await };
        fields.map(HallForm)
    }
}

impl HallFile {
    /// Returns the unpacked file. Unpacking is slow, so it must not block a thread that others need.
    pub(super) fn unpacked(&self) -> Result<Cow<'_, [u8]>, Problem> {
        if !self.is_packed {
            return Ok(Cow::Borrowed(&self.bytes));
        }
        let mut file = Vec::new();
        let read = GzDecoder::new(&*self.bytes).take(UNPACKED_BYTES + 1).read_to_end(&mut file);
        match read {
            Ok(_) if file.len() as u64 > UNPACKED_BYTES => Err(Problem::too_large(format!(
                "the hall is larger than {UNPACKED_BYTES} bytes unpacked: start hallsweep with --hall FILE"
            ))),
            Ok(_) => Ok(Cow::Owned(file)),
            Err(error) => Err(Problem::malformed(format!("the body cannot be unpacked: {error}"))),
        }
    }
}

impl From<String> for HallFile {
    fn from(text: String) -> HallFile {
        HallFile { bytes: text.into(), is_packed: false }
    }
}

impl Payload for JsonPayload {
    type Problem = Problem;

    fn needed<T: Fields>(&self) -> Result<T, Problem> {
        if self.body.is_empty() {
            return Err(Problem::malformed("the body is empty: this command needs JSON, see docs/http.md".to_owned()));
        }
        json(&self.headers, &self.body)
    }

    fn optional<T: Fields + Default>(&self) -> Result<T, Problem> {
        if self.body.is_empty() { Ok(T::default()) } else { json(&self.headers, &self.body) }
    }
}

impl<S: Send + Sync, T: DeserializeOwned> FromRequest<S> for Form<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Form<T>, Problem> {
        let (headers, body) = body_of(request, FORM_BYTES).await?;
        pairs(&headers, body, state).await.map(Form)
    }
}

/// Reads a form in the usual encoding of browsers, `application/x-www-form-urlencoded`.
async fn pairs<S: Send + Sync, T: DeserializeOwned>(headers: &HeaderMap, body: Bytes, state: &S) -> Result<T, Problem> {
    let read = axum::Form::<T>::from_request(whole(form_type(headers)?, body), state).await;
    read.map(|axum::Form(fields)| fields).map_err(|_| unreadable())
}

/// Reads the fields of a multipart form. This encoding does not enlarge a hall. The usual encoding of forms takes
/// three bytes for every wall.
async fn parts<S: Send + Sync, T: DeserializeOwned>(headers: &HeaderMap, body: Bytes, state: &S) -> Result<T, Problem> {
    let media = headers.get(header::CONTENT_TYPE).cloned().ok_or_else(unreadable)?;
    let mut parts = Multipart::from_request(whole(media, body), state).await.map_err(|_| unreadable())?;
    let mut fields = serde_json::Map::new();
    while let Some(part) = parts.next_field().await.map_err(|_| unreadable())? {
        let name = part.name().unwrap_or_default().to_owned();
        let text = part.text().await.map_err(|_| unreadable())?;
        if fields.insert(name, text.into()).is_some() {
            return Err(unreadable());
        }
    }
    serde_json::from_value(fields.into()).map_err(|_| unreadable())
}

fn whole(media: HeaderValue, body: Bytes) -> Request {
    let mut whole = Request::new(Body::from(body));
    *whole.method_mut() = axum::http::Method::POST;
    *whole.headers_mut() = HeaderMap::from_iter([(header::CONTENT_TYPE, media)]);
    whole
}

fn unreadable() -> Problem {
    Problem::unusable("the form cannot be read: send each of its fields once".to_owned())
}

impl<S: Send + Sync> FromRequestParts<S> for Named {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Named, Problem> {
        let path = in_short(parts.uri.path());
        let missing = |_| Problem::not_found(format!("there is nothing at {path}: the path needs a name"));
        Path::<String>::from_request_parts(parts, state).await.map(|Path(name)| Named(name)).map_err(missing)
    }
}

impl<S: Send + Sync> FromRequestParts<S> for Number {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Number, Problem> {
        let path = in_short(parts.uri.path());
        let missing = || Problem::not_found(format!("there is nothing at {path}: the path needs a number, such as 3"));
        let Path(text) = Path::<String>::from_request_parts(parts, state).await.map_err(|_| missing())?;
        text.parse().map(Number).map_err(|_| missing())
    }
}

async fn body_of(request: Request, most: usize) -> Result<(HeaderMap, Bytes), Problem> {
    let (parts, body) = request.into_parts();
    let announced = parts.headers.get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if announced.is_some_and(|length| length > most as u64) {
        return Err(too_large(most));
    }
    Ok((parts.headers, read(body, most).await?))
}

/// Reads a body. Refuses a body that is larger than `most` bytes or slower than `BODY_RATE`.
async fn read(body: Body, most: usize) -> Result<Bytes, Problem> {
    let (mut pieces, mut read) = (body.into_data_stream(), BytesMut::new());
    let (mut span, mut before) = (BODY_BEGIN, None);
    loop {
        let all = async {
            while let Some(piece) = pieces.next().await {
                let piece = piece.map_err(|error| Problem::malformed(format!("the body could not be read: {error}")))?;
                if read.len() + piece.len() > most {
                    return Err(too_large(most));
                }
                read.extend_from_slice(&piece);
            }
            Ok(())
        };
        match tokio::time::timeout(span, all).await {
            Ok(all) => return all.map(|()| read.freeze()),
            Err(_) if before.is_some_and(|before| read.len() < before + BODY_RATE) => {
                let begin = BODY_BEGIN.as_secs();
                return Err(Problem::too_slow(format!(
                    "the body came too slowly: after {begin} s, send at least {BODY_RATE} bytes a second"
                )));
            }
            Err(_) => (span, before) = (Duration::from_secs(1), Some(read.len())),
        }
    }
}

pub(super) fn too_large(most: usize) -> Problem {
    Problem::too_large(if most < HALL_BYTES {
        format!("the body is larger than {most} bytes: a command needs only a few dozen")
    } else {
        format!("the hall is larger than {HALL_BYTES} bytes: make it smaller, or start hallsweep with --hall FILE")
    })
}

fn json<T: Fields>(headers: &HeaderMap, body: &[u8]) -> Result<T, Problem> {
    let media = media_type(headers)?.unwrap_or_else(|| "none".to_owned());
    if media != "application/json" && !(media.starts_with("application/") && media.ends_with("+json")) {
        return Err(Problem::wrong_format(format!("the content type is {}: send application/json", in_short(&media))));
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
            Err(Problem::wrong_format(format!("the content type is {}: send a form as {FORM}", in_short(&named))))
        }
        _ => Ok(HeaderValue::from_static(FORM)),
    }
}

/// Returns the media type in lower case, without its parameters. A charset other than UTF-8 is refused.
fn media_type(headers: &HeaderMap) -> Result<Option<String>, Problem> {
    let Some(named) = headers.get(header::CONTENT_TYPE) else { return Ok(None) };
    let named = String::from_utf8_lossy(named.as_bytes()).to_ascii_lowercase();
    let mut parts = named.split(';').map(str::trim);
    let media = parts.next().unwrap_or_default().to_owned();
    let charset = parts.find_map(|part| part.strip_prefix("charset=")).map(|charset| charset.trim_matches('"'));
    match charset {
        Some(charset) if charset != "utf-8" && charset != "utf8" => {
            Err(Problem::wrong_format(format!("the charset is {}: send utf-8", in_short(charset))))
        }
        _ => Ok(Some(media)),
    }
}

/// Returns a field of a form without white space at its ends. A missing or empty field is refused.
pub(super) fn needed<'a>(name: &str, value: Option<&'a str>) -> Result<&'a str, Problem> {
    let given = value.map(str::trim).filter(|text| !text.is_empty());
    given.ok_or_else(|| Problem::unusable(format!("{name} is missing: fill it in")))
}

#[cfg(test)]
mod tests {
    use super::super::testing::app;
    use super::*;
    use crate::api::tests::fixture::searching;
    use futures_util::stream;
    use hallsweep_core::world::areas::Area;

    /// Returns the result of reading a body of `pieces` pieces with `bytes` bytes each. There is a pause of `after`
    /// before each piece.
    async fn comes(pieces: usize, bytes: usize, after: Duration) -> Result<usize, u16> {
        let body = Body::from_stream(stream::unfold(0, move |sent| async move {
            tokio::time::sleep(after).await;
            (sent < pieces).then(|| (Ok::<_, std::io::Error>(vec![b'x'; bytes]), sent + 1))
        }));
        read(body, BODY_BYTES).await.map(|body| body.len()).map_err(|problem| problem.status().as_u16())
    }

    /// Safety S9, A5.
    #[tokio::test(start_paused = true)]
    async fn a_body_comes_at_a_least_rate_or_is_refused() {
        let ms = Duration::from_millis;
        assert_eq!(comes(4, 25, ms(400)).await, Ok(100), "a small one has some time");
        assert_eq!(comes(16, 1024, ms(150)).await, Ok(16 * 1024));
        assert_eq!(comes(100, 1, ms(500)).await, Err(408), "a byte now and then is no progress");
        assert_eq!(comes(16, 1024, ms(900)).await, Err(408));
        assert_eq!(comes(1, 100, Duration::MAX).await, Err(408));
        assert_eq!(comes(17, 1024, ms(1)).await, Err(413));
    }

    #[tokio::test]
    async fn the_form_with_the_longest_names_of_all_areas_fits_and_not_much_more() {
        let app = app(searching());
        let letter = |code: usize| char::from_u32(0x2_0000 + u32::try_from(code).unwrap()).unwrap();
        let names = (0..Area::MOST).map(|n| letter(n).to_string().repeat(Area::NAME)).collect::<Vec<_>>();
        let coded: String = names.join("\r\n").bytes().map(|byte| format!("%{byte:02X}")).collect();
        let form = format!("epoch=1&later={}&areas={coded}", &coded[..Area::NAME * 12]);
        assert_eq!(app.form("/console/orderAreas", &form).await.status(), 303, "{} bytes", form.len());
        let larger = format!("{form}&note={}", "x".repeat(2048));
        assert_eq!(app.form("/console/orderAreas", &larger).await.status(), 413, "{} bytes", larger.len());
    }
}
