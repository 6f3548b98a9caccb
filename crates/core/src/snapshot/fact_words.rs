//! Facts as English sentences, for a person who reads the journal. Another module has the form that programs read
//! back.

use std::fmt::Display;
use std::sync::Arc;

use crate::asked::Asked;
use crate::closing::Closed;
use crate::command::{Command, Hot, Note, Verdict};
use crate::hold::Hold;
use crate::refused::Refused;
use crate::settings::{AfterDanger, HotRule, Rules, SafeBy};
use crate::state::fact::{Fact, Unpacked, WrittenOut};
use crate::state::{Conditions, Phase, Retrieval, RetrievalStage, Stage, Venue};
use crate::units::LuggageId;
use crate::world::hall_map::Mark;
use crate::world::luggage::{Judgement, Luggage, PhotoState};

/// Returns the English sentence for a fact, without a line break.
#[must_use]
pub fn words(fact: &Fact) -> String {
    said(fact).replace(['\n', '\r'], " ")
}

fn said(fact: &Fact) -> String {
    match fact {
        Fact::ProgramStarted(version) => format!("program started, version {version}"),
        Fact::ProgramEnded(by) => format!("program ended by {by}"),
        Fact::ClockSet(by @ ..0) => format!("the clock was set back by {}", hours(*by)),
        Fact::ClockSet(by) => format!("the clock went forward by {}: it was set, or the machine slept", hours(*by)),
        Fact::WrittenOut(WrittenOut { missions: (first, last), until, file, digest }) => {
            format!("missions {first} to {last}, entries up to {until}, are in the archive {file} alone, SHA-256 {digest}")
        }
        Fact::Unpacked(Unpacked { file, digest, behind, page }) => {
            format!(
                "unpacked from the archive {file}, SHA-256 {digest}; begins behind entry {behind}, the digest of whose page is {page}"
            )
        }
        Fact::Conditions(Conditions { venue: Venue { name, cell_m, is_reckoned, is_exercise, .. }, threshold, rules }) => {
            let exercise = if *is_exercise { "EXERCISE, " } else { "" };
            let cells = cell_m.map_or_else(String::new, |side| format!(", cells of {side} m"));
            let reckoned = if *is_reckoned { ", reckoned without a scene file" } else { "" };
            format!("{exercise}hall: {name}{cells}{reckoned}, too hot above {threshold}{}", rules_in_words(*rules))
        }
        Fact::State(standing) => {
            let mission = if standing.under_way { format!("mission {}", standing.mission) } else { "no mission".to_owned() };
            format!("all that stands: {mission}, {} cells visited", standing.map.visited())
        }
        Fact::Command { issuer, asked, luggage, refused, .. } => {
            let outcome = refused.as_ref().map_or_else(|| "accepted".to_owned(), |refused| format!("refused: {refused}"));
            format!("command {} by {issuer}: {outcome}", asked.about(*luggage))
        }
        Fact::MissionBegan(mission, strategy) => format!("mission {mission} began ({})", strategy.name()),
        Fact::MissionArchived(mission, left) => {
            format!("mission {mission} put away, bombs left: {}", list(left.iter().map(|id| format!("#{id}"))))
        }
        Fact::Phase(phase) => format!("phase: {}", in_words(phase)),
        Fact::Holds(holds) if holds.is_empty() => "nothing holds the robot".to_owned(),
        Fact::Holds(holds) => format!("held: {}", list(holds.iter().map(cause))),
        Fact::Epoch(epoch) => format!("stopped: epoch {epoch}"),
        Fact::Goal(goal, _) => goal.map_or_else(|| "no goal".to_owned(), |goal| format!("goal {}", goal.cell())),
        Fact::Pose(pose) => format!("robot at {}, facing {}", pose.cell, pose.heading.name()),
        Fact::RobotPose(robot, pose) => format!("{robot} at {}, facing {}", pose.cell, pose.heading.name()),
        Fact::Outside(robot, 0) => format!("{robot} is in the hall"),
        Fact::Outside(robot, steps) => format!("{robot} is outside, {steps} from home"),
        Fact::Retrieval(None) => "the retrieval has ended".to_owned(),
        Fact::Retrieval(Some(retrieval)) => fetching(retrieval),
        Fact::MetAgain(cell, piece) => format!("piece {} stands at {cell}, too", piece.0),
        Fact::Secured(luggage) => format!("luggage #{luggage} is in the container"),
        Fact::Led(blinking) => format!("LED {}", if *blinking { "blinking" } else { "off" }),
        Fact::Obstacle(cell, kind) => format!("obstacle at {cell}, taken for {kind}"),
        Fact::Mark(cell, mark) => {
            format!("cell {cell}: {}", if *mark == Mark::NotInspected { "not inspected" } else { mark.name() })
        }
        Fact::Luggage { record, .. } => luggage(record),
        Fact::Verdict { luggage, verdict, who, note, hot } => {
            let note = Note::in_brackets(note.as_ref());
            format!("verdict on luggage #{luggage}: {}, by {who}{}{note}", verdict.name(), answers(*hot))
        }
        Fact::Unsure { luggage, who, note, hot } => {
            let note = Note::in_brackets(note.as_ref());
            format!("unsure about luggage #{luggage}, by {who}{}{note}", answers(*hot))
        }
        Fact::Judged(judgement) => {
            let Judgement { luggage, verdict, issuer, note, hot, .. } = &**judgement;
            let note = Note::in_brackets(note.as_ref());
            format!("answer kept back until now: luggage #{luggage} {}, by {issuer}{}{note}", verdict.name(), answers(*hot))
        }
        Fact::Revealed { luggage, is_test: true } => format!("luggage #{luggage} was a test piece"),
        Fact::Revealed { luggage, is_test: false } => format!("luggage #{luggage} was no test piece"),
        Fact::SearchAgain(again) => format!("to be searched again: {again}"),
        Fact::AreasOrdered(order) => Command::OrderAreas(Arc::clone(order)).to_string(),
        Fact::AreaClosed(area, closed) => format!("area {area} closed {}", statement(closed)),
        Fact::Closed(closed) => format!("mission closed {}", statement(closed)),
        Fact::HandedOver { who, to, note } => {
            let note = Note::in_brackets(note.as_ref());
            format!("mission handed over to {to}, by {who}{note}")
        }
        Fact::Temperature(source, celsius) => format!("temperature {celsius}, by {source}"),
        Fact::ThermometerSilent(source) => format!("the thermometer of {source} fell silent"),
        Fact::AlarmRaised(alarm, _, cause) => format!("alarm {alarm} raised: {cause}"),
        Fact::AlarmAcknowledged(alarm, who) => format!("alarm {alarm} acknowledged by {who}"),
        Fact::Strategy(strategy) => format!("search order: {}", strategy.name()),
        Fact::MapEmptied(heading) => format!("map emptied, facing {}", heading.name()),
    }
}

fn statement<Open: Display>(Closed { who, name, note, open, .. }: &Closed<Open>) -> String {
    format!("by {name}, key {who}{}; open points: {open}", Note::in_brackets(note.as_ref()))
}

/// Returns the rules that differ from the usual ones, each after a comma.
fn rules_in_words(Rules { after_danger, keep_out_m, safe_by, hot, unsure_views }: Rules) -> String {
    let goes_on = (after_danger == AfterDanger::GoOn).then(|| ", the search goes on after danger".to_owned());
    let rings = (keep_out_m > 0.0).then(|| format!(", keep-out rings of {keep_out_m} m"));
    let judges = (safe_by == SafeBy::Two).then(|| ", a verdict of safe needs two judges".to_owned());
    let hot = (hot == HotRule::Required).then(|| ", a verdict of safe needs the answers to three questions".to_owned());
    let views =
        (unsure_views < Rules::MOST_VIEWS).then(|| format!(", further photos when a judge is unsure: at most {unsure_views}"));
    [goes_on, rings, judges, hot, views].into_iter().flatten().collect()
}

fn answers(hot: Hot) -> String {
    if hot.is_empty() { String::new() } else { format!(" ({hot})") }
}

/// Formats milliseconds as hours, minutes and seconds, such as `13:00:05`. The sign is left out.
#[must_use]
pub fn hours(ms: i64) -> String {
    let seconds = ms.unsigned_abs() / 1000;
    format!("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

/// Returns the text of a phase. It also names the phase that is interrupted, or the stage of the inspection.
fn in_words(phase: &Phase) -> String {
    let name = phase.name().in_words();
    if let Some(interrupted) = phase.interrupted() {
        return format!("{name} (was {})", interrupted.name().in_words());
    }
    let Some(inspection) = phase.inspection() else { return name.to_owned() };
    match inspection.stage {
        Stage::BackingUp => format!("{name}: backing up"),
        Stage::TakingPhoto => format!("{name}: taking the photo"),
        Stage::Recording(id) => format!("{name}: recording #{id}"),
        Stage::AwaitingVerdict(id) => format!("{name}: #{id} waits for its verdict"),
        Stage::RetakingPhoto(id) => format!("{name}: taking the photo of #{id} again"),
        Stage::Viewing(id) => format!("{name}: driving to another side of #{id}"),
    }
}

/// Returns the reason of a hold, without the advice to the operator.
fn cause(hold: &Hold) -> &'static str {
    let words = hold.in_words();
    words.find([':', ';']).map_or(words, |end| &words[..end])
}

fn fetching(retrieval: &Retrieval) -> String {
    let Retrieval { luggage, fetcher, stage, .. } = retrieval;
    let how = match stage {
        RetrievalStage::MakingRoom => "room is made".to_owned(),
        RetrievalStage::Fetching => "it is fetched".to_owned(),
        RetrievalStage::LettingGo => "it is put into the container".to_owned(),
        RetrievalStage::GoingOut(Some(reason)) => format!("given up: {reason}"),
        RetrievalStage::GoingOut(None) | RetrievalStage::ComingHome(None) => "it is in the container".to_owned(),
        RetrievalStage::ComingHome(Some(reason)) => format!("not fetched: {reason}"),
    };
    format!("retrieval of luggage #{luggage} by {}: {how}", fetcher.name())
}

fn luggage(record: &Luggage) -> String {
    let photo = match &record.photo {
        PhotoState::Taken { take: 1, .. } => "photographed".to_owned(),
        PhotoState::Taken { take, .. } => format!("photographed, take {take}"),
        PhotoState::Failed(reason) => format!("no photo: {reason}"),
    };
    let Luggage { id, cell, pose, .. } = record;
    format!("luggage #{id} at {cell}, seen from {} facing {}; {photo}", pose.cell, pose.heading.name())
}

fn list<T: Display>(things: impl IntoIterator<Item = T>) -> String {
    let words: Vec<String> = things.into_iter().map(|thing| thing.to_string()).collect();
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}

impl Fact {
    /// Returns the command with its final answer. Entries never change, and a verdict *safe* is recorded as accepted
    /// before it is durable. If a *danger* for the same piece arrives first, the *safe* is refused after all
    /// (safety V1). `was_dangerous` tells whether a piece was found dangerous.
    #[must_use]
    pub fn as_it_was(self, was_dangerous: impl FnOnce(LuggageId) -> bool) -> Fact {
        let Fact::Command { issuer, id, asked, epoch, luggage: Some(luggage), refused: None } = self else { return self };
        let was_safe = matches!(asked, Asked::Command(Command::Verdict { verdict: Verdict::Safe, .. }));
        let overtaken = was_safe && was_dangerous(luggage);
        let refused = overtaken.then_some(Refused::Decided { luggage, verdict: Verdict::Danger });
        Fact::Command { issuer, id, asked, epoch, luggage: Some(luggage), refused }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::command::{Door, Issuer, LuggageRef, Note};
    use crate::phase::FaultCause;
    use crate::state::Inspection;
    use crate::units::{Cell, Heading, Pose, WallTime};
    use crate::world::alarm::AlarmCause;

    fn check(fact: Fact, expect: &str) {
        assert_eq!(words(&fact), expect);
    }

    fn command(refused: Option<Refused>) -> Fact {
        let issuer = Issuer { door: Door("http"), who: "anna".into(), from: "192.0.2.7".into() };
        Fact::Command { issuer, id: None, asked: Asked::Command(Command::Start), epoch: None, luggage: None, refused }
    }

    #[test]
    fn an_entry_is_one_line() {
        check(Fact::Holds(vec![Hold::Operator, Hold::AwaitingStart]), "held: stopped by the operator, waiting for START");
        check(Fact::Holds(Vec::new()), "nothing holds the robot");
        check(Fact::Pose(Pose::START), "robot at (0, 0), facing south");
        check(Fact::Mark(Cell::new(1, 2), Mark::Wall), "cell (1, 2): wall");
        check(
            Fact::AlarmRaised(Default::default(), None, AlarmCause::Other("two\nlines".to_owned())),
            "alarm 0 raised: two lines",
        );
    }

    #[test]
    fn a_phase_says_how_far_it_has_come_and_what_it_interrupts() {
        let inspecting =
            |stage| Phase::Inspecting(Inspection { cell: Cell::new(0, 1), piece: None, pose: Pose::START, stage, views: 0 });
        check(Fact::Phase(inspecting(Stage::TakingPhoto)), "phase: inspecting luggage: taking the photo");
        let waiting = inspecting(Stage::AwaitingVerdict(LuggageId(3)));
        check(Fact::Phase(waiting.clone()), "phase: inspecting luggage: #3 waits for its verdict");
        let fault = Phase::Fault { cause: FaultCause::Unanswered, interrupted: Box::new(waiting) };
        check(Fact::Phase(fault), "phase: in fault (was inspecting luggage)");
    }

    #[test]
    fn luggage_is_told_without_the_words_of_a_programming_language() {
        let (cell, pose) = (Cell::new(6, 2), Pose { cell: Cell::new(5, 2), heading: Heading::East });
        let photo = PhotoState::Taken { bytes: 4, take: 1 };
        let (id, taken) = (LuggageId(3), WallTime::default());
        let record = Arc::new(Luggage {
            id,
            cell,
            pose,
            taken,
            first_taken: taken,
            photo,
            verdict: None,
            seen_from: Vec::new(),
            unsure: Vec::new(),
            judged: Vec::new(),
            truth: None,
            piece: None,
            secured: None,
            clock_set_ms: 0,
        });
        let expect = "luggage #3 at (6, 2), seen from (5, 2) facing east; photographed";
        check(Fact::Luggage { record, photo: None }, expect);
    }

    /// Safety A6.
    #[test]
    fn a_command_says_who_gave_it_from_where_and_what_became_of_it() {
        check(command(None), "command START by anna (http, 192.0.2.7): accepted");
        let refused = "command START by anna (http, 192.0.2.7): refused: the robot is moving: press STOP first";
        check(command(Some(Refused::Moving)), refused);
        let (id, note) = (LuggageId(13), Note::new("as #13"));
        for (luggage, note, expect) in [
            (LuggageRef::Pending, None, "safe #13"),
            (LuggageRef::Id(id), None, "safe #13"),
            (LuggageRef::Pending, note.clone(), "safe #13 (note: as #13)"),
            (LuggageRef::Id(id), note, "safe #13 (note: as #13)"),
        ] {
            let asked = Asked::Command(Command::Verdict { luggage, verdict: Verdict::Safe, note, hot: Default::default() });
            assert_eq!(asked.about(Some(id)).to_string(), expect, "the piece that was meant is named once");
        }
    }
}
