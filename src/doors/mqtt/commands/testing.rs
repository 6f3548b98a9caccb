//! Helpers for tests of commands: commands whose loop follows a script of the test, senders, and the published
//! results.

use serde_json::Value;
use tokio::sync::mpsc;

use super::{Commands, IncomingMessage, Publisher, ResultMessage, Taken};
use crate::access::{Caller, Key, Keyring, Keys, OPERATOR, Role, Token};
use crate::doors::mqtt::publication::Publication;
use crate::doors::mqtt::topics::Topics;
use crate::runtime::handle::Handle;
use crate::runtime::tests::obedient::{Noted, Script, obedient};
use crate::runtime::tests::within::within;
use hallsweep_core::command::Request;
use hallsweep_core::refused::Refused;
use hallsweep_core::snapshot::Snapshot;

/// Room for results. No test leaves this many results unread.
const ROOM: usize = 1024;

const BASE: &str = "hallsweep/discovery/";

pub(super) struct TestApp {
    pub(super) commands: Commands,
    pub(super) script: Script,
    results: mpsc::Receiver<ResultMessage>,
}

pub(super) fn topics() -> Topics {
    Topics::new("hallsweep", "discovery", "unibo/qak")
}

/// Starts an app in this state. Its loop accepts everything until told to refuse. Old clients may not drive. Must be
/// called inside a runtime.
pub(super) fn app(snapshot: Snapshot) -> TestApp {
    driven_app(snapshot, false)
}

pub(super) fn driven_app(snapshot: Snapshot, manual_driving: bool) -> TestApp {
    let (handle, script) = obedient(snapshot);
    let (commands, results) = commands_of(handle, manual_driving);
    TestApp { commands, script, results }
}

pub(super) fn commands_of(handle: Handle, manual_driving: bool) -> (Commands, mpsc::Receiver<ResultMessage>) {
    let (answers, results) = mpsc::channel(ROOM);
    (Commands::new(handle, topics(), manual_driving, answers), results)
}

pub(super) fn here() -> Publisher {
    Publisher::Known { caller: Caller::Here, from: "127.0.0.1".into() }
}

pub(super) fn viewer() -> Publisher {
    with_key("wall", Role::Viewer)
}

pub(super) fn operator(name: &str) -> Publisher {
    with_key(name, Role::Operator)
}

fn with_key(name: &str, role: Role) -> Publisher {
    let token = || Token::draw().unwrap();
    let keys = [Key::new(OPERATOR, Role::Operator, token()).unwrap(), Key::new(name, role, token()).unwrap()];
    let keyring = Keyring::of(Keys::new(Vec::from(keys)).unwrap()).unwrap();
    let shown = keyring.keys().named(name).unwrap().token.reveal().to_owned();
    Publisher::Known { caller: Caller::Known(keyring.check(&shown).unwrap()), from: "192.0.2.7".into() }
}

/// Sends a message. The topic is a topic of the original system if it begins with `unibo/`; otherwise it is relative
/// to `BASE`.
pub(super) fn say(commands: &Commands, topic: &str, payload: impl AsRef<[u8]>, publisher: &Publisher) -> Taken {
    let topic = if topic.starts_with("unibo/") { topic.to_owned() } else { format!("{BASE}{topic}") };
    commands.take(
        &IncomingMessage { topic: &topic, payload: payload.as_ref(), arrived: None, is_again: false, answer_to: None },
        publisher,
    )
}

pub(super) async fn next(results: &mut mpsc::Receiver<ResultMessage>) -> (String, Value) {
    let publication = within("a result", results.recv()).await.expect("somebody may still answer").taken();
    assert!(!publication.retain, "a result is for those who listen now");
    let topic = publication.topic.strip_prefix(BASE).expect("results are ours").to_owned();
    (topic, serde_json::from_slice(&publication.payload).expect("a result is JSON"))
}

impl TestApp {
    pub(super) fn say(&self, topic: &str, payload: impl AsRef<[u8]>) -> Taken {
        say(&self.commands, topic, payload, &here())
    }

    /// Sends a message of the operator and waits for its result. Returns the topic and the contents of the result.
    pub(super) async fn ask(&mut self, topic: &str, payload: impl AsRef<[u8]>) -> (String, Value) {
        assert_eq!(self.say(topic, payload), Taken::Taken, "{topic}");
        next(&mut self.results).await
    }

    pub(super) async fn result(&mut self) -> (String, Value) {
        next(&mut self.results).await
    }

    pub(super) async fn told(&mut self) -> Publication {
        within("a message", self.results.recv()).await.expect("somebody may still answer").taken()
    }

    pub(super) async fn is_silent(&mut self) -> bool {
        self.settled().await;
        self.results.try_recv().is_err()
    }

    pub(super) async fn last(&self) -> Request {
        self.settled().await;
        self.script.given.lock().unwrap().last().cloned().expect("a command was given")
    }

    pub(super) async fn given(&self) -> usize {
        self.settled().await;
        self.script.given.lock().unwrap().len()
    }

    /// Returns the last refusal recorded since the last call: the sender, the command, and the reason.
    pub(super) async fn noted(&self) -> Option<Noted> {
        self.settled().await;
        self.script.noted.lock().unwrap().pop()
    }

    pub(super) fn refuse(&self, refused: Refused) {
        *self.script.refuse.lock().unwrap() = Some(refused);
    }

    /// Gives the loop and the results time to finish. All tasks run on this thread, and each needs a few turns.
    async fn settled(&self) {
        for _ in 0..8 {
            tokio::task::yield_now().await;
        }
    }
}
