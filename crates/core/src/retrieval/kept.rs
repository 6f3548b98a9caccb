//! What the team needs to go on after a restart. Routes are planned anew; where the robots stand and what they hold, they say themselves.

use super::Parcel;
use super::leaves::routes::Routes;
use super::team::{Team, TeamStage};
use crate::behaviour::state::{StateError, TreeState};
use crate::behaviour::{Status, Value};
use crate::event::Piece;

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

impl Team {
    /// How it stands now.
    #[must_use]
    pub fn state(&self) -> TeamState {
        let held = |entry: &crate::behaviour::blackboard::Entry| Some((entry.name().to_owned(), entry.value()?.clone()));
        let [one, two, three] = &self.trees;
        TeamState {
            trees: [one.state(), two.state(), three.state()],
            said: self.said,
            blackboard: self.blackboard.entries().filter_map(held).collect(),
            stage: self.stage.clone(),
            losses: self.losses,
            has_called: self.has_called,
            dropped: self.dropped,
            delivered: self.delivered.clone(),
            runs: self.runs,
        }
    }

    /// Goes on from a state, as if there had been no restart.
    ///
    /// # Errors
    /// If it is that of other trees; then this team has still to begin.
    pub fn resume(state: TeamState) -> Result<Team, StateError> {
        Team::new().resumed(state)
    }

    /// The same with the trees of this team, which are not read again.
    ///
    /// # Errors
    /// If it is the state of other trees.
    pub fn resumed(&self, state: TeamState) -> Result<Team, StateError> {
        let mut team = self.clone();
        for (tree, kept) in team.trees.iter_mut().zip(state.trees) {
            tree.resume(kept)?;
        }
        let entries = state.blackboard.iter().map(|(name, value)| (name.as_str(), value.clone()));
        team.blackboard.restore(entries).map_err(|_| StateError::OtherTree)?;
        (team.said, team.stage, team.losses, team.has_called) = (state.said, state.stage, state.losses, state.has_called);
        (team.dropped, team.delivered, team.runs) = (state.dropped, state.delivered, state.runs);
        team.routes = Routes::default();
        Ok(team)
    }
}
