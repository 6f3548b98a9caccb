//! The console at a moment of the past. The page has the same parts as the live console, filled from the record. Only
//! STOP works there. The script requests another moment and receives the differences in a message, with the format of
//! the live stream.

use std::sync::Arc;

use axum::Json;
use axum::response::{Html, IntoResponse, Response};

use super::super::HttpDoor;
use super::super::language::PageReader;
use super::super::missions::{at, stood};
use super::super::problem::Problem;
use super::super::query::{MOST, Query};
use super::super::reading::Number;
use super::live::{Message, Shown};
use super::page::ConsolePage;
use super::timeline::{LAST, Timeline, Timelines};
use super::view::{HallInfo, Then, View, Who};
use super::{html, who};
use crate::phrases::Language;
use crate::runtime::archive::{At, PastMoment, Sound};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::Conditions;
use hallsweep_core::units::{MissionId, Seq, WallTime};

/// `GET missions/{id}/moment`: the page after the last entry up to `at`. Without `at` it shows the first entry.
pub(in crate::doors::http) async fn page(
    door: HttpDoor,
    to: PageReader,
    Number(id): Number,
    query: Query,
) -> Result<Html<String>, Problem> {
    query.only(&["at"])?;
    let at = at(&query)?.map_or(At::Time(i64::MIN), At::Entry);
    let [moment] = stood(&door, id, [at]).await?;
    let about = About::of(&door, to, id).await?;
    let page = move || html(&ConsolePage::new(&about.view(&about.looked_at(moment, at))));
    Ok(door.hall.archive.look_up(move |_| Ok(page())).await?)
}

/// `GET console/missions/{id}/moment`: the differences between two moments. `from` and `shown` are the entry and the
/// time that the page shows now. `at` or `time` selects the new moment: the last one up to this entry or time.
pub(in crate::doors::http) async fn message(door: HttpDoor, to: PageReader, Number(id): Number, query: Query) -> Response {
    let language = to.language;
    match differs(&door, to, id, &query).await {
        Ok(message) => Json(message).into_response(),
        Err(problem) => problem.told(language),
    }
}

async fn differs(door: &HttpDoor, to: PageReader, id: u64, query: &Query) -> Result<Message, Problem> {
    query.only(&["at", "time", "from", "shown"])?;
    let line = Timelines::of(door, MissionId(id), to.language).await;
    let time = |name| query.count(name, 0..=MOST).map(|time| time.map(|time| line.at(i64::try_from(time).unwrap_or(i64::MAX))));
    let wanted = time("time")?.or(at(query)?.map(At::Entry)).unwrap_or(At::Time(i64::MIN));
    let shown_at = time("shown")?.unwrap_or(wanted);
    let from = query.count("from", 1..=MOST)?.map(|seq| At::Entry(Seq(seq)));
    let (moment, from) = match from {
        Some(from) => {
            let [from, moment] = stood(door, id, [from, wanted]).await?;
            (moment, Some(from))
        }
        None => {
            let [moment] = stood(door, id, [wanted]).await?;
            (moment, None)
        }
    };
    let about = About::of(door, to, id).await?;
    let message = move || {
        let mut shown = from.map_or_else(Shown::default, |from| {
            let from = about.looked_at(from, shown_at);
            Shown::already(&from.snapshot, &about.view(&from))
        });
        let looked = about.looked_at(moment, wanted);
        shown.update(&looked.snapshot, &about.view(&looked))
    };
    // Drawing a large hall takes time. It runs on a thread that no other work waits for (safety S7). Only a few such
    // jobs run at once.
    Ok(door.hall.archive.look_up(move |_| Ok(message())).await?)
}

struct About {
    door: HttpDoor,
    mission: u64,
    line: Arc<Timeline>,
    began: Option<WallTime>,
    who: Option<Who>,
    language: Language,
}

impl About {
    async fn of(door: &HttpDoor, PageReader { caller, language }: PageReader, id: u64) -> Result<About, Problem> {
        let record = door.hall.archive.look_up(move |archive| archive.mission(MissionId(id))).await?;
        let (line, who) = (Timelines::of(door, MissionId(id), language).await, who(door, &caller));
        Ok(About { door: door.clone(), mission: id, line, began: record.map(|record| record.began), who, language })
    }

    /// Returns the state and the clock time for a requested moment. If the moment was requested by its time, it may
    /// be later than its entry, because the clock continues between two entries.
    fn looked_at(&self, moment: PastMoment, at: At) -> Looked {
        let PastMoment { past: Sound { of: past, .. }, wall, earlier, later } = moment;
        let unix_ms = match at {
            At::TimeAmong(time, [_, until]) if until < LAST => time.max(wall.unix_ms),
            At::Time(time) | At::TimeAmong(time, _) => time.min(self.door.process.clock.now().wall.unix_ms).max(wall.unix_ms),
            At::Entry(_) => wall.unix_ms,
        };
        let (wall, number) = (WallTime { unix_ms, ..wall }, |seq: Option<Seq>| seq.map(|seq| seq.0));
        let (earlier, later) = (number(earlier), number(later));
        let then = Then { mission: self.mission, seq: past.seq.0, time: unix_ms, earlier, later };
        let present = self.door.hall.handle.snapshot();
        let others = present.robots.iter().skip(1).map(|robot| robot.id.clone());
        let conditions = past.state.conditions.clone();
        Looked { snapshot: Arc::new(past.snapshot(self.door.hall.settings, others)), then, wall, conditions }
    }

    fn view<'a>(&'a self, Looked { snapshot, then, wall, conditions }: &'a Looked) -> View<'a> {
        let (hall, who, line) = (HallInfo::under(&self.door, conditions.as_ref()), self.who.clone(), Some(&*self.line));
        View { snapshot, hall, began: self.began, who, language: self.language, why: None, now: *wall, line, then: Some(*then) }
    }
}

struct Looked {
    snapshot: Arc<Snapshot>,
    then: Then,
    wall: WallTime,
    conditions: Option<Conditions>,
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::{TestApp, app, read};
    use crate::api::tests::fixture::searching;
    use serde_json::Value;

    async fn message(app: &TestApp, query: &str) -> Value {
        let (status, message) = read(app.get(&format!("/console/missions/1/moment?{query}")).await).await;
        assert_eq!(status, 200, "{query}: {message}");
        message
    }

    #[tokio::test]
    async fn a_moment_of_the_past_is_the_same_page_with_nothing_to_press_but_stop() {
        let app = app(searching());
        let page = app.page("/missions/1/moment?at=4").await;
        for wanted in [
            "<html lang=\"en\" data-past=\"yes\">",
            "<b>Past:</b> state at",
            "idle",
            "Held:</b> stopped by the operator",
            "23.5 °C",
            "id=\"hall-robot\"",
            "entry 4 of mission 1",
            "href=\"./missions/1/moment?at=3\">One entry back",
            "href=\"./missions/1/moment?at=5\">One entry forward",
            "action=\"./console/stop\"",
        ] {
            assert!(page.contains(wanted), "{wanted} in {page}");
        }
        assert!(page.contains("data-luggage=\"\"") && !page.contains("<title>luggage #"), "nothing had been found yet");
        for tag in
            page.split('<').filter(|tag| ["button", "fieldset", "input", "select"].iter().any(|name| tag.starts_with(name)))
        {
            let looks = [
                "id=\"stop-button\"",
                "data-always",
                "role=\"switch\"",
                "id=\"theme\"",
                "id=\"confirm-",
                "type=\"hidden\"",
                "name=\"id\"",
                "name=\"tab\"",
                "class=\"small\" lang=",
            ]
            .iter();
            let coordinates = ["name=\"x\"", "name=\"y\"", "name=\"toX\"", "name=\"toY\""];
            let buttons = ["name=\"move\"", "class=\"small\">Go there", "class=\"small\">Search again"];
            let within = coordinates.iter().chain(&buttons);
            let is_dead = tag.contains("disabled title=\"this page shows the past: go back to now first\"");
            assert!(is_dead || looks.chain(within).any(|word| tag.contains(word)), "<{tag}");
        }
        let first = app.page("/missions/1/moment").await;
        assert!(first.contains("entry 1 of mission 1") && !first.contains(">One entry back<"), "{first}");
    }

    #[tokio::test]
    async fn the_script_is_told_what_differs_from_the_moment_that_it_shows() {
        let app = app(searching());
        let whole = message(&app, "at=3").await;
        assert_eq!((&whole["whole"], &whole["then"]["seq"]), (&true.into(), &3.into()));
        assert!(whole["parts"]["hall-robot"].is_string() && whole["parts"]["time_0"].is_string());
        let shown = whole["then"]["time"].as_i64().unwrap();
        let later = message(&app, &format!("at=4&from=3&shown={shown}")).await;
        assert_eq!((&later["whole"], &later["then"]["seq"]), (&false.into(), &4.into()));
        let parts: Vec<&str> = later["parts"].as_object().unwrap().keys().map(String::as_str).collect();
        assert!(parts.contains(&"holds") && !parts.contains(&"hall-robot") && !parts.contains(&"time_0"), "{parts:?}");
        let back = message(&app, &format!("at=3&from=4&shown={shown}")).await;
        assert_eq!(back["parts"]["holds"], whole["parts"]["holds"], "backwards likewise");
        let same = message(&app, &format!("at=4&from=4&shown={shown}")).await;
        assert!(same["parts"].as_object().unwrap().is_empty(), "{}", same["parts"]);
    }

    #[tokio::test]
    async fn between_two_entries_time_goes_on_and_never_beyond_now() {
        let app = app(searching());
        let began = message(&app, "").await["then"]["time"].as_i64().unwrap();
        let later = message(&app, &format!("time={}", began + 7000)).await;
        assert_eq!((&later["then"]["seq"], &later["then"]["time"]), (&5.into(), &(began + 7000).into()));
        let now = message(&app, "time=99999999999999").await["then"]["time"].as_i64().unwrap();
        assert!(now < 99_999_999_999_999, "{now}");
    }

    #[tokio::test]
    async fn what_is_not_there_is_said_in_words() {
        let app = app(searching());
        for (path, status) in [
            ("/missions/2/moment?at=4", 404),
            ("/missions/9/moment", 404),
            ("/missions/1/moment?at=0", 422),
            ("/missions/1/moment?on=4", 422),
            ("/console/missions/1/moment?time=-1", 422),
            ("/console/missions/1/moment?at=4&from=0", 422),
            ("/console/missions/2/moment", 404),
            ("/console/missions/99/moment", 503),
        ] {
            assert_eq!(app.get(path).await.status(), status, "{path}");
        }
    }
}
