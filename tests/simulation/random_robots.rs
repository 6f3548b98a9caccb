//! A robot and a store that answer arbitrarily: late, with failures, with obstacles anywhere and a sonar that reports
//! anything, between random commands and with any strategy. The core must neither panic nor loop, move nothing while
//! held, and answer every command once the store works. A failure prints its seed.

use hallsweep_core::command::{Command, LuggageRef, Move, TemperatureReport, Verdict};
use hallsweep_core::effect::{Action, Effect};
use hallsweep_core::event::{Ahead, Event, Obstacle, RobotEvent};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::settings::Settings;
use hallsweep_core::units::{AlarmId, Cell, LuggageId, Piece, Ticket};

use crate::bare::Bare;
use crate::random_halls::in_turn;

#[test]
fn whatever_robot_and_store_answer_the_core_keeps_its_rules() {
    for seed in 0..1500 {
        let mut dice = RandomStream::new(seed, "robots");
        let (_, settings, strategy) = in_turn(seed, Settings::default());
        let mut bare = Bare::searching_by(strategy, settings);
        bare.link_up();
        let mut tickets: Vec<Ticket> = Vec::new();
        for _ in 0..150 {
            bare.keeps = dice.below(3) > 0;
            bare.effects.clear();
            match dice.below(8) {
                0..=2 => tickets.extend(bare.give(any_command(&mut dice)).ok()),
                3 => bare.keep(),
                4 => from_outside(&mut dice, &mut bare),
                _ => answer(&mut dice, &mut bare),
            }
            check(&mut bare, seed);
        }
        bare.keeps = true;
        bare.event(Event::StoreRestored);
        bare.keep();
        if bare.engine.poll_timeout().is_some() {
            // The answer to a STOP waits for a silent robot, but only for a limited time.
            bare.wait_in_vain();
        }
        let open: Vec<&Ticket> = tickets.iter().filter(|ticket| bare.answer(**ticket).is_none()).collect();
        assert!(open.is_empty(), "seed {seed}: {open:?} were never answered");
        let answered = |ticket: &Ticket| bare.answers.iter().filter(|(to, _)| to == ticket).count();
        assert!(tickets.iter().all(|ticket| answered(ticket) == 1), "seed {seed}: a command was answered twice");
    }
}

fn any_command(dice: &mut RandomStream) -> Command {
    let luggage = LuggageRef::Id(LuggageId(1 + dice.below(4)));
    match dice.below(14) {
        0..=4 => Command::Start,
        5 => Command::Stop,
        6 => Command::BackHome,
        7 | 8 => Command::Verdict { luggage, verdict: Verdict::Safe, note: None, hot: Default::default() },
        9 => Command::Verdict { luggage, verdict: Verdict::Danger, note: None, hot: Default::default() },
        10 => Command::Goto(Cell::new(dice.below(6) as i32, dice.below(6) as i32)),
        11 => Command::Move(Move::Forward),
        12 => match dice.below(3) {
            0 => Command::Temperature(TemperatureReport::TooHigh),
            1 => Command::Reset,
            _ => Command::Acknowledge(AlarmId(1)),
        },
        _ => Command::Temperature(TemperatureReport::Ok),
    }
}

fn from_outside(dice: &mut RandomStream, bare: &mut Bare) {
    match dice.below(6) {
        0 => {
            bare.takes_back();
            bare.robot(RobotEvent::LinkLost("cable".to_owned()));
        }
        1 | 2 => bare.link_up(),
        3 => bare.event(Event::StoreFailed("disk full".to_owned())),
        _ if bare.state().mission.store_failure.is_some() => bare.event(Event::StoreRestored),
        _ => {}
    }
}

/// The robot completes its order, meets an obstacle, fails, or is silent too long.
fn answer(dice: &mut RandomStream, bare: &mut Bare) {
    let Some(action) = bare.order() else { return };
    let photo = matches!(action, Action::Photograph(_));
    let forward = action == Action::Move(Move::Forward);
    match dice.below(20) {
        0 if forward => bare.meets(Obstacle::Luggage(Piece(dice.below(3) as u32))),
        1 if forward => bare.meets(Obstacle::Unknown),
        2 if forward => bare.meets(Obstacle::Wall { left: dice.below(3) as u16, right: dice.below(3) as u16 }),
        3 if photo => bare.photo_fails(),
        4 if bare.engine.poll_timeout().is_some() => bare.wait_in_vain(),
        5 => {
            let order = bare.takes_back().expect("an order is under way");
            bare.robot(RobotEvent::Failed(order.id, "wheel".to_owned()));
        }
        _ if photo => bare.photo(),
        6..=9 => {
            let obstacle = [None, Some(Obstacle::Unknown), Some(Obstacle::Luggage(Piece(7)))][dice.below(3) as usize];
            bare.robot(RobotEvent::Ahead(Ahead { free: dice.below(4) as u16, obstacle }));
            bare.done();
        }
        _ => bare.done(),
    }
}

fn check(bare: &mut Bare, seed: u64) {
    let state = bare.state();
    bare.record.check(&state, seed);
    let at_home = matches!(state.mission.phase, PhaseName::AtHome | PhaseName::BombLocated | PhaseName::Explored);
    let is_home = state.robot.pose.cell == Cell::HOME && !state.robot.off_centre;
    assert!(!at_home || is_home, "seed {seed}: {:?} away from home", state.mission.phase);
    let ordered = bare.effects.iter().any(|effect| matches!(effect, Effect::Order(_, order) if order.action.is_motion()));
    let halted = bare.effects.contains(&Effect::Halt(hallsweep_core::robot::RobotId::discovery()));
    assert!(!ordered || halted || state.mission.holds.is_empty(), "seed {seed}: told to move under {:?}", state.mission.holds);
    let danger = state.luggage.iter().any(|luggage| luggage.is_dangerous());
    assert!(!danger || !state.robot.led_blinking, "seed {seed}: the LED blinks after danger");
}
