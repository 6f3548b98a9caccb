//! Makes addresses work under any prefix that a proxy adds before the paths of this door. The door does not know the
//! prefix, so all redirects and pages use addresses relative to the requested path.

use axum::body::{Body, HttpBody, to_bytes};
use axum::extract::Request;
use axum::http::{HeaderValue, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::halls::Entered;
use super::problem::Problem;

/// Tag after which the `<base>` of a page is inserted. Templates use addresses relative to the root.
const HEAD: &str = "<head>";

/// What the process has once: the cookies of these pages are for the folder that the page is in, and the description of
/// the interface names no hall.
const OF_THE_PROCESS: [&str; 3] = ["/sign-in", "/sign-out", "/api/v1/openapi.json"];

/// Maximum length in bytes of the path to return to after signing in.
pub(super) const LONGEST_PATH: usize = 512;

pub(super) async fn relative(request: Request, next: Next) -> Response {
    let Some(Entered { path, hall }) = request.extensions().get().cloned() else { return Problem::internal().into_response() };
    let process = root(&path);
    let root = hall.map_or_else(|| process.clone(), |hall| format!("{process}halls/{hall}/"));
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    let leads = headers.get(header::LOCATION).and_then(|to| to.to_str().ok()?.strip_prefix('/')).map(|path| {
        let root = if is_of_the_process(&format!("/{path}")) { &process } else { &root };
        HeaderValue::from_str(&format!("{root}{path}"))
    });
    if let Some(Ok(leads)) = leads {
        headers.insert(header::LOCATION, leads);
    }
    // A report is sent as a stream and contains no addresses, so it is not changed.
    let is_whole = response.body().size_hint().exact().is_some();
    if root == "./" || !is_page(&response) || !is_whole {
        return response;
    }
    let (mut parts, body) = response.into_parts();
    parts.headers.remove(header::CONTENT_LENGTH);
    let page = to_bytes(body, usize::MAX).await.expect("a page is in memory");
    let page = String::from_utf8_lossy(&page).replacen(HEAD, &format!("{HEAD}\n  <base href=\"{root}\">"), 1);
    Response::from_parts(parts, Body::from(page))
}

pub(super) fn is_of_the_process(path: &str) -> bool {
    OF_THE_PROCESS.contains(&path.split('?').next().unwrap_or_default())
}

/// Returns the relative path from a page to the root. It is never empty: otherwise the text after it could be read as
/// a scheme or a host.
pub(super) fn root(path: &str) -> String {
    let folders = path.matches('/').count().saturating_sub(1);
    if folders == 0 { "./".to_owned() } else { "../".repeat(folders) }
}

pub(super) fn is_page(response: &Response) -> bool {
    response.headers().get(header::CONTENT_TYPE).is_some_and(|kind| kind.as_bytes().starts_with(b"text/html"))
}

/// Returns the path to open after signing in. It is always a path of this door. Two things could leave the proxy's
/// prefix and are refused: `..` (browsers also read `%2e` as a dot), and the escaped slash `%2f`.
pub(super) fn local(next: Option<&str>) -> &str {
    let plain = |path: &str| path.to_ascii_lowercase().replace("%2e", ".");
    let steps_up = |path: &str| plain(path).contains("%2f") || plain(path).split(['/', '?', '#']).any(|part| part == "..");
    let is_local = |path: &&str| {
        let visible = path.bytes().all(|byte| byte.is_ascii_graphic() && byte != b'\\');
        path.starts_with('/') && !path.starts_with("//") && visible && !steps_up(path) && path.len() <= LONGEST_PATH
    };
    next.filter(is_local).unwrap_or("/")
}

#[cfg(test)]
mod tests {
    use super::super::routes::table;
    use super::super::testing::{app, leads, text};
    use super::*;
    use crate::api::tests::fixture::searching;

    const BROWSER: (&str, &str) = ("accept", "text/html,application/xhtml+xml,*/*;q=0.8");

    /// Returns the path that a browser requests for `address` on the page at `path`.
    fn resolved(path: &str, base: &str, address: &str) -> String {
        let address = format!("{base}{address}");
        let mut at: Vec<&str> = path.split('/').collect();
        at.pop();
        for step in address.split('/') {
            match step {
                "." => {}
                ".." => assert!(at.pop().is_some_and(|folder| !folder.is_empty()), "{path}: {base} leads past the root"),
                name => at.push(name),
            }
        }
        at.join("/")
    }

    #[test]
    fn the_way_to_the_root_is_as_long_as_the_path_is_deep() {
        for (path, up) in
            [("/", "./"), ("/missions", "./"), ("/missions/1", "../"), ("/missions/1/moment", "../../"), ("*", "./")]
        {
            assert_eq!(root(path), up, "{path}");
        }
    }

    #[tokio::test]
    async fn every_page_finds_its_files_and_its_stop_wherever_it_lies() {
        let app = app(searching());
        let asked = table().into_iter().map(|row| (row.method.to_string(), row.path.replace("{id}", "3")));
        let astray = ["/nowhere", "/no/where/at/all", "/missions/1", "/missions/1/moment?at=4", "/missions/1/retrieval"];
        let mut pages = 0;
        for (method, path) in asked.chain(astray.map(|path| ("GET".to_owned(), path.to_owned()))) {
            let response = app.send(&method, &path, &[BROWSER], "").await;
            // Parts of pages have no `<head>`.
            if !is_page(&response) || ["/console/bar", "/console/coverage"].contains(&&*path) {
                continue;
            }
            pages += 1;
            let page = text(response).await;
            let (head, _) = page.split_once("</head>").expect("a head");
            let base = head.split_once("<base href=\"").map_or("", |(_, base)| base.split('"').next().unwrap());
            let asked = path.split('?').next().unwrap();
            assert_eq!(resolved(asked, base, "./static/stop.js"), "/static/stop.js", "{method} {path}: {base}");
            let first = head.split("=\"./").next().unwrap();
            assert!(base.is_empty() || first.contains("<base "), "{method} {path}: an address stands before its root");
            for attribute in ["href", "src", "action", "formaction"] {
                assert!(!page.contains(&format!("{attribute}=\"/")), "{method} {path}: {attribute}");
            }
        }
        assert!(pages > 20, "{pages} pages");
    }

    #[tokio::test]
    async fn what_leads_elsewhere_leads_there_under_any_prefix() {
        let app = app(searching());
        for (method, path, to) in [
            ("POST", "/console/stop", "../"),
            ("POST", "/h", "./"),
            ("POST", "/sign-out", "./sign-in"),
            ("GET", "/sign-in?next=/missions/1", "./missions/1"),
            ("GET", "/sign-in?next=/javascript:alert(1)", "./javascript:alert(1)"),
            ("GET", "/api/v1/luggage/3/photo", "../../../../luggage/3"),
        ] {
            let response = app.send(method, path, &[BROWSER], "").await;
            assert_eq!(response.headers()["location"], to, "{method} {path}");
            assert_eq!(leads(&response, path), resolved(path.split('?').next().unwrap(), "", to), "{method} {path}");
        }
    }

    /// Safety A2.
    #[tokio::test]
    async fn a_cookie_is_kept_for_the_prefix_that_it_was_given_under() {
        let app = app(searching());
        for (path, body) in [("/sign-out", ""), ("/language", "language=it")] {
            let answer = app.form(path, body).await;
            let cookie = answer.headers()["set-cookie"].to_str().unwrap();
            assert!(!cookie.to_ascii_lowercase().contains("path"), "the folder of {path} holds: {cookie}");
        }
    }

    #[tokio::test]
    async fn who_asks_for_the_head_of_a_page_alone_is_told_no_wrong_length() {
        let app = app(searching());
        for path in ["/missions/1", "/"] {
            let head = app.send("HEAD", path, &[BROWSER], "").await;
            let length = head.headers().get("content-length").map(|length| length.to_str().unwrap().parse::<usize>().unwrap());
            let whole = text(app.send("GET", path, &[BROWSER], "").await).await.len();
            assert!(length.is_none_or(|length| length == whole), "{path}: {length:?} of {whole}");
        }
    }
}
