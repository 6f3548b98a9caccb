//! Files of the web page: style, script, icon, vendored library. They are built into the program. Nothing is read
//! from disk.

use std::hash::{DefaultHasher, Hash, Hasher};

use axum::http::{HeaderMap, Uri, header};
use axum::response::{IntoResponse, Response};

use super::etag::conditional;
use super::problem::Problem;
use crate::api::fields::in_short;

struct Asset {
    path: &'static str,
    media_type: &'static str,
    bytes: &'static [u8],
}

static ASSETS: [Asset; 29] = [
    Asset {
        path: "/static/tokens.css",
        media_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../../../static/tokens.css"),
    },
    Asset {
        path: "/static/shell.css",
        media_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../../../static/shell.css"),
    },
    Asset { path: "/static/map.css", media_type: "text/css; charset=utf-8", bytes: include_bytes!("../../../static/map.css") },
    Asset {
        path: "/static/vendor/inter.woff2",
        media_type: "font/woff2",
        bytes: include_bytes!("../../../static/vendor/inter.woff2"),
    },
    Asset {
        path: "/static/vendor/icons.svg",
        media_type: "image/svg+xml",
        bytes: include_bytes!("../../../static/vendor/icons.svg"),
    },
    Asset {
        path: "/static/console.css",
        media_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../../../static/console.css"),
    },
    Asset {
        path: "/static/console.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/console.js"),
    },
    Asset {
        path: "/static/hall.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/hall.js"),
    },
    Asset {
        path: "/static/time.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/time.js"),
    },
    Asset {
        path: "/static/verdict.css",
        media_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../../../static/verdict.css"),
    },
    Asset {
        path: "/static/photo.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/photo.js"),
    },
    Asset {
        path: "/static/verdict.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/verdict.js"),
    },
    Asset {
        path: "/static/attention.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/attention.js"),
    },
    Asset {
        path: "/static/theme.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/theme.js"),
    },
    Asset {
        path: "/static/words.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/words.js"),
    },
    Asset {
        path: "/static/stop.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/stop.js"),
    },
    Asset {
        path: "/static/bar.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/bar.js"),
    },
    Asset {
        path: "/static/laboratory.css",
        media_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../../../static/laboratory.css"),
    },
    Asset {
        path: "/static/laboratory.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/laboratory.js"),
    },
    Asset {
        path: "/static/pallet.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/pallet.js"),
    },
    Asset {
        path: "/static/replay.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/replay.js"),
    },
    Asset {
        path: "/static/roomba.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/roomba.js"),
    },
    Asset {
        path: "/static/simulator.css",
        media_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../../../static/simulator.css"),
    },
    Asset {
        path: "/static/simulator.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/simulator.js"),
    },
    Asset {
        path: "/static/editor.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/editor.js"),
    },
    Asset {
        path: "/static/trees.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/trees.js"),
    },
    Asset {
        path: "/static/vendor/idiomorph.js",
        media_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../../static/vendor/idiomorph.js"),
    },
    Asset { path: "/static/icon.svg", media_type: "image/svg+xml", bytes: include_bytes!("../../../static/icon.svg") },
    Asset { path: "/favicon.ico", media_type: "image/svg+xml", bytes: include_bytes!("../../../static/icon.svg") },
];

pub(super) async fn file(uri: Uri, headers: HeaderMap) -> Result<Response, Problem> {
    let asset = ASSETS.iter().find(|asset| asset.path == uri.path());
    let asset = asset.ok_or_else(|| Problem::not_found(format!("there is no file at {}", in_short(uri.path()))))?;
    let tag = format!("W/\"{:016x}\"", fingerprint(asset.bytes));
    Ok(conditional(&headers, &tag, || ([(header::CONTENT_TYPE, asset.media_type)], asset.bytes).into_response()))
}

/// Returns a hash of some content, for detecting changes. It gives no security against forged content.
pub(super) fn fingerprint(content: impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    content.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::super::testing::app;
    use super::ASSETS;
    use crate::api::tests::fixture::idle;

    #[tokio::test]
    async fn every_file_of_the_page_can_be_fetched_by_whoever_asks() {
        let app = app(idle());
        for asset in &ASSETS {
            let answer = app.get(asset.path).await;
            assert_eq!((answer.status().as_u16(), &answer.headers()["content-type"]), (200, &asset.media_type.parse().unwrap()));
        }
    }
}
