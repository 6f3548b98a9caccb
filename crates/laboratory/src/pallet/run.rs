//! A run of the scenario. It performs one event after the other. Between two events, a person can press STOP or
//! START, or acknowledge an alarm.

#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::Duration;

use super::crew::Crew;
use super::operator::{Deed, Operator};
use super::record::{Entry, Figures, Frame, News, PalletFault, Phase, begun};
use super::yard::{ParcelsError, Yard};
use behaviour_trees::log::TickLog;
use hallsweep_core::event::RobotEvent;
use hallsweep_core::pair::{RetrievalFault, Which};
use hallsweep_core::retrieval::Team;
use hallsweep_core::retrieval::team::TICK;
use hallsweep_core::state::TeamStage;
use hallsweep_core::units::{Cell, Now, WallTime};
use hallsweep_sim::pair::{Holding, Mishaps, Pair, PairSettings};

/// Maximum simulated time of a run for each of its parcels. It is a hundred times the usual time.
const LONGEST: Duration = Duration::from_secs(4 * 3600);

/// If the operator does not press START for this time, the operator counts as absent and the run ends.
const NOBODY_COMES: Duration = Duration::from_secs(600);

/// Number of ticks from one stored frame to the next.
const FRAME_EVERY: u64 = 5;

/// Maximum number of frames, enough for hours of simulated time. A longer run is drawn only up to this point.
const MOST_FRAMES: usize = 100_000;

/// Maximum number of entries in a record. It is enough for thousands of losses, and no run has more.
const MOST_ENTRIES: usize = 100_000;

/// The requested faults. Parcels are counted from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    pub mishaps: Mishaps,
    /// Numbers of the parcels that close the way into the target area when they are lifted.
    pub blocked: Vec<u32>,
    pub absent: bool,
}

#[derive(Debug)]
pub struct PalletRun {
    yard: Yard,
    seed: u64,
    asked: Asked,
    settings: PairSettings,
    pair: Pair,
    team: Team,
    crew: Crew,
    operator: Operator,
    now: Duration,
    next_tick: Duration,
    ticks: u64,
    /// Whether STOP was pressed after the last START.
    is_stopped: bool,
    /// Whether there is an alarm that was not acknowledged yet.
    is_calling: bool,
    awaits_start: bool,
    /// When the wait for the operator began, in simulated time.
    waits_since: Option<Duration>,
    phase: Option<Phase>,
    runs: u32,
    losses: u32,
    /// Statistics of the grip from before the last restart. A restarted pair begins without them.
    held_before: Holding,
    entries: Vec<Entry>,
    logs: [TickLog; 3],
    frames: Vec<Frame>,
    ended: Option<Option<PalletFault>>,
}

impl PalletRun {
    /// Makes a run that has not begun yet.
    ///
    /// # Errors
    /// If `parcels` is 0 or more than `MOST_PARCELS`.
    pub fn new(parcels: u32, seed: u64, asked: Asked) -> Result<PalletRun, ParcelsError> {
        Ok(PalletRun::of(Yard::new(parcels, seed)?, seed, asked))
    }

    #[must_use]
    pub fn of(yard: Yard, seed: u64, asked: Asked) -> PalletRun {
        let (mishaps, way_out) = (asked.mishaps.clone(), yard.way_out);
        let settings = PairSettings { mishaps, way_out, ..PairSettings::new(seed, yard.target) };
        let pair = Pair::new(Arc::clone(&yard.hall), settings.clone(), yard.starts);
        let crew = Crew::new(&yard, pair.capabilities());
        let mut run = PalletRun {
            operator: Operator::new(seed, !asked.absent),
            yard,
            seed,
            asked,
            settings,
            pair,
            team: Team::new(),
            crew,
            now: Duration::ZERO,
            next_tick: TICK,
            ticks: 0,
            is_stopped: false,
            is_calling: false,
            awaits_start: false,
            waits_since: None,
            phase: None,
            runs: 1,
            losses: 0,
            held_before: Holding::default(),
            entries: Vec::new(),
            logs: Default::default(),
            frames: Vec::new(),
            ended: None,
        };
        run.take_reports();
        run
    }

    /// Performs the next event. Returns false if the run has ended. `watch` is called with the team after each tick
    /// of its trees.
    pub fn advance(&mut self, mut watch: impl FnMut(&Team)) -> bool {
        if self.ended.is_some() {
            return false;
        }
        let next = [Some(self.next_tick), self.pair.poll_timeout(), self.operator.due()].into_iter().flatten().min();
        self.now = self.now.max(next.unwrap_or(self.next_tick));
        self.pair.handle_timeout(self.now());
        self.take_reports();
        if let Some(deed) = self.operator.deed(self.now) {
            self.attend(deed);
        }
        if self.next_tick <= self.now {
            self.next_tick = self.now + TICK;
            self.tick(&mut watch);
        }
        self.look_at_the_clock();
        self.ended.is_none()
    }

    pub fn finish(&mut self) -> Figures {
        while self.advance(|_| {}) {}
        self.figures()
    }

    pub fn advance_to(&mut self, until: Duration) {
        while self.now < until && self.advance(|_| {}) {}
    }

    /// Performs STOP. Both robots halt where they are, and keep holding their parcel.
    pub fn stop(&mut self) {
        (self.is_stopped, self.awaits_start) = (true, true);
        self.note(News::Stopped);
        self.halt();
    }

    /// Performs START. Returns false, and does nothing, if an alarm was not acknowledged yet.
    pub fn start(&mut self) -> bool {
        if self.is_calling {
            return false;
        }
        if self.awaits_start {
            self.note(News::Started);
        }
        (self.is_stopped, self.awaits_start, self.waits_since) = (false, false, None);
        true
    }

    /// Acknowledges the alarm. The operator presses START some seconds later.
    pub fn acknowledge(&mut self) {
        if std::mem::take(&mut self.is_calling) {
            self.note(News::Acknowledged);
            self.operator.called(Deed::Start, self.now);
        }
    }

    /// Simulates that the program dies and is started again. The robots have halted by themselves, still hold their
    /// parcel, and wait for START. Open orders are never answered. The trees continue from their stored state.
    pub fn restart(&mut self) {
        self.team = Team::resume(self.team.state()).expect("they are the same trees");
        self.held_before.join(self.pair.holding());
        self.pair = Pair::remembering(Arc::clone(&self.yard.hall), self.settings.clone(), self.pair.memory(), self.now());
        self.crew.forget_orders();
        self.take_reports();
        (self.is_stopped, self.awaits_start) = (true, true);
        self.note(News::Restarted);
    }

    #[must_use]
    pub const fn yard(&self) -> &Yard {
        &self.yard
    }

    #[must_use]
    pub const fn team(&self) -> &Team {
        &self.team
    }

    /// Simulated time since the run began.
    #[must_use]
    pub const fn time(&self) -> Duration {
        self.now
    }

    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    #[must_use]
    pub fn frame(&self) -> Frame {
        Frame::of(&self.pair, self.now)
    }

    /// The frames up to now, one every half second.
    #[must_use]
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// What changed in each tick in the trees of SRM1, SRM2 and the Supervisor.
    #[must_use]
    pub const fn logs(&self) -> &[TickLog; 3] {
        &self.logs
    }

    /// Cells of the parcels that are not held and not in the target area.
    #[must_use]
    pub fn parcels(&self) -> Vec<Cell> {
        self.crew.left().filter_map(|(_, place)| place.cell()).collect()
    }

    #[must_use]
    pub const fn has_ended(&self) -> bool {
        self.ended.is_some()
    }

    #[must_use]
    pub fn not_happened(&self) -> Asked {
        let fault = self.ended.flatten();
        let mut mishaps = self.pair.mishaps_left();
        if fault == Some(PalletFault::Pair(RetrievalFault::RobotFails)) {
            mishaps.jams.retain(|parcel| *parcel as usize != self.pair.taken_in().len() + 1);
        }
        let absent = self.asked.absent && fault != Some(PalletFault::OperatorAbsent);
        Asked { mishaps, blocked: self.asked.blocked.clone(), absent }
    }

    #[must_use]
    pub fn figures(&self) -> Figures {
        let mut holding = self.held_before;
        holding.join(self.pair.holding());
        Figures {
            parcels: u32::try_from(self.yard.parcels.len()).unwrap_or(u32::MAX),
            seed: self.seed,
            delivered: self.pair.taken_in().len(),
            took: self.now,
            ticks: self.ticks,
            losses: self.losses,
            holding,
            fault: self.ended.flatten(),
        }
    }

    const fn now(&self) -> Now {
        Now { since_start: self.now, wall: WallTime { unix_ms: 0, offset_s: 0 } }
    }

    const fn is_held(&self) -> bool {
        self.is_stopped || self.is_calling || self.awaits_start
    }

    fn tick(&mut self, watch: &mut impl FnMut(&Team)) {
        if self.ticks.is_multiple_of(FRAME_EVERY) && self.frames.len() < MOST_FRAMES {
            self.frames.push(self.frame());
        }
        if self.is_held() {
            return;
        }
        self.ticks += 1;
        let outcome = self.team.tick(&self.crew.view(self.is_calling), TICK);
        self.log_ticks();
        watch(&self.team);
        self.note_phases();
        for proposal in outcome.proposals {
            if let Some(order) = self.crew.order(proposal) {
                self.pair.handle_order(proposal.which, order, self.now());
            }
        }
        self.take_reports();
        for saying in outcome.sayings {
            self.note(News::Said(saying));
            (self.is_calling, self.awaits_start, self.waits_since) = (true, true, Some(self.now));
            self.operator.called(Deed::Acknowledge, self.now);
            self.halt();
        }
        match self.team.stage() {
            TeamStage::Faulted(fault) => self.ended = Some(Some(PalletFault::Pair(*fault))),
            TeamStage::Done if self.pair.taken_in().len() == self.yard.parcels.len() => self.ended = Some(None),
            TeamStage::Done => self.ended = Some(Some(PalletFault::NotAllThere)),
            TeamStage::Working | TeamStage::Lost => {}
        }
    }

    fn log_ticks(&mut self) {
        for (log, tree) in self.logs.iter_mut().zip(self.team.trees()) {
            log.note(tree, self.team.blackboard(), self.now);
        }
    }

    fn halt(&mut self) {
        for which in Which::ALL {
            self.pair.handle_halt(which, self.now());
        }
        self.take_reports();
    }

    fn take_reports(&mut self) {
        while let Some((which, report)) = self.pair.poll_event() {
            if let RobotEvent::Found(_, found) = report {
                self.team.handle_found(found, None);
            }
            if matches!(report, RobotEvent::ParcelLost(_)) && which == Which::Srm1 {
                self.losses += 1;
                self.note(News::Lost);
            }
            self.crew.report(which, report);
        }
        let parcel = u32::try_from(self.pair.taken_in().len()).unwrap_or(u32::MAX).saturating_add(1);
        if self.asked.blocked.contains(&parcel) && self.pair.arm(Which::Srm1).lifted {
            let closed = self.yard.target.cell().is_some_and(|cell| self.pair.close_cell(cell));
            self.asked.blocked.retain(|asked| *asked != parcel || !closed);
        }
    }

    fn attend(&mut self, deed: Deed) {
        match deed {
            Deed::Acknowledge => self.acknowledge(),
            Deed::Start => drop(self.start()),
        }
    }

    fn note_phases(&mut self) {
        if self.team.runs() > self.runs {
            self.runs = self.team.runs();
            let is_next = self.phase == Some(Phase::Return);
            self.phase = Some(Phase::Approach);
            if is_next {
                self.note(News::Began(Phase::Next));
            }
        }
        for phase in begun(&self.team, self.phase) {
            self.phase = Some(phase);
            self.note(News::Began(phase));
        }
    }

    fn note(&mut self, news: News) {
        // The entry for the beginning of the way back still has the number of the parcel that was just put down.
        let back = usize::from(news == News::Began(Phase::Return));
        let parcel = u32::try_from(self.team.delivered().len() + 1 - back).unwrap_or(u32::MAX);
        if self.entries.len() < MOST_ENTRIES {
            self.entries.push(Entry { at: self.now, parcel, news });
        }
    }

    fn look_at_the_clock(&mut self) {
        let parcels = u32::try_from(self.yard.parcels.len()).unwrap_or(u32::MAX);
        if self.waits_since.is_some_and(|since| self.now.saturating_sub(since) > NOBODY_COMES) {
            self.ended = Some(Some(PalletFault::OperatorAbsent));
        } else if self.ended.is_none() && self.now > LONGEST.saturating_mul(parcels) {
            self.ended = Some(Some(PalletFault::TakesTooLong));
        }
    }
}
