//! Answers with status 304 if the client already has the current version. To detect this, each answer has a weak tag
//! `W/"run-revision-format"`. The tags are weak because the same state may be sent compressed or uncompressed.

use std::hash::{DefaultHasher, Hash, Hasher};

use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

pub(super) fn tag(run: &str, revision: impl std::fmt::Display, format: &str) -> String {
    format!("W/\"{run}-{revision}-{format}\"")
}

/// Answers 304 when the client already has this version, otherwise with the result of `body`. Both answers carry the
/// tag, and tell the client to ask again before each use (`no-cache`).
pub(super) fn conditional(request: &HeaderMap, tag: &str, body: impl FnOnce() -> Response) -> Response {
    let mut response = if is_known(request, tag) { StatusCode::NOT_MODIFIED.into_response() } else { body() };
    let tag = HeaderValue::from_str(tag).expect("a tag is a run id, a number and a format, all printable");
    response.headers_mut().insert(header::ETAG, tag);
    response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    response
}

/// Like `conditional`, for content that has no revision: the tag is computed from the content.
pub(super) fn by_content(request: &HeaderMap, media_type: &'static str, body: String) -> Response {
    let tag = tag_of(&body);
    conditional(request, &tag, || ([(header::CONTENT_TYPE, media_type)], body).into_response())
}

pub(super) fn tag_of(content: &str) -> String {
    let mut hasher = DefaultHasher::new();
    content.hash(&mut hasher);
    format!("W/\"{:016x}\"", hasher.finish())
}

/// Whether the header `If-None-Match` contains the tag. Compares weakly (RFC 9110, section 13.1.2).
pub(super) fn is_known(request: &HeaderMap, tag: &str) -> bool {
    let opaque = |text: &str| text.trim().trim_start_matches("W/").to_owned();
    let values = request.get_all(header::IF_NONE_MATCH).iter().filter_map(|value| value.to_str().ok());
    values.flat_map(|value| value.split(',')).any(|known| known.trim() == "*" || opaque(known) == opaque(tag))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(if_none_match: &str) -> bool {
        let mut headers = HeaderMap::new();
        headers.insert(header::IF_NONE_MATCH, if_none_match.parse().unwrap());
        is_known(&headers, &tag("k3", 12, "json"))
    }

    #[test]
    fn a_tag_is_known_weakly_or_strongly_alone_or_in_a_list_or_by_a_star() {
        assert!(known("W/\"k3-12-json\""));
        assert!(known("\"k3-12-json\""));
        assert!(known("\"other\", W/\"k3-12-json\""));
        assert!(known("*"));
    }

    #[test]
    fn another_revision_run_or_format_is_not_known() {
        assert!(!known("W/\"k3-11-json\""));
        assert!(!known("W/\"k4-12-json\""));
        assert!(!known("W/\"k3-12-text\""));
        assert!(!is_known(&HeaderMap::new(), &tag("k3", 12, "json")));
    }
}
