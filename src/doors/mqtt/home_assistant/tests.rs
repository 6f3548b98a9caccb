//! Tests of the messages for Home Assistant. They are compared with golden files and with the published messages.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;

use serde_json::Value;

use super::*;
use crate::api::tests::fixture::{TEN, idle, piece, searching};
use crate::doors::mqtt::change_feed::ChangeFeed;
use crate::doors::mqtt::topics::{TopicKind, Topics};
use hallsweep_core::command::Verdict;
use hallsweep_core::event::Photo;
use hallsweep_core::units::WallTime;
use hallsweep_core::world::alarm::{AlarmCause, AlarmView};

fn topics() -> Topics {
    Topics::new("hallsweep", "discovery", "unibo/qak")
}

fn components(topics: &Topics) -> BTreeMap<String, Value> {
    let config = discovery::config(topics, "1.2.3");
    config["components"].as_object().unwrap().clone().into_iter().collect()
}

fn published(snapshot: &Snapshot) -> BTreeMap<String, Vec<u8>> {
    let mut feed = ChangeFeed::new(topics(), true);
    feed.handle_state(Arc::new(snapshot.clone()));
    if let Some(picture) = feed.poll_photo() {
        assert!(feed.handle_photo(picture, Photo { bytes: Arc::from(*b"\x89PNG"), media_type: "image/png" }));
    }
    let said = std::iter::from_fn(|| feed.poll_publication(Duration::ZERO));
    said.map(|publication| (publication.topic, publication.payload.to_vec())).collect()
}

#[test]
fn what_it_is_told_of_a_robot_is_as_the_golden_files_show() {
    let others = Topics::new("site/robots", "Robot-2", "r2/qak");
    for (name, topics) in [("discovery", topics()), ("other_names", others)] {
        let path = format!("{}/src/doors/mqtt/home_assistant/golden/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let shown = serde_json::to_string_pretty(&discovery::config(&topics, "1.2.3")).unwrap() + "\n";
        if std::env::var_os("HALLSWEEP_UPDATE_DOCS").is_some() {
            std::fs::write(&path, &shown).unwrap();
        }
        let golden = std::fs::read_to_string(&path).unwrap();
        assert_eq!(golden, shown, "if it should be so, write it anew with HALLSWEEP_UPDATE_DOCS=1 cargo test golden_files");
    }
}

#[test]
fn every_topic_it_listens_to_is_one_that_is_published() {
    let published = published(&searching());
    assert!(published.contains_key(discovery::config(&topics(), "1.2.3")["availability_topic"].as_str().unwrap()));
    for (name, component) in components(&topics()) {
        for (key, topic) in component.as_object().unwrap().iter().filter(|(key, _)| key.ends_with("_topic")) {
            let topic = topic.as_str().unwrap();
            if key == "command_topic" {
                assert_eq!(topics().kind_of(topic), TopicKind::Word, "{name}");
            } else {
                assert!(published.contains_key(topic), "{name} listens to {topic}, where nothing is published");
            }
        }
    }
}

#[test]
fn everything_a_template_takes_is_in_the_message_it_is_given() {
    for published in [published(&idle()), published(&searching())] {
        let mut taken = 0;
        for (name, component) in components(&topics()) {
            for (template, topic) in [("value_template", "state_topic"), ("json_attributes_template", "json_attributes_topic")] {
                let Some(template) = component[template].as_str() else { continue };
                let message: Value = serde_json::from_slice(&published[component[topic].as_str().unwrap()]).unwrap();
                for path in paths(template) {
                    assert!(message.pointer(&path).is_some(), "{name}: {template} finds no {path} in {message}");
                    taken += 1;
                }
            }
        }
        assert!(taken > 10, "only {taken} paths were found: the test looks in the wrong place");
    }
}

fn paths(template: &str) -> Vec<String> {
    let is_of_path = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '.';
    let path = |rest: &str| rest.split(|letter| !is_of_path(letter)).next().unwrap_or_default().replace('.', "/");
    template.split("value_json").skip(1).map(path).collect()
}

#[test]
fn a_template_that_takes_what_is_not_there_would_be_found() {
    assert_eq!(paths("{{ value_json.position.x }}, {{ value_json | count }}"), ["/position/x", ""]);
    let robot = &published(&searching())["hallsweep/discovery/state/robot"];
    assert_eq!(serde_json::from_slice::<Value>(robot).unwrap().pointer("/position/z"), None);
}

#[test]
fn every_entity_has_names_of_its_own_that_it_takes() {
    let mut ids = BTreeSet::new();
    let others = Topics::new("hallsweep", "Robot-2", "unibo/qak");
    for (name, component) in components(&topics()).into_iter().chain(components(&others)) {
        let (platform, entity) = component["default_entity_id"].as_str().unwrap().split_once('.').unwrap();
        assert_eq!(platform, component["platform"], "{name}");
        let is_plain = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_';
        assert!(entity.bytes().all(is_plain), "{entity}");
        assert!(ids.insert(component["unique_id"].as_str().unwrap().to_owned()), "{name}");
    }
    assert_eq!(ids.len(), 16);
}

#[test]
fn what_has_no_battery_says_nothing_of_one() {
    let vacuum = &components(&topics())["vacuum"];
    assert_eq!(vacuum["supported_features"], serde_json::json!(["start", "pause", "stop", "return_home", "status"]));
    assert!(!discovery::config(&topics(), "1.2.3").to_string().contains("battery"));
}

#[test]
fn every_phase_is_one_of_the_activities_of_a_vacuum() {
    use Activity::{Cleaning, Docked, Error, Idle, Paused, Returning};
    let table = [
        (PhaseName::Idle, Docked, Docked),
        (PhaseName::Exploring, Cleaning, Paused),
        (PhaseName::Inspecting, Cleaning, Paused),
        (PhaseName::Driving, Cleaning, Paused),
        (PhaseName::ReturningHome, Returning, Paused),
        (PhaseName::AtHome, Docked, Docked),
        (PhaseName::ReturningWithAlarm, Returning, Paused),
        (PhaseName::BombLocated, Docked, Docked),
        (PhaseName::Retrieving, Cleaning, Paused),
        (PhaseName::BagSecured, Docked, Docked),
        (PhaseName::Explored, Docked, Docked),
        (PhaseName::Fault, Error, Error),
    ];
    assert_eq!(table.map(|(phase, _, _)| phase), PhaseName::ALL);
    for (phase, free, held) in table {
        let mut snapshot = idle();
        snapshot.mission.phase = phase;
        assert_eq!(state(&snapshot).activity, free, "{}", phase.name());
        for hold in Hold::ALL {
            snapshot.mission.holds = vec![hold, Hold::AwaitingStart];
            let is_broken = matches!(hold, Hold::TemperatureStale | Hold::RobotLink | Hold::Store);
            let expected = if is_broken { Error } else { held };
            assert_eq!(state(&snapshot).activity, expected, "{} held by {}", phase.name(), hold.name());
        }
    }
    let mut away = idle();
    away.robot.pose.cell = Cell::new(2, 1);
    assert_eq!(state(&away).activity, Idle);
}

#[test]
fn an_alarm_stands_until_it_is_seen_and_a_danger_until_it_is_secured() {
    let mut snapshot = idle();
    assert!(!state(&snapshot).alarm);
    let seen = |who: Option<(Arc<str>, WallTime)>| {
        let cause = AlarmCause::Other("a parcel was lost".to_owned());
        Arc::from([AlarmView { id: None, raised: TEN, cause, luggage: None, acknowledged: who }])
    };
    snapshot.alarms = seen(None);
    assert!(state(&snapshot).alarm);
    snapshot.alarms = seen(Some((Arc::from("operator"), TEN)));
    assert!(!state(&snapshot).alarm);
    snapshot.luggage = [piece(1, Cell::new(1, 0), Some(Verdict::Danger))].into();
    snapshot.mission.phase = PhaseName::BombLocated;
    assert!(state(&snapshot).alarm, "it was seen, and lies there still");
    snapshot.mission.phase = PhaseName::BagSecured;
    assert!(!state(&snapshot).alarm);
}

#[test]
fn the_state_is_written_as_a_vacuum_reads_it() {
    let state = State { activity: Activity::Returning, alarm: true, is_exercise: false };
    assert_eq!(state.json().to_string(), r#"{"alarm":true,"state":"returning"}"#);
}
