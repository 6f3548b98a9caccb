//! Whole missions over the old topics alone, driven and watched by one client, which reads the state in the words of
//! the resource model and sends commands in the words of the old console. The last state that it saw is the real one.

use serde_json::Value;

use super::client::Client;
use super::old_words::{EVENTS, check_numbers, event, luggage, map, model, newest, piece, robot};
use super::running::RunningClient;
use super::told::{Hello, Say};
use super::with_each;
use crate::program::{Program, hallsweep};

/// An old console that is connected to a program.
struct Console<'a> {
    process: RunningClient<'a>,
    qos: u8,
}

impl Console<'_> {
    fn of(client: Client, program: &Program) -> Console<'static> {
        // QoS 0, as in the old console. Mosquitto publishes each message from a new process, and only an
        // acknowledgement (QoS 1) keeps their order.
        let qos = u8::from(client.is_mosquitto());
        Console { process: RunningClient::begin(client, program, Hello::following(&[EVENTS], 0)), qos }
    }

    fn say(&mut self, name: &str) {
        self.process.say(Say::plain(EVENTS, &event(name)).at(self.qos));
    }

    fn tell(&mut self, actor: &str, name: &str, content: &str) {
        let message = format!("msg({name},dispatch,js,{actor},{content},1)");
        self.process.say(Say::plain(&format!("unibo/qak/{actor}"), &message).at(self.qos));
    }

    /// Waits until this piece is shown.
    fn until_piece(&self, number: u64) {
        self.process.until(&format!("luggage {number}"), |heard| (piece(heard) == Some(number)).then_some(()));
    }

    fn until_newest(&self, head: &str, wanted: &str) {
        self.process.until(wanted, |heard| (newest(heard, head) == Some(wanted)).then_some(()));
    }

    /// Waits until a command is refused with a reason that contains these words.
    fn until_refused(&self, words: &str) {
        let says = |(content, number): (&str, u64)| number == 0 && content.contains("refused: ") && content.contains(words);
        self.process.until(words, |heard| model(heard).into_iter().any(says).then_some(()));
    }

    /// Waits until the robot stands at home.
    fn until_home(&self) {
        let is_home = |item: &str| item.contains("state(stopped)") && item.contains("position(0,0)");
        self.process.until("the robot at home", |heard| newest(heard, "robot").is_some_and(is_home).then_some(()));
    }

    /// Fails unless the newest message of each kind matches the state byte for byte, and no message is missing.
    fn shows_what_stands(self, program: &Program) {
        let state = program.json("state");
        self.until_newest("robot", &robot(&state));
        self.until_newest("roomMap", &map(program));
        self.until_newest("luggage", &luggage(&state));
        check_numbers(&self.process.heard());
        self.process.leave();
    }
}

fn holds(state: &Value, hold: &str) -> bool {
    state["mission"]["holds"].as_array().is_some_and(|holds| holds.iter().any(|it| it == hold))
}

/// One piece is safe, and the next is dangerous. STOP and heat hold the robot in between.
fn a_bomb_is_found(client: Client) {
    if !client.is_here() {
        return;
    }
    let program = Program::serve("seed", "max");
    let mut console = Console::of(client, &program);
    console.say("startCmd");
    console.until_piece(1);
    console.say("stopCmd");
    console.say("luggageSafe");
    let state = program.until("the verdict", |state| state["luggage"][0]["verdict"] == "safe");
    assert!(holds(&state, "operator"), "{state:#}");
    console.say("startCmd");
    console.until_piece(2);
    console.say("temperatureTooHigh");
    console.say("luggageDanger");
    console.say("startCmd");
    let state = program.until_phase("returningWithAlarm");
    assert!(holds(&state, "tooHigh"), "{state:#}");
    console.until_refused("temperature");
    console.say("temperatureOk");
    console.say("startCmd");
    console.until_home();
    program.until_phase("bombLocated");
    console.say("startCmd");
    console.until_refused("reachBag");
    console.say("reachBag");
    program.until_phase("bagSecured");
    console.shows_what_stands(&program);
}

#[test]
fn mosquitto_finds_a_bomb_over_the_old_topics() {
    a_bomb_is_found(Client::Mosquitto);
}

#[test]
fn mosquitto_finds_a_bomb_over_the_old_topics_in_mqtt_5() {
    a_bomb_is_found(Client::MosquittoFive);
}

#[test]
fn paho_finds_a_bomb_over_the_old_topics() {
    a_bomb_is_found(Client::Paho);
}

#[test]
fn paho_finds_a_bomb_over_the_old_topics_in_mqtt_5() {
    a_bomb_is_found(Client::PahoFive);
}

#[test]
fn mqtt_js_finds_a_bomb_over_the_old_topics() {
    a_bomb_is_found(Client::MqttJs);
}

#[test]
fn mqtt_js_in_a_browser_finds_a_bomb_over_the_old_topics() {
    a_bomb_is_found(Client::MqttJsWeb);
}

#[test]
fn mqtt_js_in_a_browser_finds_a_bomb_over_the_old_topics_in_mqtt_5() {
    a_bomb_is_found(Client::MqttJsWebFive);
}

/// Every piece is safe, and the robot is sent home once during the search.
fn everything_is_safe(client: Client) {
    if !client.is_here() {
        return;
    }
    let program = Program::serve("seed", "max");
    let mut console = Console::of(client, &program);
    console.tell("robotmind", "startCmd", "startCmd");
    console.until_piece(1);
    console.say("backHomeCmd");
    console.until_home();
    program.until_phase("atHome");
    console.tell("robotmind", "luggageSafe", "luggageSafe");
    console.say("explore");
    console.until_piece(2);
    console.say("luggageSafe");
    console.until_piece(3);
    console.say("continueExploreAfterPhoto");
    console.until_home();
    program.until_phase("explored");
    console.shows_what_stands(&program);
}

#[test]
fn mosquitto_explores_a_hall_over_the_old_topics() {
    everything_is_safe(Client::Mosquitto);
}

#[test]
fn paho_explores_a_hall_over_the_old_topics() {
    everything_is_safe(Client::Paho);
}

#[test]
fn mqtt_js_explores_a_hall_over_the_old_topics() {
    everything_is_safe(Client::MqttJs);
}

/// The camera sometimes fails. The old console is told of it and of the reason why SAFE is refused; `continueExplore`
/// takes the photo again.
#[test]
fn a_hall_is_explored_over_the_old_topics_although_the_camera_fails() {
    with_each(|client| {
        let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0", "--seed", "1", "--hall", "seed", "--speed", "max"]);
        let program = Program::started(command.env("HALLSWEEP__ROBOT__PHOTO_FAILURE_RATE", "0.6"));
        let mut console = Console::of(client, &program);
        console.say("startAppl");
        let (mut refused, mut seen) = (0, 0);
        for number in 1..=3 {
            // Next message about a piece since the console's last action.
            let told = |console: &Console, seen: usize| {
                console.process.until("what is told of a piece", |heard| {
                    let told: Vec<&str> =
                        model(heard).into_iter().map(|(content, _)| content).filter(|it| it.contains("luggage(")).collect();
                    (told.len() > seen).then(|| (told[seen].to_owned(), seen + 1))
                })
            };
            loop {
                let (piece, next) = told(&console, seen);
                seen = next;
                if !piece.contains(&format!("photo {number} failed")) {
                    assert!(piece.contains(&format!("photo {number},")), "{piece}");
                    break;
                }
                console.say("luggageSafe");
                let (why, next) = told(&console, seen);
                assert!(why.contains("refused: ") && why.contains("no usable photo") && why.contains("continueExplore"), "{why}");
                (seen, refused) = (next, refused + 1);
                console.say("continueExplore");
            }
            console.say("continueExploreAfterPhoto");
        }
        console.until_home();
        let state = program.until_phase("explored");
        assert!(state["luggage"].as_array().unwrap().iter().all(|piece| piece["verdict"] == "safe"), "{state:#}");
        assert!(refused > 0, "the camera has failed");
        console.shows_what_stands(&program);
    });
}

/// STOP as an event, as a dispatch, and as the halt among the robot's own commands.
#[test]
fn every_client_stops_a_robot_that_moves() {
    with_each(|client| {
        let program = Program::serve("empty-8x8", "4");
        let mut console = Console::of(client, &program);
        let stops: [&dyn Fn(&mut Console); 3] =
            [&|console| console.say("stopCmd"), &|console| console.tell("robotmind", "stopCmd", "stopCmd"), &|console| {
                console.tell("robotmind", "userCmd", "userCmd(h)")
            }];
        for stop in stops {
            console.say("startCmd");
            program.until("it goes on", |state| !holds(state, "operator") && state["mission"]["phase"] == "exploring");
            console.process.until("a robot that moves", |heard| newest(heard, "robot")?.contains("state(moving").then_some(()));
            stop(&mut console);
            let state = program.until("it stands", |state| holds(state, "operator") && state["robot"]["state"] == "stopped");
            console.until_newest("robot", &robot(&state));
        }
        console.process.leave();
    });
}
