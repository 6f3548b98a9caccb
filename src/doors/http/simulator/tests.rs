//! Tests of the refusals that come before the simulator is asked, and of the pages in both languages.

use std::collections::BTreeSet;

use tokio::sync::watch;

use super::super::testing::{TestApp, app, guarded_app, keys, text};
use super::*;
use crate::access::Access;
use crate::api::tests::fixture::{idle, searching};
use crate::runtime::simulator::{Change, Changing, Faults, HallFacts, OtherHall, Speed};
use hallsweep_core::asked::Asked;
use hallsweep_core::simulated::Simulated;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Cell;

const ROUTES: [(&str, &str); 13] = [
    ("GET", "/simulator"),
    ("POST", "/simulator/change"),
    ("POST", "/simulator/hall"),
    ("GET", "/simulator/editor"),
    ("GET", "/api/v1/simulator"),
    ("PUT", "/api/v1/simulator"),
    ("POST", "/api/v1/simulator/step"),
    ("PUT", "/api/v1/simulator/hall"),
    ("POST", "/api/v1/simulator/hall/check"),
    ("POST", "/simulator/editor"),
    ("GET", "/api/v1/simulator/halls/mine"),
    ("PUT", "/api/v1/simulator/halls/mine"),
    ("DELETE", "/api/v1/simulator/halls/mine"),
];

#[tokio::test]
async fn where_nothing_is_simulated_every_route_says_so() {
    let app = app(searching());
    for (method, path) in ROUTES {
        let response = app.send(method, path, &[], "").await;
        assert_eq!(response.status(), 404, "{method} {path}");
        assert!(text(response).await.contains("notSimulated"), "{method} {path}");
    }
    let console = text(app.get("/").await).await;
    let css = include_str!("../../../../static/shell.css");
    let hides = css.contains("html:not([data-simulated]) .of-simulator { display: none; }");
    assert!(hides && !console.contains("-simulated"), "the rail leads nobody there");
}

/// Safety A3.
#[tokio::test]
async fn a_viewer_changes_nothing_and_a_stranger_sees_nothing() {
    let (keyring, tokens) = keys();
    let app = guarded_app(searching(), Access::Keys(keyring));
    let bearer = format!("Bearer {}", tokens.viewer);
    for (method, path) in ROUTES {
        assert_eq!(app.send(method, path, &[], "").await.status(), 401, "{method} {path}");
        let expect = if method == "GET" { 404 } else { 403 };
        let response = app.send(method, path, &[("authorization", &bearer)], "").await;
        assert_eq!(response.status(), expect, "{method} {path}");
    }
}

struct Still(watch::Sender<Arc<SimulatorState>>);

fn refused(why: NotSimulated) -> Changing {
    Box::pin(async { Err(why) })
}

impl Simulator for Still {
    fn watch(&self) -> watch::Receiver<Arc<SimulatorState>> {
        self.0.subscribe()
    }

    fn halls(&self) -> Vec<String> {
        vec!["depot".to_owned(), "mine".to_owned()]
    }

    fn kept_halls(&self) -> Vec<String> {
        vec!["mine".to_owned()]
    }

    fn hall(&self, _: &str) -> Result<String, NotSimulated> {
        Ok(self.0.borrow().hall.toml.to_string())
    }

    fn change(self: Arc<Self>, change: Change, _: Issuer) -> Changing {
        let cell = change.blocked.and_then(|blocked| blocked.first().copied());
        refused(cell.map_or(NotSimulated::NotPaused, NotSimulated::NoFreeCell))
    }

    fn step(self: Arc<Self>, _: Issuer) -> Changing {
        refused(NotSimulated::NothingUnderWay)
    }

    fn put_down(self: Arc<Self>, _: OtherHall, _: Issuer) -> Changing {
        refused(NotSimulated::Refused(Refused::NotInPhase(hallsweep_core::phase::PhaseName::Exploring)))
    }

    fn keep(self: Arc<Self>, name: String, _: String, may_replace: bool, _: Issuer) -> Changing {
        refused(match name.as_str() {
            "mine" if !may_replace => NotSimulated::AnotherKept(name),
            "depot" => NotSimulated::NameTaken(name),
            "" => NotSimulated::NotAName(name),
            "many" => NotSimulated::TooManyKept(100),
            "full" => NotSimulated::CannotChangeKept("No space left".to_owned()),
            _ => NotSimulated::NoDataFolder,
        })
    }

    fn discard(self: Arc<Self>, name: String, _: Issuer) -> Changing {
        match name.as_str() {
            "mine" => {
                let state = self.0.borrow().clone();
                Box::pin(async { Ok(state) })
            }
            _ => refused(NotSimulated::NotThere(name)),
        }
    }
}

fn simulated(snapshot: Snapshot, access: Access, is_paused: bool) -> TestApp {
    let blocked: BTreeSet<Cell> = is_paused.then_some(Cell::new(1, 0)).into_iter().collect();
    let state = SimulatorState {
        hall: HallFacts {
            name: "depot".into(),
            size: (8, 9),
            cell_m: 0.5,
            pieces: 1,
            toml: "drawing = \"\"\"\nS\n\"\"\"\n".into(),
        },
        seed: 7,
        speed: if is_paused { Speed::Max } else { Speed::Times(0.5) },
        is_paused,
        faults: Faults { link_lost: is_paused, no_thermometer: is_paused, camera_fails: is_paused, blocked },
    };
    let mut app = guarded_app(snapshot, access);
    let simulator: Arc<dyn Simulator> = Arc::new(Still(watch::Sender::new(Arc::new(state))));
    app.hall_mut().simulator = Some(simulator);
    app
}

#[track_caller]
fn check(page: &str, wanted: &[&str]) {
    for wanted in wanted {
        assert!(page.contains(wanted), "{wanted}: {page}");
    }
}

#[tokio::test]
async fn the_page_of_the_controls_speaks_italian_in_every_state() {
    let names = ["depot", "mine", "file"];
    let app = simulated(searching(), Access::Open, false);
    let page = app.italian("GET", "/simulator", "", &[], &names).await;
    check(&page, &["In corso a 0,5 × il tempo reale.", "<option value=\"0.5\" selected>0,5 ×</option>"]);
    check(&page, &["I robot sono in <b>depot</b>: 8 × 9 celle di 0,5 m, 1 bagaglio; seme 7.", "Termometro: a posto"]);
    check(&page, &["Al momento: non è possibile durante una missione: attendere che finisca, o premere ARCHIVIA"]);
    check(
        &page,
        &["solo in pausa</small>", "Nessuna cella è ostruita.", "Il comando non è stato inviato", "value=\"/simulator\""],
    );
    let app = simulated(idle(), Access::Open, true);
    let page = app.italian("GET", "/simulator", "", &[], &names).await;
    check(&page, &["In pausa: il tempo simulato è fermo.", "Collegamento: interrotto", "Fotocamera: guasta", "Liberare (1, 0)"]);
    let (keyring, tokens) = keys();
    let app = simulated(idle(), Access::Keys(keyring), true);
    let page = app.italian("GET", "/simulator", "", &[("authorization", &format!("Bearer {}", tokens.viewer))], &names).await;
    check(&page, &["Accesso come osservatore: si vede il simulatore"]);
}

#[tokio::test]
async fn what_was_refused_stands_in_italian_beside_its_button() {
    let app = simulated(idle(), Access::Open, true);
    for (path, body, words) in [
        ("/simulator/change", "act=step", "nessun robot ha un ordine in corso"),
        ("/simulator/change", "act=goOn", "il simulatore non è in pausa"),
        ("/simulator/change", "act=block&x=9&y=9", "qui non si può mettere un ostacolo"),
        ("/simulator/change", "act=block&x=9", "un valore inviato non va bene: «y is missing: fill it in»"),
        ("/simulator/hall", "name=depot", "non è possibile durante una missione: attendere che finisca"),
        ("/simulator/editor", "act=use&toml=x", "non è possibile durante una missione: attendere che finisca"),
        ("/simulator/editor", "act=keep&name=depot&toml=x", "una sala di hallsweep o delle impostazioni si chiama già così"),
        ("/simulator/editor", "act=keep&name=&toml=x", "il nome di una sala conservata ha lettere minuscole"),
        ("/simulator/editor", "act=keep&name=many&toml=x", "non si possono conservare altre sale"),
        ("/simulator/editor", "act=keep&name=full&toml=x", "le sale conservate non si possono cambiare: «No space left»"),
        ("/simulator/editor", "act=keep&name=other&toml=x", "senza cartella dei dati non si conservano sale"),
        ("/simulator/editor", "replace=mine&name=mine&toml=x", "senza cartella dei dati non si conservano sale"),
        ("/simulator/editor", "act=keep&opened=mine&name=mine&toml=x", "senza cartella dei dati non si conservano sale"),
        ("/simulator/editor", "act=check&toml=x", "questa sala non si può usare: «hall.toml:1: "),
    ] {
        let page = app.italian("POST", path, body, &[], &["depot", "mine", "Area"]).await;
        check(&page, &[&format!("role=\"alert\">{words}")]);
    }
    let (_, state) = app.json("PUT", "/api/v1/simulator/hall", "{\"name\":\"depot\"}").await;
    let detail = state["detail"].as_str().unwrap();
    assert!(detail.ends_with(": let the mission end, or press RESET, which archives the mission"), "{detail}");
}

#[tokio::test]
async fn the_editor_and_its_script_speak_italian() {
    let names = ["depot", "mine", "Area"];
    let app = simulated(searching(), Access::Open, false);
    let page = app.italian("GET", "/simulator/editor", "", &[], &names).await;
    check(
        &page,
        &["<h1>Editor delle sale</h1>", "Parete <kbd>", "Annulla", "aria-label=\"Pianta della sala\"", "value=\"0,05\""],
    );
    check(&page, &["colonna { $x }, riga { $y }", "Al momento: non è possibile durante una missione"]);
    let checked = |toml: &str| format!("act=check&toml={}", toml.replace('\n', "%0A").replace('#', "%23").replace(' ', "+"));
    let walled = checked("drawing = \"\"\"\n.#T#\nS###\n.#..\n\"\"\"\n");
    let page = app.italian("POST", "/simulator/editor", &walled, &[], &names).await;
    check(&page, &["La sala si può usare, ma una ricerca non arriva dappertutto:", "<li>colonna 2, riga -1: il bagaglio «"]);
    check(&page, &["<li>colonna 2, riga 1: questa cella libera non si può raggiungere dalla base</li>"]);
    let sound = app.italian("POST", "/simulator/editor", &checked("drawing = \"\"\"\nS.T\n\"\"\"\n"), &[], &names).await;
    check(&sound, &["La sala è a posto: tutto si può raggiungere."]);
    let opened = app.italian("GET", "/simulator/editor?hall=mine", "", &[], &names).await;
    check(
        &opened,
        &["Questa è la sala conservata come <b>mine</b>.", "name=\"opened\" id=\"opened\" value=\"mine\"", "Eliminare mine"],
    );
    let asked = app.italian("POST", "/simulator/editor", "discard=mine&opened=mine&toml=%23", &[], &names).await;
    check(&asked, &["Eliminare <b>mine</b>? La sala conservata ", "name=\"discard_for_good\" value=\"mine\"", ">#</textarea>"]);
    let discarded = app.italian("POST", "/simulator/editor", "discard_for_good=mine&opened=mine&toml=%23", &[], &names).await;
    check(&discarded, &["La sala conservata <b>mine</b> è stata eliminata.", ">#</textarea>"]);
    assert!(!discarded.contains("name=\"opened\""), "it is not opened as one that is kept");
    // The request names another hall than the one to be replaced, so nothing is replaced.
    for body in ["act=keep&name=mine&toml=x", "replace=other&name=mine&toml=x", "act=keep&opened=other&name=mine&toml=x"] {
        let asked = app.italian("POST", "/simulator/editor", body, &[], &names).await;
        check(&asked, &["Un'altra sala è conservata come <b>mine</b>: sostituirla", "name=\"replace\" value=\"mine\""]);
    }
    let (keyring, tokens) = keys();
    let app = simulated(idle(), Access::Keys(keyring), true);
    let viewer = format!("Bearer {}", tokens.viewer);
    let page = app.italian("GET", "/simulator/editor", "", &[("authorization", &viewer)], &names).await;
    check(&page, &["Accesso come osservatore: si vede la sala"]);
}

#[test]
fn what_was_done_to_the_simulator_is_said_in_every_language() {
    let whether = [None, Some(true), Some(false)];
    let cells = |cells: &[Cell]| Some(cells.iter().copied().collect::<BTreeSet<_>>());
    let blocked = [None, cells(&[]), cells(&[Cell::new(-1, 2)]), cells(&[Cell::new(1, 2), Cell::new(3, 4)])];
    for (is_so, blocked) in whether.into_iter().flat_map(|is_so| blocked.clone().map(|blocked| (is_so, blocked))) {
        for speed in [None, Some(Speed::Max), Some(Speed::Times(2.5))] {
            let change = Change {
                speed,
                is_paused: is_so,
                link_lost: is_so.filter(|_| speed.is_some()),
                no_thermometer: is_so,
                camera_fails: is_so,
                blocked: blocked.clone(),
            };
            if change == Change::default() {
                continue;
            }
            let changed = Asked::Simulated(Simulated::Changed(change));
            assert_eq!(Language::English.asked(&changed, None), changed.to_string());
            let italian = Language::Italian.asked(&changed, None);
            let is_english = |word: &str| italian.contains(word);
            assert!(
                italian.starts_with("simulatore: ")
                    && !["yes", "no ", "paused", "speed", "block"].iter().any(|word| is_english(word)),
                "{italian}"
            );
        }
    }
    let hall = || "a b".to_owned();
    for done in [Simulated::Step, Simulated::Kept(hall()), Simulated::Discarded(hall()), Simulated::PutDown(hall().into())] {
        let done = Asked::Simulated(done);
        assert_eq!(Language::English.asked(&done, None), done.to_string());
        assert_ne!(Language::Italian.asked(&done, None), done.to_string());
    }
    assert_eq!(Language::Italian.robot_said("the lens is covered"), "the lens is covered");
}

#[test]
fn what_a_search_does_not_come_to_is_said_in_every_language() {
    use crate::api::hall_files::Found;
    for found in [
        Found::PieceUnreached { name: "red backpack".to_owned() },
        Found::CellUnreached,
        Found::More { count: 2 },
        Found::NoLuggage,
    ] {
        let sent = serde_json::to_value(&found).unwrap();
        assert_eq!(sent["code"], found.code(), "the script asks for the phrase by it");
        assert_eq!(editor::in_words(Language::English, &found).to_string(), found.to_string(), "as programs are told");
        assert_ne!(editor::in_words(Language::Italian, &found).to_string(), found.to_string());
    }
}
