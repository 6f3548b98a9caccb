//! Retained messages: which are stored, for how long, at whose cost, and that searches find what the standard says.

use proptest::prelude::*;

use super::*;
use crate::filter::matches;
use crate::filter::tests::{level, some_filter};
use crate::limits::MESSAGE_COST;
use crate::message::Draft;
use crate::packet::Qos;

const ANYBODY: Payer = Payer::Anybody;

fn key(name: &str) -> Payer {
    Payer::Key(Arc::from(name))
}

impl Retained {
    fn say(&self, payer: &Payer, topic: &str, payload: &[u8], qos: Qos) -> bool {
        let message = Message::new(Draft::plain(topic, payload, qos), self.stamp(), &Arc::default());
        self.keep(payer, &Arc::new(message), Duration::ZERO)
    }
}

fn all(retained: &Retained, filter: &str, since: u64) -> Vec<Arc<Message>> {
    let (mut walk, mut found) = (Walk::new(Arc::from(filter), since), Vec::new());
    while !walk.is_over() {
        found.extend(retained.next(&mut walk, &mut 3, Duration::ZERO));
    }
    found
}

fn topics(retained: &Retained, filter: &str) -> Vec<String> {
    all(retained, filter, 0).iter().map(|kept| kept.topic().to_owned()).collect()
}

fn topic() -> impl Strategy<Value = String> {
    prop::collection::vec(level(), 1..5).prop_map(|levels| levels.join("/"))
}

proptest! {
    /// The search level by level, in any number of turns, finds exactly what a comparison with each topic finds.
    #[test]
    fn what_is_found_is_what_the_filter_matches(
        kept in prop::collection::btree_set(topic().prop_filter("not empty", |topic| !topic.is_empty()), 0..40),
        filter in some_filter(),
    ) {
        let retained = Retained::default();
        for topic in &kept {
            prop_assert!(retained.say(&ANYBODY, topic, b"x", Qos::One));
        }
        let expected: Vec<&String> = kept.iter().filter(|topic| matches(&filter, topic)).collect();
        let found = topics(&retained, &filter);
        prop_assert_eq!(found.iter().collect::<Vec<_>>(), expected);
    }
}

#[test]
fn the_last_of_each_topic_is_kept_and_an_empty_one_takes_it_away() {
    let retained = Retained::default();
    for (topic, payload) in [("a", "1"), ("a/b", "2"), ("a", "3"), ("ab", "4"), ("b/a", "5")] {
        assert!(retained.say(&ANYBODY, topic, payload.as_bytes(), Qos::One));
    }
    assert_eq!(topics(&retained, "a/#"), ["a", "a/b"]);
    assert_eq!(topics(&retained, "+"), ["a", "ab"]);
    assert_eq!(topics(&retained, "#"), ["a", "a/b", "ab", "b/a"]);
    assert_eq!(all(&retained, "a", 0)[0].payload(), b"3");
    assert!(retained.say(&ANYBODY, "a", b"", Qos::Zero) && retained.say(&ANYBODY, "never", b"", Qos::Zero));
    assert_eq!(topics(&retained, "#"), ["a/b", "ab", "b/a"]);
}

#[test]
fn what_was_kept_since_is_told_from_what_was_there() {
    let retained = Retained::default();
    for topic in ["a", "b"] {
        assert!(retained.say(&ANYBODY, topic, b"old", Qos::One));
    }
    let since = retained.stamp();
    assert!(retained.say(&ANYBODY, "b", b"new", Qos::One) && retained.say(&ANYBODY, "c", b"new", Qos::One));
    let newer: Vec<String> = all(&retained, "#", since).iter().map(|kept| kept.topic().to_owned()).collect();
    assert_eq!(newer, ["b", "c"]);
}

/// Messages outside the filter's levels cost no steps.
#[test]
fn what_others_have_kept_costs_nobody_a_step_who_does_not_ask_for_it() {
    let retained = Retained::default();
    for n in 0..KEPT {
        assert!(retained.say(&ANYBODY, &format!("deep/{n}/a/b/c/d"), b"x", Qos::Zero));
    }
    assert!(!retained.say(&ANYBODY, "one/more", b"x", Qos::Zero));
    assert!(
        retained.say(&Payer::Program, "state/a/x", b"x", Qos::Zero) && retained.say(&Payer::Program, "state/b", b"x", Qos::Zero)
    );
    for (filter, found) in [("state/a/x", 1), ("state/+/x", 1), ("+/b", 1), ("nothing/+/c", 0), ("nothing/#", 0), ("+", 0)] {
        let (mut walk, mut steps) = (Walk::new(Arc::from(filter), 0), 16);
        let count = std::iter::from_fn(|| retained.next(&mut walk, &mut steps, Duration::ZERO)).count();
        assert!(count == found && walk.is_over(), "{filter}: {count}, {steps} steps left");
    }
}

#[test]
fn a_deep_filter_takes_a_few_steps_for_each_branch_and_no_more_in_a_turn_than_it_may() {
    let retained = Retained::default();
    for n in 0..KEPT {
        assert!(retained.say(&ANYBODY, &format!("{n}/{}/z0", "a/".repeat(20)), b"x", Qos::Zero));
    }
    let (mut walk, mut turns) = (Walk::new(Arc::from("+/".repeat(22) + "z1"), 0), 0);
    while !walk.is_over() {
        let mut steps = 100;
        assert!(retained.next(&mut walk, &mut steps, Duration::ZERO).is_none());
        turns += 1;
    }
    assert!((KEPT / 100..4 * KEPT / 100).contains(&turns), "{turns} turns");
}

#[test]
fn there_is_an_end_to_their_number_and_what_is_there_can_still_change() {
    let retained = Retained::default();
    let kept = (0..KEPT + 10).filter(|n| retained.say(&ANYBODY, &format!("a/{n}"), b"x", Qos::Zero)).count();
    assert_eq!((kept, retained.count()), (KEPT, KEPT));
    assert!(retained.say(&ANYBODY, "a/0", b"y", Qos::Zero) && !retained.say(&ANYBODY, "b", b"y", Qos::Zero));
    assert!(retained.say(&ANYBODY, "a/0", b"", Qos::Zero) && retained.say(&ANYBODY, "b", b"y", Qos::Zero));
}

#[test]
fn there_is_an_end_to_their_bytes() {
    let retained = Retained::default();
    let mebibyte = vec![7; 1 << 20];
    let kept = (0..40).filter(|n| retained.say(&ANYBODY, &format!("a/{n}"), &mebibyte, Qos::Zero)).count();
    assert_eq!(kept, 31);
    assert!(retained.say(&ANYBODY, "a/0", b"x", Qos::Zero) && retained.say(&ANYBODY, "b", &mebibyte, Qos::Zero));
    for n in 0..40 {
        assert!(retained.say(&ANYBODY, &format!("a/{n}"), b"", Qos::Zero));
    }
    assert!(retained.say(&ANYBODY, "b", b"", Qos::Zero));
    assert_eq!((retained.count(), retained.shelf().clients), (0, Used::default()));
}

#[test]
fn a_key_keeps_its_share_and_leaves_others_theirs() {
    let retained = Retained::default();
    let (greedy, modest) = (key("greedy"), key("modest"));
    let kept = (0..KEPT_SHARE + 900).filter(|n| retained.say(&greedy, &format!("a/{n}"), b"x", Qos::Zero)).count();
    assert_eq!(kept, KEPT_SHARE);
    let kept = (0..KEPT_SHARE).filter(|n| retained.say(&modest, &format!("b/{n}"), b"x", Qos::Zero)).count();
    assert_eq!(kept, KEPT_SHARE);
    assert!(retained.say(&greedy, "a/0", b"y", Qos::Zero), "what it keeps can change");
    assert!(retained.say(&modest, "b/0", b"", Qos::Zero) && retained.say(&modest, "a/0", b"z", Qos::Zero));
    assert!(retained.say(&greedy, "a/new", b"y", Qos::Zero), "whoever says something in its place keeps it instead");
    assert!(!retained.say(&greedy, "a/newer", b"y", Qos::Zero));
}

/// Reserved places and bytes stay free for keys that retain little.
#[test]
fn keys_that_keep_much_leave_room_for_those_that_keep_little() {
    let (short, long): (&[u8], &[u8]) = (b"x", &[7; 100 * 1024]);
    for (payload, most) in [(short, KEPT - KEPT_RESERVE), (long, (KEPT_BYTES - KEPT_RESERVE_BYTES) / long.len())] {
        let retained = Retained::default();
        let keep = |who: &str| {
            let payer = key(who);
            (0..KEPT_SHARE).filter(|n| retained.say(&payer, &format!("{who}/{n}"), payload, Qos::Zero)).count()
        };
        let kept: usize = ["a", "b", "c", "d"].map(keep).iter().sum();
        assert!(kept <= most + 2 * KEPT_LITTLE && kept + 10 > most, "{kept}, and at most {most} by those who keep much");
        let little = KEPT_LITTLE.min(KEPT_LITTLE_BYTES / (payload.len() + MESSAGE_COST + 10));
        assert_eq!(keep("late"), little);
    }
}

#[test]
fn the_bytes_of_a_key_are_bounded_too_and_come_back() {
    let (retained, greedy) = (Retained::default(), key("greedy"));
    let long = vec![7; 256 * 1024];
    let keep_all = || (0..200).filter(|n| retained.say(&greedy, &format!("a/{n}"), &long, Qos::Zero)).count();
    let most = KEPT_SHARE_BYTES / long.len() - 1;
    assert_eq!(keep_all(), most);
    (0..200).for_each(|n| assert!(retained.say(&greedy, &format!("a/{n}"), b"", Qos::Zero)));
    assert!(retained.shelf().shares.is_empty() && keep_all() == most);
}

#[test]
fn what_the_program_says_has_room_whatever_others_have_kept_and_an_end_as_well() {
    let retained = Retained::default();
    let mebibyte = vec![0; 1024 * 1024];
    let kept = (0..40).filter(|n| retained.say(&ANYBODY, &format!("a/{n}"), &mebibyte, Qos::Zero)).count();
    assert!(kept < 40 && !retained.say(&ANYBODY, "a/39", &mebibyte, Qos::Zero));
    let ours = (0..40).filter(|n| retained.say(&Payer::Program, &format!("state/{n}"), &mebibyte, Qos::One)).count();
    assert_eq!(ours, PROGRAM_KEPT_BYTES / mebibyte.len() - 1, "our own bytes are bounded");
    assert!(retained.say(&Payer::Program, "state/0", b"newer", Qos::One));
    let more = (0..2 * PROGRAM_KEPT).filter(|n| retained.say(&Payer::Program, &format!("more/{n}"), b"x", Qos::One)).count();
    assert_eq!(more, PROGRAM_KEPT - ours, "and so is their number");
    retained.set_program_room(2);
    assert!(retained.say(&Payer::Program, "state/more", &mebibyte, Qos::One), "unless there is more room");
    assert!(!retained.say(&ANYBODY, "a/0", &vec![0; 4 * mebibyte.len()], Qos::Zero));
    assert!(all(&retained, "a/0", 0).is_empty(), "what it said before is not so any more");
}

/// An expired message is not found, and its place is free.
#[test]
fn what_is_over_is_not_kept_for_longer() {
    let (retained, at) = (Retained::default(), Duration::from_secs);
    let keep = |topic: &str, expires_at, now| {
        let draft = Draft { expires_at, ..Draft::plain(topic, b"x", Qos::Zero) };
        retained.keep(&ANYBODY, &Arc::new(Message::new(draft, 0, &Arc::default())), now)
    };
    let kept = (0..KEPT as u64).filter(|n| keep(&format!("a/{n}"), (*n < 2).then(|| at(10 + n)), at(1))).count();
    assert_eq!(kept, KEPT);
    assert!(!keep("b", None, at(9)));
    let found = |now| retained.next(&mut Walk::new("a/0".into(), 0), &mut 9, now).is_some();
    assert!(found(at(9)) && !found(at(10)));
    assert!(keep("b", None, at(10)) && !keep("c", None, at(10)), "there was one");
    assert!(keep("c", None, at(11)) && !keep("d", None, at(100)));
    assert_eq!((retained.count(), retained.shelf().first_over), (KEPT, None));
}
