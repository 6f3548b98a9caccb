//! The record of a run of the pallet scenario: phases with their times, messages to the operator, frames to draw, and
//! figures.

use std::time::Duration;

use hallsweep_core::pair::{RetrievalFault, Saying, Which};
use hallsweep_core::retrieval::Team;
use hallsweep_sim::BodyPose;
use hallsweep_sim::pair::{Holding, Pair};

/// Phases of the scenario, with the numbers of the original specification.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// 1: SRM1 finds the pallet.
    Find,
    /// 2: both robots drive to the pallet.
    Approach,
    /// 3: the parcel is identified.
    Identify,
    /// 4: both robots grip the parcel.
    PickUp,
    /// 5: the parcel is lifted and carried.
    Transport,
    /// 6: the parcel is put down.
    PutDown,
    /// 7: both robots drive back to the pallet.
    Return,
    /// 8: the phases begin again with the next parcel.
    Next,
}

impl Phase {
    pub const ALL: [Phase; 8] = [
        Phase::Find,
        Phase::Approach,
        Phase::Identify,
        Phase::PickUp,
        Phase::Transport,
        Phase::PutDown,
        Phase::Return,
        Phase::Next,
    ];

    /// Number of the phase, counted from 1.
    #[must_use]
    pub const fn number(self) -> usize {
        self as usize + 1
    }

    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Phase::Find => "SRM1 finds the pallet and reports its position",
            Phase::Approach => "both robots drive to the pallet, SRM2 after SRM1's report",
            Phase::Identify => "the parcel is identified, both robots stop beside the parcel",
            Phase::PickUp => "the grippers close; the robots control force and angle",
            Phase::Transport => "the parcel is lifted and carried to the target area",
            Phase::PutDown => "the parcel is put down and released",
            Phase::Return => "both robots go back to the pallet",
            Phase::Next => "phases 3 to 7 repeat for the next parcel",
        }
    }

    /// The index of a tree and the name of one of its nodes. The first tick of this node begins the phase.
    const fn node(self) -> Option<(usize, &'static str)> {
        match self {
            Phase::Find => Some((0, "FindPallet")),
            Phase::Approach => Some((0, "SRM1_to_LoadSite")),
            // The sequence above this node cannot mark the phase: it is ticked from the start of the run, because it
            // waits for both robots.
            Phase::Identify => Some((2, "FindParcel")),
            Phase::PickUp => Some((2, "Pick-UpPrepSequence")),
            Phase::Transport => Some((2, "TransportSequence")),
            Phase::PutDown => Some((2, "DropSequence")),
            Phase::Return => Some((2, "ReturnToPallet")),
            Phase::Next => None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum News {
    Began(Phase),
    Said(Saying),
    Acknowledged,
    Started,
    Lost,
    Stopped,
    Restarted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Simulated time since the beginning of the run.
    pub at: Duration,
    /// Number of the current parcel, counted from 1.
    pub parcel: u32,
    pub news: News,
}

/// The yard at one moment, for a page to draw. Lengths are in metres from the first robot's start, to the east and to
/// the south.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Simulated time since the beginning of the run.
    pub at: Duration,
    pub bodies: [BodyPose; 2],
    pub closed: [bool; 2],
    /// Centre of the held parcel, in metres, and its height, from 0 to 1.
    pub load: Option<(f64, f64, f64)>,
    /// While a parcel is held: gripping force in newtons, angle of the paddles in radians, and by how many metres the
    /// distance of the bases is too long.
    pub held: Option<[f64; 3]>,
    /// Number of parcels that are really in the target area. The trees may report another number.
    pub delivered: usize,
}

impl Frame {
    pub(super) fn of(pair: &Pair, at: Duration) -> Frame {
        let arm = pair.arm(Which::Srm1);
        let held = [f64::from(arm.force_mn) / 1e3, f64::from(arm.angle_urad) / 1e6, f64::from(arm.gap_um) / 1e6];
        Frame {
            at,
            bodies: Which::ALL.map(|which| pair.body(which)),
            closed: Which::ALL.map(|which| pair.arm(which).gripper == hallsweep_core::arm::Gripper::Closed),
            load: pair.load_m(),
            held: arm.holds.map(|_| held),
            delivered: pair.taken_in().len(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PalletFault {
    Pair(RetrievalFault),
    OperatorAbsent,
    /// The trees report the end, but some parcels are not in the target area.
    NotAllThere,
    /// The run took longer than `run::LONGEST` times the number of parcels.
    TakesTooLong,
}

impl PalletFault {
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            PalletFault::Pair(fault) => fault.name(),
            PalletFault::OperatorAbsent => "operatorAbsent",
            PalletFault::NotAllThere => "notAllThere",
            PalletFault::TakesTooLong => "runTakesTooLong",
        }
    }

    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            PalletFault::Pair(fault) => fault.in_words(),
            PalletFault::OperatorAbsent => "the operator was called and has not come",
            PalletFault::NotAllThere => "the trees ended before all parcels were in the target area",
            PalletFault::TakesTooLong => "the run takes longer than its time limit",
        }
    }
}

#[derive(Clone, Debug)]
pub struct Figures {
    /// Number of parcels on the pallet at the beginning.
    pub parcels: u32,
    pub seed: u64,
    /// Number of parcels that are really in the target area. The trees may report another number.
    pub delivered: usize,
    /// Simulated time of the run.
    pub took: Duration,
    pub ticks: u64,
    /// Number of times that a parcel slipped out of the grippers.
    pub losses: u32,
    /// Errors of force, angle and distance while the grippers bore a parcel.
    pub holding: Holding,
    /// Why not all parcels arrived. `None` if all parcels arrived, or if the run has not ended.
    pub fault: Option<PalletFault>,
}

/// Phases that the last tick began. Only phases later than `under_way` are considered.
pub(super) fn begun(team: &Team, under_way: Option<Phase>) -> Vec<Phase> {
    let ticked = |phase: &Phase| {
        let Some((tree, name)) = phase.node() else { return false };
        team.trees()[tree].nodes().any(|node| node.name == name && node.returned.is_some())
    };
    Phase::ALL.into_iter().filter(|phase| under_way.is_none_or(|last| *phase > last)).filter(ticked).collect()
}
