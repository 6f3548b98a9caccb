//! From a visitor to a guest: a client says who it is, is let in or told why not, gets its slot and its way to the engine, and is
//! then served by the pump. What it may do as a guest is the gate's business.

use std::net::IpAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use bytes::{Buf, BytesMut};
use subtle::ConstantTimeEq;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

use super::embedded::Running;
use super::engine::Engine;
use super::gate::frame::{self, Kind, Malformed};
use super::gate::limits::CONNECT;
use super::gate::packet::connect::{self, Connect, NoConnect};
use super::gate::packet::write;
use super::gate::turnstile::{Shared, Terms, Turnstile};
use super::limits;
use super::orders::Sender;
use super::pump;
use super::slots::{Name, Slot, Slots};
use super::visitor::{Stream, Visitor};
use crate::access::{Attempts, Caller, Network, Token};
use crate::inbound::places::{Place, Places};
use crate::runtime::clock::Clock;

/// The name by which our own session enters. No key can have it.
pub const HOUSE: &str = "$hallsweep";

/// So long a client may take to say who it is.
const CONNECT_TIME: Duration = Duration::from_millis(limits::CONNECT_TIME_MS as u64);

/// So long the engine may take to answer; it takes less than a millisecond.
const ENGINE_TIME: Duration = Duration::from_secs(5);

/// The return codes of CONNACK (MQTT 3.1.1, table 3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Code {
    Accepted = 0,
    IdentifierRejected = 2,
    ServerUnavailable = 3,
    BadNameOrPassword = 4,
    NotAuthorized = 5,
}

/// Why a visitor did not become a guest, or is one no more.
#[derive(Debug, thiserror::Error)]
pub(super) enum Sent {
    #[error("it did not say in time who it is")]
    Slow,
    #[error("its first packet is no CONNECT")]
    NoConnect,
    #[error(transparent)]
    Unfit(#[from] NoConnect),
    #[error(transparent)]
    Malformed(#[from] Malformed),
    #[error("refused with CONNACK {0}")]
    Refused(u8),
    #[error("its connection broke: {0}")]
    Broken(#[from] std::io::Error),
}

/// What all connections to our own broker have in common. Cheap to clone.
#[derive(Clone)]
pub struct House(Arc<Rooms>);

struct Rooms {
    shared: Arc<Shared>,
    /// The password of our own session.
    secret: Token,
    places: Places,
    slots: Slots,
    attempts: Attempts,
    clock: Clock,
    guests: AtomicUsize,
}

/// A guest's seat at the table: there are only so many.
struct Seat(Arc<Rooms>);

impl House {
    /// A house without guests; our own session comes with `secret`.
    #[must_use]
    pub fn new(shared: Shared, secret: Token) -> House {
        House(Arc::new(Rooms {
            shared: Arc::new(shared),
            secret,
            places: Places::new(limits::PLACES),
            slots: Slots::default(),
            attempts: Attempts::default(),
            clock: Clock::default(),
            guests: AtomicUsize::new(0),
        }))
    }

    /// A place for a connection from there.
    pub(super) fn place(&self, from: IpAddr) -> Option<Arc<Place>> {
        self.0.places.take(from).map(Arc::new)
    }

    /// Cuts some connections of strangers, when the system has no more descriptors.
    pub(super) fn relieve(&self) -> usize {
        self.0.places.relieve()
    }

    /// Serves a visitor to the end, or until its place is needed.
    pub(super) async fn entertain(self, visitor: Visitor, place: Arc<Place>, engine: Running) {
        let from = visitor.from;
        let ended = tokio::select! {
            () = place.cut() => Ok("its place was needed".to_owned()),
            ended = self.converse(visitor, &place, engine) => ended,
        };
        match ended {
            Ok(why) => tracing::debug!(%from, why, "an MQTT connection has ended"),
            Err(sent) => tracing::debug!(%from, why = %sent, "an MQTT client was sent away"),
        }
    }

    async fn converse(&self, mut visitor: Visitor, place: &Arc<Place>, engine: Running) -> Result<String, Sent> {
        let asked = place.begin();
        let mut heard = BytesMut::new();
        let connect = tokio::time::timeout(CONNECT_TIME, introduce(&mut *visitor.stream, &mut heard)).await;
        let connect = connect.map_err(|_| Sent::Slow)??;
        let sender = match self.identify(&connect, &visitor) {
            Ok(sender) => sender,
            Err(code) => return self.refuse(&mut visitor, code).await,
        };
        place.known();
        let Some(seat) = self.seat(&sender) else { return self.refuse(&mut visitor, Code::ServerUnavailable).await };
        let name = Name { who: sender.name(), client: connect.client_id.clone() };
        let slot = self.0.slots.take(name, !connect.clean_session).await;
        let at_engine = tokio::time::timeout(ENGINE_TIME, enter(&engine, &slot)).await;
        let Ok(Ok((upstream, is_known))) = at_engine else { return self.refuse(&mut visitor, Code::ServerUnavailable).await };
        let welcome = write::connack(is_known, Code::Accepted as u8);
        visitor.stream.write_all(&welcome).await?;
        let turnstile = Turnstile::new(sender, Terms::of(connect), Arc::clone(&self.0.shared));
        let ended = pump::run(turnstile, (visitor.stream, heard), upstream, slot, engine).await;
        drop((seat, asked));
        Ok(ended.to_string())
    }
}
