//! Helpers for tests of the session: a broker on loopback that does what the test says, and an app whose state the
//! test sets. The broker routes nothing; the tests of the service use real brokers.

use std::net::SocketAddr;
use std::sync::Arc;

use bytes::BytesMut;
use rumqttc::mqttbytes::Error;
use rumqttc::{
    ConnAck, Connect, ConnectReturnCode, Packet, PubAck, Publish, QoS, SubAck, Subscribe, SubscribeFilter, SubscribeReasonCode,
};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

use super::super::commands::Commands;
use super::super::publication::LARGEST;
use super::super::topic_map::TopicMap;
use super::super::topics::Topics;
use super::{Parts, Session, SessionLink, Times};
use crate::runtime::archive::Unreadable;
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::tests::obedient::{Script, obedient};
use crate::runtime::tests::partial_archive::PartialArchive;
use crate::runtime::tests::within::within;
use hallsweep_core::event::Photo;
use hallsweep_core::hall::HallId;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::LuggageId;
use mqtt_gate::packet::Version;

pub(super) struct TestApp {
    pub(super) script: Script,
    shutdown: Option<oneshot::Sender<()>>,
    session: JoinHandle<()>,
}

pub(super) struct TestBroker(TcpListener);

pub(in super::super) struct Peer {
    stream: TcpStream,
    buffer: BytesMut,
}

pub(in super::super) fn topics() -> Topics {
    Topics::new("hallsweep", "discovery", "unibo/qak")
}

pub(in super::super) fn hall(name: &str) -> HallId {
    HallId::new(name).unwrap()
}

/// The topics of the default hall `main`, and of these further halls.
pub(in super::super) fn map(further: &[&str]) -> TopicMap {
    let map = TopicMap::new(hall("main"), topics());
    for name in further {
        map.add(&hall(name));
    }
    map
}

pub(in super::super) fn publish(topic: &str, payload: &str, id: u16) -> Publish {
    let mut publish = Publish::new(topic, QoS::AtLeastOnce, payload);
    publish.pkid = id;
    publish
}

impl TestApp {
    /// Runs a session with this broker. Must be called inside a runtime.
    pub(super) fn run(snapshot: Snapshot, broker: SocketAddr, times: Times) -> TestApp {
        TestApp::run_for(topics(), snapshot, broker, times)
    }

    pub(super) fn run_for(topics: Topics, snapshot: Snapshot, broker: SocketAddr, times: Times) -> TestApp {
        let (handle, script) = obedient(snapshot);
        let (give, answers) = mpsc::channel(16);
        let commands = Commands::new(handle, topics.clone(), true, give);
        let session = Session::new(Parts {
            link: SessionLink {
                version: Version::Three,
                host: broker.ip().to_string(),
                port: broker.port(),
                tls: None,
                login: Some(("robot".to_owned(), "secret".to_owned())),
                client_id: "hallsweep-discovery".to_owned(),
            },
            commands,
            topics,
            home_assistant: true,
            states: script.publish.subscribe(),
            answers,
            archive: ArchiveReader::new(Arc::new(Album)),
            seed: 1,
            times,
        });
        let (shutdown, ended) = oneshot::channel();
        let session = tokio::spawn(session.run(async {
            let _ = ended.await;
        }));
        TestApp { script, shutdown: Some(shutdown), session }
    }

    pub(super) fn shut_down(&mut self) {
        let shutdown = self.shutdown.take().expect("it is told once");
        shutdown.send(()).expect("it runs");
    }

    pub(super) async fn ended(self) {
        within("its end", self.session).await.expect("it did not panic");
    }
}

impl TestBroker {
    pub(super) async fn open() -> TestBroker {
        TestBroker(TcpListener::bind("127.0.0.1:0").await.expect("there is a free port"))
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.0.local_addr().expect("it is bound")
    }

    pub(super) async fn peer(&self) -> Peer {
        let (stream, _) = within("somebody", self.0.accept()).await.expect("somebody connects");
        Peer { stream, buffer: BytesMut::new() }
    }

    pub(super) async fn principal(&self) -> (Peer, Connect, Vec<String>) {
        let mut peer = self.peer().await;
        let (connect, filters) = peer.greet().await;
        (peer, connect, filters)
    }
}

impl Peer {
    pub(in super::super) async fn come(broker: SocketAddr) -> Peer {
        let stream = within("the broker", TcpStream::connect(broker)).await.expect("the broker listens");
        Peer { stream, buffer: BytesMut::new() }
    }

    /// Sends a CONNECT; returns the code of the answer, or `None` if there is no answer.
    pub(in super::super) async fn introduces(&mut self, connect: Packet) -> Option<ConnectReturnCode> {
        self.says(connect).await;
        match self.hears().await {
            Some(Packet::ConnAck(answer)) => Some(answer.code),
            Some(_) | None => None,
        }
    }

    pub(in super::super) async fn asks_for(&mut self, filters: impl IntoIterator<Item = &str>) {
        let filters = filters.into_iter().map(|filter| SubscribeFilter::new(filter.to_owned(), QoS::AtMostOnce));
        let mut asked = Subscribe::new_many(filters);
        asked.pkid = 1;
        self.says(Packet::Subscribe(asked)).await;
        while !matches!(within("an answer", self.hears()).await.expect("it is answered"), Packet::SubAck(_)) {}
    }

    pub(in super::super) async fn hears_message(&mut self) -> Publish {
        self.unacknowledged(|_| true).await
    }

    /// Returns the next packet, or `None` when the connection has ended.
    pub(super) async fn hears(&mut self) -> Option<Packet> {
        loop {
            match Packet::read(&mut self.buffer, LARGEST) {
                Ok(packet) => return Some(packet),
                Err(Error::InsufficientBytes(_)) => {}
                Err(error) => panic!("no client says this: {error}"),
            }
            if within("a packet", self.stream.read_buf(&mut self.buffer)).await.unwrap_or(0) == 0 {
                return None;
            }
        }
    }

    /// Sends a packet. Errors are ignored, because the other side may have left.
    pub(in super::super) async fn says(&mut self, packet: Packet) {
        let mut bytes = BytesMut::new();
        packet.write(&mut bytes, LARGEST).expect("it is a packet");
        let _ = self.stream.write_all(&bytes).await;
    }

    pub(super) async fn answers(&mut self, code: ConnectReturnCode) -> Connect {
        let Some(Packet::Connect(connect)) = self.hears().await else { panic!("a client says who it is") };
        self.says(Packet::ConnAck(ConnAck::new(code, false))).await;
        connect
    }

    pub(super) async fn greet(&mut self) -> (Connect, Vec<String>) {
        let connect = self.answers(ConnectReturnCode::Success).await;
        let Some(Packet::Subscribe(asked)) = self.hears().await else { panic!("it subscribes before it says anything") };
        let granted = vec![SubscribeReasonCode::Success(QoS::AtLeastOnce); asked.filters.len()];
        self.says(Packet::SubAck(SubAck::new(asked.pkid, granted))).await;
        (connect, asked.filters.into_iter().map(|filter| filter.path).collect())
    }

    /// Acknowledges publications until one on `topic` arrives. Returns that publication.
    pub(super) async fn until(&mut self, topic: &str) -> Publish {
        loop {
            let publish = self.unacknowledged(|_| true).await;
            self.says(Packet::PubAck(PubAck::new(publish.pkid))).await;
            if publish.topic == topic {
                return publish;
            }
        }
    }

    /// Returns the next matching publication. Neither this publication nor any before it is acknowledged.
    pub(super) async fn unacknowledged(&mut self, is_it: impl Fn(&Publish) -> bool) -> Publish {
        loop {
            match self.hears().await {
                Some(Packet::Publish(publish)) if is_it(&publish) => return publish,
                Some(_) => {}
                None => panic!("the connection has ended"),
            }
        }
    }

    /// Waits until the other side has closed the connection.
    pub(in super::super) async fn is_left(&mut self) {
        while self.hears().await.is_some() {}
    }
}

pub(in super::super) struct Album;

impl PartialArchive for Album {
    fn photo(&self, _: LuggageId) -> Result<Option<Photo>, Unreadable> {
        Ok(Some(Photo { bytes: Arc::from(*b"\x89PNG"), media_type: "image/png" }))
    }
}
