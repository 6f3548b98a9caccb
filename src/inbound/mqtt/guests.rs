//! From a visitor to a guest: a client says who it is, is let in or told why not, gets its slot and its way to the engine, and is
//! then served by the pump. What it may do as a guest is the gate's business.

use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

use bytes::{Buf, BytesMut};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::Semaphore;

use super::embedded::Running;
use super::engine::Engine;
use super::gate::frame::{Kind, Malformed, frame};
use super::gate::limits::CONNECT;
use super::gate::packet::connect::{self, Connect, NoConnect};
use super::gate::packet::write::{self, Welcome};
use super::gate::rights::Guest;
use super::gate::turnstile::{Ended, Gatehouse, Terms, Turnstile};
use super::identity::{Identity, Unknown};
use super::limits::{CONNECT_TIME, CONNECTIONS, PLACES};
use super::orders::Orders;
use super::pump::{self, Ends};
use super::slots::{Name, Slot, Slots};
use super::visitor::{Origin, Stream, Visitor};
use crate::access::{Attempts, Network, Token};
use crate::inbound::places::{Place, Places};
use crate::runtime::clock::Clock;

/// So long the engine may take to answer; it takes less than a millisecond.
const ENGINE_TIME: Duration = Duration::from_secs(5);

/// How long the gate may be silent towards the engine, in seconds: the most there is, and longer than the longest silence of a client.
const SILENCE_S: u16 = u16::MAX;

/// The longest name of a client, in bytes; the standard asks for 23.
const CLIENT_ID: usize = 256;

/// Why a visitor did not become a guest, or is one no more.
#[derive(Debug, thiserror::Error)]
enum Sent {
    #[error("it did not say in time who it is")]
    Slow,
    #[error("its first packet is a {0:?}, not a CONNECT")]
    First(Kind),
    #[error(transparent)]
    Unfit(#[from] NoConnect),
    #[error(transparent)]
    Malformed(#[from] Malformed),
    #[error("it was refused with {0:?}")]
    Refused(Welcome),
    #[error("its connection broke: {0}")]
    Broken(#[from] std::io::Error),
    #[error("{0}")]
    Ended(Ended),
}

/// What all connections to our own broker have in common. Cheap to clone.
#[derive(Clone)]
pub struct House(Arc<Rooms>);

struct Rooms {
    gatehouse: Arc<Gatehouse>,
    orders: Orders,
    /// The password of our own session.
    secret: Token,
    places: Places,
    seats: Arc<Semaphore>,
    slots: Slots,
    attempts: Attempts,
    clock: Clock,
}

impl House {
    /// A house without guests. Commands go to `orders`; our own session comes with the password `secret`.
    #[must_use]
    pub fn new(gatehouse: Gatehouse, orders: Orders, secret: Token) -> House {
        House(Arc::new(Rooms {
            gatehouse: Arc::new(gatehouse),
            orders,
            secret,
            places: Places::new(PLACES),
            seats: Arc::new(Semaphore::new(CONNECTIONS)),
            slots: Slots::default(),
            attempts: Attempts::default(),
            clock: Clock::default(),
        }))
    }

    /// A place for a connection from there; `None` when everybody here is known already.
    pub(super) fn place(&self, from: IpAddr) -> Option<Arc<Place>> {
        self.0.places.take(from).map(Arc::new)
    }

    /// Cuts some connections of strangers, when the system has no more descriptors; how many.
    pub(super) fn relieve(&self) -> usize {
        self.0.places.relieve()
    }

    /// Whether the engine was shown so much that another one is needed.
    pub(super) fn is_worn_out(&self) -> bool {
        self.0.gatehouse.budget.is_exhausted()
    }

    /// How many bytes are kept, which is no doing of the engine's.
    pub(super) fn kept_bytes(&self) -> usize {
        self.0.gatehouse.retained.bytes()
    }

    /// There is another engine, which knows nothing yet.
    pub(super) fn renew(&self) {
        self.0.gatehouse.budget.renew();
    }

    /// Serves a visitor to the end, or until its place is needed.
    pub(super) async fn entertain(self, visitor: Visitor, place: Arc<Place>, engine: Running) {
        let from = visitor.origin.from;
        tokio::select! {
            () = place.cut() => tracing::debug!(%from, "an MQTT connection gave way to a newer one"),
            Err(sent) = self.converse(visitor, &place, engine) => tracing::debug!(%from, why = %sent, "an MQTT connection has ended"),
        }
    }

    /// Never ends well: the error is why it ended.
    async fn converse(&self, mut visitor: Visitor, place: &Arc<Place>, engine: Running) -> Result<(), Sent> {
        let _asked = place.begin();
        let mut heard = BytesMut::new();
        let introduced = tokio::time::timeout(CONNECT_TIME, introduction(&mut visitor.stream, &mut heard)).await;
        let connect = match introduced.map_err(|_| Sent::Slow)? {
            Err(Sent::Unfit(unfit)) => return Err(told(&mut visitor.stream, unfit.answer(), Sent::Unfit(unfit)).await),
            introduced => introduced?,
        };
        let identity = match self.admit(&connect, &visitor.origin).await {
            Ok(identity) => identity,
            Err(welcome) => return Err(refused(&mut visitor.stream, welcome).await),
        };
        place.known();
        let seat = if identity.guest() == Guest::House { None } else { Some(Arc::clone(&self.0.seats).try_acquire_owned()) };
        if matches!(seat, Some(Err(_))) {
            tracing::warn!(from = %visitor.origin.from, most = CONNECTIONS, "an MQTT client was refused: there are too many");
            return Err(refused(&mut visitor.stream, Welcome::Unavailable).await);
        }
        let name = Name { who: identity.name(), client: connect.client_id.clone() };
        let slot = self.0.slots.take(name, !connect.clean_session).await;
        self.serve(visitor, heard, (connect, identity), slot, engine).await
    }

    async fn serve(
        &self,
        mut visitor: Visitor,
        heard: BytesMut,
        (connect, identity): (Connect, Identity),
        slot: Slot,
        mut engine: Running,
    ) -> Result<(), Sent> {
        let here = Arc::clone(&engine.borrow_and_update());
        let entered = tokio::time::timeout(ENGINE_TIME, enter(&here, &slot)).await;
        if entered.is_err() {
            // An engine that was left before it had answered may let nobody in again.
            here.lets_nobody_in();
        }
        let Ok(Ok(upstream)) = entered else {
            return Err(refused(&mut visitor.stream, Welcome::Unavailable).await);
        };
        visitor.stream.write_all(&write::connack(Welcome::Accepted, slot.session.is_some())).await?;
        tracing::debug!(from = %visitor.origin.from, who = %identity.name(), client = connect.client_id, "an MQTT client has come");
        let terms = Terms {
            guest: identity.guest(),
            name: identity.name(),
            has_key: identity.has_key(),
            listener: identity.listener(&self.0.orders, visitor.origin.from),
            keep_alive_s: connect.keep_alive_s,
            will: connect.will,
            session: slot.session.clone().unwrap_or_default(),
        };
        let turnstile = Turnstile::new(terms, Arc::clone(&self.0.gatehouse), self.0.clock.now().since_start);
        let ends = Ends { client: visitor.stream, heard, engine: upstream };
        Err(Sent::Ended(pump::run(turnstile, ends, slot, engine, (&identity, &visitor.origin.access, self.0.clock)).await))
    }

    /// Who it is, or what it is told. Whoever shows a wrong password waits for his answer, the longer the more often.
    async fn admit(&self, connect: &Connect, origin: &Origin) -> Result<Identity, Welcome> {
        let is_nameless = connect.client_id.is_empty() && !connect.clean_session;
        if is_nameless || connect.client_id.len() > CLIENT_ID {
            return Err(Welcome::ClientId);
        }
        let identity = match Identity::of(connect, origin, &self.0.secret) {
            Ok(identity) => identity,
            Err(Unknown::Nothing) => return Err(Welcome::NotAllowed),
            Err(Unknown::Wrong) => {
                let delay = self.0.attempts.wrong(Network::of(origin.from), self.0.clock.now().since_start);
                tracing::warn!(from = %origin.from, delay_ms = delay.as_millis(), "a wrong name or password was shown over MQTT");
                tokio::time::sleep(delay).await;
                return Err(Welcome::Login);
            }
        };
        let is_allowed = |topic: &str| identity.guest().may_leave_will(self.0.gatehouse.topics.place(topic));
        match &connect.will {
            Some(will) if !is_allowed(&will.topic) => Err(Welcome::NotAllowed),
            Some(_) | None => Ok(identity),
        }
    }
}

/// The first packet of a client, which must be its CONNECT.
async fn introduction(stream: &mut Box<dyn Stream>, heard: &mut BytesMut) -> Result<Connect, Sent> {
    loop {
        if let Some(frame) = frame(heard, CONNECT)? {
            if frame.kind != Kind::Connect {
                return Err(Sent::First(frame.kind));
            }
            let connect = connect::read(&heard[frame.head..frame.length])?;
            heard.advance(frame.length);
            return Ok(connect);
        }
        if stream.read_buf(heard).await? == 0 {
            return Err(Sent::Ended(Ended::Gone));
        }
    }
}

/// A way to the engine, which has let us in. For a client that is to be remembered and was not, it first forgets whoever had the slot.
async fn enter(engine: &Engine, slot: &Slot) -> std::io::Result<TcpStream> {
    if slot.is_kept && slot.session.is_none() {
        let mut before = knock(engine, slot, true).await?;
        before.shutdown().await?;
        while before.read(&mut [0; 64]).await? > 0 {}
    }
    knock(engine, slot, !slot.is_kept).await
}

async fn knock(engine: &Engine, slot: &Slot, is_clean: bool) -> std::io::Result<TcpStream> {
    let mut upstream = TcpStream::connect(engine.address()).await?;
    upstream.set_nodelay(true)?;
    let mut hello = BytesMut::new();
    write::connect(&mut hello, &slot.id(), is_clean, SILENCE_S, engine.login());
    upstream.write_all(&hello).await?;
    let mut answer = [0; 4];
    let answered = upstream.read_exact(&mut answer).await;
    if answered.is_ok() && answer[0] == Kind::Connack.first_byte() && answer[3] == Welcome::Accepted as u8 {
        return Ok(upstream);
    }
    engine.lets_nobody_in();
    Err(std::io::Error::other("the engine did not let the gate in"))
}

async fn refused(stream: &mut Box<dyn Stream>, welcome: Welcome) -> Sent {
    told(stream, &write::connack(welcome, false), Sent::Refused(welcome)).await
}

/// Tells a client why it is sent away. Whether it listens is its own matter.
async fn told(stream: &mut Box<dyn Stream>, answer: &[u8], sent: Sent) -> Sent {
    let _ = stream.write_all(answer).await;
    let _ = stream.shutdown().await;
    sent
}
