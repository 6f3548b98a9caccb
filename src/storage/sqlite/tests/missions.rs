//! Missions are read again, past ones and the present one: their state at the end, their state at any moment, and
//! their entries.

use std::sync::Arc;

use super::testing::*;
use crate::runtime::archive::{Archive, At, PastMoment, Sound, Span};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, LuggageRef, Verdict};
use hallsweep_core::state::Phase;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{Cell, LuggageId, MissionId, Pose, Seq, WallTime};
use hallsweep_core::world::hall_map::Mark;

#[test]
fn a_mission_that_is_over_is_read_as_it_ended() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    scribe.keep(vec![wall(5, 5), inspecting(1), found(1, Some(photo("bag")))]);
    scribe.keep(vec![verdict(1, Verdict::Danger)]);
    scribe.keep(archive(1));
    scribe.keep([begin(2), vec![found(2, None)]].concat());
    let archive = &scribe.opened.archive;
    let missions = archive.missions(None, 10).unwrap();
    let figures: Vec<_> =
        missions.iter().map(|it| (it.id.0, &*it.phase, it.luggage, it.dangerous, it.archived.is_some())).collect();
    assert_eq!(figures, [(2, "exploring", 1, 0, false), (1, "inspecting", 1, 1, true)]);
    assert_eq!(missions[1].left, [LuggageId(9)]);
    assert_eq!(archive.missions(Some(MissionId(2)), 10).unwrap(), missions[1..]);
    assert_eq!(archive.missions(None, 1).unwrap(), missions[..1]);
    assert_eq!(archive.mission(MissionId(1)).unwrap().as_ref(), Some(&missions[1]));
    assert_eq!(archive.mission(MissionId(3)), Ok(None));

    let ended = archive.state(MissionId(1)).unwrap().expect("there was a mission 1").of;
    assert_eq!((ended.phase.name().name(), ended.under_way), ("inspecting", true));
    assert!(ended.luggage[0].is_dangerous());
    assert!(ended.map.at(hallsweep_core::units::Cell::new(5, 5)).is_obstacle());
    let now = archive.state(MissionId(2)).unwrap().expect("there is a mission 2").of;
    assert_eq!((now.phase, now.luggage.len()), (Phase::Exploring, 1));
    assert_eq!(archive.state(MissionId(3)), Ok(None));
    check_finds(&scratch, &[]);
}

#[test]
fn a_mission_is_read_as_it_stood_after_each_of_its_entries() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    let warm = Fact::Temperature("hall".into(), hallsweep_core::units::Celsius::new(27.5).expect("it is one"));
    scribe.keep(vec![command(None)]);
    let first =
        [begin(1), vec![wall(5, 5), warm, inspecting(1), found(1, Some(photo("bag"))), verdict(1, Verdict::Danger)]].concat();
    scribe.keep(first.clone());
    scribe.keep([archive(1), begin(2)].concat());
    let archive = &scribe.opened.archive;
    let all: Vec<Entry> = std::iter::once(command(None)).chain(first.clone()).map(at_noon).collect();
    let mut earlier = None;
    for (seq, _) in archive.entries(MissionId(1), Span::after(Seq(0)), 100).unwrap() {
        let Some(so_far) = usize::try_from(seq.0).ok().and_then(|count| all.get(..count)) else { break };
        let moment = moment(archive, 1, seq).expect("it has this entry");
        let Sound { of: past, damage } = moment.past;
        assert_eq!((past.seq, moment.earlier, damage.len()), (seq, earlier, 0));
        let (mut state, mut folded) = (past.state, fold(so_far));
        // Photos are stored separately.
        for state in [&mut state, &mut folded] {
            state.luggage = Default::default();
        }
        assert_eq!(state, folded, "after entry {seq}");
        let is_warm = so_far.iter().any(|entry| matches!(entry.fact, Fact::Temperature(..)));
        assert_eq!(past.temperatures.len(), usize::from(is_warm), "after entry {seq}");
        earlier = Some(seq);
    }
    assert_eq!(earlier, Some(Seq(all.len() as u64)), "all of them were looked at");
    let found = moment(archive, 1, Seq(all.len() as u64)).expect("it is there").past.of;
    assert!(found.state.luggage[0].is_dangerous());
    assert_eq!(moment(archive, 1, Seq(1)), None, "it had not begun");
    assert_eq!(moment(archive, 3, Seq(9)), None);
    assert_eq!(moment(archive, u64::MAX, Seq(9)), None);
    let last = moment(archive, 1, Seq(u64::MAX)).expect("there is a last");
    let reset = Seq(all.len() as u64 + 1);
    assert_eq!((last.past.of.seq, last.later), (reset, None), "what RESET empties begins what comes next");
}

fn moment(archive: &Arc<dyn Archive>, mission: u64, seq: Seq) -> Option<PastMoment> {
    archive.moments(MissionId(mission), &[At::Entry(seq)]).unwrap().pop()
}

#[test]
fn a_moment_is_found_by_its_time_and_two_of_them_share_the_map_that_is_the_same() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    let far = Cell::new(500, 500);
    let step = |x, y| Fact::Pose(Pose { cell: Cell::new(x, y), ..Pose::START });
    let facts =
        [begin(1), vec![wall(5, 5), Fact::Mark(far, Mark::Visited), step(0, 1), step(1, 1), wall(6, 5), step(1, 2)]].concat();
    let first = at_noon(command(None)).wall.unix_ms;
    let after = |seconds: i64| first + seconds * 1000;
    let entries = facts.iter().zip(1..).map(|(fact, second)| {
        let wall = WallTime { unix_ms: after(second), ..at_noon(command(None)).wall };
        Entry { wall, fact: fact.clone() }
    });
    scribe.keep_entries(entries.collect());
    let archive = &scribe.opened.archive;
    let all = archive.entries(MissionId(1), Span::after(Seq(0)), 100).unwrap();
    for (seq, entry) in &all {
        let written = entry.as_ref().unwrap().wall.unix_ms;
        for time in [written, written + 999] {
            let found = archive.moments(MissionId(1), &[At::Time(time)]).unwrap().pop().expect("there is one");
            assert_eq!(found.past.of.seq, *seq, "at {time}");
        }
    }
    let (begun, ended) = (all[0].0, all[all.len() - 1].0);
    for (time, seq) in [(i64::MIN, begun), (first, begun), (i64::MAX, ended)] {
        assert_eq!(archive.moments(MissionId(1), &[At::Time(time)]).unwrap()[0].past.of.seq, seq);
    }
    // The two moments may be in any order.
    for (from, to) in [(begun.next(), ended), (ended, begun.next())] {
        let moments = archive.moments(MissionId(1), &[At::Entry(from), At::Entry(to)]).unwrap();
        assert_eq!((moments[0].past.of.seq, moments[1].past.of.seq), (from, to));
    }
    let [late, end] = [&all[all.len() - 2].0, &ended];
    let moments = archive.moments(MissionId(1), &[At::Entry(*late), At::Entry(*end)]).unwrap();
    let [before, last] = [&moments[0].past.of.state.map, &moments[1].past.of.state.map];
    assert_eq!(before.tiles_changed_since(last).count(), 0, "a step changes no map");
    assert_eq!(moments[1].past.of.trail, [Cell::HOME, Cell::new(0, 1), Cell::new(1, 1)], "the cells that were left");
}

#[test]
fn the_entries_of_a_mission_are_read_page_by_page() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(vec![command(None)]);
    scribe.keep(begin(1));
    scribe.keep(archive(1));
    scribe.keep(begin(2));
    let archive = &scribe.opened.archive;
    let places = |mission, after, most| -> Vec<u64> {
        let entries = archive.entries(MissionId(mission), Span::after(Seq(after)), most).unwrap();
        entries.iter().map(|(seq, _)| seq.0).collect()
    };
    assert_eq!(places(1, 0, 100), [2, 3, 4, 5, 6, 8], "the phase after the mission is not its own");
    assert_eq!(places(1, 3, 2), [4, 5]);
    assert_eq!(places(2, 0, 100), [9, 10, 11, 12]);
    assert_eq!(archive.entries(MissionId(2), Span::after(Seq(11)), 9).unwrap(), [(Seq(12), Ok(at_noon(Fact::Led(true))))]);
}

/// A reader who asks for a moment gets what was known at this moment. A verdict "danger" that came a moment later
/// does not change it.
#[test]
fn a_safe_stands_as_accepted_up_to_the_danger_that_overtakes_it_and_behind_that_as_refused() {
    let is_refused = |archive: &Arc<dyn Archive>, until| {
        let entries = archive.entries(MissionId(1), Span { after: Seq(0), until }, 100).unwrap();
        let mut said = entries.into_iter().map(|(_, entry)| entry.unwrap().fact);
        said.find_map(|fact| {
            let Fact::Command { refused, luggage: Some(LuggageId(1)), .. } = fact else { return None };
            Some(refused.is_some())
        })
    };
    let Fact::Command { issuer, id, epoch, refused, .. } = command(None) else { unreachable!("it is a command") };
    let luggage = LuggageId(1);
    let asked = Asked::Command(Command::Verdict {
        luggage: LuggageRef::Id(luggage),
        verdict: Verdict::Safe,
        note: None,
        hot: Default::default(),
    });
    let safe = Fact::Command { issuer, id, asked, epoch, luggage: Some(luggage), refused };
    let standing = |facts: &[Fact]| {
        let entries: Vec<Entry> = facts.iter().cloned().map(at_noon).collect();
        Fact::State(Box::new(fold(&entries)))
    };
    let begun = [begin(1), vec![found(1, None), found(2, None), verdict(2, Verdict::Danger)]].concat();
    let known = standing(&[&begun[..], &[verdict(1, Verdict::Danger)]].concat());
    for overtakes in [verdict(1, Verdict::Danger), known] {
        let scratch = Scratch::new();
        let mut scribe = Scribe::new(scratch.open());
        scribe.keep(begun.clone());
        let before = scribe.keep(vec![safe.clone(), verdict(1, Verdict::Safe), verdict(2, Verdict::Danger)]);
        assert_eq!(is_refused(&scribe.opened.archive, before), Some(false));
        let after = scribe.keep(vec![overtakes]);
        let archive = &scribe.opened.archive;
        assert_eq!(is_refused(archive, before), Some(false), "as it was said then");
        assert_eq!((is_refused(archive, after), is_refused(archive, Seq(u64::MAX))), (Some(true), Some(true)));
    }
}

/// Safety V3.
#[test]
fn after_which_entry_all_is_lost_is_known_to_who_reads_until_it_is_taken_back() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    let kept = scribe.keep(begin(1));
    assert_eq!(scribe.opened.archive.lost_after(), Ok(None));
    let marker = scratch.data().join("journal.lost");
    std::fs::write(&marker, format!("everything after entry {:020} was said to be lost\n", kept.0)).unwrap();
    assert_eq!(scribe.opened.archive.lost_after(), Ok(Some(kept)));
    std::fs::write(&marker, "everything after that").unwrap();
    assert!(scribe.opened.archive.lost_after().unwrap_err().0.contains("journal.lost"));
}
