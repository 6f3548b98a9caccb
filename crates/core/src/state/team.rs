//! The state that the team of the pair needs to go on after a restart. Routes are planned anew; the robots themselves
//! report where they stand and what they hold.

use crate::arm::Parcel;
use crate::pair::RetrievalFault;
use crate::units::Piece;
use behaviour_trees::state::TreeState;
use behaviour_trees::{Status, Value};

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TeamStage {
    Working,
    /// The parcel is lost; work goes on when the call has been acknowledged.
    Lost,
    Done,
    Faulted(RetrievalFault),
}

#[derive(Clone, Debug, PartialEq)]
pub struct TeamState {
    /// SRM1, SRM2 and the Supervisor.
    pub trees: [TreeState; 3],
    pub said: [Status; 3],
    pub blackboard: Vec<(String, Value)>,
    pub stage: TeamStage,
    pub losses: u32,
    /// Whether this run of the Supervisor has reported a loss.
    pub has_called: bool,
    /// A parcel that stands at its destination, still in the grippers.
    pub dropped: Option<Parcel>,
    /// The pieces that were released at their destination, in order.
    pub delivered: Vec<Piece>,
    /// Number of runs of the Supervisor that have begun.
    pub runs: u32,
}

impl TeamState {
    /// Whether both states go on alike. Counted ticks and elapsed time may differ.
    #[must_use]
    pub fn stands_as(&self, other: &TeamState) -> bool {
        let trees = self.trees.iter().zip(&other.trees).all(|(one, two)| one.stands_as(two));
        let rest = |state: &TeamState| (state.said, state.losses, state.has_called, state.dropped, state.runs);
        trees
            && rest(self) == rest(other)
            && (&self.blackboard, &self.stage, &self.delivered) == (&other.blackboard, &other.stage, &other.delivered)
    }
}
