//! The topics of all halls: to which hall a topic belongs, and who may publish on it.
//!
//! ```text
//!   PREFIX/ID/…, OLD/NAME                     the default hall
//!   PREFIX/halls/NAME/…                       the hall NAME; if there is no such hall, nobody publishes there
//!   homeassistant/device/ID or NAME/config    the hall that describes itself there
//!   all others                                no hall: open to all
//! ```

use std::collections::BTreeSet;
use std::sync::{Arc, PoisonError, RwLock};

use super::rights;
use super::topics::{self, TopicKind, Topics, discovered, kind_below, under};
use hallsweep_core::hall::HallId;
use mqtt_gate::filter::overlap;
use mqtt_gate::{Rights, Tier};

/// The topics of all halls of the program. Cheap to clone; all clones know the same halls.
#[derive(Clone, Debug)]
pub struct TopicMap {
    default: HallId,
    topics: Topics,
    /// The topic above those of further halls: `PREFIX/halls`.
    above: Arc<str>,
    further: Arc<RwLock<BTreeSet<HallId>>>,
}

impl TopicMap {
    /// Begins with the default hall and its topics.
    pub fn new(default: HallId, topics: Topics) -> TopicMap {
        let above = Arc::from(topics.above_further());
        TopicMap { default, topics, above, further: Arc::default() }
    }

    /// Adds a further hall, and returns its topics. At our own broker, call `Broker::rights_changed` afterwards.
    pub fn add(&self, hall: &HallId) -> Topics {
        self.further.write().unwrap_or_else(PoisonError::into_inner).insert(hall.clone());
        Topics::of_further(&self.above, hall)
    }

    pub fn default_hall(&self) -> &HallId {
        &self.default
    }

    /// Returns the hall to which a topic belongs; `None` if it belongs to no hall. Whether there is a hall of this
    /// name does not matter: a name that is unknown must not be told from one that the client may not see.
    pub fn hall_of(&self, topic: &str) -> Option<HallId> {
        if let Some(below) = under(&self.above, topic) {
            return HallId::new(below.split('/').next().unwrap_or_default());
        }
        if let Some(id) = discovered(topic).filter(|id| *id != self.topics.id()) {
            return HallId::new(id);
        }
        (self.topics.kind_of(topic) != TopicKind::Elsewhere).then(|| self.default.clone())
    }

    pub fn kind_of<'a>(&self, topic: &'a str) -> TopicKind<'a> {
        if let Some(below) = under(&self.above, topic) {
            let known = below.split_once('/').filter(|(name, _)| self.has(name));
            return known.map_or(TopicKind::Ours, |(_, rest)| kind_below(rest));
        }
        let is_ours = topic == &*self.above || discovered(topic).is_some_and(|id| self.has(id));
        if is_ours { TopicKind::Ours } else { self.topics.kind_of(topic) }
    }

    fn has(&self, name: &str) -> bool {
        let hall = HallId::new(name);
        hall.is_some_and(|hall| self.further.read().unwrap_or_else(PoisonError::into_inner).contains(&hall))
    }
}

impl Rights for TopicMap {
    fn is_for_commands(&self, topic: &str) -> bool {
        rights::is_for_commands(self.kind_of(topic))
    }

    fn may_publish(&self, who: Tier, topic: &str) -> bool {
        rights::may_publish(who, self.kind_of(topic))
    }

    fn may_leave_will(&self, who: Tier, topic: &str) -> bool {
        rights::may_leave_will(who, self.kind_of(topic))
    }

    /// Descriptions for Home Assistant are never shared, whosever they are. The answer does not tell which of them
    /// belong to halls.
    fn may_share(&self, who: Tier, filter: &str) -> bool {
        let of_halls = [format!("{}/#", self.above), topics::discovery_of("+")];
        self.topics.may_share(who, filter) && !of_halls.iter().any(|ours| overlap(filter, ours))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::Role;
    use crate::doors::mqtt::session::testing::{hall, map};

    #[test]
    fn a_topic_belongs_to_the_hall_that_it_names() {
        let map = map(&["south"]);
        for (topic, owner, kind) in [
            ("hallsweep/discovery/command/start", Some("main"), TopicKind::Command("start")),
            ("hallsweep/discovery/state/robot", Some("main"), TopicKind::Ours),
            ("unibo/qak/events", Some("main"), TopicKind::Old),
            ("homeassistant/device/discovery/config", Some("main"), TopicKind::Ours),
            ("hallsweep/halls/south/command/start", Some("south"), TopicKind::Command("start")),
            ("hallsweep/halls/south/command", Some("south"), TopicKind::Word),
            ("hallsweep/halls/south/command/start/result", Some("south"), TopicKind::Ours),
            ("hallsweep/halls/south/state/robot", Some("south"), TopicKind::Ours),
            ("hallsweep/halls/south", Some("south"), TopicKind::Ours),
            ("homeassistant/device/south/config", Some("south"), TopicKind::Ours),
            ("hallsweep/halls/north/command/start", Some("north"), TopicKind::Ours),
            ("homeassistant/device/north/config", Some("north"), TopicKind::Elsewhere),
            ("hallsweep/halls/South/command/start", None, TopicKind::Ours),
            ("hallsweep/halls", None, TopicKind::Ours),
            ("hallsweep/halls2/south/command/start", None, TopicKind::Elsewhere),
            ("homeassistant/device/Lamp_7/config", None, TopicKind::Elsewhere),
            ("homeassistant/status", None, TopicKind::Elsewhere),
            ("south/command/start", None, TopicKind::Elsewhere),
            ("sensors/door", None, TopicKind::Elsewhere),
        ] {
            assert_eq!(map.hall_of(topic), owner.map(hall), "{topic}");
            assert_eq!(map.kind_of(topic), kind, "{topic}");
        }
    }

    #[test]
    fn the_words_behind_a_further_hall_are_those_of_the_default_hall() {
        let map = map(&[]);
        let (north, further) = (hall("north"), map.clone());
        let topics = further.add(&north);
        assert_eq!(topics.state(hallsweep_core::world::resource::Resource::Robot), "hallsweep/halls/north/state/robot");
        assert_eq!((topics.id(), topics.discovery()), ("north", "homeassistant/device/north/config".to_owned()));
        assert_eq!(map.kind_of(&topics.command("goto")), TopicKind::Command("goto"), "all clones know it");
        for topic in [topics.event(), topics.availability(), topics.result("goto"), topics.photo(), topics.discovery()] {
            assert_eq!((map.kind_of(&topic), map.hall_of(&topic)), (TopicKind::Ours, Some(north.clone())), "{topic}");
        }
        assert_eq!(topics.commands(), ["hallsweep/halls/north/command", "hallsweep/halls/north/command/+"]);
        assert_eq!(topics.kind_of("/events"), TopicKind::Elsewhere, "the old topics belong to the default hall");
    }

    /// Nobody but the program publishes below `PREFIX/halls`, apart from commands.
    #[test]
    fn rights_hold_for_the_topics_of_all_halls() {
        let map = map(&["south"]);
        let [operator, viewer] = [Role::Operator, Role::Viewer].map(rights::tier);
        for (topic, is_command, is_open) in [
            ("hallsweep/halls/south/command/stop", true, false),
            ("hallsweep/discovery/command/stop", true, false),
            ("hallsweep/halls/south/state/robot", false, false),
            ("hallsweep/halls/north/command/stop", false, false),
            ("hallsweep/halls/north/anything", false, false),
            ("homeassistant/device/south/config", false, false),
            ("sensors/door", false, true),
        ] {
            assert_eq!(map.is_for_commands(topic), is_command, "{topic}");
            assert_eq!(map.may_publish(operator, topic), is_command || is_open, "{topic}");
            assert_eq!(map.may_publish(viewer, topic), is_command, "{topic}");
            assert_eq!((map.may_leave_will(operator, topic), map.may_leave_will(viewer, topic)), (is_open, false), "{topic}");
        }
        let shares = ["#", "hallsweep/halls/#", "hallsweep/+/south/event", "homeassistant/device/south/config", "unibo/qak/+"];
        let unknown = ["hallsweep/halls/north/event", "homeassistant/device/north/config"];
        assert!(!shares.iter().chain(&unknown).any(|filter| map.may_share(operator, filter)));
        assert!(map.may_share(operator, "sensors/#") && !map.may_share(viewer, "sensors/#"));
    }
}
