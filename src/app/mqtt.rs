//! Assembles the MQTT door: our own session, and the broker, which is either our own or an external one. The messages
//! are in `doors::mqtt`.

use std::sync::Arc;

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
use crate::doors::mqtt::topics::Topics;
use crate::doors::mqtt::{Clients, IncomingConnection, Origin, Ways, serve};
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::handle::Handle;
use mqtt_gate::Broker;
use mqtt_gate::packet::Version;

/// Capacity of the queue of web clients. A small queue is enough, because the broker is never busy for long.
const WEB_CLIENTS: usize = 16;

pub(super) struct Mqtt {
    session: JoinHandle<()>,
    broker: Option<JoinHandle<()>>,
    hall: Option<http::Hall>,
}

struct Common {
    topics: Topics,
    home_assistant: bool,
    handle: Handle,
    archive: ArchiveReader,
    manual_driving: bool,
    safe_by: SafeBy,
    ending: watch::Receiver<bool>,
}

impl Mqtt {
    /// Opens the door; returns `None` if the settings have no broker. `listeners` are the ports of our own broker,
    /// whose packets are read on a separate thread.
    pub(super) fn open(
        settings: &Settings,
        listeners: Listeners,
        access: Access,
        threads: &Threads,
        budget: ConnectionBudget,
        handle: Handle,
        archive: ArchiveReader,
        ending: watch::Receiver<bool>,
    ) -> Result<Option<Mqtt>, AppError> {
        let MqttSettings { broker, prefix, id, old_prefix, home_assistant } = &settings.mqtt;
        let topics = Topics::new(prefix, id, old_prefix);
        let (home_assistant, manual_driving) = (*home_assistant, settings.old_clients.manual_driving);
        let safe_by = settings.hall.core.rules.safe_by;
        let common = Common { topics, home_assistant, handle, archive, manual_driving, safe_by, ending };
        match broker {
            None => Ok(None),
            Some(config::Broker::Own { router, .. }) => Ok(Some(own(common, listeners, *router, threads, budget, access))),
            Some(config::Broker::Other(other)) => other_broker(common, other).map(Some),
        }
    }

    pub(super) fn hall(&self) -> Option<http::Hall> {
        self.hall.clone()
    }

    /// Waits until the door is closed: the session disconnects first, then the broker ends.
    pub(super) async fn ended(self) {
        for task in [Some(self.session), self.broker].into_iter().flatten() {
            if task.await.is_err() {
                tracing::error!("a part of the MQTT door stopped after an internal error");
            }
        }
    }
}

impl Common {
    fn commands(&self, answers: mpsc::Sender<ResultMessage>) -> Commands {
        Commands::new(self.handle.clone(), self.topics.clone(), self.manual_driving, answers).with_judges(self.safe_by)
    }

    fn shutdown(&self) -> impl Future<Output = ()> + use<> {
        let mut ending = self.ending.clone();
        async move { drop(ending.wait_for(|ending| *ending).await) }
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
    common: Common,
    listeners: Listeners,
    router: MqttRouter,
    threads: &Threads,
    budget: ConnectionBudget,
    access: Access,
) -> Mqtt {
    let (answer, answers) = mpsc::channel(ANSWERS);
    let (visit, web_clients) = mpsc::channel(WEB_CLIENTS);
    let (commands, shutdown) = (common.commands(answer), common.shutdown());
    let topics = common.topics.clone();
    let broker = Arc::new(match router {
        #[cfg(feature = "rumqttd-router")]
        MqttRouter::Rumqttd => Broker::with_router(topics, RumqttdRouter::start(threads.gate.handle().clone())),
        #[cfg(not(feature = "rumqttd-router"))]
        MqttRouter::Rumqttd => Broker::new(topics),
        MqttRouter::Own => Broker::new(topics),
    });
    let clients = Clients::with_budget(Arc::clone(&broker), commands, budget);
    let Common { topics, home_assistant, handle, archive, .. } = common;
    let session = OwnSession::new(broker, topics, home_assistant, handle.watch(), answers, archive);
    let (leave, mut left) = watch::channel(());
    let session = tokio::spawn(async move {
        let _leave = leave;
        session.run(shutdown).await;
    });
    let ways = Ways { listeners, access, web_clients, hearing: threads.mqtt.handle().clone() };
    // The broker waits until the session has disconnected, so that the session's last messages are delivered.
    let disconnected = async move { while left.changed().await.is_ok() {} };
    let broker = threads.gate.handle().spawn(serve(clients, ways, disconnected));
    Mqtt { session, broker: Some(broker), hall: Some(hall(visit)) }
}

fn other_broker(common: Common, other: &OtherBroker) -> Result<Mqtt, AppError> {
    let (answer, answers) = mpsc::channel(ANSWERS);
    let tls = if other.is_encrypted { Some(believing(other.certificates.as_deref())?) } else { None };
    let link = SessionLink {
        version: if other.is_five { Version::Five } else { Version::Three },
        host: other.host.clone(),
        port: other.port,
        tls,
        login: other.login.as_ref().map(|login| (login.name.clone(), login.password.clone())),
        client_id: format!("hallsweep-{}", common.topics.id()),
    };
    let [a, b, c, d, e, f, g, h, ..] = access::chance()?;
    let (commands, shutdown) = (common.commands(answer), common.shutdown());
    let session = Session::new(Parts {
        link,
        commands,
        topics: common.topics,
        home_assistant: common.home_assistant,
        states: common.handle.watch(),
        answers,
        archive: common.archive,
        seed: u64::from_be_bytes([a, b, c, d, e, f, g, h]),
        times: Times::default(),
    });
    let session = tokio::spawn(session.run(shutdown));
    Ok(Mqtt { session, broker: None, hall: None })
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
