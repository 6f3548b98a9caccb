//! Tests of requests and their answers: representations, actions, and refusals with their reasons. `table_tests`
//! tests the table.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use super::testing::{PAST, TestApp, UNREADABLE, app, driven_app, get, post, put};
use super::*;
use crate::api::cbor;
use crate::api::tests::fixture::{idle, piece, searching, touch};
use coap_endpoint::{Code, Format};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, LuggageRef, Move, Note, Strategy, TemperatureReport, Verdict};
use hallsweep_core::robot::RobotState;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{AlarmId, Cell, Epoch, LuggageId};
use hallsweep_core::world::luggage::{Luggage, PhotoState};
use hallsweep_core::world::resource::Resource;

fn accepting(format: Format, request: Request) -> Request {
    Request { accept: Some(format), ..request }
}

fn labelled(format: Format, payload: Vec<u8>, request: Request) -> Request {
    Request { format: Some(format), payload, ..request }
}

async fn code(app: &TestApp, request: Request) -> String {
    app.said(request).await.0
}

fn change(app: &TestApp, revision: u64, resources: &[Resource], change: impl FnOnce(&mut Snapshot)) {
    app.publish.send_modify(|state| {
        let mut newer = Snapshot::clone(state);
        change(&mut newer);
        touch(&mut newer, revision, resources);
        *state = Arc::new(newer);
    });
}

fn words(answer: &Answer) -> Vec<String> {
    answer.observed.iter().map(|item| String::from_utf8_lossy(&item.body).into_owned()).collect()
}

#[tokio::test]
async fn every_command_reaches_the_loop_as_what_it_says() {
    let app = app(searching());
    let verdict =
        |verdict| Command::Verdict { luggage: LuggageRef::Id(LuggageId(3)), verdict, note: None, hot: Default::default() };
    let noted = Command::Verdict {
        luggage: LuggageRef::Id(LuggageId(3)),
        verdict: Verdict::Safe,
        note: Note::new("red"),
        hot: Default::default(),
    };
    let cases = [
        (post("/commands/start", ""), Command::Start),
        (post("/commands/start", "{}"), Command::Start),
        (post("/commands/stop", ""), Command::Stop),
        (post("/commands/backHome", ""), Command::BackHome),
        (post("/commands/retrieve", ""), Command::Retrieve(None)),
        (post("/commands/reset", ""), Command::Reset),
        (post("/commands/move", r#"{"move":"w"}"#), Command::Move(Move::Forward)),
        (post("/commands/move", r#"{"move":"h"}"#), Command::Stop),
        (post("/commands/goto", r#"{"x":4,"y":-2}"#), Command::Goto(Cell::new(4, -2))),
        (post("/luggage/3/verdict", r#"{"verdict":"safe"}"#), verdict(Verdict::Safe)),
        (post("/luggage/3/verdict", r#"{"verdict":"safe","note":"red"}"#), noted),
        (put("/luggage/3/verdict", r#"{"verdict":"danger"}"#), verdict(Verdict::Danger)),
        (post("/luggage/3/photo", ""), Command::RetakePhoto(LuggageId(3))),
        (post("/alarms/1/acknowledge", ""), Command::Acknowledge(AlarmId(1))),
        (put("/temperature", r#"{"status":"tooHigh"}"#), Command::Temperature(TemperatureReport::TooHigh)),
        (post("/temperature", r#"{"status":"ok"}"#), Command::Temperature(TemperatureReport::Ok)),
        (put("/strategy", r#"{"name":"snail"}"#), Command::ChooseStrategy(Strategy::Snail)),
        (post("/strategy", r#"{"name":"snail"}"#), Command::ChooseStrategy(Strategy::Snail)),
    ];
    for (request, command) in cases {
        assert_eq!(app.said(request.clone()).await.0, "2.04", "{request:?}");
        assert_eq!(app.last().command, command, "{request:?}");
        assert_eq!(app.last().issuer.to_string(), "operator (coap, 127.0.0.1)");
    }
}

#[tokio::test]
async fn a_command_is_given_before_its_answer_is_waited_for() {
    let app = app(searching());
    let answers: Vec<Reply> =
        ["start", "stop", "backHome"].map(|name| app.resources.answer(&post(&format!("/commands/{name}"), ""))).into();
    drop(answers);
    tokio::task::yield_now().await;
    let given: Vec<Command> = app.given.lock().unwrap().iter().map(|request| request.command.clone()).collect();
    assert_eq!(given, [Command::Start, Command::Stop, Command::BackHome]);
}

#[tokio::test]
async fn the_answer_says_in_every_format_that_it_was_accepted() {
    let app = app(searching());
    let verdict = || post("/luggage/3/verdict", r#"{"verdict":"safe"}"#);
    let (_, json) = app.said(verdict()).await;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json["accepted"], &json["revision"], &json["epoch"]), (&true.into(), &20.into(), &1.into()));
    assert_eq!(json["luggage"]["photo"]["url"], "/luggage/3/photo");
    assert_eq!(app.said(accepting(Format::TEXT, verdict())).await.1, "accepted");
    let answer = app.ask(accepting(Format::CBOR, post("/commands/start", ""))).await.response;
    assert_eq!(*answer.body, *b"\xa3\x68accepted\xf5\x68revision\x14\x65epoch\x01");
    let silent = app.ask(accepting(Format::PROBLEM, verdict())).await.response;
    assert_eq!((silent.code, silent.body.len()), (Code::CHANGED, 0));
    assert_eq!(code(&app, accepting(Format::PNG, verdict())).await, "4.06");
}

#[tokio::test]
async fn bodies_come_in_json_or_cbor_and_in_nothing_else() {
    let app = app(searching());
    let goto = serde_json::json!({"x": 1, "y": 2, "epoch": 8});
    let request = labelled(Format::CBOR, cbor::written(&goto), post("/commands/goto", ""));
    assert_eq!(code(&app, request).await, "2.04");
    assert_eq!((app.last().command, app.last().epoch), (Command::Goto(Cell::new(1, 2)), Some(Epoch(8))));
    let json = goto.to_string().into_bytes();
    assert_eq!(code(&app, labelled(Format::JSON, json.clone(), post("/commands/goto", ""))).await, "2.04");
    let text = app.said(labelled(Format::TEXT, json, post("/commands/goto", ""))).await;
    assert_eq!(text.0, "4.15");
    assert_eq!(text.1, "refused: the body is in text/plain (0): send application/json (50) or application/cbor (60)");
}

#[tokio::test]
async fn what_is_malformed_is_refused_with_the_code_that_fits_and_goes_on_record() {
    let app = app(searching());
    let cases = [
        (post("/commands/start", "{"), "4.00", "malformed"),
        (post("/commands/start", r#"{"epoc":1}"#), "4.22", "unusable"),
        (post("/commands/start", "[]"), "4.22", "unusable"),
        (post("/commands/start?epoch=1", ""), "4.00", "malformed"),
        (post("/commands/start?id=a b", ""), "4.00", "malformed"),
        (post("/commands/start?id=a&id=a", ""), "4.00", "malformed"),
        (post("/commands/start?id=", ""), "4.00", "malformed"),
        (post("/commands/move", ""), "4.00", "malformed"),
        (post("/commands/move", r#"{"move":"q"}"#), "4.22", "unusable"),
        (post("/commands/goto", r#"{"x":8193,"y":1}"#), "4.22", "unusable"),
        (post("/luggage/3/verdict", r#"{"verdict":"safe","verdict":"danger"}"#), "4.22", "unusable"),
        (post("/luggage/three/verdict", r#"{"verdict":"safe"}"#), "4.04", "notFound"),
        (put("/strategy", r#"{"name":"worm"}"#), "4.22", "unusable"),
        (put("/temperature", r#"{"celsius":-300}"#), "4.22", "unusable"),
        (put("/state", "{}"), "4.05", "methodNotAllowed"),
        (post("/nothing", ""), "4.04", "notFound"),
        (accepting(Format::PNG, post("/commands/start", "")), "4.06", "notAcceptable"),
    ];
    for (request, expect, word) in cases {
        let (code, words) = app.said(request.clone()).await;
        assert_eq!(code, expect, "{request:?}: {words}");
        assert!(words.starts_with("refused: "), "{words}");
        let (issuer, asked, refused) = app.noted().await.expect("it is on record");
        assert_eq!((refused.code(), &*issuer.from), (word, "127.0.0.1"));
        assert!(asked.to_string().starts_with(request.method.name()), "{asked}");
    }
    assert!(app.given.lock().unwrap().is_empty(), "nothing malformed reaches the loop");
    app.said(get("/nothing")).await;
    assert!(app.noted().await.is_none(), "who only looks is not recorded");
}

#[tokio::test]
async fn what_the_core_refuses_it_has_recorded_itself() {
    let app = app(searching());
    app.refuse(Refused::Decided { luggage: LuggageId(3), verdict: Verdict::Safe });
    let request = accepting(Format::JSON, post("/luggage/3/verdict", r#"{"verdict":"danger"}"#));
    let (code, json) = app.said(request).await;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((code.as_str(), &json["code"], &json["accepted"]), ("4.09", &"decided".into(), &false.into()));
    assert_eq!(json["luggage"]["id"], 3);
    assert!(app.noted().await.is_none());
}

/// Safety S1: a STOP halts whatever is wrong with its request.
#[tokio::test]
async fn a_stop_reads_nothing_of_its_request() {
    let app = app(searching());
    let wrong = Conditions { if_none_match: true, ..Conditions::default() };
    let stop = || post("/commands/stop", "{not json");
    for request in [
        stop(),
        labelled(Format(9999), vec![0xFF; 100], stop()),
        accepting(Format::PNG, stop()),
        Request { queries: vec!["id=a b".to_owned(), "x".to_owned()], ..stop() },
        Request { conditions: wrong.clone(), ..stop() },
        Request { conditions: wrong, queries: vec!["x".to_owned()], accept: Some(Format::CBOR), ..put("/resourcemodel", "h") },
        Request { queries: vec!["x".to_owned()], ..post("/commands/move", r#"{"move":"h"}"#) },
    ] {
        app.given.lock().unwrap().clear();
        assert_eq!(code(&app, request.clone()).await, "2.04", "{request:?}");
        assert_eq!(app.last().command, Command::Stop);
    }
}

/// Safety S1, S8: a request that `IS_STOP` recognises is carried out however many commands are under way.
#[test]
fn a_stop_is_known_by_its_path_and_word_and_nothing_else_is_one() {
    let is_stop = |request| Resources::IS_STOP(&request);
    for stop in [
        post("/commands/stop", "{not json"),
        post("/commands/move", r#"{"move":"h"}"#),
        put("/resourcemodel", "h"),
        labelled(Format(9999), b" h ".to_vec(), post("/resourcemodel", "")),
    ] {
        assert!(is_stop(stop.clone()), "{stop:?}");
        assert!(!is_stop(Request { peer: "192.0.2.7:1".parse().unwrap(), ..stop }), "others may not stop here");
    }
    for other in
        [post("/commands/move", r#"{"move":"w"}"#), put("/resourcemodel", "safe"), get("/commands/stop"), get("/nothing")]
    {
        assert!(!is_stop(other.clone()), "{other:?}");
    }
}

/// Safety A6.
#[tokio::test]
async fn the_name_of_a_command_and_the_epoch_its_sender_saw_go_with_it() {
    let app = app(searching());
    app.said(post("/commands/start?id=k7", r#"{"epoch":7}"#)).await;
    let given = app.last();
    assert_eq!((given.id.unwrap().text(), given.epoch), ("k7", Some(Epoch(7))));
}

#[tokio::test]
async fn a_condition_is_held_against_what_is_shown() {
    let app = app(searching());
    let temperature = |conditions| Request { conditions, ..put("/temperature", r#"{"celsius":21.5}"#) };
    let tag = |accept| {
        let request = Request { accept, ..get("/temperature") };
        let Reply::Now(answer) = app.resources.answer(&request) else { panic!("it is at hand") };
        answer.response.tag
    };
    for known in [tag(None), tag(Some(Format::TEXT)), None] {
        let conditions = Conditions { if_match: vec![known], if_none_match: false };
        assert_eq!(code(&app, temperature(conditions)).await, "2.04");
    }
    let stale = Conditions { if_match: vec![tag(None)], if_none_match: false };
    change(&app, 21, &[Resource::Temperature], |_| ());
    assert_eq!(code(&app, temperature(stale)).await, "4.12");
    assert_eq!(app.noted().await.unwrap().2.code(), "preconditionFailed");
    let only_new = Conditions { if_match: Vec::new(), if_none_match: true };
    assert_eq!(code(&app, temperature(only_new.clone())).await, "4.12");
    assert_eq!(code(&app, Request { conditions: only_new, ..post("/commands/start", "") }).await, "4.12");
}

#[tokio::test]
async fn the_texts_are_lines_for_people() {
    let app = app(searching());
    let text = async |path| app.said(accepting(Format::TEXT, get(path))).await.1;
    assert_eq!(text("/mission").await, "inspecting");
    assert_eq!(text("/temperature").await, "21.4 °C, ok");
    assert_eq!(text("/strategy").await, "snail");
    assert_eq!(text("/robot").await, "robot( state(stopped), direction(rightDir), position(2, 2))");
    assert!(text("/map").await.starts_with("|1, 1, 1, X, 1, X, \n"));
}

#[tokio::test]
async fn what_is_read_must_be_asked_for_again_and_what_is_observed_is_good_for_a_while() {
    let app = app(searching());
    for path in ["/state", "/robot", "/luggage/3", "/resourcemodel"] {
        let answer = app.ask(get(path)).await;
        assert_eq!(answer.response.max_age, Some(0), "{path}");
        assert!(answer.observed.iter().all(|thing| thing.max_age.is_none()), "{path}");
    }
}

#[tokio::test]
async fn the_list_of_links_is_made_when_luggage_or_alarms_change_and_not_at_every_get() {
    let app = app(searching());
    let links = async || app.ask(get("/.well-known/core")).await;
    let first = links().await;
    assert_eq!((first.response.max_age, first.observed.len()), (Some(0), 0));
    change(&app, 21, &[Resource::Robot, Resource::Map, Resource::Mission], |_| {});
    assert!(Arc::ptr_eq(&links().await.response, &first.response));
    change(&app, 22, &[Resource::Luggage], |state| state.luggage = Default::default());
    let second = links().await.response;
    assert!(String::from_utf8_lossy(&first.response.body).contains("</luggage/3>"));
    assert!(!String::from_utf8_lossy(&second.body).contains("</luggage/3>"));
    assert_ne!(first.response.tag, second.tag);
    change(&app, 23, &[Resource::Alarms], |state| state.alarms = Arc::default());
    assert!(String::from_utf8_lossy(&second.body).contains("</alarms/1/"));
    assert!(!String::from_utf8_lossy(&links().await.response.body).contains("</alarms/1/"));
    let filtered = app.ask(get("/.well-known/core?href=/robot")).await.response;
    assert_eq!(String::from_utf8_lossy(&filtered.body).matches("</").count(), 1, "{filtered:?}");
}

#[tokio::test]
async fn whoever_observes_is_shown_what_holds_now() {
    let app = app(searching());
    let request = get("/robot");
    let before = app.ask(request.clone()).await;
    assert!(Arc::ptr_eq(&before.observed[0], &app.resources.things(&request)[0]), "all share one");
    change(&app, 21, &[Resource::Robot], |state| state.robot.sonar_cm = None);
    let after = app.resources.things(&request);
    assert_ne!(before.observed[0].body, after[0].body);
    assert_eq!(app.ask(request).await.response.body, after[0].body);
}

#[tokio::test]
async fn an_observed_piece_ends_with_its_mission_and_can_still_be_read() {
    let app = app(searching());
    assert_eq!(app.resources.things(&get("/luggage/3"))[0].code, Code::CONTENT);
    change(&app, 21, &[Resource::Luggage], |state| state.luggage = Default::default());
    assert_eq!(app.resources.things(&get("/luggage/3"))[0].code, Code::NOT_FOUND);
    let past = app.ask(get(&format!("/luggage/{PAST}"))).await;
    assert!(past.response.code == Code::CONTENT && past.observed.is_empty());
    for missing in ["/luggage/71", "/luggage/71/photo", "/luggage/01"] {
        assert_eq!(code(&app, get(missing)).await, "4.04");
        let unavailable = accepting(Format::LINKS, get(missing));
        assert_eq!(code(&app, unavailable).await, "4.04", "there is none in any format: {missing}");
    }
    for there in [format!("/luggage/{PAST}"), format!("/luggage/{PAST}/photo")] {
        assert_eq!(code(&app, accepting(Format::LINKS, get(&there))).await, "4.06");
    }
    assert_eq!(app.said(get(&format!("/luggage/{UNREADABLE}"))).await.0, "5.03");
}

#[tokio::test]
async fn a_photo_is_read_once_and_again_after_a_retake() {
    let app = app(searching());
    let photo = || get("/luggage/3/photo");
    let first = app.ask(photo()).await.response;
    assert_eq!((&*first.body, first.format), (&b"\x89PNG"[..], Some(Format::PNG)));
    for _ in 0..1000 {
        assert_eq!(app.ask(photo()).await.response.tag, first.tag);
    }
    assert_eq!(app.photos_read.load(Ordering::SeqCst), 1);
    change(&app, 21, &[Resource::Luggage], |state| {
        let again = Luggage { photo: PhotoState::Taken { bytes: 4, take: 2 }, ..(*state.luggage[2]).clone() };
        state.luggage = [Arc::new(again)].into();
    });
    assert_ne!(app.ask(photo()).await.response.tag, first.tag);
    assert_eq!(app.photos_read.load(Ordering::SeqCst), 2);
}

#[tokio::test]
async fn a_photo_of_a_mission_that_is_over_is_there_and_one_that_failed_says_why() {
    let app = app(searching());
    let past = || get(&format!("/luggage/{PAST}/photo"));
    let tag = app.ask(past()).await.response.tag;
    assert_eq!(tag, Some(photos::tag(&piece(PAST, Cell::HOME, None))));
    app.ask(past()).await;
    assert_eq!(app.photos_read.load(Ordering::SeqCst), 1);
    change(&app, 21, &[Resource::Luggage], |state| {
        let failed = Luggage { photo: PhotoState::Failed("lens covered".to_owned()), ..(*state.luggage[2]).clone() };
        state.luggage = [Arc::new(failed)].into();
    });
    let (code, words) = app.said(get("/luggage/3/photo")).await;
    assert_eq!((code.as_str(), words.as_str()), ("4.04", "there is no photo of luggage #3: lens covered; take the photo again"));
    assert_eq!(app.said(get("/luggage/71/photo")).await, ("4.04".to_owned(), "there is no luggage #71".to_owned()));
}

#[tokio::test]
async fn the_old_model_shows_the_robot_until_something_changes_and_then_that() {
    let app = app(idle());
    let shown = async || app.said(get("/resourcemodel")).await.1;
    let robot = "robot( state(stopped), direction(downDir), position(0, 0))";
    assert_eq!(shown().await, robot);
    assert_eq!(words(&app.ask(get("/resourcemodel")).await), [robot, "roomMap( 'r @' )"]);
    change(&app, 2, &[Resource::Robot], |state| state.robot.state = RobotState::MovingForward);
    assert_eq!(shown().await, "robot( state(movingForward), direction(downDir), position(0, 0))");
    change(&app, 3, &[Resource::Map], |state| state.map = crate::api::tests::fixture::drawn(&["11X", "11W"], 3));
    assert_eq!(shown().await, "roomMap( 'r 1 0 @1 1 X @' )");
    change(&app, 4, &[Resource::Luggage], |state| state.luggage = [piece(1, Cell::new(0, 2), None)].into());
    let luggage = "luggage( state( 'photo 1, position: (0, 2), date: 2026-02-03T10:00:00.000+01:00' ) )";
    assert_eq!(shown().await, luggage);
    change(&app, 5, &[Resource::Temperature, Resource::Robot], |state| state.robot.sonar_cm = Some(12));
    assert_eq!(shown().await, luggage, "none of the items has changed");
    let observed = words(&app.ask(get("/resourcemodel")).await);
    assert_eq!((observed.len(), observed[2].as_str()), (3, luggage));
    assert_eq!(app.resources.things(&get("/resourcemodel")).len(), 3);
}

#[tokio::test]
async fn the_old_model_shows_what_changed_last_however_seldom_somebody_looks() {
    let app = app(idle());
    let shown = async || app.said(get("/resourcemodel")).await.1;
    let moves = |state: &mut Snapshot| {
        let is_forward = state.robot.state == RobotState::MovingForward;
        state.robot.state = if is_forward { RobotState::Stopped } else { RobotState::MovingForward };
    };
    let finds = |state: &mut Snapshot| state.luggage = [piece(1, Cell::new(0, 2), None)].into();
    change(&app, 2, &[Resource::Luggage], finds);
    change(&app, 3, &[Resource::Robot, Resource::Mission], moves);
    assert!(shown().await.starts_with("robot("), "the mission is no piece of luggage");
    change(&app, 4, &[Resource::Robot], moves);
    app.resources.handle_change();
    change(&app, 5, &[Resource::Luggage], |state| state.luggage = [piece(2, Cell::new(0, 3), None)].into());
    app.resources.handle_change();
    change(&app, 6, &[Resource::Robot, Resource::Mission], |state| state.robot.sonar_cm = Some(7));
    assert!(shown().await.starts_with("luggage("), "what is not shown of the robot hides nothing");
    change(&app, 7, &[Resource::Robot], moves);
    app.resources.handle_change();
    change(&app, 8, &[Resource::Mission], |_| ());
    assert!(shown().await.starts_with("robot("));
}

#[tokio::test]
async fn an_old_client_is_answered_in_a_word() {
    let app = driven_app(searching(), true);
    let cases = [
        ("w", Command::Move(Move::Forward)),
        ("h", Command::Stop),
        ("safe", Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Safe, note: None, hot: Default::default() }),
    ];
    for (word, command) in cases {
        for request in [put("/resourcemodel", word), post("/resourcemodel", word)] {
            let answer = app.ask(request).await.response;
            assert_eq!((answer.code, answer.format, &*answer.body), (Code::CHANGED, Some(Format::TEXT), &b"accepted"[..]));
            assert_eq!(app.last().command, command);
        }
    }
    app.refuse(Refused::NothingPending);
    let said = app.said(put("/resourcemodel", "safe")).await;
    assert_eq!(said, ("4.09".to_owned(), "refused: no luggage waits for a verdict".to_owned()));
}

#[tokio::test]
async fn a_stray_word_is_refused_and_recorded_as_what_it_was() {
    let app = app(searching());
    let (code, words) = app.said(put("/resourcemodel", "w")).await;
    assert!(code == "4.03" && words.starts_with("refused: ") && words.contains("manual_driving"), "{code} {words}");
    let (issuer, asked, refused) = app.noted().await.unwrap();
    assert_eq!(
        (issuer.door, asked, refused.code()),
        (crate::api::door::COAP, Asked::Command(Command::Move(Move::Forward)), "notAllowed")
    );
    assert!(app.given.lock().unwrap().is_empty());
}
