//! The pages of missions, past and present. There is a list of missions, and one page for each mission with its hall,
//! its luggage and all its events. A command is shown with its sender, address and outcome. The pages work without a
//! script.

use askama::Template;
use axum::response::Html;

use super::super::HttpDoor;
use super::super::language::{PageReader, Spoken};
use super::super::missions::{MISSIONS, RECEIPTS, RecordedMission, after, before, happened, newest, of_these, recorded, wanted};
use super::super::problem::Problem;
use super::super::query::Query;
use super::super::reading::Number;
use super::entrance::Entrance;
use super::{hall, html};
use crate::access::Need;
use crate::api::luggage::photo_url;
use crate::api::time::{Zone, rfc3339};
use crate::phrases::{Language, Phrase};
use crate::report::receipt::{Receipt, ReceiptOf};
use crate::runtime::archive::{Happened, MissionRecord, Unreadable};
use hallsweep_core::command::Strategy;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::snapshot::searched::SearchedHall;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{MissionId, Seq, WallTime};
use hallsweep_core::world::luggage::Luggage;

/// Number of events on one page. They fill a few screens.
const EVENTS: u64 = 200;

pub(in crate::doors::http) async fn list(
    door: HttpDoor,
    Spoken(language): Spoken,
    query: Query,
) -> Result<Html<String>, Problem> {
    query.only(&["before"])?;
    let before = before(&query)?;
    let (missions, next) = newest(&door, before, MISSIONS).await?;
    let zone = Zone::of(door.process.clock.now().wall);
    Ok(html(&List { language, missions, before, next, zone }))
}

pub(in crate::doors::http) async fn one(
    door: HttpDoor,
    Spoken(language): Spoken,
    Number(id): Number,
    query: Query,
) -> Result<Html<String>, Problem> {
    query.only(&["after", "show"])?;
    let (after, show) = (after(&query)?, Show::of(query.word("show", &["all", "commands"])?));
    let RecordedMission { record, state, damage } = recorded(&door, id).await?;
    let (events, next) = match show {
        Show::Main => wanted(&door, id, after, EVENTS, is_main).await?,
        Show::Commands => wanted(&door, id, after, EVENTS, |fact| matches!(fact, Fact::Command { .. })).await?,
        Show::All => happened(&door, id, after, EVENTS).await?,
    };
    let zone = Zone::of(door.process.clock.now().wall);
    let fetched = [PhaseName::Retrieving, PhaseName::BagSecured].iter().any(|phase| phase.name() == &*record.phase);
    let has_retrieval = fetched || state.as_ref().is_some_and(|state| state.retrieval.is_some());
    Ok(html(&One { language, record, state, has_retrieval, damage, show, after, events, next, zone }))
}

/// The receipts of a mission, to be printed and signed.
pub(in crate::doors::http) async fn receipts(
    door: HttpDoor,
    PageReader { caller, language, .. }: PageReader,
    Number(id): Number,
    query: Query,
) -> Result<Html<String>, Problem> {
    query.only(&["after"])?;
    let after = after(&query)?;
    let (receipts, next) = of_these(&door, id, after, RECEIPTS, Receipt::all).await?;
    let (mission, zone) = (MissionId(id), Zone::of(door.process.clock.now().wall));
    let present = &door.hall.handle.snapshot().mission;
    let may_hand_over = caller.may(Need::Act).is_ok() && present.is_under_way() && present.id == mission;
    Ok(html(&Receipts { language, mission, after, receipts, next, zone, may_hand_over }))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Show {
    Main,
    Commands,
    All,
}

impl Show {
    fn of(word: Option<&str>) -> Show {
        match word {
            Some("all") => Show::All,
            Some("commands") => Show::Commands,
            _ => Show::Main,
        }
    }

    /// Returns the query parameter of this view, after `?` or `&`. The main view is the default and has no parameter.
    fn address(self, joined_by: &str) -> String {
        match self {
            Show::Main => String::new(),
            Show::Commands => format!("{joined_by}show=commands"),
            Show::All => format!("{joined_by}show=all"),
        }
    }
}

/// Whether a fact is shown in the main view. That view has commands and findings, but not the thousands of steps of
/// the robot.
fn is_main(fact: &Fact) -> bool {
    let found = matches!(fact, Fact::Luggage { .. } | Fact::AlarmRaised(..) | Fact::Phase(_) | Fact::Holds(_) | Fact::Secured(_));
    let done = matches!(fact, Fact::Command { .. } | Fact::Verdict { .. } | Fact::AlarmAcknowledged(..) | Fact::Strategy(_));
    let began = matches!(
        fact,
        Fact::ProgramStarted(_) | Fact::ProgramEnded(_) | Fact::ClockSet(_) | Fact::MissionBegan(..) | Fact::MissionArchived(..)
    );
    found || done || began
}

#[derive(Template)]
#[template(path = "missions/list.html")]
struct List {
    language: Language,
    missions: Vec<MissionRecord>,
    before: Option<MissionId>,
    next: Option<MissionId>,
    zone: Zone,
}

#[derive(Template)]
#[template(path = "missions/one.html")]
struct One {
    language: Language,
    record: MissionRecord,
    state: Option<PersistentState>,
    has_retrieval: bool,
    damage: Vec<String>,
    show: Show,
    after: Seq,
    events: Vec<Happened>,
    next: Option<Seq>,
    zone: Zone,
}

#[derive(Template)]
#[template(path = "missions/receipts.html")]
struct Receipts {
    language: Language,
    mission: MissionId,
    after: Seq,
    receipts: Vec<ReceiptOf>,
    next: Option<Seq>,
    zone: Zone,
    /// Whether the mission is under way, and the reader may give commands.
    may_hand_over: bool,
}

struct Event {
    seq: Seq,
    moment: String,
    time: String,
    what: String,
    /// Sender of a command, with the address and the door that the command came from.
    by: Option<String>,
    outcome: String,
    refused: bool,
}

impl List {
    fn here(&self) -> String {
        self.before.map_or_else(|| "/missions".to_owned(), |before| format!("/missions?before={before}"))
    }

    fn time(&self, wall: &WallTime) -> String {
        self.language.date(&self.zone.date_and_time(*wall))
    }

    /// Returns how the mission ended. The number of unsearched places is missing: to count them, the whole record
    /// must be read. Only the mission's own page does this.
    fn came_to(&self, record: &MissionRecord) -> String {
        let came_to = came_to(self.language, record);
        let ends_the_search = [PhaseName::BombLocated, PhaseName::BagSecured].iter().any(|phase| phase.name() == &*record.phase);
        if ends_the_search { format!("{came_to} · {}", self.language.say("search-ended-there")) } else { came_to }
    }
}

impl One {
    fn time(&self, wall: &WallTime) -> String {
        self.language.date(&self.zone.date_and_time(*wall))
    }

    fn came_to(&self) -> String {
        let came_to = came_to(self.language, &self.record);
        self.state.as_ref().map_or_else(|| came_to.clone(), |state| self.language.headline(&came_to, state))
    }

    fn team(&self) -> String {
        self.language.team(self.state.as_ref().and_then(|state| state.conditions.as_ref()))
    }

    /// Returns the name of the search strategy in the reader's language. A strategy that this version does not know
    /// keeps its recorded name.
    fn strategy(&self) -> String {
        let known = Strategy::named(&self.record.strategy);
        known.map_or_else(|| self.record.strategy.to_string(), |known| self.language.say_of("strategy", known.name()).to_string())
    }

    fn conditions(&self) -> Option<String> {
        let conditions = self.state.as_ref()?.conditions.clone()?;
        Some(self.language.fact(&Fact::Conditions(conditions)))
    }

    /// Returns labels and addresses of the files of a mission: the report in every language, and the record in two
    /// formats.
    fn files(&self) -> Vec<(String, String)> {
        let at = |file: &str| format!("/missions/{}/{file}", self.record.id);
        let report = |language: Language| (language.name().to_owned(), at(&format!("report?language={}", language.tag())));
        let lists = [("JSON Lines", "record.jsonl"), ("CSV", "record.csv")].map(|(name, file)| (name.to_owned(), at(file)));
        Language::ALL.map(report).into_iter().chain(lists).collect()
    }

    fn hall(&self, state: &PersistentState) -> String {
        let pieces = state.luggage.iter().map(|luggage| &**luggage);
        let found = hall::found(self.language, &state.map, entrance(state), pieces);
        format!("{}{found}{}", hall::tiles(&state.map), hall::labels(&state.map))
    }

    fn coverage(&self, state: &PersistentState) -> String {
        let looked = hall::coverage(&state.coverage, state.venue().sensor);
        format!("{}{looked}{}", hall::tiles(&state.map), hall::labels(&state.map))
    }

    fn pieces<'s>(&self, state: &'s PersistentState) -> Vec<(&'s Luggage, Option<String>)> {
        state.luggage.iter().map(|luggage| (&**luggage, photo_url(luggage))).collect()
    }

    fn events(&self) -> Vec<Event> {
        let event = |(seq, entry): &Happened| match entry {
            Ok(entry) => Event::of(self.language, *seq, entry, self.zone),
            Err(Unreadable(why)) => Event {
                seq: *seq,
                moment: String::new(),
                time: String::new(),
                what: why.clone(),
                by: None,
                outcome: String::new(),
                refused: true,
            },
        };
        self.events.iter().map(event).collect()
    }

    /// Returns the views of the events. Each has a label, an address, and whether it is the view shown now.
    fn views(&self) -> [(Phrase<'static>, String, bool); 3] {
        let at = |show: Show| format!("/missions/{}{}#events", self.record.id, show.address("?"));
        [("main", Show::Main), ("commands", Show::Commands), ("all", Show::All)]
            .map(|(name, show)| (self.language.say_of("missions-show", name), at(show), show == self.show))
    }
}

impl Event {
    fn of(language: Language, seq: Seq, entry: &Entry, zone: Zone) -> Event {
        let mut event = Event {
            seq,
            moment: rfc3339(entry.wall),
            time: language.date(&zone.date_and_time(entry.wall)),
            what: String::new(),
            by: None,
            outcome: String::new(),
            refused: false,
        };
        if let Fact::Command { issuer, asked, luggage, refused, .. } = &entry.fact {
            event.what = language.asked(asked, *luggage);
            (event.by, event.outcome) = (Some(language.issuer(issuer)), language.outcome(refused.as_ref()));
            event.refused = refused.is_some();
        } else {
            event.what = language.fact(&entry.fact);
        }
        event
    }
}

fn entrance(state: &PersistentState) -> Option<Entrance> {
    state.luggage.iter().any(|luggage| luggage.secured.is_some()).then(|| Entrance::of(&state.map))
}

fn came_to(language: Language, record: &MissionRecord) -> String {
    let phase = PhaseName::ALL.into_iter().find(|phase| phase.name() == &*record.phase);
    let is_put_away = record.archived.is_some();
    let came_to = match phase {
        Some(PhaseName::Explored) => language.say("missions-searched-reachable"),
        Some(phase) => language.came_to(phase, is_put_away),
        None => language.ended_while(&record.phase, is_put_away),
    };
    let left: Vec<String> = record.left.iter().map(|luggage| format!("#{luggage}")).collect();
    let left_behind = || language.say("missions-left").with("outcome", &came_to).with("which", left.join(", "));
    if left.is_empty() { came_to.to_string() } else { left_behind().to_string() }
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::{app, text};
    use crate::api::tests::fixture::{TEN, searching};
    use crate::api::time::Zone;
    use crate::phrases::Language;
    use crate::runtime::archive::MissionRecord;
    use crate::runtime::clock::Clock;
    use hallsweep_core::units::WallTime;

    fn here(wall: WallTime) -> String {
        Zone::of(Clock::default().now().wall).date_and_time(wall)
    }

    fn check(page: &str, wanted: &[&str]) {
        for wanted in wanted {
            assert!(page.contains(wanted), "{wanted} in {page}");
        }
    }

    #[tokio::test]
    async fn the_list_says_what_each_mission_came_to() {
        let page = app(searching()).page("/missions").await;
        let began = here(TEN);
        check(
            &page,
            &[
                "href=\"./missions/1\"",
                &began,
                "A bomb was located; luggage #2 was left in place",
                "Under way: exploring",
                "href=\"./\"",
                "action=\"./console/stop\"",
            ],
        );
        assert!(page.find("Mission 2") < page.find("Mission 1"), "the newest first");
    }

    #[tokio::test]
    async fn a_mission_shows_its_hall_its_luggage_and_who_decided() {
        let page = app(searching()).page("/missions/1").await;
        let hall = ["<svg id=\"hall\"", "class=\"wall\"", "class=\"piece danger\"", "<title>home</title>"];
        check(&page, &hall);
        check(&page, &["What is missing here", "a mouse was at it"]);
        check(&page, &[" · not on record whether simulated</h2>", "<dt>Robots</dt><dd>not on record</dd>"]);
        let count = page
            .split_once("luggage #2 was left in place · ")
            .and_then(|(_, rest)| rest.split_once(" known places not searched"));
        assert!(count.is_some_and(|(count, _)| count.parse::<u64>().is_ok()), "in the heading: {page}");
        let list = app(searching()).page("/missions").await;
        check(&list, &["luggage #2 was left in place · the search ended there</span></td>"]);
        assert_eq!(list.matches("the search ended there").count(), 1, "the other mission is under way: {list}");
        let decided = format!("decided {} by operator", here(TEN));
        check(&page, &["/api/v1/luggage/3/photo?take=1", &decided, "pending"]);
    }

    /// Safety A6.
    #[tokio::test]
    async fn the_events_say_who_commanded_what_from_where_and_what_became_of_it() {
        let app = app(searching());
        let all = app.page("/missions/1").await;
        check(&all, &["START <span class=\"by\">by anna (console, 192.0.2.7):</span> <b class=\"accepted\">accepted</b>"]);
        check(
            &all,
            &["<b class=\"refused\">refused: the robot is moving: press STOP first</b>", "held: stopped by the operator"],
        );
        let commands = app.page("/missions/1?show=commands").await;
        assert!(commands.contains("RESET") && !commands.contains("held: stopped by the operator"));
        for view in [&all, &commands] {
            check(view, &["title=\"the hall at that moment\">6</a> entry 6 of the journal cannot be understood"]);
        }
        let steps = app.page("/missions/1?show=all").await;
        check(&steps, &["robot at (0, 0)", "START", "<b>Every step</b>"]);
        assert!(!all.contains("robot at (0, 0)") && all.contains("<b>What was done and found</b>"), "steps are a second view");
        let later = app.page("/missions/1?after=3").await;
        assert!(
            !later.contains("anna") && later.contains("held: stopped by the operator") && later.contains("From the beginning")
        );
    }

    #[tokio::test]
    async fn nothing_on_the_pages_is_inline_or_of_another_origin() {
        let app = app(searching());
        for path in [
            "/missions",
            "/missions?before=2",
            "/missions/1",
            "/missions/2",
            "/missions/1?show=all&after=2",
            "/missions?before=2",
        ] {
            let page = app.page(path).await;
            for unwanted in ["style=", "<style", "onclick", "http://", "https://"] {
                assert!(!page.contains(unwanted), "{unwanted} in {path}");
            }
            assert_eq!(page.matches("<script").count(), 3, "{path}: those of STOP, the bar and the colours");
        }
    }

    #[tokio::test]
    async fn a_person_who_asks_for_what_is_not_there_is_told_so_on_a_page() {
        let app = app(searching());
        for (path, status, words) in [
            ("/missions/9", 404, "there is no mission 9"),
            ("/missions/99", 503, "the disk is on strike"),
            ("/missions?before=x", 422, "send a whole number from 1"),
            ("/missions/1?show=nothing", 422, "send all or commands"),
        ] {
            let response = app.send("GET", path, &[("accept", "text/html")], "").await;
            assert_eq!(response.status(), status, "{path}");
            assert!(text(response).await.contains(words), "{path}");
        }
    }

    #[tokio::test]
    async fn who_reads_italian_reads_them_in_italian() {
        const NAMES: [&str; 5] =
            ["entry 6 of the journal cannot be understood (a mouse was at it)", "English", "Italiano", "JSON Lines", "CSV"];
        let app = app(searching());
        let list = app.italian("GET", "/missions", "", &[], &NAMES).await;
        check(&list, &["Una bomba è stata localizzata; rimasto sul posto: bagaglio #2", "In corso: ", ">Missione 1</a>"]);
        let older = app.italian("GET", "/missions?before=1", "", &[], &NAMES).await;
        check(&older, &["Non ci sono missioni più vecchie.", "Le più recenti"]);
        let one = app.italian("GET", "/missions/1", "", &[], &NAMES).await;
        check(&one, &["3, di cui pericolosi: 1", "Una parte di ciò che è registrato", "da anna (console, 192.0.2.7):"]);
        check(
            &one,
            &[
                "<span class=\"verdict\">da decidere</span>",
                "<b>Che cosa è stato fatto e trovato</b>",
                "da decidere</li>",
                "base</li>",
            ],
        );
        let steps = app.italian("GET", "/missions/1?show=all&after=2", "", &[], &NAMES).await;
        check(&steps, &["<b>Ogni passo</b>", "Dal principio"]);
        let unkept = app.italian("GET", "/missions/2", "", &[], &NAMES).await;
        check(&unkept, &["La mappa e i bagagli di questa missione non sono conservati.", "non ancora"]);
    }

    #[test]
    fn every_verdict_has_its_word_in_both_languages() {
        for language in Language::ALL {
            let words = ["pending", "safe", "danger"].map(|verdict| language.say_of("verdict", verdict).to_string());
            assert!(language != Language::English || words == ["pending", "safe", "danger"], "{words:?}");
        }
    }

    #[test]
    fn a_search_that_has_come_to_its_end_is_not_listed_as_under_way() {
        let record = super::super::super::testing::present_mission();
        let came_to = |phase: &str| super::came_to(Language::English, &MissionRecord { phase: phase.into(), ..record.clone() });
        assert_eq!(came_to("explored"), "Everything that can be reached from the start was searched");
        assert_eq!(came_to("bombLocated"), "A bomb was located");
        assert_eq!(came_to("bagSecured"), "The bomb was fetched and secured");
        assert_eq!(came_to("returningHome"), "Under way: returning home");
        let archived = MissionRecord { phase: "atHome".into(), archived: Some(TEN), left: Vec::new(), ..record.clone() };
        assert_eq!(super::came_to(Language::English, &archived), "Put away while waiting at home");
        assert!(super::came_to(Language::Italian, &archived).starts_with("Archiviata nella fase: "));
    }
}
