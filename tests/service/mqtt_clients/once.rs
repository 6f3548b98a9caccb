//! A message acts as a command once, when it is published: repetitions do not act again, and a later client does not
//! trigger it again.

use serde_json::Value;

use super::running::RunningClient;
use super::told::{Hello, Message, Say};
use super::{AVAILABILITY, command, results, with_each};
use crate::program::Program;

/// Number of STOPs so far: each STOP raises the epoch by one.
fn stops(program: &Program) -> u64 {
    program.json("state")["mission"]["epoch"].as_u64().expect("an epoch")
}

#[test]
fn a_command_acts_once_at_every_qos() {
    with_each(|client| {
        let program = Program::serve("empty-8x8", "max");
        let stop = command("stop");
        let mut process =
            RunningClient::begin(client, &program, Hello::following(&["hallsweep/discovery/command/stop/result"], 1));
        for (given, qos) in [(1, 0), (2, 1), (3, 2)] {
            process.say(Say::plain(&stop, "").at(qos));
            process.until("a result of each", |heard| (results(heard, "stop").len() == given).then_some(()));
        }
        process.say(Say::plain("unibo/qak/events", "msg(stopCmd,event,js,none,stopCmd,1)").at(2));
        process.say(Say::plain("unibo/qak/events", "msg(stopCmd,event,js,none,stopCmd,1)").at(1));
        program.until("two more", |state| state["mission"]["epoch"].as_u64() >= Some(5));
        process.leave();
        assert_eq!(stops(&program), 5);
    });
}

/// Safety S4, for messages with the retain flag: a START acts when it is published, and never again.
#[test]
fn a_command_that_was_to_be_kept_acts_when_it_is_said_and_not_later() {
    with_each(|client| {
        let program = Program::serve("empty-8x8", "4");
        let (start, events) = (command("start"), "unibo/qak/events");
        let mut process = RunningClient::begin(client, &program, Hello::speaking());
        process.say(Say::plain(&start, "").at(1).kept());
        program.until_phase("exploring");
        process.say(Say::plain(&command("stop"), "").at(1).kept());
        process.say(Say::plain(events, "msg(stopCmd,event,js,none,stopCmd,1)").at(1).kept());
        let stands = |state: &Value| state["mission"]["epoch"] == 2 && state["robot"]["state"] == "stopped";
        program.until("both stops", stands);
        process.leave();
        let filters = ["hallsweep/discovery/command/#", "unibo/#", AVAILABILITY];
        let late = RunningClient::begin(client, &program, Hello::following(&filters, 1));
        late.until_newest(AVAILABILITY, "online", |message| message.payload == "online");
        late.leave();
        let late = RunningClient::begin(client, &program, Hello::following(&filters, 1));
        late.until_newest(AVAILABILITY, "online", |message| message.payload == "online");
        let kept: Vec<Message> = late.heard().into_iter().filter(|message| message.kept).collect();
        assert!(kept.iter().all(|message| message.topic == AVAILABILITY), "{kept:#?}");
        late.leave();
        assert!(stands(&program.json("state")), "nothing was carried out again");
    });
}
