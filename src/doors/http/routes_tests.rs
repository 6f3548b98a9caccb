//! Tries every route of the table without a key, as a viewer and as an operator. Other tests check the effects of the
//! routes.

use std::fmt::Write;

use super::*;
use crate::access::Access;
use crate::api::resources::Form;
use crate::api::tests::documented;
use crate::api::tests::fixture::searching;
use crate::doors::http::testing;
use crate::doors::http::testing::{TestApp, app, guarded_app, keys, leads, read, text};

async fn sent(app: &TestApp, row: &RouteRow, token: Option<&str>, accept: &str) -> axum::http::Response<axum::body::Body> {
    let bearer = token.map(|token| format!("Bearer {token}"));
    let mut headers = vec![("accept", accept)];
    headers.extend(bearer.as_deref().map(|bearer| ("authorization", bearer)));
    app.send(row.method.as_str(), &row.path.replace("{id}", "3"), &headers, "").await
}

fn guarded() -> (TestApp, testing::Tokens) {
    let (keyring, tokens) = keys();
    (guarded_app(searching(), Access::Keys(keyring)), tokens)
}

/// Safety A1.
#[tokio::test]
async fn every_route_lets_in_whom_the_table_says_and_nobody_else() {
    let (app, tokens) = guarded();
    for row in table() {
        let (method, path) = (&row.method, &row.path);
        let stranger = sent(&app, &row, None, "*/*").await;
        let expect_401 = row.need != Nothing;
        assert_eq!(stranger.status() == 401, expect_401, "{method} {path} for nobody: {}", stranger.status());
        assert_eq!(stranger.headers().contains_key("www-authenticate"), expect_401, "{method} {path}");

        let viewer = sent(&app, &row, Some(&tokens.viewer), "*/*").await;
        assert_ne!(viewer.status(), 401, "{method} {path} for a viewer");
        assert_eq!(viewer.status() == 403, row.need == Act, "{method} {path} for a viewer: {}", viewer.status());
        if row.need == Act {
            assert_eq!(read(viewer).await.1["code"], "notAllowed", "{method} {path}");
        }

        let operator = sent(&app, &row, Some(&tokens.operator), "*/*").await;
        assert!(![401, 403].contains(&operator.status().as_u16()), "{method} {path} for an operator: {}", operator.status());
    }
}

/// Safety S1, A1.
#[tokio::test]
async fn all_that_a_viewer_can_make_the_core_do_is_to_stop() {
    let (app, tokens) = guarded();
    for row in table() {
        sent(&app, &row, Some(&tokens.viewer), "*/*").await;
    }
    let given: Vec<Command> = app.given.lock().unwrap().drain(..).map(|request| request.command).collect();
    assert_eq!(given, vec![Command::Stop; 4], "by the interface, the console, and two words of old clients");

    let bearer = format!("Bearer {}", tokens.viewer);
    let moved = async |path: &str, media: &str, body: &str| {
        let headers = [("authorization", bearer.as_str()), ("content-type", media)];
        app.send("POST", path, &headers, body).await.status().as_u16()
    };
    let (json, form) = ("application/json", "application/x-www-form-urlencoded");
    assert_eq!(moved("/api/v1/commands/move", json, r#"{"move":"w"}"#).await, 403);
    assert_eq!(moved("/console/move", form, "move=w").await, 403);
    assert!(app.given.lock().unwrap().is_empty());
    assert_eq!(moved("/api/v1/commands/move", json, r#"{"move":"h"}"#).await, 200, "`h` is STOP");
    assert_eq!(moved("/console/move", form, "move=h").await, 303);
    assert_eq!(&*app.last().issuer.who, "lobby");
}

#[tokio::test]
async fn a_browser_that_nobody_is_signed_in_with_is_led_to_the_page_for_it() {
    let (app, _) = guarded();
    for row in table().iter().filter(|row| row.need != Nothing && !row.path.starts_with("/api/")) {
        let response = sent(&app, row, None, "text/html,*/*;q=0.8").await;
        assert_eq!(response.status(), 303, "{}", row.path);
        let leads_back = row.method == Method::GET && row.path != "/";
        let expect = match row.method {
            Method::GET if leads_back => format!("/sign-in?next={}", row.path.replace("{id}", "3")),
            Method::GET => "/sign-in".to_owned(),
            _ if ["/console/stop", "/stopappl", "/h"].contains(&&*row.path) => "/sign-in?undone=stop".to_owned(),
            _ => "/sign-in?undone=command".to_owned(),
        };
        assert_eq!(leads(&response, &row.path), expect);
    }
    assert!(app.given.lock().unwrap().is_empty());
}

#[tokio::test]
async fn what_is_not_in_the_table_is_answered_to_those_who_may_look() {
    let (app, tokens) = guarded();
    let bearer = format!("Bearer {}", tokens.viewer);
    for method in ["PATCH", "TRACE"] {
        assert_eq!(app.send(method, "/healthz", &[], "").await.status(), 405, "there is nothing to be seen behind it");
    }
    for (method, path, status) in [("GET", "/nowhere", 404), ("DELETE", "/api/v1/state", 405)] {
        assert_eq!(app.send(method, path, &[], "").await.status(), 401, "{path}");
        assert_eq!(app.send(method, path, &[("authorization", &bearer)], "").await.status(), status, "{path}");
    }
}

#[tokio::test]
async fn an_open_door_asks_nobody_for_a_key() {
    let app = app(searching());
    for row in table() {
        let response = sent(&app, &row, None, "*/*").await;
        assert!(![401, 403].contains(&response.status().as_u16()), "{} {}: {}", row.method, row.path, response.status());
    }
    assert!(!text(app.get("/").await).await.contains("/sign-out"));
}

#[test]
fn no_route_is_in_the_table_twice() {
    let mut routes: Vec<(String, String)> = table().iter().map(|row| (row.method.to_string(), row.path.to_string())).collect();
    routes.sort();
    let all = routes.len();
    routes.dedup();
    assert_eq!(routes.len(), all);
}

#[test]
fn the_documentation_shows_the_table_as_it_is() {
    let mut shown = String::from("| route | for |\n|---|---|\n");
    for row in table() {
        writeln!(shown, "| `{} {}` | {} |", row.method, row.path, row.need.in_words()).unwrap();
    }
    documented::shows("http.md", "the table of routes", &shown);
}

#[test]
fn the_documentation_shows_the_commands_as_they_are() {
    let mut shown = String::from("| route | what | body |\n|---|---|---|\n");
    for row in &COMMANDS {
        let method = if row.methods == Methods::Put { "PUT" } else { "POST" };
        writeln!(shown, "| `{method} /api/v1{}` | {} | {} |", row.path, row.title, documented::bodies(row)).unwrap();
    }
    documented::shows("http.md", "the table of commands", &shown);
}

#[test]
fn the_documentation_shows_the_files_of_the_map_as_they_are() {
    let mut shown = String::from("| route | what | content type |\n|---|---|---|\n");
    for row in &FILES {
        writeln!(shown, "| `GET /api/v1/map/{}` | {} | `{}` |", row.name, row.title, row.media_type).unwrap();
    }
    documented::shows("http.md", "the table of map files", &shown);
}

#[test]
fn the_documentation_shows_the_resources_as_they_are() {
    let mut shown = String::from("| route | what | formats |\n|---|---|---|\n");
    for row in &RESOURCES {
        let formats = match row.forms {
            [Form::Picture] => "the picture",
            forms if forms.contains(&Form::Text) => "JSON, or text by `Accept: text/plain`",
            _ => "JSON",
        };
        writeln!(shown, "| `GET /api/v1{}` | {} | {formats} |", row.path, row.title).unwrap();
    }
    documented::shows("http.md", "the table of resources", &shown);
}

/// Returns the commands that the page can send, each with its required right. A verdict has three buttons, so it counts
/// three times.
fn console_commands() -> Vec<(String, Need)> {
    let words = |row: &commands::CommandRow| {
        if row.kind == CommandKind::Verdict { vec!["safe", "danger", "unsure"] } else { vec![row.name] }
    };
    let mut all: Vec<_> =
        COMMANDS.iter().flat_map(|row| words(row).into_iter().map(|word| (format!("/console/{word}"), row.need))).collect();
    all.sort();
    all
}

#[test]
fn the_page_can_send_every_command_of_the_table_and_no_other() {
    let console = table().into_iter().filter(|row| row.method == Method::POST && row.path.starts_with("/console/"));
    let mut routes: Vec<(String, Need)> = console.map(|row| (row.path.to_string(), row.need)).collect();
    routes.sort();
    assert_eq!(routes, console_commands());
}

#[test]
fn every_form_of_the_page_sends_a_command_of_the_table_and_every_command_has_its_form() {
    fn templates(folder: &std::path::Path) -> String {
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        entries.map(|path| if path.is_dir() { templates(&path) } else { std::fs::read_to_string(path).unwrap() }).collect()
    }
    let pages = templates(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("templates"));
    // A button with a confirmation sends its command only from the confirmation page.
    let named = |attribute: &str| pages.split(attribute).skip(1).filter_map(|rest| rest.split('"').next()).collect::<Vec<_>>();
    let sends = |to: &&str| to.starts_with("/console/") && !to.starts_with("/console/confirm/");
    let forms = [named("action=\""), named("data-confirm=\"")].concat();
    let from_root = forms.into_iter().filter_map(|to| to.strip_prefix('.'));
    let mut sent: Vec<String> = from_root.filter(sends).map(str::to_owned).collect();
    sent.sort();
    sent.dedup();
    let known: Vec<String> = console_commands().into_iter().map(|(path, _)| path).collect();
    assert_eq!(sent, known);
}
