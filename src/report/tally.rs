//! Counts over a whole mission, in one pass over its record.

use super::{Failure, each};
use crate::runtime::archive::{Archive, Unreadable};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, Strategy};
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{Celsius, MissionId, Seq, WallTime};

/// Maximum number of stored sentences about unreadable entries. Further unreadable entries are only counted.
const DAMAGES: usize = 100;

#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    seen: Option<Seq>,
    /// First and last readable entry, each with its time.
    pub(super) first: Option<(Seq, WallTime)>,
    pub(super) last: Option<(Seq, WallTime)>,
    /// The entry that archived the mission, with its time. A mission is archived by RESET or the next START.
    pub(super) archived: Option<(Seq, WallTime)>,
    pub(super) strategy: Option<Strategy>,
    pub(super) accepted: u64,
    pub(super) refused: u64,
    /// Number of accepted STOPs. Many STOPs may share an entry.
    pub(super) stops: u64,
    pub(super) alarms: u64,
    pub(super) acknowledged: u64,
    /// Number of program starts during the mission.
    pub(super) restarts: u64,
    /// Sum of the durations that the runs of the program measured, in milliseconds.
    measured_ms: i64,
    /// Latest time of an entry in this run of the program, in milliseconds since 1970. Adjusted when the clock is
    /// set.
    clock_ms: Option<i64>,
    /// How often the clock was set or the machine slept.
    pub(super) clock_sets: u64,
    /// Sum of all changes of the clock, in milliseconds.
    clock_set_ms: i64,
    pub(super) readings: u64,
    pub(super) coldest: Option<(Celsius, WallTime)>,
    pub(super) hottest: Option<(Celsius, WallTime)>,
    pub(super) damage: Vec<String>,
    pub(super) more_damage: u64,
}

impl Tally {
    pub(super) fn of(archive: &dyn Archive, mission: MissionId, until: Seq) -> Result<Tally, Unreadable> {
        let mut tally = Tally::default();
        let counted = each(archive, mission, until, |seq, entry| {
            tally.seen = Some(seq);
            match entry {
                Ok(entry) => tally.count(seq, entry),
                Err(Unreadable(why)) if tally.damage.len() < DAMAGES => tally.damage.push(why.clone()),
                Err(_) => tally.more_damage += 1,
            }
            Ok(())
        });
        match counted {
            Ok(()) => Ok(tally),
            Err(Failure::Unreadable(unreadable)) => Err(unreadable),
            Err(Failure::Unwritable(error)) => Err(Unreadable(error.to_string())),
        }
    }

    /// The last entry, even if it cannot be read.
    pub(super) fn last(&self) -> Option<Seq> {
        self.seen
    }

    /// The entry after which the mission had its final or present state. For an archived mission, this is the entry
    /// before the archiving; otherwise it is `until`.
    pub(super) fn stood_last(&self, until: Seq) -> Seq {
        self.archived.map_or(until, |(seq, _)| Seq(seq.0.saturating_sub(1)))
    }

    /// Duration of the mission in milliseconds. If the clock was set, this is the sum of what each run measured.
    /// Otherwise it is the difference of clock times.
    pub(super) fn took_ms(&self) -> i64 {
        if self.clock_sets > 0 { self.measured_ms } else { self.span_ms() }
    }

    /// Time from the first to the last readable entry, in milliseconds. Changes of the clock are subtracted.
    pub(super) fn span_ms(&self) -> i64 {
        let at = |end: Option<(Seq, WallTime)>| end.map_or(0, |(_, wall)| wall.unix_ms);
        at(self.last).saturating_sub(at(self.first)).saturating_sub(self.clock_set_ms)
    }

    fn count(&mut self, seq: Seq, Entry { wall, fact }: &Entry) {
        self.first.get_or_insert((seq, *wall));
        self.last = Some((seq, *wall));
        self.measure(wall.unix_ms, fact);
        if let Fact::MissionBegan(_, strategy) = fact {
            self.strategy = Some(*strategy);
        } else if let Fact::MissionArchived(..) = fact {
            self.archived = Some((seq, *wall));
        } else if let Fact::Command { asked, refused, .. } = fact {
            self.refused += u64::from(refused.is_some());
            self.accepted += u64::from(refused.is_none());
            self.stops += if refused.is_none() { stops(asked) } else { 0 };
        } else if let Fact::AlarmRaised(..) = fact {
            self.alarms += 1;
        } else if let Fact::AlarmAcknowledged(..) = fact {
            self.acknowledged += 1;
        } else if let Fact::ProgramStarted(_) = fact {
            self.restarts += 1;
        } else if let Fact::ClockSet(by_ms) = fact {
            self.clock_sets += 1;
            self.clock_set_ms = self.clock_set_ms.saturating_add(*by_ms);
        } else if let Fact::Temperature(_, celsius) = fact {
            self.read(*celsius, *wall);
        }
    }

    fn measure(&mut self, now_ms: i64, fact: &Fact) {
        let before_ms = match (self.clock_ms, fact) {
            (None, _) | (_, Fact::ProgramStarted(_)) => now_ms,
            (Some(before_ms), Fact::ClockSet(by_ms)) => before_ms.saturating_add(*by_ms),
            (Some(before_ms), _) => before_ms,
        };
        self.measured_ms = self.measured_ms.saturating_add(now_ms.saturating_sub(before_ms).max(0));
        self.clock_ms = Some(now_ms.max(before_ms));
    }

    fn read(&mut self, celsius: Celsius, wall: WallTime) {
        self.readings += 1;
        if self.coldest.is_none_or(|(coldest, _)| celsius.degrees() < coldest.degrees()) {
            self.coldest = Some((celsius, wall));
        }
        if self.hottest.is_none_or(|(hottest, _)| celsius.degrees() > hottest.degrees()) {
            self.hottest = Some((celsius, wall));
        }
    }
}

fn stops(asked: &Asked) -> u64 {
    match asked {
        Asked::Command(Command::Stop) => 1,
        Asked::Stops { count, .. } => *count,
        Asked::Command(_) | Asked::Simulated(_) | Asked::Many { .. } | Asked::Words(_) => 0,
    }
}
