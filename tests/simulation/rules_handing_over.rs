//! Mission §13: a hand-over is recorded while a mission is under way, and nothing follows from it.

use hallsweep_core::closing::Closing;
use hallsweep_core::command::{Command, Note, Verdict};
use hallsweep_core::hand_over::HandOver;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::units::MissionId;

use crate::operator::{Operator, in_drawn};

fn hand_over(mission: Option<u64>) -> Command {
    Command::HandOver(HandOver { mission: mission.map(MissionId), to: Note::new("police").unwrap(), note: None })
}

#[test]
fn a_hand_over_is_recorded_while_a_mission_is_under_way_and_changes_nothing() {
    let mut run = in_drawn(&["S...", ".a..", "...."]);
    let idle = Err(Refused::NotInPhase(PhaseName::Idle));
    assert_eq!(run.give(hand_over(None)).map(drop), idle, "there is no mission yet");
    run.give(Command::Start).unwrap();
    run.until_pending();
    for stage in ["while a piece waits", "while stopped", "at the end", "closed"] {
        match stage {
            "while stopped" => drop(run.give(Command::Stop).unwrap()),
            "at the end" => {
                run.verdict(1, Verdict::Safe).unwrap();
                run.give(Command::Start).unwrap();
                run.until_explored();
            }
            "closed" => {
                let state = run.state();
                let seen = state.mission.open.code(state.mission.id).into();
                let name = Note::new("Anna Rossi").unwrap();
                run.give(Command::Close(Closing { name, note: None, seen })).unwrap();
            }
            _ => {}
        }
        let before = run.state();
        run.give(hand_over(Some(1))).unwrap();
        assert_eq!(run.give(hand_over(Some(2))).map(drop), Err(Refused::OtherMission(MissionId(1))), "{stage}");
        let after = run.state();
        assert_eq!((&before.mission, &before.luggage), (&after.mission, &after.luggage), "{stage}");
        assert_eq!(before.robot.led_blinking, after.robot.led_blinking, "{stage}");
        let told = after.log.iter().any(|line| line.said.to_string().contains("hand over to police"));
        assert!(told, "{stage}: {:?}", after.log);
    }
    assert!(run.state().mission.closed.is_some(), "a hand-over does not end the statement of the person in charge");
    run.give(Command::Reset).unwrap();
    assert_eq!(run.give(hand_over(Some(1))).map(drop), idle, "the mission was put away");
}
