//! Tests of the limits of commands: STOP beyond the limits, repeated commands, and commands that get no answer.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{mpsc, watch};

use super::testing::{app, commands_of, here, next, operator, say, topics, viewer};
use super::*;
use crate::api::tests::fixture::searching;
use crate::runtime::clock::Clock;
use crate::runtime::halt::Halter;
use crate::runtime::handle::{COMMANDS, Envelope};
use crate::runtime::link::link;
use crate::runtime::store::{Store, StoreStatus};
use crate::runtime::task::{Course, Task};
use crate::runtime::tests::within::within;
use hallsweep_core::effect::Page;
use hallsweep_core::engine::Engine;
use hallsweep_core::event::{Capabilities, RobotEvent};
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::{Parts, RobotId};
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;

/// Maximum number of commands under way when no keys are used.
const UNDER_WAY: usize = 256;

/// A loop that never handles its commands.
struct Hanging {
    handle: Handle,
    envelopes: mpsc::Receiver<Envelope>,
    halter: Halter,
    _publish: watch::Sender<Arc<Snapshot>>,
}

fn hanging() -> Hanging {
    let (commands, envelopes) = mpsc::channel(COMMANDS);
    let publish = watch::Sender::new(Arc::new(searching()));
    let halter = Halter::new(Epoch(4));
    let handle = Handle::new(commands, publish.subscribe(), halter.clone());
    Hanging { handle, envelopes, halter, _publish: publish }
}

/// Safety S1: the robot has been halted when the call returns, even if the loop hangs.
#[tokio::test]
async fn a_stop_halts_at_the_call_although_the_loop_hangs_and_every_place_is_taken() {
    let Hanging { handle, envelopes: _envelopes, halter, _publish } = hanging();
    let (commands, _results) = commands_of(handle, false);
    let halts = halter.watch();
    for count in 1..=3 * UNDER_WAY as u64 {
        // Commands above the sender's rate are refused, but no STOP is.
        let _ = say(&commands, "command/start", "", &here());
        assert_eq!(say(&commands, "command/stop", "garbage", &here()), Taken::Taken);
        assert_eq!((halts.now().count, halts.now().epoch), (count, Epoch(4 + count)));
    }
}

/// Safety A5.
#[tokio::test]
async fn only_so_many_commands_are_under_way_and_one_more_is_told_so() {
    let Hanging { handle, mut envelopes, halter, _publish } = hanging();
    let (commands, mut results) = commands_of(handle, false);
    for _ in 0..UNDER_WAY {
        say(&commands, "command/start", "", &here());
    }
    say(&commands, "command/goto", r#"{"x":1,"y":1,"id":"k1"}"#, &here());
    let (topic, json) = next(&mut results).await;
    assert_eq!(topic, "command/goto/result");
    assert_eq!((&json["id"], &json["status"], &json["code"]), (&"k1".into(), &503.into(), &"tooMany".into()));
    assert!(json["detail"].as_str().unwrap().contains("256 commands are under way"), "{json}");
    say(&commands, "command/stop", "", &here());
    assert_eq!(halter.watch().now().count, 1);

    let Some(Envelope::Command(_, answer)) = within("a command", envelopes.recv()).await else { panic!("a command was given") };
    answer.send(Err(Refused::Moving)).unwrap();
    assert_eq!(next(&mut results).await.1["code"], "moving");
    // The place becomes free after the result is published, in the same turn of the same task.
    tokio::task::yield_now().await;
    say(&commands, "command/goto", r#"{"x":1,"y":1,"id":"k2"}"#, &here());
    let came = std::iter::from_fn(|| envelopes.try_recv().ok());
    let names = came.filter_map(|envelope| match envelope {
        Envelope::Command(request, _) => request.id.map(|id| id.text().to_owned()),
        Envelope::Refused(..) | Envelope::Simulated(..) | Envelope::PutDown(..) => None,
    });
    assert_eq!(names.collect::<Vec<_>>(), ["k2"]);
}

/// Safety S9: an operator's STOP gets a place among the commands under way, and one among the answers waiting to be
/// sent.
#[tokio::test]
async fn an_operators_stop_has_its_result_however_many_a_viewer_and_another_operator_have_given() {
    let (handle, _script) = crate::runtime::tests::obedient::obedient(searching());
    let (answers, mut results) = mpsc::channel(ANSWERS);
    let commands = Commands::new(handle, topics(), false, answers);
    let (greedy, wall, panel) = (operator("greedy"), viewer(), operator("panel"));
    for _ in 0..3 {
        for _ in 0..UNDER_WAY {
            say(&commands, "command/stop", "", &wall);
            say(&commands, "command/stop", "", &greedy);
        }
        tokio::task::yield_now().await;
    }
    say(&commands, "command/stop", r#"{"id":"own"}"#, &panel);
    for _ in 0..8 {
        tokio::task::yield_now().await;
    }
    let came: Vec<_> = std::iter::from_fn(|| results.try_recv().ok()).map(|answer| answer.taken().payload).collect();
    assert_eq!(came.len(), 32 + 128 + 1, "half of the places for each key, and of a viewer's there are fewer");
    assert!(came.last().is_some_and(|last| last.windows(10).any(|part| part == br#""id":"own""#)), "{:?}", came.last());
}

#[tokio::test]
async fn results_for_which_there_is_no_room_are_lost_and_nothing_else() {
    let (handle, script) = crate::runtime::tests::obedient::obedient(searching());
    let (answers, mut results) = mpsc::channel(1);
    let commands = Commands::new(handle, topics(), false, answers);
    for _ in 0..5 {
        say(&commands, "command/start", "", &here());
        say(&commands, "command/dance", "", &here());
    }
    for _ in 0..8 {
        tokio::task::yield_now().await;
    }
    assert_eq!(script.given.lock().unwrap().len(), 5);
    assert_eq!(next(&mut results).await.0, "command/dance/result");
    assert!(results.try_recv().is_err());
    drop(results);
    assert_eq!(say(&commands, "command/start", "", &here()), Taken::Taken, "nobody has to listen");
}

#[tokio::test(start_paused = true)]
async fn nobody_waits_for_ever() {
    let Hanging { handle, envelopes: _envelopes, halter: _halter, _publish } = hanging();
    let (commands, mut results) = commands_of(handle, false);
    say(&commands, "command/start", r#"{"id":"k1"}"#, &here());
    let (_, json) = next(&mut results).await;
    assert_eq!((&json["id"], &json["status"], &json["code"]), (&"k1".into(), &503.into(), &"noAnswer".into()));
    assert!(json["detail"].as_str().unwrap().contains("read the state before you repeat the command"), "{json}");
}

#[tokio::test]
async fn a_program_that_ends_says_so() {
    let Hanging { handle, envelopes, halter: _halter, _publish } = hanging();
    drop(envelopes);
    let (commands, mut results) = commands_of(handle, false);
    for name in ["start", "stop"] {
        say(&commands, &format!("command/{name}"), "", &here());
        let (_, json) = next(&mut results).await;
        assert_eq!((&json["status"], &json["code"]), (&503.into(), &"shuttingDown".into()), "{name}");
    }
}

#[tokio::test]
async fn commands_keep_the_order_in_which_they_came() {
    let app = app(searching());
    for x in 0..50 {
        app.say("command/goto", format!(r#"{{"x":{x},"y":0,"id":"k{x}"}}"#));
    }
    app.last().await;
    let given = app.script.given.lock().unwrap();
    let names = given.iter().filter_map(|request| request.id.as_ref().map(|id| id.text().to_owned()));
    assert_eq!(names.collect::<Vec<_>>(), (0..50).map(|x| format!("k{x}")).collect::<Vec<_>>());
}

/// A store that stores nothing, but reports at once that everything is stored.
struct Forgetful(watch::Sender<StoreStatus>);

impl Store for Forgetful {
    fn record(&mut self, page: Page, _losses: u64) {
        self.0.send_modify(|word| word.kept = page.last());
    }

    fn word(&self) -> watch::Receiver<StoreStatus> {
        self.0.subscribe()
    }
}

/// Uses the real loop. Its robot has just connected and does nothing.
#[tokio::test]
async fn a_command_that_comes_again_under_its_name_acts_once_and_is_answered_as_before() {
    let halter = Halter::new(Epoch(0));
    let (loop_side, robot) = link(halter.watch());
    let engine = Engine::new(Settings::default(), Default::default(), "test".into());
    let store = Box::new(Forgetful(watch::Sender::new(StoreStatus::default())));
    let (handle, task) = Task::new(engine, [(RobotId::discovery(), loop_side)], store, Clock::default(), halter);
    let (_course, coursed) = watch::channel(Course::default());
    tokio::spawn(task.run(coursed));
    let second = Duration::from_secs(1);
    robot
        .reports
        .send(RobotEvent::LinkUp(Capabilities {
            step: second,
            turn: second,
            photo: second,
            arm: Duration::ZERO,
            nudges: false,
            parts: Parts::ROUND_ROBOT,
        }))
        .await
        .unwrap();
    let (commands, mut results) = commands_of(handle.clone(), false);

    say(&commands, "command/start", r#"{"id":"k1"}"#, &here());
    let (_, first) = next(&mut results).await;
    assert_eq!((&first["id"], &first["accepted"]), (&"k1".into(), &true.into()));
    say(&commands, "command/stop", "", &here());
    assert_eq!(next(&mut results).await.1["accepted"], true);
    say(&commands, "command/start", r#"{"id":"k1"}"#, &here());
    assert_eq!(next(&mut results).await.1, first, "it is answered as before");
    let holds = handle.snapshot().mission.holds.clone();
    assert!(holds.contains(&hallsweep_core::hold::Hold::Operator), "and does not act again");

    say(&commands, "command/backHome", r#"{"id":"k1"}"#, &here());
    let (_, json) = next(&mut results).await;
    assert_eq!((&json["status"], &json["code"]), (&422.into(), &"otherContent".into()));
}
