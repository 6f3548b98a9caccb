//! State shared by all connections.

use axum::Router;
use tokio::runtime::Handle;
use tokio::sync::watch;

use crate::doors::connection_limits::{ConnectionSlots, PendingConnections};
use crate::doors::http::guard::Hosts;
use crate::doors::http::halls::Halls;
use crate::doors::http::tls::Tls;

pub(in crate::doors::http) struct ServerContext {
    pub(in crate::doors::http) halls: Halls,
    pub(in crate::doors::http) hosts: Hosts,
    pub(in crate::doors::http) router: Router,
    pub(in crate::doors::http) tls: Option<Tls>,
    pub(in crate::doors::http) slots: ConnectionSlots,
    pub(in crate::doors::http) pending: PendingConnections,
    /// Connections that get no more answers, but are still read.
    pub(in crate::doors::http) lingering: PendingConnections,
    /// The runtime on which hyper and the routes run.
    pub(in crate::doors::http) work: Handle,
    pub(in crate::doors::http) closing: watch::Receiver<bool>,
}

impl ServerContext {
    /// Evicts some connections when the system has no more file descriptors. Returns their number. Connections that
    /// get no more answers are evicted first. Connections that may be about to send STOP are evicted last.
    pub(in crate::doors::http) fn evict_some(&self) -> usize {
        let mut relieved = self.lingering.evict_some();
        if relieved == 0 {
            relieved = self.slots.evict_some();
        }
        if relieved == 0 {
            relieved = self.pending.evict_some();
        }
        relieved
    }
}
