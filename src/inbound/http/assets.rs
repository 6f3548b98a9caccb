//! Files of the page, built into the program: style, script, icon, vendored library. Nothing is read from the disk.

use std::hash::{DefaultHasher, Hash, Hasher};

use axum::Router;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;

use super::Door;
use super::etag::conditional;

/// One file: its path, its media type, what is in it.
struct Asset {
    path: &'static str,
    media_type: &'static str,
    text: &'static str,
}

static ASSETS: [Asset; 5] = [
    Asset {
        path: "/static/console.css",
        media_type: "text/css; charset=utf-8",
        text: include_str!("../../../static/console.css"),
    },
    Asset {
        path: "/static/console.js",
        media_type: "text/javascript; charset=utf-8",
        text: include_str!("../../../static/console.js"),
    },
    Asset {
        path: "/static/vendor/idiomorph.js",
        media_type: "text/javascript; charset=utf-8",
        text: include_str!("../../../static/vendor/idiomorph.js"),
    },
    Asset { path: "/static/icon.svg", media_type: "image/svg+xml", text: include_str!("../../../static/icon.svg") },
    Asset { path: "/favicon.ico", media_type: "image/svg+xml", text: include_str!("../../../static/icon.svg") },
];

/// A route for each.
pub(super) fn routes() -> Router<Door> {
    ASSETS.iter().fold(Router::new(), |router, asset| {
        let tag = format!("W/\"{:016x}\"", fingerprint(asset.text));
        router.route(asset.path, get(move |headers: HeaderMap| async move { sent(&headers, &tag, asset) }))
    })
}

fn sent(headers: &HeaderMap, tag: &str, asset: &Asset) -> Response {
    conditional(headers, tag, || ([(header::CONTENT_TYPE, asset.media_type)], asset.text).into_response())
}

/// Tells one build's file from another's; nobody is kept out by it.
fn fingerprint(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}
