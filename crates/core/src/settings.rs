//! The settings of the core. `config` reads them from files.

use super::search::Objective;
use super::search::costs::Costs;
use super::units::Celsius;
use crate::not_fetched::Fetcher;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Temperature threshold. When the hall is hotter, nothing moves.
    pub threshold: Celsius,
    /// How far a reading must be below the threshold, in °C, before it counts as cool again.
    pub hysteresis: f64,
    /// Whether to inspect every obstacle, including walls, as the original program did.
    pub inspect_everything: bool,
    pub fetcher: Fetcher,
    pub objective: Objective,
    /// Number of cells ahead that the robot's sonar can report as free to the search. If 0, the robot finds obstacles
    /// only by driving into them.
    pub sonar_cells: u8,
    /// The cost of each move in the search. If `None`, the cost of a move is the time that the robot needs for it.
    pub costs: Option<Costs>,
    /// Whether a recognised wall also reveals the rest of its straight line, as far as the camera sees it.
    pub wall_lines: bool,
}

impl Default for Settings {
    fn default() -> Settings {
        let threshold = Celsius::new(25.0).expect("25 °C is within a thermometer's range");
        Settings {
            threshold,
            hysteresis: 1.0,
            inspect_everything: false,
            fetcher: Fetcher::Pair,
            objective: Objective::default(),
            sonar_cells: 0,
            costs: None,
            wall_lines: true,
        }
    }
}
