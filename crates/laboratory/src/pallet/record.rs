//! What a run of the pallet scenario leaves behind: its phases with their times, what was said, frames to draw, and figures.

use std::time::Duration;

use hallsweep_core::pair::{RetrievalFault, Saying};
use hallsweep_core::retrieval::{Team, Which};
use hallsweep_sim::BodyPose;
use hallsweep_sim::pair::{Holding, Pair};

/// The phases of the scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// 1: SRM1 finds the pallet.
    Find,
    /// 2: both come to the pallet.
    Approach,
    /// 3: the parcel is identified.
    Identify,
    /// 4: both take hold of it.
    PickUp,
    /// 5: it is lifted and carried.
    Transport,
    /// 6: it is put down.
    PutDown,
    /// 7: both go back to the pallet.
    Return,
    /// 8: the same for the next one.
    Next,
}

impl Phase {
    /// All of them, in their order.
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

    /// Its number in the scenario.
    #[must_use]
    pub const fn number(self) -> usize {
        self as usize + 1
    }

    /// What passes in it.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Phase::Find => "SRM1 finds the pallet and tells where it is",
            Phase::Approach => "both come to the pallet, SRM2 when it has been told where it is",
            Phase::Identify => "the parcel is identified, both stand beside it",
            Phase::PickUp => "the grippers close; force and angle are held",
            Phase::Transport => "the parcel is lifted and carried to the target area",
            Phase::PutDown => "the parcel is put down and let go",
            Phase::Return => "both go back to the pallet",
            Phase::Next => "the same for the next parcel",
        }
    }

    /// The node by which its beginning is known, and in which of the three trees.
    const fn node(self) -> Option<(usize, &'static str)> {
        match self {
            Phase::Find => Some((0, "FindPallet")),
            Phase::Approach => Some((0, "SRM1_to_LoadSite")),
            // The sequence itself is ticked from the first, to wait for the two.
            Phase::Identify => Some((2, "FindParcel")),
            Phase::PickUp => Some((2, "Pick-UpPrepSequence")),
            Phase::Transport => Some((2, "TransportSequence")),
            Phase::PutDown => Some((2, "DropSequence")),
            Phase::Return => Some((2, "ReturnToPallet")),
            Phase::Next => None,
        }
    }
}

/// Something worth telling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum News {
    /// A phase began.
    Began(Phase),
    /// Something was said to the operator.
    Said(Saying),
    /// The operator has acknowledged it.
    Acknowledged,
    /// START was pressed.
    Started,
    /// A parcel slipped out of the grippers.
    Lost,
    /// The robots were halted.
    Stopped,
    /// The program died and was started again.
    Restarted,
}

/// Something worth telling, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// In simulated time, since the run began.
    pub at: Duration,
    /// The parcel that was under way, counted from 1.
    pub parcel: u32,
    /// What.
    pub news: News,
}

/// The yard at one moment, for a page to draw. Lengths are in metres from the first robot's start, to the east and to the south.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// When.
    pub at: Duration,
    /// Where the bodies of the two are.
    pub bodies: [BodyPose; 2],
    /// Whether each gripper is closed.
    pub closed: [bool; 2],
    /// The middle of the parcel between them, and how high it is lifted, 0–1.
    pub load: Option<(f64, f64, f64)>,
    /// The gripping force in newtons, the angle of the paddles in radians, the distance of the bases beyond what is wanted in metres.
    pub held: Option<[f64; 3]>,
    /// Parcels in the target area.
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

/// Why a run did not bring all parcels to the target area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PalletFault {
    /// The pair could not go on.
    Pair(RetrievalFault),
    /// The operator was called, and never came.
    OperatorAbsent,
    /// The trees say that all is done, and the target area holds fewer parcels.
    NotAllThere,
    /// The run took longer than it ever should.
    TakesTooLong,
}

impl PalletFault {
    /// Its fixed name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            PalletFault::Pair(fault) => fault.name(),
            PalletFault::OperatorAbsent => "operatorAbsent",
            PalletFault::NotAllThere => "notAllThere",
            PalletFault::TakesTooLong => "runTakesTooLong",
        }
    }

    /// What it says.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            PalletFault::Pair(fault) => fault.in_words(),
            PalletFault::OperatorAbsent => "the operator was called and has not come",
            PalletFault::NotAllThere => "the trees ended, and not all parcels are in the target area",
            PalletFault::TakesTooLong => "the run takes longer than it ever should",
        }
    }
}

/// What a run came to.
#[derive(Clone, Debug)]
pub struct Figures {
    /// Parcels on the pallet at first.
    pub parcels: u32,
    /// The seed of everything.
    pub seed: u64,
    /// Parcels in the target area: what is really there.
    pub delivered: usize,
    /// How long it took, in simulated time.
    pub took: Duration,
    /// Ticks of the three trees.
    pub ticks: u64,
    /// Parcels that slipped out of the grippers.
    pub losses: u32,
    /// How well parcels were held while they were off the floor.
    pub holding: Holding,
    /// Why not all parcels arrived.
    pub fault: Option<PalletFault>,
}

/// The phases that begin in the last tick, given the one that is under way.
pub(super) fn begun(team: &Team, under_way: Option<Phase>) -> Vec<Phase> {
    let ticked = |phase: &Phase| {
        let Some((tree, name)) = phase.node() else { return false };
        team.trees()[tree].nodes().any(|node| node.name == name && node.returned.is_some())
    };
    Phase::ALL.into_iter().filter(|phase| under_way.is_none_or(|last| *phase > last)).filter(ticked).collect()
}
