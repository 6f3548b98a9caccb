//! Opens the CoAP door at each of its ports, and serves all of them on one thread. The resources are in
//! `doors::coap`.

use std::net::UdpSocket;
use std::sync::Arc;

use tokio::sync::watch;
use tokio::task::JoinHandle;

use super::AppError;
use crate::doors::coap::{self, Resources, Socket};
use crate::runtime::threads::Thread;
use hallsweep_core::snapshot::Snapshot;

/// Opens the door at each port. Each port closes when `ending` says so. There is one returned task for each port,
/// which ends when the port is closed. A panic in this door does not close the other doors.
pub(super) fn open(
    ports: Vec<UdpSocket>,
    thread: &Thread,
    resources: impl Fn() -> Resources,
    secret: [u8; 32],
    states: watch::Receiver<Arc<Snapshot>>,
    ending: watch::Receiver<bool>,
) -> Result<Vec<JoinHandle<()>>, AppError> {
    let open = |port| {
        let socket = {
            let _on_it = thread.handle().enter();
            Socket::new(port).map_err(AppError::System)?
        };
        let mut ending = ending.clone();
        let shutdown = async move { drop(ending.wait_for(|ending| *ending).await) };
        let door = coap::serve(socket, secret, resources(), states.clone(), shutdown);
        let door = thread.handle().spawn(door);
        Ok(tokio::spawn(async {
            if door.await.is_err() {
                tracing::error!("the CoAP door stopped after an internal error: start hallsweep again to use CoAP");
            }
        }))
    };
    ports.into_iter().map(open).collect()
}
