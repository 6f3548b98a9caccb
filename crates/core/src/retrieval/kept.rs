//! Resumes a team after a restart. Its routes are not restored; they are planned again.

use super::leaves::routes::Routes;
use super::team::Team;
use crate::state::TeamState;
use behaviour_trees::state::StateError;

impl Team {
    #[must_use]
    pub fn state(&self) -> TeamState {
        let held = |entry: &behaviour_trees::blackboard::BlackboardEntry| Some((entry.name().to_owned(), entry.value()?.clone()));
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

    /// Returns the team in this state, as if there had been no restart.
    ///
    /// # Errors
    /// If the state belongs to other trees. The caller must then use a new team.
    pub fn resume(state: TeamState) -> Result<Team, StateError> {
        Team::new().resumed(state)
    }

    /// Returns the team in this state. It takes the trees of this team, so the files of the trees are not read again.
    ///
    /// # Errors
    /// If the state belongs to other trees.
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
