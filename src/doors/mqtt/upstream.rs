//! A client's way to the engine, and how bytes are moved on it.

use std::io;

use bytes::BytesMut;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::sync::OwnedSemaphorePermit;

use super::embedded::Running;
use super::engine::Engine;
use super::slots::Slot;
use mqtt_gate::frame::Kind;
use mqtt_gate::packet::write::{self, Welcome};

/// How long the gate may be silent towards the engine, in seconds: the most there is, and longer than the longest silence of a client.
const SILENCE_S: u16 = u16::MAX;

/// A way to the engine.
pub(super) struct Upstream {
    pub(super) stream: TcpStream,
    /// By what it knows the client.
    pub(super) slot: Slot,
    /// Which it is.
    pub(super) engine: Running,
    pub(super) way: OwnedSemaphorePermit,
}

/// The way to the engine, and back.
pub(super) type ToEngine = (OwnedReadHalf, OwnedWriteHalf);

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

/// The engine holds its next small packet back until the system has acknowledged the last one, which may be 40 ms later unless it is
/// told each time not to wait.
fn acknowledge_at_once(engine: &OwnedReadHalf) {
    #[cfg(target_os = "linux")]
    if let Err(error) = engine.as_ref().set_quickack(true) {
        tracing::debug!(%error, "small packets of the engine will be held back");
    }
    #[cfg(not(target_os = "linux"))]
    let _ = engine;
}

/// Sends the last words to the engine, and waits until it has closed the connection as well: one that hears of an end later than of the
/// next client with the same number ends that one.
pub(super) async fn leave((engine, to_engine): &mut ToEngine, last_words: &[u8]) {
    let _ = to_engine.write_all(last_words).await;
    let _ = to_engine.shutdown().await;
    let mut unheard = [0; 4096];
    while let Ok(1..) = engine.read(&mut unheard).await {}
}

/// A way to the engine, which has let us in. For a client that is to be remembered and was not, it first forgets whoever had the slot.
pub(super) async fn enter(engine: &Engine, slot: &Slot) -> std::io::Result<TcpStream> {
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
