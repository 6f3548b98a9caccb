//! The port to the simulator, where the robots are simulated: how a door sees it, changes it while it runs, and has the robots put down in
//! another hall. What is simulated and how is not known here; whether a hall may be changed just now, the core decides.

use std::collections::BTreeSet;
use std::pin::Pin;
use std::sync::Arc;

use tokio::sync::watch;

use super::handle::Gone;
use hallsweep_core::command::{Issuer, Refused};
pub use hallsweep_core::simulated::{Change, Pace};
use hallsweep_core::units::Cell;

/// As many cells as can be blocked at once: more than anybody places by hand.
pub const MOST_BLOCKED: usize = 64;

/// The largest side of a hall that is taken while the program runs, in cells: a page must be able to draw it.
pub const MOST_SIDE: u32 = 250;

/// Whether a hall may be kept under this name: it stands in addresses and in files.
pub fn is_hall_name(name: &str) -> bool {
    let is_plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit();
    name.starts_with(is_plain) && name.len() <= 40 && name.chars().all(|letter| is_plain(letter) || letter == '-')
}

/// What somebody lets go wrong, until it is taken back.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// The link to the robot that searches is lost.
    pub link_lost: bool,
    /// It has no thermometer.
    pub no_thermometer: bool,
    /// No photo of it succeeds.
    pub camera_fails: bool,
    /// Something stands in these cells that the hall does not have.
    pub blocked: BTreeSet<Cell>,
}

/// The simulator as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatorState {
    pub hall: HallFacts,
    pub seed: u64,
    pub speed: Pace,
    pub is_paused: bool,
    pub faults: Faults,
}

/// What is said of the hall that is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct HallFacts {
    pub name: Arc<str>,
    /// Columns and rows.
    pub size: (u32, u32),
    pub cell_m: f64,
    pub pieces: usize,
    /// The whole hall, as a hall file.
    pub toml: Arc<str>,
}

/// The hall in which the robots are to be put down.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherHall {
    pub source: HallSource,
    /// Of the noise and failures of the sensors; as it was when nobody says.
    pub seed: Option<u64>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum HallSource {
    /// One that is offered by this name.
    Named(String),
    /// A hall file, whole.
    Toml(String),
}

/// Why it was not done. `Display` is the sentence a person reads.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotSimulated {
    /// The core has refused it.
    #[error(transparent)]
    Refused(#[from] Refused),
    #[error("the simulator runs: pause it first, then go on step by step")]
    NotPaused,
    #[error("no robot has anything under way: a step takes one to the end of its order; press START first")]
    NothingUnderWay,
    /// There is no such hall, or what is wrong with it.
    #[error("{0}")]
    Hall(String),
    #[error("nothing can be put into {0}: it is no free cell of this hall")]
    NoFreeCell(Cell),
    #[error("{0} cells are to be blocked, and at most {MOST_BLOCKED} can be: leave some free")]
    TooManyBlocked(usize),
    /// It is done, and would be gone after a restart.
    #[error("the robots are put down there, but the hall cannot be kept ({0}): after a restart it is the one before again")]
    NotKept(String),
    #[error("a hall is kept under a name of small letters, digits and `-`, 40 at most, and not under {0:?}")]
    NotAName(String),
    #[error("{0} is a hall of hallsweep's own or of its settings: keep yours under another name")]
    NameTaken(String),
    #[error("another hall is kept as {0}: replace it, or choose another name")]
    AnotherKept(String),
    #[error("{0} halls are kept, and more cannot be: discard one first")]
    TooManyKept(usize),
    #[error("no hall is kept without a data folder: download it, or start hallsweep with --data")]
    NoDataFolder,
    #[error("no hall is kept as {0:?}")]
    NotThere(String),
    /// What the disk says.
    #[error("{0}")]
    CannotChangeKept(String),
    #[error(transparent)]
    Gone(#[from] Gone),
}

impl NotSimulated {
    /// Too large a hall; `None` when it is not.
    pub fn too_large(width: u32, height: u32) -> Option<NotSimulated> {
        let words = || {
            format!("a hall of {width} × {height} cells is too large for the simulator's page: {MOST_SIDE} a side are the most")
        };
        (width.max(height) > MOST_SIDE).then(|| NotSimulated::Hall(words()))
    }
}

/// What becomes of a change.
pub type Changing = Pin<Box<dyn Future<Output = Result<Arc<SimulatorState>, NotSimulated>> + Send>>;

/// The simulator, as doors have it.
pub trait Simulator: Send + Sync {
    /// Always the newest state.
    fn watch(&self) -> watch::Receiver<Arc<SimulatorState>>;

    /// The names of the halls that are offered, those that are kept last.
    fn halls(&self) -> Vec<String>;

    /// The names of those that somebody has kept, and may discard.
    fn kept_halls(&self) -> Vec<String>;

    /// The hall that is offered by this name, as a hall file.
    ///
    /// # Errors
    /// There is none, or what is wrong with it.
    fn hall(&self, name: &str) -> Result<String, NotSimulated>;

    /// Changes what is named, at once, and puts it on record.
    fn change(self: Arc<Self>, change: Change, issuer: Issuer) -> Changing;

    /// Takes every robot to the end of what it has under way, while time stands still.
    fn step(self: Arc<Self>, issuer: Issuer) -> Changing;

    /// Puts the robots down at home in another hall.
    fn put_down(self: Arc<Self>, hall: OtherHall, issuer: Issuer) -> Changing;

    /// Keeps the hall of a hall file under a name; in the place of one that is kept under it only if it may replace that.
    fn keep(self: Arc<Self>, name: String, toml: String, may_replace: bool, issuer: Issuer) -> Changing;

    /// Discards a hall that is kept.
    fn discard(self: Arc<Self>, name: String, issuer: Issuer) -> Changing;
}
