//! Safety R1, R2 and R4: random operators in random halls with a store that confirms late. The program is killed at
//! random moments, also during steps and photos, and between a record and its confirmation. After the start,
//! everything that was shown or answered is there, nothing is there twice, nothing moves before a START, and the
//! mission can be brought to its end. A failure prints its seed.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use hallsweep_core::command::{Command, LuggageRef, TemperatureReport, Verdict};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{AlarmId, Cell, LuggageId, Now, Ticket};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_sim::{Hall, SimSettings, Truth};

use crate::halls;
use crate::mortal::Mortal;
use crate::random_commands::any_area;
use crate::random_halls::in_turn;
use crate::rules_areas::note_areas;
use crate::shown::Record;

#[test]
fn whenever_the_program_is_killed_it_goes_on_from_where_it_was() {
    for seed in 0..300 {
        let hall = halls::random(seed, 10);
        let mut dice = RandomStream::new(seed, "kills");
        let (sim, rules, strategy) = in_turn(seed, Settings::default());
        let sim = SimSettings { unknown_rate: 0.1, photo_failure_rate: 0.2, ..sim };
        let mut mortal = Mortal::searching_by(strategy, rules, Arc::clone(&hall), sim);
        note_areas(&mut mortal.engine, Now::default());
        let mut seen = Seen::default();
        let mut record = Record::of(strategy);
        for _ in 0..dice.below(12) {
            live(&mut mortal, &mut seen, &mut record, &mut dice, seed);
            mortal = mortal.killed(dice.below(4) as usize);
            record.look(&mut mortal, seed);
            seen.check(&mut mortal, seed);
            stands_still(&mut mortal, seed);
        }
        bring_to_the_end(&mut mortal, &mut seen, seed);
        check_map(&mortal.state(), &hall, seed);
    }
}

/// Some commands, some time, and some stored pages.
fn live(mortal: &mut Mortal, seen: &mut Seen, record: &mut Record, dice: &mut RandomStream, seed: u64) {
    for _ in 0..dice.below(30) {
        match dice.below(4) {
            0 => {
                let pending = mortal.state().pending().map_or(1, |luggage| luggage.id.0);
                seen.ask(mortal, any_command(dice, pending));
            }
            1 => (0..dice.below(20)).for_each(|_| {
                mortal.keep_one();
                record.look(mortal, seed);
            }),
            _ => (0..dice.below(12)).for_each(|_| {
                mortal.advance();
                record.look(mortal, seed);
            }),
        }
        seen.look(mortal);
        record.look(mortal, seed);
    }
}

impl Record {
    fn look(&mut self, mortal: &mut Mortal, seed: u64) {
        self.keep_from(&mortal.disk);
        self.check(&mortal.state(), seed);
    }
}

fn any_command(dice: &mut RandomStream, pending: u64) -> Command {
    let verdict = if dice.below(10) == 0 { Verdict::Danger } else { Verdict::Safe };
    match dice.below(14) {
        0..=5 => Command::Start,
        6 => Command::Stop,
        7 => Command::BackHome,
        8 | 9 => Command::Verdict { luggage: LuggageRef::Id(LuggageId(pending)), verdict, note: None, hot: Default::default() },
        10 => Command::Temperature(if dice.below(2) == 0 { TemperatureReport::TooHigh } else { TemperatureReport::Ok }),
        11 => Command::Goto(Cell::new(dice.below(10) as i32, dice.below(10) as i32)),
        12 if dice.below(2) == 0 => Command::RetakePhoto(LuggageId(pending)),
        12 => Command::Unsure { luggage: LuggageRef::Id(LuggageId(pending)), note: None, hot: Default::default() },
        _ => {
            if dice.below(3) == 0 {
                any_area(dice)
            } else if dice.below(2) == 0 {
                Command::Reset
            } else {
                Command::Acknowledge(AlarmId(1))
            }
        }
    }
}

/// What an operator was shown and told, and must find again.
#[derive(Default)]
struct Seen {
    luggage: BTreeMap<LuggageId, Option<Verdict>>,
    /// Unanswered verdicts and resets, by ticket.
    asked: BTreeMap<Ticket, Command>,
    mission: u64,
}

impl Seen {
    fn ask(&mut self, mortal: &mut Mortal, command: Command) {
        if let Ok(ticket) = mortal.give(command.clone()) {
            self.asked.insert(ticket, command);
        }
    }

    fn look(&mut self, mortal: &mut Mortal) {
        for (ticket, answer) in std::mem::take(&mut mortal.answers) {
            let accepted: Result<_, Refused> = answer;
            if let (Some(Command::Verdict { luggage: LuggageRef::Id(id), verdict, note: None, hot: _ }), true) =
                (self.asked.remove(&ticket), accepted.is_ok())
            {
                self.luggage.insert(id, Some(verdict));
            }
        }
        let state = mortal.state();
        if state.mission.id.0 != self.mission || is_idle(&state) {
            self.mission = state.mission.id.0;
            self.luggage.clear();
        }
        let shown = |luggage: &hallsweep_core::world::luggage::Luggage| luggage.verdict.as_ref().map(|decision| decision.verdict);
        self.luggage.extend(state.luggage.iter().map(|luggage| (luggage.id, shown(luggage))));
    }

    /// Checks that everything seen is still there, and nothing is there twice.
    fn check(&mut self, mortal: &mut Mortal, seed: u64) {
        self.asked.clear();
        let state = mortal.state();
        if state.mission.id.0 == self.mission && !is_idle(&state) {
            for (id, verdict) in &self.luggage {
                let found = state.luggage(*id).unwrap_or_else(|| panic!("seed {seed}: luggage #{id} is gone"));
                let stands = found.verdict.as_ref().map(|decision| decision.verdict);
                assert!(verdict.is_none() || stands == *verdict, "seed {seed}: #{id} was {verdict:?} and is {stands:?}");
            }
        }
        let pieces: Vec<_> = state.luggage.iter().filter_map(|luggage| luggage.piece).collect();
        let mut once = pieces.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(pieces.len(), once.len(), "seed {seed}: a piece is on record twice");
        assert!(state.mission.holds.contains(&Hold::Restart) || mortal.disk.is_empty(), "seed {seed}: {:?}", state.mission.holds);
        self.look(mortal);
    }
}

/// Whether no mission is under way, even while somebody drives the robot by hand.
fn is_idle(state: &Snapshot) -> bool {
    state.mission.phase == PhaseName::Idle || state.mission.interrupted == Some(PhaseName::Idle)
}

/// Safety R1: nothing moves until a START, however long the wait.
fn stands_still(mortal: &mut Mortal, seed: u64) {
    let before = mortal.body();
    mortal.wait_a_minute();
    mortal.keep_all();
    mortal.wait_a_minute();
    assert_eq!(mortal.body(), before, "seed {seed}: it moved after a restart");
}

/// Gives the pending verdicts and presses START. The search must end explored, or at home with the bomb located.
fn bring_to_the_end(mortal: &mut Mortal, seen: &mut Seen, seed: u64) {
    let _ = mortal.give(Command::Temperature(TemperatureReport::Ok));
    for _ in 0..20_000 {
        mortal.keep_all();
        let state = mortal.state();
        if matches!(state.mission.phase, PhaseName::Explored | PhaseName::BombLocated) {
            mortal.keep_all();
            assert!(state.robot.pose.cell == Cell::HOME && !mortal.sim.led(), "seed {seed}: away from home, or blinking");
            seen.look(mortal);
            return;
        }
        let waits = state.pending().filter(|luggage| luggage.has_photo()).map(|luggage| luggage.id);
        let held = !state.mission.holds.is_empty() || matches!(state.mission.phase, PhaseName::Idle | PhaseName::AtHome);
        let gave = match waits {
            Some(id) => mortal
                .give(Command::Verdict {
                    luggage: LuggageRef::Id(id),
                    verdict: Verdict::Safe,
                    note: None,
                    hot: Default::default(),
                })
                .is_ok(),
            None if state.mission.refusals.retake.is_none() => {
                mortal.give(Command::RetakePhoto(state.mission.inspected.expect("a photo can be retaken"))).is_ok()
            }
            None if held => mortal.give(Command::Start).is_ok(),
            None => false,
        };
        assert!(gave || mortal.advance(), "seed {seed}: stuck: {:?}", state.mission);
    }
    panic!("seed {seed}: the mission did not come to its end; it is {:?}", mortal.state().mission);
}

/// Checks that the map never contradicts the hall, and is complete when the hall is explored.
fn check_map(state: &Snapshot, hall: &Hall, seed: u64) {
    for (cell, mark) in state.map.known() {
        let truth = hall.truth(cell);
        assert_eq!(
            matches!(mark, Mark::Visited | Mark::Seen),
            truth == Truth::Free,
            "seed {seed}: the map is wrong at {cell}: {mark:?}"
        );
        assert!(mark != Mark::Wall || truth == Truth::Wall, "seed {seed}: no wall at {cell}");
    }
    if state.mission.phase == PhaseName::Explored {
        let closed = state.mission.areas.iter().filter(|shown| shown.closed.is_some());
        let left_out: BTreeSet<Cell> = closed.flat_map(|shown| shown.area.cells()).collect();
        let mut open = vec![Cell::HOME];
        let mut reached = BTreeSet::new();
        while let Some(cell) = open.pop() {
            let is_visited = state.map.at(cell) == Mark::Visited;
            if hall.truth(cell) == Truth::Free && (is_visited || !left_out.contains(&cell)) && reached.insert(cell) {
                assert!(is_visited, "seed {seed}: {cell} can be reached and was not visited");
                open.extend(cell.neighbours());
            }
        }
    }
}
