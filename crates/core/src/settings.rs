//! The settings of the core. `config` reads them from files.

use super::search::Objective;
use super::search::costs::Costs;
use super::units::Celsius;
use crate::not_fetched::Fetcher;

named! {
    ALL by name;
    /// What the robot that searches does after a verdict of danger.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum AfterDanger {
        /// The robot comes home, and the search ends.
        #[default]
        Return = "return",
        /// The search goes on, because there may be further bombs.
        GoOn = "go_on",
    }
}

named! {
    ALL by name;
    /// How many judges a verdict of safe needs.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum SafeBy {
        #[default]
        One = "1",
        /// Two senders with different keys. The second does not see the answer of the first.
        Two = "2",
    }
}

named! {
    ALL by name;
    /// Whether a verdict of safe needs answers to the three questions about the piece.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum HotRule {
        #[default]
        Optional = "optional",
        Required = "required",
    }
}

/// The rules of the team that searches. They are recorded, because they may change between missions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    pub after_danger: AfterDanger,
    /// The radius of the keep-out ring round each located bomb, in metres. If 0, there are no rings.
    pub keep_out_m: f64,
    pub safe_by: SafeBy,
    pub hot: HotRule,
    /// Maximum number of further photos that the robot takes from other places when a judge is unsure.
    pub unsure_views: u8,
}

impl Default for Rules {
    fn default() -> Rules {
        Rules {
            after_danger: AfterDanger::default(),
            keep_out_m: 0.0,
            safe_by: SafeBy::default(),
            hot: HotRule::default(),
            unsure_views: Rules::MOST_VIEWS,
        }
    }
}

impl Rules {
    /// Widest keep-out ring, in metres. It bounds the work for each bomb.
    pub const WIDEST_M: f64 = 50.0;

    /// Most further photos for each unsure answer: one from another side, and one from two cells off.
    pub const MOST_VIEWS: u8 = 2;
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    pub rules: Rules,
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
            rules: Rules::default(),
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
