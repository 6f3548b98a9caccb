//! Many observers of one resource, each with its own port, acknowledge every confirmable notification. Measured are
//! the time from a change until the last observer receives it, and whether all observers do.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use tokio::net::UdpSocket;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use crate::client::Client;
use crate::datagram::{Asking, CONTENT, GET, OBSERVE, Told, acknowledgement};

pub(crate) const OBSERVERS: usize = 500;

/// Number of changes.
pub(crate) const ROUNDS: u32 = 12;

/// Time limit of a round; it ends before the first retransmission of a lost message.
const ROUND: Duration = Duration::from_secs(2);

/// Pause between two rounds, so that the servers become idle.
const REST: Duration = Duration::from_millis(250);

/// Result of one change.
pub(crate) struct Round {
    /// Number of observers that received the change.
    pub(crate) heard: usize,
    /// Time from the change until the last of these observers received it.
    pub(crate) last: Duration,
}

/// Observer number, received temperature in °C, and time of receipt.
type Heard = (usize, f64, Instant);

/// Registers all observers and changes the temperature `ROUNDS` times; `text` builds the payload of the change.
pub(crate) fn rounds(server: SocketAddr, path: &'static str, text: impl Fn(f64) -> String) -> Vec<Round> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("the system gives sockets");
    runtime.block_on(async {
        let (hear, mut heard) = unbounded_channel();
        let mut sockets = Vec::new();
        for observer in 0..OBSERVERS {
            sockets.push(registered(server, path, observer).await);
        }
        for (observer, socket) in sockets.into_iter().enumerate() {
            tokio::spawn(listen(socket, observer, hear.clone()));
        }
        let mut rounds = Vec::new();
        for number in 0..ROUNDS {
            tokio::time::sleep(REST).await;
            let celsius = 10.5 + f64::from(number);
            rounds.push(round(server, path, celsius, text(celsius), &mut heard).await);
        }
        rounds
    })
}

/// Returns a socket whose observation the server has confirmed.
async fn registered(server: SocketAddr, path: &str, observer: usize) -> UdpSocket {
    let socket = UdpSocket::bind("127.0.0.1:0").await.expect("a free port");
    socket.connect(server).await.expect("an address of this machine");
    let mut asking = Asking::new(GET, path, &[(OBSERVE, &[])], &[]);
    let mut room = [0; 2048];
    loop {
        let _ = socket.send(asking.numbered(observer as u16, observer as u32)).await;
        if let Ok(Ok(length)) = tokio::time::timeout(ROUND, socket.recv(&mut room)).await {
            let told = Told::read(&room[..length]);
            assert!(told.is_some_and(|told| told.code == CONTENT), "the observation of {path} is refused");
            return socket;
        }
    }
}

/// Acknowledges and forwards every notification until the runtime ends.
async fn listen(socket: UdpSocket, observer: usize, hear: UnboundedSender<Heard>) {
    let mut room = [0; 2048];
    while let Ok(length) = socket.recv(&mut room).await {
        let at = Instant::now();
        let Some(told) = Told::read(&room[..length]) else { continue };
        if told.confirmable {
            let _ = socket.send(&acknowledgement(told.id)).await;
        }
        if let Some(celsius) = celsius(told.payload) {
            let _ = hear.send((observer, celsius, at));
        }
    }
}

/// Makes one change and waits until all observers have received it or the round's time is over.
async fn round(server: SocketAddr, path: &str, celsius: f64, text: String, heard: &mut UnboundedReceiver<Heard>) -> Round {
    let changed = Instant::now();
    let path = path.to_owned();
    let put = tokio::task::spawn_blocking(move || Client::new(server).put(&path, &text));
    let mut all = vec![false; OBSERVERS];
    let mut round = Round { heard: 0, last: Duration::ZERO };
    let over = tokio::time::Instant::from_std(changed + ROUND);
    while round.heard < OBSERVERS {
        let Ok(Some((observer, told, at))) = tokio::time::timeout_at(over, heard.recv()).await else { break };
        if told == celsius && !std::mem::replace(&mut all[observer], true) {
            round.heard += 1;
            round.last = at - changed;
        }
    }
    let answer = put.await.expect("a client does not panic");
    assert!(answer.as_ref().is_none_or(|(code, _)| code >> 5 == 2), "the change was refused: {answer:?}");
    round
}

/// Temperature in °C that a payload contains.
fn celsius(payload: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(payload).ok()?;
    let (_, rest) = text.split_once("\"celsius\":")?;
    rest.split([',', '}']).next()?.trim().parse().ok()
}
