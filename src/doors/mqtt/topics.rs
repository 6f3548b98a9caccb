//! The names of all topics, and who may publish on them. The messages are made elsewhere.

use crate::api::resources::ResourceKind;
use hallsweep_core::world::resource::Resource;

const COMMAND: &str = "command";

const RESULT: &str = "result";

const EVENTS: &str = "events";

pub const HOME_ASSISTANT_STATUS: &str = "homeassistant/status";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topics {
    /// The beginning of our own topics, such as `hallsweep/discovery`.
    base: String,
    /// The beginning of the original system's topics, such as `unibo/qak`.
    old: String,
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
        Topics { base: format!("{prefix}/{id}"), old: old.to_owned(), id: id.to_owned() }
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
        format!("homeassistant/device/{}/config", self.id)
    }

    pub fn old_events(&self) -> String {
        format!("{}/{EVENTS}", self.old)
    }

    /// Returns filters for the subscription at another broker. They match all commands, but no results.
    pub fn commands(&self) -> [String; 3] {
        [self.word(), self.command("+"), format!("{}/+", self.old)]
    }

    /// Returns filters that match all topics on which only the program itself publishes. They match all command
    /// topics too.
    pub fn ours(&self) -> [String; 3] {
        [format!("{}/#", self.base), format!("{}/+", self.old), self.discovery()]
    }

    pub fn kind_of<'a>(&self, topic: &'a str) -> TopicKind<'a> {
        if let Some(name) = under(&self.old, topic) {
            return if name.contains('/') { TopicKind::Elsewhere } else { TopicKind::Old };
        }
        let Some(rest) = under(&self.base, topic) else {
            let is_ours = topic == self.base || topic == self.discovery();
            return if is_ours { TopicKind::Ours } else { TopicKind::Elsewhere };
        };
        match rest.split_once('/') {
            None if rest == COMMAND => TopicKind::Word,
            Some((COMMAND, name)) if !name.contains('/') => TopicKind::Command(name),
            None | Some(_) => TopicKind::Ours,
        }
    }
}

fn under<'a>(above: &str, topic: &'a str) -> Option<&'a str> {
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
