//! The commands of `/api/v1`, one for each row of the table of commands. Reads the body and sends the command. The
//! command carries its id, and the name and address of its sender. The answer contains the revision after the
//! command. The routes of the console use the same `CommandSender`, but write their own answers.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName};
use axum::response::{IntoResponse, Response};

use super::HttpDoor;
use super::gate::{allowed, issuer};
use super::halls::Entered;
use super::hearing::{Arrived, Pressed};
use super::peer::{LetIn, Peer};
use super::problem::Problem;
use super::reading::JsonPayload;
use crate::access::{Caller, Need};
use crate::api::answer::AnswerJson;
use crate::api::command::no_command_id;
use crate::api::commands::{CommandKind, asked};
use crate::api::door;
use crate::runtime::carry_out::Done;
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{self, Command, CommandId, Request};
use hallsweep_core::units::Epoch;

type CommandAnswer = Result<Response, Problem>;

pub(super) async fn stop(sender: CommandSender) -> CommandAnswer {
    give(&sender, Command::Stop, None).await
}

/// Handles every command route except that of STOP. `number` is the number of the luggage or alarm that the command
/// is about. If the body of a `move` says STOP, the request is carried out as STOP, whatever else it contains.
pub(super) async fn command(
    kind: CommandKind,
    sender: CommandSender,
    number: u64,
    body: Result<JsonPayload, Problem>,
) -> CommandAnswer {
    if kind == CommandKind::Move && sender.has_pressed_stop() {
        return give(&sender, Command::Stop, None).await;
    }
    let (command, epoch) = asked(kind, number, &body?)?;
    give(&sender, command, epoch).await
}

/// Sends a command and returns the answer as JSON. The routes of the old console use this function too.
pub(super) async fn give(sender: &CommandSender, command: Command, epoch: Option<Epoch>) -> CommandAnswer {
    let done = sender.give(door::HTTP, command, epoch).await?;
    Ok(axum::Json(AnswerJson::new(done.accepted, &done.snapshot)).into_response())
}

pub(super) const IDEMPOTENCY_KEY: HeaderName = HeaderName::from_static("idempotency-key");

pub(super) struct CommandSender {
    pub(super) door: HttpDoor,
    pub(super) caller: Caller,
    peer: Peer,
    pressed: Option<Pressed>,
    arrived: Option<Epoch>,
    id: Result<Option<CommandId>, Problem>,
}

impl<S: Send + Sync> FromRequestParts<S> for CommandSender {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<CommandSender, Problem> {
        let LetIn(caller) = LetIn::from_request_parts(parts, state).await?;
        let peer = Peer::from_request_parts(parts, state).await?;
        let pressed = parts.extensions.remove();
        let door = HttpDoor::from_request_parts(parts, state).await?;
        let hall = parts.extensions.get().and_then(|entered: &Entered| entered.hall.clone());
        // The epoch of another hall says nothing about this one, so the request counts as one that came before any STOP.
        let arrived = parts.extensions.get().map(|of: &Arrived| if of.hall == hall { of.epoch } else { Epoch::default() });
        Ok(CommandSender { door, caller, peer, pressed, arrived, id: command_id(&parts.headers) })
    }
}

impl CommandSender {
    /// Whether a STOP was recognised in this request, even if the request has faults.
    pub(super) fn has_pressed_stop(&self) -> bool {
        self.pressed.as_ref().is_some_and(Pressed::is_there)
    }

    /// Sends a command and waits for its answer. On every route, all commands except STOP need the role of an
    /// operator. A STOP halts the robot even if other parts of the request are faulty.
    pub(super) async fn give(&self, door: command::Door, command: Command, epoch: Option<Epoch>) -> Result<Done, Problem> {
        let is_stop = command == Command::Stop;
        if let Some(given) = self.pressed.as_ref().filter(|_| is_stop).and_then(Pressed::take) {
            return Ok(given.await?);
        }
        let issuer = issuer(&self.caller, door, self.peer);
        if let Err(refused) = allowed(&self.caller, if is_stop { Need::Stop } else { Need::Act }) {
            self.door.note_refused(issuer, Asked::Command(command), refused.clone()).await;
            return Err(Problem::refused(&refused).off_record());
        }
        let id = match &self.id {
            Ok(id) => id.clone(),
            Err(_) if is_stop => None,
            Err(problem) => return Err(problem.clone()),
        };
        let request = Request { id, epoch, arrived: self.arrived, ..Request::new(command, issuer) };
        // Runs in a separate task: an accepted command is carried out even if its sender disconnects.
        let carried_out = tokio::spawn(self.door.hall.handle.carry_out(request));
        Ok(carried_out.await.map_err(|_| Problem::internal())??)
    }
}

/// Reads the command id from the header `Idempotency-Key`. The id may have no quotes, or be quoted as in the draft of
/// this header (a structured string, RFC 9651).
pub(super) fn command_id(headers: &HeaderMap) -> Result<Option<CommandId>, Problem> {
    let mut values = headers.get_all(IDEMPOTENCY_KEY).iter();
    let Some(value) = values.next() else { return Ok(None) };
    let text = String::from_utf8_lossy(value.as_bytes());
    let wrong = || Problem::malformed(no_command_id("Idempotency-Key", &text) + ", bare or in quotes");
    if values.next().is_some() {
        return Err(wrong());
    }
    let name = if text.starts_with('"') { unquoted(&text) } else { Some(text.clone().into_owned()) };
    name.as_deref().and_then(CommandId::new).map(Some).ok_or_else(wrong)
}

/// Returns the contents of a quoted string, or `None` when its quotes or its escapes are wrong.
fn unquoted(text: &str) -> Option<String> {
    let mut letters = text.strip_prefix('"')?.strip_suffix('"')?.chars();
    let mut said = String::new();
    while let Some(letter) = letters.next() {
        said.push(match letter {
            '"' => return None,
            '\\' => letters.next().filter(|escaped| matches!(escaped, '"' | '\\'))?,
            plain => plain,
        });
    }
    Some(said)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{TestApp, app, read};
    use super::*;
    use crate::api::tests::fixture::searching;
    use hallsweep_core::bomb_size::BombSize;
    use hallsweep_core::closing::{AreaClosing, Closing};
    use hallsweep_core::command::{Again, Hot, HotAnswer, LuggageRef, Move, Note, TemperatureReport, Verdict};
    use hallsweep_core::hand_over::HandOver;
    use hallsweep_core::refused::Refused;
    use hallsweep_core::units::{AlarmId, Cell, LuggageId, MissionId};
    use hallsweep_core::world::hall_map::Bounds;

    async fn check(app: &TestApp, method: &str, path: &str, body: &str, expect: u16) -> serde_json::Value {
        let (status, json) = app.json(method, &format!("/api/v1{path}"), body).await;
        assert_eq!(status, expect, "{method} {path} {body}: {json}");
        if expect == 200 {
            assert_eq!((&json["accepted"], &json["revision"], &json["epoch"]), (&true.into(), &20.into(), &1.into()));
        } else {
            assert_eq!(json["status"], expect);
            assert!(["type", "title", "detail", "code"].iter().all(|field| json[field].is_string()), "{json}");
        }
        json
    }

    #[tokio::test]
    async fn every_command_reaches_the_loop_as_what_it_says() {
        let app = app(searching());
        let cell = Cell::new(4, -2);
        let verdict =
            |verdict| Command::Verdict { luggage: LuggageRef::Id(LuggageId(3)), verdict, note: None, hot: Default::default() };
        let noted = Command::Verdict {
            luggage: LuggageRef::Id(LuggageId(3)),
            verdict: Verdict::Safe,
            note: Note::new("red"),
            hot: Default::default(),
        };
        let closing =
            Command::Close(Closing { name: Note::new("Anna Rossi").unwrap(), note: None, seen: "7:1,0,0,0,0,0,0".into() });
        let hot = Hot { size: Some(BombSize::Radius(120)), ..Hot::NONE };
        let luggage = LuggageRef::Id(LuggageId(3));
        let sized = Command::Verdict { luggage, verdict: Verdict::Danger, note: None, hot };
        let hand_over = HandOver {
            mission: Some(MissionId(7)),
            to: Note::new("Inspector Bianchi").unwrap(),
            note: Note::new("with the photos"),
        };
        let closing_area = AreaClosing {
            area: "gate 1".into(),
            name: Note::new("Rossi").unwrap(),
            note: Note::new("searched twice"),
            mission: Some(MissionId(7)),
        };
        let area = Bounds { least: Cell::new(1, -1), most: Cell::new(3, 4) };
        let unsure = Command::Unsure {
            luggage: LuggageRef::Id(LuggageId(3)),
            note: Note::new("red"),
            hot: Hot { hidden: Some(HotAnswer::CannotSay), ..Hot::NONE },
        };
        let cases = [
            ("POST", "/commands/start", "", Command::Start),
            ("POST", "/commands/start", "{}", Command::Start),
            ("POST", "/commands/stop", "", Command::Stop),
            ("POST", "/commands/backHome", "", Command::BackHome),
            ("POST", "/commands/goOn", "", Command::GoOn),
            ("POST", "/commands/retrieve", "", Command::Retrieve(None)),
            ("POST", "/commands/retrieve", r#"{"luggage":3}"#, Command::Retrieve(Some(LuggageId(3)))),
            ("POST", "/commands/reset", "", Command::Reset),
            ("POST", "/commands/close", r#"{"name":"Anna Rossi","openPoints":"7:1,0,0,0,0,0,0"}"#, closing),
            (
                "POST",
                "/commands/handOver",
                r#"{"to":" Inspector Bianchi","note":"with the photos","mission":7}"#,
                Command::HandOver(hand_over),
            ),
            ("POST", "/commands/searchAgain", r#"{"x":3,"y":-1,"toX":1,"toY":4}"#, Command::SearchAgain(Again::Within(area))),
            ("POST", "/commands/searchAgain", r#"{"area":"gate 1"}"#, Command::SearchAgain(Again::Area("gate 1".into()))),
            (
                "POST",
                "/commands/orderAreas",
                r#"{"areas":["gate 2","gate 1"]}"#,
                Command::OrderAreas(["gate 2".into(), "gate 1".into()].into()),
            ),
            (
                "POST",
                "/commands/closeArea",
                r#"{"area":"gate 1","name":" Rossi ","note":"searched twice","mission":7}"#,
                Command::CloseArea(closing_area),
            ),
            ("POST", "/commands/move", r#"{"move":"w"}"#, Command::Move(Move::Forward)),
            ("POST", "/commands/move", r#"{"move":"h"}"#, Command::Stop),
            ("POST", "/commands/goto", r#"{"x":4,"y":-2}"#, Command::Goto(cell)),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"safe"}"#, verdict(Verdict::Safe)),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"safe","note":"red"}"#, noted),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"danger"}"#, verdict(Verdict::Danger)),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"unsure","note":"red","hidden":"cannotSay"}"#, unsure),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"danger","size":"120"}"#, sized),
            ("POST", "/luggage/3/photo", "", Command::RetakePhoto(LuggageId(3))),
            ("POST", "/alarms/1/acknowledge", "", Command::Acknowledge(AlarmId(1))),
            ("PUT", "/temperature", r#"{"status":"tooHigh"}"#, Command::Temperature(TemperatureReport::TooHigh)),
            ("PUT", "/strategy", r#"{"name":"snail"}"#, Command::ChooseStrategy(hallsweep_core::command::Strategy::Snail)),
        ];
        for (method, path, body, command) in cases {
            check(&app, method, path, body, 200).await;
            assert_eq!(app.last().command, command, "{path}");
        }
    }

    #[tokio::test]
    async fn what_was_carried_out_is_never_said_to_be_refused_for_its_coding() {
        let app = app(searching());
        for coding in ["identity;q=0", "*;q=0", "br, *;q=0", "gzip;q=0, identity; q=0.0", "deflate,IDENTITY;q=0"] {
            let answer = app.send("POST", "/api/v1/commands/stop", &[("accept-encoding", coding)], "").await;
            assert_eq!(answer.status(), 200, "{coding}");
            assert_eq!(app.send("GET", "/nowhere", &[("accept-encoding", coding)], "").await.status(), 404, "{coding}");
        }
    }

    #[tokio::test]
    async fn the_epoch_its_sender_saw_goes_with_a_command() {
        let app = app(searching());
        check(&app, "POST", "/commands/start", r#"{"epoch":7}"#, 200).await;
        assert_eq!(app.last().epoch, Some(Epoch(7)));
        check(&app, "POST", "/commands/goto", r#"{"x":1,"y":1,"epoch":8}"#, 200).await;
        assert_eq!(app.last().epoch, Some(Epoch(8)));
    }

    #[tokio::test]
    async fn what_is_malformed_is_refused_with_the_code_that_fits() {
        let app = app(searching());
        let names = |count: usize| {
            serde_json::json!({ "areas": (0..count).map(|n| format!("area {n}")).collect::<Vec<_>>() }).to_string()
        };
        let long = format!(r#"{{"name":"Anna","openPoints":"{}"}}"#, "1".repeat(161));
        let cases = [
            ("POST", "/commands/start", "{", 400),
            ("POST", "/commands/start", "nonsense", 400),
            ("POST", "/commands/start", r#"{"epoc":1}"#, 422),
            ("POST", "/commands/start", r#"{"epoch":-1}"#, 422),
            ("POST", "/commands/start", "[]", 422),
            ("POST", "/commands/move", r#"["w"]"#, 422),
            ("POST", "/luggage/3/verdict", r#"["danger"]"#, 422),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"safe","verdict":"danger"}"#, 422),
            ("POST", "/commands/move", "", 400),
            ("POST", "/commands/move", "{}", 422),
            ("POST", "/commands/move", r#"{"move":"q"}"#, 422),
            ("POST", "/commands/move", r#"{"move":1}"#, 422),
            ("POST", "/commands/goto", r#"{"x":1}"#, 422),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"danger","size":"bus"}"#, 422),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"danger","size":"5001"}"#, 422),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"danger","size":120}"#, 422),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"safe","size":"pipe"}"#, 422),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"unsure","size":"pipe"}"#, 422),
            ("POST", "/commands/searchAgain", r#"{"x":1,"y":1,"toX":2}"#, 422),
            ("POST", "/commands/searchAgain", r#"{"x":1,"y":1,"toX":2,"toY":8193}"#, 422),
            ("POST", "/commands/searchAgain", r#"{"x":1,"y":1,"toX":2,"toY":2.5}"#, 422),
            ("POST", "/commands/searchAgain", r#"{"x":1,"y":1,"toX":2,"toY":2,"area":"bar"}"#, 422),
            ("POST", "/commands/searchAgain", r#"{"x":1,"y":1,"toX":2,"area":null}"#, 422),
            ("POST", "/commands/searchAgain", r#"{"area":" gate"}"#, 422),
            ("POST", "/commands/searchAgain", r#"{"area":["gate"]}"#, 422),
            ("POST", "/commands/orderAreas", "", 400),
            ("POST", "/commands/orderAreas", "[]", 422),
            ("POST", "/commands/orderAreas", "{}", 422),
            ("POST", "/commands/orderAreas", r#"{"areas":"gate 1"}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":{"gate 1":1}}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":[1]}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":[["gate 1"]]}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":["gate 1",null]}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":["gate 1","bar","gate 1"]}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":["gate\u0000"]}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":["a\nb"]}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":["a\u202eb"]}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":[""]}"#, 422),
            ("POST", "/commands/orderAreas", r#"{"areas":[],"epoch":1}"#, 422),
            ("POST", "/commands/orderAreas", &names(65), 422),
            ("POST", "/commands/orderAreas", &names(10_000), 413),
            ("POST", "/commands/closeArea", "", 400),
            ("POST", "/commands/closeArea", r#"{"area":"gate 1"}"#, 422),
            ("POST", "/commands/closeArea", r#"{"name":"Rossi"}"#, 422),
            ("POST", "/commands/closeArea", r#"{"area":"","name":"Rossi"}"#, 422),
            ("POST", "/commands/closeArea", r#"{"area":"gate\u001b[31m","name":"Rossi"}"#, 422),
            ("POST", "/commands/closeArea", r#"{"area":"gate 1","name":" "}"#, 422),
            ("POST", "/commands/closeArea", r#"{"area":"gate 1","name":"Ro\u2028ssi"}"#, 422),
            ("POST", "/commands/closeArea", r#"{"area":"gate 1","name":"Rossi","note":7}"#, 422),
            ("POST", "/commands/closeArea", r#"{"area":["gate 1"],"name":"Rossi"}"#, 422),
            ("POST", "/commands/closeArea", r#"{"area":"gate 1","name":"Rossi","mission":-1}"#, 422),
            ("POST", "/commands/close", r#"{"openPoints":"1:0"}"#, 422),
            ("POST", "/commands/close", r#"{"name":" "}"#, 422),
            ("POST", "/commands/close", r#"{"name":"a\u202eb"}"#, 422),
            ("POST", "/commands/close", r#"{"name":"Anna","openPoints":1}"#, 422),
            ("POST", "/commands/close", &long, 422),
            ("POST", "/commands/handOver", "", 400),
            ("POST", "/commands/handOver", r#"{"note":"x"}"#, 422),
            ("POST", "/commands/handOver", r#"{"to":"\u2028"}"#, 422),
            ("POST", "/commands/handOver", r#"{"to":"police","epoch":1}"#, 422),
            ("POST", "/commands/goto", r#"{"x":1.5,"y":1}"#, 422),
            ("POST", "/commands/goto", r#"{"x":8193,"y":1}"#, 422),
            ("POST", "/commands/goto", r#"{"x":99999999999999999999,"y":1}"#, 422),
            ("POST", "/luggage/3/verdict", r#"{"verdict":"maybe"}"#, 422),
            ("POST", "/luggage/three/verdict", r#"{"verdict":"safe"}"#, 404),
            ("POST", "/luggage/-1/photo", "", 404),
            ("POST", "/luggage/%FF/photo", "", 404),
            ("PUT", "/strategy", r#"{"name":"worm"}"#, 422),
            ("PUT", "/temperature", r#"{}"#, 422),
            ("PUT", "/temperature", r#"{"celsius":"warm"}"#, 422),
            ("PUT", "/temperature", r#"{"celsius":NaN}"#, 400),
            ("PUT", "/temperature", r#"{"celsius":-300}"#, 422),
            ("POST", "/nothing", "", 404),
        ];
        for (method, path, body, expect) in cases {
            check(&app, method, path, body, expect).await;
        }
        assert!(app.given.lock().unwrap().is_empty(), "nothing malformed reaches the loop");
        let unknown = check(&app, "POST", "/commands/start", r#"{"epoc":1}"#, 422).await;
        assert!(unknown["detail"].as_str().unwrap().contains("`epoc`"), "{unknown}");
    }

    #[tokio::test]
    async fn wrong_types_large_bodies_and_wrong_methods_have_codes_too() {
        let app = app(searching());
        let (status, _) = read(app.send("POST", "/api/v1/commands/move", &[("content-type", "text/plain")], "w").await).await;
        assert_eq!(status, 415);
        let (status, _) = read(app.send("POST", "/api/v1/commands/move", &[], r#"{"move":"w"}"#).await).await;
        assert_eq!(status, 415);
        for (charset, expect) in [("utf-8", 200), ("\"UTF-8\"", 200), ("utf-16", 415), ("latin1", 415)] {
            let media = format!("application/json; charset={charset}");
            let sent = app.send("POST", "/api/v1/commands/move", &[("content-type", &media)], r#"{"move":"w"}"#).await;
            assert_eq!(sent.status(), expect, "{charset}");
        }
        let large = format!("{{\"move\":\"{}\"}}", "w".repeat(20_000));
        assert_eq!(app.json("POST", "/api/v1/commands/move", &large).await.0, 413);
        let response = app.send("DELETE", "/api/v1/luggage/3/photo", &[], "").await;
        let allow = response.headers()["allow"].to_str().unwrap().to_owned();
        assert!(allow.contains("GET") && allow.contains("POST"), "{allow}");
        assert_eq!(response.headers()["content-type"], "application/problem+json");
        assert_eq!(read(response).await.0, 405);
    }

    #[tokio::test]
    async fn a_stop_halts_whatever_its_body_is() {
        let app = app(searching());
        let huge = "x".repeat(100_000);
        for (headers, body) in [(&[("content-type", "image/png")][..], "{{{"), (&[], &huge)] {
            assert_eq!(app.send("POST", "/api/v1/commands/stop", headers, body).await.status(), 200);
        }
        assert_eq!(app.given.lock().unwrap().len(), 2);
    }

    #[tokio::test]
    async fn refusals_say_why_and_verdicts_come_back_with_the_record() {
        let app = app(searching());
        app.refuse(Refused::Decided { luggage: LuggageId(2), verdict: Verdict::Danger });
        let json = check(&app, "POST", "/luggage/2/verdict", r#"{"verdict":"safe"}"#, 409).await;
        assert_eq!((&json["code"], &json["luggage"]["verdict"]), (&"decided".into(), &"danger".into()));
        app.refuse(Refused::UnknownLuggage(LuggageId(9)));
        let json = check(&app, "POST", "/luggage/9/verdict", r#"{"verdict":"safe"}"#, 404).await;
        assert_eq!(json.get("luggage"), None);
        app.refuse(Refused::StoreDown);
        check(&app, "POST", "/luggage/3/verdict", r#"{"verdict":"danger"}"#, 503).await;
    }

    #[tokio::test]
    async fn an_accepted_verdict_comes_with_the_record() {
        let app = app(searching());
        let json = check(&app, "POST", "/luggage/3/verdict", r#"{"verdict":"safe"}"#, 200).await;
        assert_eq!(json["luggage"]["id"], 3);
    }

    fn id(values: &[&str]) -> Option<Option<String>> {
        let pairs = values.iter().map(|value| (IDEMPOTENCY_KEY, value.parse().unwrap()));
        command_id(&pairs.collect()).ok().map(|id| id.map(|id| id.text().to_owned()))
    }

    #[test]
    fn a_commands_own_name_comes_bare_or_quoted() {
        assert_eq!(id(&[]), Some(None));
        assert_eq!(id(&["8e03978e-40d5-43dd"]), Some(Some("8e03978e-40d5-43dd".to_owned())));
        assert_eq!(id(&["\"8e03978e\""]), Some(Some("8e03978e".to_owned())));
        assert_eq!(id(&["\"a\\\"b\\\\c\""]), Some(Some("a\"b\\c".to_owned())));
        assert_eq!(id(&[&"a".repeat(CommandId::MOST)]), Some(Some("a".repeat(CommandId::MOST))));
    }

    #[test]
    fn a_name_that_is_none_is_refused() {
        let long = "a".repeat(CommandId::MOST + 1);
        for wrong in [&[""][..], &["\""], &["\"\""], &["\"a"], &["\"a\"b\""], &["\"a\\n\""], &["a b"], &[&long], &["a", "a"]] {
            assert_eq!(id(wrong), None, "{wrong:?}");
        }
    }

    #[tokio::test]
    async fn a_malformed_name_refuses_a_command_and_never_a_stop() {
        let app = app(searching());
        let wrong = [("idempotency-key", "a b")];
        assert_eq!(app.send("POST", "/api/v1/commands/start", &wrong, "").await.status(), 400);
        assert!(app.given.lock().unwrap().is_empty());
        for path in ["/api/v1/commands/stop", "/console/stop", "/h", "/stopappl"] {
            assert!(app.send("POST", path, &wrong, "").await.status().as_u16() < 400, "{path}");
            assert_eq!((app.last().command, app.last().id), (Command::Stop, None));
        }
    }

    /// Safety A6: a command carries the name of its sender, the sender's address and the command id.
    #[tokio::test]
    async fn who_from_where_and_under_which_name_goes_with_a_command() {
        let app = app(searching());
        app.send("POST", "/api/v1/commands/start", &[("idempotency-key", "\"k7\"")], "").await;
        let given = app.last();
        assert_eq!((&*given.issuer.who, &*given.issuer.from), ("operator", "127.0.0.1"));
        assert_eq!((given.issuer.door, given.id.unwrap().text()), (crate::api::door::HTTP, "k7"));
    }
}
