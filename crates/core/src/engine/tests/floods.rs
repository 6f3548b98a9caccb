//! Tests of endless STOPs: what is recorded, and what is not.

use super::*;
use crate::asked::Asked;
use crate::command::CommandId;
use crate::state::PersistentState;
use crate::state::fact::{Entry, Fact};

struct Recorder {
    engine: Engine,
    millis: u64,
    pages: usize,
    entries: Vec<Entry>,
    answers: usize,
    epoch: Epoch,
}

impl Recorder {
    fn new() -> Recorder {
        let mut engine = sweep_in(PhaseName::Exploring, &[]);
        engine.state.luggage = Default::default();
        Recorder { engine, millis: 0, pages: 0, entries: Vec::new(), answers: 0, epoch: Epoch(0) }
    }

    fn now(&self) -> Now {
        Now { since_start: Duration::from_millis(self.millis), wall: WallTime::default() }
    }

    /// Handles a STOP like the main loop: the halt comes first, and the command with its sender follows.
    fn stop(&mut self, who: &str, from: &str) {
        self.press(Issuer { door: Door("http"), who: who.into(), from: from.into() }, None);
    }

    /// Handles a STOP that carries an id of the press.
    fn stop_named(&mut self, who: &str, name: &str) {
        let issuer = Issuer { door: Door("http"), who: who.into(), from: "192.0.2.7".into() };
        self.press(issuer, CommandId::new(name));
    }

    fn press(&mut self, issuer: Issuer, id: Option<CommandId>) {
        self.epoch = self.epoch.next();
        self.engine.handle_halt(self.epoch, self.now());
        self.drain();
        let stop = Request { epoch: Some(self.epoch), id, ..Request::new(Command::Stop, issuer) };
        self.engine.handle_command(stop, self.now()).expect("a stop is never refused");
        self.drain();
        assert_eq!(self.engine.snapshot().mission.epoch, self.epoch, "it is shown at once");
    }

    fn wait_until(&mut self, millis: u64) {
        self.millis = millis;
        while self.engine.poll_timeout().is_some_and(|due| due <= self.now().since_start) {
            self.engine.handle_timeout(self.now());
            self.drain();
        }
    }

    fn drain(&mut self) {
        while let Some(effect) = self.engine.poll_effect() {
            match effect {
                Effect::Record(page) => {
                    self.pages += 1;
                    self.engine.handle_event(Event::Recorded(page.last()), self.now());
                    self.entries.extend(page.entries);
                }
                Effect::Answer(_, answer) => self.answers += usize::from(answer.is_ok()),
                Effect::Order(..) | Effect::Halt(_) | Effect::Led(..) => {}
            }
        }
    }

    fn by(&self, name: &str) -> Vec<String> {
        self.entries.iter().filter_map(|entry| by(entry, name)).collect()
    }

    /// Returns the epoch after a restart from the recorded entries.
    fn epoch_on_record(&self) -> Epoch {
        let mut state = PersistentState::first(Strategy::Snail);
        self.entries.iter().for_each(|entry| state.apply(entry));
        state.epoch
    }
}

/// Returns the command of this entry, if it is from this sender.
fn by(entry: &Entry, name: &str) -> Option<String> {
    let Fact::Command { issuer, asked, .. } = &entry.fact else { return None };
    (*issuer.who == *name || *issuer.from == *name).then(|| asked.to_string())
}

fn count(words: &str) -> u64 {
    words.split(' ').nth(1).map_or(1, |count| count.parse().expect("a number"))
}

/// Safety S1, A5, A6.
#[test]
fn a_flood_of_stops_shares_an_entry_a_second_and_those_of_others_have_their_own() {
    let mut recorder = Recorder::new();
    for n in 0..3000 {
        recorder.wait_until(n);
        recorder.stop("lobby", "192.0.2.7");
        if n % 200 == 0 {
            recorder.stop("anna", "192.0.2.8");
        }
    }
    assert_eq!(recorder.by("anna"), ["STOP"; 15]);
    assert!(recorder.pages < 60, "{} pages", recorder.pages);
    assert_eq!(recorder.by("lobby")[..22], [&["STOP"; 20][..], &["STOP, 1000 times within 1.0 s"; 2]].concat());
    recorder.wait_until(4000);
    assert_eq!(recorder.by("lobby")[22..], ["STOP, 980 times within 1.0 s"]);
    assert_eq!(recorder.answers, 3015, "every one is answered");
    recorder.wait_until(4200);
    recorder.stop("lobby", "192.0.2.7");
    assert_eq!(recorder.by("lobby").last().map(String::as_str), Some("STOP"), "after a while each has its own entry again");
}

/// Safety S4: the entry for a flood of STOPs waits for further STOPs, but the epoch is recorded within a second.
#[test]
fn the_epoch_of_a_flood_is_on_record_with_the_next_entry_or_soon() {
    let mut recorder = Recorder::new();
    (0..100).for_each(|_| recorder.stop("lobby", "192.0.2.7"));
    assert!(recorder.epoch_on_record() >= Epoch(20));
    recorder.wait_until(999);
    assert!(recorder.epoch_on_record() < Epoch(100), "nothing has taken it along");
    recorder.wait_until(1000);
    assert_eq!(recorder.epoch_on_record(), Epoch(100));

    (0..100).for_each(|_| recorder.stop("lobby", "192.0.2.7"));
    let start = Request::new(Command::Start, Issuer::operator(Door("http")));
    recorder.engine.handle_command(start, recorder.now()).expect("nothing else holds it");
    recorder.drain();
    assert_eq!(recorder.epoch_on_record(), Epoch(200), "the START is on record behind the stops that it came after");

    (0..100).for_each(|_| recorder.stop("lobby", "192.0.2.7"));
    recorder.engine.record_rest(recorder.now());
    recorder.drain();
    assert_eq!(recorder.epoch_on_record(), Epoch(300));
    assert_eq!(recorder.by("lobby").iter().map(|words| count(words)).sum::<u64>(), 300);
}

/// Safety S1, A6: a sender that gets no answer sends STOP again and again. A person or a web page may do this.
#[test]
fn a_stop_under_the_name_of_the_one_before_halts_again_and_is_the_same_press() {
    let mut recorder = Recorder::new();
    for (millis, who, name, presses) in [
        (0, "anna", "k1", 1),
        (1000, "anna", "k1", 1),
        (59_999, "anna", "k1", 1),
        (59_999, "anna", "k2", 2),
        (60_000, "anna", "k1", 3),
        (61_000, "anna", "k1", 3),
    ] {
        recorder.wait_until(millis);
        recorder.stop_named(who, name);
        assert_eq!(recorder.by(who), vec!["STOP"; presses], "{name} at {millis} ms");
    }
    recorder.stop_named("bert", "k1");
    assert_eq!(recorder.by("bert"), ["STOP"], "a name belongs to its sender");
    let start = Request::new(Command::Start, Issuer::operator(Door("http")));
    recorder.engine.handle_command(start, recorder.now()).expect("nothing else holds it");
    recorder.drain();
    recorder.stop_named("anna", "k1");
    assert_eq!(recorder.by("anna").len(), 4, "what stops a robot that was released is on record");
    recorder.wait_until(90_000);
    let all = (recorder.epoch_on_record(), recorder.answers);
    assert_eq!(all, (Epoch(8), 9), "each has halted and is answered, as the START is");
}

/// Safety A5, A6: 128 ids are remembered, and stops that arrive together are all counted.
#[test]
fn presses_that_were_forgotten_or_come_in_crowds_are_on_record() {
    let mut recorder = Recorder::new();
    for n in (0..128).chain(0..128).chain([128, 1, 0]) {
        recorder.stop_named("anna", &format!("k{n}"));
    }
    let issuer = Issuer { door: Door("http"), who: "anna".into(), from: "192.0.2.7".into() };
    let last = Request { epoch: Some(recorder.epoch), id: CommandId::new("k0"), ..Request::new(Command::Stop, issuer) };
    recorder.engine.handle_stops(last, 1000, recorder.now()).expect("a stop is never refused");
    recorder.engine.record_rest(recorder.now());
    recorder.drain();
    let words = recorder.by("anna");
    assert_eq!(words.iter().map(|words| count(words)).sum::<u64>(), 128 + 2 + 1000, "{words:?}");
    let is_named = |entry: &&Entry| matches!(&entry.fact, Fact::Command { id: Some(_), .. });
    assert_eq!(recorder.entries.iter().filter(is_named).count(), 20, "what stands for many has no name");
}

/// Safety A6: refusals by interfaces are recorded at the end of the program at the latest.
#[test]
fn all_that_doors_refuse_is_on_record() {
    let mut recorder = Recorder::new();
    for door in [Door("http"), Door("mqtt")] {
        let issuer = Issuer { door, who: "lobby".into(), from: "192.0.2.7".into() };
        for _ in 0..100 {
            let refused = Refused::NotAllowed("lobby may only look".to_owned());
            recorder.engine.note_refused(issuer.clone(), Asked::Words("RESET".to_owned()), &refused, 1, recorder.now());
        }
    }
    recorder.drain();
    assert_eq!(recorder.by("lobby"), ["RESET"; 120]);
    recorder.engine.record_rest(recorder.now());
    recorder.drain();
    assert_eq!(recorder.by("lobby")[120..], ["RESET, and 39 more that were refused"; 2]);
}

/// Tests a stop whose sender is never known.
#[test]
fn an_epoch_goes_on_record_although_no_command_follows() {
    let mut recorder = Recorder::new();
    recorder.stop("anna", "192.0.2.8");
    recorder.engine.handle_halt(Epoch(7), recorder.now());
    recorder.drain();
    recorder.wait_until(5000);
    assert_eq!(recorder.epoch_on_record(), Epoch(7));
    assert_eq!(recorder.engine.poll_timeout(), None, "nothing is left to be done");
}

/// Without authentication, all senders have the same name.
#[test]
fn whoever_signs_in_nowhere_is_told_apart_by_his_address_and_others_by_their_names() {
    let mut recorder = Recorder::new();
    (0..100).for_each(|_| recorder.stop("operator", "127.0.0.7"));
    recorder.stop("operator", "127.0.0.1");
    recorder.stop("operator", "::1");
    assert_eq!((recorder.by("127.0.0.1"), recorder.by("::1")), (vec!["STOP".to_owned()], vec!["STOP".to_owned()]));
    assert_eq!(recorder.by("127.0.0.7").len(), 20);
    (0..100).for_each(|n| recorder.stop("lobby", &format!("192.0.2.{n}")));
    assert_eq!(recorder.by("lobby").len(), 20, "many addresses are no more than one");
}

/// A person may choose any name.
#[test]
fn whoever_signs_in_under_many_names_has_the_share_of_one_key() {
    let mut recorder = Recorder::new();
    (0..100).for_each(|n| recorder.stop(&format!("lobby (Anna {n})"), "192.0.2.7"));
    assert_eq!(recorder.by("192.0.2.7").len(), 20);
    assert_eq!(recorder.by("lobby (Anna 0)"), ["STOP"], "each is on record by its own name");
    assert_eq!(recorder.by("lobby (Anna 99)"), [""; 0], "the last of several people is not on record for all");
}
