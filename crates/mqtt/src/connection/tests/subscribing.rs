//! What clients subscribe to: what the router is told, and that each packet has one answer.

use std::time::Duration;

use bytes::BytesMut;

use super::scene::{OPERATOR, PULSE, Scene, VIEWER, broker, in_words, subscribe, unsubscribe};
use crate::budget::Payer;
use crate::limits::{ASKED, CLIENT_ROOM, FILTERS, ROUTER_FILTERS};
use crate::packet::Qos;

const NONE: [&str; 0] = [];

#[test]
fn refusals_stand_in_their_places_among_what_the_router_grants() {
    let mut scene = Scene::of(VIEWER);
    let filters = [
        ("$SYS/#", Qos::Zero),
        ("a/#", Qos::Two),
        ("$share/g/a", Qos::One),
        ("b#", Qos::One),
        (PULSE, Qos::Zero),
        ("b", Qos::Zero),
    ];
    scene.client(&subscribe(9, &filters)).unwrap();
    assert_eq!(scene.client_got(), NONE, "not before the router has answered");
    scene.router_answers();
    assert_eq!(scene.client_got(), ["Suback (9, [128, 1, 128, 128, 128, 0])"]);
}

#[test]
fn the_router_sees_only_what_is_granted_and_nothing_when_nothing_is() {
    let mut scene = Scene::of(OPERATOR);
    scene.client(&subscribe(9, &[("$SYS/#", Qos::Zero), ("a", Qos::Two)])).unwrap();
    assert_eq!(scene.router_got(), [r#"Subscribe [("a", One)]"#]);
    scene.client(&subscribe(10, &[("$SYS/#", Qos::Zero)])).unwrap();
    assert_eq!((scene.router_got(), scene.client_got()), (vec![], vec!["Suback (10, [128])".to_owned()]));
}

#[test]
fn one_unsuback_for_each_unsubscribe_whatever_is_known() {
    let mut scene = Scene::of(OPERATOR);
    scene.subscribe(&[("a", Qos::Zero), ("b", Qos::One), ("c", Qos::One)]);
    scene.client(&unsubscribe(5, &["a", "never", "b", "a", "$SYS/#"])).unwrap();
    assert_eq!(scene.client_got(), NONE);
    scene.router_answers();
    assert_eq!(scene.client_got(), ["Unsuback 5"]);
    scene.client(&unsubscribe(6, &["a", "never"])).unwrap();
    assert_eq!((scene.router_got(), scene.client_got()), (vec![], vec!["Unsuback 6".to_owned()]));
}

#[test]
fn a_filter_that_is_held_is_not_asked_for_again_unless_at_another_qos() {
    let mut scene = Scene::of(OPERATOR);
    scene.subscribe(&[("a", Qos::Zero), ("b", Qos::Zero)]);
    scene.client(&subscribe(2, &[("a", Qos::Zero)])).unwrap();
    assert_eq!((scene.router_got(), scene.client_got()), (vec![], vec!["Suback (2, [0])".to_owned()]));
    scene.client(&subscribe(3, &[("a", Qos::One), ("c", Qos::Zero), ("c", Qos::One)])).unwrap();
    assert_eq!(scene.connection.to_router()[..2], [0xA2, 5], "let go");
    scene.router_answers();
    assert_eq!(scene.client_got(), ["Suback (3, [1, 0, 1])"]);
    scene.client(&subscribe(4, &[("a", Qos::Zero)])).unwrap();
    assert_eq!(scene.router_got(), [r#"Unsubscribe ["a"]"#, r#"Subscribe [("a", Zero)]"#]);
}

#[test]
fn a_connection_holds_so_many_filters() {
    let mut scene = Scene::of(OPERATOR);
    let names: Vec<String> = (0..=FILTERS).map(|n| format!("a/{n}")).collect();
    let filters: Vec<(&str, Qos)> = names.iter().map(|name| (&**name, Qos::Zero)).collect();
    let codes = [vec![0; FILTERS], vec![128]].concat();
    assert_eq!(scene.subscribe(&filters), [format!("Suback (1, {codes:?})")]);
    scene.client(&unsubscribe(2, &["a/0"])).unwrap();
    scene.router_answers();
    scene.client_got();
    assert_eq!(scene.subscribe(&[("a/64", Qos::Zero)]), ["Suback (1, [0])"]);
}

#[test]
fn a_router_that_can_remember_no_more_gets_no_new_filters() {
    let mut scene = Scene::of(OPERATOR);
    for n in 0..ROUTER_FILTERS {
        assert!(scene.broker.budget.admits_filter(&Payer::Anybody, &format!("b/{n}")));
    }
    assert_eq!(scene.subscribe(&[("a", Qos::Zero), ("b/7", Qos::Zero)]), ["Suback (1, [128, 0])"]);
}

#[test]
fn a_remembered_session_holds_its_filters_and_can_let_them_go() {
    let broker = broker();
    let mut scene = Scene::at_broker(&broker, OPERATOR, |_| {});
    scene.subscribe(&[("a", Qos::One), ("b", Qos::Zero)]);
    assert!(broker.retained.keep(&Payer::Anybody, "a", b"x", Qos::One));
    let session = scene.connection.into_session();
    let mut scene = Scene::at_broker(&broker, OPERATOR, |terms| terms.session = session.clone());
    assert_eq!(scene.connection.to_router()[..2], [0x82, 10]);
    assert_eq!(
        broker.readers.of("a").iter().filter(|reader| reader.is_owed).count(),
        1,
        "whoever floods waits for it as for others"
    );
    scene.router_answers();
    assert_eq!(scene.client_got(), NONE, "the client did not ask, and what is kept it has");
    scene.client(&unsubscribe(3, &["a"])).unwrap();
    scene.router_answers();
    assert_eq!(scene.client_got(), ["Unsuback 3"]);
    let left: Vec<String> = scene.connection.into_session().filters.keys().map(ToString::to_string).collect();
    assert_eq!((left, session.filters.len()), (vec!["b".to_owned()], 2));
}

/// The router writes an answer for each filter that is let go, and keeps the room that its answers took.
#[test]
fn nothing_more_is_taken_while_the_router_has_much_to_answer() {
    let names: Vec<String> = (0..FILTERS).map(|n| format!("a/{n}")).collect();
    let names: Vec<&str> = names.iter().map(|name| &**name).collect();
    for size in [1, 7, FILTERS] {
        let some: Vec<(&str, Qos)> = names[..size].iter().map(|name| (*name, Qos::Zero)).collect();
        let pair = [subscribe(1, &some), unsubscribe(2, &names[..size])].concat();
        let mut scene = Scene::of(VIEWER);
        let (mut unread, mut answered) = (BytesMut::from(&pair.repeat(1000)[..]), 0);
        loop {
            scene.connection.handle_client(&mut unread, Duration::ZERO).unwrap();
            assert!(asked(&in_words(scene.connection.to_router())) < ASKED + size);
            assert!(unread.is_empty() || !scene.connection.wants_client());
            scene.router_answers();
            assert!(scene.connection.wants_client());
            answered += scene.client_got().len();
            if unread.is_empty() {
                break;
            }
        }
        assert_eq!(answered, 2000, "each has its answer");
    }
}

/// So many filters the router is to answer for.
fn asked(questions: &[String]) -> usize {
    // Each name is in quotes.
    questions.iter().map(|question| question.matches('"').count() / 2).sum()
}

/// Whoever reads none of the answers that have to come first is sent away, and is heard to the end.
#[test]
fn whoever_waits_for_answers_that_it_does_not_read_leaves_them_unread() {
    let mut scene = Scene::of(OPERATOR);
    let again = [subscribe(1, &[("a", Qos::Zero)]), unsubscribe(2, &["a"])].concat();
    scene.client(&again.repeat(ASKED)).unwrap();
    assert!(!scene.connection.wants_client() && !scene.connection.is_unread());
    scene.connection.to_client().end().extend_from_slice(&[0; CLIENT_ROOM]);
    assert!(!scene.connection.wants_router() && scene.connection.is_unread());
    scene.connection.to_client().clear();
    assert!(!scene.connection.is_unread());
    scene.router_answers();
    assert!(scene.connection.wants_client());
}
