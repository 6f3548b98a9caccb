//! Sessions: a client that returns receives the messages of its absence, and of two clients with one id only one
//! stays.

use super::client::Client;
use super::running::RunningClient;
use super::told::{Hello, Say};
use super::{AVAILABILITY, with_each};
use crate::program::Program;

const NEWS: &str = "site/news";

#[test]
fn a_client_that_is_remembered_gets_what_was_said_while_it_was_away() {
    with_each(|client| {
        let program = Program::serve("empty-8x8", "max");
        let hello = || Hello::following(&[NEWS], 1).remembered("night-shift");
        let mut writer = RunningClient::begin(client, &program, Hello::speaking());
        let first = RunningClient::begin(client, &program, hello());
        writer.say(Say::plain(NEWS, "0").at(1));
        first.until_newest(NEWS, "it is there", |message| message.payload == "0");
        first.leave();
        writer.say_all(&[Say::plain(NEWS, "1").at(1), Say::plain(NEWS, "2").at(2)]);
        let second = RunningClient::begin(client, &program, hello());
        second.until_newest(NEWS, "said meanwhile", |message| message.payload == "2");
        writer.say(Say::plain(NEWS, "3").at(1));
        second.until_newest(NEWS, "said now", |message| message.payload == "3");
        let heard: Vec<String> = second.heard().into_iter().map(|message| message.payload).collect();
        assert_eq!(heard, ["1", "2", "3"], "{client:?}");
        second.break_off();
        writer.say(Say::plain(NEWS, "4").at(1));
        let third = RunningClient::begin(client, &program, hello());
        third.until_newest(NEWS, "said after it broke off", |message| message.payload == "4");
        third.leave();
    });
}

#[test]
fn a_client_that_is_not_remembered_gets_what_is_said_from_now_on() {
    with_each(|client| {
        let program = Program::serve("empty-8x8", "max");
        let hello = || Hello::following(&[NEWS], 1).called("passer-by");
        let mut writer = RunningClient::begin(client, &program, Hello::speaking());
        RunningClient::begin(client, &program, hello()).leave();
        writer.say(Say::plain(NEWS, "1").at(1));
        let again = RunningClient::begin(client, &program, hello());
        writer.say(Say::plain(NEWS, "2").at(1));
        again.until_newest(NEWS, "said now", |message| message.payload == "2");
        assert_eq!(again.heard().len(), 1, "{client:?}");
        again.leave();
    });
}

/// The later client keeps the id (MQTT 3.1.1, section 3.1.4).
#[test]
fn of_two_clients_with_one_id_the_later_stays() {
    // Mosquitto's command would reconnect at once and displace the other client in turn.
    for client in Client::ALL.into_iter().filter(|client| !client.is_mosquitto() && client.is_here()) {
        let program = Program::serve("empty-8x8", "max");
        let hello = || Hello::following(&[NEWS, AVAILABILITY], 1).called("twin");
        let first = RunningClient::begin(client, &program, hello());
        let mut second = RunningClient::begin(client, &program, hello());
        first.until_word("Closed");
        second.say(Say::plain(NEWS, "for the later").at(1));
        second.until_newest(NEWS, "it serves", |message| message.payload == "for the later");
        assert!(first.heard().iter().all(|message| message.topic != NEWS));
    }
}

/// Keepalive 0 lets a client be silent without limit (section 3.1.2.10).
#[test]
fn a_client_without_a_keepalive_is_served() {
    // Mosquitto's command does not accept keepalive 0.
    for client in Client::ALL.into_iter().filter(|client| !client.is_mosquitto() && client.is_here()) {
        let program = Program::serve("empty-8x8", "max");
        let mut silent = RunningClient::begin(client, &program, Hello { keepalive_s: 0, ..Hello::following(&[NEWS], 1) });
        silent.say(Say::plain(NEWS, "heard").at(2));
        silent.until_newest(NEWS, "it is served", |message| message.payload == "heard");
        silent.leave();
    }
}
