//! Attacks with a viewer's key: floods of refused packets, and more connections than the broker accepts. A STOP from
//! a new client or from a connected one still halts. The latency is measured in `benches`.

use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

use super::client::{Came, Client};
use super::packets::{CONNACK, PINGREQ, connect_as, packet, publish, subscribe, text};
use crate::access::Site;
use crate::journal::holds;
use crate::program::{Deadline, PATIENCE};

const STOP: &str = "hallsweep/discovery/command/stop";

/// Topic of the results of STOP.
const STOPPED: &str = "hallsweep/discovery/command/stop/result";

/// Number of STOPs by an operator beside a viewer that sends STOP without pause.
const PRESSES: usize = 20;

/// Number of connections, more than the broker accepts.
const CROWD: usize = 300;

/// A program whose MQTT interface asks for keys.
fn site(name: &str) -> Site {
    Site::new(name, &["MQTT__REQUIRE_PASSWORD"])
}

impl Site {
    fn viewer(&self, id: &str) -> Client {
        self.client(id, ("lobby", &self.viewer))
    }

    fn operator(&self, id: &str) -> Client {
        self.client(id, ("operator", &self.operator))
    }

    fn client(&self, id: &str, login: (&str, &str)) -> Client {
        let mut client = Client::silent(self.program.mqtt());
        client.say(&connect_as(id, login));
        assert_eq!(client.next(), Some(Came { first: CONNACK, body: vec![0, 0] }));
        client
    }

    /// Starts the robot, runs `stop`, and waits until the robot is held.
    fn halts(&self, stop: impl FnOnce()) {
        self.program.command("start").accepted();
        self.program.until("nothing holds the robot", |state| !holds(state, "operator"));
        stop();
        self.program.until("the stop holds the robot", |state| holds(state, "operator"));
    }
}

/// Floods that a viewer can send, each with a name.
fn floods() -> Vec<(&'static str, Vec<u8>)> {
    let filters: Vec<u8> = (0..20_000).flat_map(|n| text(&n.to_string())).collect();
    let deep: Vec<u8> = (0..64).flat_map(|n| [text(&format!("{}z{n}", "+/".repeat(16))), vec![0]].concat()).collect();
    let term = format!("msg(startCmd,event,{},none,startCmd,1)", "f(".repeat(30) + &"x".repeat(4000) + &")".repeat(30));
    vec![
        ("refused commands", publish("hallsweep/discovery/command/start", b"{}", 1, 0, 7).repeat(1000)),
        ("refused terms", publish("unibo/qak/robotmind", term.as_bytes(), 0, 0, 0).repeat(20)),
        ("pings", PINGREQ.repeat(10_000)),
        ("filters let go of", packet(0xA2, &[&[0, 1][..], &filters].concat())),
        ("deep filters", packet(0x82, &[&[0, 1][..], &deep].concat())),
        ("subscriptions", (0..500).flat_map(|n| subscribe(1, &format!("a/{}", n % 70), 0)).collect()),
    ]
}

/// Safety S1, S7: STOP from a new client, from a connected one, and over HTTP.
#[test]
fn a_stop_halts_whatever_a_viewer_floods_the_broker_with() {
    let site = site("viewer-floods");
    let mut kept = site.viewer("kept");
    for (what, flood) in floods() {
        let is_enough = AtomicBool::new(false);
        std::thread::scope(|scope| {
            for n in 0..2 {
                let (site, flood, is_enough) = (&site, &flood, &is_enough);
                scope.spawn(move || {
                    let mut client = site.viewer(&format!("flood-{n}"));
                    while !is_enough.load(Ordering::SeqCst) {
                        // The broker disconnects a client that reads no answers. The client connects again.
                        if client.mouth().write_all(flood).is_err() {
                            client = site.viewer(&format!("flood-{n}"));
                        }
                    }
                });
            }
            let _enough = Enough(&is_enough);
            site.halts(|| kept.publish(STOP, what.as_bytes()));
            site.halts(|| site.viewer("newcomer").publish(STOP, b""));
            site.halts(|| {
                site.program.command("stop").accepted();
            });
        });
    }
}

/// Safety S9: a viewer cannot occupy all places for results.
#[test]
fn an_operators_stop_has_its_result_beside_a_viewer_who_does_nothing_but_stop() {
    let site = site("viewer-stops");
    let mut operator = site.operator("panel");
    assert_eq!(operator.subscribe(STOPPED, 0), 0);
    let flood = publish(STOP, b"", 0, 0, 0).repeat(2_000);
    let is_enough = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for n in 0..2 {
            let (site, flood, is_enough) = (&site, &flood, &is_enough);
            scope.spawn(move || {
                let client = site.viewer(&format!("flood-{n}"));
                while !is_enough.load(Ordering::SeqCst) && client.mouth().write_all(flood).is_ok() {}
            });
        }
        let _enough = Enough(&is_enough);
        // The first result belongs to the flood, and shows that the flood has started.
        assert_eq!(operator.message().topic, STOPPED);
        for press in 0..PRESSES {
            let own = format!("press-{press}");
            operator.publish(STOP, format!(r#"{{"id":"{own}"}}"#).as_bytes());
            let deadline = Deadline::within(PATIENCE);
            while !String::from_utf8_lossy(&operator.message().payload).contains(&own) {
                assert!(!deadline.has_passed(), "{own} has no result");
            }
        }
    });
}

/// Ends the floods when it is dropped, even if the test fails.
struct Enough<'a>(&'a AtomicBool);

impl Drop for Enough<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

/// Safety S9.
#[test]
fn one_viewer_with_three_hundred_connections_keeps_nobody_out() {
    let site = site("viewer-crowd");
    let mut before = site.operator("before");
    let crowd: Vec<Client> = (0..CROWD).map(|n| site.viewer(&n.to_string())).collect();
    site.halts(|| before.publish(STOP, b""));
    let mut newcomers: Vec<Client> = (0..20).map(|n| site.operator(&format!("operator-{n}"))).collect();
    for newcomer in &mut newcomers {
        newcomer.settle();
    }
    site.halts(|| newcomers[0].publish(STOP, b""));
    site.halts(|| site.viewer("last").publish(STOP, b""));
    before.settle();
    drop(crowd);
}

/// Safety S1: the broker slows a flood down while subscribers read nothing, but a STOP at the end of the flood does
/// not wait.
#[test]
fn a_stop_behind_its_senders_own_flood_halts_although_subscribers_read_nothing() {
    let site = site("own-flood");
    let mut stalled: Vec<Client> = (0..2).map(|n| site.operator(&format!("stalled-{n}"))).collect();
    for stalled in &mut stalled {
        assert_eq!(stalled.subscribe("#", 1), 1);
    }
    let mut sender = site.operator("sender");
    let flood = publish("sensors/door", &[7; 1000], 0, 0, 0).repeat(4 * 1024);
    for _ in 0..3 {
        site.halts(|| {
            sender.say(&flood);
            sender.publish(STOP, b"");
        });
    }
}
