//! The MQTT door, joined: our own session, and the broker it speaks to, which is our own or somebody else's. What is said and heard
//! there is the door's business.

use std::net::SocketAddr;

use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;

use super::AppError;
use super::threads::Threads;
use crate::access::{self, Access, Token};
use crate::config::{Broker, MqttSettings, OtherBroker, Settings, from_here};
use crate::doors::http;
use crate::doors::listeners::Listeners;
use crate::doors::mqtt::commands::{ANSWERS, Answer, Commands};
use crate::doors::mqtt::session::{Health, Hearing, Link, Parts, Session, Times, believing};
use crate::doors::mqtt::topics::Topics;
use crate::doors::mqtt::{Clients, Embedded, IncomingConnection, OWN_SESSION, Origin, Ways};
use crate::doors::room::Room;
use crate::runtime::archive_reader::Reader;
use crate::runtime::handle::Handle;

/// Web clients that wait to be received: the broker is never busy for long.
const WEB_CLIENTS: usize = 16;

pub(super) struct Mqtt {
    session: JoinHandle<()>,
    broker: Option<JoinHandle<()>>,
    hall: Option<http::Hall>,
}

/// What both kinds of broker have in common.
struct Common {
    topics: Topics,
    home_assistant: bool,
    handle: Handle,
    archive: Reader,
    manual_driving: bool,
    ending: watch::Receiver<bool>,
}

impl Mqtt {
    /// Opens the door, if there is to be one: at these ports, of which the first has the address `at`, where it is our own broker's; what
    /// clients say there is heard on `hearing`.
    pub(super) async fn open(
        settings: &Settings,
        (listeners, at, access, inner): (Listeners, Option<SocketAddr>, Access, (&Threads, Room)),
        handle: Handle,
        archive: Reader,
        ending: watch::Receiver<bool>,
    ) -> Result<Option<Mqtt>, AppError> {
        let MqttSettings { broker, prefix, id, old_prefix, home_assistant } = &settings.mqtt;
        let topics = Topics::new(prefix, id, old_prefix);
        let (home_assistant, manual_driving) = (*home_assistant, settings.old_clients.manual_driving);
        let common = Common { topics, home_assistant, handle, archive, manual_driving, ending };
        match (broker, at) {
            (None, _) | (Some(Broker::Own { .. }), None) => Ok(None),
            (Some(Broker::Own { .. }), Some(at)) => own(common, (listeners, at), inner, access).await.map(Some),
            (Some(Broker::Other(other)), _) => other_broker(common, other).map(Some),
        }
    }

    /// Where web clients are brought, when the broker is our own.
    pub(super) fn hall(&self) -> Option<http::Hall> {
        self.hall.clone()
    }

    /// Waits for its end: the session takes its leave, and then the broker ends.
    pub(super) async fn ended(self) {
        for task in [Some(self.session), self.broker].into_iter().flatten() {
            if task.await.is_err() {
                tracing::error!("a part of the MQTT door has ended by a mistake of its own");
            }
        }
    }
}

impl Common {
    fn commands(&self, answers: mpsc::Sender<Answer>) -> Commands {
        Commands::new(self.handle.clone(), self.topics.clone(), self.manual_driving, answers)
    }

    /// The session through this link; it ends when the program does.
    fn session(
        self,
        (link, hearing): (Link, Hearing),
        answers: mpsc::Receiver<Answer>,
        health: watch::Sender<Health>,
    ) -> Result<JoinHandle<()>, AppError> {
        let [a, b, c, d, e, f, g, h, ..] = access::chance()?;
        let parts = Parts {
            link,
            hearing,
            topics: self.topics,
            home_assistant: self.home_assistant,
            states: self.handle.watch(),
            answers,
            archive: self.archive,
            health,
            seed: u64::from_be_bytes([a, b, c, d, e, f, g, h]),
            times: Times::default(),
        };
        let mut ending = self.ending;
        let shutdown = async move { drop(ending.wait_for(|ending| *ending).await) };
        Ok(tokio::spawn(Session::new(parts).run(shutdown)))
    }
}

async fn own(
    common: Common,
    (listeners, at): (Listeners, SocketAddr),
    (threads, room): (&Threads, Room),
    access: Access,
) -> Result<Mqtt, AppError> {
    let (answer, answers) = mpsc::channel(ANSWERS);
    let (visit, web_clients) = mpsc::channel(WEB_CLIENTS);
    let health = watch::Sender::new(Health::Unproven);
    let secret = Token::draw()?;
    let link = Link {
        host: from_here(at).ip().to_string(),
        port: at.port(),
        tls: None,
        login: Some((OWN_SESSION.to_owned(), secret.reveal().to_owned())),
        client_id: format!("hallsweep-{}", common.topics.id()),
    };
    let clients = Clients::with_room(mqtt_gate::Broker::new(common.topics.clone()), common.commands(answer), secret, room);
    let broker = Embedded::start(clients).await?;
    let hearing = threads.mqtt.handle().clone();
    let ways = Ways { listeners, access, web_clients, hearing, health: health.subscribe() };
    let session = common.session((link, Hearing::Own), answers, health)?;
    let (leave, left) = watch::channel(());
    let session = tokio::spawn(async move {
        let _leave = leave;
        if session.await.is_err() {
            tracing::error!("our own MQTT session has ended by a mistake of its own");
        }
    });
    let broker = threads.gate.handle().spawn(broker.serve(ways, gone(left)));
    Ok(Mqtt { session, broker: Some(broker), hall: Some(hall(visit)) })
}

/// Waits until the session has taken its leave, so that its last words are passed on.
async fn gone(mut left: watch::Receiver<()>) {
    while left.changed().await.is_ok() {}
}

fn other_broker(common: Common, other: &OtherBroker) -> Result<Mqtt, AppError> {
    let (answer, answers) = mpsc::channel(ANSWERS);
    let tls = if other.is_encrypted { Some(believing(other.certificates.as_deref())?) } else { None };
    let link = Link {
        host: other.host.clone(),
        port: other.port,
        tls,
        login: other.login.as_ref().map(|login| (login.name.clone(), login.password.clone())),
        client_id: format!("hallsweep-{}", common.topics.id()),
    };
    let hearing = Hearing::Other(common.commands(answer));
    let session = common.session((link, hearing), answers, watch::Sender::new(Health::Unproven))?;
    Ok(Mqtt { session, broker: None, hall: None })
}

/// Where web clients are brought. One that finds the broker busy is sent away, and comes again.
fn hall(visit: mpsc::Sender<IncomingConnection>) -> http::Hall {
    http::Hall::new(move |connection: http::IncomingConnection| {
        let origin = Origin { from: connection.from, caller: connection.caller, access: connection.access };
        if visit.try_send(IncomingConnection::over(connection.stream, origin)).is_err() {
            tracing::debug!("a web client found the MQTT broker busy");
        }
    })
}
