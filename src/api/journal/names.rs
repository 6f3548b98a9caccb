//! Names in the journal, and how they are read back. Unknown names are refused.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Unparsed;
use crate::api::door::DOORS;
use crate::api::fields::in_short;
use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::command::{CommandId, Door, HotAnswer, Move, Note, Strategy, TemperatureReport, Verdict};
use hallsweep_core::hold::Hold;
use hallsweep_core::not_fetched::{AloneFault, Fetcher, StuckFault};
use hallsweep_core::pair::{RetrievalFault, Saying};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::robot::RobotId;
use hallsweep_core::search::Search;
use hallsweep_core::units::{Celsius, Epoch, Heading};
use hallsweep_core::world::areas::Area;

const TAKEN_FOR: [&str; 3] = ["wall", "luggage", "unknown"];

/// State of a search: its strategy, and the numbers from which the strategy continues.
#[derive(Serialize, Deserialize)]
pub(super) struct SearchShape {
    strategy: String,
    notes: Vec<i64>,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) enum Step {
    Forward,
    Backward,
    TurnLeft,
    TurnRight,
    NudgeLeft,
    NudgeRight,
}

pub(super) fn named<T: Copy>(what: &str, name: &str, all: &[T], name_of: fn(T) -> &'static str) -> Result<T, Unparsed> {
    let known = all.iter().copied().find(|one| name_of(*one) == name);
    known.ok_or_else(|| Unparsed(format!("{:?} is no {what} that this version knows", in_short(name))))
}

pub(super) fn door(name: &str) -> Result<Door, Unparsed> {
    named("door", name, &DOORS, |door| door.0)
}

pub(super) fn robot(name: &str) -> Result<RobotId, Unparsed> {
    RobotId::new(name).ok_or_else(|| Unparsed(format!("`{name}` is no name of a robot")))
}

pub(super) fn note(text: Option<String>) -> Result<Option<Note>, Unparsed> {
    let sound = |text: String| Note::new(&text).ok_or_else(|| Unparsed(format!("{:?} is no note of a verdict", in_short(&text))));
    text.map(sound).transpose()
}

/// Reads the name of a person or office.
pub(super) fn name(text: String) -> Result<Note, Unparsed> {
    note(Some(text))?.ok_or_else(|| Unparsed("there is no name".to_owned()))
}

/// Reads the name of an area of the hall.
pub(super) fn area(name: String) -> Result<Arc<str>, Unparsed> {
    let sound = Area::is_name(&name);
    sound.then(|| name.as_str().into()).ok_or_else(|| Unparsed(format!("{:?} is no name of an area", in_short(&name))))
}

/// Reads the order of the areas.
pub(super) fn areas(names: Vec<String>) -> Result<Arc<[Arc<str>]>, Unparsed> {
    if names.len() > Area::MOST {
        return Err(Unparsed("there are too many names of areas".to_owned()));
    }
    names.into_iter().map(area).collect()
}

pub(super) fn command_id(id: Option<String>) -> Result<Option<CommandId>, Unparsed> {
    let sound = |id: String| CommandId::new(&id).ok_or_else(|| Unparsed("the id of the command is not valid".to_owned()));
    id.map(sound).transpose()
}

/// Reads a number of stops. The store counts in signed 64-bit numbers, so a larger number is refused.
pub(super) fn epoch(count: u64) -> Result<Epoch, Unparsed> {
    i64::try_from(count).map(|_| Epoch(count)).map_err(|_| Unparsed(format!("{count} is too large a number of stops")))
}

pub(super) fn heading(name: &str) -> Result<Heading, Unparsed> {
    named("heading", name, &Heading::ALL, Heading::name)
}

pub(super) fn hold(name: &str) -> Result<Hold, Unparsed> {
    named("hold", name, &Hold::ALL, Hold::name)
}

pub(super) fn strategy(name: &str) -> Result<Strategy, Unparsed> {
    named("strategy", name, &Strategy::ALL, Strategy::name)
}

pub(super) fn verdict(name: &str) -> Result<Verdict, Unparsed> {
    named("verdict", name, &[Verdict::Safe, Verdict::Danger], Verdict::name)
}

pub(super) fn bomb_size(text: &str) -> Result<BombSize, Unparsed> {
    BombSize::read(text).ok_or_else(|| Unparsed(format!("{text:?} is no size of a bomb")))
}

pub(super) fn hot_answer(name: &str) -> Result<HotAnswer, Unparsed> {
    named("answer", name, &HotAnswer::ALL, HotAnswer::name)
}

pub(super) fn phase(name: &str) -> Result<PhaseName, Unparsed> {
    named("phase", name, &PhaseName::ALL, PhaseName::name)
}

pub(super) fn saying(name: &str) -> Result<Saying, Unparsed> {
    named("call of the pair", name, &Saying::ALL, Saying::name)
}

pub(super) fn pair_fault(name: &str) -> Result<RetrievalFault, Unparsed> {
    named("fault of the pair", name, &RetrievalFault::ALL, RetrievalFault::name)
}

pub(super) fn alone_fault(name: &str) -> Result<AloneFault, Unparsed> {
    named("fault of a robot that fetches", name, &AloneFault::ALL, AloneFault::name)
}

pub(super) fn stuck_fault(name: &str) -> Result<StuckFault, Unparsed> {
    named("fault of robots that are stuck", name, &StuckFault::ALL, StuckFault::name)
}

pub(super) fn fetcher(name: &str) -> Result<Fetcher, Unparsed> {
    named("fetcher", name, &Fetcher::ALL, Fetcher::name)
}

pub(super) fn sensor(name: &str) -> Result<Arc<str>, Unparsed> {
    TemperatureReport::sensor_name(name).ok_or_else(|| Unparsed(format!("{:?} is no name of a sensor", in_short(name))))
}

pub(super) fn taken_for(name: &str) -> Result<&'static str, Unparsed> {
    named("obstacle", name, &TAKEN_FOR, |known| known)
}

pub(super) fn celsius(degrees: f64) -> Result<Celsius, Unparsed> {
    Celsius::new(degrees).ok_or_else(|| Unparsed(format!("{degrees} °C is no temperature that a hall can have")))
}

impl From<&Search> for SearchShape {
    fn from(search: &Search) -> SearchShape {
        SearchShape { strategy: search.strategy().name().to_owned(), notes: search.notes() }
    }
}

impl SearchShape {
    pub(super) fn search(&self) -> Result<Search, Unparsed> {
        let search = strategy(&self.strategy)?.resume(&self.notes);
        let same = search.notes() == self.notes;
        same.then_some(search).ok_or_else(|| Unparsed(format!("the search state does not fit the strategy {}", self.strategy)))
    }
}

impl From<Move> for Step {
    fn from(step: Move) -> Step {
        match step {
            Move::Forward => Step::Forward,
            Move::Backward => Step::Backward,
            Move::TurnLeft => Step::TurnLeft,
            Move::TurnRight => Step::TurnRight,
            Move::NudgeLeft => Step::NudgeLeft,
            Move::NudgeRight => Step::NudgeRight,
        }
    }
}

impl From<Step> for Move {
    fn from(step: Step) -> Move {
        match step {
            Step::Forward => Move::Forward,
            Step::Backward => Move::Backward,
            Step::TurnLeft => Move::TurnLeft,
            Step::TurnRight => Move::TurnRight,
            Step::NudgeLeft => Move::NudgeLeft,
            Step::NudgeRight => Move::NudgeRight,
        }
    }
}
