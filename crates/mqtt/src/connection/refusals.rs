//! What a client was refused, for the log: the first, and then ever fewer of them, since a client may go on for ever.

use std::fmt::Display;
use std::sync::Arc;

/// How many characters of a client's text stand in the log.
const SHOWN: usize = 80;

#[derive(Debug)]
pub(super) struct Refusals {
    name: Arc<str>,
    count: u64,
}

impl Refusals {
    pub(super) const fn new(name: Arc<str>) -> Refusals {
        Refusals { name, count: 0 }
    }

    pub(super) fn note(&mut self, topic: &[u8], why: impl Display) {
        self.count += 1;
        if self.count.is_power_of_two() {
            let topic: String = String::from_utf8_lossy(topic).chars().take(SHOWN).collect();
            tracing::warn!(client = %self.name, topic, refused = self.count, "refused over MQTT, this being the latest: {why}");
        }
    }
}
