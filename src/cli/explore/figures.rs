//! The result of a mission, as JSON for programs and as a table for people.

use serde::Serialize;

use crate::api::robot::PositionJson;
use crate::api::time::rfc3339;
use hallsweep_core::world::luggage::Luggage;
use hallsweep_sim::headless::Figures;

#[derive(Serialize)]
struct FiguresJson<'a> {
    hall: &'a str,
    strategy: &'static str,
    seed: u64,
    /// Reachable cells, including home.
    cells: usize,
    free_cells: usize,
    /// Number of pieces of luggage that can be reached; `pieces` counts all pieces.
    reachable_pieces: usize,
    pieces: usize,
    steps: u64,
    turns: u64,
    bumps: u64,
    moves_per_cell: f64,
    /// Whether every reachable cell was visited and every reachable piece inspected.
    complete: bool,
    home: bool,
    luggage: Vec<PieceJson>,
    /// Number of moves until a dangerous piece was met; null if no dangerous piece was met.
    bomb_found_at_moves: Option<u64>,
}

/// A piece of luggage without its photo, which a run without doors does not render.
#[derive(Serialize)]
struct PieceJson {
    id: u64,
    verdict: &'static str,
    cell: PositionJson,
    position: PositionJson,
    heading: &'static str,
    taken: String,
}

pub(super) fn json(figures: &Figures) -> String {
    let shape = FiguresJson::from(figures);
    serde_json::to_string(&shape).expect("figures are numbers and strings, which JSON can hold")
}

pub(super) fn table(figures: &Figures) -> String {
    let Figures { hall, strategy, seed, cells, free_cells, moves, home, luggage, bomb_found_at, .. } = figures;
    let Figures { reachable_pieces, pieces, .. } = figures;
    let is_partial = cells < free_cells || reachable_pieces < pieces;
    let completeness = match figures.complete {
        true if is_partial => "yes, as far as can be reached from the start",
        true => "yes",
        false => "no",
    };
    let yes = |is_so: &bool| if *is_so { "yes" } else { "no" };
    let dangerous: Vec<String> =
        luggage.iter().filter(|piece| piece.is_dangerous()).map(|piece| format!("#{} at {}", piece.id, piece.cell)).collect();
    let rows = [
        ("hall", hall.clone()),
        ("strategy", strategy.name().to_owned()),
        ("seed", seed.to_string()),
        ("cells", format!("{cells} of {free_cells} free cells can be reached from the start")),
        ("steps", moves.steps.to_string()),
        ("turns", moves.turns.to_string()),
        ("bumps", moves.bumps.to_string()),
        ("moves per cell", format!("{:.2}", moves_per_cell(figures))),
        ("pieces", format!("{reachable_pieces} of {pieces} pieces of luggage can be reached from the start")),
        ("luggage", luggage.len().to_string()),
        ("dangerous", if dangerous.is_empty() { "none".to_owned() } else { dangerous.join(", ") }),
        ("bomb met after", bomb_found_at.map_or_else(|| "-".to_owned(), |moves| format!("{moves} moves"))),
        ("complete", completeness.to_owned()),
        ("home", yes(home).to_owned()),
    ];
    rows.map(|(name, value)| format!("{name:<16}{value}")).join("\n")
}

#[expect(clippy::cast_precision_loss, reason = "no mission makes 2^53 moves")]
fn moves_per_cell(figures: &Figures) -> f64 {
    figures.moves.total() as f64 / figures.cells.max(1) as f64
}

impl<'a> From<&'a Figures> for FiguresJson<'a> {
    fn from(figures: &'a Figures) -> FiguresJson<'a> {
        FiguresJson {
            hall: &figures.hall,
            strategy: figures.strategy.name(),
            seed: figures.seed,
            cells: figures.cells,
            free_cells: figures.free_cells,
            reachable_pieces: figures.reachable_pieces,
            pieces: figures.pieces,
            steps: figures.moves.steps,
            turns: figures.moves.turns,
            bumps: figures.moves.bumps,
            moves_per_cell: moves_per_cell(figures),
            complete: figures.complete,
            home: figures.home,
            luggage: figures.luggage.iter().map(|piece| PieceJson::from(&**piece)).collect(),
            bomb_found_at_moves: figures.bomb_found_at,
        }
    }
}

impl From<&Luggage> for PieceJson {
    fn from(piece: &Luggage) -> PieceJson {
        PieceJson {
            id: piece.id.0,
            verdict: piece.verdict_name(),
            cell: piece.cell.into(),
            position: piece.pose.cell.into(),
            heading: piece.pose.heading.name(),
            taken: rfc3339(piece.taken),
        }
    }
}
