//! The accept loop on the hearing thread. It ends within two seconds after the signal to end. The caller opens the
//! ports and decides when to end. `hearing` serves the connections.

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
use super::{Halls, Hosts, router};
use crate::doors::connection_limits::{ConnectionBudget, ConnectionSlots, PendingConnections, SLOTS};
use crate::doors::listeners::Listeners;

/// Maximum wait for open requests when the program ends. Together with closing the streams, ending takes less than
/// two seconds.
const GRACE: Duration = Duration::from_millis(1500);

/// Pause after a failed accept, for example when too many files are open.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// Pause after a failed accept if connections were evicted. Closing these connections takes this long.
const RELIEF_PAUSE: Duration = Duration::from_millis(2);

/// Maximum number of connections whose first head is not complete yet. For each further connection, one of these is
/// evicted. Sending a head takes only a moment.
const WAITING: usize = 512;

/// Maximum number of connections that are still read after their last answer.
const LINGERING: usize = 64;

/// Number of new connections accepted before other tasks get a turn.
const NEWCOMERS: usize = 64;

#[derive(Clone, Default)]
pub struct Front {
    /// Host names of the door. IP addresses and this machine's own names are accepted in addition.
    pub hosts: Vec<String>,
    pub tls: Option<Tls>,
    pub budget: ConnectionBudget,
}

/// Serves until `shutdown`. Then ends all streams, waits briefly for open requests, and returns even if clients are
/// still connected. Requests are read on the runtime of the ports, and carried out on the caller's runtime.
pub async fn serve(listeners: Listeners, halls: Halls, front: Front, shutdown: impl Future<Output = ()>) {
    serve_so_many(listeners, halls, front, SLOTS, WAITING, shutdown).await;
}

async fn serve_so_many(
    listeners: Listeners,
    halls: Halls,
    front: Front,
    slots: usize,
    waiting: usize,
    shutdown: impl Future<Output = ()>,
) {
    if !halls.process.can_date() {
        tracing::error!(
            "the clock of this machine shows a year before 1970: until it is set, hallsweep accepts STOP but serves no page"
        );
    }
    let halls = halls.at(listeners.port(), front.budget);
    let hosts = Hosts::new(listeners.are_local(), &front.hosts);
    let context = Arc::new(ServerContext {
        router: router(&halls, hosts.clone()),
        hosts,
        tls: front.tls,
        slots: ConnectionSlots::new(slots, front.budget, &halls.process.access),
        pending: PendingConnections::new(front.budget.scaled(waiting)),
        lingering: PendingConnections::new(front.budget.scaled(waiting.min(LINGERING))),
        work: Handle::current(),
        closing: halls.process.closing.subscribe(),
        halls: halls.clone(),
    });
    let (end, ended) = oneshot::channel();
    let thread = listeners.thread.clone();
    let mut listening = JoinSet::new();
    listening.spawn_on(listen(listeners, context, ended), &thread);
    shutdown.await;
    halls.close();
    // If the receiver is gone, the accept loop and all connections have ended already.
    let _ = end.send(());
    while listening.join_next().await.is_some() {}
}

/// Accepts connections until `ended`. Then waits briefly for open connections.
async fn listen(mut listeners: Listeners, context: Arc<ServerContext>, mut ended: oneshot::Receiver<()>) {
    let mut connections = JoinSet::new();
    let mut newcomers = 0;
    loop {
        tokio::select! {
            biased;
            _ = &mut ended => break,
            Some(_) = connections.join_next() => {}
            accepted = listeners.accept() => match accepted {
                Ok((stream, address)) => {
                    begin(&mut connections, converse(stream, address, Arc::clone(&context))).await;
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
        tracing::info!(open = connections.len(), "connections still open at the end were closed");
    }
}

/// Reads at once what a new connection has already sent, before older connections get a turn. Then starts a task for
/// the connection.
async fn begin(connections: &mut JoinSet<()>, conversation: impl Future<Output = ()> + Send + 'static) {
    // Boxed, because it is moved to a separate task later.
    let mut conversation = Box::pin(conversation);
    let begun = poll_fn(|cx| {
        // A panic in one connection ends only that connection.
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
