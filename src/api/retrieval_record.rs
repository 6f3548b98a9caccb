//! A recorded retrieval in JSON: its events, and the ticks of its trees for a replay. `retrieval` shows a retrieval
//! that is still going on.

use std::time::Duration;

use schemars::JsonSchema;
use serde::Serialize;

use super::journal_words::words;
use super::replay::{ReplayJson, seconds};
use super::time::rfc3339;
use super::vocabulary;
use behaviour_trees::TickLog;
use hallsweep_core::retrieval::Team;
use hallsweep_core::state::Retrieval;
use hallsweep_core::state::fact::{Entry, Fact};

/// Record of a retrieval, from the beginning to the end or to the present stage.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RetrievalRecordJson {
    /// Number of the piece to fetch.
    pub luggage: u64,
    /// Robots that fetch: `pair` or `discovery`.
    #[schemars(with = "vocabulary::Fetcher")]
    pub fetcher: &'static str,
    /// Time at which the retrieval began, RFC 3339 with zone.
    pub began: String,
    /// Time from the beginning to the last recorded event, in seconds. Changes of the clock are subtracted.
    pub seconds: f64,
    /// Whether the record is complete; otherwise its later part is missing.
    pub complete: bool,
    pub events: Vec<EventJson>,
    #[serde(flatten)]
    pub replay: ReplayJson,
}

/// Event of a retrieval, in words.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "RetrievalEvent")]
pub struct EventJson {
    /// Time since the beginning, in seconds.
    pub t: f64,
    pub words: String,
    /// The recorded fact, from which callers make the words in another language.
    #[serde(skip)]
    pub fact: Fact,
}

impl RetrievalRecordJson {
    /// The record of the last retrieval that began in these entries; `None` if there is none. The entries are those
    /// of one mission, oldest first.
    pub fn new(entries: &[Entry], complete: bool) -> Option<RetrievalRecordJson> {
        let began = |index: usize| {
            let before = entries[..index].iter().rev().find(|entry| matches!(entry.fact, Fact::Retrieval(_)));
            retrieval_in(&entries[index]).is_some() && before.is_none_or(|before| retrieval_in(before).is_none())
        };
        let entries = &entries[(0..entries.len()).rev().find(|index| began(*index))?..];
        let (first, retrieval) = (entries.first()?, retrieval_in(entries.first()?)?);
        let mut record = RetrievalRecordJson {
            luggage: retrieval.luggage.0,
            fetcher: retrieval.fetcher.name(),
            began: rfc3339(first.wall),
            seconds: 0.0,
            complete,
            events: Vec::new(),
            replay: ReplayJson { trees: Vec::new() },
        };
        let (trees, mut logs) = (Team::new(), <[TickLog; 3]>::default());
        let (mut team, mut at, mut stage, mut began) = (None, Duration::ZERO, String::new(), first.wall);
        for entry in entries {
            if let Fact::ClockSet(by_ms) = entry.fact {
                began = began.set_by(by_ms);
            }
            let since_began_ms = u64::try_from(entry.wall.unix_ms.saturating_sub(began.unix_ms)).unwrap_or(0);
            // Old journals have no entries about changes of the clock, so times in them may go back. The time of the
            // run must not go back.
            at = at.max(Duration::from_millis(since_began_ms));
            let (told, words) = (retrieval_in(entry), words(&entry.fact));
            // Each entry with the trees repeats the stage. Only a new stage is an event.
            if told.is_none() || words != stage {
                record.events.push(EventJson { t: seconds(at), words: words.clone(), fact: entry.fact.clone() });
            }
            stage = if told.is_some() { words } else { stage };
            if let Some(stood) = told.and_then(|retrieval| trees.resumed(retrieval.team.clone()?).ok()) {
                for (log, tree) in logs.iter_mut().zip(stood.trees()) {
                    log.note(tree, stood.blackboard(), at);
                }
                team = Some(stood);
            }
            if matches!(entry.fact, Fact::Retrieval(None)) {
                break;
            }
        }
        record.seconds = seconds(at);
        record.replay = ReplayJson::new(team.iter().flat_map(|team| team.trees().iter().zip(&logs)));
        Some(record)
    }
}

fn retrieval_in(entry: &Entry) -> Option<&Retrieval> {
    if let Fact::Retrieval(Some(retrieval)) = &entry.fact { Some(retrieval) } else { None }
}
