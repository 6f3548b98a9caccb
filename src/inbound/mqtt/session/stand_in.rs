//! Until News and Orders are merged.
#![allow(missing_docs, clippy::all)]
use super::super::publication::Publication;
use crate::core::units::Now;
use crate::core::world::snapshot::Snapshot;
use std::sync::Arc;
use std::time::Duration;
pub struct News;
impl News {
    pub fn handle_state(&mut self, _: &Arc<Snapshot>, _: Now) {}
    pub fn poll_publication(&mut self, _: Now) -> Option<Publication> {
        None
    }
    pub fn poll_timeout(&self) -> Option<Duration> {
        None
    }
    pub fn renew(&mut self, _: Vec<Publication>) {}
}
pub struct Orders;
pub struct Heard<'a> {
    pub topic: &'a str,
    pub payload: &'a [u8],
}
pub enum Sender {
    Unknown { broker: Arc<str> },
}
impl Orders {
    pub fn take(&self, _: &Heard<'_>, _: &Sender) {}
}
