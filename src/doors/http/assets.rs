//! Files of the web page: style, script, icon, vendored library. They are built into the program. Nothing is read
//! from disk.

use std::hash::{DefaultHasher, Hash, Hasher};

use axum::http::{HeaderMap, Uri, header};
use axum::response::{IntoResponse, Response};

use super::etag::conditional;
use super::problem::Problem;
use crate::api::fields::in_short;

const STYLE: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const PICTURE: &str = "image/svg+xml";
const TYPEFACE: &str = "font/woff2";

struct Asset {
    path: &'static str,
    media_type: &'static str,
    bytes: &'static [u8],
}

macro_rules! assets {
    ($($name:literal $media_type:ident)*) => {
        &[$(Asset {
            path: concat!("/static/", $name),
            media_type: $media_type,
            bytes: include_bytes!(concat!("../../../static/", $name)),
        }),*]
    };
}

static ASSETS: &[Asset] = assets! {
    "tokens.css" STYLE
    "shell.css" STYLE
    "map.css" STYLE
    "vendor/inter.woff2" TYPEFACE
    "vendor/icons.svg" PICTURE
    "console.css" STYLE
    "console.js" SCRIPT
    "hall.js" SCRIPT
    "time.js" SCRIPT
    "verdict.css" STYLE
    "photo.js" SCRIPT
    "areas.js" SCRIPT
    "verdict.js" SCRIPT
    "attention.js" SCRIPT
    "theme.js" SCRIPT
    "words.js" SCRIPT
    "stop.js" SCRIPT
    "bar.js" SCRIPT
    "laboratory.css" STYLE
    "laboratory.js" SCRIPT
    "pallet.js" SCRIPT
    "replay.js" SCRIPT
    "roomba.js" SCRIPT
    "simulator.css" STYLE
    "simulator.js" SCRIPT
    "editor.js" SCRIPT
    "trees.js" SCRIPT
    "vendor/idiomorph.js" SCRIPT
    "icon.svg" PICTURE
};

pub(super) async fn file(uri: Uri, headers: HeaderMap) -> Result<Response, Problem> {
    // Some browsers ask for an icon at this path, whatever a page says.
    let path = if uri.path() == "/favicon.ico" { "/static/icon.svg" } else { uri.path() };
    let asset = ASSETS.iter().find(|asset| asset.path == path);
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
        for asset in ASSETS {
            let answer = app.get(asset.path).await;
            assert_eq!((answer.status().as_u16(), &answer.headers()["content-type"]), (200, &asset.media_type.parse().unwrap()));
        }
    }
}
