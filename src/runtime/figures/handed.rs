//! Pages that were handed to the store but are not stored yet. A page is a group of journal entries. The time until
//! each page is stored is measured. The entries of a page are counted once the page is stored. Lost entries are not
//! counted until they are recorded anew.

use std::collections::VecDeque;
use std::time::Duration;

use super::{Families, Figures, OTHER};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::Verdict;
use hallsweep_core::effect::Page;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::{CODES, Refused};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{LuggageId, Pose, Seq};

/// Maximum number of waiting pages, and of waiting facts that will be counted. At this number, further pages are
/// ignored. A disk that hangs counts as failed long before this number is reached.
const WAITING: usize = 64 * 1024;

/// Pages that are not stored yet, and the state of the mission after the stored pages.
#[derive(Debug)]
pub struct HandedPages {
    figures: Figures,
    /// Last entry of each page, and the time at which the page was handed over.
    pages: VecDeque<(Seq, Duration)>,
    counted: VecDeque<(Seq, CountedFact)>,
    phase: PhaseName,
    /// The phase before the present phase. When a mission is archived, `left` is the last phase of the mission,
    /// because the following phase is recorded before the archiving.
    left: PhaseName,
    pose: Pose,
    luggage: LuggageId,
}

/// The part of an entry that is counted, or that helps to count another entry.
#[derive(Clone, Copy, Debug)]
enum CountedFact {
    MissionBegan,
    MissionEnded,
    Phase(PhaseName),
    Stands(PhaseName, Pose),
    Pose(Pose),
    /// Name of the command, number of commands to count, and code of the refusal, if any.
    Command(&'static str, u64, Option<&'static str>),
    Luggage(LuggageId, bool),
    Verdict(Verdict),
    Alarm,
}

impl HandedPages {
    pub fn new(figures: Figures, snapshot: &Snapshot) -> HandedPages {
        let luggage = snapshot.luggage.last().map_or(LuggageId(0), |luggage| luggage.id);
        let (phase, pose) = (snapshot.mission.phase, snapshot.robot.pose);
        HandedPages { figures, pages: VecDeque::new(), counted: VecDeque::new(), phase, left: phase, pose, luggage }
    }

    pub fn hand(&mut self, page: &Page, now: Duration) {
        // A page without entries has an answer that is kept back. Counting it would tell that somebody has answered.
        if page.entries.is_empty() || self.pages.len().max(self.counted.len()) >= WAITING {
            return;
        }
        self.pages.push_back((page.last(), now));
        let entries = (page.first.0..).map(Seq).zip(&page.entries);
        self.counted.extend(entries.filter_map(|(seq, entry)| Some((seq, CountedFact::of(&entry.fact)?))));
    }

    pub fn keep(&mut self, kept: Seq, now: Duration) {
        while let Some((_, handed)) = self.pages.front().copied().filter(|(last, _)| *last <= kept) {
            self.pages.pop_front();
            self.figures.0.records.observe(now.saturating_sub(handed));
        }
        while let Some((_, counted)) = self.counted.front().copied().filter(|(seq, _)| *seq <= kept) {
            self.counted.pop_front();
            self.count(counted);
        }
    }

    /// Forgets all waiting pages: the store has lost every page that was not stored yet.
    pub fn lose(&mut self) {
        self.pages.clear();
        self.counted.clear();
    }

    fn count(&mut self, counted: CountedFact) {
        let all: &Families = &self.figures.0;
        match counted {
            CountedFact::MissionBegan => drop(all.missions_begun.inc()),
            CountedFact::MissionEnded => drop(all.missions_ended.at([self.left.name()]).map(|ended| ended.inc())),
            CountedFact::Phase(phase) => {
                // The progress of an inspection is recorded as a phase, too. It is not counted as a new phase.
                if phase != self.phase {
                    self.left = std::mem::replace(&mut self.phase, phase);
                    all.phases.at([phase.name()]).map(|times| times.inc());
                }
            }
            CountedFact::Stands(phase, pose) => (self.phase, self.pose) = (phase, pose),
            CountedFact::Pose(pose) => {
                let before = std::mem::replace(&mut self.pose, pose);
                if before.cell.neighbours().contains(&pose.cell) {
                    all.steps.inc();
                } else if before.cell == pose.cell && before.heading != pose.heading {
                    all.turns.inc();
                }
            }
            CountedFact::Command(name, count, refused) => {
                let outcome = if refused.is_some() { "refused" } else { "accepted" };
                all.commands.at([name, outcome]).map(|commands| commands.inc_by(count));
                refused.and_then(|code| all.refusals.at([code])).map(|refusals| refusals.inc_by(count));
            }
            CountedFact::Luggage(luggage, has_photo) => {
                if luggage > self.luggage {
                    self.luggage = luggage;
                    all.luggage.inc();
                }
                all.photos.inc_by(u64::from(has_photo));
            }
            CountedFact::Verdict(verdict) => drop(all.verdicts.at([verdict.name()]).map(|verdicts| verdicts.inc())),
            CountedFact::Alarm => drop(all.alarms.inc()),
        }
    }
}

impl CountedFact {
    fn of(fact: &Fact) -> Option<CountedFact> {
        match fact {
            Fact::MissionBegan(..) => Some(CountedFact::MissionBegan),
            Fact::MissionArchived(..) => Some(CountedFact::MissionEnded),
            Fact::Phase(phase) => Some(CountedFact::Phase(phase.name())),
            Fact::State(state) => Some(CountedFact::Stands(state.phase.name(), state.pose)),
            Fact::Pose(pose) => Some(CountedFact::Pose(*pose)),
            Fact::Command { asked, refused, .. } => Some(CountedFact::command(asked, refused.as_ref())),
            Fact::Luggage { record, photo } => Some(CountedFact::Luggage(record.id, photo.is_some())),
            Fact::Verdict { verdict, .. } => Some(CountedFact::Verdict(*verdict)),
            Fact::AlarmRaised(..) => Some(CountedFact::Alarm),
            Fact::ProgramStarted(_)
            | Fact::ProgramEnded(_)
            | Fact::ClockSet(_)
            | Fact::Conditions(_)
            | Fact::Judged(_)
            | Fact::Unsure { .. }
            | Fact::Revealed { .. }
            | Fact::Closed(_)
            | Fact::HandedOver { .. }
            | Fact::SearchAgain(_)
            | Fact::AreasOrdered(_)
            | Fact::AreaClosed(..)
            | Fact::Holds(_)
            | Fact::Epoch(_)
            | Fact::Goal(..)
            | Fact::RobotPose(..)
            | Fact::Outside(..)
            | Fact::Retrieval(_)
            | Fact::MetAgain(..)
            | Fact::Secured(_)
            | Fact::Led(_)
            | Fact::Obstacle(..)
            | Fact::Mark(..)
            | Fact::Temperature(..)
            | Fact::ThermometerSilent(_)
            | Fact::AlarmAcknowledged(..)
            | Fact::Strategy(_)
            | Fact::MapEmptied(_)
            | Fact::WrittenOut(_)
            | Fact::Unpacked(_) => None,
        }
    }

    /// The command of an entry, to be counted. Accepted STOPs that share an entry are counted one by one. Refusals
    /// that share an entry count as one refusal, of the last command, because the entry does not name the other
    /// commands.
    fn command(asked: &Asked, refused: Option<&Refused>) -> CountedFact {
        let asked = if let Asked::Many { last, .. } = asked { last } else { asked };
        let shared = if let Asked::Stops { count, .. } = asked { Some(*count) } else { None };
        let count = shared.filter(|_| refused.is_none()).unwrap_or(1);
        let code = |refused: &Refused| if CODES.iter().any(|(code, _)| *code == refused.code()) { refused.code() } else { OTHER };
        CountedFact::Command(name(asked), count, refused.map(code))
    }
}

const fn name(asked: &Asked) -> &'static str {
    match asked {
        Asked::Stops { .. } => "stop",
        Asked::Simulated(_) | Asked::Many { .. } | Asked::Words(_) => OTHER,
        Asked::Command(command) => command.code(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use hallsweep_core::closing::{AreaClosing, Closing};
    use hallsweep_core::command::{Again, Command, Door, Issuer, LuggageRef, Move, Note, Strategy, TemperatureReport};
    use hallsweep_core::engine::Engine;
    use hallsweep_core::event::Photo;
    use hallsweep_core::hand_over::HandOver;
    use hallsweep_core::refused::{Refusal, RefusalKind};
    use hallsweep_core::settings::Settings;
    use hallsweep_core::state::fact::Entry;
    use hallsweep_core::state::{PersistentState, Phase};
    use hallsweep_core::units::{AlarmId, Cell, Heading, MissionId, WallTime};
    use hallsweep_core::world::alarm::AlarmCause;
    use hallsweep_core::world::hall_map::Bounds;
    use hallsweep_core::world::luggage::{Luggage, PhotoState};

    fn handed() -> (HandedPages, Figures) {
        let figures = Figures::default();
        let snapshot = Engine::new(Settings::default(), Strategy::default(), "test".into()).snapshot();
        (HandedPages::new(figures.clone(), &snapshot), figures)
    }

    fn page(first: u64, facts: impl IntoIterator<Item = Fact>) -> Page {
        let entry = |fact| Entry { wall: WallTime::default(), fact };
        Page { first: Seq(first), entries: facts.into_iter().map(entry).collect(), kept_back: None }
    }

    fn counted(facts: Vec<Fact>) -> Figures {
        let (mut handed, figures) = handed();
        let kept = Seq(facts.len() as u64);
        handed.hand(&page(1, facts), Duration::ZERO);
        handed.keep(kept, Duration::ZERO);
        figures
    }

    fn command(asked: Asked, refused: Option<&'static str>) -> Fact {
        let refusal = |code| Refusal { code, kind: RefusalKind::Conflict, words: "no".to_owned() };
        let refused = refused.map(|code| Refused::InWords(refusal(code)));
        Fact::Command { issuer: Issuer::operator(Door::LOCAL), id: None, asked, epoch: None, luggage: None, refused }
    }

    fn at(x: i32, y: i32, heading: Heading) -> Fact {
        Fact::Pose(Pose { cell: Cell::new(x, y), heading })
    }

    fn piece(id: u64, has_photo: bool) -> Fact {
        let photo = has_photo.then(|| Photo { bytes: Arc::from(*b"picture"), media_type: "image/png" });
        let record = Luggage {
            id: LuggageId(id),
            cell: Cell::HOME,
            pose: Pose::START,
            taken: WallTime::default(),
            first_taken: WallTime::default(),
            photo: PhotoState::Failed("dark".to_owned()),
            verdict: None,
            seen_from: Vec::new(),
            unsure: Vec::new(),
            judged: Vec::new(),
            truth: None,
            piece: None,
            secured: None,
            clock_set_ms: 0,
        };
        Fact::Luggage { record: Arc::new(record), photo }
    }

    fn alarm(id: u64) -> Fact {
        Fact::AlarmRaised(AlarmId(id), None, AlarmCause::Other("smoke".to_owned()))
    }

    #[test]
    fn a_page_counts_and_is_measured_when_it_is_kept_and_not_before() {
        let (mut handed, figures) = handed();
        let second = Duration::from_secs(1);
        handed.hand(&page(1, [alarm(1), alarm(2)]), second);
        handed.hand(&page(3, [alarm(3)]), second);
        let so_far =
            |figures: &Figures| ["alarms_total", "record_seconds_count", "record_seconds_sum"].map(|name| figures.value(name));
        handed.keep(Seq(0), second * 2);
        assert_eq!(so_far(&figures), [0.0, 0.0, 0.0]);
        handed.keep(Seq(2), second * 3);
        assert_eq!(so_far(&figures), [2.0, 1.0, 2.0]);
        handed.keep(Seq(3), second * 4);
        handed.keep(Seq(9), second * 5);
        assert_eq!(so_far(&figures), [3.0, 2.0, 5.0]);
    }

    #[test]
    fn what_was_lost_counts_when_it_is_recorded_anew_and_once() {
        let (mut handed, figures) = handed();
        handed.hand(&page(1, [piece(1, true), alarm(1)]), Duration::ZERO);
        handed.lose();
        handed.hand(&page(3, [piece(1, true)]), Duration::ZERO);
        handed.keep(Seq(3), Duration::ZERO);
        assert_eq!(["luggage_total", "photos_total", "alarms_total"].map(|name| figures.value(name)), [1.0, 1.0, 0.0]);
        assert_eq!(figures.value("record_seconds_count"), 1.0, "how long it took is no figure of what was lost");
    }

    #[test]
    fn missions_are_told_apart_by_the_phase_to_which_they_had_come() {
        let figures = counted(vec![
            Fact::Phase(Phase::Exploring),
            Fact::MissionBegan(MissionId(1), Strategy::default()),
            Fact::Phase(Phase::Exploring),
            Fact::Phase(Phase::Explored),
            Fact::Phase(Phase::Idle),
            Fact::MissionArchived(MissionId(1), Vec::new()),
            Fact::Phase(Phase::Exploring),
            Fact::MissionBegan(MissionId(2), Strategy::default()),
        ]);
        let phases =
            ["exploring", "explored", "idle", "fault"].map(|phase| figures.value(&format!("phases_total{{phase=\"{phase}\"}}")));
        assert_eq!(phases, [2.0, 1.0, 1.0, 0.0]);
        assert_eq!(figures.value("missions_begun_total"), 2.0);
        let ended = ["explored", "exploring"].map(|phase| figures.value(&format!("missions_ended_total{{phase=\"{phase}\"}}")));
        assert_eq!(ended, [1.0, 0.0]);
    }

    #[test]
    fn a_step_is_a_cell_a_turn_is_a_quarter_and_being_put_down_is_neither() {
        let figures = counted(vec![
            at(0, 0, Heading::South),
            at(0, 1, Heading::South),
            at(0, 2, Heading::South),
            at(0, 2, Heading::East),
            at(0, 2, Heading::East),
            at(7, 7, Heading::North),
            at(6, 7, Heading::North),
        ]);
        assert_eq!((figures.value("steps_total"), figures.value("turns_total")), (3.0, 1.0));
    }

    #[test]
    fn a_piece_is_one_however_often_it_is_photographed() {
        let figures = counted(vec![piece(1, true), piece(1, true), piece(2, false), piece(2, false), piece(3, true)]);
        assert_eq!((figures.value("luggage_total"), figures.value("photos_total")), (3.0, 3.0));
    }

    fn commands() -> [Command; 19] {
        [
            Command::Start,
            Command::Stop,
            Command::BackHome,
            Command::GoOn,
            Command::Retrieve(None),
            Command::Reset,
            Command::Close(Closing { name: Note::new("Anna").expect("a sound name"), note: None, seen: "".into() }),
            Command::HandOver(HandOver { mission: None, to: Note::new("police").expect("a sound name"), note: None }),
            Command::SearchAgain(Again::Within(Bounds::of(Cell::HOME))),
            Command::OrderAreas(Default::default()),
            Command::CloseArea(AreaClosing {
                area: "gate".into(),
                name: Note::new("Anna").expect("a sound name"),
                note: None,
                mission: None,
            }),
            Command::Move(Move::Forward),
            Command::Goto(Cell::HOME),
            Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Safe, note: None, hot: Default::default() },
            Command::Unsure { luggage: LuggageRef::Pending, note: None, hot: Default::default() },
            Command::RetakePhoto(LuggageId(1)),
            Command::Acknowledge(AlarmId(1)),
            Command::ChooseStrategy(Strategy::default()),
            Command::Temperature(TemperatureReport::Ok),
        ]
    }

    #[test]
    fn every_command_counts_under_its_name_by_what_became_of_it() {
        let accepted = commands().map(|asked| command(Asked::Command(asked), None));
        let refused = commands().map(|asked| command(Asked::Command(asked), Some("held")));
        let figures = counted([&accepted[..], &refused, &refused].concat());
        for name in Command::CODES {
            let times = |outcome: &str| figures.value(&format!("commands_total{{command=\"{name}\",outcome=\"{outcome}\"}}"));
            assert_eq!((times("accepted"), times("refused")), (1.0, 2.0), "{name}");
        }
        assert_eq!(figures.value("refusals_total{code=\"held\"}"), 38.0);
    }

    #[test]
    fn stops_in_one_entry_are_many_and_words_from_outside_are_one_and_make_no_series() {
        let before = Figures::default().text().lines().count();
        let stops = |count| Asked::Stops { count, within: None };
        let many = |last, more| Asked::Many { last: Box::new(last), more };
        let brew = || Asked::Words("BREW /coffee{pot=\"1\"}".to_owned());
        let figures = counted(vec![
            command(stops(7), None),
            command(stops(9), Some("notAllowed")),
            command(many(Asked::Command(Command::Start), 4), Some("notAllowed")),
            command(brew(), Some("malformed")),
            command(many(brew(), u64::MAX), Some("tooMany")),
        ]);
        let times = |command: &str, outcome: &str| {
            figures.value(&format!("commands_total{{command=\"{command}\",outcome=\"{outcome}\"}}"))
        };
        assert_eq!((times("stop", "accepted"), times("stop", "refused")), (7.0, 1.0));
        assert_eq!((times("start", "refused"), times("other", "refused")), (1.0, 2.0));
        let codes = ["notAllowed", "other"].map(|code| figures.value(&format!("refusals_total{{code=\"{code}\"}}")));
        assert_eq!(codes, [2.0, 2.0]);
        assert_eq!(figures.text().lines().count(), before);
    }

    #[test]
    fn what_stands_is_followed_where_an_entry_says_everything() {
        let mut standing = PersistentState::first(Strategy::default());
        standing.phase = Phase::Explored;
        standing.pose = Pose { cell: Cell::new(5, 5), heading: Heading::East };
        let archived = Fact::MissionArchived(MissionId(1), Vec::new());
        let figures = counted(vec![Fact::State(Box::new(standing)), at(5, 6, Heading::East), Fact::Phase(Phase::Idle), archived]);
        let names = ["steps_total", "missions_ended_total{phase=\"explored\"}", "phases_total{phase=\"explored\"}"];
        assert_eq!(names.map(|name| figures.value(name)), [1.0, 1.0, 0.0]);
    }

    /// A disk that hangs may leave any number of pages waiting, but no more than `WAITING` of them are remembered.
    #[test]
    fn no_more_waits_than_there_is_room_for() {
        for (of_a_page, pages, counted) in [(vec![Fact::Led(true)], WAITING, 0), (vec![alarm(1), alarm(2)], WAITING / 2, WAITING)]
        {
            let (mut handed, figures) = handed();
            for n in 1..=WAITING as u64 + 1000 {
                handed.hand(&page(2 * n, of_a_page.clone()), Duration::ZERO);
            }
            assert_eq!((handed.pages.len(), handed.counted.len()), (pages, counted));
            handed.keep(Seq(u64::MAX), Duration::ZERO);
            assert_eq!(figures.value("alarms_total"), counted as f64);
        }
    }
}
