//! Many observers on a bad network, in simulated time: a hundred of them observe a thing that changes sixty times in a
//! minute.

use std::time::Duration;

use crate::rig::client::ask::Ask;
use crate::rig::each_seed;
use crate::rig::network::Weather;
use crate::rig::scene::Scene;

const OBSERVERS: u16 = 100;
const SEEDS: u64 = 20;
const LAST: &[u8] = b"seen 60";

/// How many of a hundred observers had the last state.
struct Held {
    /// Half a minute after the last change.
    soon: usize,
    /// After Max-Age ran out and they registered again.
    at_last: usize,
}

fn scene(seed: u64, loss: f64) -> Held {
    let mut scene = Scene::crowd(seed, Weather { loss, double: 0.01, delay_ms: (1, 100) }, OBSERVERS);
    let tokens: Vec<Vec<u8>> = (0..usize::from(OBSERVERS)).map(|n| scene.begin_of(n, Ask::observe("/obs"))).collect();
    for turn in 1..=60 {
        scene.wait(Duration::from_secs(1));
        scene.change(|server| server.set("/obs", format!("seen {turn}")));
    }
    let count = |scene: &Scene| {
        let held = scene.clients.iter().zip(&tokens).filter(|(client, token)| client.held(token) == Some(LAST));
        held.count()
    };
    scene.wait(Duration::from_secs(30));
    let soon = count(&scene);
    // Max-Age, and twice the time that a client takes to notice and to ask with all its retransmissions.
    scene.wait(Duration::from_secs(60 + 2 * (5 + 93)));
    Held { soon, at_last: count(&scene) }
}

/// `least` is the share of observers with the last state soon after the change, for the worst seed and for all
/// together.
fn check(loss: f64, least: f64) {
    let all = std::cell::Cell::new(0);
    each_seed(SEEDS, |seed| {
        let held = scene(seed, loss);
        all.set(all.get() + held.soon);
        assert_eq!(held.at_last, usize::from(OBSERVERS), "all must hold it after they registered again; {} did soon", held.soon);
    });
    let share = f64::from(u32::try_from(all.get()).unwrap()) / f64::from(OBSERVERS) / 20.0;
    eprintln!("loss {loss} each way: {} of {} held the last state within 30 s", all.get(), u64::from(OBSERVERS) * SEEDS);
    assert!(share >= least, "{share} of all held it within 30 s, {least} were to");
}

#[test]
fn all_of_a_hundred_observers_hold_the_last_state_when_one_in_twenty_is_lost() {
    check(0.05, 1.0);
}

#[test]
fn almost_all_do_when_one_in_five_is_lost_and_all_after_they_registered_again() {
    check(0.2, 0.99);
}
