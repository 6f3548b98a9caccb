//! Safety R4, for any state and any journal: the mission, phase, pieces and verdicts shown are recorded, and a number
//! that was shown never means another thing later, across all starts of a program.

use std::collections::BTreeMap;

use hallsweep_core::command::Strategy;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{AlarmId, Cell, LuggageId, MissionId};
use hallsweep_core::world::alarm::AlarmCause;

/// Stored part of the journal, and numbers shown so far.
pub(crate) struct Record {
    standing: PersistentState,
    entries: usize,
    /// Place in the journal where each mission began.
    began: BTreeMap<MissionId, usize>,
    missions: BTreeMap<MissionId, usize>,
    luggage: BTreeMap<LuggageId, Cell>,
    alarms: BTreeMap<AlarmId, AlarmCause>,
    /// Every mission and phase that was in force at some time.
    stood: Vec<(MissionId, PhaseName)>,
    /// Whether everything in force at the last failure of the store has been recorded.
    pub(crate) is_whole: bool,
}

impl Record {
    /// Empty record of a program that began with this strategy.
    pub(crate) fn of(strategy: Strategy) -> Record {
        Record {
            standing: PersistentState::first(strategy),
            entries: 0,
            began: BTreeMap::new(),
            missions: BTreeMap::new(),
            luggage: BTreeMap::new(),
            alarms: BTreeMap::new(),
            stood: vec![(MissionId(0), PhaseName::Idle)],
            is_whole: true,
        }
    }

    /// Adds stored entries.
    pub(crate) fn keep<'a>(&mut self, entries: impl IntoIterator<Item = &'a Entry>) {
        for entry in entries {
            self.standing.apply(entry);
            self.is_whole |= matches!(entry.fact, Fact::State(_));
            if let Fact::MissionBegan(mission, _) = entry.fact {
                let before = self.began.insert(mission, self.entries);
                assert!(before.is_none(), "mission {mission:?} began twice");
            }
            self.entries += 1;
            let stands = (self.standing.mission, self.standing.phase.name());
            if !self.stood.contains(&stands) {
                self.stood.push(stands);
            }
        }
    }

    /// Adds the new entries of the disk, which holds the entries of all starts.
    pub(crate) fn keep_from(&mut self, disk: &[Entry]) {
        let known = self.entries;
        self.keep(&disk[known..]);
    }

    pub(crate) fn check(&mut self, state: &Snapshot, seed: u64) {
        let (mission, stands) = (&state.mission, &self.standing);
        let failing = mission.store_failure.is_some() || !self.is_whole;
        // While the store fails, the state shown may be older than the record.
        if failing {
            let stood = |phase| self.stood.contains(&(mission.id, phase));
            assert!(mission.phase == PhaseName::Fault || stood(mission.phase), "seed {seed}: {:?} never stood", mission.phase);
            return;
        }
        assert_eq!(mission.id, stands.mission, "seed {seed}: a mission is shown that is not on record");
        if mission.phase != PhaseName::Fault {
            assert_eq!(mission.phase, stands.phase.name(), "seed {seed}: a phase is shown that is not on record");
        }
        assert_eq!(mission.strategy, stands.strategy, "seed {seed}");
        for piece in state.luggage.iter() {
            let kept = stands.luggage.get(piece.id).unwrap_or_else(|| panic!("seed {seed}: {:?} is not on record", piece.id));
            assert_eq!((piece.cell, piece.pose), (kept.cell, kept.pose), "seed {seed}: {:?}", piece.id);
            assert!(piece.verdict.is_none() || piece.verdict == kept.verdict, "seed {seed}: a verdict is not on record");
            let meant = *self.luggage.entry(piece.id).or_insert(piece.cell);
            assert_eq!(meant, piece.cell, "seed {seed}: {:?} is another piece now", piece.id);
        }
        for alarm in state.alarms.iter() {
            let Some(id) = alarm.id else { continue };
            let kept = stands.alarms.iter().find(|kept| kept.id == id);
            assert_eq!(kept.map(|kept| &kept.cause), Some(&alarm.cause), "seed {seed}: {id:?} is not on record");
            let meant = self.alarms.entry(id).or_insert_with(|| alarm.cause.clone());
            assert_eq!(*meant, alarm.cause, "seed {seed}: {id:?} is another alarm now");
        }
        if let Some(place) = self.began.get(&mission.id) {
            let meant = *self.missions.entry(mission.id).or_insert(*place);
            assert_eq!(meant, *place, "seed {seed}: {:?} is another mission now", mission.id);
        }
    }
}
