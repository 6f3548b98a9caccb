//! A retrieval, stage by stage. The robot that searches makes room, the others fetch the piece, and the robot that
//! searches comes home again. While the pair fetches, its behaviour trees propose its actions (`crate::retrieval`).
//! All their proposals go through the one gate.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::Engine;
use super::motion::Turn;
use crate::arm::{ArmAction, Gripper};
use crate::command::Move;
use crate::effect::Action;
use crate::mission::{Input, InputContext};
use crate::not_fetched::{Fetcher, NotFetched, StuckFault};
use crate::pair::Which;
use crate::phase::FaultCause;
use crate::place::{BasePose, Place};
use crate::retrieval::{BaseView, Floor, Gear, MOST_FAILURES, steer};
use crate::robot::{Part, RobotId};
use crate::snapshot::retrieval::RetrievalView;
use crate::state::fact::Fact;
use crate::state::{Phase, Retrieval, RetrievalStage};
use crate::units::{Cell, Heading, LuggageId};
use crate::world::hall_map::Mark;
use crate::world::keep_out::NOWHERE;
use crate::world::luggage::Luggage;
use crate::world::resource::Resource;

impl Engine {
    /// Returns the robots that fetch, according to the settings; `None` if these robots do not exist, or nobody is to
    /// fetch.
    pub(super) fn fetchers(&self) -> Option<Vec<RobotId>> {
        // A robot that has not reported its capabilities yet is assumed to have a gripper.
        let can_take = self.robots.searching().controller.capabilities.is_none_or(|can| can.parts.has(Part::Gripper));
        let fetchers = match self.settings.fetcher {
            Fetcher::Pair => Which::ALL.map(Which::robot).to_vec(),
            Fetcher::Discovery if can_take => vec![self.robots.searching_id().clone()],
            Fetcher::Discovery | Fetcher::None => return None,
        };
        fetchers.iter().all(|robot| self.robots.get(robot).is_some()).then_some(fetchers)
    }

    /// Returns the first robot of a retrieval that cannot be reached. The robot that searches counts, because it must
    /// make room even when others fetch.
    pub(super) fn unreached(&self) -> Option<RobotId> {
        let needed = self.fetchers().into_iter().flatten().chain([self.robots.searching_id().clone()]);
        let is_linked = |robot: &RobotId| self.robots.get(robot).is_some_and(|robot| robot.controller.capabilities.is_some());
        needed.into_iter().find(|robot| !is_linked(robot))
    }

    pub(super) fn is_fetching(&self, robot: &RobotId) -> bool {
        self.state.retrieval.is_some() && self.fetchers().is_some_and(|fetchers| fetchers.contains(robot))
    }

    /// Returns the first robot that is not at the place where a mission begins, if the retrieval can continue and
    /// bring this robot there. A searching robot that carries something is returned in any case.
    pub(super) fn abroad(&self, phase: &Phase) -> Option<RobotId> {
        let can_go_on = self.state.retrieval.is_some() && self.fault_stands(phase).is_none();
        let searching = Some(self.robots.searching_id().clone()).filter(|robot| self.steps_outside(robot) > 0);
        if self.robots.searching().arm.holds.is_some() {
            return Some(self.robots.searching_id().clone());
        }
        let is_inside = |robot: &RobotId| !self.searches(robot) && self.steps_outside(robot) == 0;
        searching.or_else(|| self.fetchers()?.into_iter().find(is_inside)).filter(|_| can_go_on)
    }

    pub(super) fn steps_outside(&self, robot: &RobotId) -> u8 {
        self.state.outside.get(robot).copied().unwrap_or(0)
    }

    pub(super) fn place_of(&self, robot: &RobotId) -> Place {
        match self.steps_outside(robot) {
            0 => Place::Cell(self.pose_of(robot).cell),
            steps => Place::Outside(steps),
        }
    }

    /// Begins the retrieval of the named piece, or of the dangerous piece that was found first.
    pub(super) fn begin_retrieval(&mut self, named: Option<LuggageId>) {
        let wanted = self.state.luggage.bombs_left().find(|bomb| named.is_none_or(|id| bomb.id == id)).cloned();
        let Some(bomb) = wanted else { return };
        let piece = self.cells_of(&bomb);
        let (luggage, fetcher) = (bomb.id, self.settings.fetcher);
        let stage = RetrievalStage::MakingRoom;
        self.note_retrieval(Some(Retrieval { luggage, fetcher, stage, piece, call: None, team: None }));
    }

    pub(super) fn end_retrieval(&mut self) {
        (self.team, self.trees) = (None, Arc::default());
        if self.state.retrieval.is_some() {
            self.note_retrieval(None);
        }
    }

    /// Begins a failed retrieval again, with the present knowledge. While a robot holds something, nothing changes:
    /// the robots must go out first.
    pub(super) fn retry_retrieval(&mut self) {
        let Some(retrieval) = self.state.retrieval.clone() else { return };
        let pair = Which::ALL.map(|which| self.base_view(which).arm);
        if pair.iter().chain([&self.robots.searching().arm]).any(|arm| arm.holds.is_some()) {
            return;
        }
        let has_vanished = retrieval.piece.is_empty();
        let is_alone = retrieval.fetcher == Fetcher::Discovery && retrieval.stage == RetrievalStage::Fetching;
        if retrieval.stage.reason().is_some() || has_vanished && is_alone {
            let piece = if has_vanished { self.stands_again(retrieval.luggage) } else { retrieval.piece };
            self.team = None;
            self.note_retrieval(Some(Retrieval { stage: RetrievalStage::MakingRoom, piece, team: None, ..retrieval }));
        }
    }

    /// Marks the cells where a lost piece once stood, and returns these cells. No robot holds the piece, and nobody
    /// knows where it lies, so the robots look for it there.
    fn stands_again(&mut self, luggage: LuggageId) -> BTreeSet<Cell> {
        let piece = self.state.luggage.get(luggage).map(|luggage| self.cells_of(luggage)).unwrap_or_default();
        for cell in &piece {
            self.mark(*cell, Mark::Luggage);
        }
        piece
    }

    pub(super) fn retrieval_as_it_is(&self) -> Option<Arc<RetrievalView>> {
        let Retrieval { luggage, fetcher, stage, piece, .. } = self.state.retrieval.as_ref()?;
        Some(Arc::new(RetrievalView {
            luggage: *luggage,
            fetcher: *fetcher,
            stage: stage.name(),
            reason: stage.reason().cloned(),
            piece: piece.iter().copied().collect(),
            trees: Arc::clone(&self.trees),
        }))
    }

    pub(super) fn note_retrieval(&mut self, retrieval: Option<Retrieval>) {
        self.world.touch(Resource::Retrieval);
        self.record(Fact::Retrieval(retrieval.map(Box::new)));
    }

    pub(super) fn set_retrieval_stage(&mut self, stage: RetrievalStage) {
        if let Some(retrieval) = self.state.retrieval.clone() {
            self.note_retrieval(Some(Retrieval { stage, ..retrieval }));
        }
    }

    /// Returns the cells where any robot has met this piece.
    pub(super) fn cells_of(&self, luggage: &Luggage) -> BTreeSet<Cell> {
        let same = self.state.met_again.iter().filter(|(_, piece)| luggage.piece == Some(**piece)).map(|(cell, _)| *cell);
        same.chain([luggage.cell]).collect()
    }

    /// Whether the robots have called the operator, and nobody has acknowledged the call.
    pub(super) fn is_calling(&self) -> bool {
        let call = self.state.retrieval.as_ref().and_then(|retrieval| retrieval.call);
        self.state.alarms.iter().any(|alarm| Some(alarm.id) == call && alarm.acknowledged.is_none())
    }

    pub(super) fn retrieve(&mut self) -> Turn {
        let Some(retrieval) = &self.state.retrieval else { return Turn::Rest };
        let (began, set) = (retrieval.fetcher, self.settings.fetcher);
        if began != set {
            // The robot that began the retrieval may stand anywhere, with the piece in its grip.
            self.not_fetched(NotFetched::OtherFetcher { began, set });
            return Turn::Again;
        }
        match (&retrieval.stage, retrieval.fetcher) {
            (RetrievalStage::MakingRoom, Fetcher::Pair) => self.make_room(),
            (RetrievalStage::MakingRoom, Fetcher::Discovery | Fetcher::None) => {
                self.set_retrieval_stage(RetrievalStage::Fetching);
                Turn::Again
            }
            (RetrievalStage::Fetching, Fetcher::Pair) => self.fetch(),
            (RetrievalStage::Fetching, Fetcher::Discovery) => self.fetch_alone(),
            (RetrievalStage::LettingGo, _) => self.let_go(),
            (RetrievalStage::Fetching, Fetcher::None) => Turn::Rest,
            (RetrievalStage::GoingOut(reason), _) => {
                let reason = reason.clone();
                self.go_out(reason)
            }
            (RetrievalStage::ComingHome(reason), _) => {
                let reason = reason.clone();
                self.come_home(reason)
            }
        }
    }

    fn make_room(&mut self) -> Turn {
        if self.steps_outside(self.robots.searching_id()) > 0 {
            self.set_retrieval_stage(RetrievalStage::Fetching);
            return Turn::Again;
        }
        // At the beginning of a mission, the robot stands at home with the entrance behind it.
        match self.state.pose.heading {
            Heading::South => self.order(Action::Leave),
            Heading::East => self.order(Action::Move(Move::TurnRight)),
            Heading::North | Heading::West => self.order(Action::Move(Move::TurnLeft)),
        }
    }

    /// Makes the robots that fetched set down what they hold and go back outside, one after the other.
    fn go_out(&mut self, reason: Option<NotFetched>) -> Turn {
        let bases = Which::ALL.map(|which| self.base_view(which));
        if bases.iter().any(|base| base.open.is_some()) {
            return Turn::Rest;
        }
        if bases.iter().any(|base| base.failures >= MOST_FAILURES) {
            return self.stuck(reason, StuckFault::RobotFails);
        }
        let astray = Which::ALL.into_iter().filter(|which| bases[which.index()].off_centre).collect::<Vec<_>>();
        if !astray.is_empty() {
            return self.all(&astray, Action::Recentre);
        }
        if let Some(action) = set_down(&bases) {
            return self.all(&Which::ALL, Action::Arm(action));
        }
        let stands = bases.map(|base| base.stands);
        let inside: Vec<Which> = Which::ALL.into_iter().filter(|which| stands[which.index()].place.cell().is_some()).collect();
        if inside.is_empty() {
            self.set_retrieval_stage(RetrievalStage::ComingHome(reason));
            return Turn::Again;
        }
        for which in inside.into_iter().rev() {
            let (base, taken) = (stands[which.index()], [stands[which.other().index()].place]);
            let (freed, kept_out) = (BTreeSet::new(), &self.planner.keep_out);
            let floor = Floor { map: &self.state.map, way_out: true, freed: &freed, taken: &taken, kept_out };
            // A bomb that was found meanwhile must not lock the robots in.
            let through_rings = Floor { kept_out: &NOWHERE, ..floor };
            let way = [floor, through_rings].iter().find_map(|floor| floor.approach(base.place, Place::ENTRANCE));
            if let Some(action) = way.and_then(|way| steer(base, *way.first()?, Gear::Forwards)) {
                return self.all(&[which], action);
            }
        }
        self.stuck(reason, StuckFault::NoWayOut)
    }

    /// Raises a fault, because the robots cannot go out. After START they try once more.
    fn stuck(&mut self, reason: Option<NotFetched>, fault: StuckFault) -> Turn {
        self.forget_failures();
        self.not_fetched(NotFetched::Stuck(fault, reason.map(Box::new)));
        Turn::Again
    }

    /// Resets the count of failures, so that earlier failures do not count in the next stage.
    pub(super) fn forget_failures(&mut self) {
        for which in Which::ALL {
            if let Some(robot) = self.robots.get_mut(&which.robot()) {
                robot.failures = 0;
            }
        }
    }

    fn all(&mut self, which: &[Which], action: Action) -> Turn {
        for one in which {
            self.let_through(*one, action);
        }
        Turn::Rest
    }

    /// Moves only the robot that searches, because the next mission begins with this robot at home.
    fn come_home(&mut self, reason: Option<NotFetched>) -> Turn {
        if self.steps_outside(self.robots.searching_id()) > 0 {
            return self.order(Action::Enter);
        }
        match reason {
            Some(reason) => self.not_fetched(reason),
            None => {
                self.feed(Input::Secured, &InputContext::default());
            }
        }
        Turn::Again
    }

    pub(super) fn not_fetched(&mut self, why: NotFetched) {
        self.feed(Input::NotFetched, &InputContext { fault: Some(FaultCause::NotFetched(why)), ..InputContext::default() });
    }

    /// Orders a proposed action, if the gate allows it. Otherwise the trees propose it again later.
    pub(super) fn let_through(&mut self, which: Which, action: Action) {
        let robot = which.robot();
        if self.may_do(&robot, action).is_ok() {
            self.order_of(&robot, action);
        }
    }

    pub(super) fn base_view(&self, which: Which) -> BaseView {
        let id = which.robot();
        let robot = self.robots.get(&id);
        BaseView {
            stands: BasePose { place: self.place_of(&id), heading: self.pose_of(&id).heading },
            off_centre: robot.is_some_and(|robot| robot.off_centre),
            open: robot.and_then(|robot| robot.controller.open()).map(|order| order.action),
            failures: robot.map_or(0, |robot| robot.failures),
            arm: robot.map_or_else(Default::default, |robot| robot.arm),
        }
    }
}

/// Returns the next action with which both arms release what they hold. It works from every state in which a halt may
/// leave the arms. `None` when both grippers are open.
fn set_down(bases: &[BaseView; 2]) -> Option<ArmAction> {
    let arms = bases.map(|base| base.arm);
    if arms.iter().any(|arm| arm.holds.is_some() && !arm.on_floor) {
        Some(ArmAction::Lower)
    } else {
        arms.iter().any(|arm| arm.gripper == Gripper::Closed).then_some(ArmAction::Release)
    }
}
