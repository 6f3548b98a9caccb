//! The router of messages, behind one small handle: where it is, by what it is entered, and its end. It is rumqttd, which
//! listens on a port of this machine alone and is not fit for an open one: whoever comes in from outside meets the gate instead,
//! and only the gate knows how to enter. Whether it is well shows in the pulse of our own session, not here.

use std::collections::HashMap;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use rumqttd::local::LinkTx;
use rumqttd::protocol::v4::V4;
use rumqttd::{ConnectionId, ConnectionSettings, LinkType, RouterConfig, Server, ServerSettings};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;

use super::limits;
use crate::access::Token;
use mqtt_gate::limits::{PROGRAM_PACKET, SEGMENT_BYTES, SEGMENTS};

/// By this name the gate enters.
const GATE: &str = "gate";

/// A port that was free and is taken a moment later is no reason to give up before so many tries.
const TRIES: usize = 5;

/// So long one start may take; it takes a few milliseconds.
const START_TIME: Duration = Duration::from_secs(5);

/// So long its end may take: a gigabyte of small messages takes about one second.
const END_TIME: Duration = Duration::from_secs(5);

/// How long the gate may take to enter, in milliseconds: it is at home.
const CONNECT_TIME_MS: u16 = 5_000;

/// What is taken beyond the longest packet: the router is not to be stricter than the gate.
const ROOM: usize = 1024;

/// How often it is looked whether it listens, or whether it has gone.
const GLANCE: Duration = Duration::from_millis(5);

/// How often it is looked whether its router lives.
const LOOK: Duration = Duration::from_millis(500);

/// A connection that there never is.
const NOBODY: ConnectionId = ConnectionId::MAX;

/// A running router; it ends when this is dropped, and all that it remembers with it.
#[derive(Debug)]
pub(super) struct Router {
    pub(super) address: SocketAddr,
    secret: Token,
    /// Its thread ends when this is changed or dropped;
    stop: watch::Sender<()>,
    /// then this is closed,
    alive: watch::Receiver<()>,
    /// and this when the router has given back all it had.
    gone: watch::Receiver<()>,
    /// Set when it did not let the gate in.
    is_shut: watch::Sender<bool>,
}

#[derive(Debug, thiserror::Error)]
pub enum RouterError {
    #[error("the broker cannot be started: {0}")]
    System(#[from] std::io::Error),
    #[error("the broker does not answer on its own port")]
    Silent,
}

impl Router {
    /// Starts one on a free port of this machine.
    pub(super) async fn start() -> Result<Router, RouterError> {
        for _ in 0..TRIES {
            let router = Router::begin().await?;
            if tokio::time::timeout(START_TIME, router.listens()).await == Ok(true) {
                return Ok(router);
            }
        }
        Err(RouterError::Silent)
    }

    /// One that lets whoever comes in wait for ever.
    #[cfg(test)]
    pub(super) fn hanging(address: SocketAddr) -> Router {
        let secret = Token::draw().expect("the system gives chance");
        let never = || {
            let (holds, seen) = watch::channel(());
            std::mem::forget(holds);
            seen
        };
        Router {
            address,
            secret,
            stop: watch::Sender::new(()),
            alive: never(),
            gone: never(),
            is_shut: watch::Sender::new(false),
        }
    }

    /// Name and password by which it is entered.
    pub(super) fn login(&self) -> (&str, &str) {
        (GATE, self.secret.reveal())
    }

    /// Waits until one of its threads has ended, which they do not do by themselves.
    pub(super) fn ended(&self) -> impl Future<Output = ()> + use<> {
        let mut alive = self.alive.clone();
        async move { while alive.changed().await.is_ok() {} }
    }

    /// Ends it, and waits, but not for long, until it has given back all it had.
    pub(super) fn end(&self) -> impl Future<Output = ()> + use<> {
        self.stop.send_replace(());
        let mut gone = self.gone.clone();
        async move {
            // One that takes longer is left to itself.
            let _ = tokio::time::timeout(END_TIME, async { while gone.changed().await.is_ok() {} }).await;
        }
    }

    pub(super) fn lets_nobody_in(&self) {
        self.is_shut.send_replace(true);
    }

    /// Waits until it has not let the gate in, which lets it do all else.
    pub(super) fn shut(&self) -> impl Future<Output = ()> + use<> {
        let mut is_shut = self.is_shut.subscribe();
        async move {
            if is_shut.wait_for(|is_shut| *is_shut).await.is_err() {
                std::future::pending::<()>().await;
            }
        }
    }

    /// Starts its threads. The crate binds the port itself, so one is looked for that is free just now.
    async fn begin() -> Result<Router, RouterError> {
        let address = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await?.local_addr()?;
        let secret = Token::draw().map_err(std::io::Error::other)?;
        // By the port its thread is known: `router-1883`.
        let requests = rumqttd::Router::new(usize::from(address.port()), config()).spawn();
        let mut last_word = LinkTx::new(NOBODY, requests.clone(), Arc::default());
        let mut server = Server::new(settings(address, &secret), requests.clone(), V4);
        let (stop, mut stopped) = watch::channel(());
        let ((living, alive), (there, gone)) = (watch::channel(()), watch::channel(()));
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        std::thread::Builder::new().name("mqtt-router".to_owned()).spawn(move || {
            let ended = runtime.block_on(async {
                tokio::select! {
                    ended = server.start(LinkType::Remote) => ended,
                    () = ended(|| requests.is_disconnected()) => Ok(()),
                    _ = stopped.changed() => Ok(()),
                }
            });
            if let Err(error) = ended {
                tracing::warn!(%error, "the MQTT router has ended");
            }
            // With the runtime all its connections end.
            drop((runtime, living));
            // rumqttd has no word to end its router's thread, which would keep all that it remembers: but it does not outlive a
            // question for somebody who is not there. One that has much to do may not hear the first.
            while !requests.is_disconnected() {
                let _ = last_word.shadow("");
                std::thread::sleep(GLANCE);
            }
            drop(there);
        })?;
        Ok(Router { address, secret, stop, alive, gone, is_shut: watch::Sender::new(false) })
    }

    /// Waits until it listens; false when its thread has ended.
    async fn listens(&self) -> bool {
        while TcpStream::connect(self.address).await.is_err() {
            if self.alive.has_changed().is_err() {
                return false;
            }
            tokio::time::sleep(GLANCE).await;
        }
        true
    }
}

/// Waits until the thread that routes has ended; nothing tells of that, so it is looked at.
async fn ended(has_ended: impl Fn() -> bool) {
    while !has_ended() {
        tokio::time::sleep(LOOK).await;
    }
}

fn config() -> RouterConfig {
    RouterConfig {
        // With those that have left and are not cleared away yet.
        max_connections: 2 * limits::PLACES,
        max_outgoing_packet_count: limits::BATCH,
        max_segment_size: SEGMENT_BYTES,
        max_segment_count: SEGMENTS,
        ..RouterConfig::default()
    }
}

fn settings(listen: SocketAddr, secret: &Token) -> ServerSettings {
    let auth = HashMap::from([(GATE.to_owned(), secret.reveal().to_owned())]);
    ServerSettings {
        name: "hallsweep".to_owned(),
        listen,
        tls: None,
        next_connection_delay_ms: 0,
        connections: ConnectionSettings {
            connection_timeout_ms: CONNECT_TIME_MS,
            max_payload_size: PROGRAM_PACKET + ROOM,
            max_inflight_count: limits::PACKETS,
            auth: Some(auth),
            external_auth: None,
            // A message that nobody has subscribed to is no mistake of its sender.
            dynamic_filters: false,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn it_listens_on_this_machine_alone_and_ends_with_its_handle() {
        let router = Router::start().await.expect("it starts");
        let address = router.address;
        assert!(address.ip().is_loopback());
        assert!(TcpStream::connect(address).await.is_ok());
        drop(router);
        while TcpStream::connect(address).await.is_ok() {
            tokio::time::sleep(GLANCE).await;
        }
    }

    /// The threads of this program, by name.
    #[cfg(target_os = "linux")]
    fn threads() -> Vec<String> {
        let tasks = std::fs::read_dir("/proc/self/task").expect("the system tells of threads");
        // One may end between the two looks.
        let names = tasks.filter_map(|task| std::fs::read_to_string(task.ok()?.path().join("comm")).ok());
        names.map(|name| name.trim().to_owned()).collect()
    }

    /// What a router remembers goes with it. Safety A5.
    #[cfg(target_os = "linux")]
    #[tokio::test]
    async fn its_router_ends_with_its_handle() {
        let router = Router::start().await.expect("it starts");
        let thread = format!("router-{}", router.address.port());
        // A thread takes its name when it begins to run.
        while !threads().contains(&thread) {
            tokio::time::sleep(GLANCE).await;
        }
        router.end().await;
        while threads().contains(&thread) {
            tokio::time::sleep(GLANCE).await;
        }
    }

    #[tokio::test]
    async fn each_has_a_secret_of_its_own() {
        let (one, other) = (Router::start().await.expect("it starts"), Router::start().await.expect("so does another"));
        assert_ne!(one.login().1, other.login().1);
        assert_ne!(one.address, other.address);
    }
}
