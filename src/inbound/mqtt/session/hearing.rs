//! What the session listens to, which depends on whose broker it is. What is done with it is not here.

use super::super::topics::{HOME_ASSISTANT_STATUS, PULSE, Topics};

/// What the session listens to.
#[derive(Clone, Debug)]
pub struct Hearing {
    /// The topics of this robot.
    pub topics: Topics,
    /// Whether the broker is our own: then commands are heard at its gate, with their senders' names, and the session asks it
    /// whether it is well. Somebody else's passes commands on to the session.
    pub is_own: bool,
    /// Whether Home Assistant is told of the robot, and so again when it has started.
    pub home_assistant: bool,
}

impl Hearing {
    /// The filters to subscribe to; there is at least one.
    pub(super) fn filters(&self) -> Vec<String> {
        let mut filters = if self.is_own { vec![PULSE.to_owned()] } else { self.topics.commands().to_vec() };
        filters.extend(self.home_assistant.then(|| HOME_ASSISTANT_STATUS.to_owned()));
        filters
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filters(is_own: bool, home_assistant: bool) -> Vec<String> {
        Hearing { topics: Topics::new("hallsweep", "discovery", "unibo/qak"), is_own, home_assistant }.filters()
    }

    #[test]
    fn commands_are_heard_here_only_at_somebody_elses_broker() {
        assert_eq!(filters(true, false), [PULSE]);
        assert_eq!(filters(true, true), [PULSE, HOME_ASSISTANT_STATUS]);
        let commands = ["hallsweep/discovery/command", "hallsweep/discovery/command/+", "unibo/qak/+"];
        assert_eq!(filters(false, false), commands);
        assert_eq!(filters(false, true)[3], HOME_ASSISTANT_STATUS);
    }
}
