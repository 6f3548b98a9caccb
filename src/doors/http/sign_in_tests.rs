//! Signing in and out as a browser does it, and attempts at abuse.

use std::time::Duration;

use futures_util::StreamExt;

use super::*;
use crate::access::{Keyring, Moment, SESSION_S};
use crate::api::tests::fixture::searching;
use crate::doors::http::prefix::LONGEST_PATH;
use crate::doors::http::testing::{TestApp, app, guarded_app, keys, leads, text};

const FORM: (&str, &str) = ("content-type", "application/x-www-form-urlencoded");
const BROWSER: (&str, &str) = ("accept", "text/html,application/xhtml+xml,*/*;q=0.8");

fn guarded() -> (TestApp, String, String) {
    let (keyring, tokens) = keys();
    (guarded_app(searching(), Access::Keys(keyring)), tokens.operator, tokens.viewer)
}

fn cookie(response: &Response) -> (String, String) {
    let set = response.headers()["set-cookie"].to_str().unwrap().to_owned();
    (set.split(';').next().unwrap().to_owned(), set)
}

/// Safety A2.
#[tokio::test]
async fn a_token_becomes_a_cookie_that_no_script_and_no_other_site_sees() {
    let (app, operator, _) = guarded();
    let response = app.send("POST", "/sign-in", &[FORM, BROWSER], &format!("token=%20{operator}%20&next=%2F")).await;
    assert_eq!((response.status().as_u16(), &*leads(&response, "/sign-in")), (303, "/"));
    let (cookie, set) = cookie(&response);
    for wanted in ["; HttpOnly", "; SameSite=Strict", "; Max-Age=34560000"] {
        assert!(set.contains(wanted), "{set}");
    }
    assert!(!set.contains("Secure") && !set.contains(&operator), "{set}");
    let page = text(app.send("GET", "/", &[BROWSER, ("cookie", &format!("a=b; {cookie}"))], "").await).await;
    assert!(page.contains("/sign-out") && page.contains("<b>operator</b>"));
    assert_eq!(app.send("POST", "/console/start", &[FORM, BROWSER, ("cookie", &cookie)], "epoch=1").await.status(), 303);
    assert_eq!(&*app.last().issuer.who, "operator");
}

/// The typed name does not change any right.
#[tokio::test]
async fn whoever_gives_a_name_is_on_record_with_it_beside_the_key() {
    let (app, operator, viewer) = guarded();
    let sign_in = async |token: &str, name: &str| {
        app.send("POST", "/sign-in", &[FORM, BROWSER], &format!("token={token}&name={name}&next=%2F")).await
    };
    let (anna, _) = cookie(&sign_in(&operator, "+Anna++O%27Brien+").await);
    let page = text(app.send("GET", "/", &[BROWSER, ("cookie", &anna)], "").await).await;
    assert!(page.contains("<b>operator (Anna O&#39;Brien)</b>"), "{page}");
    for path in ["/console/start", "/console/stop", "/h"] {
        app.send("POST", path, &[FORM, BROWSER, ("cookie", &anna)], "epoch=1").await;
        assert_eq!(&*app.last().issuer.who, "operator (Anna O'Brien)", "{path}");
    }
    let (eve, _) = cookie(&sign_in(&viewer, "operator").await);
    let start = app.send("POST", "/console/start", &[FORM, ("accept", "application/json"), ("cookie", &eve)], "epoch=1").await;
    assert_eq!(start.status(), 403, "a viewer by the name of operator is a viewer");

    let long = "x".repeat(33);
    for wrong in ["%3Cb%3E", "a%00b", "Anna%29+%28console", long.as_str()] {
        let refused = sign_in(&operator, wrong).await;
        assert!(refused.status() == 422 && refused.headers().get("set-cookie").is_none(), "{wrong}");
        let page = text(refused).await;
        assert!(page.contains("up to 32 letters") && !page.contains("<b>"), "{page}");
    }
}

#[tokio::test]
async fn over_tls_the_cookie_is_for_tls_only() {
    let peer = Peer { address: std::net::Ipv4Addr::LOCALHOST.into(), is_encrypted: true };
    let (app, ..) = guarded();
    assert!(cookie(&sign_out(app.door.clone(), peer).await).1.ends_with("; Secure"));
}

/// Safety S1.
#[tokio::test]
async fn whoever_is_signed_in_can_stop_from_the_page_where_one_signs_in_too() {
    let (app, operator, viewer) = guarded();
    let stop = "action=\"./console/stop\"";
    let bearer = format!("Bearer {viewer}");
    let known = [BROWSER, ("authorization", &bearer)];
    let page = text(app.send("GET", &format!("/sign-in?token={operator}"), &known, "").await).await;
    assert!(page.contains(stop), "{page}");
    let refused = app.send("POST", "/sign-in", &[FORM, BROWSER, ("authorization", &bearer)], "token=wrong").await;
    assert!(refused.status() == 403 && text(refused).await.contains(stop));
    let page = text(app.send("GET", "/sign-in", &[BROWSER], "").await).await;
    assert!(!page.contains(stop), "a stranger's STOP would not be taken: {page}");
}

#[tokio::test]
async fn a_link_fills_the_field_and_signs_nobody_in() {
    let (app, operator, _) = guarded();
    let response = app.send("GET", &format!("/sign-in?token={operator}&next=/console/live"), &[BROWSER], "").await;
    assert!(response.headers().get("set-cookie").is_none());
    assert_eq!(response.headers()["cache-control"], "no-store");
    let page = text(response).await;
    assert!(page.contains(&format!("value=\"{operator}\"")) && page.contains("name=\"next\" value=\"/console/live\""));
    let page = text(app.send("GET", "/sign-in?token=%22%3E%3Cscript%3E", &[BROWSER], "").await).await;
    assert!(!page.contains("<script>"), "{page}");
    assert_eq!(app.send("GET", "/sign-in?%FF=%&token=1&token=2", &[BROWSER], "").await.status(), 200);
}

/// Safety A3.
#[tokio::test(start_paused = true)]
async fn wrong_tokens_are_answered_later_and_later_and_right_ones_at_once() {
    let (app, operator, viewer) = guarded();
    // The paused clock advances only when all tasks wait for it. An answer without delay therefore takes no time.
    let within = async |ms: u64, token: &str, by_form: bool| {
        let bearer = format!("Bearer {token}");
        let answer = async {
            match by_form {
                true => app.send("POST", "/sign-in", &[FORM, BROWSER], &format!("token={token}")).await,
                false => app.send("POST", "/api/v1/commands/stop", &[("authorization", &bearer)], "").await,
            }
        };
        tokio::time::timeout(std::time::Duration::from_millis(ms), answer).await.ok().map(|answer| answer.status().as_u16())
    };
    assert_eq!(within(240, "wrong", true).await, None);
    assert_eq!(within(490, "wrong", false).await, None, "by whichever way");
    assert_eq!(within(990, "wrong", true).await, None);
    assert_eq!(within(2100, "wrong", false).await, Some(401));
    assert_eq!(within(4100, "wrong", true).await, Some(403));
    for token in [&operator, &viewer] {
        assert_eq!(within(1, token, false).await, Some(200), "a STOP with a right token is never held back");
        assert_eq!(within(1, token, true).await, Some(303));
    }
}

#[tokio::test]
async fn whoever_signed_out_is_asked_again() {
    let (app, _, viewer) = guarded();
    let (cookie, _) = cookie(&app.send("POST", "/sign-in", &[FORM], &format!("token={viewer}")).await);
    assert_eq!(leads(&app.send("GET", "/sign-in", &[BROWSER, ("cookie", &cookie)], "").await, "/sign-in"), "/");
    let out = app.send("POST", "/sign-out", &[FORM, BROWSER, ("cookie", &cookie)], "").await;
    assert_eq!((out.status().as_u16(), &*leads(&out, "/sign-out")), (303, "/sign-in"));
    let (gone, set) = self::cookie(&out);
    assert!(gone == "hallsweep-0=" && set.contains("Max-Age=0"), "{set}");
    assert_eq!(leads(&app.send("GET", "/", &[BROWSER, ("cookie", &gone)], "").await, "/"), "/sign-in");
}

/// Safety S1.
#[tokio::test]
async fn whoever_pressed_something_and_is_not_signed_in_any_more_reads_that_it_was_not_done() {
    let (app, ..) = guarded();
    for (path, words) in [
        ("/console/stop", "STOP was not carried out: you are not signed in any more."),
        ("/h", "STOP was not carried out"),
        ("/console/danger", "Your command was not carried out"),
    ] {
        let led = app.send("POST", path, &[FORM, BROWSER, ("cookie", "hallsweep-0=old")], "id=3").await;
        let page = text(app.send("GET", &leads(&led, path), &[BROWSER], "").await).await;
        assert!(page.contains(words), "{path}: {page}");
    }
    let watched = text(app.send("GET", &Undone::Watching.page(), &[BROWSER], "").await).await;
    assert!(watched.contains("You are not signed in any more: "), "{watched}");
    assert!(!text(app.send("GET", "/sign-in?undone=nonsense", &[BROWSER], "").await).await.contains("undone"));
    assert!(app.given.lock().unwrap().is_empty());
}

#[tokio::test]
async fn a_viewers_page_has_one_living_button_beside_signing_out_and_the_language() {
    let (app, _, viewer) = guarded();
    let (cookie, _) = cookie(&app.send("POST", "/sign-in", &[FORM], &format!("token={viewer}")).await);
    let page = text(app.send("GET", "/", &[BROWSER, ("cookie", &cookie)], "").await).await;
    let forms = page.split("<form ").skip(1).filter(|form| !form.starts_with("method=\"post\">"));
    for form in forms {
        let lives =
            ["id=\"stop\"", "id=\"who\"", "method=\"post\" action=\"./language\""].iter().any(|begin| form.starts_with(begin));
        let (form, _) = form.split_once("</form>").unwrap();
        let buttons = form.matches("<button").count();
        let dead = form.matches("<button").count().min(form.matches("disabled title=\"you are signed in as a viewer\"").count());
        let fieldset = form.contains("<fieldset") && dead == 1;
        assert_eq!(dead == buttons || fieldset, !lives, "{form}");
    }
    assert!(page.contains("START: you are signed in as a viewer."));
    assert!(page.contains("You are signed in as a viewer: you see everything and may press STOP."));
}

#[tokio::test]
async fn a_page_of_another_origin_signs_nobody_in() {
    let (app, operator, _) = guarded();
    let foreign = [FORM, BROWSER, ("sec-fetch-site", "cross-site")];
    let response = app.send("POST", "/sign-in", &foreign, &format!("token={operator}")).await;
    assert!(response.status() == 403 && response.headers().get("set-cookie").is_none());
}

#[tokio::test]
async fn an_open_door_needs_no_page_to_sign_in() {
    let app = app(searching());
    assert_eq!(leads(&app.send("GET", "/sign-in?next=/console/live", &[BROWSER], "").await, "/sign-in"), "/console/live");
}

#[test]
fn the_way_back_never_leads_away() {
    for path in ["/", "/console/confirm/danger/3", "/nowhere?a=b..c"] {
        assert_eq!(local(Some(path)), path);
    }
    let long = format!("/{}", "a".repeat(LONGEST_PATH));
    for away in [
        "",
        "//elsewhere.example",
        "/\\elsewhere.example",
        "https://elsewhere.example",
        "/\t/a",
        "/ä",
        "/a b",
        "/../elsewhere",
        "/missions/%2E%2e/.%2e/elsewhere",
        "/..?a=b",
        "/missions%2F1",
        "elsewhere",
        &long,
    ] {
        assert_eq!(local(Some(away)), "/", "{away:?}");
    }
    assert_eq!(sign_in_page("/missions/1/moment?at=4"), "/sign-in?next=/missions/1/moment%3Fat%3D4");
    assert_eq!(sign_in_page("/a?b&next=//c"), "/sign-in?next=/a%3Fb%26next%3D//c");
    assert_eq!(sign_in_page("/a%2Fb"), "/sign-in", "what is escaped already stays out");
}

/// Safety A2.
#[tokio::test]
async fn an_expired_session_cookie_of_an_earlier_run_is_refused() {
    let (keyring, tokens) = keys();
    let app = guarded_app(searching(), Access::Keys(keyring.clone()));
    let earlier_run = Keyring::of((*keyring.keys()).clone()).unwrap();
    for (began_s, status) in [(-SESSION_S + 60, 200), (-SESSION_S, 401), (-2 * SESSION_S, 401)] {
        let now = app.door.process.moment();
        let session =
            earlier_run.sign_in(&tokens.operator, &Person::default(), Moment { unix_s: now.unix_s + began_s, ..now }).unwrap();
        let cookie = format!("hallsweep-0={session}");
        assert_eq!(app.send("GET", "/api/v1/state", &[("cookie", &cookie)], "").await.status(), status, "{began_s} s");
        let stop = app.send("POST", "/api/v1/commands/stop", &[("cookie", &cookie)], "").await;
        assert_eq!(stop.status(), status, "{began_s} s");
    }
    assert_eq!(app.given.lock().unwrap().len(), 1, "one STOP was taken");
}

/// Safety S8, A2.
#[tokio::test(start_paused = true)]
async fn however_the_clock_is_set_a_session_stops_the_robot_and_looks_on_for_twelve_hours_and_not_longer() {
    for set_s in [-600, -3600, 46_800, 30 * 86_400] {
        let (keyring, tokens) = keys();
        let mut app = guarded_app(searching(), Access::Keys(keyring));
        let form = format!("token={}", tokens.viewer);
        let (cookie, _) = cookie(&app.send("POST", "/sign-in", &[FORM], &form).await);
        let process = Arc::make_mut(&mut app.door.process);
        process.clock = process.clock.set_by(set_s * 1000);
        let stream = app.send("GET", "/console/live", &[("cookie", &cookie)], "").await;
        let mut parts = stream.into_body().into_data_stream();
        let status = async |app: &TestApp| {
            let stop = app.send("POST", "/api/v1/commands/stop", &[("cookie", &cookie)], "").await.status().as_u16();
            (stop, app.send("GET", "/console/live", &[("cookie", &cookie)], "").await.status().as_u16())
        };
        assert_eq!(status(&app).await, (200, 200), "{set_s} s");
        tokio::time::sleep(Duration::from_secs(SESSION_S.unsigned_abs() - 60)).await;
        assert_eq!(status(&app).await, (200, 200), "{set_s} s");
        assert!(parts.next().await.is_some(), "the stream that was open goes on");
        tokio::time::sleep(Duration::from_secs(120)).await;
        assert_eq!(status(&app).await, (401, 401), "{set_s} s");
        while let Some(part) = parts.next().await {
            part.expect("it ends in order");
        }
    }
}

#[tokio::test]
async fn instances_at_several_ports_of_one_host_leave_each_others_sessions_alone() {
    let (keyring, tokens) = keys();
    let mut app = guarded_app(searching(), Access::Keys(keyring));
    let form = format!("token={}", tokens.operator);
    let mut jar = String::new();
    for port in [8080, 8081] {
        Arc::make_mut(&mut app.door.process).cookie = cookie_name(port);
        let (cookie, _) = cookie(&app.send("POST", "/sign-in", &[FORM], &form).await);
        assert!(cookie.starts_with(&format!("hallsweep-{port}=")), "{cookie}");
        jar = format!("{jar}{}{cookie}", if jar.is_empty() { "" } else { "; " });
    }
    for (port, status) in [(8080, 200), (8081, 200), (8082, 401)] {
        Arc::make_mut(&mut app.door.process).cookie = cookie_name(port);
        assert_eq!(app.send("GET", "/api/v1/state", &[("cookie", &jar)], "").await.status(), status, "{port}");
    }
}

#[tokio::test]
async fn every_state_of_the_page_is_there_in_italian_and_in_the_other_language_stays_what_it_is() {
    let (app, operator, viewer) = guarded();
    let names = ["Token"];
    let page = app.italian("GET", &format!("/sign-in?token={operator}&next=/missions&undone=stop"), "", &[], &names).await;
    for wanted in [
        "<h1>Accedere a hallsweep</h1>".to_owned(),
        "STOP non è stato eseguito".to_owned(),
        "lang=\"en\">English</button>".to_owned(),
        format!("name=\"next\" value=\"/sign-in?token={operator}&#38;next=/missions&#38;undone=stop\""),
    ] {
        assert!(page.contains(&wanted), "{wanted}: {page}");
    }
    for (undone, words) in [("command", "Il comando premuto non è stato eseguito"), ("watching", "L&#39;accesso non vale più: ")]
    {
        let page = app.italian("GET", &format!("/sign-in?undone={undone}"), "", &[], &names).await;
        assert!(page.contains(words), "{page}");
    }
    let known = [("authorization", &*format!("Bearer {viewer}"))];
    let page = app.italian("POST", "/sign-in", "token=wrong&next=%2Fmissions", &known, &names).await;
    assert!(page.contains("Questo token qui non è conosciuto") && page.contains("ferma tutti i robot"), "{page}");
    assert!(page.contains("name=\"next\" value=\"/sign-in?next=/missions\""), "{page}");
    let page = app.italian("GET", "/sign-in?next=%22%3E%26token%3D1", "", &[], &names).await;
    assert!(page.contains("name=\"next\" value=\"/sign-in\""), "{page}");
}

#[tokio::test]
async fn what_is_seldom_said_is_there_in_both_languages_too() {
    for language in Language::ALL {
        assert!(unusable(language).contains("access.toml"));
        let peer = Peer { address: std::net::Ipv4Addr::new(192, 168, 0, 7).into(), is_encrypted: false };
        let page = text(shown(StatusCode::OK, peer, SignIn { language, ..SignIn::default() })).await;
        assert!(page.contains(&language.say("sign-in-overheard").to_string()), "{page}");
    }
}
