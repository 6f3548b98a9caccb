//! Tests every path of the table with every method and format, from this machine and from another one.

use std::fmt::Write;

use super::super::caller;
use super::super::testing::{TestApp, app, get, request};
use super::*;
use crate::access::Need;
use crate::api::commands::CommandKind;
use crate::api::tests::documented;
use crate::api::tests::fixture::searching;
use coap_endpoint::{Code, Request};
use hallsweep_core::command::Command;
use hallsweep_core::world::resource::Resource;

const METHODS: [Method; 7] =
    [Method::Get, Method::Post, Method::Put, Method::Delete, Method::Fetch, Method::Patch, Method::IPatch];

fn path(row: &PathRow) -> String {
    row.path.replace("{id}", "3")
}

async fn code(app: &TestApp, request: Request) -> String {
    app.ask(request).await.response.code.to_string()
}

#[test]
fn every_resource_has_its_path_and_can_be_observed() {
    let table = Table::default();
    for resource in Resource::ALL {
        let name = ResourceKind::Of(resource).row().name;
        let found = table.find(&[name.to_owned()]).expect("a row");
        let shown = found.row.shows.as_ref().expect("it can be read");
        assert!(shown.show == Show::Resource(ResourceKind::Of(resource)) && shown.is_observable, "{name}");
    }
}

#[test]
fn no_path_is_in_the_table_twice_and_none_does_nothing() {
    let table = Table::default();
    let mut paths: Vec<&str> = table.rows.iter().map(|row| row.path).collect();
    paths.sort_unstable();
    paths.dedup();
    assert_eq!(paths.len(), table.rows.len());
    assert!(table.rows.iter().all(|row| row.methods().next().is_some()));
    assert!(table.rows.iter().all(|row| row.actions.iter().all(|(method, _)| *method != Method::Get)));
}

#[test]
fn a_path_is_found_whole_and_a_number_is_a_number() {
    let table = Table::default();
    let found = |path: &str| table.find(&get(path).path).map(|found| (found.row.path.to_owned(), found.number));
    assert_eq!(found("/luggage/7/photo"), Some(("/luggage/{id}/photo".to_owned(), 7)));
    assert_eq!(found("/luggage"), Some(("/luggage".to_owned(), 0)));
    for nothing in ["/", "/luggage/", "/luggage/1/", "/luggage/{id}", "/robot/1", "/Robot", "//robot"] {
        assert_eq!(found(nothing), None, "{nothing}");
    }
    for no_number in ["x", "-1", "+1", "01", "00", "1 ", "٣"] {
        assert_eq!(found(&format!("/luggage/{no_number}")), None, "{no_number}");
    }
    assert_eq!(found("/luggage/0").map(|(_, number)| number), Some(0));
    assert_eq!(found(&format!("/luggage/{}", "9".repeat(40))), None);
}

#[tokio::test]
async fn whatever_is_not_in_the_table_is_answered_4_04_or_4_05() {
    let app = app(searching());
    for row in Table::default().rows {
        for method in METHODS.into_iter().filter(|method| row.methods().all(|known| known != *method)) {
            let (code, words) = app.said(request(method, &path(&row), "")).await;
            assert_eq!(code, "4.05", "{} {}", method.name(), row.path);
            assert!(row.methods().all(|known| words.contains(known.name())), "{words}");
        }
    }
    assert_eq!(code(&app, get("/nowhere")).await, "4.04");
    assert_eq!(code(&app, get("/")).await, "4.04");
    let given = app.given.lock().unwrap();
    assert!(given.iter().all(|request| request.command == Command::Stop), "but a STOP halts by every method: {given:?}");
}

#[tokio::test]
async fn everything_is_there_in_the_formats_that_the_table_says_and_in_no_other() {
    let app = app(searching());
    let all = [Format::TEXT, Format::LINKS, Format::BYTES, Format::PNG, Format::JSON, Format::CBOR, Format::SENML_JSON];
    for row in Table::default().rows {
        let Some(shown) = &row.shows else { continue };
        let first = app.ask(get(&path(&row))).await;
        assert_eq!(first.response.format, Some(shown.formats[0]), "{}", row.path);
        assert_eq!(first.observed.is_empty(), !shown.is_observable, "{}", row.path);
        for format in all {
            let answer = app.ask(Request { accept: Some(format), ..get(&path(&row)) }).await.response;
            if shown.formats.contains(&format) {
                assert_eq!((answer.code, answer.format), (Code::CONTENT, Some(format)), "{}", row.path);
                assert!(!answer.body.is_empty() && answer.tag.is_some(), "{} {format}", row.path);
            } else {
                assert_eq!(answer.code, Code::NOT_ACCEPTABLE, "{} {format}", row.path);
            }
        }
    }
}

/// Safety A4: from another machine everything can be read, but no command is accepted.
#[tokio::test]
async fn from_beyond_this_machine_everything_is_seen_and_nothing_done() {
    let app = app(searching());
    let beyond = |request| Request { peer: "192.0.2.7:40000".parse().unwrap(), ..request };
    for row in Table::default().rows {
        if row.shows.is_some() {
            assert_eq!(code(&app, beyond(get(&path(&row)))).await, "2.05", "{}", row.path);
        }
        for (method, _) in &row.actions {
            assert_eq!(code(&app, beyond(request(*method, &path(&row), "h"))).await, "4.03", "{}", row.path);
        }
    }
    assert!(app.given.lock().unwrap().is_empty());
    assert!(app.noted().await.is_none(), "strangers must not be able to fill the disk");
}

/// Safety S1: on this machine a STOP needs no right.
#[tokio::test]
async fn a_stop_is_in_the_table_and_does_what_it_says() {
    let app = app(searching());
    let table = Table::default();
    let stops =
        table.rows.iter().filter(|row| row.actions.iter().any(|(_, action)| *action == Action::Command(CommandKind::Stop)));
    for row in stops {
        assert_eq!(code(&app, request(Method::Post, row.path, "")).await, "2.04");
        assert_eq!(app.last().command, Command::Stop);
    }
}

#[test]
fn the_documentation_shows_the_table_as_it_is() {
    let mut shown = String::from("| path | what | GET, in these formats | observe | also | for |\n|---|---|---|---|---|---|\n");
    for row in Table::default().rows {
        writeln!(shown, "{}", line(&row)).unwrap();
    }
    documented::shows("coap.md", "the table of resources", &shown);
}

#[test]
fn the_documentation_shows_the_commands_as_they_are() {
    let mut shown = String::from("| path | what | body |\n|---|---|---|\n");
    for row in &COMMANDS {
        let methods = if row.methods == Methods::Post { "`POST" } else { "`PUT` or `POST" };
        writeln!(shown, "| {methods} {}` | {} | {} |", row.path, row.title, documented::bodies(row)).unwrap();
    }
    documented::shows("coap.md", "the table of commands", &shown);
}

fn line(row: &PathRow) -> String {
    let offers = row.shows.iter().flat_map(|shown| &shown.formats).map(|format| format.0.to_string());
    let observe = if row.shows.as_ref().is_some_and(|shown| shown.is_observable) { "yes" } else { "" };
    let actions: Vec<&str> = row.actions.iter().map(|(method, _)| method.name()).collect();
    let needs = row.actions.iter().map(|(_, action)| caller::in_words(action.need()));
    let seen = row.shows.iter().map(|_| caller::in_words(Need::See));
    let mut whom: Vec<&str> = seen.chain(needs).collect();
    whom.dedup();
    let cells = [
        format!("`{}`", row.path),
        row.title.to_owned(),
        offers.collect::<Vec<_>>().join(", "),
        observe.to_owned(),
        actions.join(", "),
        whom.join("; to act "),
    ];
    format!("| {} |", cells.join(" | "))
}
