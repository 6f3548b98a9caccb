//! What a team needs to go on after the program has ended: how its trees stand, what is on their blackboard, how far the work has come.
//! It is written as text, so that whoever keeps it need not know what is in it. Routes are not kept: the map tells them again.

use std::fmt;
use std::str::FromStr;

use super::arm::Parcel;
use super::fault::RetrievalFault;
use super::leaves::{place_of, written};
use super::team::{Stage, Team};
use crate::behaviour::state::{StateError, TreeState};
use crate::behaviour::{Status, Value, ValueType};
use crate::event::Piece;

/// The version of the text.
const VERSION: &str = "team 1";

/// How a team stands between two ticks.
#[derive(Clone, Debug, PartialEq)]
pub struct TeamState {
    pub(super) trees: [TreeState; 3],
    /// The entries of the blackboard that hold anything.
    pub(super) entries: Vec<(String, Value)>,
    pub(super) said: [Status; 3],
    pub(super) stage: Stage,
    pub(super) losses: u32,
    pub(super) has_called: bool,
    pub(super) dropped: Option<Parcel>,
    pub(super) delivered: Vec<Piece>,
    pub(super) runs: u32,
}

impl Team {
    /// How the team stands now.
    #[must_use]
    pub fn state(&self) -> TeamState {
        let entries = self.blackboard.entries().filter_map(|entry| Some((entry.name().to_owned(), entry.value()?.clone())));
        TeamState {
            trees: [self.trees[0].state(), self.trees[1].state(), self.trees[2].state()],
            entries: entries.collect(),
            said: self.said,
            stage: self.stage.clone(),
            losses: self.losses,
            has_called: self.has_called,
            dropped: self.dropped,
            delivered: self.delivered.clone(),
            runs: self.runs,
        }
    }

    /// Goes on from a state: the next tick is as if the program had not ended.
    ///
    /// # Errors
    /// If it is the state of other trees; then this team stands as before.
    pub fn resume(&mut self, state: TeamState) -> Result<(), StateError> {
        let mut team = self.clone();
        for (tree, kept) in team.trees.iter_mut().zip(state.trees) {
            tree.resume(kept)?;
        }
        team.blackboard.clear();
        let entries = state.entries.iter().map(|(name, value)| (name.as_str(), value.clone()));
        team.blackboard.restore(entries).map_err(|_| StateError::OtherTree)?;
        (team.said, team.stage, team.losses, team.has_called) = (state.said, state.stage, state.losses, state.has_called);
        (team.dropped, team.delivered, team.runs) = (state.dropped, state.delivered, state.runs);
        team.routes.forget();
        *self = team;
        Ok(())
    }
}

impl Stage {
    /// Its fixed word; of a fault, the fault's.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Stage::Working => "working",
            Stage::Lost => "lost",
            Stage::Done => "done",
            Stage::Faulted(fault) => fault.name(),
        }
    }

    fn named(word: &str) -> Option<Stage> {
        let plain = [Stage::Working, Stage::Lost, Stage::Done].into_iter().find(|stage| stage.word() == word);
        plain.or_else(|| RetrievalFault::ALL.into_iter().find(|fault| fault.name() == word).map(Stage::Faulted))
    }
}

impl fmt::Display for TeamState {
    /// A line of figures, one of each tree, and one of each entry.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said = self.said.map(Status::word).join(" ");
        writeln!(f, "{VERSION} {} {} {} {} {said}", self.stage.word(), self.losses, self.has_called, self.runs)?;
        match self.dropped {
            Some(Parcel { piece, place }) => writeln!(f, "dropped {} {}", piece.0, written(place))?,
            None => writeln!(f, "dropped none")?,
        }
        let delivered: Vec<String> = self.delivered.iter().map(|piece| piece.0.to_string()).collect();
        writeln!(f, "delivered {}", delivered.join(","))?;
        self.trees.iter().try_for_each(|tree| writeln!(f, "{tree}"))?;
        let mut entries = self.entries.iter();
        entries.try_for_each(|(name, value)| {
            writeln!(f, "{}\t{}\t{}", escaped(name), value.value_type().word(), escaped(&value.to_string()))
        })
    }
}

impl FromStr for TeamState {
    type Err = StateError;

    fn from_str(text: &str) -> Result<TeamState, StateError> {
        parsed(text).ok_or(StateError::Unreadable)
    }
}

fn parsed(text: &str) -> Option<TeamState> {
    let mut lines = text.split('\n');
    let words: Vec<&str> = lines.next()?.strip_prefix(VERSION)?.strip_prefix(' ')?.split(' ').collect();
    let [stage, losses, has_called, runs, srm1, srm2, supervisor] = words[..] else { return None };
    let dropped = match lines.next()?.strip_prefix("dropped ")? {
        "none" => None,
        parcel => {
            let (piece, place) = parcel.split_once(' ')?;
            Some(Parcel { piece: Piece(piece.parse().ok()?), place: place_of(place)? })
        }
    };
    let delivered = lines.next()?.strip_prefix("delivered ")?.split(',').filter(|piece| !piece.is_empty());
    let delivered = delivered.map(|piece| piece.parse().ok().map(Piece)).collect::<Option<Vec<Piece>>>()?;
    let mut tree = || lines.next()?.parse::<TreeState>().ok();
    let trees = [tree()?, tree()?, tree()?];
    let entries = lines.filter(|line| !line.is_empty()).map(entry).collect::<Option<Vec<(String, Value)>>>()?;
    Some(TeamState {
        trees,
        entries,
        said: [Status::named(srm1)?, Status::named(srm2)?, Status::named(supervisor)?],
        stage: Stage::named(stage)?,
        losses: losses.parse().ok()?,
        has_called: has_called.parse().ok()?,
        dropped,
        delivered,
        runs: runs.parse().ok()?,
    })
}

fn entry(line: &str) -> Option<(String, Value)> {
    let mut fields = line.split('\t');
    let (name, ty, value) = (fields.next()?, fields.next()?, fields.next()?);
    let ty = ValueType::ALL.into_iter().find(|known| known.word() == ty)?;
    Some((unescaped(name), Value::parse(&unescaped(value), ty)?))
}

fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('\t', "\\t").replace('\n', "\\n")
}

fn unescaped(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut letters = text.chars();
    while let Some(letter) = letters.next() {
        match letter {
            '\\' => plain.extend(match letters.next() {
                Some('t') => Some('\t'),
                Some('n') => Some('\n'),
                other => other,
            }),
            letter => plain.push(letter),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::behaviour::Blackboard;
    use crate::retrieval::Place;
    use crate::units::Cell;

    fn held(blackboard: &Blackboard) -> Vec<(String, String)> {
        blackboard.entries().filter_map(|entry| Some((entry.name().to_owned(), entry.value()?.to_string()))).collect()
    }

    #[test]
    fn a_team_goes_on_from_its_written_state() {
        let mut team = Team::new();
        team.handle_found(Some(Parcel { piece: Piece(3), place: Place::Cell(Cell::new(-1, 4)) }), None);
        team.blackboard.set("odd", Value::text("a\tb\\n\nc")).expect("any text may stand there");
        let mut state = team.state();
        (state.losses, state.stage, state.delivered) = (2, Stage::Faulted(RetrievalFault::RobotFails), vec![Piece(1), Piece(7)]);
        state.dropped = Some(Parcel { piece: Piece(9), place: Place::Outside(1) });
        let kept: TeamState = state.to_string().parse().expect("it was written so");
        assert_eq!(kept, state);
        let mut later = Team::new();
        later.resume(kept).expect("they are the same trees");
        assert_eq!(held(later.blackboard()), held(team.blackboard()));
        assert_eq!((later.delivered(), later.stage()), (&[Piece(1), Piece(7)][..], &Stage::Faulted(RetrievalFault::RobotFails)));
    }

    #[test]
    fn what_is_no_state_is_refused() {
        let text = Team::new().state().to_string();
        for (from, to) in
            [("team 1", "team 2"), ("working", "idle"), ("dropped none", "dropped 1"), ("delivered", "x"), ("IDLE", "NO")]
        {
            assert_eq!(text.replacen(from, to, 1).parse::<TeamState>(), Err(StateError::Unreadable), "{from}");
        }
        for length in 0..text.len().min(120) {
            assert!(text[..length].parse::<TeamState>().is_err(), "{length}");
        }
    }

    #[test]
    fn the_state_of_other_trees_is_refused_and_changes_nothing() {
        let file = r#"<root BTCPP_format="4"><BehaviorTree ID="T"><AlwaysSuccess/></BehaviorTree></root>"#;
        let other = Team::of([file, file, file]).expect("it is a good file");
        let mut team = Team::new();
        let before = team.state();
        assert_eq!(team.resume(other.state()), Err(StateError::OtherTree));
        assert_eq!(team.state(), before);
    }
}
