//! The pair's behaviour trees at work: when they are ticked, what they see, and what happens to their proposals. The
//! proposals go through the one gate. While anything holds the pair, the trees are not ticked, so their time is
//! paused.

use std::sync::Arc;
use std::time::Duration;

use super::Engine;
use super::motion::Turn;
use crate::hold::Hold;
use crate::not_fetched::{Fetcher, NotFetched};
use crate::pair::{Saying, Which};
use crate::place::Place;
use crate::retrieval::team::TICK;
use crate::retrieval::{Proposal, Team, View};
use crate::snapshot::log::Tone;
use crate::snapshot::retrieval::TreesView;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::state::{Phase, Retrieval, RetrievalStage, TeamStage};
use crate::world::alarm::AlarmCause;
use crate::world::resource::Resource;

#[derive(Clone, Debug)]
pub(super) struct Ticked {
    pub(super) team: Team,
    /// Time of the last tick, since the start of the program. `None` before the first tick, and after a hold.
    at: Option<Duration>,
    /// Whether something has happened since the last tick. The next tick is then due at once.
    is_awake: bool,
}

impl Engine {
    pub(super) fn tick_due(&self) -> Option<Duration> {
        let ticked = self.team.as_ref().filter(|_| self.is_fetching_by_trees())?;
        Some(ticked.at.map_or(self.now.since_start, |at| at.saturating_add(TICK)))
    }

    fn is_fetching_by_trees(&self) -> bool {
        let fetching =
            |retrieval: &Retrieval| (&retrieval.stage, retrieval.fetcher) == (&RetrievalStage::Fetching, Fetcher::Pair);
        self.state.phase == Phase::Retrieving
            && self.state.retrieval.as_ref().is_some_and(fetching)
            && self.may_move(self.robots.searching_id()).is_ok()
    }

    /// Makes the trees tick at once, because a robot of the pair has reported something or a record is stored.
    pub(super) fn wake_team(&mut self) {
        if let Some(ticked) = &mut self.team {
            ticked.is_awake = true;
        }
    }

    /// Pauses the trees' time, because time under a hold does not count.
    pub(super) fn stop_trees_clock(&mut self) {
        if let Some(ticked) = &mut self.team {
            ticked.at = None;
        }
    }

    /// Ticks the trees every `TICK`, or at once when something has woken them.
    pub(super) fn fetch(&mut self) -> Turn {
        let mut ticked = self.team.take().unwrap_or_else(|| self.resumed_team());
        let now = self.now.since_start;
        if !ticked.is_awake && ticked.at.is_some_and(|at| now < at.saturating_add(TICK)) {
            self.team = Some(ticked);
            return Turn::Rest;
        }
        let since_last = ticked.at.map_or(Duration::ZERO, |at| now.saturating_sub(at));
        (ticked.at, ticked.is_awake) = (Some(now), false);
        if let Some(found) = self.seen.take() {
            ticked.team.handle_found(found, self.wanted_piece());
        }
        let outcome = self.with_view(|view| ticked.team.tick(view, since_last));
        let stage = ticked.team.stage().clone();
        let words = ticked.team.words().map(str::to_owned);
        self.note_tick(&ticked.team);
        self.team = Some(ticked);
        for Proposal { which, action } in outcome.proposals {
            self.let_through(which, action);
        }
        for saying in outcome.sayings {
            self.call_operator(saying);
        }
        match stage {
            TeamStage::Working | TeamStage::Lost => Turn::Rest,
            TeamStage::Done => self.secured(),
            TeamStage::Faulted(fault) => {
                self.forget_failures();
                self.set_retrieval_stage(RetrievalStage::GoingOut(Some(NotFetched::Pair(fault, words))));
                Turn::Again
            }
        }
    }

    fn resumed_team(&mut self) -> Ticked {
        let kept = self.state.retrieval.as_ref().and_then(|retrieval| retrieval.team.clone());
        let team = kept.map(Team::resume).and_then(|team| match team {
            Ok(team) => Some(team),
            Err(why) => {
                self.world.write(self.now.wall, Tone::Warning, Said::TreesBeginAnew(why));
                None
            }
        });
        Ticked { team: team.unwrap_or_default(), at: None, is_awake: true }
    }

    pub(super) fn wanted_piece(&self) -> Option<crate::units::Piece> {
        let luggage = self.state.retrieval.as_ref()?.luggage;
        self.state.luggage.get(luggage)?.piece
    }

    fn with_view<T>(&self, look: impl FnOnce(&View<'_>) -> T) -> T {
        let nothing = std::collections::BTreeSet::new();
        let view = View {
            map: &self.state.map,
            way_out: true,
            others: &[],
            piece: self.state.retrieval.as_ref().map_or(&nothing, |retrieval| &retrieval.piece),
            wanted: self.wanted_piece(),
            target: Place::ENTRANCE,
            bases: Which::ALL.map(|which| self.base_view(which)),
            is_calling: self.is_calling(),
            kept_out: &self.planner.keep_out,
        };
        look(&view)
    }

    /// After a restart, shows the trees in their earlier state before anything continues.
    pub(super) fn recall_team(&mut self) {
        if self.state.retrieval.as_ref().is_some_and(|retrieval| retrieval.team.is_some()) {
            let ticked = self.resumed_team();
            self.trees = Arc::new(TreesView::of(ticked.team.trees(), ticked.team.blackboard()));
            self.team = Some(ticked);
        }
    }

    /// Makes a new view of the trees after each tick. Only the state that the trees need to resume is recorded.
    fn note_tick(&mut self, team: &Team) {
        self.trees = Arc::new(TreesView::of(team.trees(), team.blackboard()));
        let state = team.state();
        let Some(retrieval) = self.state.retrieval.clone() else { return };
        if !retrieval.team.as_ref().is_some_and(|kept| kept.stands_as(&state)) {
            self.note_retrieval(Some(Retrieval { team: Some(state), ..retrieval }));
        }
    }

    /// Calls the operator. Nothing continues before the alarm is acknowledged and START is given.
    fn call_operator(&mut self, saying: Saying) {
        let Some(retrieval) = self.state.retrieval.clone() else { return };
        let cause = AlarmCause::Call(retrieval.luggage, saying);
        self.world.touch(Resource::Alarms);
        self.world.write(self.now.wall, Tone::Alarm, Said::Alarm(cause.clone()));
        let alarm = self.state.last_alarm.next();
        self.record(Fact::AlarmRaised(alarm, None, cause));
        self.note_retrieval(Some(Retrieval { call: Some(alarm), ..retrieval }));
        self.raise(Hold::Alarm, None);
    }

    /// Handles a piece that is in the container. The robots that fetched it still have to go out.
    pub(super) fn secured(&mut self) -> Turn {
        let Some(Retrieval { luggage, fetcher, .. }) = self.state.retrieval.clone() else { return Turn::Rest };
        self.world.touch(Resource::Luggage);
        self.world.write(self.now.wall, Tone::Info, Said::Secured(luggage));
        self.record(Fact::Secured(luggage));
        let is_outside = fetcher == Fetcher::Pair;
        self.set_retrieval_stage(if is_outside { RetrievalStage::GoingOut(None) } else { RetrievalStage::ComingHome(None) });
        Turn::Again
    }
}
