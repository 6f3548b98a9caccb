//! The names of the topics of one hall, and what each is for. The messages are made elsewhere. `topic_map` has the
//! topics of all halls.

use crate::api::resources::ResourceKind;
use hallsweep_core::hall::HallId;
use hallsweep_core::world::resource::Resource;

const COMMAND: &str = "command";

const RESULT: &str = "result";

const EVENTS: &str = "events";

/// The level of the topics of further halls, in place of an id.
const FURTHER: &str = "halls";

pub const HOME_ASSISTANT_STATUS: &str = "homeassistant/status";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topics {
    /// The beginning of our own topics, such as `hallsweep/discovery`.
    base: String,
    /// The beginning of the original system's topics, such as `unibo/qak`. Only the default hall has these topics.
    old: Option<String>,
    /// The id of the robot, such as `discovery`.
    id: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TopicKind<'a> {
    /// `…/command/NAME`: a command with this name. The payload is JSON.
    Command(&'a str),
    /// `…/command`: the payload is the bare name of a command without arguments.
    Word,
    Old,
    /// Topics on which only the program itself publishes: everything else under our prefix, and the description for
    /// Home Assistant.
    Ours,
    Elsewhere,
}

impl Topics {
    /// Creates the names of the topics under `PREFIX/ID`, and of the original system's topics under `old`.
    pub fn new(prefix: &str, id: &str, old: &str) -> Topics {
        Topics { base: format!("{prefix}/{id}"), old: Some(old.to_owned()), id: id.to_owned() }
    }

    /// Creates the names of the topics of a further hall, under `PREFIX/halls/NAME`.
    pub(super) fn of_further(above: &str, hall: &HallId) -> Topics {
        Topics { base: format!("{above}/{hall}"), old: None, id: hall.name().to_owned() }
    }

    /// Returns the topic below which all further halls have their topics: `PREFIX/halls`. Only for the default hall.
    pub(super) fn above_further(&self) -> String {
        format!("{}{FURTHER}", &self.base[..self.base.len() - self.id.len()])
    }

    pub fn id(&self) -> &str {
        &self.id
    }

    pub fn state(&self, resource: Resource) -> String {
        format!("{}/state/{}", self.base, ResourceKind::Of(resource).row().name)
    }

    pub fn event(&self) -> String {
        format!("{}/event", self.base)
    }

    pub fn availability(&self) -> String {
        format!("{}/availability", self.base)
    }

    pub fn word(&self) -> String {
        format!("{}/{COMMAND}", self.base)
    }

    pub fn command(&self, name: &str) -> String {
        format!("{}/{COMMAND}/{name}", self.base)
    }

    pub fn result(&self, name: &str) -> String {
        format!("{}/{COMMAND}/{name}/{RESULT}", self.base)
    }

    pub fn home_assistant(&self) -> String {
        format!("{}/homeassistant", self.base)
    }

    /// The topic of the last photo, for Home Assistant.
    pub fn photo(&self) -> String {
        format!("{}/photo", self.base)
    }

    pub fn discovery(&self) -> String {
        discovery_of(&self.id)
    }

    /// Whether the hall has the topics of the original system.
    pub fn has_old(&self) -> bool {
        self.old.is_some()
    }

    /// The topic of the original system's events. Nothing is published there for a hall without old topics.
    pub fn old_events(&self) -> String {
        format!("{}/{EVENTS}", self.old.as_deref().unwrap_or_default())
    }

    /// Returns filters for the subscription at another broker. They match all commands, but no results.
    pub fn commands(&self) -> Vec<String> {
        [self.word(), self.command("+")].into_iter().chain(self.old_filter()).collect()
    }

    /// Returns filters that match all topics on which only the program itself publishes. They match all command
    /// topics too.
    pub fn ours(&self) -> Vec<String> {
        [format!("{}/#", self.base), self.discovery()].into_iter().chain(self.old_filter()).collect()
    }

    fn old_filter(&self) -> Option<String> {
        self.old.as_ref().map(|old| format!("{old}/+"))
    }

    pub fn kind_of<'a>(&self, topic: &'a str) -> TopicKind<'a> {
        if let Some(name) = self.old.as_deref().and_then(|old| under(old, topic)) {
            return if name.contains('/') { TopicKind::Elsewhere } else { TopicKind::Old };
        }
        match under(&self.base, topic) {
            Some(rest) => kind_below(rest),
            None if topic == self.base || discovered(topic) == Some(self.id.as_str()) => TopicKind::Ours,
            None => TopicKind::Elsewhere,
        }
    }
}

/// What a topic is for, by its levels below the base of its hall.
pub(super) fn kind_below(rest: &str) -> TopicKind<'_> {
    match rest.split_once('/') {
        None if rest == COMMAND => TopicKind::Word,
        Some((COMMAND, name)) if !name.contains('/') => TopicKind::Command(name),
        None | Some(_) => TopicKind::Ours,
    }
}

/// The topic on which a device describes itself to Home Assistant.
pub(super) fn discovery_of(id: &str) -> String {
    format!("homeassistant/device/{id}/config")
}

/// Returns the id of the device that describes itself to Home Assistant on this topic.
pub(super) fn discovered(topic: &str) -> Option<&str> {
    topic.strip_prefix("homeassistant/device/")?.strip_suffix("/config")
}

pub(super) fn under<'a>(above: &str, topic: &'a str) -> Option<&'a str> {
    topic.strip_prefix(above)?.strip_prefix('/')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_topic_is_somebodys_business() {
        let topics = Topics::new("hallsweep", "discovery", "unibo/qak");
        let cases = [
            ("hallsweep/discovery/command/start", TopicKind::Command("start")),
            ("hallsweep/discovery/command", TopicKind::Word),
            ("hallsweep/discovery/command/start/result", TopicKind::Ours),
            ("hallsweep/discovery/state/robot", TopicKind::Ours),
            ("hallsweep/discovery", TopicKind::Ours),
            ("homeassistant/device/discovery/config", TopicKind::Ours),
            ("homeassistant/status", TopicKind::Elsewhere),
            ("unibo/qak/events", TopicKind::Old),
            ("unibo/qak/robotmind", TopicKind::Old),
            ("unibo/qak/a/b", TopicKind::Elsewhere),
            ("unibo/qak", TopicKind::Elsewhere),
            ("hallsweep/discovery2/command/start", TopicKind::Elsewhere),
            ("hallsweep/other/state/robot", TopicKind::Elsewhere),
            ("", TopicKind::Elsewhere),
        ];
        for (topic, kind) in cases {
            assert_eq!(topics.kind_of(topic), kind, "{topic}");
        }
    }

    #[test]
    fn what_is_published_is_ours_and_what_is_taken_is_a_command() {
        let topics = Topics::new("site/robots", "r2", "r2/qak");
        let published = [topics.event(), topics.availability(), topics.result("goto"), topics.photo(), topics.home_assistant()];
        let states = Resource::ALL.map(|resource| topics.state(resource));
        for topic in published.iter().chain(&states).chain([&topics.discovery()]) {
            assert_eq!(topics.kind_of(topic), TopicKind::Ours, "{topic}");
        }
        assert_eq!(topics.kind_of(&topics.command("goto")), TopicKind::Command("goto"));
        assert_eq!(topics.kind_of(&topics.old_events()), TopicKind::Old);
    }
}
