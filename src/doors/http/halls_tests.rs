//! What the name of a hall in a path does, and what a key without that hall can learn of it: nothing.

use axum::body::Body;
use axum::http::Response;

use super::*;
use crate::access::{Access, Keyring, Keys, Need, OPERATOR, Role};
use crate::api::tests::fixture::searching;
use crate::doors::http::routes::table;
use crate::doors::http::testing::{TestApp, app, guarded_app, leads, read, send, text};
use hallsweep_core::command::Command;
use hallsweep_core::snapshot::Snapshot;

const PERSON: (&str, &str) = ("accept", "text/html,*/*;q=0.8");
const JSON: (&str, &str) = ("content-type", "application/json");

fn id(name: &str) -> HallId {
    HallId::new(name).expect("a plain name")
}

/// Two halls: `main` is the default hall, and `south` has a loop of its own.
struct Two {
    main: TestApp,
    south: TestApp,
    halls: Halls,
}

fn two(access: Access) -> Two {
    let main = guarded_app(searching(), access);
    let south = app(Snapshot { hall: Some(id("south")), ..searching() });
    let halls = main.halls();
    halls.add(id("south"), HallDoor::new(south.door.hall.handle.clone(), south.door.hall.archive.clone(), "depot"));
    Two { main, south, halls }
}

/// A key for each of three people: an operator of all halls, a viewer of all halls, and an operator of `south` alone.
fn keys() -> (Keyring, [String; 3]) {
    let mut keys = Keys::first().unwrap();
    keys.add("lobby", Role::Viewer, None).unwrap();
    keys.add("south", Role::Operator, Some([id("south")].into())).unwrap();
    let token = |name: &str| format!("Bearer {}", keys.named(name).unwrap().token.reveal());
    let tokens = [OPERATOR, "lobby", "south"].map(token);
    (Keyring::of(keys).unwrap(), tokens)
}

fn given(app: &TestApp) -> Vec<Command> {
    app.given.lock().unwrap().drain(..).map(|request| request.command).collect()
}

/// Everything of an answer that its reader sees.
async fn whole(mut response: Response<Body>) -> String {
    response.headers_mut().remove("date");
    let (status, headers) = (response.status(), format!("{:?}", response.headers()));
    format!("{status} {headers} {}", text(response).await)
}

#[test]
fn a_path_names_a_hall_in_either_form() {
    let south = |within: &str| Some((id("south"), within.to_owned()));
    assert_eq!(named("/halls/south"), south("/"));
    assert_eq!(named("/halls/south/"), south("/"));
    assert_eq!(named("/halls/south/missions/4"), south("/missions/4"));
    assert_eq!(named("/halls/south/api/v1/state"), south("/api/v1/state"));
    assert_eq!(named("/api/v1/halls/south/commands/start"), south("/api/v1/commands/start"));
    for none in ["/", "/halls", "/halls/", "/halls/South/", "/halls//x", "/api/v1/halls", "/hallsouth", "/x/halls/south", "*"] {
        assert_eq!(named(none), None, "{none}");
    }
}

#[tokio::test]
async fn a_command_reaches_the_hall_that_its_path_names_and_no_other() {
    let Two { main, south, halls } = two(Access::Open);
    for path in ["/api/v1/halls/south/commands/start", "/halls/south/api/v1/commands/start", "/halls/south/console/start"] {
        let answer = send(&halls, "POST", path, &[], "").await;
        assert!(answer.status().is_success() || answer.status().is_redirection(), "{path} {}", answer.status());
        assert_eq!((given(&main), given(&south)), (vec![], vec![Command::Start]), "{path}");
    }
    for path in ["/api/v1/commands/start", "/console/start", "/api/v1/halls/main/commands/start", "/halls/main/console/start"] {
        send(&halls, "POST", path, &[], "").await;
        assert_eq!((given(&main), given(&south)), (vec![Command::Start], vec![]), "{path}");
    }
    for path in ["/api/v1/halls/north/commands/start", "/api/v1/halls/South/commands/start", "/halls/north/h"] {
        assert_eq!(send(&halls, "POST", path, &[], "").await.status(), 404, "{path}");
    }
    assert_eq!((given(&main), given(&south)), (vec![], vec![]));
}

#[tokio::test]
async fn addresses_in_answers_lead_into_the_same_hall() {
    let Two { halls, .. } = two(Access::Open);
    let (_, state) = read(send(&halls, "GET", "/api/v1/halls/south/state", &[], "").await).await;
    let photo = state["luggage"][0]["photo"]["url"].as_str().expect("it has a photo");
    assert!(photo.starts_with("/halls/south/api/v1/luggage/"), "{photo}");
    assert_eq!(send(&halls, "GET", photo, &[], "").await.status(), 200);
    let (_, missions) = read(send(&halls, "GET", "/api/v1/halls/south/missions?limit=1", &[], "").await).await;
    let links = &missions["missions"][0]["links"];
    for address in [&links["itself"], &links["self"], &links["page"], &links["events"], &missions["next"]] {
        assert!(address.is_null() || address.as_str().is_some_and(|to| to.starts_with("/halls/south/")), "{address}");
    }
    assert!(links["page"].is_string() && links["events"].is_string(), "{links}");
    let (_, state) = read(send(&halls, "GET", "/api/v1/state", &[], "").await).await;
    assert!(state["luggage"][0]["photo"]["url"].as_str().is_some_and(|url| url.starts_with("/api/v1/luggage/")));
}

#[tokio::test]
async fn pages_and_redirects_stay_in_their_hall_and_signing_in_is_for_all() {
    let (keyring, [operator, _, south_only]) = keys();
    let Two { halls, .. } = two(Access::Keys(keyring));
    let headers = [PERSON, ("authorization", &*operator)];
    for (path, base) in [
        ("/halls/south", "../halls/south/"),
        ("/halls/south/", "../../halls/south/"),
        ("/halls/south/missions/1", "../../../halls/south/"),
        ("/halls/south/nowhere", "../../halls/south/"),
    ] {
        let page = text(send(&halls, "GET", path, &headers, "").await).await;
        assert!(page.contains(&format!("<base href=\"{base}\">")), "{path}: {:.400}", page);
    }
    let entered = send(&halls, "GET", "/", &[PERSON, ("authorization", &*south_only)], "").await;
    assert_eq!(leads(&entered, "/"), "/halls/south/", "the first page that this key sees");
    let nowhere = text(send(&halls, "GET", "/halls/none/", &headers, "").await).await;
    assert!(!nowhere.contains("/stop\""), "no STOP without a hall: {nowhere}");
    let stopped = send(&halls, "POST", "/halls/south/console/stop", &headers, "").await;
    assert_eq!(leads(&stopped, "/halls/south/console/stop"), "/halls/south/");
    let photo = send(&halls, "GET", "/api/v1/halls/south/luggage/3/photo", &headers, "").await;
    assert_eq!(leads(&photo, "/api/v1/halls/south/luggage/3/photo"), "/halls/south/luggage/3");
    let stranger = send(&halls, "GET", "/halls/south/missions/1", &[PERSON], "").await;
    assert_eq!(leads(&stranger, "/halls/south/missions/1"), "/sign-in?next=/halls/south/missions/1");
    let out = send(&halls, "POST", "/halls/south/sign-out", &headers, "").await;
    assert_eq!((out.status().as_u16(), leads(&out, "/halls/south/sign-out").as_str()), (307, "/sign-out"));
}

/// Safety A1: every route, by every kind of address, with a key that sees another hall only.
#[tokio::test]
async fn a_hall_that_a_key_does_not_see_answers_byte_for_byte_as_one_that_does_not_exist() {
    let (keyring, [_, _, south_only]) = keys();
    let Two { main, halls, .. } = two(Access::Keys(keyring));
    for row in table().into_iter().filter(|row| row.need != Need::Nothing && row.path != LIST) {
        let path = row.path.replace("{id}", "3").replace("{name}", "depot");
        for accept in [("accept", "application/json"), PERSON] {
            let headers = [JSON, accept, ("authorization", &*south_only)];
            let ask = async |path: String| whole(send(&halls, row.method.as_str(), &path, &headers, "{}").await).await;
            let within = |hall: &str| match path.strip_prefix("/api/v1") {
                Some(rest) => format!("/api/v1/halls/{hall}{rest}"),
                None => format!("/halls/{hall}{path}"),
            };
            let (hidden, unknown) = (ask(within("main")).await, ask(within("none")).await);
            assert!(unknown.starts_with("404 "), "{path}: {unknown}");
            assert_eq!(hidden, unknown.replace("halls/none", "halls/main"), "{path}");
            if path == "/" {
                continue;
            }
            let by_default = ask(path.clone()).await;
            assert!(by_default.starts_with("404 ") && !by_default.contains("airport"), "{path}: {by_default}");
        }
    }
    assert_eq!(given(&main), []);
    assert!(main.noted.lock().unwrap().is_empty(), "the records of a hall tell nothing of those who may not see it");
}

#[tokio::test]
async fn a_list_of_halls_has_those_that_the_key_sees_and_what_waits_there() {
    let (keyring, [operator, viewer, south_only]) = keys();
    let Two { halls, .. } = two(Access::Keys(keyring));
    for (token, expected) in [(&operator, &["main", "south"][..]), (&viewer, &["main", "south"]), (&south_only, &["south"])] {
        let (status, list) = read(send(&halls, "GET", LIST, &[("authorization", token)], "").await).await;
        let names: Vec<_> = list["halls"].as_array().unwrap().iter().map(|hall| hall["name"].as_str().unwrap()).collect();
        assert_eq!((status.as_u16(), &names[..]), (200, expected));
        let south = list["halls"].as_array().unwrap().last().unwrap();
        assert_eq!((&south["title"], &south["phase"], &south["default"]), (&"depot".into(), &"inspecting".into(), &false.into()));
        assert_eq!(south["links"]["page"], "/halls/south/");
        let waiting = searching().luggage.pending().count();
        assert_eq!(south["waiting"], waiting);
        assert_eq!(south["waitingSince"].is_null(), waiting == 0);
    }
    assert_eq!(send(&halls, "GET", LIST, &[], "").await.status(), 401);
}
