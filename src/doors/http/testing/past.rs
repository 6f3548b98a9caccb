//! Two missions for the tests of this door, made by hand: the first is over and left a bomb behind, the second has just begun.
//! How an archive finds them is `testing`'s business.

use std::sync::Arc;

use crate::api::fixture::{TEN, searching};
use crate::runtime::archive::{Happened, MissionRecord, Unreadable};
use hallsweep_core::command::{Command, Issuer, LuggageRef, Refusal, Refused, Verdict};
use hallsweep_core::effect::{Entry, Fact};
use hallsweep_core::mission::{Hold, Phase, PhaseName};
use hallsweep_core::retrieval::Place;
use hallsweep_core::search::Strategy;
use hallsweep_core::settings::Settings;
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::{LuggageId, MissionId, Pose, Seq, WallTime};
use hallsweep_sim::headless::Run;
use hallsweep_sim::pair::PairSettings;
use hallsweep_sim::{Camera, Hall, SimSettings};

/// A mission that cannot be read.
pub(super) const UNREADABLE: MissionId = MissionId(99);

/// What is wrong with the record of the first.
pub(super) const DAMAGE: &str = "entry 6 of the journal cannot be understood (a mouse was at it)";

/// Both, the newest first.
pub(super) fn missions() -> [MissionRecord; 2] {
    let hour = |hours: i64| WallTime { unix_ms: TEN.unix_ms + hours * 3_600_000, ..TEN };
    let first = MissionRecord {
        id: MissionId(1),
        strategy: Strategy::Snail.name().into(),
        began: TEN,
        archived: Some(hour(1)),
        phase: "bombLocated".into(),
        luggage: 3,
        dangerous: 1,
        left: vec![LuggageId(2)],
    };
    let second = MissionRecord {
        id: MissionId(2),
        began: hour(2),
        archived: None,
        phase: "exploring".into(),
        luggage: 0,
        dangerous: 0,
        left: Vec::new(),
        ..first.clone()
    };
    [second, first]
}

/// What stood when the first was put away: the map and the luggage of the fixture.
pub(super) fn state() -> PersistentState {
    let state = searching();
    let luggage = state.luggage.iter().map(|luggage| (luggage.id, luggage.clone())).collect();
    PersistentState {
        mission: MissionId(1),
        map: state.map,
        luggage,
        phase: Phase::BombLocated,
        ..PersistentState::first(Strategy::Snail)
    }
}

/// A retrieval by the pair as a small hall's journal tells of it, from the last entries before it on.
pub(super) fn retrieval() -> Vec<Happened> {
    let hall = Arc::new(Hall::from_rows("hall", &["S....", "..a..", "....."]).expect("a sound hall"));
    let pair = PairSettings { way_out: true, ..PairSettings::new(1, Place::ENTRANCE) };
    let sim = SimSettings::new(1, Camera::Stub);
    let mut run = Run::with_pair(hall, sim, Settings::default(), Strategy::Snail, pair);
    run.give(Command::Start).expect("nothing holds it");
    run.run_until(10_000, |state| state.mission.inspected.is_some());
    let danger = Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Danger };
    run.give(danger).expect("a piece waits");
    run.run_until(10_000, |state| state.mission.phase == PhaseName::BombLocated);
    run.give(Command::Retrieve).expect("discovery is home");
    assert!(run.run_until(100_000, |state| state.mission.phase == PhaseName::BagSecured), "the bag can be fetched");
    let is_told = |entry: &&Entry| matches!(entry.fact, Fact::Retrieval(_) | Fact::Holds(_) | Fact::Secured(_) | Fact::Phase(_));
    (1..).map(Seq).zip(run.journal.iter().filter(is_told).cloned().map(Ok)).collect()
}

/// What happened in the first, and one entry that cannot be understood.
pub(super) fn entries() -> Vec<Happened> {
    let command = |command: &str, refused: Option<Refused>| {
        let issuer = Issuer { door: crate::api::door::CONSOLE, who: "anna".into(), from: "192.0.2.7".into() };
        let refused = refused.as_ref().map(Refusal::from);
        Fact::Command { issuer, id: None, command: command.to_owned(), epoch: None, luggage: None, refused }
    };
    let facts = [
        Fact::MissionBegan(MissionId(1), Strategy::Snail),
        command("START", None),
        command("RESET", Some(Refused::Moving)),
        Fact::Holds(vec![Hold::Operator]),
        Fact::Pose(Pose::START),
    ];
    let sound = facts.map(|fact| Ok(Entry { wall: TEN, fact }));
    (1..).map(Seq).zip(sound.into_iter().chain([Err(Unreadable(DAMAGE.to_owned()))])).collect()
}
