//! A client's way to the router, and how bytes are moved on it.

use std::io;

use bytes::BytesMut;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::sync::OwnedSemaphorePermit;

use super::embedded::Running;
use super::router::Router;
use super::slots::Slot;
use mqtt_gate::Kind;
use mqtt_gate::packet::write::{self, Welcome};

/// How long the gate may be silent towards the router, in seconds: the most there is, and longer than the longest silence of a client.
const SILENCE_S: u16 = u16::MAX;

pub(super) struct Upstream {
    pub(super) stream: TcpStream,
    pub(super) slot: Slot,
    pub(super) router: Running,
    pub(super) way: OwnedSemaphorePermit,
}

pub(super) type ToRouter = (OwnedReadHalf, OwnedWriteHalf);

pub(super) async fn write_some(to: Option<&mut OwnedWriteHalf>, bytes: &mut BytesMut) -> io::Result<usize> {
    match to {
        Some(to) => to.write_buf(bytes).await,
        None => std::future::pending().await,
    }
}

pub(super) async fn read_some(from: Option<&mut OwnedReadHalf>, into: &mut BytesMut) -> io::Result<usize> {
    let Some(from) = from else { return std::future::pending().await };
    let read = from.read_buf(into).await;
    acknowledge_at_once(from);
    read
}

/// The router holds its next small packet back until the system has acknowledged the last one, which may be 40 ms later unless it is
/// told each time not to wait.
fn acknowledge_at_once(router: &OwnedReadHalf) {
    #[cfg(target_os = "linux")]
    if let Err(error) = router.as_ref().set_quickack(true) {
        tracing::debug!(%error, "small packets of the router will be held back");
    }
    #[cfg(not(target_os = "linux"))]
    let _ = router;
}

/// Sends the last words to the router, and waits until it has closed the connection as well: one that hears of an end later than of the
/// next client with the same number ends that one.
pub(super) async fn leave((router, to_router): &mut ToRouter, last_words: &[u8]) {
    let _ = to_router.write_all(last_words).await;
    let _ = to_router.shutdown().await;
    let mut unheard = [0; 4096];
    while let Ok(1..) = router.read(&mut unheard).await {}
}

/// A way to the router, which has let us in. For a client that is to be remembered and was not, it first forgets whoever had the slot.
pub(super) async fn enter(router: &Router, slot: &Slot) -> std::io::Result<TcpStream> {
    if slot.is_kept && slot.session.is_none() {
        let mut before = knock(router, slot, true).await?;
        before.shutdown().await?;
        while before.read(&mut [0; 64]).await? > 0 {}
    }
    knock(router, slot, !slot.is_kept).await
}

async fn knock(router: &Router, slot: &Slot, is_clean: bool) -> std::io::Result<TcpStream> {
    let mut upstream = TcpStream::connect(router.address).await?;
    upstream.set_nodelay(true)?;
    let mut hello = BytesMut::new();
    write::connect(&mut hello, &slot.id(), is_clean, SILENCE_S, router.login());
    upstream.write_all(&hello).await?;
    let mut answer = [0; 4];
    let answered = upstream.read_exact(&mut answer).await;
    if answered.is_ok() && answer[0] == Kind::Connack.first_byte() && answer[3] == Welcome::Accepted as u8 {
        return Ok(upstream);
    }
    router.lets_nobody_in();
    Err(std::io::Error::other("the router did not let the gate in"))
}
