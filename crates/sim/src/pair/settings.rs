//! The settings of the simulated pair, and its mishaps. How fast simulated time runs is not here.

use std::time::Duration;

use hallsweep_core::place::Place;

/// Times are in simulated time.
#[derive(Clone, Debug, PartialEq)]
pub struct PairSettings {
    /// The seed of its noise and failures.
    pub seed: u64,
    /// Duration of a base's step of one place without a load.
    pub step: Duration,
    /// Duration of a step with a load: a parcel is carried at a walking pace.
    pub loaded_step: Duration,
    /// Duration of a turn of 90°.
    pub turn: Duration,
    pub look: Duration,
    pub arm: Duration,
    /// Probability that a look does not recognise a parcel that is there, 0–1.
    pub unrecognised_rate: f64,
    pub way_out: bool,
    /// The place that takes in released parcels for good: the target area, or the container.
    pub container: Place,
    pub mishaps: Mishaps,
}

/// The requested mishaps, each of which happens once. Parcels are counted from 1: parcel 1 is the current one until it
/// has arrived.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mishaps {
    pub slips: Vec<Slip>,
    /// Parcels that the first look does not recognise.
    pub unrecognised: Vec<u32>,
    /// Parcels round which a gripper does not close, however often it tries.
    pub jams: Vec<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slip {
    /// The parcel, counted from 1.
    pub parcel: u32,
    /// Number of steps after which the parcel slips: in the middle of the next step, or of the last step if the way is
    /// shorter. With 0 the parcel slips while it is lifted.
    pub after_steps: u32,
}

/// Shortest movement, so that speeds stay finite.
const QUICKEST: Duration = Duration::from_millis(1);

impl PairSettings {
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

    /// Limits every duration to the range that the arithmetic can handle.
    pub(super) fn sound(mut self) -> PairSettings {
        for time in [&mut self.step, &mut self.loaded_step, &mut self.turn, &mut self.look, &mut self.arm] {
            *time = (*time).max(QUICKEST);
        }
        self
    }
}
