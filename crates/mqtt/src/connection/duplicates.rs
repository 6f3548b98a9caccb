//! Remembers which messages of a client were handled before. A command counts as a duplicate only if its sender marks
//! it as one, and its id, topic and payload are the same. So no urgent command is lost here.

use std::collections::{BTreeMap, VecDeque};

use super::Ended;
use crate::limits::{HANDLED, UNRELEASED};
use crate::packet::Qos;
use crate::packet::publish::Publish;

/// The fingerprint stored for a message that is no command.
const NO_COMMAND: u64 = 0;

#[derive(Debug, Default)]
pub(super) struct Duplicates {
    /// Ids of the messages of QoS 2 that the client has not released, each with the fingerprint of its command or
    /// `NO_COMMAND`.
    unreleased: BTreeMap<u16, u64>,
    /// Ids and fingerprints of the latest commands of QoS 1.
    commands: VecDeque<(u16, u64)>,
}

impl Duplicates {
    pub(super) const fn resumed(unreleased: BTreeMap<u16, u64>) -> Duplicates {
        Duplicates { unreleased, commands: VecDeque::new() }
    }

    pub(super) fn into_unreleased(self) -> BTreeMap<u16, u64> {
        self.unreleased
    }

    /// Whether this message of QoS 2 repeats a message that the client has not released yet (section 4.3.3).
    pub(super) fn is_unreleased(&self, publish: &Publish<'_>) -> bool {
        publish.qos == Qos::Two && self.unreleased.contains_key(&publish.id)
    }

    /// Whether this command was handled before: its sender marks it as a duplicate, and its id and fingerprint are
    /// known.
    pub(super) fn was_heard(&self, publish: &Publish<'_>, print: u64) -> bool {
        publish.is_duplicate
            && (self.commands.contains(&(publish.id, print))
                || publish.qos == Qos::Two && self.unreleased.get(&publish.id) == Some(&print))
    }

    /// Notes that a message was handled, so that its repetition is recognised. `print` is the fingerprint if it is a
    /// command.
    pub(super) fn handled(&mut self, publish: &Publish<'_>, print: Option<u64>) -> Result<(), Ended> {
        match (publish.qos, print) {
            (Qos::One, Some(print)) => {
                self.commands.retain(|(id, _)| *id != publish.id);
                self.commands.push_back((publish.id, print));
                if self.commands.len() > HANDLED {
                    self.commands.pop_front();
                }
            }
            (Qos::Two, print) => {
                if self.unreleased.len() >= UNRELEASED && !self.unreleased.contains_key(&publish.id) {
                    return Err(Ended::Unreleased);
                }
                self.unreleased.insert(publish.id, print.unwrap_or(NO_COMMAND));
            }
            (Qos::Zero, _) | (Qos::One, None) => {}
        }
        Ok(())
    }

    /// Handles a PUBREL: the client will not send this message of QoS 2 again. Returns whether its id was known.
    pub(super) fn released(&mut self, id: u16) -> bool {
        self.unreleased.remove(&id).is_some()
    }
}
