//! Access by key, and the rights of each key. The table of roles and topics is tested beside the gate; these tests
//! check that each kind of refusal reaches real clients.

use super::client::{Client, Library};
use super::running::RunningClient;
use super::told::{Hello, Say};
use super::{AVAILABILITY, OURS, command, results, with_each};
use crate::access::{Folder, Site};
use crate::program::Program;

const ROBOT: &str = "hallsweep/discovery/state/robot";

/// HTTP stays open, so that tests can read the state. MQTT over WebSocket on the HTTP port is not tested here.
fn site(name: &str) -> Site {
    Site::new(name, &["MQTT__REQUIRE_PASSWORD"])
}

/// Runs a scenario with every client that uses the MQTT port.
fn with_each_by_tcp(scenario: impl Fn(Client)) {
    with_each(|client| {
        if !client.is_web() {
            scenario(client);
        }
    });
}

/// Safety A4.
#[test]
fn whoever_shows_no_key_or_a_wrong_one_is_told_so() {
    let site = site("mqtt-login");
    with_each_by_tcp(|client| {
        RunningClient::knock(client, &site.program, Hello::speaking()).until_refused(5);
        // One wrong key per client library, because the delay grows with each wrong key.
        let wrong = format!("{}0", &site.operator[1..]);
        let (name, password) = match client.library() {
            Library::Mosquitto => ("operator", &wrong),
            Library::Paho => ("lobby", &site.operator),
            Library::MqttJs => ("nobody", &site.operator),
        };
        RunningClient::knock(client, &site.program, Hello::speaking().with_login(name, password)).until_refused(4);
        RunningClient::begin(client, &site.program, Hello::speaking().with_login("operator", &site.operator)).leave();
    });
}

/// Safety A1: beyond loopback the broker asks for keys without a setting for it.
#[test]
fn a_broker_for_others_asks_for_keys() {
    let folder = Folder::new("mqtt-others");
    let mut command = folder.command(&["serve", "--http", "127.0.0.1:0", "--mqtt", "0.0.0.0:0", "--hall", "empty-8x8"]);
    let program = Program::started(&mut command);
    let operator = folder.token_of("operator");
    with_each_by_tcp(|client| {
        RunningClient::knock(client, &program, Hello::speaking()).until_refused(5);
        RunningClient::begin(client, &program, Hello::speaking().with_login("operator", &operator)).leave();
    });
}

/// Safety A1, A4, A6, S1.
#[test]
fn a_viewer_watches_and_stops_and_does_nothing_else() {
    let site = site("mqtt-viewer");
    with_each_by_tcp(|client| {
        let program = &site.program;
        let epoch = program.json("state")["mission"]["epoch"].as_u64().expect("an epoch");
        let mut viewer = RunningClient::begin(client, program, Hello::following(&[OURS], 1).with_login("lobby", &site.viewer));
        viewer.until_newest(AVAILABILITY, "it sees", |message| message.payload == "online");
        viewer.say(Say::plain(&command("start"), "{\"id\":\"v1\"}").at(1));
        let refused = viewer.until("a refusal", |heard| results(heard, "start").into_iter().find(|it| it["id"] == "v1"));
        assert_eq!(
            (&refused["accepted"], &refused["status"], &refused["code"]),
            (&false.into(), &403.into(), &"notAllowed".into())
        );
        viewer.say(Say::plain("unibo/qak/events", "msg(startCmd,event,js,none,startCmd,1)").at(1));
        program.command("start").accepted();
        viewer.say(Say::plain(&command("stop"), "").at(1));
        viewer.until("a result", |heard| results(heard, "stop").into_iter().find(|it| it["accepted"] == true));
        viewer.say(Say::plain("unibo/qak/events", "msg(stopCmd,event,js,none,stopCmd,1)").at(1));
        viewer.say(Say::plain(&command("move"), "{\"move\":\"h\"}").at(1));
        program.until("three stops", |state| state["mission"]["epoch"] == epoch + 3);
        viewer.leave();
    });
    let events = site.program.json("missions/1/events").to_string();
    assert!(events.contains("\"lobby\"") && events.contains("\"mqtt\""), "{events}");
}

/// Safety A4: messages on topics that only the program may publish reach nobody, and neither do messages of viewers.
#[test]
fn what_is_published_on_a_forbidden_topic_reaches_nobody() {
    let site = site("mqtt-topics");
    with_each_by_tcp(|client| {
        let login = |name| {
            Hello::following(&[ROBOT, "site/#"], 1).with_login(name, if name == "lobby" { &site.viewer } else { &site.operator })
        };
        let mut operator = RunningClient::begin(client, &site.program, login("operator"));
        let mut viewer = RunningClient::begin(client, &site.program, login("lobby"));
        operator.say(Say::plain(ROBOT, "forged").at(1).kept());
        for topic in [ROBOT, "site/lamp"] {
            viewer.say(Say::plain(topic, "forged").at(1).kept());
        }
        operator.say(Say::plain("site/lamp", "true").at(1));
        for process in [operator, viewer] {
            process.until_newest("site/lamp", "what may be said", |message| message.payload == "true");
            assert!(process.heard().iter().all(|message| message.payload != "forged"));
            process.leave();
        }
        let late = RunningClient::begin(client, &site.program, login("operator"));
        late.until_newest(ROBOT, "as it stands", |message| message.json() == site.program.json("state")["robot"]);
        assert!(late.heard().iter().all(|message| message.payload != "forged"), "nothing forged is kept");
        late.leave();
    });
}

#[test]
fn a_will_is_published_where_its_client_may_and_refused_elsewhere() {
    let site = site("mqtt-will");
    with_each_by_tcp(|client| {
        let operator = || Hello::speaking().with_login("operator", &site.operator);
        let start = command("start");
        for forbidden in [start.as_str(), "unibo/qak/events", ROBOT, AVAILABILITY] {
            let will = Say::plain(forbidden, "offline").at(1);
            RunningClient::knock(client, &site.program, operator().with_will(will)).until_refused(5);
        }
        let will = Say::plain("site/last", "gone").at(1);
        let viewer = Hello::speaking().with_login("lobby", &site.viewer).with_will(will);
        RunningClient::knock(client, &site.program, viewer).until_refused(5);

        let follow = Hello { follow: vec![("site/#", 1)], ..operator() };
        let mut witness = RunningClient::begin(client, &site.program, follow);
        let left = Say::plain("site/left", "gone").at(1);
        RunningClient::begin(client, &site.program, operator().with_will(left)).leave();
        RunningClient::begin(client, &site.program, operator().with_will(will)).break_off();
        witness.until_newest("site/last", "the will", |message| message.payload == "gone");
        witness.say(Say::plain("site/end", "").at(1));
        witness.until_newest("site/end", "the end", |_| true);
        // In MQTT 5 mosquitto's command asks for its will when it disconnects (reason 0x04), so it is excepted.
        if client != Client::MosquittoFive {
            assert!(witness.heard().iter().all(|message| message.topic != "site/left"), "who takes its leave leaves no will");
        }
        witness.leave();
    });
}

/// MQTT Explorer subscribes to `$SYS/#` at once. That filter is refused, and the others are served.
#[test]
fn a_filter_that_cannot_be_had_is_refused_and_the_connection_lives() {
    with_each(|client| {
        let program = Program::serve("empty-8x8", "max");
        let filters = ["$SYS/#", OURS, "$share/group/site/#"];
        let mut process = RunningClient::begin(client, &program, Hello::following(&filters, 1));
        assert_eq!(process.granted(), [128, 1, if client.is_five() { 1 } else { 128 }], "{client:?}");
        process.until_newest(AVAILABILITY, "it is served", |message| message.payload == "online");
        process.say(Say::plain(&command("stop"), "").at(1));
        process.until("a result", |heard| results(heard, "stop").pop());
        process.leave();
    });
}
