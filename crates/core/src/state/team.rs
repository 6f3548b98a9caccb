//! What the team of the pair needs to go on after a restart. Routes are planned anew; where the robots stand and what they hold, they say
//! themselves.

use crate::arm::Parcel;
use crate::pair::RetrievalFault;
use crate::units::Piece;
use behaviour_trees::state::TreeState;
use behaviour_trees::{Status, Value};

/// How far the work has come.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TeamStage {
    /// The trees are at work.
    Working,
    /// The parcel is lost; it goes on when the call has been acknowledged.
    Lost,
    /// Everything has been fetched.
    Done,
    /// It cannot go on.
    Faulted(RetrievalFault),
}

/// How a team stands between two ticks.
#[derive(Clone, Debug, PartialEq)]
pub struct TeamState {
    /// SRM1, SRM2 and the Supervisor.
    pub trees: [TreeState; 3],
    /// What each of them said last.
    pub said: [Status; 3],
    /// What the entries of the blackboard hold that hold anything.
    pub blackboard: Vec<(String, Value)>,
    /// How far the work has come.
    pub stage: TeamStage,
    /// How often a parcel was lost.
    pub losses: u32,
    /// Whether this run of the Supervisor has told of a loss.
    pub has_called: bool,
    /// Put down where it was to go, and still in the grippers.
    pub dropped: Option<Parcel>,
    /// What was let go where it was to go, in order.
    pub delivered: Vec<Piece>,
    /// Runs of the Supervisor that were begun.
    pub runs: u32,
}

impl TeamState {
    /// Whether both go on alike: ticks that were counted and time that has passed aside.
    #[must_use]
    pub fn stands_as(&self, other: &TeamState) -> bool {
        let trees = self.trees.iter().zip(&other.trees).all(|(one, two)| one.stands_as(two));
        let rest = |state: &TeamState| (state.said, state.losses, state.has_called, state.dropped, state.runs);
        trees
            && rest(self) == rest(other)
            && (&self.blackboard, &self.stage, &self.delivered) == (&other.blackboard, &other.stage, &other.delivered)
    }
}
