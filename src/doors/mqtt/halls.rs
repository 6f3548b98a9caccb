//! The commands of all halls at our own broker. A message is a command for the hall that its topic names, from a sender
//! who may see that hall. For anybody else that hall does not exist.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

use super::commands::{Commands, tidied};
use super::topic_map::TopicMap;
use crate::runtime::figures::Figures;
use hallsweep_core::hall::HallId;
use hallsweep_core::units;
use mqtt_gate::Epoch;

/// Number of changes of epochs that are remembered. A command that arrived before that is refused as outdated if a STOP
/// has ever come.
const REMEMBERED: usize = 256;

/// The commands of each hall. Cheap to clone. Halls may be added while clients are connected.
#[derive(Clone, Debug)]
pub struct Halls(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    topics: TopicMap,
    /// Locked only to look something up or to add a hall, so that a STOP never waits (safety S1).
    commands: RwLock<BTreeMap<HallId, Arc<Commands>>>,
    figures: Figures,
    /// The epochs of all halls after each of the latest changes.
    epochs: Mutex<VecDeque<Epochs>>,
}

#[derive(Debug)]
struct Epochs {
    sum: u64,
    of: Vec<(HallId, u64)>,
}

impl Halls {
    /// Begins with the commands of the default hall.
    pub fn new(topics: TopicMap, default: Commands) -> Halls {
        let figures = default.figures().clone();
        let hall = topics.default_hall().clone();
        let halls = Halls(Arc::new(Inner { topics, commands: RwLock::default(), figures, epochs: Mutex::default() }));
        halls.add(&hall, default);
        halls
    }

    /// Adds the commands of a hall whose topics are in the `TopicMap`.
    pub fn add(&self, hall: &HallId, commands: Commands) {
        let commands = Arc::new(commands.among(self.0.topics.clone()));
        self.0.commands.write().unwrap_or_else(PoisonError::into_inner).insert(hall.clone(), commands);
    }

    pub(super) fn topics(&self) -> &TopicMap {
        &self.0.topics
    }

    pub(super) fn figures(&self) -> &Figures {
        &self.0.figures
    }

    /// Returns the hall to which a topic belongs, and its commands. If the topic is faulty, it counts as the topic
    /// without its faults, as in `Commands::halts`.
    pub(super) fn on(&self, topic: &str) -> Option<(HallId, Arc<Commands>)> {
        let hall = self.0.topics.hall_of(topic).or_else(|| self.0.topics.hall_of(&tidied(topic)?))?;
        let commands = self.0.commands.read().unwrap_or_else(PoisonError::into_inner).get(&hall).map(Arc::clone)?;
        Some((hall, commands))
    }

    /// The epoch of all halls together: the sum of their epochs. Epochs only grow, so the sum names the epoch of each
    /// hall, which is remembered for [`Halls::arrived`].
    pub(super) fn epoch(&self) -> Epoch {
        let mut remembered = self.0.epochs.lock().unwrap_or_else(PoisonError::into_inner);
        let commands = self.0.commands.read().unwrap_or_else(PoisonError::into_inner);
        let sum = commands.values().map(|commands| commands.epoch().0).sum();
        if remembered.back().is_some_and(|latest| latest.sum == sum) {
            return Epoch(sum);
        }
        // Another STOP may have come since, so the sum is that of the epochs that are remembered.
        let of: Vec<_> = commands.iter().map(|(hall, commands)| (hall.clone(), commands.epoch().0)).collect();
        let sum = of.iter().map(|(_, epoch)| epoch).sum();
        remembered.push_back(Epochs { sum, of });
        if remembered.len() > REMEMBERED {
            remembered.pop_front();
        }
        Epoch(sum)
    }

    /// The epoch of a hall at the time at which `epoch` returned this value.
    pub(super) fn arrived(&self, hall: &HallId, Epoch(sum): Epoch) -> units::Epoch {
        let remembered = self.0.epochs.lock().unwrap_or_else(PoisonError::into_inner);
        let then = remembered.iter().rev().find(|epochs| epochs.sum == sum);
        let epoch = then.and_then(|epochs| epochs.of.iter().find(|(known, _)| known == hall));
        units::Epoch(epoch.map_or(0, |(_, epoch)| *epoch))
    }
}

/// A program with one hall.
impl From<Commands> for Halls {
    fn from(commands: Commands) -> Halls {
        Halls::new(TopicMap::new(HallId::main(), commands.topics().clone()), commands)
    }
}

#[cfg(test)]
#[path = "halls_tests.rs"]
mod tests;
