//! The simulated pair before it is started: the place where it was left, and what to do if this place is in another
//! hall or unknown.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tokio::sync::watch;

use super::pair_link::{self, Begin, Moved};
use super::pair_state_file::PairStateFile;
use super::remote::Remote;
use super::state_file::StateFileError;
use crate::config::{PairMishaps, RobotSettings};
use crate::robots::Adapter;
use crate::runtime::clock::Clock;
use hallsweep_core::pair::Which;
use hallsweep_core::place::Place;
use hallsweep_core::robot::RobotId;
use hallsweep_core::speed::Speed;
use hallsweep_core::units::Now;
use hallsweep_sim::Hall;
use hallsweep_sim::pair::{Mishaps, Pair, PairMemory, PairSettings, Slip};

pub(in crate::robots) struct SimPair {
    hall: Arc<Hall>,
    settings: PairSettings,
    speed: Speed,
    remembered: PairRecollection,
    moved: watch::Sender<Moved>,
}

enum PairRecollection {
    /// There is no stored position, and no position will be stored.
    Nothing,
    Here(PairStateFile, Option<Box<PairMemory>>),
    /// The pair was left in another hall, as the state file in this folder says.
    Elsewhere(PathBuf),
    /// The position of the pair is unknown, for this reason.
    Lost(String),
}

impl SimPair {
    /// A pair with the speed and the seed of the searching robot.
    pub(in crate::robots) fn new(hall: Arc<Hall>, robot: &RobotSettings, mishaps: PairMishaps) -> SimPair {
        // All slips happen with the first piece, each one step later than the previous slip.
        let slips = (1..=mishaps.slips).map(|after_steps| Slip { parcel: 1, after_steps }).collect();
        let unrecognised = (0..mishaps.unrecognised).map(|_| 1).collect();
        let mishaps = Mishaps { slips, unrecognised, ..Mishaps::default() };
        let settings = PairSettings { way_out: true, mishaps, ..PairSettings::new(robot.seed, Place::ENTRANCE) };
        let moved = watch::Sender::new(Moved::new());
        SimPair { hall, settings, speed: robot.speed, remembered: PairRecollection::Nothing, moved }
    }

    pub(in crate::robots) fn ids() -> [RobotId; 2] {
        Which::ALL.map(Which::robot)
    }

    /// The pieces that the pair has lifted. Other robots must not meet these pieces any more.
    pub(in crate::robots) fn moved(&self) -> watch::Receiver<Moved> {
        self.moved.subscribe()
    }

    pub(in crate::robots) fn recall(&mut self, folder: &Path) {
        self.remembered = match PairStateFile::open(folder, &self.hall) {
            Ok((state_file, memory)) => PairRecollection::Here(state_file, memory.map(Box::new)),
            Err(StateFileError::OtherHall { .. }) => PairRecollection::Elsewhere(folder.to_owned()),
            Err(lost) => PairRecollection::Lost(lost.to_string()),
        };
    }

    pub(in crate::robots) fn floor(&self) -> Arc<Hall> {
        Arc::new(self.hall.rearranged(&self.taken_away()))
    }

    pub(in crate::robots) fn taken_away(&self) -> Moved {
        let PairRecollection::Here(_, Some(memory)) = &self.remembered else { return Moved::new() };
        Pair::remembering(Arc::clone(&self.hall), self.settings.clone(), (**memory).clone(), Now::default()).moved()
    }

    pub(in crate::robots) fn lost(&self) -> Option<&str> {
        if let PairRecollection::Lost(lost) = &self.remembered { Some(lost) } else { None }
    }

    pub(in crate::robots) fn lose(&mut self, why: &str) {
        self.remembered = PairRecollection::Lost(why.to_owned());
    }

    pub(in crate::robots) fn put_down(&mut self) {
        if let PairRecollection::Elsewhere(folder) = &self.remembered {
            self.remembered = PairRecollection::Here(PairStateFile::begin_anew(folder, &self.hall), None);
        }
    }

    pub(in crate::robots) fn keep_other_hall(&mut self) {
        if matches!(self.remembered, PairRecollection::Here(_, None)) {
            self.remembered = PairRecollection::Nothing;
        }
    }

    /// Makes the two adapters. If the position of the pair is unknown, its links stay down.
    pub(in crate::robots) fn adapters(self, clock: Clock, remote: Remote) -> [Adapter; 2] {
        let SimPair { hall, settings, speed, remembered, moved } = self;
        let (memory, state_file) = match remembered {
            PairRecollection::Lost(lost) => {
                tracing::error!(lost, "the position of the simulated pair is unknown: hallsweep does not start the pair");
                return [(), ()].map(|()| -> Adapter { Box::new(|side| Box::pin(async move { side.reports.closed().await })) });
            }
            PairRecollection::Here(state_file, memory) => (memory, Some(state_file)),
            PairRecollection::Nothing | PairRecollection::Elsewhere(_) => (None, None),
        };
        let of_another = settings.clone();
        let pair = move |now| match memory {
            Some(memory) => Pair::remembering(hall, settings, *memory, now),
            None => Pair::new(hall, settings, pair_link::outside()),
        };
        pair_link::adapters(Begin { pair, settings: of_another, speed, state_file, moved, remote }, clock)
    }
}
