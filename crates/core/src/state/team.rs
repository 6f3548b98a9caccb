//! The state that the pair's behaviour trees need to continue after a restart. Routes are planned again. The robots
//! themselves report where they stand and what they hold.

use crate::arm::Parcel;
use crate::pair::RetrievalFault;
use crate::units::Piece;
use behaviour_trees::state::TreeState;
use behaviour_trees::{Status, Value};

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TeamStage {
    Working,
    /// The parcel is lost. Work continues after the call to the operator is acknowledged.
    Lost,
    Done,
    Faulted(RetrievalFault),
}

#[derive(Clone, Debug, PartialEq)]
pub struct TeamState {
    /// The trees of SRM1, SRM2 and the Supervisor, in this order.
    pub trees: [TreeState; 3],
    pub said: [Status; 3],
    pub blackboard: Vec<(String, Value)>,
    pub stage: TeamStage,
    pub losses: u32,
    /// Whether this run of the Supervisor has reported a loss.
    pub has_called: bool,
    /// A parcel that stands at its destination and is still in the grippers.
    pub dropped: Option<Parcel>,
    /// The pieces that were released at their destination, in order.
    pub delivered: Vec<Piece>,
    /// Number of runs of the Supervisor that have begun.
    pub runs: u32,
}

impl TeamState {
    /// Whether both states lead to the same next actions. Numbers of ticks and elapsed times may differ.
    #[must_use]
    pub fn stands_as(&self, other: &TeamState) -> bool {
        let trees = self.trees.iter().zip(&other.trees).all(|(one, two)| one.stands_as(two));
        let rest = |state: &TeamState| (state.said, state.losses, state.has_called, state.dropped, state.runs);
        trees
            && rest(self) == rest(other)
            && (&self.blackboard, &self.stage, &self.delivered) == (&other.blackboard, &other.stage, &other.delivered)
    }
}
