//! Assembles the MQTT door: a session for each hall, and the broker, which is either our own or an external one. The messages
//! are in `doors::mqtt`.

use std::sync::Arc;

use hallsweep_core::hall::HallId;
use hallsweep_core::settings::SafeBy;
use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;

use super::AppError;
use super::threads::Threads;
use crate::access::{self, Access};
use crate::config::{self, MqttRouter, MqttSettings, OtherBroker, Settings};
use crate::doors::connection_limits::ConnectionBudget;
use crate::doors::http;
use crate::doors::listeners::Listeners;
#[cfg(feature = "rumqttd-router")]
use crate::doors::mqtt::RumqttdRouter;
use crate::doors::mqtt::commands::{ANSWERS, Commands, ResultMessage};
use crate::doors::mqtt::session::{OwnSession, Parts, Session, SessionLink, Times, believing};
use crate::doors::mqtt::topic_map::TopicMap;
use crate::doors::mqtt::topics::Topics;
use crate::doors::mqtt::{Clients, Halls, IncomingConnection, Origin, Ways, serve};
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::handle::Handle;
use mqtt_gate::Broker;
use mqtt_gate::packet::Version;

/// Capacity of the queue of web clients. A small queue is enough, because the broker is never busy for long.
const WEB_CLIENTS: usize = 16;

pub(super) struct Mqtt {
    sessions: Vec<JoinHandle<()>>,
    broker: Option<JoinHandle<()>>,
    hall: Option<http::Hall>,
}

/// A hall whose state is published, and that obeys commands.
pub(super) struct MqttHall {
    pub(super) name: HallId,
    pub(super) handle: Handle,
    pub(super) archive: ArchiveReader,
    pub(super) safe_by: SafeBy,
}

/// What all halls have in common.
struct Common {
    topics: TopicMap,
    home_assistant: bool,
    manual_driving: bool,
    ending: watch::Receiver<bool>,
}

impl Mqtt {
    /// Opens the door; returns `None` if the settings have no broker. `listeners` are the ports of our own broker,
    /// whose packets are read on a separate thread. `default` is the hall of the old topics.
    pub(super) fn open(
        settings: &Settings,
        listeners: Listeners,
        access: Access,
        threads: &Threads,
        budget: ConnectionBudget,
        default: MqttHall,
        further: Vec<MqttHall>,
        ending: watch::Receiver<bool>,
    ) -> Result<Option<Mqtt>, AppError> {
        let MqttSettings { broker, prefix, id, old_prefix, home_assistant } = &settings.mqtt;
        let first = Topics::new(prefix, id, old_prefix);
        let topics = TopicMap::new(default.name.clone(), first.clone());
        let (home_assistant, manual_driving) = (*home_assistant, settings.old_clients.manual_driving);
        let further = further.into_iter().map(|hall| (topics.add(&hall.name), hall)).collect();
        let common = Common { topics, home_assistant, manual_driving, ending };
        match broker {
            None => Ok(None),
            Some(config::Broker::Own { router, .. }) => {
                Ok(Some(own(&common, *router, (first, default), further, listeners, threads, budget, access)))
            }
            Some(config::Broker::Other(other)) => other_broker(&common, other, (first, default), further).map(Some),
        }
    }

    pub(super) fn hall(&self) -> Option<http::Hall> {
        self.hall.clone()
    }

    /// Waits until the door is closed: the sessions disconnect first, then the broker ends.
    pub(super) async fn ended(self) {
        for task in self.sessions.into_iter().chain(self.broker) {
            if task.await.is_err() {
                tracing::error!("a part of the MQTT door stopped after an internal error");
            }
        }
    }
}

impl Common {
    fn commands(&self, topics: &Topics, hall: &MqttHall, answers: mpsc::Sender<ResultMessage>) -> Commands {
        let commands = Commands::new(hall.handle.clone(), topics.clone(), self.manual_driving, answers);
        commands.with_judges(hall.safe_by).among(self.topics.clone())
    }

    fn shutdown(&self) -> impl Future<Output = ()> + use<> {
        let mut ending = self.ending.clone();
        async move { drop(ending.wait_for(|ending| *ending).await) }
    }

    /// Begins to publish for a hall at our own broker. The session keeps `leave` until it has disconnected.
    fn own_session(
        &self,
        broker: &Arc<Broker>,
        topics: Topics,
        hall: MqttHall,
        leave: watch::Sender<()>,
    ) -> (Commands, JoinHandle<()>) {
        let (answer, answers) = mpsc::channel(ANSWERS);
        let (commands, shutdown) = (self.commands(&topics, &hall, answer), self.shutdown());
        let MqttHall { handle, archive, .. } = hall;
        let session = OwnSession::new(Arc::clone(broker), topics, self.home_assistant, handle.watch(), answers, archive);
        let task = tokio::spawn(async move {
            let _leave = leave;
            session.run(shutdown).await;
        });
        (commands, task)
    }

    /// Begins to publish for a hall at another broker, in a connection of its own.
    fn session(&self, link: SessionLink, topics: Topics, hall: MqttHall) -> Result<JoinHandle<()>, AppError> {
        let (answer, answers) = mpsc::channel(ANSWERS);
        let [a, b, c, d, e, f, g, h, ..] = access::chance()?;
        let (commands, shutdown) = (self.commands(&topics, &hall, answer), self.shutdown());
        let session = Session::new(Parts {
            link,
            commands,
            topics,
            home_assistant: self.home_assistant,
            states: hall.handle.watch(),
            answers,
            archive: hall.archive,
            seed: u64::from_be_bytes([a, b, c, d, e, f, g, h]),
            times: Times::default(),
        });
        Ok(tokio::spawn(session.run(shutdown)))
    }
}

/// A message to an operator if the settings ask for rumqttd, but the program was built without it.
pub(super) fn note(settings: &Settings) -> Option<String> {
    let asks = matches!(settings.mqtt.broker, Some(config::Broker::Own { router: MqttRouter::Rumqttd, .. }));
    (asks && !cfg!(feature = "rumqttd-router")).then(|| {
        "mqtt.router is rumqttd, but this hallsweep was built without rumqttd and uses its own router: set mqtt.router to own, \
         or build hallsweep with --features rumqttd-router"
            .to_owned()
    })
}

fn own(
    common: &Common,
    router: MqttRouter,
    (first, default): (Topics, MqttHall),
    further: Vec<(Topics, MqttHall)>,
    listeners: Listeners,
    threads: &Threads,
    budget: ConnectionBudget,
    access: Access,
) -> Mqtt {
    let rights = common.topics.clone();
    let broker = &Arc::new(match router {
        #[cfg(feature = "rumqttd-router")]
        MqttRouter::Rumqttd => Broker::with_router(rights, RumqttdRouter::start(threads.gate.handle().clone())),
        #[cfg(not(feature = "rumqttd-router"))]
        MqttRouter::Rumqttd => Broker::new(rights),
        MqttRouter::Own => Broker::new(rights),
    });
    let (leave, mut left) = watch::channel(());
    broker.set_program_room(1 + further.len());
    let (commands, session) = common.own_session(broker, first, default, leave.clone());
    let (halls, mut sessions) = (Halls::new(common.topics.clone(), commands), vec![session]);
    for (topics, hall) in further {
        let name = hall.name.clone();
        let (commands, session) = common.own_session(broker, topics, hall, leave.clone());
        halls.add(&name, commands);
        sessions.push(session);
    }
    drop(leave);
    let clients = Clients::with_budget(Arc::clone(broker), halls, budget);
    let (visit, web_clients) = mpsc::channel(WEB_CLIENTS);
    let ways = Ways { listeners, access, web_clients, hearing: threads.mqtt.handle().clone() };
    // The broker waits until the sessions have disconnected, so that their last messages are delivered.
    let disconnected = async move { while left.changed().await.is_ok() {} };
    let broker = threads.gate.handle().spawn(serve(clients, ways, disconnected));
    Mqtt { sessions, broker: Some(broker), hall: Some(hall(visit)) }
}

fn other_broker(
    common: &Common,
    other: &OtherBroker,
    default: (Topics, MqttHall),
    further: Vec<(Topics, MqttHall)>,
) -> Result<Mqtt, AppError> {
    let tls = if other.is_encrypted { Some(believing(other.certificates.as_deref())?) } else { None };
    let client_id = format!("hallsweep-{}", default.0.id());
    let link = |client_id| SessionLink {
        version: if other.is_five { Version::Five } else { Version::Three },
        host: other.host.clone(),
        port: other.port,
        tls: tls.clone(),
        login: other.login.as_ref().map(|login| (login.name.clone(), login.password.clone())),
        client_id,
    };
    let mut sessions = vec![common.session(link(client_id.clone()), default.0, default.1)?];
    for (topics, hall) in further {
        let link = link(format!("{client_id}-{}", hall.name));
        sessions.push(common.session(link, topics, hall)?);
    }
    Ok(Mqtt { sessions, broker: None, hall: None })
}

/// Passes web clients to the broker. If the queue is full, the client is disconnected and may try again.
fn hall(visit: mpsc::Sender<IncomingConnection>) -> http::Hall {
    http::Hall::new(move |connection: http::IncomingConnection| {
        let origin = Origin { from: connection.from, caller: connection.caller, access: connection.access };
        if visit.try_send(IncomingConnection::over(connection.stream, origin)).is_err() {
            tracing::debug!("a web client found the MQTT broker busy");
        }
    })
}
