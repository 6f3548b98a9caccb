//! The port to the simulator. Through this port a door sees the simulator, changes it while it runs, and moves the
//! robots to another hall. The simulation itself is not known here. The core decides whether the hall may be changed
//! now.

use std::collections::BTreeSet;
use std::pin::Pin;
use std::sync::Arc;

use tokio::sync::watch;

use super::handle::Gone;
use hallsweep_core::command::Issuer;
use hallsweep_core::refused::Refused;
pub use hallsweep_core::simulated::Change;
pub use hallsweep_core::speed::Speed;
use hallsweep_core::units::Cell;

/// Maximum number of cells with an added obstacle. Nobody places more obstacles by hand.
pub const MOST_BLOCKED: usize = 64;

/// Maximum side of a hall that is loaded while the program runs, in cells. A page must be able to draw the hall.
pub const MOST_SIDE: u32 = 250;

/// Whether a hall may be stored under this name. The name appears in addresses and in file names.
pub fn is_hall_name(name: &str) -> bool {
    let is_plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit();
    name.starts_with(is_plain) && name.len() <= 40 && name.chars().all(|letter| is_plain(letter) || letter == '-')
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// The searching robot's link is lost.
    pub link_lost: bool,
    /// The searching robot has no thermometer.
    pub no_thermometer: bool,
    /// Every photo of the searching robot fails.
    pub camera_fails: bool,
    /// Cells with an added obstacle, which the hall itself does not have.
    pub blocked: BTreeSet<Cell>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SimulatorState {
    pub hall: HallFacts,
    pub seed: u64,
    pub speed: Speed,
    pub is_paused: bool,
    pub faults: Faults,
}

#[derive(Clone, Debug, PartialEq)]
pub struct HallFacts {
    pub name: Arc<str>,
    /// Number of columns and number of rows.
    pub size: (u32, u32),
    pub cell_m: f64,
    pub pieces: usize,
    pub toml: Arc<str>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct OtherHall {
    pub source: HallSource,
    /// Seed of the sensors' noise and failures; unchanged when `None`.
    pub seed: Option<u64>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum HallSource {
    Named(String),
    Toml(String),
}

/// Why a request failed. `Display` is the message for a person.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotSimulated {
    #[error(transparent)]
    Refused(#[from] Refused),
    #[error("the simulator runs: pause it first, then go on step by step")]
    NotPaused,
    #[error("no robot has an order under way that a step could complete: press START first")]
    NothingUnderWay,
    /// The hall does not exist or is faulty, with the reason.
    #[error("{0}")]
    Hall(String),
    #[error("the cell {0} cannot be blocked: it is no free cell of this hall")]
    NoFreeCell(Cell),
    #[error("{0} blocked cells are too many: the maximum is {MOST_BLOCKED}")]
    TooManyBlocked(usize),
    /// The robots were moved, but the choice of the hall could not be stored. After a restart, the previous hall is
    /// used.
    #[error("the robots are in the new hall, but the choice could not be stored ({0}): a restart returns to the previous hall")]
    NotKept(String),
    #[error("{0:?} is no name for a hall: use at most 40 small letters, digits and `-`")]
    NotAName(String),
    #[error("the name {0} belongs to a hall of hallsweep or of its settings: choose another name")]
    NameTaken(String),
    #[error("another hall is stored as {0}: replace that hall, or choose another name")]
    AnotherKept(String),
    #[error("{0} halls are stored, which is the maximum: discard a hall first")]
    TooManyKept(usize),
    #[error("a hall can be stored only in a data folder: download the hall, or start hallsweep with --data")]
    NoDataFolder,
    #[error("no hall is stored as {0:?}")]
    NotThere(String),
    #[error("{0}")]
    CannotChangeKept(String),
    #[error(transparent)]
    Gone(#[from] Gone),
}

impl NotSimulated {
    pub fn too_large(width: u32, height: u32) -> Option<NotSimulated> {
        let words = || {
            format!("a hall of {width} × {height} cells is too large for the simulator's page: the maximum is {MOST_SIDE} a side")
        };
        (width.max(height) > MOST_SIDE).then(|| NotSimulated::Hall(words()))
    }
}

pub type Changing = Pin<Box<dyn Future<Output = Result<Arc<SimulatorState>, NotSimulated>> + Send>>;

pub trait Simulator: Send + Sync {
    fn watch(&self) -> watch::Receiver<Arc<SimulatorState>>;

    /// Names of the offered halls, the stored halls last.
    fn halls(&self) -> Vec<String>;

    fn kept_halls(&self) -> Vec<String>;

    /// Returns the offered hall of this name, as a hall file. Fails if there is no such hall, or if the hall is
    /// faulty.
    fn hall(&self, name: &str) -> Result<String, NotSimulated>;

    /// Applies the fields that are set in `change`, and records them.
    fn change(self: Arc<Self>, change: Change, issuer: Issuer) -> Changing;

    /// Lets every robot finish its present action. Works only while the simulation is paused.
    fn step(self: Arc<Self>, issuer: Issuer) -> Changing;

    /// Moves the robots to their homes in another hall.
    fn put_down(self: Arc<Self>, hall: OtherHall, issuer: Issuer) -> Changing;

    /// Stores a hall file under a name. A stored hall of this name is replaced only if `may_replace` is true.
    fn keep(self: Arc<Self>, name: String, toml: String, may_replace: bool, issuer: Issuer) -> Changing;

    fn discard(self: Arc<Self>, name: String, issuer: Issuer) -> Changing;
}
