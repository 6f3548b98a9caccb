//! Safety R1 and R2 in the core: what is on record is what stands, and a program that is killed at any moment stands where it
//! stood, held, and goes on after a START.

use hallsweep::core::command::{Command, Verdict};
use hallsweep::core::mission::Phase;
use hallsweep::core::rng::Stream;
use hallsweep::core::settings::Settings;
use hallsweep::core::standing::Standing;
use hallsweep::headless::Run;
use hallsweep::outbound::robot::sim::{Camera, SimSettings};

use crate::halls;
use crate::operator::{Operator, in_hall};
use crate::random_commands::{any_command, from_outside};

/// Safety R1, D2.
#[test]
fn what_stands_follows_from_the_journal_alone() {
    for seed in 0..150 {
        let hall = halls::random(seed, 14);
        let mut dice = Stream::new(seed, "journal");
        let sim = SimSettings { unknown_rate: 0.1, photo_failure_rate: 0.2, ..SimSettings::new(seed, Camera::Stub) };
        let mut run = Run::new(hall, sim, Settings::default(), Default::default());
        let mut folded = Folded::default();
        for _ in 0..120 {
            let command = any_command(&mut dice, &mut run);
            let _ = run.give(command);
            if dice.below(10) == 0 {
                from_outside(&mut dice, &mut run);
            }
            folded.check(&run, seed);
            for _ in 0..dice.below(30) {
                run.advance();
            }
            folded.check(&run, seed);
        }
    }
}

#[test]
fn a_mission_after_a_mission_is_folded_from_its_own_beginning() {
    let mut run = in_hall("seed");
    for _ in 0..2 {
        run.give(Command::Start).unwrap();
        run.until_explored();
    }
    let fact = |entry: &hallsweep::core::effect::Entry| matches!(entry.fact, hallsweep::core::effect::Fact::Standing(_));
    let last = run.journal.iter().rposition(fact).expect("the second mission begins with everything that stands");
    let mut standing = Standing::first(Default::default());
    run.journal[last..].iter().for_each(|entry| standing.apply(entry));
    assert_eq!(standing, run.sweep.standing());
    assert_eq!(standing.mission.0, 2);
    assert!(standing.luggage.values().all(|luggage| luggage.verdict.as_ref().unwrap().verdict == Verdict::Safe));
}

/// A journal that is folded as it grows.
struct Folded {
    standing: Standing,
    read: usize,
}

impl Default for Folded {
    fn default() -> Folded {
        Folded { standing: Standing::first(Default::default()), read: 0 }
    }
}

impl Folded {
    fn check(&mut self, run: &Run, seed: u64) {
        run.journal[self.read..].iter().for_each(|entry| self.standing.apply(entry));
        self.read = run.journal.len();
        let mut live = run.sweep.standing();
        // Not on record: how far the search looked ahead when it found nothing to do, and the next move of a drive by hand, which
        // no restart goes on with.
        let mut folded = Standing { search: live.search.clone(), ..self.standing.clone() };
        for standing in [&mut folded, &mut live] {
            if let Phase::Driving { next, .. } = &mut standing.phase {
                *next = None;
            }
        }
        if folded != live {
            explain(&folded, &live, seed);
        }
    }
}

fn explain(folded: &Standing, live: &Standing, seed: u64) {
    assert_eq!(folded.map.changes_since(&live.map), [], "seed {seed}: the maps differ");
    let bare = |standing: &Standing| format!("{:#?}", Standing { map: live.map.clone(), ..standing.clone() });
    let (folded, live) = (bare(folded), bare(live));
    let differ: Vec<_> = folded.lines().zip(live.lines()).filter(|(folded, live)| folded != live).collect();
    panic!("seed {seed}: folded and live differ: {differ:#?}");
}
