//! What the session listens to, which depends on whose broker it is. What is done with it is not here.

use super::super::commands::Commands;
use super::super::topics::{HOME_ASSISTANT_STATUS, PULSE, Topics};

/// Whose broker it is, and so what the session listens to there.
#[derive(Clone, Debug)]
pub enum Hearing {
    /// Our own: commands are heard at its gate, with their senders' names, and the session asks it whether it is well.
    Own,
    /// Somebody else's, which passes commands on to the session.
    Other(Commands),
}

impl Hearing {
    /// The filters to subscribe to; there is at least one.
    pub(super) fn filters(&self, topics: &Topics, home_assistant: bool) -> Vec<String> {
        let mut filters = match self {
            Hearing::Own => vec![PULSE.to_owned()],
            Hearing::Other(_) => topics.commands().to_vec(),
        };
        filters.extend(home_assistant.then(|| HOME_ASSISTANT_STATUS.to_owned()));
        filters
    }
}

#[cfg(test)]
mod tests {
    use tokio::sync::mpsc;

    use super::*;
    use crate::api::fixture::idle;
    use crate::runtime::obedient::obedient;

    #[tokio::test]
    async fn commands_are_heard_here_only_at_somebody_elses_broker() {
        let topics = Topics::new("hallsweep", "discovery", "unibo/qak");
        assert_eq!(Hearing::Own.filters(&topics, false), [PULSE]);
        assert_eq!(Hearing::Own.filters(&topics, true), [PULSE, HOME_ASSISTANT_STATUS]);
        let commands = Commands::new(obedient(idle()).0, topics.clone(), true, mpsc::channel(1).0);
        let filters = ["hallsweep/discovery/command", "hallsweep/discovery/command/+", "unibo/qak/+"];
        assert_eq!(Hearing::Other(commands.clone()).filters(&topics, false), filters);
        assert_eq!(Hearing::Other(commands).filters(&topics, true)[3], HOME_ASSISTANT_STATUS);
    }
}
