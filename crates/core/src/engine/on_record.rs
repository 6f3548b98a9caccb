//! Shows only what is recorded of the mission (safety R4). The state itself is ahead of the record (ADR 2). A view of
//! the state waits here until its page of the journal is stored. Warnings and halts do not wait: `view` adds them.
//!
//! ```text
//!   the state after each input ─► StateView and last written entry ─► ahead: (Seq, StateView), … ─► kept up to Seq ─► shown
//! ```

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use super::Engine;
use crate::closing::{Closed, OpenInArea};
use crate::command::Strategy;
use crate::effect::Effect;
use crate::hold::Hold;
use crate::phase::{FaultCause, PhaseName};
use crate::search::Goal;
use crate::snapshot::Refusals;
use crate::snapshot::retrieval::RetrievalView;
use crate::state::{Inspection, Phase};
use crate::units::{AlarmId, Cell, LuggageId, MissionId, Revision, Seq};
use crate::world::alarm::Alarm;
use crate::world::coverage::Coverage;
use crate::world::hall_map::HallMap;
use crate::world::records::LuggageRecords;
use crate::world::resource::Resource;

/// Maximum number of waiting views. When the store is further behind, a new view replaces the latest waiting view.
/// Some states are then never shown, but nothing is shown early.
const AHEAD: usize = 64;

/// After a loss of entries, nothing new is shown until the whole state is recorded again.
const NEVER: Seq = Seq(u64::MAX);

/// What is shown only after it is recorded: the results of commands and the found pieces, as they are after one
/// input.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct StateView {
    pub(super) mission: MissionId,
    under_way: bool,
    pub(super) phase: PhaseName,
    pub(super) interrupted: Option<PhaseName>,
    pub(super) fault: Option<FaultCause>,
    pub(super) inspected: Option<LuggageId>,
    pub(super) strategy: Strategy,
    pub(super) goal: Option<Cell>,
    pub(super) holds: Vec<Hold>,
    pub(super) led_blinking: bool,
    pub(super) luggage: LuggageRecords,
    pub(super) alarms: Arc<[Arc<Alarm>]>,
    pub(super) retrieval: Option<Arc<RetrievalView>>,
    pub(super) closed: Option<Arc<Closed>>,
    pub(super) again: Arc<BTreeSet<Cell>>,
    pub(super) area_order: Arc<[Arc<str>]>,
    pub(super) closed_areas: Arc<BTreeMap<Arc<str>, Closed<OpenInArea>>>,
    pub(super) is_viewing: bool,
    pub(super) refusals: Refusals,
    emptied: u64,
}

#[derive(Clone, Debug)]
pub(super) struct OnRecord {
    pub(super) shown: StateView,
    ahead: VecDeque<(Seq, StateView)>,
    /// The revision and the last entry at the previous call of `look`. If both are the same now, nothing has changed
    /// since then.
    looked: (Revision, Seq),
    /// Nothing new is shown before this entry is stored, because an earlier entry was lost.
    floor: Seq,
    emptied: u64,
    /// The old map, which is shown until the emptying of the map is recorded.
    pub(super) before: Option<(HallMap, Coverage)>,
    /// Whether the LED was told to blink. A blinking LED also shows that a mission has begun.
    pub(super) lit: bool,
}

impl OnRecord {
    pub(super) fn first(strategy: Strategy) -> OnRecord {
        OnRecord::of(StateView { strategy, ..StateView::default() })
    }

    pub(super) fn of(shown: StateView) -> OnRecord {
        let (ahead, looked, lit) = (VecDeque::new(), (Revision(0), Seq(0)), shown.led_blinking);
        OnRecord { emptied: shown.emptied, shown, ahead, looked, floor: Seq(0), before: None, lit }
    }

    pub(super) fn is_current(&self) -> bool {
        self.ahead.is_empty() && self.floor != NEVER
    }

    #[cfg(test)]
    pub(super) fn waiting(&self) -> usize {
        self.ahead.len()
    }

    fn push(&mut self, seq: Seq, view: StateView) {
        if self.ahead.len() == AHEAD {
            self.ahead.pop_back();
        }
        self.ahead.push_back((seq.max(self.floor), view));
    }

    fn advance(&mut self, kept: Seq) {
        let due = self.ahead.iter().take_while(|(seq, _)| *seq <= kept).count();
        if let Some((_, view)) = self.ahead.drain(..due).next_back() {
            self.shown = view;
        }
    }
}

impl Engine {
    /// Notes the state after an input, and shows the recorded part of it.
    pub(super) fn look(&mut self) {
        let looked = (self.world.revision(), self.outbox.written());
        if looked != self.on_record.looked {
            self.on_record.looked = looked;
            let view = self.mission_as_it_is();
            let latest = self.on_record.ahead.back().map_or(&self.on_record.shown, |(_, view)| view);
            if view != *latest {
                let buttons = view.refusals != latest.refusals;
                self.on_record.push(looked.1, view);
                // A button whose command is now refused is no longer offered, although the reason is not recorded
                // yet.
                if buttons {
                    self.world.touch(Resource::Mission);
                }
            }
        }
        self.show_kept();
    }

    /// Handles the loss of entries on their way to the store. Stored records and verdicts stay shown, although their
    /// consequences are not recorded.
    pub(super) fn show_nothing_lost(&mut self) {
        self.on_record.ahead.clear();
        self.on_record.floor = NEVER;
        self.on_record.looked = (Revision(0), Seq(0));
        self.world.log.lose();
        let (shown, now) = (&self.on_record.shown, self.mission_as_it_is());
        if (shown.mission, shown.under_way) == (now.mission, now.under_way) && shown.luggage != now.luggage {
            self.on_record.shown.luggage = now.luggage;
            self.world.touch(Resource::Luggage);
        }
    }

    /// Shows nothing new before entry `seq` is stored. The whole state is being recorded again, up to this entry.
    pub(super) fn show_from(&mut self, seq: Seq) {
        self.on_record.ahead.clear();
        self.on_record.floor = seq;
        self.on_record.looked = (Revision(0), Seq(0));
        self.world.log.lose();
    }

    pub(super) fn shown_map(&self) -> &HallMap {
        self.on_record.before.as_ref().map_or(&self.state.map, |(map, _)| map)
    }

    /// Must be called before the map is emptied. The old map is shown until the emptying is recorded.
    pub(super) fn keep_map_shown(&mut self) {
        self.on_record.emptied += 1;
        if self.on_record.before.is_none() {
            self.on_record.before = Some((self.state.map.clone(), self.state.coverage.clone()));
        }
    }

    pub(super) fn show_kept(&mut self) {
        let (written, kept) = (self.outbox.written().max(self.on_record.floor), self.outbox.kept());
        if self.world.log.show(written, kept) {
            self.world.touch(Resource::Log);
        }
        if self.on_record.ahead.is_empty() {
            return;
        }
        let before = self.on_record.shown.clone();
        self.on_record.advance(kept);
        let shown = &self.on_record.shown;
        if before == *shown {
            return;
        }
        let changed = [
            (Resource::Mission, true),
            (Resource::Luggage, before.luggage != shown.luggage),
            (Resource::Alarms, before.alarms != shown.alarms),
            (Resource::Map, before.emptied != shown.emptied),
            (Resource::Robot, before.led_blinking != shown.led_blinking),
            (Resource::Temperature, before.holds != shown.holds),
            (Resource::Retrieval, before.retrieval != shown.retrieval),
        ];
        for (resource, _) in changed.into_iter().filter(|(_, changed)| *changed) {
            self.world.touch(resource);
        }
        self.show_emptied_map();
        self.light();
    }

    fn show_emptied_map(&mut self) {
        if self.on_record.shown.emptied == self.on_record.emptied && self.on_record.before.take().is_some() {
            let revision = self.world.touch(Resource::Map);
            self.state.map.show_first_at(revision);
        }
    }

    fn light(&mut self) {
        if self.on_record.shown.led_blinking && self.state.led_blinking && !self.on_record.lit {
            self.on_record.lit = true;
            self.outbox.send(Effect::Led(self.robots.searching_id().clone(), true));
        }
    }

    pub(super) fn mission_as_it_is(&self) -> StateView {
        let state = &self.state;
        StateView {
            mission: state.mission,
            under_way: state.under_way,
            phase: state.phase.name(),
            interrupted: state.phase.interrupted().map(Phase::name),
            fault: state.phase.fault().cloned(),
            inspected: self.inspected().filter(|id| state.luggage.get(*id).is_some()),
            strategy: state.strategy,
            goal: self.goal(),
            holds: state.holds.to_vec(),
            led_blinking: state.led_blinking,
            luggage: state.luggage.clone(),
            alarms: state.alarms.iter().map(Arc::clone).collect(),
            retrieval: self.retrieval_as_it_is(),
            closed: self.state.closed.clone(),
            again: Arc::clone(&self.state.again),
            area_order: Arc::clone(&self.state.area_order),
            closed_areas: Arc::clone(&self.state.closed_areas),
            is_viewing: self.state.phase.inspection().is_some_and(Inspection::is_viewing),
            refusals: self.refusals(),
            emptied: self.on_record.emptied,
        }
    }

    fn goal(&self) -> Option<Cell> {
        match &self.state.phase {
            Phase::ReturningHome | Phase::ReturningWithAlarm => Some(Cell::HOME),
            Phase::Driving { goal, .. } => *goal,
            Phase::Exploring | Phase::Inspecting(_) | Phase::AtHome | Phase::Fault { .. } => self.state.goal.map(Goal::cell),
            Phase::Idle | Phase::BombLocated | Phase::Retrieving | Phase::BagSecured | Phase::Explored => None,
        }
    }

    /// Whether this alarm is recorded. If so, somebody may know its number.
    pub(super) fn is_on_record(&self, alarm: AlarmId) -> bool {
        self.on_record.shown.alarms.iter().any(|known| known.id == alarm)
    }
}
