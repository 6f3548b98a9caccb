//! Words for the faults of missions and of retrievals, and for the causes of alarms.

use crate::phrases::Language;
use hallsweep_core::not_fetched::{AloneFault, NotFetched, StuckFault};
use hallsweep_core::phase::FaultCause;
use hallsweep_core::world::alarm::AlarmCause;

impl Language {
    /// Words for a fault, without a full stop, because they become part of a sentence.
    pub fn fault(self, fault: &FaultCause) -> String {
        match fault {
            FaultCause::NoWayHome => self.say("fault-noWayHome").to_string(),
            FaultCause::Unanswered => self.say("fault-unanswered").to_string(),
            FaultCause::Undecided => self.say("fault-undecided").to_string(),
            FaultCause::Robot(words) => self.say("fault-robot").with("words", words).to_string(),
            FaultCause::NotFetched(why) => self.say("fault-notFetched").with("why", self.not_fetched(why)).to_string(),
        }
    }

    /// Words for the reason why a piece was not fetched, without a full stop, because they become part of a sentence.
    pub fn not_fetched(self, why: &NotFetched) -> String {
        let said = match why {
            NotFetched::Pair(fault, None) => self.say_of("not-fetched", fault.name()),
            NotFetched::Pair(fault, Some(words)) => {
                self.say("not-fetched-and").with("why", self.say_of("not-fetched", fault.name())).with("words", words)
            }
            NotFetched::Alone(fault) => self.say(alone(*fault)),
            NotFetched::OtherFetcher { began, set } => {
                self.say("not-fetched-other-fetcher").with("began", began.name()).with("set", set.name())
            }
            NotFetched::Stuck(fault, None) => self.say(stuck(*fault)),
            NotFetched::Stuck(fault, Some(before)) => {
                self.say("not-fetched-and-stuck").with("before", self.not_fetched(before)).with("why", self.say(stuck(*fault)))
            }
            NotFetched::Other(words) => return words.clone(),
        };
        said.to_string()
    }

    pub fn alarm(self, cause: &AlarmCause) -> String {
        let said = match cause {
            AlarmCause::Dangerous(id, cell) => self.say("alarm-dangerous").with("id", id).with("cell", cell),
            AlarmCause::Unrecorded(id, cell) => self.say("alarm-dangerous-unrecorded").with("id", id).with("cell", cell),
            AlarmCause::Call(id, saying) => {
                self.say("alarm-call").with("id", id).with("saying", self.say_of("saying", saying.name()))
            }
            AlarmCause::Other(words) => return words.clone(),
        };
        said.to_string()
    }
}

const fn alone(fault: AloneFault) -> &'static str {
    match fault {
        AloneFault::OtherPiece => "alone-OtherPiece",
        AloneFault::PieceLost => "alone-PieceLost",
        AloneFault::NoWayHome => "alone-NoWayHome",
        AloneFault::NoWayToPiece => "alone-NoWayToPiece",
        AloneFault::CannotTake => "alone-CannotTake",
        AloneFault::NotRecognised => "alone-NotRecognised",
    }
}

const fn stuck(fault: StuckFault) -> &'static str {
    match fault {
        StuckFault::RobotFails => "stuck-RobotFails",
        StuckFault::NoWayOut => "stuck-NoWayOut",
    }
}
