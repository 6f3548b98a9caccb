//! STOP has the same spellings at every interface: a table of what people and old clients write, tried at the real
//! program.

use crate::coap::client::Coap;
use crate::mqtt_attacks::client::Client;
use crate::mqtt_attacks::packets::connect;
use crate::program::Program;

/// Place of a written command.
#[derive(Clone, Copy, Debug)]
enum At {
    /// HTTP path, for a body without a content type.
    Http(&'static str),
    Coap(&'static str),
    Mqtt(&'static str),
}

use At::{Coap as C, Http as H, Mqtt as M};

const WORDS: [&str; 8] = ["h", "H", "stop", "STOP", " Stop\n", "\"h\"", "'h'", "'stop'"];

/// Places that accept a bare word.
const BARE: [At; 5] = [
    H("/api/v1/commands/move"),
    C("/resourcemodel"),
    C("/commands/move"),
    M("hallsweep/discovery/command"),
    M("hallsweep/discovery/command/move"),
];

const BODIES: [&str; 6] =
    [r#"{"move":"h"}"#, r#"{"move":"H"}"#, r#"{"move":" stop "}"#, r#"{"move":"h","zz":0}"#, r#"{"move":"h""#, "move=h"];

const MOVES: [At; 4] =
    [H("/api/v1/commands/move"), H("/console/move"), C("/commands/move"), M("hallsweep/discovery/command/move")];

/// Paths that are not STOP.
const OTHERS: [At; 5] = [H("/hh"), H("/%2568"), H("/h%3Fx"), H("/x/../h"), C("/commands/hh")];

/// STOP in the words of the original system, with every kind of quotes.
const OLD: [&str; 6] = [
    "msg(robotCmd,dispatch,js,robotmind,robotCmd(stop),1)",
    "msg(robotCmd,dispatch,js,robotmind,robotCmd('stop'),1)",
    "msg(robotCmd,dispatch,js,robotmind,robotCmd(\"stop\"),1)",
    "msg(userCmd,dispatch,js,robotmind,\"userCmd(H)\",1)",
    "msg(modelChange,dispatch,js,resourcemodel,modelChange(robot,\"h\"),1)",
    "msg(\"stopCmd\",event,js,none,stopCmd,1)",
];

/// Places that mean STOP whatever the body is.
const NAMED: [At; 16] = [
    H("/api/v1/commands/stop"),
    H("/api/v1/Commands/STOP/"),
    H("/api/v1/commands/h"),
    H("/console/stop"),
    H("/h"),
    H("/H/"),
    H("/%68%00"),
    H("/api%2Fv1%2Fcommands/st%6Fp%20"),
    H("/stopAppl"),
    C("/commands/stop"),
    C("/Commands/STOP/"),
    C("/commands/h"),
    M("hallsweep/discovery/command/stop"),
    M("hallsweep/discovery/command/STOP/"),
    M("hallsweep/discovery/command/h"),
    M("hallsweep/discovery/command/H"),
];

struct Doors {
    program: Program,
    coap: Coap,
    mqtt: Client,
}

impl Doors {
    fn say(&mut self, at: At, words: &str) {
        match at {
            H(path) => drop(self.program.send("POST", path, "text/plain", words)),
            C(path) => drop(self.coap.ask("POST", path, words).expect("the door answers")),
            M(topic) => self.mqtt.publish(topic, words.as_bytes()),
        }
    }

    fn epoch(&self) -> u64 {
        self.program.json("state")["mission"]["epoch"].as_u64().expect("an epoch")
    }

    fn halts(&mut self, at: At, words: &str) {
        let before = self.epoch();
        self.say(at, words);
        let wanted = format!("{at:?} {words:?} halts once");
        let state = self.program.until(&wanted, |state| state["mission"]["epoch"].as_u64() > Some(before));
        assert_eq!(state["mission"]["epoch"], before + 1, "{wanted}");
    }
}

/// Safety S1, S8.
#[test]
fn what_is_stop_at_one_door_is_stop_at_every_other() {
    for is_five in [false, true] {
        what_is_stop(is_five);
    }
}

/// Tries the table, in MQTT 5 if `is_five`.
fn what_is_stop(is_five: bool) {
    let program = Program::serve("empty-8x8", "max");
    let coap = Coap::at(program.coap());
    let mqtt = Client::try_speaking(program.mqtt(), &connect("words", 0), is_five).expect("the door opens");
    let mut doors = Doors { program, coap, mqtt };
    for at in NAMED {
        doors.halts(at, "");
        doors.halts(at, "whatever");
    }
    for (at, word) in BARE.into_iter().flat_map(|at| WORDS.map(|word| (at, word))) {
        doors.halts(at, word);
    }
    for (at, body) in MOVES.into_iter().flat_map(|at| BODIES.map(|body| (at, body))) {
        doors.halts(at, body);
    }
    for word in OLD {
        doors.halts(M("unibo/qak/robotmind"), word);
    }
    let before = doors.epoch();
    for (at, word) in
        BARE.into_iter().chain(MOVES).flat_map(|at| ["", "w", "hh", "stopp", r#"{"move":"w"}"#].map(|word| (at, word)))
    {
        doors.say(at, word);
    }
    OTHERS.into_iter().for_each(|at| doors.say(at, "h"));
    doors.halts(M("hallsweep/discovery/command/stop"), "");
    assert_eq!(doors.epoch(), before + 1, "nothing else halts");
}
