//! The session alone, with an artificial state, and a broker that is killed and restarted.

use std::sync::Arc;
use std::time::Duration;

use hallsweep::doors::mqtt::commands::Commands;
use hallsweep::doors::mqtt::session::{Parts, Session, SessionLink, Times, believing};
use hallsweep::doors::mqtt::topics::Topics;
use hallsweep::runtime::archive_reader::ArchiveReader;
use hallsweep::runtime::halt::Halter;
use hallsweep::runtime::handle::{Envelope, Handle};
use hallsweep::storage::sqlite::MemoryStore;
use hallsweep_core::command::Strategy;
use hallsweep_core::engine::Engine;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Epoch, Revision};
use hallsweep_core::world::resource::Resource;
use mqtt_gate::packet::Version;
use tokio::runtime::Runtime;
use tokio::sync::{mpsc, oneshot, watch};

use super::broker::{Broker, CERTIFICATE, Kind, LOGIN};
use super::subscriber::TestSubscriber;

/// Longest wait for anything. It is far longer than needed, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

const ROBOT: &str = "hallsweep/discovery/state/robot";

const AVAILABILITY: &str = "hallsweep/discovery/availability";

/// A session with its inputs and outputs.
struct TestApp {
    runtime: Runtime,
    states: watch::Sender<Arc<Snapshot>>,
    given: mpsc::Receiver<Envelope>,
    shutdown: oneshot::Sender<()>,
    session: tokio::task::JoinHandle<()>,
}

impl TestApp {
    fn at(broker: &Broker, tls: bool) -> TestApp {
        let runtime = Runtime::new().expect("there are threads");
        let (states, watched) = watch::channel(Engine::new(Settings::default(), Strategy::default(), "test".into()).snapshot());
        let (commands, given) = mpsc::channel(16);
        let (answer, answers) = mpsc::channel(16);
        let topics = Topics::new("hallsweep", "discovery", "unibo/qak");
        let handle = Handle::new(commands, watched.clone(), Halter::new(Epoch(1)));
        let session = Session::new(Parts {
            link: SessionLink {
                version: if broker.kind() == Kind::MosquittoFive { Version::Five } else { Version::Three },
                host: "127.0.0.1".to_owned(),
                port: broker.port(),
                tls: tls.then(|| believing(Some(CERTIFICATE.as_ref())).expect("it is a certificate")),
                login: Some((LOGIN.0.to_owned(), LOGIN.1.to_owned())),
                client_id: "hallsweep-discovery".to_owned(),
            },
            commands: Commands::new(handle, topics.clone(), false, answer),
            topics,
            home_assistant: false,
            states: watched,
            answers,
            archive: ArchiveReader::new(MemoryStore::new().archive()),
            seed: u64::from(broker.port()),
            times: Times::default(),
        });
        let (shutdown, ended) = oneshot::channel::<()>();
        let session = runtime.spawn(session.run(async {
            let _ = ended.await;
        }));
        TestApp { runtime, states, given, shutdown, session }
    }

    /// Changes the sonar distance of the robot in the state.
    fn measure(&self, distance_cm: u16) {
        self.states.send_modify(|state| {
            let mut newer = Snapshot::clone(state);
            newer.robot.sonar_cm = Some(distance_cm);
            newer.revision = Revision(newer.revision.0 + 1);
            newer.revisions[Resource::Robot as usize] = newer.revision;
            *state = Arc::new(newer);
        });
    }

    /// Waits until a command arrives.
    fn is_given_something(&mut self) {
        let given = soon(&self.runtime, self.given.recv()).expect("a command comes");
        assert!(matches!(given, Some(Envelope::Command(..))), "{given:?}");
    }

    /// Ends the session.
    fn end(self) {
        self.shutdown.send(()).expect("it runs");
        soon(&self.runtime, self.session).expect("it ends").expect("it did not panic");
    }
}

/// Waits for a future for at most `PATIENCE`.
fn soon<T>(runtime: &Runtime, what: impl Future<Output = T>) -> Option<T> {
    runtime.block_on(async { tokio::time::timeout(PATIENCE, what).await.ok() })
}

/// Waits until the robot is published with this sonar distance.
fn measures(subscriber: &TestSubscriber, distance_cm: u16) {
    subscriber.json(ROBOT, |robot| robot["sonar"] == distance_cm);
}

/// After its restart a killed broker receives the current state, and commands work there again.
fn check(kind: Kind, name: &str) {
    if !kind.is_here() {
        return;
    }
    let mut broker = Broker::start(kind, name);
    let mut app = TestApp::at(&broker, false);
    app.measure(11);
    measures(&TestSubscriber::at(&broker, "hallsweep/#"), 11);
    broker.kill();
    (12..20).for_each(|distance_cm| app.measure(distance_cm));
    broker.start_again();
    measures(&TestSubscriber::at(&broker, "hallsweep/#"), 19);
    TestSubscriber::at(&broker, AVAILABILITY).until("online", |said| &said.payload[..] == b"online");
    let speaker = TestSubscriber::at(&broker, "nothing");
    speaker.say("hallsweep/discovery/command/stop", "");
    app.is_given_something();
    app.end();
    TestSubscriber::at(&broker, AVAILABILITY).until("offline", |said| &said.payload[..] == b"offline");
}

#[test]
fn mosquitto_is_told_the_newest_state_when_it_is_back() {
    check(Kind::Mosquitto, "session-mosquitto");
}

#[test]
fn mosquitto_is_told_the_newest_state_in_mqtt_5_too() {
    check(Kind::MosquittoFive, "session-five");
}

#[test]
fn mosquitto_with_a_login_is_told_the_newest_state_when_it_is_back() {
    check(Kind::MosquittoWithLogin, "session-login");
}

#[test]
fn nats_is_told_the_newest_state_when_it_is_back() {
    check(Kind::Nats, "session-nats");
}

#[test]
fn a_broker_is_reached_by_tls_when_its_certificate_is_believed() {
    if !Kind::MosquittoByTls.is_here() {
        return;
    }
    let broker = Broker::start(Kind::MosquittoByTls, "session-tls");
    let app = TestApp::at(&broker, true);
    broker.until_it_says("Received PUBLISH from hallsweep-discovery");
    app.end();
}
