//! Tests of commands by their topics: what reaches the loop, the answers, the records, and the rights. Tests of the
//! limits are in `bounds_tests`.

use super::table;
use super::testing::{app, driven_app, here, say, viewer};
use super::*;
use crate::api::commands::COMMANDS;
use crate::api::tests::fixture::{degrees, searching};
use hallsweep_core::asked::Asked;
use hallsweep_core::closing::{AreaClosing, Closing};
use hallsweep_core::command::{Again, LuggageRef, Move, Note, Strategy, TemperatureReport, Verdict};
use hallsweep_core::hand_over::HandOver;
use hallsweep_core::refused::Refused;
use hallsweep_core::units::{AlarmId, Cell, LuggageId, MissionId};
use hallsweep_core::world::hall_map::Bounds;
use hallsweep_core::world::luggage::Luggage;

const OLD: &str = "unibo/qak/events";

fn event(id: &str) -> String {
    format!("msg({id},event,js,none,{id},1)")
}

fn all_commands() -> Vec<(&'static str, &'static str, Command)> {
    let verdict =
        |verdict| Command::Verdict { luggage: LuggageRef::Id(LuggageId(3)), verdict, note: None, hot: Default::default() };
    let noted = Command::Verdict {
        luggage: LuggageRef::Id(LuggageId(3)),
        verdict: Verdict::Safe,
        note: Note::new("red"),
        hot: Default::default(),
    };
    let temperature = Command::Temperature;
    let closing = |seen: &str| Command::Close(Closing { name: Note::new("Anna Rossi").unwrap(), note: None, seen: seen.into() });
    let (area, name) = ("gate 1".into(), Note::new("Anna Rossi").unwrap());
    let closing_area = Command::CloseArea(AreaClosing { area, name, note: None, mission: Some(MissionId(7)) });
    let unsure = Command::Unsure { luggage: LuggageRef::Id(LuggageId(3)), note: None, hot: Default::default() };
    vec![
        ("start", "", Command::Start),
        ("start", " \r\n", Command::Start),
        ("start", "{}", Command::Start),
        ("stop", "", Command::Stop),
        ("backHome", "", Command::BackHome),
        ("goOn", "", Command::GoOn),
        ("retrieve", r#"{"epoch":4}"#, Command::Retrieve(None)),
        ("retrieve", r#"{"luggage":3}"#, Command::Retrieve(Some(LuggageId(3)))),
        ("reset", "", Command::Reset),
        ("close", r#"{"name":"Anna Rossi","openPoints":"7:1,0,0,0,0,0,0"}"#, closing("7:1,0,0,0,0,0,0")),
        ("close", r#"{"name":" Anna Rossi ","note":null}"#, closing("")),
        (
            "handOver",
            r#"{"to":"police"}"#,
            Command::HandOver(HandOver { mission: None, to: Note::new("police").unwrap(), note: None }),
        ),
        ("searchAgain", r#"{"x":0,"y":0,"toX":0,"toY":0}"#, Command::SearchAgain(Again::Within(Bounds::of(Cell::HOME)))),
        ("searchAgain", r#"{"area":"gate 1"}"#, Command::SearchAgain(Again::Area("gate 1".into()))),
        ("orderAreas", r#"{"areas":["gate 2","gate 1"]}"#, Command::OrderAreas(["gate 2".into(), "gate 1".into()].into())),
        ("orderAreas", r#"{"areas":[]}"#, Command::OrderAreas([].into())),
        ("closeArea", r#"{"area":"gate 1","name":"Anna Rossi","mission":7}"#, closing_area),
        ("move", r#"{"move":"w"}"#, Command::Move(Move::Forward)),
        ("move", r#"{"move":"h"}"#, Command::Stop),
        ("goto", r#"{"x":4,"y":-2}"#, Command::Goto(Cell::new(4, -2))),
        ("verdict", r#"{"luggage":3,"verdict":"safe"}"#, verdict(Verdict::Safe)),
        ("verdict", r#"{"luggage":3,"verdict":"safe","note":"red"}"#, noted),
        ("verdict", r#"{"verdict":"danger","luggage":3}"#, verdict(Verdict::Danger)),
        ("verdict", r#"{"verdict":"unsure","luggage":3}"#, unsure),
        ("retake", r#"{"luggage":3}"#, Command::RetakePhoto(LuggageId(3))),
        ("acknowledge", r#"{"alarm":2}"#, Command::Acknowledge(AlarmId(2))),
        ("strategy", r#"{"name":"snail"}"#, Command::ChooseStrategy(Strategy::Snail)),
        ("temperature", r#"{"status":"tooHigh"}"#, temperature(TemperatureReport::TooHigh)),
        ("temperature", r#"{"celsius":21.5}"#, temperature(TemperatureReport::Reading(degrees(21.5)))),
        (
            "temperature",
            r#"{"celsius":21.5,"sensor":"roof"}"#,
            temperature(TemperatureReport::Sensor("roof".into(), degrees(21.5))),
        ),
    ]
}

#[tokio::test]
async fn every_command_reaches_the_loop_as_what_it_says_and_is_answered_beside_its_topic() {
    let mut app = app(searching());
    for row in &COMMANDS {
        assert!(all_commands().iter().any(|(name, _, _)| *name == row.name), "{} is not among them", row.name);
    }
    for (name, payload, command) in all_commands() {
        let (topic, json) = app.ask(&format!("command/{name}"), payload).await;
        assert_eq!(app.last().await.command, command, "{name} {payload}");
        assert_eq!(topic, format!("command/{name}/result"));
        assert_eq!((&json["accepted"], &json["revision"], &json["epoch"]), (&true.into(), &20.into(), &1.into()));
        assert_eq!(json.get("id"), None, "{name} had no name of its own");
    }
}

#[tokio::test]
async fn what_the_table_shows_as_payloads_is_taken() {
    let mut app = app(searching());
    for row in &COMMANDS {
        for payload in row.body {
            let (_, json) = app.ask(&format!("command/{}", row.name), payload).await;
            assert_eq!(json["accepted"], true, "{} {payload}: {json}", row.name);
        }
    }
}

#[tokio::test]
async fn wrong_orders_of_areas_are_answered_with_what_is_wrong() {
    let mut app = app(searching());
    let given = app.given().await;
    let many = serde_json::json!({ "areas": vec!["gate"; 10_000] }).to_string();
    for (name, payload, status) in [
        ("orderAreas", "orderAreas", 400),
        ("orderAreas", r#"{"areas":"gate"}"#, 422),
        ("orderAreas", r#"{"areas":["gate","gate"]}"#, 422),
        ("orderAreas", r#"{"areas":["\u0007"]}"#, 422),
        ("orderAreas", r#"{"areas":[{"name":"gate"}]}"#, 422),
        ("orderAreas", &many, 413),
        ("closeArea", r#"{"area":"gate"}"#, 422),
        ("closeArea", r#"{"area":"gate","name":"\u2028"}"#, 422),
        ("searchAgain", r#"{"area":"gate","toX":1}"#, 422),
    ] {
        let (topic, json) = app.ask(&format!("command/{name}"), payload).await;
        assert_eq!((topic, &json["status"]), (format!("command/{name}/result"), &status.into()), "{payload:.80}: {json}");
    }
    assert_eq!(app.given().await, given);
}

#[tokio::test]
async fn a_command_goes_with_its_own_name_its_epoch_and_its_sender() {
    let mut app = app(searching());
    for (name, payload, _) in all_commands() {
        let body = if payload.trim().is_empty() { "{}" } else { payload };
        let named = body.replacen('{', r#"{"id":"k7","#, 1).replace(",}", "}");
        let (_, json) = app.ask(&format!("command/{name}"), &named).await;
        assert_eq!(json["id"], "k7", "{named}");
        let given = app.last().await;
        assert_eq!(given.id.map(|id| id.text().to_owned()).as_deref(), Some("k7"), "{named}");
        assert_eq!(given.issuer.to_string(), "operator (mqtt, 127.0.0.1)");
    }
    app.ask("command/goto", r#"{"x":1,"y":1,"epoch":8}"#).await;
    assert_eq!(app.last().await.epoch, Some(Epoch(8)));
}

#[tokio::test]
async fn a_bare_word_is_a_command_without_arguments() {
    let mut app = app(searching());
    for row in COMMANDS.iter().filter(|row| row.is_word()) {
        for word in [row.name.to_owned(), format!("\"{}\"", row.name), format!(" {}\n", row.name)] {
            let (topic, json) = app.ask("command", &word).await;
            assert_eq!((topic, &json["accepted"]), (format!("command/{}/result", row.name), &true.into()), "{word}");
        }
    }
    for halt in ["STOP", "Stop", "h"] {
        assert_eq!(app.ask("command", halt).await.0, "command/stop/result");
        assert_eq!(app.last().await.command, Command::Stop);
    }
    let given = app.given().await;
    let (topic, json) = app.ask("command", "goto").await;
    assert_eq!((topic.as_str(), &json["status"], &json["code"]), ("command/goto/result", &404.into(), &"notFound".into()));
    assert!(json["detail"].as_str().unwrap().contains("start, stop, backHome, goOn, retrieve, reset"), "{json}");
    for strange in [&b"\xff\xfe"[..], b"", b"{}", b"start stop"] {
        let (topic, json) = app.ask("command", strange).await;
        assert_eq!((topic.as_str(), &json["status"]), ("command/unknown/result", &404.into()));
    }
    assert_eq!(app.given().await, given);
}

/// Safety A6: every refusal is recorded.
#[tokio::test]
async fn what_is_wrong_is_refused_in_words_and_put_on_record() {
    let mut app = app(searching());
    let large = format!(r#"{{"move":"{}"}}"#, "w".repeat(4096));
    let cases = [
        ("start", "{", 400, "malformed", "the body is not JSON"),
        ("start", "PRESS", 400, "malformed", "the body is not JSON"),
        ("start", r#"{"epoc":1}"#, 422, "unusable", "no field `epoc`: its fields are epoch, id"),
        ("start", r#"{"epoch":-1}"#, 422, "unusable", "`epoch` is -1: send a whole number from 0"),
        ("start", "[]", 422, "unusable", "the body is a list: send a JSON object"),
        ("start", r#"{"id":"two words"}"#, 400, "malformed", "1 to 128 visible ASCII characters"),
        ("start", r#"{"id":7}"#, 422, "unusable", "`id` is 7: send a text in quotes"),
        ("start", r#"{"id":"a","id":"b"}"#, 422, "unusable", "`id` occurs twice"),
        ("move", "", 400, "malformed", "the payload is empty: this command needs JSON"),
        ("move", "{}", 422, "unusable", "`move` is missing"),
        ("move", r#"{"move":"q"}"#, 422, "unusable", "\"q\" is no move"),
        ("move", &large, 413, "tooLarge", "the maximum is 4096"),
        ("goto", r#"{"x":1}"#, 422, "unusable", "`y` is missing"),
        ("goto", r#"{"x":8193,"y":1}"#, 422, "unusable", "out of reach"),
        ("verdict", r#"{"verdict":"safe"}"#, 422, "unusable", "`luggage` is missing: send {\"luggage\":3,"),
        ("verdict", r#"{"luggage":"3","verdict":"safe"}"#, 422, "unusable", "`luggage` is \"3\": send a whole number from 0"),
        ("verdict", r#"{"luggage":3,"verdict":"maybe"}"#, 422, "unusable", "\"maybe\" is no verdict"),
        (
            "verdict",
            r#"{"luggage":3,"word":"safe"}"#,
            422,
            "unusable",
            "its fields are verdict, note, hidden, obvious, typical, size, id, luggage",
        ),
        ("verdict", r#"{"luggage":3,"verdict":"safe","note":"a\nb"}"#, 422, "unusable", "the invisible character '\\n'"),
        ("verdict", r#"{"luggage":3,"verdict":"safe","note":7}"#, 422, "unusable", "`note` is 7: send a text in quotes"),
        ("retake", "{}", 422, "unusable", "`luggage` is missing: send {\"luggage\":3}"),
        ("acknowledge", r#"{"luggage":1}"#, 422, "unusable", "`alarm` is missing: send {\"alarm\":2}"),
        ("strategy", r#"{"name":"worm"}"#, 422, "unusable", "there is no strategy \"worm\": send one of"),
        ("temperature", r#"{"celsius":-300}"#, 422, "unusable", "is not plausible"),
    ];
    for (name, payload, status, code, words) in cases {
        let (topic, json) = app.ask(&format!("command/{name}"), payload).await;
        assert_eq!(topic, format!("command/{name}/result"));
        assert_eq!((&json["status"], &json["code"]), (&status.into(), &code.into()), "{payload}: {json}");
        assert_eq!((&json["accepted"], &json["type"]), (&false.into(), &format!("urn:hallsweep:problem:{code}").into()));
        let said = json["detail"].as_str().unwrap();
        assert!(said.contains(words), "{payload}: {said}");
        let (issuer, asked, refused) = app.noted().await.expect("on record");
        assert_eq!((issuer.to_string().as_str(), asked), ("operator (mqtt, 127.0.0.1)", Asked::Words(format!("command {name}"))));
        assert_eq!((refused.code(), refused.to_string().as_str()), (code, said));
    }
    assert_eq!(app.given().await, 0, "nothing of this reaches the loop");
}

#[tokio::test]
async fn a_refusal_says_which_command_it_is_about_when_that_can_be_read() {
    let mut app = app(searching());
    let (_, json) = app.ask("command/goto", r#"{"id":"k9","x":"far","y":1}"#).await;
    assert_eq!((&json["id"], &json["status"]), (&"k9".into(), &422.into()));
    assert!(app.noted().await.is_some(), "this door has refused it");
    app.refuse(Refused::Moving);
    let (_, json) = app.ask("command/goto", r#"{"id":"k10","x":1,"y":1}"#).await;
    assert_eq!((&json["id"], &json["status"], &json["code"]), (&"k10".into(), &409.into(), &"moving".into()));
    assert!(app.noted().await.is_none(), "the core has that on record itself");
}

#[tokio::test]
async fn a_name_that_is_none_is_answered_with_those_there_are() {
    let mut app = app(searching());
    let (topic, json) = app.ask("command/dance", "{}").await;
    assert_eq!((topic.as_str(), &json["status"], &json["code"]), ("command/dance/result", &404.into(), &"notFound".into()));
    let said = json["detail"].as_str().unwrap();
    assert!(said.contains("there is no command \"dance\"") && said.contains(&table::names(false)), "{said}");
    assert_eq!(app.noted().await.map(|(_, asked, _)| asked), Some(Asked::Words("command dance".to_owned())));
    for strange in ["Start", "start ", "", "größe"] {
        assert_eq!(app.ask(&format!("command/{strange}"), "").await.1["code"], "notFound", "{strange}");
    }
    assert_eq!(app.given().await, 0);
}

#[tokio::test]
async fn verdicts_come_back_with_the_record() {
    let mut app = app(searching());
    let (_, json) = app.ask("command/verdict", r#"{"luggage":3,"verdict":"safe"}"#).await;
    assert_eq!(json["luggage"]["id"], 3);
    app.refuse(Refused::Decided { luggage: LuggageId(2), verdict: Verdict::Danger });
    let (_, json) = app.ask("command/verdict", r#"{"luggage":2,"verdict":"safe"}"#).await;
    assert_eq!((&json["status"], &json["luggage"]["verdict"]), (&409.into(), &"danger".into()));
    app.refuse(Refused::UnknownLuggage(LuggageId(9)));
    let (_, json) = app.ask("command/verdict", r#"{"luggage":9,"verdict":"safe"}"#).await;
    assert_eq!((&json["status"], json.get("luggage")), (&404.into(), None));
}

fn stops() -> Vec<(&'static str, Vec<u8>)> {
    let huge = vec![b'x'; 100_000];
    let huge_move = format!(r#"{{"move":"h","why":"{}"}}"#, "x".repeat(5000)).into_bytes();
    let plain = [
        ("command/stop", "{{{"),
        ("command/stop", r#"{"id":7,"id":8}"#),
        ("command/stop", r#"{"epoch":-1}"#),
        ("command", "stop"),
        ("command", "\"STOP\"\n"),
        ("command/move", r#"{"move":"h","id":"two words","speed":3}"#),
        ("command/move", "h"),
        (OLD, "msg(stopCmd,event,js,none,stopCmd,1)"),
        (OLD, "msg(stopCmd,event,"),
        ("unibo/qak/robotmind", "msg(stopExplore,dispatch,js,robotmind,stopExplore,1)"),
        ("unibo/qak/robotmind", "msg(userCmd,dispatch,js,robotmind,userCmd(h),1)"),
    ];
    let plain = plain.into_iter().map(|(topic, payload)| (topic, payload.as_bytes().to_vec()));
    plain.chain([("command/stop", huge), ("command/stop", vec![0xff, 0]), ("command/move", huge_move)]).collect()
}

/// Safety S1.
#[tokio::test]
async fn a_stop_is_a_stop_whatever_is_wrong_with_it_and_whoever_sends_it() {
    for publisher in [here(), viewer(), Publisher::Unknown { broker: "broker.example".into() }] {
        let app = app(searching());
        for (count, (topic, payload)) in stops().into_iter().enumerate() {
            assert_eq!(say(&app.commands, topic, &payload, &publisher), Taken::Taken, "{topic}");
            assert_eq!(app.given().await, count + 1, "{topic} {}", String::from_utf8_lossy(&payload));
            assert_eq!(app.last().await.command, Command::Stop);
        }
        assert!(app.noted().await.is_none());
    }
}

#[tokio::test]
async fn a_stop_with_a_name_is_answered_under_it() {
    let mut app = app(searching());
    let (topic, json) = app.ask("command/stop", r#"{"id":"s1","why":"smoke"}"#).await;
    assert_eq!((topic.as_str(), &json["id"], &json["accepted"]), ("command/stop/result", &"s1".into(), &true.into()));
}

/// Safety A1, A4.
#[tokio::test]
async fn a_viewer_may_stop_and_nothing_else() {
    let mut app = app(searching());
    let acts = all_commands().into_iter().filter(|(_, _, command)| *command != Command::Stop);
    for (name, payload, command) in acts {
        assert_eq!(say(&app.commands, &format!("command/{name}"), payload, &viewer()), Taken::Forbidden);
        let (topic, json) = app.result().await;
        assert_eq!((topic, &json["status"]), (format!("command/{name}/result"), &403.into()));
        assert!(json["detail"].as_str().unwrap().contains("you are signed in as `wall` with the role viewer"), "{json}");
        let (issuer, asked, refused) = app.noted().await.expect("on record");
        assert_eq!((issuer.to_string().as_str(), refused.code()), ("wall (mqtt, 192.0.2.7)", "notAllowed"));
        assert_eq!(asked, Asked::Command(command));
    }
    assert_eq!(say(&app.commands, "command", "start", &viewer()), Taken::Forbidden);
    assert_eq!(app.result().await.1["status"], 403);
    assert_eq!(say(&app.commands, "command/goto", "nonsense", &viewer()), Taken::Forbidden);
    assert_eq!(app.result().await.1["status"], 403);
    while app.noted().await.is_some() {}
    for said in [event("startCmd"), event("luggageDanger"), "msg(startCmd".to_owned(), "nonsense".to_owned()] {
        assert_eq!(say(&app.commands, OLD, &said, &viewer()), Taken::Forbidden, "{said}");
        assert_eq!(app.noted().await.map(|(_, _, refused)| refused.code()), Some("notAllowed"), "{said}");
    }
    assert_eq!(app.given().await, 0);
    assert!(app.is_silent().await);
}

/// Safety A1: of a viewer's messages on these topics, only a STOP is passed on.
#[tokio::test]
async fn nothing_that_a_viewer_says_where_commands_are_is_passed_on_but_a_stop() {
    let mut app = app(searching());
    for (topic, payload) in [
        ("command/temperature", r#"{"status":"ok"}"#),
        ("command/move", r#"{"move":"q"}"#),
        ("command/xyz", "{}"),
        ("command", "anything"),
        ("command/goto", &"z".repeat(200_000)),
    ] {
        assert_eq!(say(&app.commands, topic, payload, &viewer()), Taken::Forbidden, "{topic}");
        assert_eq!(app.result().await.1["accepted"], false, "{topic}");
    }
    assert_eq!(say(&app.commands, "command/stop", "", &viewer()), Taken::Taken);
}

/// Old consoles show everything that is published on the old topics.
#[tokio::test]
async fn a_viewer_cannot_pretend_to_be_the_robot() {
    let app = app(searching());
    let pretended = "msg(modelContent,event,resourcemodel,none,content(robot(state(stopped))),7)";
    assert_eq!(say(&app.commands, OLD, pretended, &viewer()), Taken::Forbidden);
    assert!(app.noted().await.is_none(), "it is no command");
    assert_eq!(app.say(OLD, pretended), Taken::NotACommand);
}

#[tokio::test]
async fn whoever_commands_through_another_broker_is_known_by_that_broker_alone() {
    let app = app(searching());
    let publisher = Publisher::Unknown { broker: "broker.example".into() };
    assert_eq!(say(&app.commands, "command/start", "", &publisher), Taken::Taken);
    let given = app.last().await;
    assert_eq!((given.command, given.issuer.to_string().as_str()), (Command::Start, "mqtt (mqtt, broker.example)"));
}

#[tokio::test]
async fn messages_of_the_original_system_command_and_are_answered_by_none() {
    let mut app = app(searching());
    let verdict = |verdict| Command::Verdict { luggage: LuggageRef::Pending, verdict, note: None, hot: Default::default() };
    for (id, command) in [
        ("startCmd", Command::Start),
        ("backHomeCmd", Command::BackHome),
        ("luggageSafe", verdict(Verdict::Safe)),
        ("luggageDanger", verdict(Verdict::Danger)),
        ("temperatureTooHigh", Command::Temperature(TemperatureReport::TooHigh)),
    ] {
        assert_eq!(app.say(OLD, event(id)), Taken::Taken);
        let given = app.last().await;
        assert_eq!((given.command, given.id), (command, None), "{id}");
    }
    assert!(app.is_silent().await);
}

/// An old console can learn only from this message that a command was refused.
#[tokio::test]
async fn an_old_console_is_told_why_a_command_is_refused_and_what_goes_on() {
    let mut app = app(searching());
    let no_photo = "luggage #3 has no usable photo: take it again, or answer danger (continueExplore takes the photo again)";
    for (word, refused, why) in [
        ("luggageSafe", Refused::NoPhoto(LuggageId(3)), no_photo),
        ("continueExploreAfterPhoto", Refused::NoPhoto(LuggageId(3)), no_photo),
        (
            "startCmd",
            Refused::NotInPhase(PhaseName::BombLocated),
            "not possible while home, bomb located (reachBag fetches the bag)",
        ),
        ("backHomeCmd", Refused::NotInPhase(PhaseName::Idle), "not possible while idle"),
        ("startCmd", Refused::Moving, "the robot is moving: press STOP first"),
    ] {
        app.refuse(refused);
        assert_eq!(app.say(OLD, event(word)), Taken::Taken);
        let told = app.told().await;
        let why = format!("refused: {why}");
        let message = format!("msg(modelContent,event,resourcemodel,none,content(luggage(state('{why}'))),0)");
        assert_eq!((told.topic.as_str(), String::from_utf8_lossy(&told.payload)), (OLD, message.into()));
        assert!(!told.retain);
    }
    assert_eq!(say(&app.commands, OLD, event("luggageSafe"), &viewer()), Taken::Forbidden);
    assert!(app.is_silent().await, "others hear nothing of what a viewer may not");
}

#[tokio::test]
async fn to_go_on_is_to_take_a_photo_again_that_has_failed_and_else_to_start() {
    let failed = |phase| {
        let mut state = searching();
        let piece = Luggage { photo: PhotoState::Failed("lens".to_owned()), ..Luggage::clone(&state.luggage[2]) };
        state.luggage.insert(Arc::new(piece));
        state.mission.phase = phase;
        state
    };
    for (state, command) in [
        (searching(), Command::Start),
        (failed(PhaseName::Inspecting), Command::RetakePhoto(LuggageId(3))),
        // After START the robot drives back to that piece.
        (failed(PhaseName::AtHome), Command::Start),
    ] {
        let app = app(state);
        assert_eq!(app.say(OLD, event("continueExplore")), Taken::Taken);
        assert_eq!(app.last().await.command, command);
        assert_eq!(app.say(OLD, event("startCmd")), Taken::Taken);
        assert_eq!(app.last().await.command, Command::Start, "the others mean what they say");
    }
}

/// Mission §8.
#[tokio::test]
async fn an_old_message_that_nobody_understands_is_counted_and_no_other() {
    let app = app(searching());
    let sonar = "msg(sonar,event,basicrobot,none,sonar(12),9)";
    for _ in 0..3 {
        assert_eq!(app.say(OLD, sonar), Taken::NotACommand);
    }
    assert_eq!(app.say("unibo/qak/robotmind", "msg(dance,dispatch,js,robotmind,dance,1)"), Taken::NotACommand);
    assert_eq!(app.commands.not_understood(), 4);
    let pretended = "msg(modelContent,event,resourcemodel,none,content(robot(state(stopped))),7)";
    assert_eq!(app.say(OLD, pretended), Taken::NotACommand, "we hear ourselves");
    assert_eq!(app.say("state/robot", sonar), Taken::NotACommand);
    app.say(OLD, event("startCmd"));
    app.say(OLD, "nonsense");
    assert_eq!(app.commands.not_understood(), 4, "these were understood, refused, or are not for here");
}

#[tokio::test]
async fn what_is_wrong_in_an_old_message_is_on_record_and_not_published() {
    let mut app = app(searching());
    let large = event(&format!("startCmd{}", " ".repeat(5000)));
    let driving = "msg(userCmd,dispatch,js,robotmind,userCmd(w),1)";
    for (said, code) in [
        ("msg(startCmd,event", "malformed"),
        ("", "malformed"),
        (&large, "malformed"),
        ("msg(startTest,dispatch,js,robotmind,startTest(a,b),1)", "unusable"),
        (driving, "notAllowed"),
    ] {
        assert_eq!(app.say("unibo/qak/robotmind", said), Taken::Taken, "{said}");
        let noted = app.noted().await.map(|(_, _, refused)| refused.code());
        assert_eq!(noted, Some(code), "{}", said.chars().take(40).collect::<String>());
    }
    assert_eq!(app.given().await, 0);
    assert!(app.is_silent().await);
    let driven = driven_app(searching(), true);
    assert_eq!(driven.say("unibo/qak/robotmind", driving), Taken::Taken);
    assert_eq!(driven.last().await.command, Command::Move(Move::Forward));
}

#[tokio::test]
async fn whatever_is_no_command_is_left_alone() {
    let mut app = app(searching());
    for topic in ["state/robot", "event", "availability", "command/start/result", "commands", "command/start/now"] {
        assert_eq!(app.say(topic, "start"), Taken::NotACommand, "{topic}");
    }
    let elsewhere =
        IncomingMessage { topic: "somebody/else/command/start", payload: b"", arrived: None, is_again: false, answer_to: None };
    assert_eq!(app.commands.take(&elsewhere, &here()), Taken::NotACommand);
    assert_eq!(app.say(OLD, "msg(sonar,event,basicrobot,none,sonar(12),9)"), Taken::NotACommand);
    assert_eq!(app.given().await, 0);
    assert!(app.noted().await.is_none() && app.is_silent().await);
}

/// Results are published on topics that are not command topics. Otherwise hallsweep, as a client of another broker,
/// would take its own answers for commands.
#[tokio::test]
async fn no_result_is_itself_a_command() {
    let mut app = app(searching());
    for topic in ["command/start", "command/dance", "command/unknown", "command/result", "command"] {
        let (result, _) = app.ask(topic, "start").await;
        assert_eq!(app.say(&result, "{}"), Taken::NotACommand, "{result}");
    }
}

/// Safety A4: an answer is published on a requested topic only if the topic is valid and the sender may publish
/// there.
#[tokio::test]
async fn an_answer_goes_where_it_is_wanted_when_its_sender_may_say_something_there() {
    let mut app = app(searching());
    let wanted = |topic| Some(AnswerTo { topic, correlation: Some(&b"7"[..]) });
    for topic in [
        "",
        "panel/#",
        "panel/+/x",
        "+",
        "$SYS/x",
        "hallsweep/discovery/state/robot",
        "unibo/qak/events",
        "homeassistant/device/discovery/config",
    ] {
        assert_eq!(app.commands.answer_to(wanted(topic), &here()), None, "{topic}");
    }
    assert_eq!(app.commands.answer_to(wanted("panel/answers"), &viewer()), None);
    let long = AnswerTo { topic: "panel/answers", correlation: Some(&[0; 1025]) };
    assert_eq!(app.commands.answer_to(Some(long), &here()), None);
    let answer_to = app.commands.answer_to(wanted("panel/answers"), &here());
    assert!(answer_to.is_some());
    for (topic, payload) in
        [("hallsweep/discovery/command/start", &b"{}"[..]), ("hallsweep/discovery/command/dance", b"{\"id\":\"k\"}")]
    {
        app.commands.take(&IncomingMessage { topic, payload, arrived: None, is_again: false, answer_to }, &here());
    }
    assert!(app.commands.halts(b"hallsweep/discovery/command", b"stop", answer_to, &here()));
    for _ in 0..3 {
        let told = app.told().await;
        assert_eq!((&*told.topic, told.beside.correlation.as_deref()), ("panel/answers", Some(&b"7"[..])));
        assert_eq!(told.beside.by.as_deref(), Some("operator"));
    }
}
