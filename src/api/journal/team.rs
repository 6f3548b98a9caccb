//! The behaviour trees of the robot pair in the journal, after each tick that changed something. After a restart, the
//! trees continue from this record. A run can also be replayed from it.

use serde::{Deserialize, Serialize};

use super::Unparsed;
use super::places::Point;
use behaviour_trees::{Status, Value, ValueType};
use hallsweep_core::arm::Parcel;
use hallsweep_core::pair::RetrievalFault;
use hallsweep_core::place::Place;
use hallsweep_core::state::{TeamStage, TeamState};
use hallsweep_core::units::Piece;

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TeamShape {
    /// The states of the trees SRM1, SRM2 and Supervisor, one line each.
    trees: [String; 3],
    said: [String; 3],
    /// Name, type and value of each entry of the blackboard.
    blackboard: Vec<[String; 3]>,
    stage: StageShape,
    losses: u32,
    has_called: bool,
    dropped: Option<ParcelShape>,
    delivered: Vec<u32>,
    runs: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
enum StageShape {
    Working,
    Lost,
    Done,
    Faulted(String),
}

#[derive(Serialize, Deserialize)]
struct ParcelShape {
    piece: u32,
    place: PlaceShape,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
enum PlaceShape {
    Cell(Point),
    Outside(u8),
}

impl From<&TeamState> for TeamShape {
    fn from(team: &TeamState) -> TeamShape {
        let entry = |(name, value): &(String, Value)| [name.clone(), value.value_type().word().to_owned(), value.to_string()];
        TeamShape {
            trees: team.trees.each_ref().map(ToString::to_string),
            said: team.said.map(|status| status.word().to_owned()),
            blackboard: team.blackboard.iter().map(entry).collect(),
            stage: match &team.stage {
                TeamStage::Working => StageShape::Working,
                TeamStage::Lost => StageShape::Lost,
                TeamStage::Done => StageShape::Done,
                TeamStage::Faulted(fault) => StageShape::Faulted(fault.name().to_owned()),
            },
            losses: team.losses,
            has_called: team.has_called,
            dropped: team.dropped.map(ParcelShape::from),
            delivered: team.delivered.iter().map(|piece| piece.0).collect(),
            runs: team.runs,
        }
    }
}

impl TeamShape {
    pub(super) fn team(self) -> Result<TeamState, Unparsed> {
        let unparsed = |what: &str| Unparsed(format!("the pair's trees: {what}"));
        let tree = |text: &String| text.parse().map_err(|error| unparsed(&format!("{error}")));
        let status = |word: &String| Status::named(word).ok_or_else(|| unparsed(&format!("a node has no status {word:?}")));
        let [one, two, three] = &self.trees;
        let [first, second, third] = &self.said;
        Ok(TeamState {
            trees: [tree(one)?, tree(two)?, tree(three)?],
            said: [status(first)?, status(second)?, status(third)?],
            blackboard: self
                .blackboard
                .into_iter()
                .map(entry)
                .collect::<Option<_>>()
                .ok_or_else(|| unparsed("a blackboard entry is not valid"))?,
            stage: self.stage.stage().ok_or_else(|| unparsed("the stage of the pair is not valid"))?,
            losses: self.losses,
            has_called: self.has_called,
            dropped: self.dropped.map(Parcel::from),
            delivered: self.delivered.into_iter().map(Piece).collect(),
            runs: self.runs,
        })
    }
}

fn entry([name, kind, text]: [String; 3]) -> Option<(String, Value)> {
    let kind = ValueType::ALL.into_iter().find(|known| known.word() == kind)?;
    Some((name, Value::parse(&text, kind)?))
}

impl StageShape {
    fn stage(self) -> Option<TeamStage> {
        Some(match self {
            StageShape::Working => TeamStage::Working,
            StageShape::Lost => TeamStage::Lost,
            StageShape::Done => TeamStage::Done,
            StageShape::Faulted(name) => TeamStage::Faulted(RetrievalFault::ALL.into_iter().find(|fault| fault.name() == name)?),
        })
    }
}

impl From<Parcel> for ParcelShape {
    fn from(parcel: Parcel) -> ParcelShape {
        let place = match parcel.place {
            Place::Cell(cell) => PlaceShape::Cell(cell.into()),
            Place::Outside(steps) => PlaceShape::Outside(steps),
        };
        ParcelShape { piece: parcel.piece.0, place }
    }
}

impl From<ParcelShape> for Parcel {
    fn from(parcel: ParcelShape) -> Parcel {
        let place = match parcel.place {
            PlaceShape::Cell(point) => Place::Cell(point.into()),
            PlaceShape::Outside(steps) => Place::Outside(steps),
        };
        Parcel { piece: Piece(parcel.piece), place }
    }
}
