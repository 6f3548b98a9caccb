//! What can be set of the simulated pair, and what is to go wrong with it. How fast simulated time runs is not here.

use std::time::Duration;

use hallsweep_core::place::Place;

/// The settings of a simulated pair. Times are in simulated time.
#[derive(Clone, Debug, PartialEq)]
pub struct PairSettings {
    /// The seed of its noise and failures.
    pub seed: u64,
    /// How long a step of one place takes a base without a load.
    pub step: Duration,
    /// How long it takes with one: a parcel is carried at a walking pace.
    pub loaded_step: Duration,
    /// How long a turn of 90° takes.
    pub turn: Duration,
    /// How long a look for a parcel takes.
    pub look: Duration,
    /// How long a movement of the arm takes.
    pub arm: Duration,
    /// How likely a look recognises no parcel although there is one, 0–1.
    pub unrecognised_rate: f64,
    /// Whether there is a way out at home.
    pub way_out: bool,
    /// The place where what is let go is taken in for good: the target area, or the container.
    pub container: Place,
    /// What is to go wrong.
    pub mishaps: Mishaps,
}

/// What is to go wrong, each once. Parcels are counted from 1: the first is the one that is under way while none has arrived.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mishaps {
    /// Parcels that slip out of the grippers.
    pub slips: Vec<Slip>,
    /// Parcels that are not recognised when they are looked for.
    pub unrecognised: Vec<u32>,
    /// Parcels round which a gripper does not close, however often it tries.
    pub jams: Vec<u32>,
}

/// When a parcel is to slip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slip {
    /// Which parcel, counted from 1.
    pub parcel: u32,
    /// In the middle of the step after so many, or of the last step where the way is shorter; 0 is while it is lifted.
    pub after_steps: u32,
}

/// No movement is quicker than this, so that speeds stay finite.
const QUICKEST: Duration = Duration::from_millis(1);

impl PairSettings {
    /// The usual pair, with what it lets go at this place taken in.
    #[must_use]
    pub fn new(seed: u64, container: Place) -> PairSettings {
        PairSettings {
            seed,
            step: Duration::from_millis(330),
            loaded_step: Duration::from_secs(1),
            turn: Duration::from_millis(500),
            look: Duration::from_millis(500),
            arm: Duration::from_millis(1500),
            unrecognised_rate: 0.0,
            way_out: false,
            container,
            mishaps: Mishaps::default(),
        }
    }

    /// With every time where arithmetic holds.
    pub(super) fn sound(mut self) -> PairSettings {
        for time in [&mut self.step, &mut self.loaded_step, &mut self.turn, &mut self.look, &mut self.arm] {
            *time = (*time).max(QUICKEST);
        }
        self
    }
}
