//! One honest client that observes over a network that loses, duplicates and reorders: in the end both sides agree, and
//! of several things none stays hidden.

use std::time::Duration;

use crate::rig::client::ask::Ask;
use crate::rig::each_seed;
use crate::rig::message::Kind;
use crate::rig::network::Weather;
use crate::rig::scene::Scene;

/// A scene in which the first client observes a thing that changed a few times.
fn watching(seed: u64, path: &str) -> (Scene, Vec<u8>) {
    let mut scene = Scene::new(seed, Weather::foul(0.2));
    let token = scene.begin(Ask::observe(path));
    for turn in 1..=10 {
        scene.wait(Duration::from_millis(900));
        scene.change(|server| server.set(path, format!("seen {turn}")));
    }
    (scene, token)
}

/// Changes a thing now and then, and waits until nothing is on its way any more.
fn let_it_end(scene: &mut Scene) {
    for turn in 100..110 {
        scene.change(|server| server.set("/obs", format!("seen {turn}")));
        scene.wait(Duration::from_secs(20));
    }
    scene.wait(Duration::from_secs(200));
}

#[test]
fn numbers_of_what_a_client_takes_never_go_back_and_the_last_state_is_the_last_taken() {
    each_seed(50, |seed| {
        let (mut scene, token) = watching(seed, "/obs");
        scene.wait(Duration::from_secs(200));
        let states = scene.clients[0].states(&token);
        let turns: Vec<u32> = states.iter().map(|state| state.trim_start_matches("seen ").parse().unwrap()).collect();
        assert!(turns.is_sorted(), "{turns:?}");
        assert_eq!(turns.last(), Some(&10));
    });
}

#[test]
fn an_observation_that_is_cancelled_over_a_bad_network_ends_on_both_sides() {
    each_seed(50, |seed| {
        let (mut scene, token) = watching(seed, "/obs");
        let now = scene.now();
        scene.clients[0].cancel(&token, now);
        let_it_end(&mut scene);
        assert_eq!(scene.bench.endpoint.counts().observers, 0);
        let heard = scene.clients[0].seen.len();
        let_it_end(&mut scene);
        assert_eq!(scene.clients[0].seen.len(), heard, "nothing comes any more");
    });
}

#[test]
fn an_observation_that_its_client_forgot_is_rejected_until_the_endpoint_knows() {
    each_seed(50, |seed| {
        let (mut scene, token) = watching(seed, "/obs");
        scene.clients[0].forget(&token);
        let_it_end(&mut scene);
        assert_eq!(scene.bench.endpoint.counts().observers, 0);
        let rejections = scene.clients[0].sent.iter().filter(|(_, message)| message.kind == Kind::Rst).count();
        assert!((1..60).contains(&rejections), "{rejections}");
    });
}

#[test]
fn a_client_that_is_switched_off_is_forgotten() {
    each_seed(20, |seed| {
        let (mut scene, _) = watching(seed, "/obs");
        scene.clients[0].is_off = true;
        let_it_end(&mut scene);
        let counts = scene.bench.endpoint.counts();
        assert_eq!((counts.observers, counts.reliable), (0, 0));
    });
}

#[test]
fn of_several_things_each_arrives_at_last_though_others_change_all_the_time() {
    each_seed(50, |seed| {
        let mut scene = Scene::new(seed, Weather::foul(0.2));
        let token = scene.begin(Ask::observe("/model"));
        for turn in 1..=200 {
            scene.wait(Duration::from_millis(300));
            scene.change(|server| {
                server.set_model(0, &format!("robot {turn}"));
                if turn % 10 == 0 {
                    server.set_model(1, &format!("map {turn}"));
                }
                if turn == 30 {
                    server.set_model(2, "lamp 1");
                }
            });
        }
        scene.wait(Duration::from_secs(200));
        let states = scene.clients[0].states(&token).join("\n");
        for last in ["robot 200", "map 200", "lamp 1"] {
            assert!(states.contains(last), "{last} never arrived");
        }
    });
}
