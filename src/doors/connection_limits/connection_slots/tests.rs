//! Tests of the order of eviction.

use std::collections::VecDeque;

use futures_util::FutureExt;
use hallsweep_core::rng::RandomStream;

use super::*;
use crate::access::Keyring;

const HERE: &str = "127.0.0.1";

/// A connection. It has a slot until it is evicted.
struct Somebody {
    slot: Option<ConnectionSlot>,
    claim: SlotClaim,
    cut: Arc<Notify>,
}

fn open(most: usize) -> ConnectionSlots {
    ConnectionSlots::new(most, ConnectionBudget::default(), &Access::Open)
}

fn keyed(most: usize) -> ConnectionSlots {
    ConnectionSlots::new(most, ConnectionBudget::default(), &Access::Keys(Keyring::in_memory().unwrap()))
}

/// Opens a connection from this address. `who` is the name of its key. A key whose name begins with `operator` is an
/// operator's.
fn comes(slots: &ConnectionSlots, from: &str, who: &str) -> Somebody {
    let who = (!who.is_empty()).then(|| (Arc::from(who), who.starts_with("operator")));
    let claim = SlotClaim { network: Network::of(from.parse().unwrap()), who };
    let cut = Arc::new(Notify::new());
    let slot = slots.take(claim.clone(), false, Arc::clone(&cut));
    Somebody { slot, claim, cut }
}

impl Somebody {
    fn slot(&self) -> &ConnectionSlot {
        self.slot.as_ref().expect("there was a slot")
    }

    /// Sends the head of a request. Its body has not arrived yet.
    fn dribbles(self) -> Somebody {
        self.slot().asked(self.claim.clone(), true);
        self
    }

    /// Sends a request without a body. The request is being answered.
    fn asks(self) -> Somebody {
        self.slot().asked(self.claim.clone(), false);
        self
    }

    fn is_cut(&self) -> bool {
        self.cut.notified().now_or_never().is_some()
    }
}

/// Safety S9: after its body has arrived, a request counts like one without a body.
#[test]
fn a_body_that_has_come_whole_is_none_that_is_on_its_way() {
    let slots = open(2);
    let older = comes(&slots, HERE, "operator").dribbles();
    older.slot().received();
    older.slot().answered();
    let newer = comes(&slots, HERE, "operator").asks();
    newer.slot().answered();
    let _newcomer = comes(&slots, HERE, "operator");
    assert!(older.is_cut() && !newer.is_cut());
}

/// Safety S9.
#[test]
fn whoever_makes_least_progress_gives_way() {
    let slots = open(5);
    let answered = comes(&slots, HERE, "operator").asks();
    let dribbling = comes(&slots, HERE, "operator").dribbles();
    let resting = comes(&slots, HERE, "operator").asks();
    let sending = comes(&slots, HERE, "operator").asks();
    let watching = comes(&slots, HERE, "operator").asks();
    watching.slot().watches();
    resting.slot().answered();
    answered.slot().sends();
    sending.slot().sends();
    answered.slot().sends();
    let mut newcomers = Vec::new();
    for gives_way in [&resting, &dribbling, &sending, &answered] {
        assert!(!gives_way.is_cut());
        newcomers.push(comes(&slots, HERE, "operator").asks());
        newcomers.iter().for_each(|newcomer| newcomer.slot().sends());
        assert!(gives_way.is_cut());
    }
    assert!(!watching.is_cut(), "an endless answer does not give way");
}

/// Safety S9: a slow body is no progress, even if pieces of it keep arriving.
#[test]
fn two_thousand_bodies_that_do_not_come_keep_nobody_out() {
    let slots = open(100);
    let mut dribbling = VecDeque::new();
    for _ in 0..2000 {
        dribbling.push_back(comes(&slots, HERE, "operator").dribbles());
        if dribbling[0].is_cut() {
            drop(dribbling.pop_front());
        }
    }
    assert_eq!(dribbling.len(), 100);
    for _ in 0..300 {
        let newcomer = comes(&slots, HERE, "operator").asks();
        newcomer.slot().sends();
        assert!(!newcomer.is_cut());
        assert!(dribbling[0].is_cut(), "one of them went for him");
        drop(dribbling.pop_front());
        dribbling.push_back(comes(&slots, HERE, "operator").dribbles());
        assert!(!newcomer.is_cut(), "nor does it take the slot of who asks");
    }
}

/// Safety S9.
#[test]
fn one_key_has_its_share_from_wherever_it_comes() {
    let slots = keyed(8);
    let mut viewer = Vec::new();
    for number in 0..20 {
        viewer.push(comes(&slots, &format!("192.0.2.{number}"), "lobby").asks());
    }
    assert_eq!(viewer.iter().filter(|of_viewer| !of_viewer.is_cut()).count(), 2, "a fourth of eight");
    viewer.iter().rev().take(2).for_each(|of_viewer| of_viewer.slot().watches());
    assert!(comes(&slots, "192.0.2.99", "lobby").slot.is_none(), "whoever looks on does not give way to his own either");
    assert!(comes(&slots, "192.0.2.99", "operator").slot.is_some());
}

/// Safety S9.
#[test]
fn one_network_has_its_share_but_this_machine() {
    let slots = keyed(8);
    let mut theirs = Vec::new();
    for number in 0..8 {
        theirs.push(comes(&slots, "192.0.2.1", &format!("viewer{number}")).asks());
    }
    assert!(theirs[5].is_cut() && !theirs[6].is_cut() && !theirs[7].is_cut());
    let here: Vec<_> = (0..4).map(|number| comes(&slots, HERE, &format!("viewer{number}")).asks()).collect();
    for of_here in &here {
        assert!(!of_here.is_cut(), "a proxy is the way of many");
    }
}

/// Safety S9.
#[test]
fn some_slots_are_reserved_for_operators_who_are_not_there_yet() {
    let slots = keyed(16);
    let mut viewers = Vec::new();
    for number in 0..40 {
        viewers.push(comes(&slots, &format!("192.0.2.{number}"), &format!("viewer{number}")).asks());
    }
    assert_eq!(viewers.iter().filter(|viewer| !viewer.is_cut()).count(), 14);
    let operators = [comes(&slots, HERE, "operator"), comes(&slots, HERE, "operator-2")];
    assert!(operators.iter().all(|operator| operator.slot.is_some()));
    for viewer in &viewers[26..] {
        assert!(!viewer.is_cut(), "nobody had to give way");
    }
}

/// Safety S9, A5.
#[test]
fn strangers_give_way_before_anybody_who_is_known() {
    let slots = keyed(8);
    let known = comes(&slots, HERE, "lobby").asks();
    known.slot().answered();
    let strangers: Vec<_> = (0..6).map(|_| comes(&slots, HERE, "").asks()).collect();
    let _newcomer = comes(&slots, HERE, "operator").asks();
    let _another = comes(&slots, HERE, "operator").asks();
    assert!(strangers[0].is_cut() && !known.is_cut());
}

#[test]
fn a_system_without_descriptors_is_relieved_of_all_but_lookers_on() {
    let slots = open(40);
    let all: Vec<_> = (0..40).map(|_| comes(&slots, HERE, "operator").asks()).collect();
    all.iter().take(20).for_each(|somebody| somebody.slot().watches());
    assert_eq!([slots.evict_some(), slots.evict_some(), slots.evict_some()], [EVICTED_AT_ONCE, 4, 0]);
}

#[test]
fn a_slot_that_is_left_is_free() {
    let slots = open(1);
    for _ in 0..3 {
        let somebody = comes(&slots, HERE, "operator").asks();
        assert!(!somebody.is_cut());
    }
    assert_eq!(slots.evict_some(), 0, "nobody is here");
}

/// Safety S9.
#[test]
fn an_operator_who_rests_gives_way_to_no_viewer_and_no_stranger() {
    let slots = keyed(8);
    let operators = [comes(&slots, HERE, "operator").asks(), comes(&slots, HERE, "operator-2").asks()];
    operators.iter().for_each(|operator| operator.slot().answered());
    let mut others = Vec::new();
    for number in 0..20 {
        others.push(comes(&slots, &format!("192.0.2.{number}"), &format!("viewer{number}")).asks());
    }
    others.extend((20..30).map(|number| comes(&slots, &format!("192.0.2.{number}"), "").dribbles()));
    for operator in &operators {
        assert!(!operator.is_cut());
    }
    let third = comes(&slots, HERE, "operator-3");
    assert!(third.slot.is_some() && !operators[0].is_cut());
}

/// Safety S9.
#[test]
fn a_system_without_descriptors_is_relieved_of_operators_last() {
    let slots = keyed(24);
    let operators: Vec<_> = (0..4).map(|number| comes(&slots, HERE, &format!("operator{number}")).asks()).collect();
    operators.iter().for_each(|operator| operator.slot().answered());
    let _viewers: Vec<_> = (0..16).map(|number| comes(&slots, HERE, &format!("viewer{number}")).asks()).collect();
    assert_eq!(slots.evict_some(), EVICTED_AT_ONCE);
    for operator in &operators {
        assert!(!operator.is_cut());
    }
}

/// Safety S9.
#[test]
fn a_key_that_is_shown_later_counts_for_its_share_too() {
    let slots = keyed(8);
    let connections: Vec<_> = (0..6).map(|_| comes(&slots, HERE, "").asks()).collect();
    let lobby = SlotClaim { who: Some((Arc::from("lobby"), false)), ..connections[0].claim.clone() };
    connections.iter().for_each(|connection| connection.slot().asked(lobby.clone(), false));
    assert_eq!(connections.iter().filter(|connection| !connection.is_cut()).count(), 2, "a fourth of eight");
}

/// Safety S9, A5: the number of evicted connections that are still closing is limited too.
#[test]
fn when_too_many_were_cut_and_are_not_gone_only_who_says_stop_gets_a_slot() {
    let slots = open(4);
    let mut all: Vec<_> = (0..4 + LEAVING).map(|_| comes(&slots, HERE, "operator").asks()).collect();
    let newcomer = comes(&slots, HERE, "operator");
    assert!(newcomer.slot.is_none());
    assert!(!all[LEAVING].is_cut(), "nobody has to give way for who is not let in");
    let stop = |cut: &Arc<Notify>| slots.take(newcomer.claim.clone(), true, Arc::clone(cut));
    let stops: Vec<_> = (0..=LEAVING).map(|_| stop(&newcomer.cut)).collect();
    assert_eq!(stops.iter().flatten().count(), LEAVING);
    drop((stops, all.remove(0)));
    assert!(comes(&slots, HERE, "operator").slot.is_some(), "one has gone");
}

/// Safety S9: after any events, the queues name the same connection as a search of all connections.
#[test]
fn whoever_is_found_to_give_way_is_the_first_of_all() {
    let slots = keyed(40);
    let mut chance = RandomStream::new(7, "places");
    let mut draw = |most: usize| usize::try_from(chance.below(most as u64)).expect("it fits");
    let mut all: Vec<Somebody> = Vec::new();
    for _ in 0..20_000 {
        let (from, who) =
            (["192.0.2.1", "192.0.2.2", "192.0.2.3"][draw(3)], ["", "lobby", "hall", "operator", "operator-2"][draw(5)]);
        let somebody = (!all.is_empty()).then(|| draw(all.len()));
        match (draw(9), somebody) {
            (0..=2, _) | (_, None) => all.extend(Some(comes(&slots, from, who)).filter(|somebody| somebody.slot.is_some())),
            (3, Some(n)) => drop(all.swap_remove(n)),
            (4, Some(n)) => all[n].slot().asked(comes(&open(1), from, who).claim, draw(2) == 0),
            (5, Some(n)) => all[n].slot().received(),
            (6, Some(n)) => all[n].slot().watches(),
            (7, Some(n)) => all[n].slot().answered(),
            (_, Some(n)) => all[n].slot().sends(),
        }
        let table = slots.table();
        let found = |among: &dyn Fn(&SlotHolder) -> bool| {
            let these = table.holders.iter().filter(|(_, holder)| among(holder));
            let yielding = these.clone().filter(|(_, holder)| holder.activity() != Activity::Watching);
            QueueHead { many: these.count(), first: yielding.map(|(number, holder)| holder.turn(*number)).min() }
        };
        let claim = SlotClaim { network: Network::of(from.parse().unwrap()), who: Some((Arc::from("lobby"), false)) };
        assert_eq!(table.queues.of_all(), found(&|_| true));
        assert_eq!(table.queues.of_others(), found(&|holder| !holder.claim.is_operator()));
        assert_eq!(table.queues.of_key(&claim), found(&|holder| holder.claim.who == claim.who));
        assert_eq!(table.queues.of_network(&claim), found(&|holder| holder.claim.network == claim.network));
    }
    drop(all);
    assert!(slots.table().queues.are_empty(), "nothing is kept of who has left");
}
