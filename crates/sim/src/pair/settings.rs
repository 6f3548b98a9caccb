//! The settings of the simulated pair, and its mishaps. The speed of simulated time is not set here.

use std::time::Duration;

use hallsweep_core::place::Place;

/// Settings of the simulated pair. All times are simulated time.
#[derive(Clone, Debug, PartialEq)]
pub struct PairSettings {
    /// The seed of the pair's noise and failures.
    pub seed: u64,
    /// Duration of a step from one place to the next, without a load.
    pub step: Duration,
    /// Duration of a step with a parcel, which is carried at a walking pace.
    pub loaded_step: Duration,
    /// Duration of a turn of 90°.
    pub turn: Duration,
    pub look: Duration,
    pub arm: Duration,
    /// Probability that a look fails to recognise a parcel that is there, 0–1.
    pub unrecognised_rate: f64,
    pub way_out: bool,
    /// The place where released parcels go into the container. It is a target area or the container itself.
    pub container: Place,
    pub mishaps: Mishaps,
}

/// The requested mishaps. Parcels are counted from 1, in the order in which they arrive. Each slip and each
/// unrecognised parcel happens once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mishaps {
    pub slips: Vec<Slip>,
    /// Numbers of the parcels that the first look does not recognise.
    pub unrecognised: Vec<u32>,
    /// Numbers of the parcels on which the grippers never close, however often they try.
    pub jams: Vec<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slip {
    /// Number of the parcel, counted from 1.
    pub parcel: u32,
    /// Number of completed steps before the slip. The parcel slips in the middle of the next step, or of the last
    /// step if the way is shorter. With 0 it slips while it is lifted.
    pub after_steps: u32,
}

/// Shortest duration of a movement. It keeps speeds finite.
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

    /// Raises durations that are too short to `QUICKEST`.
    pub(super) fn sound(mut self) -> PairSettings {
        for time in [&mut self.step, &mut self.loaded_step, &mut self.turn, &mut self.look, &mut self.arm] {
            *time = (*time).max(QUICKEST);
        }
        self
    }
}
