//! An operator for the tests: starts runs in named halls, waits for states, and gives commands with short functions.

use std::sync::Arc;

use hallsweep_core::command::{Accepted, Command, LuggageRef, Move, Strategy, TemperatureReport, Verdict};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Cell, Celsius, LuggageId};
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

/// Number of events that exceeds any mission of these tests.
pub(crate) const PLENTY: usize = 100_000;

/// Robot at home in a hall that comes with the program.
pub(crate) fn in_hall(name: &str) -> Run {
    run_in(Hall::named_or_file(name).expect("the hall comes with the program"), SimSettings::new(1, Camera::Stub))
}

/// Robot at home in a hall drawn with `.`, `#`, `S`, and letters for luggage.
pub(crate) fn in_drawn(rows: &[&str]) -> Run {
    drawn_with(rows, SimSettings::new(1, Camera::Stub))
}

pub(crate) fn drawn_with(rows: &[&str], settings: SimSettings) -> Run {
    run_in(Hall::from_rows("drawn", rows).expect("the tests draw sound halls"), settings)
}

pub(crate) fn run_in(hall: Hall, settings: SimSettings) -> Run {
    Run::new(Arc::new(hall), settings, Settings::default(), Strategy::Snail)
}

/// Reading of a configured sensor.
pub(crate) fn sensor_reads(sensor: &str, degrees: f64) -> Command {
    let celsius = Celsius::new(degrees).expect("the tests use believable temperatures");
    Command::Temperature(TemperatureReport::Sensor(sensor.into(), celsius))
}

/// Actions and waits of an operator.
pub(crate) trait Operator {
    fn verdict(&mut self, id: u64, verdict: Verdict) -> Result<Accepted, Refused>;
    fn drive(&mut self, step: Move) -> Result<Accepted, Refused>;
    fn temperature(&mut self, report: TemperatureReport) -> Result<Accepted, Refused>;
    fn reading(&mut self, degrees: f64) -> Result<Accepted, Refused>;
    fn until(&mut self, what: &str, reached: impl FnMut(&Snapshot) -> bool);
    fn until_phase(&mut self, phase: PhaseName);
    /// Continues until a piece waits for its verdict, and returns its number.
    fn until_pending(&mut self) -> LuggageId;
    /// Answers safe for every piece until the hall is explored.
    fn until_explored(&mut self);
    fn holds(&mut self) -> Vec<Hold>;
    fn cell(&mut self) -> Cell;
    /// Checks that nothing moves for a simulated minute.
    fn stands_still(&mut self);
}

impl Operator for Run {
    fn verdict(&mut self, id: u64, verdict: Verdict) -> Result<Accepted, Refused> {
        self.give(Command::Verdict { luggage: LuggageRef::Id(LuggageId(id)), verdict, note: None, hot: Default::default() })
    }

    fn drive(&mut self, step: Move) -> Result<Accepted, Refused> {
        self.give(Command::Move(step))
    }

    fn temperature(&mut self, report: TemperatureReport) -> Result<Accepted, Refused> {
        self.give(Command::Temperature(report))
    }

    fn reading(&mut self, degrees: f64) -> Result<Accepted, Refused> {
        let celsius = Celsius::new(degrees).expect("the tests use believable temperatures");
        self.temperature(TemperatureReport::Reading(celsius))
    }

    fn until(&mut self, what: &str, reached: impl FnMut(&Snapshot) -> bool) {
        assert!(self.run_until(PLENTY, reached), "never {what}; the phase is {:?}", self.phase());
    }

    fn until_phase(&mut self, phase: PhaseName) {
        self.until(phase.name(), |state| state.mission.phase == phase);
    }

    fn until_pending(&mut self) -> LuggageId {
        self.until("a piece that waits", |state| state.mission.inspected.and_then(|id| state.luggage(id)).is_some());
        self.state().mission.inspected.expect("a piece is in front of the robot")
    }

    fn until_explored(&mut self) {
        loop {
            self.until("a piece or the end", |state| {
                state.mission.inspected.is_some() || state.mission.phase == PhaseName::Explored
            });
            match self.state().mission.inspected {
                Some(LuggageId(id)) => drop(self.verdict(id, Verdict::Safe).expect("a pending piece may be called safe")),
                None => break,
            }
        }
    }

    fn holds(&mut self) -> Vec<Hold> {
        self.state().mission.holds.clone()
    }

    fn cell(&mut self) -> Cell {
        self.state().robot.pose.cell
    }

    fn stands_still(&mut self) {
        let (now, before) = (self.now(), self.sim.pose_at(self.now()));
        self.wait(60.0);
        assert_eq!(self.sim.pose_at(self.now()), before, "the robot moved since {:?}", now.since_start);
    }
}
