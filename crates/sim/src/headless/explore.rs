//! Runs a whole mission in simulated time and computes its figures, which the command line prints. The operator is
//! simulated too, and answers from the hall file.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{Moves, Run};
use crate::{Hall, SimSettings, Truth};
use hallsweep_core::command::{Command, LuggageRef, Strategy, Verdict};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{Cell, Piece};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::records::LuggageRecords;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Verdicts {
    /// The operator judges by the hall file: pieces that are dangerous there are called dangerous, and all others
    /// safe.
    #[default]
    Hall,
    AllSafe,
}

#[derive(Clone, Debug)]
pub struct Figures {
    pub hall: String,
    pub strategy: Strategy,
    pub seed: u64,
    /// Number of cells that the robot can reach, home included.
    pub cells: usize,
    /// Number of free cells of the hall, reachable or not.
    pub free_cells: usize,
    pub reachable_pieces: usize,
    pub pieces: usize,
    pub moves: Moves,
    /// Whether three conditions hold: every reachable cell was visited, nothing reachable is unknown, and every piece
    /// that can be touched is on record.
    pub complete: bool,
    pub home: bool,
    pub luggage: LuggageRecords,
    /// Number of moves before the robot first stood at a dangerous piece.
    pub bomb_found_at: Option<u64>,
    pub state: Arc<Snapshot>,
    /// All recorded entries. Empty if the run does not collect them.
    pub journal: Vec<Entry>,
    /// Why the mission ended early, if it did.
    pub stuck: Option<String>,
}

/// After this number of retaken photos in a row, the run counts as stuck.
const MOST_RETAKEN: u32 = 10_000;

/// Runs a mission from START to its end. `watch` is called with the state after each step of the run.
pub fn explore(
    hall: &Arc<Hall>,
    sim: SimSettings,
    settings: Settings,
    strategy: Strategy,
    verdicts: Verdicts,
    mut watch: impl FnMut(&Snapshot),
) -> Figures {
    let mut journal = Vec::new();
    let figures = explore_and_tell(hall, sim, settings, strategy, verdicts, |state, entries| {
        journal.extend_from_slice(entries);
        watch(state);
    });
    Figures { journal, ..figures }
}

/// Like `explore`, but `watch` also gets the new entries, and the entries are not collected. A journal takes a
/// hundred times the memory of the hall.
pub fn explore_and_tell(
    hall: &Arc<Hall>,
    sim: SimSettings,
    settings: Settings,
    strategy: Strategy,
    verdicts: Verdicts,
    mut watch: impl FnMut(&Snapshot, &[Entry]),
) -> Figures {
    let mut run = Run::new(Arc::clone(hall), sim, settings, strategy);
    let (mut bomb_found_at, mut inspected, mut retaken) = (None, BTreeSet::new(), 0);
    let mut tell = |run: &mut Run, state: &Snapshot| {
        for entry in &run.journal {
            if let Fact::Luggage { record, .. } = &entry.fact {
                inspected.extend(piece_at(hall, record.cell));
            }
        }
        watch(state, &run.journal);
        run.journal.clear();
    };
    let mut stuck = start(&mut run).err();
    while stuck.is_none() && !matches!(run.phase(), PhaseName::Explored | PhaseName::BombLocated | PhaseName::BagSecured) {
        let state = run.state();
        tell(&mut run, &state);
        let in_front = state.mission.inspected.and_then(|id| state.luggage(id));
        if bomb_found_at.is_none() && in_front.is_some_and(|luggage| is_bomb(luggage, hall)) {
            bomb_found_at = Some(run.moves.total());
        }
        let answer = answer(&state, hall, verdicts);
        match answer {
            Some(Command::RetakePhoto(_)) => retaken += 1,
            Some(_) => retaken = 0,
            None => {}
        }
        stuck = match answer {
            Some(Command::RetakePhoto(id)) if retaken == MOST_RETAKEN => {
                Some(format!("the photo of luggage #{id} fails again and again"))
            }
            Some(command) => run.give(command).err().map(|refused| refused.to_string()),
            None if state.mission.phase == PhaseName::Fault => state.mission.fault.as_ref().map(ToString::to_string),
            None => (!run.advance()).then(|| {
                let holds: Vec<&str> = state.mission.holds.iter().map(|hold| hold.in_words()).collect();
                if holds.is_empty() { "the mission makes no more progress".to_owned() } else { holds.join("; ") }
            }),
        };
    }
    let state = run.state();
    tell(&mut run, &state);
    figures(&mut run, hall, sim.seed, bomb_found_at, stuck, &inspected)
}

fn piece_at(hall: &Hall, cell: Cell) -> Option<Piece> {
    if let Truth::Luggage(piece) = hall.truth(cell) { Some(piece) } else { None }
}

fn start(run: &mut Run) -> Result<(), String> {
    while let Err(refused) = run.give(Command::Start) {
        let cooling = run.state().mission.holds == [Hold::Temperature];
        if !cooling || !run.advance() {
            return Err(refused.to_string());
        }
    }
    Ok(())
}

/// The operator's next command. It is a verdict on the piece in front of the robot, or a request for a new photo of
/// the piece. It is START when the mission only waits for START.
fn answer(state: &Snapshot, hall: &Hall, verdicts: Verdicts) -> Option<Command> {
    if state.mission.holds == [Hold::AwaitingStart] && state.mission.refusals.start.is_none() {
        return Some(Command::Start);
    }
    let piece = state.mission.inspected.and_then(|id| state.luggage(id)).filter(|luggage| luggage.is_pending())?;
    let verdict = if verdicts == Verdicts::Hall && is_bomb(piece, hall) { Verdict::Danger } else { Verdict::Safe };
    if verdict == Verdict::Safe && !piece.has_photo() {
        return state.mission.refusals.retake.is_none().then_some(Command::RetakePhoto(piece.id));
    }
    Some(Command::Verdict { luggage: LuggageRef::Id(piece.id), verdict, note: None, hot: Default::default() })
}

fn is_bomb(luggage: &Luggage, hall: &Hall) -> bool {
    matches!(hall.truth(luggage.cell), Truth::Luggage(piece) if hall.is_dangerous(piece))
}

fn figures(
    run: &mut Run,
    hall: &Arc<Hall>,
    seed: u64,
    bomb_found_at: Option<u64>,
    stuck: Option<String>,
    inspected: &BTreeSet<Piece>,
) -> Figures {
    let state = run.state();
    let reachable = hall.reachable();
    Figures {
        hall: hall.name().to_owned(),
        strategy: state.mission.strategy,
        seed,
        cells: reachable.len(),
        free_cells: hall.reach().free as usize,
        reachable_pieces: hall.pieces().len() - hall.unreachable_pieces().len(),
        pieces: hall.pieces().len(),
        moves: run.moves,
        complete: is_complete(&state, hall, &reachable, inspected),
        home: state.robot.pose.cell == Cell::HOME && !state.robot.off_centre,
        luggage: state.luggage.clone(),
        bomb_found_at,
        state,
        journal: Vec::new(),
        stuck,
    }
}

fn is_complete(state: &Snapshot, hall: &Hall, reachable: &BTreeSet<Cell>, inspected: &BTreeSet<Piece>) -> bool {
    let visited = reachable.iter().all(|cell| state.map.at(*cell) == Mark::Visited);
    let touched = reachable.iter().flat_map(|cell| cell.neighbours()).filter_map(|cell| piece_at(hall, cell));
    let luggage = touched.into_iter().all(|piece| inspected.contains(&piece));
    visited && luggage && state.map.frontier_size() == 0 && state.map.uninspected() == 0
}
