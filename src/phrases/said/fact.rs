//! Words for the facts of the journal; words for requests are in `asked`.

use std::fmt::Display;
use std::sync::Arc;

use crate::phrases::{Language, Phrase};
use hallsweep_core::closing::{Closed, OpenInArea, OpenPoints};
use hallsweep_core::command::{Again, Hot, Note, Verdict};
use hallsweep_core::hold::Hold;
use hallsweep_core::refused::Refused;
use hallsweep_core::settings::{AfterDanger, HotRule, Rules, SafeBy};
use hallsweep_core::snapshot::fact_words::hours;
use hallsweep_core::state::fact::{Fact, Unpacked, WrittenOut};
use hallsweep_core::state::{Conditions, Phase, Retrieval, RetrievalStage, Stage};
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::{Doubt, Judgement, Luggage, PhotoState};
use hallsweep_core::world::records::LuggageRecords;

impl Language {
    pub fn fact(self, fact: &Fact) -> String {
        self.happened(fact).replace(['\n', '\r'], " ")
    }

    pub fn outcome(self, refused: Option<&Refused>) -> String {
        let Some(refused) = refused else { return self.say("fact-accepted").to_string() };
        self.say("fact-refused").with("why", self.refused(refused)).to_string()
    }

    fn conditions(self, Conditions { venue, threshold, rules }: &Conditions) -> String {
        let id = match (venue.cell_m, venue.is_reckoned) {
            (Some(_), _) => "fact-conditions",
            (None, true) => "fact-conditions-reckoned",
            (None, false) => "fact-conditions-no-side",
        };
        let say = self.say(id).with("hall", &venue.name).with("threshold", self.celsius(*threshold));
        let said = venue.cell_m.map_or_else(|| say.clone(), |side| say.clone().with("side", self.number(&side.to_string())));
        let rules = self.rules(*rules).into_iter().map(|rule| format!(", {rule}"));
        let exercise = venue.is_exercise.then(|| format!("{}, ", self.say("exercise")));
        exercise.into_iter().chain([said.to_string()]).chain(rules).collect()
    }

    /// Words for each rule that differs from the usual ones.
    pub fn rules(self, Rules { after_danger, keep_out_m, safe_by, hot, unsure_views }: Rules) -> Vec<String> {
        let goes_on = (after_danger == AfterDanger::GoOn).then(|| self.say("rule-goes-on"));
        let rings = (keep_out_m > 0.0).then(|| self.say("rule-rings").with("metres", self.number(&keep_out_m.to_string())));
        let judges = (safe_by == SafeBy::Two).then(|| self.say("rule-two-judges"));
        let hot = (hot == HotRule::Required).then(|| self.say("rule-hot"));
        let views = (unsure_views < Rules::MOST_VIEWS).then(|| self.say("rule-views").with("count", unsure_views));
        [goes_on, rings, judges, hot, views].into_iter().flatten().map(|rule| rule.to_string()).collect()
    }

    fn happened(self, fact: &Fact) -> String {
        let said = match fact {
            Fact::ProgramStarted(version) => self.say("fact-started").with("version", version),
            Fact::ProgramEnded(by) => self.say("fact-ended").with("by", by),
            Fact::ClockSet(by @ ..0) => self.say("fact-clock-back").with("by", hours(*by)),
            Fact::ClockSet(by) => self.say("fact-clock-forward").with("by", hours(*by)),
            Fact::WrittenOut(WrittenOut { missions: (first, last), until, file, digest }) => {
                let say = self.say("fact-written-out").with("first", first).with("last", last).with("until", until);
                say.with("file", file).with("digest", digest)
            }
            Fact::Unpacked(Unpacked { file, digest, behind, page }) => {
                let say = self.say("fact-unpacked").with("file", file).with("digest", digest);
                say.with("behind", behind).with("page", page)
            }
            Fact::Conditions(conditions) => return self.conditions(conditions),
            Fact::State(standing) if standing.under_way => {
                self.say("fact-state").with("mission", standing.mission).with("cells", standing.map.visited())
            }
            Fact::State(standing) => self.say("fact-state-none").with("cells", standing.map.visited()),
            Fact::Command { issuer, asked, luggage, refused, .. } => {
                let say = self.say("fact-command").with("asked", self.asked(asked, *luggage));
                say.with("issuer", self.issuer(issuer)).with("outcome", self.outcome(refused.as_ref()))
            }
            Fact::MissionBegan(mission, strategy) => {
                self.say("fact-mission-began").with("mission", mission).with("strategy", self.say_of("strategy", strategy.name()))
            }
            Fact::MissionArchived(mission, left) => {
                let ids = left.iter().map(|id| format!("#{id}")).collect::<Vec<_>>().join(", ");
                let left = if ids.is_empty() { self.say("fact-none-left").to_string() } else { ids };
                self.say("fact-mission-archived").with("mission", mission).with("left", left)
            }
            Fact::Phase(phase) => self.say("fact-phase").with("phase", self.phase_on_record(phase)),
            Fact::Holds(holds) if holds.is_empty() => self.say("fact-nothing-holds"),
            Fact::Holds(holds) => {
                let brief = |hold: &Hold| self.say_of("hold-brief", hold.name()).to_string();
                self.say("fact-held").with("holds", holds.iter().map(brief).collect::<Vec<_>>().join(", "))
            }
            Fact::Epoch(epoch) => self.say("fact-epoch").with("epoch", epoch),
            Fact::Goal(None, _) => self.say("fact-no-goal"),
            Fact::Goal(Some(goal), _) => self.say("goal-at").with("cell", goal.cell()),
            Fact::Pose(pose) => self.say("fact-robot-at").with("cell", pose.cell).with("heading", self.heading(pose.heading)),
            Fact::RobotPose(robot, pose) => {
                let say = self.say("fact-other-at").with("robot", robot).with("cell", pose.cell);
                say.with("heading", self.heading(pose.heading))
            }
            Fact::Outside(robot, 0) => self.say("fact-in-hall").with("robot", robot),
            Fact::Outside(robot, steps) => self.say("fact-outside").with("robot", robot).with("steps", steps),
            Fact::Retrieval(None) => self.say("fact-retrieval-ended"),
            Fact::Retrieval(Some(retrieval)) => return self.fetching(retrieval),
            Fact::MetAgain(cell, piece) => self.say("fact-met-again").with("piece", piece.0).with("cell", cell),
            Fact::Secured(luggage) => self.say("secured-one").with("id", luggage),
            Fact::Led(blinking) => self.say(if *blinking { "fact-led-on" } else { "fact-led-off" }),
            Fact::Obstacle(at, kind) => self.say("fact-obstacle").with("cell", at).with("kind", self.say_of("obstacle", kind)),
            Fact::Mark(cell, mark) => self.say("fact-cell").with("cell", cell).with("mark", self.say_of("cell", mark.name())),
            Fact::Luggage { record, .. } => return self.luggage(record),
            Fact::Unsure { luggage, who, note, hot } => return self.unsure(*luggage, who, *hot, note.as_ref()),
            Fact::Judged(judgement) => return self.judged(judgement),
            Fact::Verdict { luggage, verdict, who, note, hot } if !hot.is_empty() => {
                let say = self.say("fact-verdict").with("id", luggage).with("verdict", self.verdict(verdict.name()));
                return self.with_remarks(say.with("who", who), *hot, note.as_ref());
            }
            Fact::Verdict { luggage, verdict, who, note, .. } => {
                let say = self.say(if note.is_some() { "fact-verdict-noted" } else { "fact-verdict" });
                let say = say.with("id", luggage).with("verdict", self.verdict(verdict.name())).with("who", who);
                note.as_ref().map_or_else(|| say.clone(), |note| say.clone().with("note", note))
            }
            Fact::Revealed { luggage, is_test } => {
                self.say(if *is_test { "fact-test-piece" } else { "fact-no-test-piece" }).with("id", luggage)
            }
            Fact::Closed(closed) => return self.closed(closed),
            Fact::HandedOver { who, to, note } => {
                return self.with_remarks(self.say("fact-handed-over").with("to", to).with("who", who), Hot::NONE, note.as_ref());
            }
            Fact::SearchAgain(Again::Within(bounds)) => {
                self.say("fact-search-again").with("from", bounds.least).with("to", bounds.most)
            }
            Fact::SearchAgain(Again::Area(area)) => self.say("fact-area-again").with("area", area),
            Fact::AreasOrdered(order) => return self.area_order(order),
            Fact::AreaClosed(area, closed) => return self.closed_area(area, closed),
            Fact::Temperature(source, celsius) => {
                self.say("fact-temperature").with("celsius", self.celsius(*celsius)).with("source", source)
            }
            Fact::ThermometerSilent(source) => self.say("fact-thermometer-silent").with("source", source),
            Fact::AlarmRaised(alarm, _, cause) => self.say("fact-alarm").with("alarm", alarm).with("cause", self.alarm(cause)),
            Fact::AlarmAcknowledged(alarm, who) => self.say("fact-alarm-seen").with("alarm", alarm).with("who", who),
            Fact::Strategy(strategy) => self.say("fact-strategy").with("strategy", self.say_of("strategy", strategy.name())),
            Fact::MapEmptied(heading) => self.say("fact-map-emptied").with("heading", self.heading(*heading)),
        };
        said.to_string()
    }

    /// What there is to say of the judges of a piece beside its verdict: who was unsure, the answers to the three
    /// questions, and the answers of other judges.
    pub fn judges(self, luggage: &Luggage) -> Vec<String> {
        let own = luggage.verdict.as_ref().and_then(|decision| self.hot(decision.hot));
        let others = luggage.judged.iter().map(|judgement| self.judged(judgement));
        let doubts = luggage.unsure.iter();
        let unsure = doubts.map(|Doubt { who, note, hot, .. }| self.unsure(luggage.id, who, *hot, note.as_ref()));
        let truth = luggage.truth.map(|is_test| self.fact(&Fact::Revealed { luggage: luggage.id, is_test }));
        unsure.chain(own).chain(others).chain(truth).collect()
    }

    /// Words for what a search has found. Nobody can say that there is no device.
    pub fn finding(self, luggage: &LuggageRecords) -> String {
        let (judged, dangerous) =
            luggage.iter().filter_map(|piece| piece.verdict.as_ref()).fold((0, 0), |(judged, dangerous), decision| {
                (judged + 1, dangerous + usize::from(decision.verdict == Verdict::Danger))
            });
        let said = self.say(if dangerous == 0 { "report-no-device" } else { "report-devices" });
        said.with("count", judged).with("dangerous", dangerous).to_string()
    }

    fn unsure(self, luggage: LuggageId, who: &str, hot: Hot, note: Option<&Note>) -> String {
        self.with_remarks(self.say("fact-unsure").with("id", luggage).with("who", who), hot, note)
    }

    fn judged(self, Judgement { luggage, verdict, issuer, note, hot, .. }: &Judgement) -> String {
        let say = self.say("fact-judged").with("id", luggage).with("verdict", self.verdict(verdict.name()));
        self.with_remarks(say.with("issuer", self.issuer(issuer)), *hot, note.as_ref())
    }

    /// Adds the answers to the three questions and the note to what was said.
    pub(super) fn with_remarks(self, said: impl Display, hot: Hot, note: Option<&Note>) -> String {
        let said = self.hot(hot).map_or_else(|| said.to_string(), |hot| format!("{said} ({hot})"));
        note.map_or_else(|| said.clone(), |note| self.say("asked-noted").with("asked", &said).with("note", note).to_string())
    }

    /// Words for the order of the areas, also where somebody asks for it.
    pub(super) fn area_order(self, names: &[Arc<str>]) -> String {
        match names {
            [] => self.say("asked-areas-automatic").to_string(),
            _ => self.say("asked-orderAreas").with("areas", names.join(", ")).to_string(),
        }
    }

    pub fn open_in_area(self, OpenInArea { cells, pending }: OpenInArea) -> String {
        self.say("open-in-area").with("cells", cells).with("pending", pending).to_string()
    }

    /// Words for the statement with which a mission was closed.
    pub fn closed(self, closed: &Closed) -> String {
        self.statement(self.say("fact-closed"), closed, self.open_points(closed.open).join(", "))
    }

    pub(super) fn closed_area(self, area: &str, closed: &Closed<OpenInArea>) -> String {
        self.statement(self.say("fact-area-closed").with("area", area), closed, self.open_in_area(closed.open))
    }

    fn statement<Open>(self, say: Phrase, Closed { who, name, note, .. }: &Closed<Open>, open: String) -> String {
        let said = self.with_remarks(say.with("name", name).with("who", who), Hot::NONE, note.as_ref());
        self.say("fact-closed-open").with("closed", said).with("open", open).to_string()
    }

    /// Words for each kind of open points that there is; *none* if there is none.
    pub fn open_points(self, open: OpenPoints) -> Vec<String> {
        let left = open.parts().into_iter().filter(|(.., count)| *count > 0);
        let left: Vec<String> =
            left.map(|(kind, _, count)| self.say_of("left-open", kind).with("count", count).to_string()).collect();
        if left.is_empty() { vec![self.say("left-open-none").to_string()] } else { left }
    }

    fn phase_on_record(self, phase: &Phase) -> String {
        let name = phase.name();
        let Some(inspection) = phase.inspection().filter(|_| phase.interrupted().is_none()) else {
            return self.phase_and_before(name, phase.interrupted().map(Phase::name));
        };
        let stage = match inspection.stage {
            Stage::BackingUp => self.say("stage-backing-up"),
            Stage::TakingPhoto => self.say("stage-taking-photo"),
            Stage::Recording(id) => self.say("stage-recording").with("id", id),
            Stage::AwaitingVerdict(id) => self.say("stage-waits").with("id", id),
            Stage::RetakingPhoto(id) => self.say("stage-retaking").with("id", id),
            Stage::Viewing(id) => self.say("stage-viewing").with("id", id),
        };
        self.say("fact-stage").with("phase", self.phase(name)).with("stage", stage).to_string()
    }

    fn fetching(self, Retrieval { luggage, fetcher, stage, .. }: &Retrieval) -> String {
        let how: Phrase<'_> = match stage {
            RetrievalStage::MakingRoom => self.say("fetching-room"),
            RetrievalStage::Fetching => self.say("fetching-fetched"),
            RetrievalStage::LettingGo => self.say("fetching-let-go"),
            RetrievalStage::GoingOut(Some(why)) => self.say("fetching-given-up").with("why", self.not_fetched(why)),
            RetrievalStage::GoingOut(None) | RetrievalStage::ComingHome(None) => self.say("fetching-in-container"),
            RetrievalStage::ComingHome(Some(why)) => self.say("fetching-not").with("why", self.not_fetched(why)),
        };
        self.say("fact-retrieval")
            .with("id", luggage)
            .with("fetcher", self.say_of("by", fetcher.name()))
            .with("how", how)
            .to_string()
    }

    fn luggage(self, Luggage { id, cell, pose, photo, .. }: &Luggage) -> String {
        let photo = match photo {
            PhotoState::Taken { take: 1, .. } => self.say("photographed"),
            PhotoState::Taken { take, .. } => self.say("photographed-take").with("take", take),
            PhotoState::Failed(why) => self.say("photographed-not").with("why", self.robot_said(why)),
        };
        let say = self.say("fact-luggage").with("id", id).with("cell", cell).with("from", pose.cell);
        say.with("heading", self.heading(pose.heading)).with("photo", photo).to_string()
    }
}
