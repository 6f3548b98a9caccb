//! The timeline of one mission: which entries are shown, and where. The timeline consists of sections of `SECTION`
//! entries. New entries are added at its end, so only the last section changes. One unit to the right is `UNIT_MS` of
//! mission time. A time in which the program was off is drawn with a length of at most `OFF_MS`. `section` draws the
//! sections.

use std::sync::Arc;

use serde::Serialize;

use super::section::{Section, TemperaturePoint, escaped, id};
use crate::api::time::Zone;
use crate::phrases::Language;
use crate::runtime::archive::{At, Happened};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::state::{Conditions, Phase, Speaking};
use hallsweep_core::units::{Celsius, MissionId, Seq, WallTime};
use hallsweep_core::world::luggage::PhotoState;

const SECTION: usize = 64;

/// Milliseconds per unit of the horizontal axis.
const UNIT_MS: i64 = 100;

/// Maximum number of entries drawn. This is enough for several days of a busy mission.
pub(in super::super) const MOST: usize = 20_000;

/// Minimum length of the timeline, in milliseconds. A shorter mission leaves the rest empty.
const LEAST_MS: i64 = 20_000;

/// Maximum drawn length of a time in which the program was off, in milliseconds.
const OFF_MS: i64 = 5_000;

pub(in super::super) const LAST: Seq = Seq(u64::MAX);

/// What the script needs to convert between positions on the timeline and times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in super::super) struct Scale {
    mission: u64,
    /// Time at which the first entry was written, in milliseconds since 1970.
    began: i64,
    /// Time at which the last entry was written, in milliseconds since 1970. `last` is the number of that entry.
    end: i64,
    last: u64,
    /// Gaps in the axis of time: the program was off, or the clock was changed. Each has three values in milliseconds:
    /// the time before the gap, the time after it, and the length of the gap in the drawing.
    breaks: Vec<[i64; 3]>,
    /// Milliseconds per unit of the horizontal axis.
    unit: i64,
    open: bool,
    /// Whether the timeline ends early because it has reached the maximum number of entries.
    cut: bool,
}

#[derive(Clone, Debug)]
pub(in super::super) struct Timeline {
    mission: MissionId,
    language: Language,
    zone: Zone,
    threshold: Celsius,
    full: Vec<Arc<str>>,
    growing: Section,
    carried: OpenSpans,
    began: Option<i64>,
    end: i64,
    last: Seq,
    leaps: Vec<(Seq, [i64; 3])>,
    entries: usize,
    is_over: bool,
}

/// State that continues from one section to the next, such as the phase and the last temperature reading.
#[derive(Clone, Debug, Default)]
struct OpenSpans {
    phase: Option<(PhaseName, Option<PhaseName>)>,
    reading: Option<TemperaturePoint>,
    speaking: Speaking,
    stage: Option<&'static str>,
}

impl Timeline {
    pub(super) fn new(mission: MissionId, language: Language, zone: Zone, threshold: Celsius) -> Timeline {
        Timeline {
            mission,
            language,
            zone,
            threshold,
            full: Vec::new(),
            growing: Section::default(),
            carried: OpenSpans::default(),
            began: None,
            end: 0,
            last: Seq(0),
            leaps: Vec::new(),
            entries: 0,
            is_over: false,
        }
    }

    pub(in super::super) const fn mission(&self) -> MissionId {
        self.mission
    }

    pub(super) const fn last(&self) -> Seq {
        self.last
    }

    pub(super) const fn language(&self) -> Language {
        self.language
    }

    pub(super) const fn is_complete(&self) -> bool {
        self.is_over || self.is_cut()
    }

    pub(in super::super) const fn is_cut(&self) -> bool {
        self.entries >= MOST && !self.is_over
    }

    pub(in super::super) fn is_empty(&self) -> bool {
        self.began.is_none()
    }

    pub(in super::super) fn scale(&self) -> Scale {
        Scale {
            mission: self.mission.0,
            began: self.began.unwrap_or(0),
            end: self.end,
            last: self.last.0,
            breaks: self.leaps.iter().map(|(_, leap)| *leap).collect(),
            unit: UNIT_MS,
            open: !self.is_complete(),
            cut: self.is_cut(),
        }
    }

    pub(in super::super) fn width(&self) -> i64 {
        self.x(self.end).max(LEAST_MS / UNIT_MS)
    }

    pub(in super::super) fn x(&self, unix_ms: i64) -> i64 {
        let (_, shown, off) = self.stretch(unix_ms);
        shown.saturating_sub(self.began.unwrap_or(shown)).saturating_sub(off).max(0) / UNIT_MS
    }

    pub(in super::super) fn at(&self, unix_ms: i64) -> At {
        let (place, ..) = self.stretch(unix_ms);
        let least = place.checked_sub(1).map_or(Seq(0), |before| self.leaps[before].0);
        At::TimeAmong(unix_ms, [least, self.leaps.get(place).map_or(LAST, |(seq, _)| Seq(seq.0.saturating_sub(1)))])
    }

    /// Finds the part of the timeline that contains the clock time `unix_ms`; jumps of the clock separate the parts.
    /// Returns three values: the number of the part, the clock time at which the moment is drawn, and how far the
    /// clock is ahead of the timeline in this part. Times are in milliseconds. If the clock was set back and showed a
    /// time twice, the later part counts. A time that the clock skipped is drawn at the jump.
    fn stretch(&self, unix_ms: i64) -> (usize, i64, i64) {
        let (mut from, mut off, mut is_found) = (self.began.unwrap_or(unix_ms), 0_i64, false);
        let mut stretch = (0, from, 0);
        for place in 0..=self.leaps.len() {
            let leap = self.leaps.get(place);
            let to = leap.map_or(self.end, |(_, [to, ..])| *to);
            let is_here = from <= unix_ms && unix_ms <= to;
            if is_here || (from <= unix_ms && !is_found) {
                stretch = (place, if leap.is_some() { unix_ms.min(to) } else { unix_ms }, off);
            }
            is_found |= is_here;
            if let Some((_, [leapt_from, leapt_to, shown])) = leap {
                off = off.saturating_add(leapt_to.saturating_sub(*leapt_from).saturating_sub(*shown));
                from = *leapt_to;
            }
        }
        stretch
    }

    /// Number of sections that are full and cannot change any more.
    pub(in super::super) fn full(&self) -> usize {
        self.full.len()
    }

    /// Returns the sections from number `from` on, each as a group with its id. Only the last one can still change.
    pub(in super::super) fn sections(&self, from: usize) -> impl Iterator<Item = (String, Arc<str>)> {
        let growing = Arc::from(self.growing.drawn(self.full.len(), self.carried.reading));
        let sections = self.full.iter().skip(from).cloned().chain([growing]);
        (from..).zip(sections).map(|(place, markup)| (id(place), markup))
    }

    pub(super) const fn under(&mut self, conditions: &Conditions) {
        self.threshold = conditions.threshold;
    }

    pub(super) fn extend(&mut self, happened: &[Happened]) {
        for (seq, entry) in happened {
            self.last = *seq;
            if self.is_complete() {
                return;
            }
            if let Ok(entry) = entry {
                self.add(entry.wall, &entry.fact);
            }
        }
    }

    fn add(&mut self, wall: WallTime, fact: &Fact) {
        if self.began.is_none() {
            (self.began, self.end) = (Some(wall.unix_ms), wall.unix_ms);
        } else if let Fact::ClockSet(by_ms) = fact {
            let set = self.end.saturating_add(*by_ms).min(wall.unix_ms);
            self.leaps.push((self.last, [self.end, set, 0]));
            self.end = set;
        } else if matches!(fact, Fact::ProgramStarted(_)) && wall.unix_ms.saturating_sub(self.end) > OFF_MS {
            self.leaps.push((self.last, [self.end, wall.unix_ms, OFF_MS]));
        }
        // Old journals do not record clock changes. There, a clock that was set back does not move the end of the
        // timeline back.
        self.end = self.end.max(wall.unix_ms);
        self.entries += 1;
        self.is_over = matches!(fact, Fact::MissionArchived(..));
        let x = self.x(self.end);
        if !self.carried.speaking.hear(fact) {
            self.growing.reading_ends(x, &mut self.carried.reading);
        }
        if let Fact::Phase(phase) = fact {
            self.phase(x, wall, (phase.name(), phase.interrupted().map(Phase::name)));
        } else if let Fact::Holds(holds) = fact {
            self.holds(x, wall, fact, !holds.is_empty());
        } else if let Fact::Conditions(conditions) = fact {
            self.under(conditions);
            // The threshold may have changed, so the last reading is compared with the threshold again.
            if let Some(TemperaturePoint { celsius, .. }) = self.carried.reading {
                self.growing.reading(x, celsius, self.threshold, &mut self.carried.reading);
            }
        } else if let Fact::Temperature(_, celsius) = fact {
            self.growing.reading(x, *celsius, self.threshold, &mut self.carried.reading);
        } else if let Fact::Retrieval(retrieval) = fact {
            let stage = retrieval.as_ref().map(|retrieval| retrieval.stage.name());
            if std::mem::replace(&mut self.carried.stage, stage) != stage {
                self.mark(x, wall, "secured", fact);
            }
        } else if let Some(class) = class(fact) {
            self.mark(x, wall, class, fact);
        }
        self.growing.entries += 1;
        if self.growing.entries == SECTION {
            let full = std::mem::take(&mut self.growing);
            self.full.push(Arc::from(full.drawn(self.full.len(), None)));
            self.growing.go_on(self.carried.reading);
        }
    }

    fn phase(&mut self, x: i64, wall: WallTime, phase: (PhaseName, Option<PhaseName>)) {
        if self.carried.phase == Some(phase) {
            return;
        }
        self.carried.phase = Some(phase);
        let (name, interrupted) = phase;
        let phase = self.language.phase_and_before(name, interrupted);
        let (said, about) = (format!("{} {phase}", self.zone.clock_time(wall)), format!(" data-name=\"{}\"", escaped(&phase)));
        self.growing.band(x, (0, 12), &format!("phase {}", name.name()), &about, &said);
    }

    fn holds(&mut self, x: i64, wall: WallTime, fact: &Fact, is_held: bool) {
        let said = format!("{} {}", self.zone.clock_time(wall), self.language.fact(fact));
        self.growing.band(x, (12, 16), if is_held { "hold" } else { "no-hold" }, "", &said);
    }

    fn mark(&mut self, x: i64, wall: WallTime, class: &str, fact: &Fact) {
        let said = format!("{} {}", self.zone.clock_time(wall), self.language.fact(fact));
        self.growing.mark(x, class, &about(fact), &said);
    }
}

/// Returns attributes with the piece that a fact is about, and with the number of its photo. The page puts the photo
/// on the timeline.
fn about(fact: &Fact) -> String {
    let (piece, take) = if let Fact::Luggage { record, .. } = fact {
        let take = if let PhotoState::Taken { take, .. } = record.photo { Some(take) } else { None };
        (record.id, take)
    } else if let Fact::Verdict { luggage, .. } = fact {
        (*luggage, None)
    } else {
        return String::new();
    };
    let take = take.map(|take| format!(" data-take=\"{take}\"")).unwrap_or_default();
    format!(" data-piece=\"{piece}\"{take}")
}

/// Returns the CSS class of a fact's mark, or `None` if the fact has no mark.
fn class(fact: &Fact) -> Option<&'static str> {
    Some(match fact {
        Fact::Luggage { .. } => "found",
        Fact::Verdict { verdict: Verdict::Safe, .. } => "safe",
        Fact::Verdict { verdict: Verdict::Danger, .. } => "danger",
        Fact::Secured(_) => "secured",
        Fact::AlarmRaised(..) => "alarm",
        Fact::AlarmAcknowledged(..) => "seen",
        // The fact `Verdict` already has a mark, so the command that gave the verdict gets no mark.
        Fact::Command { asked: Asked::Command(Command::Verdict { .. }), refused: None, .. } => return None,
        Fact::Command { refused: Some(_), .. } => "refused",
        Fact::Command { asked: Asked::Command(Command::Stop) | Asked::Stops { .. }, .. } => "stop",
        Fact::Command { .. } => "command",
        Fact::ProgramStarted(_) | Fact::ProgramEnded(_) | Fact::ClockSet(_) | Fact::WrittenOut(_) | Fact::Unpacked(_) => {
            "program"
        }
        Fact::MissionBegan(..)
        | Fact::MissionArchived(..)
        | Fact::Strategy(_)
        | Fact::Conditions(_)
        | Fact::Phase(_)
        | Fact::Holds(_)
        | Fact::Judged(_)
        | Fact::Unsure { .. }
        | Fact::Revealed { .. }
        | Fact::Closed(_)
        | Fact::HandedOver { .. }
        | Fact::SearchAgain(_)
        | Fact::AreasOrdered(_)
        | Fact::AreaClosed(..)
        | Fact::Retrieval(_) => {
            return None;
        }
        Fact::State(_) | Fact::Epoch(_) | Fact::Goal(..) | Fact::Pose(_) | Fact::RobotPose(..) | Fact::Outside(..) => {
            return None;
        }
        Fact::MetAgain(..) | Fact::Led(_) | Fact::Obstacle(..) | Fact::Mark(..) | Fact::MapEmptied(_) => return None,
        // These facts are drawn in the temperature curve and have no mark.
        Fact::Temperature(..) | Fact::ThermometerSilent(_) => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::section::{FAR, THRESHOLD_Y};
    use super::*;
    use crate::api::tests::fixture::{TEN, degrees, piece};
    use hallsweep_core::command::{Issuer, LuggageRef};
    use hallsweep_core::hold::Hold;
    use hallsweep_core::settings::Rules;
    use hallsweep_core::state::Venue;
    use hallsweep_core::state::fact::Entry;
    use hallsweep_core::units::{Cell, LuggageId};

    /// Builds timeline entries from facts. Each fact comes with its time, in seconds after `TEN`.
    fn happened(facts: impl IntoIterator<Item = (i64, Fact)>) -> Vec<Happened> {
        let at = |second: i64| WallTime { unix_ms: TEN.unix_ms + second * 1000, ..TEN };
        (1..).map(Seq).zip(facts.into_iter().map(|(second, fact)| Ok(Entry { wall: at(second), fact }))).collect()
    }

    fn line(facts: impl IntoIterator<Item = (i64, Fact)>) -> Timeline {
        let mut line = Timeline::new(MissionId(1), Language::English, Zone::of(TEN), degrees(25.0));
        line.extend(&happened(facts));
        line
    }

    fn drawn(line: &Timeline) -> String {
        line.sections(0).map(|(_, markup)| markup.to_string()).collect()
    }

    fn temperature(celsius: f64) -> Fact {
        Fact::Temperature("hall".into(), degrees(celsius))
    }

    fn command(command: Command) -> Fact {
        let issuer = Issuer { who: "<anna>".into(), ..Issuer::operator(crate::api::door::CONSOLE) };
        Fact::Command { issuer, id: None, asked: Asked::Command(command), epoch: None, luggage: None, refused: None }
    }

    #[test]
    fn a_time_that_a_damaged_journal_has_ends_no_page() {
        for unix_ms in [i64::MIN, -9_223_372_036_854_775_000, i64::MAX] {
            let mut line = Timeline::new(MissionId(1), Language::English, Zone::of(TEN), degrees(25.0));
            let entry = |unix_ms, fact| Ok(Entry { wall: WallTime { unix_ms, ..TEN }, fact });
            let started = || Fact::ProgramStarted("1".to_owned());
            line.extend(&[
                (Seq(1), entry(unix_ms, started())),
                (Seq(2), entry(TEN.unix_ms, started())),
                (Seq(3), entry(unix_ms, started())),
            ]);
            assert!(line.width() > 0 && line.x(i64::MIN) >= 0 && line.x(i64::MAX) >= 0);
        }
    }

    #[test]
    fn the_temperature_is_drawn_level_from_its_first_reading_until_it_is_not_known_any_more() {
        let read = || (0, temperature(22.0));
        let path = |facts: Vec<(i64, Fact)>| {
            let path = drawn(&line(facts)).split_once("class=\"temperature\" d=\"").map(|(_, path)| path.to_owned())?;
            Some(path.split('"').next()?.split_once('H')?.1.to_owned())
        };
        let silent = |source: &str| Fact::ThermometerSilent(source.into());
        let stop = || (60, command(Command::Stop));
        assert_eq!(path(vec![read(), stop()]), Some(FAR.to_string()), "a temperature that stays is a line");
        assert_eq!(path(vec![read(), (20, silent("hall")), stop()]).as_deref(), Some("200"), "it ends with its source");
        assert_eq!(path(vec![read(), (20, silent("robot")), stop()]), Some(FAR.to_string()), "but not with another one");
        let started = Fact::ProgramStarted("1.0".into());
        assert_eq!(path(vec![read(), (3, started), stop()]).as_deref(), Some("30"), "what was off heard nothing");
        assert_eq!(path(vec![stop()]), None, "where nothing was read there is none");
    }

    #[test]
    fn phases_holds_temperatures_pieces_verdicts_stops_and_commands_stand_at_their_times() {
        let verdict =
            |verdict| Fact::Verdict { luggage: LuggageId(3), verdict, who: "anna".into(), note: None, hot: Default::default() };
        let found = Fact::Luggage { record: piece(3, Cell::new(1, 2), None), photo: None };
        let line = line([
            (0, Fact::Phase(Phase::Exploring)),
            (1, command(Command::Start)),
            (2, temperature(25.0)),
            (4, found),
            (
                6,
                command(Command::Verdict {
                    luggage: LuggageRef::Id(LuggageId(3)),
                    verdict: Verdict::Safe,
                    note: None,
                    hot: Default::default(),
                }),
            ),
            (6, verdict(Verdict::Safe)),
            (7, verdict(Verdict::Danger)),
            (8, command(Command::Stop)),
            (8, Fact::Holds(vec![Hold::Operator])),
        ]);
        let drawn = drawn(&line);
        for part in [
            "class=\"phase exploring\" d=\"M0 0H1000000000v12H0z\" data-name=\"exploring\">",
            "class=\"mark command\" d=\"M10 57V64\"",
            "class=\"mark found\" d=\"M40 49V54\" data-piece=\"3\" data-take=\"1\">",
            "class=\"mark safe\" d=\"M60 44V54\" data-piece=\"3\">",
            "class=\"mark danger\" d=\"M70 42V56\" data-piece=\"3\">",
            "class=\"mark stop\" d=\"M80 0V64\"",
            "class=\"hold\" d=\"M80 12",
            "START by &#60;anna&#62;",
        ] {
            assert!(drawn.contains(part), "{part} in {drawn}");
        }
        assert!(!drawn.contains("M60 57"), "a verdict is one mark");
        assert_eq!((line.width(), line.scale().end), (200, TEN.unix_ms + 8000));
    }

    #[test]
    fn the_temperature_holds_until_the_next_reading_and_what_is_too_hot_is_seen() {
        let line = line([(0, temperature(25.0)), (2, temperature(27.0)), (5, temperature(20.0))]);
        let threshold = THRESHOLD_Y;
        let drawn = drawn(&line);
        assert!(drawn.contains(&format!("class=\"temperature\" d=\"M0 {threshold}H20V")), "{drawn}");
        let (_, hot) = drawn.split_once("temperature hot\" d=\"M20 ").expect("it was too hot");
        assert!(hot.split('"').next().unwrap().ends_with("H50"), "{hot}");
    }

    #[test]
    fn what_is_too_hot_is_so_by_the_threshold_of_then() {
        let venue = Venue { name: "depot".into(), ..Venue::default() };
        let under = |threshold| Conditions { threshold: degrees(threshold), venue: venue.clone(), rules: Rules::default() };
        let facts = [
            (0, Fact::Conditions(under(30.0))),
            (1, temperature(27.0)),
            (4, Fact::Conditions(under(20.0))),
            (6, Fact::Conditions(under(28.0))),
        ];
        let hot = |line: &Timeline| {
            drawn(line).split_once("temperature hot\" d=\"").map(|(_, d)| d.split('"').next().unwrap().to_owned())
        };
        let hot_at = hot(&line(facts.clone())).expect("it was too hot for a while");
        assert!(hot_at.starts_with("M40 ") && hot_at.ends_with("H60"), "{hot_at}");
        let mut before = Timeline::new(MissionId(1), Language::English, Zone::of(TEN), degrees(25.0));
        before.under(&under(30.0));
        before.extend(&happened([facts[1].clone()]));
        assert_eq!(hot(&before), None, "they may have been said before the mission");
    }

    #[test]
    fn what_is_full_never_changes_and_the_temperature_goes_on_beyond_it() {
        let many = |count: i64| (0..count).map(|second| (second, temperature(20.0 + (second % 3) as f64)));
        let (before, after) = (line(many(100)), line(many(1000)));
        assert_eq!((before.full(), after.full()), (100 / SECTION, 1000 / SECTION));
        let first = |line: &Timeline| line.sections(0).next().unwrap().1;
        assert_eq!(first(&before), first(&after));
        for (place, (_, markup)) in after.sections(1).enumerate() {
            let from = (place as i64 + 1) * SECTION as i64 - 1;
            assert!(
                markup.contains(&format!("d=\"M{} ", from * 10)),
                "section {place} begins where the one before it ended: {markup}"
            );
        }
    }

    #[test]
    fn while_the_program_was_off_no_time_passes_and_a_clock_set_back_does_not_go_back() {
        let line = line([
            (0, command(Command::Start)),
            (10, Fact::ProgramEnded("SIGTERM".to_owned())),
            (36_010, Fact::ProgramStarted("1".to_owned())),
            (36_020, command(Command::Start)),
            (30_000, command(Command::Reset)),
        ]);
        let at = |second: i64| line.x(TEN.unix_ms + second * 1000);
        assert_eq!((at(10), at(36_010), at(36_020)), (100, 150, 250));
        assert_eq!(line.scale().breaks, [[TEN.unix_ms + 10_000, TEN.unix_ms + 36_010_000, 5000]]);
        assert!(drawn(&line).matches("M250 57").count() == 2, "{}", drawn(&line));
    }

    #[test]
    fn a_clock_that_is_set_neither_stretches_the_line_nor_folds_it() {
        let line = line([
            (0, command(Command::Start)),
            (100, command(Command::Stop)),
            (-3490, Fact::ClockSet(-3_600_000)),
            (-3480, command(Command::Start)),
            (-3400, command(Command::Stop)),
            (83_020, Fact::ClockSet(86_400_000)),
            (83_030, command(Command::Reset)),
        ]);
        let drawn = drawn(&line);
        let x_of = |words: &str| {
            let (before, _) = drawn.split_once(words).unwrap_or_else(|| panic!("{words} in {drawn}"));
            before.rsplit("d=\"M").next().and_then(|d| d.split(' ').next()).and_then(|x| x.parse::<i64>().ok())
        };
        assert_eq!(x_of("the clock was set back by 1:00:00"), Some(1100), "{drawn}");
        assert_eq!((x_of("the clock went forward by 24:00:00"), x_of("RESET")), (Some(2200), Some(2300)), "{drawn}");
        let time = |second: i64| TEN.unix_ms + second * 1000;
        for (second, x, of) in [
            (50, 500, [Seq(0), Seq(2)]),
            (-3485, 1150, [Seq(3), Seq(5)]),
            // The clock skipped this time.
            (40_000, 2000, [Seq(3), Seq(5)]),
            (83_025, 2250, [Seq(6), LAST]),
        ] {
            assert_eq!((line.x(time(second)), line.at(time(second))), (x, At::TimeAmong(time(second), of)), "{second}");
        }
        assert_eq!(line.width(), 2300);
    }

    #[test]
    fn it_ends_with_the_mission_and_before_it_is_too_much() {
        let over = line([
            (0, command(Command::Start)),
            (1, Fact::MissionArchived(MissionId(1), Vec::new())),
            (2, command(Command::Start)),
        ]);
        assert!(over.is_complete() && !over.scale().open && !over.scale().cut);
        assert_eq!(over.scale().end, TEN.unix_ms + 1000);
        let endless = line((0..MOST as i64 + 10).map(|second| (second, command(Command::Start))));
        assert!(endless.is_complete() && endless.scale().cut && !endless.scale().open);
        assert_eq!(endless.entries, MOST);
    }
}
