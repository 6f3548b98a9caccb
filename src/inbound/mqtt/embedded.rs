//! Our own broker, from its start to its end: clients come in by TCP and by WebSocket and are shown to the gate; the engine behind it
//! is started anew when the pulse says that it is ill. What a client may do is the gate's business.

use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::sync::{mpsc, watch};
use tokio::task::JoinSet;

use super::engine::{Engine, EngineError};
use super::guests::House;
use super::session::Health;
use super::visitor::Visitor;
use crate::access::Access;
use crate::inbound::patience::Patient;

/// After an accept has failed (as with too many open files) the next is tried this much later.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// An engine is not started anew sooner than this after the last time: an illness that does not end with it is another's.
const REST: Duration = Duration::from_secs(5);

/// The engine that messages are routed by just now.
pub(super) type Running = watch::Receiver<Arc<Engine>>;

/// How clients come to our own broker, and who says whether it is well.
pub struct Ways {
    /// By TCP,
    pub listener: TcpListener,
    /// where these are let in;
    pub access: Access,
    /// and by WebSocket.
    pub visitors: mpsc::Receiver<Visitor>,
    /// What our own session finds.
    pub health: watch::Receiver<Health>,
}

/// A broker that has started.
pub struct Embedded {
    house: House,
    engine: watch::Sender<Arc<Engine>>,
}

impl Embedded {
    /// Starts the engine for this house.
    ///
    /// # Errors
    /// When there is no engine to be had.
    pub async fn start(house: House) -> Result<Embedded, EngineError> {
        Ok(Embedded { house, engine: watch::Sender::new(Arc::new(Engine::start().await?)) })
    }

    /// Serves until `shutdown`; then every connection ends.
    pub async fn serve(self, mut ways: Ways, shutdown: impl Future<Output = ()>) {
        let mut guests = JoinSet::new();
        tokio::pin!(shutdown);
        loop {
            let ended = self.engine.borrow().ended();
            tokio::select! {
                biased;
                () = &mut shutdown => break,
                Some(_) = guests.join_next() => {}
                why = self.ill(&mut ways.health, ended) => self.renew(why).await,
                accepted = ways.listener.accept() => match accepted {
                    Ok((stream, address)) => {
                        // Small packets are held back otherwise; one that cannot be told so is served all the same.
                        let _ = stream.set_nodelay(true);
                        let access = ways.access.clone();
                        let stream = Box::new(Patient::new(stream));
                        self.receive(&mut guests, Visitor { stream, from: address.ip(), caller: None, access });
                    }
                    Err(error) => {
                        tracing::warn!(%error, relieved = self.house.relieve(), "an MQTT connection could not be accepted");
                        tokio::time::sleep(ACCEPT_PAUSE).await;
                    }
                },
                Some(visitor) = ways.visitors.recv() => self.receive(&mut guests, visitor),
            }
        }
    }

    fn receive(&self, guests: &mut JoinSet<()>, visitor: Visitor) {
        match self.house.place(visitor.from) {
            Some(place) => drop(guests.spawn(self.house.clone().entertain(visitor, place, self.engine.subscribe()))),
            None => tracing::debug!(from = %visitor.from, "an MQTT connection was refused: every place is taken"),
        }
    }

    /// Waits until the engine has to be started anew; why.
    async fn ill(&self, health: &mut watch::Receiver<Health>, ended: impl Future<Output = ()>) -> &'static str {
        tokio::select! {
            () = ended => "it has ended",
            Ok(_) = health.wait_for(|health| *health == Health::Ill) => "it does not pass messages on",
            () = self.house.worn_out() => "it was shown too many different topics",
        }
    }

    /// Starts another engine in its place. Whoever was connected has to come again; what is kept is kept by the gate.
    async fn renew(&self, why: &'static str) {
        match Engine::start().await {
            Ok(engine) => {
                tracing::warn!(why, "the MQTT broker was started anew: its clients have to connect again");
                self.house.renew();
                self.engine.send_replace(Arc::new(engine));
            }
            Err(error) => tracing::error!(%error, why, "the MQTT broker is to be started anew"),
        }
        tokio::time::sleep(REST).await;
    }
}
