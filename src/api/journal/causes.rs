//! Causes of alarms, and the reasons why a piece was not fetched, in the journal.

use serde_json::json;

use super::coded::{Coded, Valued};
use super::places::Point;
use super::{Unparsed, earlier, names};
use hallsweep_core::not_fetched::NotFetched;
use hallsweep_core::units::{Cell, LuggageId};
use hallsweep_core::world::alarm::AlarmCause;

impl Valued for AlarmCause {
    fn coded(&self) -> Coded {
        let at = |luggage: &LuggageId, cell: &Cell| json!({ "luggage": luggage.0, "cell": Point::from(*cell) });
        match self {
            AlarmCause::Dangerous(luggage, cell) => Coded::new("dangerous", at(luggage, cell)),
            AlarmCause::Unrecorded(luggage, cell) => Coded::new("unrecorded", at(luggage, cell)),
            AlarmCause::Call(luggage, saying) => Coded::new("call", json!({ "luggage": luggage.0, "saying": saying.name() })),
            AlarmCause::Other(words) => Coded::new("words", json!({ "words": words })),
        }
    }

    fn value(coded: &Coded) -> Result<AlarmCause, Unparsed> {
        let luggage = || coded.field("luggage").map(LuggageId);
        let cell = || coded.field::<Point>("cell").map(Cell::from);
        Ok(match &*coded.code {
            "dangerous" => AlarmCause::Dangerous(luggage()?, cell()?),
            "unrecorded" => AlarmCause::Unrecorded(luggage()?, cell()?),
            "call" => AlarmCause::Call(luggage()?, names::saying(&coded.field::<String>("saying")?)?),
            "words" => AlarmCause::Other(coded.field("words")?),
            _ => return coded.unknown(),
        })
    }

    fn earlier(sentence: &str) -> Option<Coded> {
        earlier::alarm(sentence)
    }

    fn words(words: String) -> AlarmCause {
        AlarmCause::Other(words)
    }
}

impl Valued for NotFetched {
    fn coded(&self) -> Coded {
        match self {
            NotFetched::Pair(fault, words) => Coded::new("pair", json!({ "fault": fault.name(), "words": words })),
            NotFetched::Alone(fault) => Coded::new("alone", json!({ "fault": fault.name() })),
            NotFetched::OtherFetcher { began, set } => {
                Coded::new("otherFetcher", json!({ "began": began.name(), "set": set.name() }))
            }
            NotFetched::Stuck(fault, before) => {
                Coded::new("stuck", json!({ "fault": fault.name(), "before": before.as_ref().map(|before| before.coded()) }))
            }
            NotFetched::Other(words) => Coded::new("words", json!({ "words": words })),
        }
    }

    fn value(coded: &Coded) -> Result<NotFetched, Unparsed> {
        let name = |field| coded.field::<String>(field);
        Ok(match &*coded.code {
            "pair" => NotFetched::Pair(names::pair_fault(&name("fault")?)?, coded.field("words")?),
            "alone" => NotFetched::Alone(names::alone_fault(&name("fault")?)?),
            "otherFetcher" => {
                NotFetched::OtherFetcher { began: names::fetcher(&name("began")?)?, set: names::fetcher(&name("set")?)? }
            }
            "stuck" => {
                let before = coded.field::<Option<Coded>>("before")?;
                let before = before.map(|before| NotFetched::value(&before).map(Box::new)).transpose()?;
                NotFetched::Stuck(names::stuck_fault(&name("fault")?)?, before)
            }
            "words" => NotFetched::Other(name("words")?),
            _ => return coded.unknown(),
        })
    }

    fn earlier(sentence: &str) -> Option<Coded> {
        earlier::not_fetched(sentence)
    }

    fn words(words: String) -> NotFetched {
        NotFetched::Other(words)
    }
}
