//! The team: the behaviour trees of SRM1, SRM2 and the Supervisor on one blackboard, ticked in this order. The team
//! also handles the end of each tree. It moves nothing and calls nobody. The engine ticks the team, announces its
//! sayings, and passes its proposals through a gate.
//!
//! ```text
//!   view ─► SRM1 ─► SRM2 ─► Supervisor ─► proposals, sayings
//!             └───────┴── blackboard ┘        │
//!   SUCCESS of the Supervisor: it runs again while anything is left to fetch (phase 8), else Done
//!   FAILURE: a named fault, or the parcel is lost: after an acknowledged call the Supervisor runs again where it lies
//! ```
//! While anything holds the robots, the team is not ticked, so its time is paused.

use std::time::Duration;

use super::leaves::routes::Routes;
use super::leaves::{Output, Performer, REPORTING, catalogue, place_of, seen, written};
use super::view::{Proposal, View};
use crate::arm::Parcel;
use crate::pair::{RetrievalFault, Saying, Which};
use crate::state::TeamStage;
use crate::units::Piece;
use behaviour_trees::{Blackboard, Status, Tree, TreeError, xml};

pub const TICK: Duration = Duration::from_millis(100);

/// Number of losses of one parcel after which the grippers or the parcel count as faulty.
pub const MOST_LOSSES: u32 = 10;

pub const FILES: [(&str, &str); 3] = [
    ("scenario1-SRM1", include_str!("../../../../config/behaviours/scenario1-SRM1.xml")),
    ("scenario1-SRM2", include_str!("../../../../config/behaviours/scenario1-SRM2.xml")),
    ("scenario1-Supervisor", include_str!("../../../../config/behaviours/scenario1-Supervisor.xml")),
];

/// The blackboard entry with the parcel's place. The entry is updated while the parcel is carried. If the parcel
/// falls when the program ends, it is found again with this entry.
const PARCEL: &str = "parcel";

const SUPERVISOR: usize = 2;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TickOutcome {
    /// The proposed actions, at most one for each robot.
    pub proposals: Vec<Proposal>,
    pub sayings: Vec<Saying>,
}

#[derive(Clone, Debug)]
pub struct Team {
    pub(super) trees: [Tree; 3],
    pub(super) blackboard: Blackboard,
    pub(super) routes: Routes,
    pub(super) said: [Status; 3],
    pub(super) stage: TeamStage,
    pub(super) losses: u32,
    /// Whether the tree of the Supervisor has reported the loss in this run.
    pub(super) has_called: bool,
    /// A parcel that stands at its destination and is still in the grippers.
    pub(super) dropped: Option<Parcel>,
    pub(super) delivered: Vec<Piece>,
    /// Number of runs of the Supervisor that have begun.
    pub(super) runs: u32,
    words: Option<String>,
    /// How long the two robots have disagreed on whether they hold something.
    waited: Duration,
}

impl Team {
    #[must_use]
    pub fn new() -> Team {
        Team::of(FILES.map(|(_, file)| file)).expect("a test builds the trees of the shipped files")
    }

    /// Reads the trees of SRM1, SRM2 and the Supervisor from these files.
    ///
    /// # Errors
    /// The fault of the first file that is not a tree of these leaves.
    pub fn of(files: [&str; 3]) -> Result<Team, TreeError> {
        let mut blackboard = Blackboard::new();
        let catalogue = catalogue();
        let mut build = |file: &str| Tree::build(&xml::read(file)?, None, &catalogue, &mut blackboard);
        let trees = [build(files[0])?, build(files[1])?, build(files[2])?];
        Ok(Team {
            trees,
            blackboard,
            routes: Routes::default(),
            said: [Status::Idle; 3],
            stage: TeamStage::Working,
            losses: 0,
            has_called: false,
            dropped: None,
            delivered: Vec::new(),
            runs: 0,
            words: None,
            waited: Duration::ZERO,
        })
    }

    pub fn handle_found(&mut self, found: Option<Parcel>, wanted: Option<Piece>) {
        let (entry, value) = seen(found.filter(|parcel| wanted.is_none_or(|wanted| wanted == parcel.piece)));
        // Cannot fail: the entry is for texts, and the text is short.
        let _ = self.blackboard.set(entry, value);
    }

    /// Ticks the three trees once, `since_last` after the previous tick. Does nothing if the work is done or cannot
    /// continue.
    pub fn tick(&mut self, view: &View<'_>, since_last: Duration) -> TickOutcome {
        let mut outcome = TickOutcome::default();
        match self.stage {
            TeamStage::Lost if !view.is_calling => self.stage = TeamStage::Working,
            TeamStage::Done | TeamStage::Faulted(_) | TeamStage::Lost => return outcome,
            TeamStage::Working => {}
        }
        let [one, two] = view.bases.map(|base| base.arm.holds);
        if let Some(parcel) = one.filter(|_| one == two) {
            // If the trees have no such entry, they do not need it.
            let _ = self.blackboard.set(PARCEL, written(parcel.place));
        }
        let mut output = Output::default();
        for index in 0..self.trees.len() {
            if self.stage == TeamStage::Working && !(index == SUPERVISOR && self.waits_to_begin(view, since_last)) {
                self.tick_tree(index, view, since_last, &mut output, &mut outcome);
            }
        }
        let proposals = Which::ALL.into_iter().zip(output.proposals);
        outcome.proposals = proposals.filter_map(|(which, action)| Some(Proposal { which, action: action? })).collect();
        outcome
    }

    /// Whether the next run must wait. The two robots report separately, so after a loss one robot may still report
    /// that it holds the parcel. No run begins until both reports agree. If they still disagree after `REPORTING`,
    /// that is a fault.
    fn waits_to_begin(&mut self, view: &View<'_>, since_last: Duration) -> bool {
        let [one, two] = view.bases.map(|base| base.arm.holds.is_some());
        let waits = self.said[SUPERVISOR] != Status::Running && one != two;
        self.waited = if waits { self.waited.saturating_add(since_last) } else { Duration::ZERO };
        if self.waited > REPORTING {
            self.stage = TeamStage::Faulted(RetrievalFault::NotAligned);
        }
        waits
    }

    fn tick_tree(&mut self, index: usize, view: &View<'_>, since_last: Duration, output: &mut Output, outcome: &mut TickOutcome) {
        // The trees of the two robots end when both are at the pallet.
        if index != SUPERVISOR && self.said[index] == Status::Success {
            return;
        }
        if index == SUPERVISOR && self.said[index] != Status::Running {
            (self.runs, self.has_called) = (self.runs.saturating_add(1), false);
        }
        (output.fault, output.dropped, output.released) = (None, None, false);
        let last = self.blackboard.get(PARCEL).and_then(|place| place_of(place.as_text()?));
        let mut performer = Performer { view, last, routes: &mut self.routes, output };
        let mut said = match self.trees[index].tick(&mut self.blackboard, &mut performer, since_last) {
            Ok(said) => said,
            Err(fault) => {
                self.words = Some(fault.to_string());
                performer.output.fault = Some(RetrievalFault::Tree);
                Status::Failure
            }
        };
        if performer.output.fault.is_some() && said == Status::Running {
            // The other leaves of this tree are halted. They would only delay the end, and the reason of the failure
            // would then be forgotten.
            self.trees[index].halt(&mut self.blackboard, &mut performer);
            performer.output.sayings.clear();
            said = Status::Failure;
        }
        self.said[index] = said;
        self.has_called |= index == SUPERVISOR && output.sayings.contains(&Saying::PackageLost);
        outcome.sayings.append(&mut output.sayings);
        self.dropped = output.dropped.or(self.dropped);
        if output.released {
            self.delivered.extend(self.dropped.take().map(|parcel| parcel.piece));
            self.losses = 0;
        }
        self.follow(index, said, output.fault, view, outcome);
    }

    fn follow(&mut self, index: usize, said: Status, fault: Option<RetrievalFault>, view: &View<'_>, outcome: &mut TickOutcome) {
        match (said, fault) {
            (Status::Failure, Some(fault)) => self.stage = TeamStage::Faulted(fault),
            (Status::Failure, None) if index == SUPERVISOR => self.lose(outcome),
            (Status::Success, _) if index == SUPERVISOR && view.piece.is_empty() => self.stage = TeamStage::Done,
            (Status::Success | Status::Failure | Status::Running | Status::Skipped | Status::Idle, _) => {}
        }
    }

    /// Handles a failure of the Supervisor without a named fault. The parcel is not in the grippers, although it
    /// should be there.
    fn lose(&mut self, outcome: &mut TickOutcome) {
        self.routes.forget();
        self.dropped = None;
        self.losses = self.losses.saturating_add(1);
        if self.losses > MOST_LOSSES {
            self.stage = TeamStage::Faulted(RetrievalFault::LostTooOften);
        } else if !self.has_called {
            outcome.sayings.push(Saying::PackageLost);
            self.stage = TeamStage::Lost;
        }
    }

    #[must_use]
    pub const fn stage(&self) -> &TeamStage {
        &self.stage
    }

    /// Returns the trees in the order SRM1, SRM2, Supervisor.
    #[must_use]
    pub const fn trees(&self) -> &[Tree; 3] {
        &self.trees
    }

    /// Returns the last status of each tree; IDLE before its first tick.
    #[must_use]
    pub const fn said(&self) -> [Status; 3] {
        self.said
    }

    #[must_use]
    pub const fn blackboard(&self) -> &Blackboard {
        &self.blackboard
    }

    #[must_use]
    pub fn delivered(&self) -> &[Piece] {
        &self.delivered
    }

    #[must_use]
    pub const fn losses(&self) -> u32 {
        self.losses
    }

    #[must_use]
    pub const fn runs(&self) -> u32 {
        self.runs
    }

    #[must_use]
    pub fn words(&self) -> Option<&str> {
        self.words.as_deref()
    }
}

impl Default for Team {
    fn default() -> Team {
        Team::new()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::arm::ArmState;
    use crate::effect::Action;
    use crate::place::{BasePose, Place};
    use crate::retrieval::BaseView;
    use crate::units::{Cell, Heading, Revision};
    use crate::world::hall_map::HallMap;
    use crate::world::keep_out::NOWHERE;

    fn ticked(team: &mut Team, places: [Place; 2], piece: Option<Cell>, failures: u32) -> TickOutcome {
        ticked_holding(team, places, piece, failures, [None; 2])
    }

    fn ticked_holding(
        team: &mut Team,
        places: [Place; 2],
        piece: Option<Cell>,
        failures: u32,
        holds: [Option<Parcel>; 2],
    ) -> TickOutcome {
        let map = HallMap::new(Cell::HOME, Revision(0));
        let piece: BTreeSet<Cell> = piece.into_iter().collect();
        let base = |index: usize| BaseView {
            stands: BasePose { place: places[index], heading: Heading::East },
            off_centre: false,
            open: None,
            failures,
            arm: ArmState { holds: holds[index], ..ArmState::default() },
        };
        let view = View {
            map: &map,
            way_out: true,
            others: &[],
            piece: &piece,
            wanted: Some(Piece(7)),
            target: Place::ENTRANCE,
            bases: [base(0), base(1)],
            is_calling: false,
            kept_out: &NOWHERE,
        };
        team.tick(&view, TICK)
    }

    fn seen(team: &Team) -> Option<&str> {
        team.blackboard().get(super::super::leaves::SEEN)?.as_text()
    }

    #[test]
    fn no_run_begins_while_one_robot_still_says_that_it_holds_what_the_other_has_lost() {
        let mut team = Team::new();
        let parcel = Parcel { piece: Piece(7), place: Place::Cell(Cell::new(2, 0)) };
        for holds in [[Some(parcel), None], [None, Some(parcel)]] {
            ticked_holding(&mut team, [Place::ENTRANCE; 2], Some(Cell::new(2, 0)), 0, holds);
            assert_eq!(team.runs(), 0);
        }
        ticked(&mut team, [Place::ENTRANCE; 2], Some(Cell::new(2, 0)), 0);
        assert_eq!(team.runs(), 1);
    }

    #[test]
    fn two_robots_that_never_agree_whether_they_hold_something_are_a_fault() {
        let mut team = Team::new();
        let parcel = Parcel { piece: Piece(7), place: Place::Cell(Cell::new(2, 0)) };
        let mut tick = |holds| {
            ticked_holding(&mut team, [Place::ENTRANCE; 2], Some(Cell::new(2, 0)), 0, holds);
            team.stage().clone()
        };
        let ticks = REPORTING.as_millis() / TICK.as_millis();
        assert!((0..ticks).all(|_| tick([Some(parcel), None]) == TeamStage::Working), "they have so long");
        assert_eq!(tick([Some(parcel), None]), TeamStage::Faulted(RetrievalFault::NotAligned));
    }

    #[test]
    fn a_parcel_whose_fall_nobody_has_heard_of_is_looked_for_where_it_was_carried() {
        let mut team = Team::new();
        let corner = [Place::Cell(Cell::new(1, 0)), Place::Cell(Cell::new(2, 1))];
        let over = Parcel { piece: Piece(7), place: Place::Cell(Cell::new(2, 0)) };
        ticked_holding(&mut team, corner, None, 0, [Some(over); 2]);
        let mut team = Team::resume(team.state()).unwrap();
        (team.said, team.stage) = ([Status::Success, Status::Success, Status::Failure], TeamStage::Working);
        let outcome = (0..3).map(|_| ticked(&mut team, corner, None, 0)).find(|outcome| !outcome.proposals.is_empty()).unwrap();
        let look = Action::Arm(crate::arm::ArmAction::FindParcel(over.place));
        assert_eq!(outcome.proposals, [Proposal { which: Which::Srm1, action: look }]);
    }

    #[test]
    fn another_piece_than_the_one_it_was_sent_for_counts_as_not_recognised() {
        let mut team = Team::new();
        let found = |piece| Some(Parcel { piece: Piece(piece), place: Place::Cell(Cell::new(3, 4)) });
        team.handle_found(found(6), Some(Piece(7)));
        assert_eq!(seen(&team), Some("none"));
        team.handle_found(found(7), Some(Piece(7)));
        assert_eq!(seen(&team), Some("3;4"));
        team.handle_found(found(6), None);
        assert_eq!(seen(&team), Some("3;4"), "any will do");
    }

    #[test]
    fn srm1_comes_in_first_and_srm2_stays_until_it_has_been_told_where_to() {
        let mut team = Team::new();
        let outcome = ticked(&mut team, [Place::ENTRANCE; 2], Some(Cell::new(3, 3)), 0);
        assert_eq!(outcome.proposals, [Proposal { which: Which::Srm1, action: Action::Enter }]);
        assert_eq!(team.said(), [Status::Running, Status::Failure, Status::Running]);
    }

    #[test]
    fn what_cannot_be_done_is_a_fault_with_a_name_and_nothing_is_proposed_any_more() {
        for (piece, failures, fault) in
            [(None, 0, RetrievalFault::NothingToFetch), (Some(Cell::new(3, 3)), 3, RetrievalFault::RobotFails)]
        {
            let mut team = Team::new();
            ticked(&mut team, [Place::ENTRANCE; 2], piece, failures);
            assert_eq!(team.stage(), &TeamStage::Faulted(fault));
            assert_eq!(ticked(&mut team, [Place::ENTRANCE; 2], Some(Cell::new(3, 3)), 0), TickOutcome::default());
        }
    }

    #[test]
    fn both_beside_the_piece_have_nothing_to_drive_and_the_camera_looks() {
        let mut team = Team::new();
        let places = [Place::Cell(Cell::new(2, 3)), Place::Cell(Cell::new(4, 3))];
        let looks: Vec<Action> = (0..3)
            .flat_map(|_| ticked(&mut team, places, Some(Cell::new(3, 3)), 0).proposals)
            .map(|proposal| proposal.action)
            .collect();
        assert!(!looks.is_empty(), "the Supervisor is past the barrier");
        let wanted = Action::Arm(crate::arm::ArmAction::FindParcel(Place::Cell(Cell::new(3, 3))));
        assert!(looks.iter().all(|action| *action == wanted), "{looks:?}");
    }
}
