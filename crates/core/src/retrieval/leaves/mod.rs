//! The leaves of the three behaviour trees, as pure functions. They read a view and return statuses, proposals and
//! sayings. They move nothing. This file has the names and ports of the leaves, and calls their code in `ask`,
//! `drive` and `handle`.
//!
//! State that must be kept when the program ends is on the blackboard. Routes are not on the blackboard, because they
//! are planned again from the map.

mod ask;
mod drive;
mod handle;
pub(super) mod routes;

pub(super) use self::ask::seen;

use std::collections::BTreeSet;
use std::time::Duration;

use super::view::{BaseView, View};
use super::way::{Floor, Train};
use crate::arm::{ArmState, Parcel};
use crate::effect::Action;
use crate::pair::{RetrievalFault, Saying, Which};
use crate::place::Place;
use crate::units::Cell;
use behaviour_trees::{Catalogue, Direction, Leaf, LeafKind, Leaves, Port, Status, Value, ValueType};
use routes::Routes;

/// Number of consecutive failed orders of a robot after which the leaf fails. One failure may be chance, three are
/// not.
pub(crate) const MOST_FAILURES: u32 = 3;

/// Maximum time during which the two robots' reports may contradict each other on whether they hold something. They
/// report one after the other. The gripper that closes first reports what it holds only when the second gripper is
/// closed too.
pub(super) const REPORTING: Duration = Duration::from_secs(30);

/// Maximum time of one run of a leaf. Two bases with a parcel need about an hour for the way through the largest
/// hall.
const LONGEST: Duration = Duration::from_secs(4 * 3600);

/// The blackboard entry with the camera's answer. The answer stays there until the leaf has read it.
pub(super) const SEEN: &str = "parcel_seen";

named! {
    ALL by id;
    /// The leaves, with their names from the original specification.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    enum SeedLeaf {
        FindObj = "FindObj",
        CalculateGoal = "CalculateGoal",
        NearObj = "NearObj",
        ApproachObject = "ApproachObject",
        SaySomething = "SaySomething",
        DataReceived = "DataReceived",
        CheckAlignment = "CheckAlignment",
        MoveBase = "MoveBase",
        SetEe = "Set-EE",
        CloseGripper = "CloseGripper",
        Controller = "Controller",
        LiftObj = "LiftObj",
        Drop = "Drop",
        Release = "Release",
    }
}

impl SeedLeaf {
    fn described(self) -> LeafKind {
        let text = |name| Port::input(name, ValueType::Text);
        let out = |name| Port::output(name, ValueType::Text);
        let ports = match self {
            SeedLeaf::FindObj => {
                vec![text("object"), Port { direction: Direction::InOut, ..text("seen") }, out("found")]
            }
            SeedLeaf::CalculateGoal => vec![text("object"), text("found"), out("goal")],
            SeedLeaf::NearObj | SeedLeaf::ApproachObject => vec![text("base"), text("object")],
            SeedLeaf::SaySomething => vec![text("to"), text("message"), out("heard")],
            SeedLeaf::DataReceived => vec![text("data")],
            SeedLeaf::CheckAlignment => vec![text("of"), text("object")],
            SeedLeaf::MoveBase => vec![text("goal"), text("object")],
            SeedLeaf::SetEe => vec![text("object")],
            SeedLeaf::Controller => vec![text("starts")],
            SeedLeaf::CloseGripper | SeedLeaf::LiftObj | SeedLeaf::Drop | SeedLeaf::Release => Vec::new(),
        };
        match self {
            SeedLeaf::NearObj | SeedLeaf::DataReceived | SeedLeaf::CheckAlignment => LeafKind::condition(self.id(), ports),
            SeedLeaf::FindObj
            | SeedLeaf::CalculateGoal
            | SeedLeaf::ApproachObject
            | SeedLeaf::SaySomething
            | SeedLeaf::MoveBase
            | SeedLeaf::SetEe
            | SeedLeaf::CloseGripper
            | SeedLeaf::Controller
            | SeedLeaf::LiftObj
            | SeedLeaf::Drop
            | SeedLeaf::Release => LeafKind::action(self.id(), ports),
        }
    }
}

/// Returns the leaves that the trees of the pair may name.
#[must_use]
pub fn catalogue() -> Catalogue {
    Catalogue::new(SeedLeaf::ALL.into_iter().map(SeedLeaf::described).collect())
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Output {
    /// The action of each robot. If several leaves of a tick propose actions for one robot, the first one counts.
    pub(super) proposals: [Option<Action>; 2],
    pub(super) sayings: Vec<Saying>,
    /// The fault for which the last leaf failed, if only a person can correct it.
    pub(super) fault: Option<RetrievalFault>,
    /// A parcel that stands at its destination and is still in the grippers.
    pub(super) dropped: Option<Parcel>,
    pub(super) released: bool,
}

#[derive(Debug)]
pub(super) struct Performer<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) last: Option<Place>,
    pub(super) routes: &'a mut Routes,
    pub(super) output: &'a mut Output,
}

impl Leaves for Performer<'_> {
    fn tick(&mut self, leaf: &mut Leaf<'_>) -> Status {
        let Some(kind) = SeedLeaf::ALL.get(leaf.kind()).copied() else { return self.fails(RetrievalFault::Tree) };
        if leaf.elapsed() > LONGEST {
            return self.fails(RetrievalFault::TakesTooLong);
        }
        match kind {
            SeedLeaf::FindObj => self.find(leaf),
            SeedLeaf::CalculateGoal => self.calculate_goal(leaf),
            SeedLeaf::NearObj => self.near(leaf),
            SeedLeaf::ApproachObject => self.approach(leaf),
            SeedLeaf::SaySomething => self.say(leaf),
            SeedLeaf::DataReceived => answer(leaf.text(0).is_some_and(|data| !data.is_empty())),
            SeedLeaf::CheckAlignment => self.check_alignment(leaf),
            SeedLeaf::MoveBase => self.move_base(leaf),
            SeedLeaf::SetEe => self.set_end_effectors(leaf),
            SeedLeaf::CloseGripper => self.close_grippers(leaf),
            SeedLeaf::Controller => self.start_controller(leaf),
            SeedLeaf::LiftObj => self.lift(),
            SeedLeaf::Drop => self.drop(),
            SeedLeaf::Release => self.release(),
        }
    }

    /// Does nothing: a robot ends its step by itself, and the engine halts robots.
    fn halt(&mut self, _: &mut Leaf<'_>) {}
}

impl<'a> Performer<'a> {
    /// Ends the run of the pair with this fault. Only a person can correct it.
    fn fails(&mut self, fault: RetrievalFault) -> Status {
        self.output.fault = Some(fault);
        Status::Failure
    }

    fn propose(&mut self, which: Which, action: Action) {
        self.output.proposals[which.index()].get_or_insert(action);
    }

    fn base(&self, which: Which) -> &'a BaseView {
        self.view.base(which)
    }

    fn is_anybody_busy(&self) -> bool {
        Which::ALL.into_iter().any(|which| self.base(which).open.is_some())
    }

    fn arms(&self) -> [&'a ArmState; 2] {
        Which::ALL.map(|which| &self.base(which).arm)
    }

    fn places(&self) -> [Place; 2] {
        Which::ALL.map(|which| self.base(which).stands.place)
    }

    /// Returns the parcel that both arms hold. At the end of a step, the arms report the parcel's new place one after
    /// the other. If the two reports differ, SRM1's place is returned.
    fn load(&self) -> Option<Parcel> {
        let [one, two] = self.arms().map(|arm| arm.holds);
        one.filter(|one| two.is_some_and(|two| one.piece == two.piece))
    }

    /// Returns the known cells of the piece at this place, or only the cell of this place if none is known.
    fn piece(&self, at: Place) -> BTreeSet<Cell> {
        match at {
            Place::Cell(cell) if self.view.piece.contains(&cell) => self.view.piece.clone(),
            Place::Cell(cell) => BTreeSet::from([cell]),
            Place::Outside(_) => BTreeSet::new(),
        }
    }

    fn floor<'b>(&self, freed: &'b BTreeSet<Cell>, taken: &'b [Place]) -> Floor<'b>
    where
        'a: 'b,
    {
        Floor { map: self.view.map, way_out: self.view.way_out, freed, taken, kept_out: self.view.kept_out }
    }

    /// Returns the train that the two bases would form if they gripped the parcel from their present places.
    fn train(&self, parcel: Place) -> Train {
        Train { bases: self.places(), parcel }
    }
}

const fn answer(truth: bool) -> Status {
    if truth { Status::Success } else { Status::Failure }
}

/// Writes a place in the form of a blackboard entry: `3;4` in the hall, `outside;1` outside the entrance.
pub(super) fn written(place: Place) -> Value {
    Value::text(&match place {
        Place::Cell(Cell { x, y }) => format!("{x};{y}"),
        Place::Outside(steps) => format!("outside;{steps}"),
    })
}

pub(super) fn place_of(text: &str) -> Option<Place> {
    match text.split_once(';')? {
        ("outside", steps) => steps.parse().ok().filter(|steps| (1..=Place::FURTHEST).contains(steps)).map(Place::Outside),
        (x, y) => Some(Place::Cell(Cell::new(x.parse().ok()?, y.parse().ok()?))),
    }
}

fn place_in(leaf: &Leaf<'_>, port: usize) -> Option<Place> {
    place_of(leaf.text(port)?)
}

fn robot_in(leaf: &Leaf<'_>, port: usize) -> Option<Which> {
    let name = leaf.text(port)?;
    Which::ALL.into_iter().find(|which| which.name() == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_read_as_it_is_written() {
        for place in [Place::Cell(Cell::new(-3, 4)), Place::Outside(1), Place::Outside(2)] {
            assert_eq!(written(place).as_text().and_then(place_of), Some(place));
        }
        for wrong in ["", "3", "3;", "outside;0", "outside;9", "3;4;5", "none"] {
            assert_eq!(place_of(wrong), None, "{wrong}");
        }
    }
}
