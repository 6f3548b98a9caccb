//! The laboratory: the Roomba as state machine and as behaviour tree, on a page and as JSON. It is all arithmetic on what stands in
//! the address; nothing here reads or moves anything of the hall.

use askama::Template;
use axum::http::header;
use axum::response::{Html, IntoResponse, Response};

use super::console::html;
use super::problem::Problem;
use super::query::Query;
use crate::api::laboratory::{Roomba, Row};

/// The longest run that is shown, in seconds: ten minutes fill the room with lines, and take a few milliseconds to compute.
const LONGEST_S: u64 = 600;

/// How long the run is when nobody says: long enough for spirals and walls.
const USUAL_S: u64 = 120;

/// The seed when nobody says.
const USUAL_SEED: u64 = 1;

/// What stands in the address.
struct Asked {
    seed: u64,
    seconds: u64,
}

impl Asked {
    fn of(query: &Query) -> Result<Asked, Problem> {
        query.only(&["seed", "seconds"])?;
        let seed = query.count("seed", 0..=u64::MAX)?.unwrap_or(USUAL_SEED);
        let seconds = query.count("seconds", 1..=LONGEST_S)?.unwrap_or(USUAL_S);
        Ok(Asked { seed, seconds })
    }

    fn run(&self) -> Result<Roomba, Problem> {
        let seconds = u32::try_from(self.seconds).unwrap_or(u32::MAX);
        Roomba::both(self.seed, seconds).map_err(|error| Problem::unusable(error.to_string()))
    }
}

/// `GET laboratory`
pub(super) async fn page(query: Query) -> Result<Html<String>, Problem> {
    let asked = Asked::of(&query)?;
    let roomba = asked.run()?;
    let parting = roomba.parting().map(|parting| parting.to_string());
    let (names, drawings, figures) = (roomba.names(), roomba.drawings(), roomba.figures());
    Ok(html(&Page { asked, transitions: roomba.transitions(), parting, names, drawings, figures }))
}

/// `GET laboratory/roomba`
pub(super) async fn roomba(query: Query) -> Result<Response, Problem> {
    let json = Asked::of(&query)?.run()?.json();
    Ok(([(header::CONTENT_TYPE, "application/json")], json).into_response())
}

#[derive(Template)]
#[template(path = "laboratory/page.html")]
struct Page {
    asked: Asked,
    transitions: usize,
    /// Where machine and tree part, if they do.
    parting: Option<String>,
    names: Vec<&'static str>,
    drawings: Vec<String>,
    figures: Vec<Row>,
}

impl Page {
    fn longest(&self) -> u64 {
        LONGEST_S
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{app, read, text};
    use crate::api::fixture::searching;

    #[tokio::test]
    async fn the_page_shows_both_runs_drawn_without_a_script_and_says_that_they_are_the_same() {
        let app = app(searching());
        let page = text(app.get("/laboratory?seed=3&seconds=60").await).await;
        for wanted in [
            "class=\"roomba-wall\"",
            ">State machine, seed 3, 60 s<",
            ">Behaviour tree, seed 3, 60 s<",
            "Machine and tree made the same",
            "action=\"/console/stop\"",
            "href=\"/api/v1/laboratory/roomba?seed=3&amp;seconds=60\"",
            "floor passed over",
        ] {
            assert!(page.contains(wanted), "{wanted} in {page}");
        }
        assert_eq!(page.matches("class=\"roomba-wall\"").count(), 2);
        assert!(app.given.lock().unwrap().is_empty(), "it moves nothing");
    }

    #[tokio::test]
    async fn nothing_on_the_page_is_inline_or_of_another_origin() {
        let page = text(app(searching()).get("/laboratory").await).await;
        let page = page.replace("http://www.w3.org/2000/svg", "");
        for unwanted in ["style=", "<style", "onclick", "http://", "https://"] {
            assert!(!page.contains(unwanted), "{unwanted}");
        }
        assert_eq!(page.matches("<script").count(), page.matches("<script src=\"/static/").count() + 1);
        assert!(page.contains("<script type=\"module\" src=\"/static/roomba.js\">"));
    }

    #[tokio::test]
    async fn the_interface_gives_the_runs_of_the_seed_that_is_asked_for() {
        let app = app(searching());
        let (status, told) = read(app.get("/api/v1/laboratory/roomba?seed=9&seconds=30").await).await;
        assert_eq!((status.as_u16(), &told["seed"], &told["seconds"]), (200, &9.into(), &30.0.into()));
        assert_eq!((&told["same"], told["runs"].as_array().map(Vec::len)), (&true.into(), Some(2)));
        let (_, usual) = read(app.get("/api/v1/laboratory/roomba").await).await;
        assert_eq!((&usual["seed"], &usual["seconds"]), (&1.into(), &120.0.into()));
    }

    #[tokio::test]
    async fn what_cannot_be_run_is_a_problem_that_says_what_belongs_there() {
        let app = app(searching());
        for (query, words) in [
            ("seed=-1", "`seed` is \"-1\": a whole number from 0 to 18446744073709551615 belongs there"),
            ("seed=x", "`seed` is \"x\""),
            ("seconds=0", "`seconds` is \"0\": a whole number from 1 to 600 belongs there"),
            ("seconds=601", "`seconds` is \"601\""),
            ("seconds=1e9", "`seconds` is \"1e9\""),
            ("speed=4", "there is no `speed` to ask by: there are seed, seconds"),
        ] {
            for path in ["/api/v1/laboratory/roomba", "/laboratory"] {
                let (status, problem) = read(app.get(&format!("{path}?{query}")).await).await;
                assert_eq!(status, 422, "{path}?{query}");
                assert!(problem["detail"].as_str().unwrap().starts_with(words), "{problem}");
            }
        }
    }
}
