//! The page of a recorded retrieval: its events, and its behaviour trees at one moment. A script moves through the
//! moments. Without a script, links lead to the other moments. `missions` reads the record.

use askama::Template;
use axum::response::Html;

use super::super::HttpDoor;
use super::super::language::Spoken;
use super::super::missions::retrieved;
use super::super::problem::Problem;
use super::super::query::Query;
use super::super::reading::Number;
use super::html;
use super::retrieval::{rows, sign};
use crate::api::retrieval_record::RetrievalRecordJson;
use crate::phrases::{Language, Phrase};
use hallsweep_core::snapshot::retrieval::{TreeView, TreesView};

pub(in crate::doors::http) async fn page(
    door: HttpDoor,
    Spoken(language): Spoken,
    Number(id): Number,
    query: Query,
) -> Result<Html<String>, Problem> {
    query.only(&["moment"])?;
    let record = retrieved(&door, id).await?;
    let moments = record.replay.moments();
    let last = moments.len().max(1);
    let moment = query.count("moment", 1..=u64::try_from(last).unwrap_or(1))?;
    let moment = moment.and_then(|moment| usize::try_from(moment).ok()).unwrap_or(last);
    let t = moments.get(moment - 1).copied().unwrap_or(record.seconds);
    Ok(html(&ReplayPage { language, mission: id, shown: record.replay.shown(t), record, moment, last, t }))
}

#[derive(Template)]
#[template(path = "missions/retrieval.html")]
struct ReplayPage {
    language: Language,
    mission: u64,
    record: RetrievalRecordJson,
    shown: TreesView,
    /// `moment` is the number of the shown moment, counted from 1. `last` is the number of the last moment, and `t`
    /// is the time of the shown moment in seconds.
    moment: usize,
    last: usize,
    t: f64,
}

impl ReplayPage {
    const fn language(&self) -> Language {
        self.language
    }

    fn trees(&self) -> &[TreeView] {
        &self.shown.trees
    }

    fn ticked(&self) -> Option<&TreesView> {
        Some(&self.shown)
    }

    /// Returns the links to other moments, with their labels. A link that would lead to the shown moment has no
    /// address.
    fn ways(&self) -> [(Phrase<'static>, Option<usize>); 4] {
        let other = |moment: usize| Some(moment).filter(|moment| (1..=self.last).contains(moment) && *moment != self.moment);
        [
            (self.language.say("missions-moment-first"), other(1)),
            (self.language.say("missions-moment-previous"), other(self.moment - 1)),
            (self.language.say("missions-moment-next"), other(self.moment + 1)),
            (self.language.say("missions-moment-last"), other(self.last)),
        ]
    }

    fn seconds(&self, t: &f64) -> String {
        self.language.number(&format!("{t:.1}"))
    }

    fn title(&self) -> Phrase<'static> {
        let id = if self.record.fetcher == "pair" { "missions-fetched-by-pair" } else { "missions-fetched-alone" };
        self.language.say(id).with("luggage", self.record.luggage)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::{app, read, text};
    use crate::api::tests::fixture::searching;

    #[tokio::test]
    async fn a_retrieval_shows_its_trees_at_any_of_its_moments_and_what_happened() {
        let app = app(searching());
        let last = text(app.get("/missions/1/retrieval").await).await;
        assert_eq!(last.matches("<section class=\"tree\"").count(), 3);
        for wanted in [
            "Retrieval of luggage #1 by the pair",
            "luggage #1 is in the container",
            "action=\"./console/stop\"",
            ">Previous</a>",
        ] {
            assert!(last.contains(wanted), "{wanted} in {last}");
        }
        assert!(!last.contains(">Next</a>") && !last.contains("style="), "it is the last moment, and nothing is inline");
        let first = text(app.get("/missions/1/retrieval?moment=1").await).await;
        assert!(
            first.contains("class=\"node running ticked\"") && first.contains(">Next</a>") && !first.contains(">Previous</a>")
        );
        assert!(first.contains("<dt>pallet</dt>"), "the blackboard stands beside the trees");
        assert_eq!(app.get("/missions/1/retrieval?moment=0").await.status(), 422);
        assert_eq!(app.get("/missions/1/retrieval?moment=100000").await.status(), 422);
    }

    #[tokio::test]
    async fn who_reads_italian_reads_it_in_italian() {
        const NAMES: [&str; 1] = ["JSON"];
        let app = app(searching());
        let page = app.italian("GET", "/missions/1/retrieval?moment=2", "", &[], &NAMES).await.replace("&#39;", "'");
        for wanted in [
            "Recupero nella missione 1 ·",
            "Recupero del bagaglio #1 da parte della coppia",
            "0,2 s dopo l'inizio del recupero, momento 2 di",
            "<li data-t=\"0.1\"><span class=\"seq\">0,1 s</span>",
            ">Precedente</a>",
            "La riproduzione non può partire",
        ] {
            assert!(page.contains(wanted), "{wanted} in {page}");
        }
    }

    #[tokio::test]
    async fn programs_get_every_tick_that_changed_something() {
        let app = app(searching());
        let (status, told) = read(app.get("/api/v1/missions/1/retrieval").await).await;
        assert_eq!(status, 200, "{told}");
        let ids: Vec<_> = told["trees"].as_array().unwrap().iter().map(|tree| tree["id"].as_str().unwrap()).collect();
        assert_eq!((ids, &told["complete"]), (vec!["SRM1", "SRM2", "Supervisor"], &true.into()));
        let ticks = told["trees"][2]["ticks"].as_array().unwrap();
        let times: Vec<f64> = ticks.iter().map(|tick| tick["t"].as_f64().unwrap()).collect();
        assert!(ticks.len() > 3 && times.is_sorted(), "{times:?}");
        let said: Vec<&str> = told["events"].as_array().unwrap().iter().map(|event| event["words"].as_str().unwrap()).collect();
        let told_once = said.iter().filter(|words| words.ends_with(": it is fetched")).count();
        assert_eq!((told_once, said.last()), (1, Some(&"the retrieval has ended")), "{said:?}");
    }

    #[tokio::test]
    async fn where_nothing_was_fetched_it_says_so() {
        let app = app(searching());
        let words = |json: serde_json::Value| json["detail"].as_str().unwrap().to_owned();
        let (status, none) = read(app.get("/api/v1/missions/2/retrieval").await).await;
        assert_eq!((status.as_u16(), words(none)), (404, "mission 2 had no luggage to fetch".to_owned()));
        let (status, unknown) = read(app.get("/api/v1/missions/7/retrieval").await).await;
        assert_eq!(status, 404);
        assert!(words(unknown).starts_with("there is no mission 7"));
    }
}
