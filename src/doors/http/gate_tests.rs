//! Which refused requests this door records. Rights are tested in `routes_tests`.

use crate::access::Access;
use crate::api::door;
use crate::api::tests::fixture::searching;
use crate::doors::http::testing::{TestApp, app, guarded_app, keys};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::Door;
use hallsweep_core::refused::Refused;
use hallsweep_core::units::{Epoch, LuggageId};

const JSON: (&str, &str) = ("content-type", "application/json");
const FORM: (&str, &str) = ("content-type", "application/x-www-form-urlencoded");
const PERSON: (&str, &str) = ("accept", "text/html,*/*;q=0.8");

/// A request (method, path, headers, body), and its answer (status, problem code).
type Case<'a> = (&'a str, &'a str, &'a [(&'a str, &'a str)], &'a str, u16, &'a str);

/// Returns the recorded refusals. The loop handles its queue in order, so when it answers this STOP, all earlier
/// refusals are recorded.
async fn noted(app: &TestApp) -> Vec<(Door, String, &'static str, String)> {
    assert_eq!(app.door.hall.handle.give(stop()).await.map(|answer| answer.is_ok()), Ok(true));
    let noted = std::mem::take(&mut *app.noted.lock().unwrap());
    let told = |(issuer, asked, refused): (hallsweep_core::command::Issuer, Asked, Refused)| {
        (issuer.door, asked.to_string(), refused.code(), format!("{} {}: {refused}", issuer.who, issuer.from))
    };
    noted.into_iter().map(told).collect()
}

fn stop() -> hallsweep_core::command::Request {
    let issuer = hallsweep_core::command::Issuer { door: Door::LOCAL, who: "test".into(), from: "here".into() };
    hallsweep_core::command::Request::new(hallsweep_core::command::Command::Stop, issuer)
}

/// Safety A6.
#[tokio::test]
async fn what_the_door_itself_refuses_is_put_on_record_once() {
    let app = app(searching());
    let (huge, key) = ("x".repeat(20_000), ("idempotency-key", "a b"));
    let cases: [Case; 10] = [
        ("POST", "/api/v1/commands/start", &[JSON], "{", 400, "malformed"),
        ("POST", "/api/v1/commands/start", &[key], "", 400, "malformed"),
        ("POST", "/api/v1/commands/move", &[JSON], &huge, 413, "tooLarge"),
        ("POST", "/api/v1/commands/move", &[("content-type", "text/plain")], "w", 415, "unsupportedMediaType"),
        ("POST", "/api/v1/commands/move", &[JSON], r#"{"move":"q"}"#, 422, "unusable"),
        ("PUT", "/api/v1/temperature", &[JSON], "{}", 422, "unusable"),
        ("POST", "/api/v1/luggage/three/verdict", &[JSON], r#"{"verdict":"safe"}"#, 404, "notFound"),
        ("POST", "/startappl", &[key, PERSON], "", 400, "malformed"),
        ("POST", "/console/goto", &[FORM], "x=&y=2", 422, "unusable"),
        ("POST", "/console/goto", &[FORM, PERSON], "x=&y=2", 422, "unusable"),
    ];
    for (method, path, headers, body, status, code) in cases {
        assert_eq!(app.send(method, path, headers, body).await.status(), status, "{path} {body:.20}");
        let door = if path.starts_with("/console/") { door::CONSOLE } else { door::HTTP };
        let records = noted(&app).await;
        let [(by, asked, refused, words)] = &records[..] else { panic!("{path} {body:.20}: {records:?}") };
        assert_eq!((*by, asked.as_str(), *refused), (door, format!("{method} {path}").as_str(), code));
        assert!(words.starts_with("operator 127.0.0.1: ") && words.len() > 40, "{words}");
    }
}

/// Safety A6: the core itself records the commands that it refuses.
#[tokio::test]
async fn what_the_core_refused_or_nobody_asked_for_is_not_put_on_record_here() {
    let app = app(searching());
    for refused in [Refused::Moving, Refused::UnknownLuggage(LuggageId(3)), Refused::Outdated { sent: Epoch(1), now: Epoch(2) }] {
        app.refuse(refused);
        for (path, headers) in [("/api/v1/commands/start", vec![]), ("/console/start", vec![FORM, PERSON]), ("/w", vec![PERSON])]
        {
            assert!(app.send("POST", path, &headers, "").await.status().is_client_error(), "{path}");
        }
    }
    *app.refuse.lock().unwrap() = None;
    for (path, status) in [("/nowhere", 404), ("/missions/1?show=nothing", 422), ("/api/v1/missions?limit=x", 422)] {
        assert_eq!(app.get(path).await.status(), status, "{path}");
    }
    assert_eq!(app.send("POST", "/sign-in", &[JSON], "{").await.status(), 415);
    assert_eq!(app.send("POST", "/api/v1/commands/reset", &[("host", "elsewhere.example")], "").await.status(), 421);
    assert_eq!(noted(&app).await, []);
}

/// Safety A6, S1.
#[tokio::test]
async fn strangers_leave_no_record_viewers_one_and_a_stop_is_never_refused() {
    let (keyring, tokens) = keys();
    let app = guarded_app(searching(), Access::Keys(keyring));
    let bearer = format!("Bearer {}", tokens.viewer);
    let viewer = ("authorization", bearer.as_str());
    assert_eq!(app.send("POST", "/api/v1/commands/start", &[JSON], "{").await.status(), 401);
    assert_eq!(app.send("POST", "/api/v1/commands/stop", &[viewer, ("idempotency-key", "a b")], "{").await.status(), 200);
    assert_eq!(noted(&app).await, []);
    assert_eq!(app.send("POST", "/console/start", &[viewer, FORM], "epoch=x").await.status(), 403);
    assert_eq!(app.send("POST", "/api/v1/commands/move", &[viewer, JSON], r#"{"move":"w"}"#).await.status(), 403);
    assert_eq!(app.send("POST", "/console/move", &[viewer, FORM], "move=q").await.status(), 422);
    let records: Vec<_> = noted(&app).await.into_iter().map(|(door, asked, code, _)| (door, asked, code)).collect();
    let expected = [
        (door::CONSOLE, "POST /console/start", "notAllowed"),
        (door::HTTP, "move forward", "notAllowed"),
        (door::CONSOLE, "POST /console/move", "unusable"),
    ];
    assert_eq!(records, expected.map(|(door, asked, code)| (door, asked.to_owned(), code)));
}
