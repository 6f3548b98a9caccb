//! The accept loop, on the thread that hears, and its end within two seconds. The ports are bound, and the end decided, by whoever
//! calls; what becomes of a connection stands in `hearing`.

use std::future::{Future, poll_fn};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::task::Poll;
use std::time::Duration;

use tokio::runtime::Handle;
use tokio::sync::oneshot;
use tokio::task::JoinSet;
use tokio::task::coop::unconstrained;

use super::hearing::{ServerContext, converse};
use super::tls::Tls;
use super::{Hosts, HttpDoor, router};
use crate::doors::connection_limits::{ConnectionBudget, ConnectionSlots, PendingConnections, SLOTS};
use crate::doors::listeners::Listeners;

/// How long open requests are waited for at the end: with what closing a stream takes, within two seconds.
const GRACE: Duration = Duration::from_millis(1500);

/// After an accept has failed (as with too many open files) the next is tried this much later.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// But so much later when connections were cut for it, which takes them this long to close.
const RELIEF_PAUSE: Duration = Duration::from_millis(2);

/// So many wait at once until their first head has come: that is within a moment, or whoever sends it has this many newcomers' time.
const WAITING: usize = 512;

/// So many linger at once.
const LINGERING: usize = 64;

/// So many connections are taken in before those that are here have their turn.
const NEWCOMERS: usize = 64;

/// What stands before the door.
#[derive(Clone, Default)]
pub struct Front {
    /// The names under which it is reached, beside its addresses and this machine's own names.
    pub hosts: Vec<String>,
    pub tls: Option<Tls>,
    pub budget: ConnectionBudget,
}

/// Serves until `shutdown`, then ends every stream, waits shortly for open requests, and returns whatever clients do. What comes is
/// heard where the ports are waited for, and carried out where this is called.
pub async fn serve(listeners: Listeners, door: HttpDoor, front: Front, shutdown: impl Future<Output = ()>) {
    serve_so_many(listeners, door, front, (SLOTS, WAITING), shutdown).await;
}

async fn serve_so_many(
    listeners: Listeners,
    door: HttpDoor,
    front: Front,
    (slots, waiting): (usize, usize),
    shutdown: impl Future<Output = ()>,
) {
    if !door.can_date() {
        tracing::error!(
            "the clock of this machine stands before 1970: set it, no page is served before; STOP is heard all the same"
        );
    }
    let door = door.at(listeners.port()).with_streams(front.budget);
    let hosts = Hosts::new(listeners.are_local(), &front.hosts);
    let context = Arc::new(ServerContext {
        router: router(&door, hosts.clone()),
        hosts,
        tls: front.tls,
        slots: ConnectionSlots::new(slots, front.budget, &door.access),
        pending: PendingConnections::new(front.budget.scaled(waiting)),
        lingering: PendingConnections::new(front.budget.scaled(waiting.min(LINGERING))),
        work: Handle::current(),
        closing: door.closing.subscribe(),
        door: door.clone(),
    });
    let (end, ended) = oneshot::channel();
    let thread = listeners.thread.clone();
    let mut listening = JoinSet::new();
    listening.spawn_on(listen(listeners, context, ended), &thread);
    shutdown.await;
    door.close();
    // When it is gone already, so are all connections.
    let _ = end.send(());
    while listening.join_next().await.is_some() {}
}

/// Takes connections in until the end, and then waits shortly for those that are open.
async fn listen(mut listeners: Listeners, context: Arc<ServerContext>, mut ended: oneshot::Receiver<()>) {
    let mut connections = JoinSet::new();
    let mut newcomers = 0;
    loop {
        tokio::select! {
            biased;
            _ = &mut ended => break,
            Some(_) = connections.join_next() => {}
            accepted = listeners.accept() => match accepted {
                Ok(newcomer) => {
                    begin(&mut connections, converse(newcomer, Arc::clone(&context))).await;
                    newcomers += 1;
                }
                Err(error) => {
                    let relieved = context.evict_some();
                    tracing::warn!(%error, relieved, "a connection could not be accepted");
                    tokio::time::sleep(if relieved > 0 { RELIEF_PAUSE } else { ACCEPT_PAUSE }).await;
                }
            },
        }
        if newcomers == NEWCOMERS {
            newcomers = 0;
            tokio::task::yield_now().await;
        }
    }
    drop(listeners);
    let drained = tokio::time::timeout(GRACE, async { while connections.join_next().await.is_some() {} }).await;
    if drained.is_err() {
        tracing::info!(open = connections.len(), "connections that would not end were cut");
    }
}

/// Hears what a newcomer has said already, at once and not behind those who were here before; then it goes on among them.
async fn begin(connections: &mut JoinSet<()>, conversation: impl Future<Output = ()> + Send + 'static) {
    // Boxed, since it is moved about.
    let mut conversation = Box::pin(conversation);
    let begun = poll_fn(|cx| {
        // A mistake in one connection ends that one alone.
        let begun = catch_unwind(AssertUnwindSafe(|| conversation.as_mut().poll(cx)));
        Poll::Ready(begun.is_ok_and(|begun| begun.is_pending()))
    });
    if unconstrained(begun).await {
        connections.spawn(conversation);
    }
}

#[cfg(test)]
#[path = "serve_tests.rs"]
mod tests;
