//! The laboratory: the Roomba as a state machine and as a behaviour tree, and the pallet scenario. Both are shown on
//! one page and as JSON. Everything is computed from the address of the page. Nothing here reads the state of the
//! hall or moves a robot.

pub(super) mod asked;
mod said;

use std::sync::Arc;

use askama::Template;
use axum::http::header;
use axum::response::{Html, IntoResponse, Response};
use tokio::sync::Semaphore;

use self::asked::{AskedPage, AskedPallet, AskedRoomba};
use self::said::{Event, Row};
use super::HttpDoor;
use super::console::{html, rows, sign};
use super::language::PageReader;
use super::peer::LetIn;
use super::problem::Problem;
use super::query::Query;
use crate::access::Caller;
use crate::api::replay::ReplayJson;
use crate::doors::connection_limits::{QuotaLimits, RequestQuota};
use crate::phrases::Language;
use hallsweep_core::snapshot::retrieval::{TreeView, TreesView};
use hallsweep_laboratory::pallet::{Mishap, Pallet};
use hallsweep_laboratory::roomba::Roomba;

/// Limits for runs that are being computed or wait. A run takes less than a tenth of a second. A key may have at most
/// three runs. Four of the twelve places are reserved for keys that have fewer than two runs.
const RUNS: QuotaLimits = QuotaLimits { most: 12, of_one_key: 3, kept: 4, few: 2 };

/// Computes one run after the other. Many users of the laboratory therefore occupy only one thread, and STOP does not
/// need that thread.
#[derive(Clone, Debug)]
pub(super) struct Laboratory {
    places: RequestQuota,
    turn: Arc<Semaphore>,
}

pub(super) async fn page(door: HttpDoor, to: PageReader, query: Query) -> Result<Html<String>, Problem> {
    let PageReader { caller, language } = to;
    let asked = AskedPage::of(&query)?;
    let page = door.computed(&caller, move || {
        let (roomba, pallet) = (asked.roomba.run()?, asked.pallet.run()?);
        Ok(Page::of(language, asked, &roomba, &pallet))
    });
    Ok(html(&page.await?))
}

pub(super) async fn roomba(door: HttpDoor, LetIn(caller): LetIn, query: Query) -> Result<Response, Problem> {
    let asked = AskedRoomba::of(&query)?;
    Ok(json(door.computed(&caller, move || Ok(asked.run()?.json())).await?))
}

pub(super) async fn pallet(door: HttpDoor, LetIn(caller): LetIn, query: Query) -> Result<Response, Problem> {
    let asked = AskedPallet::of(&query)?;
    let run = move || {
        let pallet = asked.run()?;
        Ok(pallet.json(ReplayJson::new(pallet.logs())))
    };
    Ok(json(door.computed(&caller, run).await?))
}

fn json(text: String) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], text).into_response()
}

impl Default for Laboratory {
    fn default() -> Laboratory {
        Laboratory { places: RequestQuota::new(RUNS), turn: Arc::new(Semaphore::new(1)) }
    }
}

impl HttpDoor {
    /// Computes a run on a thread that no robot depends on. Waits until it is this run's turn.
    async fn computed<T: Send + 'static>(
        &self,
        caller: &Caller,
        run: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let Laboratory { places, turn } = &self.process.laboratory;
        let place = places.take(self.process.access.key_of(caller)).map_err(Problem::too_many_runs)?;
        let turn = Arc::clone(turn).acquire_owned().await.map_err(|_| Problem::internal())?;
        // The place and the turn are freed when the run has ended, even if nobody waits for the result any more.
        let computing = tokio::task::spawn_blocking(move || (run(), turn, place));
        computing.await.map_err(|_| Problem::internal())?.0
    }
}

#[derive(Template)]
#[template(path = "laboratory/page.html")]
struct Page {
    language: Language,
    asked: AskedPage,
    transitions: usize,
    parting: Option<String>,
    names: Vec<&'static str>,
    drawings: Vec<String>,
    figures: Vec<Row>,
    carried: Carried,
}

struct Carried {
    drawing: String,
    /// Columns and rows of the yard, including half a cell of the wall on each side.
    size: (i32, i32),
    events: Vec<Event>,
    figures: Vec<(String, String)>,
    /// Why some parcels did not arrive; `None` if all arrived.
    fault: Option<String>,
    missed: Vec<String>,
    /// The behaviour trees at the end of the run.
    trees: TreesView,
}

impl Page {
    const fn language(&self) -> Language {
        self.language
    }

    fn of(language: Language, asked: AskedPage, roomba: &Roomba, pallet: &Pallet) -> Page {
        Page {
            language,
            asked,
            transitions: roomba.transitions(),
            parting: roomba.parting().map(|parting| said::parting(language, &parting)),
            names: roomba.names(),
            drawings: roomba.drawings(&language),
            figures: said::figures(language, roomba),
            carried: Carried {
                drawing: pallet.drawing(&language.say("laboratory-yard-drawn").to_string()),
                size: pallet.size(),
                events: said::events(language, pallet),
                figures: said::carried(language, pallet.figures()),
                fault: pallet.fault().map(|fault| said::fault(language, fault)),
                missed: said::missed(language, pallet),
                trees: pallet.trees(),
            },
        }
    }

    fn most_parcels(&self) -> u64 {
        asked::MOST_PARCELS
    }

    fn mishaps(&self) -> [Mishap; 6] {
        Mishap::ALL
    }

    fn trees(&self) -> &[TreeView] {
        &self.carried.trees.trees
    }

    fn ticked(&self) -> Option<&TreesView> {
        Some(&self.carried.trees)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{app, guarded_app, keys, read, text};
    use super::*;
    use crate::access::Access;
    use crate::api::tests::fixture::searching;

    #[tokio::test]
    async fn the_page_shows_both_runs_drawn_without_a_script_and_says_that_they_are_the_same() {
        let app = app(searching());
        let page = text(app.get("/laboratory?seed=3&seconds=60").await).await;
        for wanted in [
            "class=\"roomba-wall\"",
            ">State machine, seed 3, 60 s<",
            ">Behaviour tree, seed 3, 60 s<",
            "Machine and tree made the same",
            "action=\"./console/stop\"",
            "href=\"./api/v1/laboratory/roomba?seed=3&amp;seconds=60\"",
            "floor passed over",
        ] {
            assert!(page.contains(wanted), "{wanted} in {page}");
        }
        assert_eq!(page.matches("class=\"roomba-wall\"").count(), 2);
        assert!(app.given.lock().unwrap().is_empty(), "it moves nothing");
    }

    /// Safety S9: one run is computed while others wait. The number of runs of one key is limited.
    #[tokio::test]
    async fn one_key_has_a_few_runs_and_some_places_are_kept_for_keys_that_have_few() {
        let places = Laboratory::default().places;
        let all = |key: &str| std::iter::from_fn(|| places.take(Some(Arc::from(key))).ok()).take(100).collect::<Vec<_>>();
        let taken: Vec<_> = ["a", "b", "c"].map(all).into();
        assert_eq!(taken.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3, 2]);
        assert_eq!(all("d").len(), 2, "whoever has few finds one");
        drop(taken);
        assert_eq!(all("a").len(), 3, "what has ended is free");
    }

    /// Safety S9.
    #[tokio::test]
    async fn a_viewer_who_asks_for_many_runs_is_refused_and_an_operator_computes() {
        let (keyring, tokens) = keys();
        let app = Arc::new(guarded_app(searching(), Access::Keys(keyring)));
        let turn = Arc::clone(&app.door.process.laboratory.turn).acquire_owned().await.unwrap();
        let mut asked = tokio::task::JoinSet::new();
        let ask = |asked: &mut tokio::task::JoinSet<_>, token: &str| {
            let (app, key) = (Arc::clone(&app), format!("Bearer {token}"));
            asked.spawn(async move {
                read(app.send("GET", "/api/v1/laboratory/roomba?seconds=1", &[("authorization", &key)], "").await).await
            });
        };
        (0..5).for_each(|_| ask(&mut asked, &tokens.viewer));
        for _ in 0..2 {
            let (status, problem) = asked.join_next().await.unwrap().unwrap();
            assert_eq!((status.as_u16(), &problem["code"]), (503, &"tooManyRuns".into()), "three wait: {problem}");
        }
        ask(&mut asked, &tokens.operator);
        drop(turn);
        let statuses: Vec<u16> = asked.join_all().await.into_iter().map(|(status, _)| status.as_u16()).collect();
        assert_eq!(statuses, [200; 4], "the viewer's three, and the operator's");
    }

    #[tokio::test]
    async fn who_reads_italian_reads_it_in_italian() {
        const NAMES: [&str; 10] =
            ["SRM1", "SRM2", "Sequence", "JSON", "Roomba", "MoveForward", "MoveInSpiral", "GoBack", "Rotate", "Selector"];
        let app = app(searching());
        let page = app
            .italian("GET", "/laboratory?seed=3&seconds=60&palletSeed=2&parcels=2&fault=lost&fault=absent&at=2", "", &[], &NAMES)
            .await
            .replace("&#39;", "'");
        for wanted in [
            ">Macchina a stati, seme 3, 60 s<",
            ">Albero di comportamento, seme 3, 60 s<",
            "Macchina e albero hanno fatto le stesse",
            "data-label=\"albero\"",
            ">0,5 s</text>",
            "data-words=\"il pacco è sollevato e portato nell'area di arrivo\"",
            "fase 5: il pacco è sollevato e portato nell'area di arrivo",
            "ALLARME: ",
            "La prova finisce qui: l'operatore è stato chiamato e non è venuto.",
            "data-ended=\"La prova finisce: l'operatore",
            "1 di 2 nell'area di arrivo",
            "pacco</li>",
            "bancale</li>",
            " checked>perso per strada</label>",
            "L'animazione non può partire",
        ] {
            assert!(page.contains(wanted), "{wanted} in {page}");
        }
        let decimals = page.split(" mrad").next().and_then(|before| before.split_whitespace().last());
        assert!(decimals.is_some_and(|figure| figure.contains(',')), "{decimals:?}");
    }

    #[tokio::test]
    async fn nothing_on_the_page_is_inline_or_of_another_origin() {
        let page = text(app(searching()).get("/laboratory").await).await;
        let page = page.replace("http://www.w3.org/2000/svg", "");
        for unwanted in ["style=", "<style", "onclick", "http://", "https://"] {
            assert!(!page.contains(unwanted), "{unwanted}");
        }
        assert_eq!(page.matches("<script").count(), page.matches("<script src=\"./static/").count() + 2);
        for script in ["roomba", "pallet"] {
            assert!(page.contains(&format!("<script type=\"module\" src=\"./static/{script}.js\">")), "{script}");
        }
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
            ("seed=-1", "`seed` is \"-1\": send a whole number from 0 to 18446744073709551615"),
            ("seed=x", "`seed` is \"x\""),
            ("seconds=0", "`seconds` is \"0\": send a whole number from 1 to 600"),
            ("seconds=601", "`seconds` is \"601\""),
            ("seconds=1e9", "`seconds` is \"1e9\""),
            ("speed=4", "there is no parameter `speed`: the parameters are seed, seconds"),
            ("seed=1&seed=2", "`seed` occurs twice: send it once"),
        ] {
            for path in ["/api/v1/laboratory/roomba", "/laboratory"] {
                let (status, problem) = read(app.get(&format!("{path}?{query}")).await).await;
                assert_eq!(status, 422, "{path}?{query}");
                assert!(problem["detail"].as_str().unwrap().starts_with(words), "{problem}");
            }
        }
    }

    #[tokio::test]
    async fn the_page_shows_the_pallet_drawn_without_a_script_with_its_phases_its_figures_and_its_trees_at_the_end() {
        let app = app(searching());
        let page = text(app.get("/laboratory?palletSeed=2&parcels=2&fault=lost&fault=absent&at=2").await).await;
        for wanted in [
            "class=\"yard-target\"",
            "phase 5: the parcel is lifted and carried to the target area",
            "class=\"alarm\"",
            "1 of 2 in the target area",
            "the operator was called and has not come",
            "class=\"node failure ticked\"",
            "data-run=\"./api/v1/laboratory/pallet?parcels=2&#38;seed=2&#38;fault=lost@2&#38;fault=absent\"",
        ] {
            assert!(page.contains(wanted), "{wanted} in {page}");
        }
        assert_eq!(page.matches("<section class=\"tree\"").count(), 3);
        assert!(!page.contains("Did not happen"));
        let calm = text(app.get("/laboratory?palletSeed=2&parcels=1&fault=absent").await).await;
        assert!(
            calm.contains("<p class=\"same why\">Did not happen: no operator (the operator was never called).</p>"),
            "{calm}"
        );
        assert!(app.given.lock().unwrap().is_empty(), "it moves nothing");
    }

    #[tokio::test]
    async fn each_of_the_two_forms_keeps_what_was_asked_of_the_other() {
        let address = "/laboratory?seed=3&seconds=60&palletSeed=4&parcels=2&fault=lost&fault=jammed&at=2";
        let page = text(app(searching()).get(address).await).await;
        let (roomba, pallet) = page.split_once("id=\"pallet\"").unwrap();
        for kept in [("palletSeed", "4"), ("parcels", "2"), ("at", "2"), ("fault", "lost"), ("fault", "jammed")] {
            let input = format!("<input type=\"hidden\" name=\"{}\" value=\"{}\">", kept.0, kept.1);
            assert!(roomba.contains(&input), "{input}");
        }
        for kept in [("seed", "3"), ("seconds", "60")] {
            let input = format!("<input type=\"hidden\" name=\"{}\" value=\"{}\">", kept.0, kept.1);
            assert!(pallet.contains(&input), "{input}");
        }
        assert_eq!(pallet.matches(" checked>").count(), 2);
    }

    #[tokio::test]
    async fn the_interface_gives_the_run_of_the_pallet_that_is_asked_for() {
        let app = app(searching());
        let address = "/api/v1/laboratory/pallet?parcels=2&seed=9&fault=lost%402&fault=unrecognised";
        let (status, told) = read(app.get(address).await).await;
        assert_eq!((status.as_u16(), &told["seed"], &told["parcels"]), (200, &9.into(), &2.into()));
        assert_eq!(told["faults"], serde_json::json!(["lost@2", "unrecognised@1"]));
        assert_eq!((&told["figures"]["losses"], &told["figures"]["delivered"]), (&1.into(), &2.into()));
        assert_eq!(told["trees"].as_array().map(Vec::len), Some(3));
        let (_, usual) = read(app.get("/api/v1/laboratory/pallet").await).await;
        assert_eq!((&usual["seed"], &usual["parcels"], &usual["faults"]), (&1.into(), &3.into(), &serde_json::json!([])));
    }

    #[tokio::test]
    async fn a_run_of_the_pallet_is_never_large() {
        let app = app(searching());
        for faults in ["", "&fault=lost@4&fault=lost@4&fault=lost@3&fault=lost@2&fault=unrecognised@1&fault=unrecognised@2"] {
            let json = text(app.get(&format!("/api/v1/laboratory/pallet?parcels=4{faults}")).await).await;
            assert!(json.len() < 1 << 20, "{} bytes with {faults:?}", json.len());
        }
    }

    #[tokio::test]
    async fn what_cannot_be_carried_is_a_problem_that_says_what_belongs_there() {
        let app = app(searching());
        let (interface, page) = ("/api/v1/laboratory/pallet", "/laboratory");
        let many = ["fault=lost"; 13].join("&");
        for (path, query, words) in [
            (interface, "seed=-1", "`seed` is \"-1\": send a whole number from 0 to 18446744073709551615"),
            (page, "palletSeed=x", "`palletSeed` is \"x\""),
            (interface, "parcels=0", "`parcels` is \"0\": send a whole number from 1 to 4"),
            (page, "parcels=5", "`parcels` is \"5\": send a whole number from 1 to 4"),
            (interface, "fault=gone", "`fault` is \"gone\": this mishap is unknown: use lost, lostLifting"),
            (page, "fault=lost@2", "`fault` is \"lost@2\": this mishap is unknown"),
            (interface, "fault=lost@0", "`fault` is \"lost@0\": the number of a parcel is 1 to 24"),
            (interface, "fault=absent@1", "`fault` is \"absent@1\": absent concerns the whole run"),
            (interface, "fault=lost@4", "`fault` names parcel 4, but the pallet has only 3: see `parcels`"),
            (page, "fault=lost&at=4", "`at` names parcel 4, but the pallet has only 3: see `parcels`"),
            (page, "at=9", "`at` is \"9\": send a whole number from 1 to 4"),
            (interface, &many, "`fault` occurs 13 times: a run has at most 12 faults"),
            (interface, "at=1", "there is no parameter `at`: the parameters are seed, parcels, fault"),
            (interface, "seed=1&seed=2", "`seed` occurs twice: send it once"),
        ] {
            let (status, problem) = read(app.get(&format!("{path}?{query}")).await).await;
            assert_eq!(status, 422, "{path}?{query}");
            assert!(problem["detail"].as_str().unwrap().starts_with(words), "{problem}");
        }
    }
    #[test]
    fn trees_stand_at_the_end_of_a_run_as_after_the_last_tick_of_their_log() {
        let pallet = Pallet::new(1, 1, Vec::new(), Default::default()).unwrap();
        let trees = pallet.trees();
        let ids: Vec<&str> = trees.trees.iter().map(|tree| &*tree.id).collect();
        assert_eq!(ids, ["SRM1", "SRM2", "Supervisor"]);
        let shown = ReplayJson::new(pallet.logs()).shown(pallet.figures().took.as_secs_f64());
        assert_eq!((trees.ticks, trees), (320, shown));
    }
}
