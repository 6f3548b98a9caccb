//! The sender of a command as the core needs it: name, address, and the command id. The route decides about the form of the
//! answer.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName};

use super::HttpDoor;
use super::gate::{allowed, issuer};
use super::hearing::{Arrived, Pressed};
use super::peer::{LetIn, Peer};
use super::problem::Problem;
use crate::access::{Caller, Need};
use crate::api::command::no_command_id;
use crate::runtime::carry_out::Done;
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{self, Command, CommandId, Request};
use hallsweep_core::units::Epoch;

pub(super) const IDEMPOTENCY_KEY: HeaderName = HeaderName::from_static("idempotency-key");

pub(super) struct CommandSender {
    pub(super) door: HttpDoor,
    pub(super) caller: Caller,
    peer: Peer,
    pressed: Option<Pressed>,
    arrived: Option<Epoch>,
    id: Result<Option<CommandId>, Problem>,
}

impl FromRequestParts<HttpDoor> for CommandSender {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, door: &HttpDoor) -> Result<CommandSender, Problem> {
        let LetIn(caller) = LetIn::from_request_parts(parts, door).await?;
        let peer = Peer::from_request_parts(parts, door).await?;
        let pressed = parts.extensions.remove();
        let arrived = parts.extensions.get().map(|Arrived(epoch)| *epoch);
        Ok(CommandSender { door: door.clone(), caller, peer, pressed, arrived, id: command_id(&parts.headers) })
    }
}

impl CommandSender {
    /// Whether a STOP was recognised in this request, whatever else it contains.
    pub(super) fn has_pressed_stop(&self) -> bool {
        self.pressed.as_ref().is_some_and(Pressed::is_there)
    }

    /// Sends a command and waits for its answer. On every route all commands but STOP need an operator; no fault of a STOP
    /// request prevents it from halting the robot.
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
        // In a task of its own, so that an accepted command is carried out even when its sender disconnects.
        let carried_out = tokio::spawn(self.door.handle.carry_out(request));
        Ok(carried_out.await.map_err(|_| Problem::internal())??)
    }
}

/// The command id: bare, or quoted as in the header's draft (a structured string, RFC 9651).
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

/// The contents of a quoted string; `None` when its quotes or its escapes are wrong.
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
    use super::super::testing::app;
    use super::*;
    use crate::api::fixture::searching;

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

    /// Safety A6: a command carries its sender, its address and its id.
    #[tokio::test]
    async fn who_from_where_and_under_which_name_goes_with_a_command() {
        let app = app(searching());
        app.send("POST", "/api/v1/commands/start", &[("idempotency-key", "\"k7\"")], "").await;
        let given = app.last();
        assert_eq!((&*given.issuer.who, &*given.issuer.from), ("operator", "127.0.0.1"));
        assert_eq!((given.issuer.door, given.id.unwrap().text()), (crate::api::door::HTTP, "k7"));
    }
}
