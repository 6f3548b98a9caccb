//! The operator's console: one page, built here and kept up to date by `live`. Every button is a plain HTML form, so
//! the page works without a script. The script only avoids reloading. The core decides which commands are
//! allowed, and the page shows its refusals.

mod acts;
mod areas;
mod began;
mod carriers;
mod doing;
mod drawing;
mod entrance;
mod evacuation;
mod hall;
mod incident;
mod live;
pub(super) mod missions;
pub(super) mod moments;
mod page;
mod parts;
pub(super) mod photo;
mod pieces;
pub(super) mod replay;
mod retrieval;
mod timeline;
mod view;

use askama::Template;
use axum::extract::Query;
use axum::extract::rejection::QueryRejection;
use axum::http::{HeaderMap, HeaderValue, Uri, header};
use axum::response::{Html, IntoResponse, Redirect, Response};

use super::HttpDoor;
use super::accept::preferred;
use super::command::CommandSender;
use super::language::{PageReader, Spoken, spoken};
use super::problem::Problem;
use super::reading::{Form, Number};
use crate::access::{Access, Caller};
use crate::api::answer::AnswerJson;
use crate::api::door;
use crate::api::problem::ProblemKind;
use crate::phrases::Language;
use crate::runtime::carry_out::Done;
pub(super) use acts::buttons;
use acts::{Fields, TypedRemarks};
use areas::{CloseArea, has_more_open};
use hallsweep_core::command::{Accepted, Command, Hot};
use hallsweep_core::units::LuggageId;
use page::{ConsolePage, DRIVE};
use view::{HallInfo, View, Who, Why};

pub(super) use began::Began;
pub(super) use live::live;
pub(super) use retrieval::{rows, sign};
pub(super) use timeline::Timelines;

pub(super) async fn refused_page(door: &HttpDoor, to: &PageReader, button: &str, problem: &Problem) -> Response {
    let why = Why::new(button, &problem.in_words(to.language));
    let mut response = (problem.status(), whole(door, to, Some(why)).await).into_response();
    problem.tell_gate(&mut response);
    response
}

/// `GET /`. With `?tab=drive` the tab *Drive* is open at first.
pub(super) async fn page(door: HttpDoor, to: PageReader, query: super::query::Query) -> Html<String> {
    let opened = query.every("tab").first().map(|tab| Why::new(tab, ""));
    whole(&door, &to, opened).await
}

/// `GET console/bar`: the status bar with the state of the hall, for all pages except the console. The console gets
/// its bar by its stream.
pub(super) async fn bar(door: HttpDoor, Spoken(language): Spoken) -> Html<String> {
    let (snapshot, hall, now) = (door.hall.handle.snapshot(), HallInfo::of(&door), door.process.clock.now().wall);
    let view = View { snapshot: &snapshot, hall, began: None, who: None, language, why: None, now, line: None, then: None };
    html(&parts::Elsewhere { v: &view })
}

/// `GET console/coverage`: how well each cell was searched, as a part of the picture of the hall. The page asks for it only
/// while it is shown, because it is large.
pub(super) async fn coverage(door: HttpDoor) -> Html<String> {
    let snapshot = door.hall.handle.snapshot();
    Html(hall::coverage(&snapshot.coverage, snapshot.venue.sensor))
}

/// `POST console/start` and every other form except the form of STOP. If a form was recognised as a STOP, it is
/// carried out as STOP, whatever else it contains.
pub(super) async fn act(sender: CommandSender, uri: Uri, headers: HeaderMap, form: Result<Form<Fields>, Problem>) -> Response {
    match form {
        _ if sender.has_pressed_stop() => stop(sender, headers).await,
        Ok(Form(fields)) => answered(&sender, &headers, uri.path().trim_start_matches("/console/"), &fields).await,
        Err(problem) if is_by_script(&headers) => problem.told(spoken(&headers)),
        Err(problem) => problem.into_response(),
    }
}

fn is_by_script(headers: &HeaderMap) -> bool {
    preferred(headers, &["text/html", "application/json"]) == Some("application/json")
}

/// `POST console/stop`. The body is not read, so that no fault in it can prevent the halt.
pub(super) async fn stop(sender: CommandSender, headers: HeaderMap) -> Response {
    answered(&sender, &headers, "stop", &Fields::default()).await
}

async fn answered(sender: &CommandSender, headers: &HeaderMap, act: &str, fields: &Fields) -> Response {
    let [name, receiver, note, area, open] = fields.stated();
    let done = match fields.command(act) {
        Ok((Command::CloseArea(_), _)) if has_more_open(&sender.door.hall.handle.snapshot(), &area, &open) => {
            let detail = "more is open in this area than the page has shown: read the figures again, then close the area";
            Err(Problem::new(("moreOpen", ProblemKind::Conflict), detail.to_owned()))
        }
        Ok((command, epoch)) => sender.give(door::CONSOLE, command, epoch).await,
        Err(problem) => Err(problem),
    };
    let by_script = is_by_script(headers);
    let mut response = match done {
        Ok(Done { accepted, snapshot }) if by_script => axum::Json(AnswerJson::new(accepted, &snapshot)).into_response(),
        Ok(Done { accepted: Accepted { is_kept_back: true, luggage, .. }, .. }) => {
            let to = PageReader::new(sender.caller.clone(), headers);
            let said = to.language.say("kept-back").with("id", luggage.unwrap_or_default()).to_string();
            whole(&sender.door, &to, Some(Why::new("verdict", &said))).await.into_response()
        }
        Ok(Done { snapshot, .. }) if act == "handOver" => {
            Redirect::to(&format!("/missions/{}/receipts", snapshot.mission.id)).into_response()
        }
        Ok(_) if DRIVE.contains(&&*fields.button(act)) => Redirect::to("/?tab=drive#more").into_response(),
        Ok(_) => Redirect::to("/").into_response(),
        Err(problem) if by_script => problem.told(spoken(headers)),
        Err(problem) => {
            let to = PageReader::new(sender.caller.clone(), headers);
            let (door, why) = (&sender.door, problem.in_words(to.language));
            let statement = match act {
                "close" => Some(close_page(door, to.language, why, [name, note])),
                "closeArea" => Some(html(&CloseArea::new(to.language, &door.hall.handle.snapshot(), area, why, [name, note]))),
                "handOver" => Some(hand_over_page(door, to.language, why, [receiver, note])),
                _ => None,
            };
            match statement {
                Some(page) => {
                    let mut response = (problem.status(), page).into_response();
                    problem.tell_gate(&mut response);
                    response
                }
                None => refused_page(door, &to, &fields.button(act), &problem).await,
            }
        }
    };
    response.headers_mut().append(header::VARY, HeaderValue::from_static("accept"));
    response
}

/// `GET console/confirm/danger/{id}?note=…`: asks for a confirmation of the verdict DANGER. The note typed beside the
/// button is kept in the confirmation form.
pub(super) async fn confirm_danger(
    door: HttpDoor,
    to: PageReader,
    Number(id): Number,
    typed: Result<Query<TypedRemarks>, QueryRejection>,
) -> Response {
    let snapshot = door.hall.handle.snapshot();
    let (button, problem) =
        match (snapshot.luggage(LuggageId(id)), typed.map_or(Ok((None, Hot::NONE)), |Query(typed)| typed.remarks())) {
            (Some(luggage), Ok((note, hot))) => {
                return html(&parts::Confirm::danger(to.language, luggage, note, hot, door.hall.settings.rules)).into_response();
            }
            (Some(_), Err(problem)) => ("verdict", problem),
            (None, _) => ("page", Problem::no_luggage(id)),
        };
    refused_page(&door, &to, button, &problem).await
}

pub(super) async fn confirm_reset(Spoken(language): Spoken) -> Html<String> {
    html(&parts::Confirm::reset(language))
}

/// `GET console/confirm/close`: lists what is left open, and asks who closes the mission.
pub(super) async fn confirm_close(door: HttpDoor, Spoken(language): Spoken) -> Html<String> {
    close_page(&door, language, String::new(), Default::default())
}

/// The page that closes a mission. After a refusal it shows the reason, and keeps what was typed.
fn close_page(door: &HttpDoor, language: Language, why: String, [name, note]: [String; 2]) -> Html<String> {
    let snapshot = door.hall.handle.snapshot();
    let (open, code) = (snapshot.mission.open, snapshot.mission.open.code(snapshot.mission.id));
    let finding = language.finding(&snapshot.luggage);
    html(&parts::CloseMission { language, finding, open, code, why, name, note })
}

/// `GET console/confirm/closeArea?area=…`: says what is open in the area, and asks who closes it.
pub(super) async fn confirm_close_area(
    door: HttpDoor,
    Spoken(language): Spoken,
    named: Result<Query<Fields>, QueryRejection>,
) -> Html<String> {
    let [.., area, _] = named.map_or_else(|_| Fields::default(), |Query(fields)| fields).stated();
    html(&CloseArea::new(language, &door.hall.handle.snapshot(), area, String::new(), Default::default()))
}

/// `GET console/confirm/handOver`: asks to whom the mission is handed over.
pub(super) async fn confirm_hand_over(door: HttpDoor, Spoken(language): Spoken) -> Html<String> {
    hand_over_page(&door, language, String::new(), Default::default())
}

/// The page that hands a mission over. After a refusal it shows the reason, and keeps what was typed.
fn hand_over_page(door: &HttpDoor, language: Language, why: String, [to, note]: [String; 2]) -> Html<String> {
    let mission = Some(&door.hall.handle.snapshot().mission).filter(|mission| mission.is_under_way()).map(|mission| mission.id);
    html(&parts::HandOverMission { language, mission, why, to, note })
}

async fn whole(door: &HttpDoor, to: &PageReader, why: Option<Why>) -> Html<String> {
    let snapshot = door.hall.handle.snapshot();
    let began = began::began(door, snapshot.mission.id).await;
    let line = Timelines::of(door, snapshot.mission.id, to.language).await;
    let (hall, who, now) = (HallInfo::of(door), who(door, &to.caller), door.process.clock.now().wall);
    let view = View { snapshot: &snapshot, hall, began, who, language: to.language, why, now, line: Some(&line), then: None };
    html(&ConsolePage::new(&view))
}

fn who(door: &HttpDoor, caller: &Caller) -> Option<Who> {
    match door.process.access {
        Access::Open => None,
        Access::Keys(_) => Some(Who { name: caller.signature(), role: caller.role() }),
    }
}

pub(in crate::doors::http) fn html(template: &impl Template) -> Html<String> {
    Html(template.render().expect("the console's templates only write strings, which does not fail"))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{app, leads, read, text};
    use crate::api::tests::fixture::{idle, searching};
    use hallsweep_core::command::{Again, Command, LuggageRef, Move, Note, Verdict};
    use hallsweep_core::phase::PhaseName;
    use hallsweep_core::refused::Refused;
    use hallsweep_core::units::{Cell, Epoch, LuggageId, MissionId};
    use hallsweep_core::world::hall_map::Bounds;

    const FORM: (&str, &str) = ("content-type", "application/x-www-form-urlencoded");

    #[tokio::test]
    async fn the_page_is_complete_without_a_script() {
        let app = app(searching());
        let page = app.page("/").await;
        for wanted in [
            "waits for your verdict",
            "STOP",
            "SAFE #3",
            "DANGER #3",
            "/api/v1/luggage/3/photo?take=1",
            "action=\"./console/acknowledge\"",
            "name=\"epoch\" value=\"1\"",
            "<svg id=\"hall\"",
            "15 cells</b> searched",
            "4 places left to search",
            "<b data-since=\"1770109200000\">",
            "title=\"luggage #3 waits for its verdict: answer safe or danger first\"",
        ] {
            assert!(page.contains(wanted), "{wanted}");
        }
    }

    #[tokio::test]
    async fn who_reads_italian_reads_now_and_the_past_in_italian() {
        // The log lines and alarms are invented for this test, so they are not translated.
        const NAMES: [&str; 14] = [
            "42 cm",
            ": luggage #2 is dangerous.",
            "exploration began",
            "luggage #2 is dangerous",
            "luggage #3 found at (3, 2)",
            "LED",
            "OK",
            "Robot",
            "Sonar",
            "airport",
            "hallsweep ·",
            "rev",
            "robot",
            "sonar",
        ];
        for (snapshot, path) in [(idle(), "/"), (searching(), "/"), (searching(), "/missions/1/moment?at=4")] {
            app(snapshot).italian("GET", path, "", &[], &NAMES).await;
        }
        app(searching()).italian("GET", "/console/confirm/danger/3?note=red", "", &[], &NAMES).await;
        app(searching()).italian("GET", "/console/confirm/reset", "", &[], &NAMES).await;
    }

    /// Safety S10.
    #[tokio::test]
    async fn every_page_has_a_stop_that_works_without_a_script_and_the_script_that_does_not_let_it_go() {
        let app = app(searching());
        let browser = [("accept", "text/html,application/xhtml+xml,*/*;q=0.8")];
        let pages = [
            "/",
            "/missions",
            "/missions/1",
            "/missions/1/moment",
            "/missions/9",
            "/luggage/3",
            "/luggage/99",
            "/console/confirm/reset",
        ];
        for path in pages.into_iter().chain(["/console/confirm/danger/3", "/nowhere", "/api/v1/luggage/3/photo"]) {
            let mut response = app.send("GET", path, &browser, "").await;
            if response.headers().contains_key("location") {
                response = app.send("GET", &leads(&response, path), &browser, "").await;
            }
            let page = text(response).await;
            assert!(page.contains("<form id=\"stop\" method=\"post\" action=\"./console/stop\">"), "{path}: {page}");
            assert!(page.contains("<script src=\"./static/stop.js\" defer>") && page.matches("<h1").count() == 1, "{path}");
        }
    }

    #[tokio::test]
    async fn every_page_but_the_console_has_a_place_for_the_bar_and_the_bar_is_what_the_console_says() {
        let app = app(searching());
        let browser = [("accept", "text/html,application/xhtml+xml,*/*;q=0.8")];
        let pages =
            ["/missions", "/missions/1", "/luggage/3", "/console/confirm/reset", "/console/confirm/danger/3", "/laboratory"];
        for path in pages.into_iter().chain(["/api", "/nowhere"]) {
            let page = text(app.send("GET", path, &browser, "").await).await;
            assert_eq!(page.matches("id=\"bar\"").count(), 1, "{path}");
            assert!(page.contains("<div id=\"elsewhere\">") && page.contains("src=\"./static/bar.js\""), "{path}: {page}");
        }
        let console = app.page("/").await;
        assert!(console.matches("id=\"bar\"").count() == 1 && !console.contains("/static/bar.js"), "it has its own");
        let bar = app.page("/console/bar").await;
        for wanted in ["airport", "waits for your verdict", "class=\"chip doing\"", "LED ", "class=\"chip num heat", "as of "] {
            assert!(bar.contains(wanted), "{wanted} in {bar}");
        }
        assert!(!bar.contains("<h1") && !bar.contains("<a "), "what is replaced every second takes no focus: {bar}");
        let (_, lamps) = bar.split_once("<ul").unwrap();
        assert!(console.contains(lamps.split_once("</ul>").unwrap().0), "{lamps}");
        let bar = text(app.send("GET", "/console/bar", &[("accept-language", "it")], "").await).await;
        assert!(bar.contains("attende il verdetto") && bar.contains("alle ") && !bar.contains("as of"), "{bar}");
    }

    #[tokio::test]
    async fn a_page_that_another_name_led_to_has_no_stop_because_it_would_be_refused() {
        let app = app(searching());
        let browser = [("accept", "text/html"), ("host", "elsewhere.example")];
        let response = app.send("GET", "/", &browser, "").await;
        assert_eq!(response.status(), 421);
        assert!(!text(response).await.contains("/console/stop"));
    }

    #[tokio::test]
    async fn a_photo_opened_by_itself_is_a_page_and_a_program_gets_the_picture() {
        let app = app(searching());
        let photo = "/api/v1/luggage/3/photo?take=1";
        let opened = app.send("GET", photo, &[("accept", "text/html,image/avif,*/*;q=0.8")], "").await;
        assert_eq!((opened.status().as_u16(), &*leads(&opened, photo)), (303, "/luggage/3?take=1"));
        for accept in ["*/*", "image/avif,image/webp,image/*,*/*;q=0.8", "image/png"] {
            let picture = app.send("GET", photo, &[("accept", accept)], "").await;
            assert_eq!(
                (picture.status().as_u16(), &picture.headers()["content-type"]),
                (200, &"image/png".parse().unwrap()),
                "{accept}"
            );
            assert!(picture.headers().get_all("vary").iter().any(|vary| vary == "accept"));
        }
        let page = text(app.get("/luggage/3").await).await;
        assert!(page.contains(&format!("src=\".{photo}\"")) && page.contains("Times are in UTC"), "{page}");
        assert!(text(app.get("/").await).await.contains("href=\"./luggage/3\" target"));
    }

    #[tokio::test]
    async fn nothing_on_the_page_is_inline_or_of_another_origin() {
        for snapshot in [idle(), searching()] {
            let app = app(snapshot);
            let past = text(app.get("/missions/1/moment?at=4").await).await;
            for page in [app.page("/").await, past, text(app.get("/console/confirm/reset").await).await] {
                assert!(!page.contains("style=") && !page.contains("<style") && !page.contains("onclick"));
                assert!(!page.contains("http://") && !page.contains("https://"), "everything comes from here");
                for script in page.split("<script").skip(1) {
                    assert!(script.starts_with(" src=\"./static/"), "{}", &script[..40]);
                }
            }
        }
    }

    #[tokio::test]
    async fn a_form_that_was_accepted_leads_back_to_the_page() {
        let app = app(searching());
        let cases = [
            ("/console/start", "epoch=7", Command::Start),
            ("/console/move", "epoch=7&move=w", Command::Move(Move::Forward)),
            ("/console/goto", "epoch=7&x=1&y=2", Command::Goto(Cell::new(1, 2))),
            (
                "/console/searchAgain",
                "epoch=7&x=1&y=2&toX=1&toY=2",
                Command::SearchAgain(Again::Within(Bounds::of(Cell::new(1, 2)))),
            ),
        ];
        for (path, body, command) in cases {
            let response = app.form(path, body).await;
            let to = if command == Command::Start { "/" } else { "/?tab=drive#more" };
            assert_eq!((response.status().as_u16(), &*leads(&response, path)), (303, to), "{path}");
            assert_eq!((app.last().command, app.last().epoch), (command, Some(Epoch(7))));
        }
        for (path, tab) in [("/", "status"), ("/?tab=drive", "drive"), ("/?tab=%22", "status")] {
            let page = app.page(path).await;
            assert!(page.contains(&format!("id=\"tab-{tab}\" autocomplete=\"off\" checked")), "{path}: {page}");
        }
    }

    #[tokio::test]
    async fn a_refused_form_shows_the_page_with_the_reason_beside_its_button() {
        let app = app(searching());
        app.refuse(Refused::Moving);
        let response = app.form("/console/reset", "").await;
        assert_eq!(response.status(), 409);
        let page = text(response).await;
        assert!(page.contains("id=\"why-reset\" role=\"alert\">the robot is moving: press STOP first</p>"));
        assert!(page.contains("id=\"why-start\" role=\"alert\"></p>"));
    }

    #[tokio::test]
    async fn a_form_filled_in_wrongly_says_what_is_missing() {
        let app = app(searching());
        let response = app.form("/console/goto", "x=&y=2").await;
        assert_eq!(response.status(), 422);
        assert!(text(response).await.contains("x is missing: fill it in"));
        assert!(app.given.lock().unwrap().is_empty());
    }

    #[tokio::test]
    async fn danger_asks_once_more_before_anything_is_sent() {
        let app = app(searching());
        let asked = app.get("/console/confirm/danger/3?").await;
        assert_eq!(asked.status(), 200);
        let page = text(asked).await;
        assert!(page.contains("Is luggage #3 dangerous?") && page.contains("action=\"./console/danger\""));
        assert!(page.contains("STOP"), "STOP is on this page too");
        assert!(app.given.lock().unwrap().is_empty(), "asking changes nothing");
        assert_eq!(app.get("/console/confirm/danger/9").await.status(), 404);
        assert_eq!(app.form("/console/danger", "id=3").await.status(), 303);
        let luggage = LuggageRef::Id(LuggageId(3));
        assert_eq!(
            app.last().command,
            Command::Verdict { luggage, verdict: Verdict::Danger, note: None, hot: Default::default() }
        );
    }

    /// A refusal stands on the page of the form, with what was typed, and what is open now.
    #[tokio::test]
    async fn a_mission_that_could_not_be_closed_is_said_not_to_be_on_the_same_page() {
        let mut snapshot = searching();
        snapshot.mission.open.bombs = 2;
        let code = snapshot.mission.open.code(snapshot.mission.id);
        let app = app(snapshot);
        let page = app.page("/console/confirm/close").await;
        assert!(page.contains("bombs in the hall: 2") && page.contains(&format!("value=\"{code}\"")), "{page}");
        assert!(app.given.lock().unwrap().is_empty(), "looking changes nothing");
        let typed = "name=Anna+%3Cb%3E&note=handed%0Aover&open=1%3A0";
        assert_eq!(app.form("/console/close", typed).await.status(), 303);
        let Command::Close(closing) = app.last().command else { panic!("{:?}", app.last()) };
        assert_eq!(
            (closing.name.text(), closing.note.as_ref().map(Note::text), &*closing.seen),
            ("Anna <b>", Some("handed over"), "1:0")
        );
        app.refuse(Refused::NotInPhase(PhaseName::Idle));
        let refused = app.form("/console/close", typed).await;
        assert_eq!(refused.status(), 409);
        let page = text(refused).await;
        assert!(page.contains("role=\"alert\">not possible while") && page.contains("value=\"Anna &#60;b&#62;\""), "{page}");
        let blank = app.form("/console/close", "name=+&open=").await;
        assert_eq!(blank.status(), 422);
        assert!(text(blank).await.contains("role=\"alert\">name"));
        let italian = [("accept-language", "it")];
        let page = text(app.send("GET", "/console/confirm/close", &italian, "").await).await;
        assert!(page.contains("bombe nella sala: 2") && page.contains("Chiudere la missione"), "{page}");
    }

    #[tokio::test]
    async fn a_mission_is_handed_over_by_a_form_that_keeps_what_was_typed() {
        let app = app(searching());
        let page = app.page("/console/confirm/handOver").await;
        assert!(page.contains("<b>Mission 1</b>") && page.contains("action=\"./console/handOver\""), "{page}");
        let typed = "to=Police+%3Cb%3E&note=with%0Aphotos&mission=1";
        let done = app.form("/console/handOver", typed).await;
        assert_eq!((done.status().as_u16(), &done.headers()["location"]), (303, &"../missions/1/receipts".parse().unwrap()));
        let Command::HandOver(over) = app.last().command else { panic!("{:?}", app.last()) };
        assert_eq!((over.to.text(), over.note.as_ref().map(Note::text)), ("Police <b>", Some("with photos")));
        assert_eq!(over.mission, Some(MissionId(1)), "the mission that the page named");
        app.refuse(Refused::StoreDown);
        let refused = app.form("/console/handOver", typed).await;
        assert_eq!(refused.status(), 503);
        let page = text(refused).await;
        assert!(page.contains("role=\"alert\">the record cannot") && page.contains("value=\"Police &#60;b&#62;\""), "{page}");
        assert_eq!(app.form("/console/handOver", "to=+").await.status(), 422);
        for act in ["start", "close", "handOver"] {
            let refused = app.form(&format!("/console/{act}"), "to=police&name=Anna&open=").await;
            let varies = refused.headers().get_all("vary").iter().any(|value| value == "accept");
            assert!(varies, "{act}: scripts get JSON from the same address");
        }
        let none = super::super::testing::app(idle());
        let page = none.page("/console/confirm/handOver").await;
        assert!(
            page.contains("No mission is under way") && !page.contains("<form method=\"post\" action=\"./console/handOver"),
            "{page}"
        );
    }

    #[tokio::test]
    async fn the_note_that_was_typed_goes_on_with_the_question_and_is_never_markup() {
        let app = app(searching());
        let asked = text(app.get("/console/confirm/danger/3?id=3&note=%3Cb%3E+red%0D%0Abag").await).await;
        assert!(asked.contains("name=\"note\" value=\"&#60;b&#62; red bag\"") && !asked.contains("<b> red"), "{asked}");
        let endless = app.get(&format!("/console/confirm/danger/3?note={}", "x".repeat(501))).await;
        assert_eq!(endless.status(), 422);
        assert!(text(endless).await.contains("id=\"why-verdict\" role=\"alert\">the note has 501 characters: the limit is 500"));
        assert_eq!(app.form("/console/danger", "id=3&note=%3Cb%3E+red%0D%0Abag").await.status(), 303);
        let (luggage, note) = (LuggageRef::Id(LuggageId(3)), Note::new("<b> red bag"));
        assert_eq!(app.last().command, Command::Verdict { luggage, verdict: Verdict::Danger, note, hot: Default::default() });
    }

    #[tokio::test]
    async fn the_script_gets_json_from_the_same_forms() {
        let app = app(searching());
        let headers = [FORM, ("accept", "application/json")];
        let (status, json) = read(app.send("POST", "/console/backHome", &headers, "epoch=1").await).await;
        assert_eq!((status.as_u16(), &json["accepted"]), (200, &true.into()));
        app.refuse(Refused::Driving);
        let (status, json) = read(app.send("POST", "/console/start", &headers, "epoch=1").await).await;
        assert_eq!((status.as_u16(), &json["code"]), (409, &"driving".into()));
    }

    #[tokio::test]
    async fn stop_reads_nothing_of_what_was_sent() {
        let app = app(searching());
        let response = app.send("POST", "/console/stop", &[("content-type", "image/png")], "garbage").await;
        assert_eq!((response.status().as_u16(), app.last().command), (303, Command::Stop));
    }

    #[tokio::test]
    async fn the_old_routes_answer_programs_in_json_and_browsers_with_the_page() {
        let app = app(searching());
        let (status, json) = read(app.send("POST", "/w", &[], "").await).await;
        assert_eq!((status.as_u16(), &json["accepted"]), (200, &true.into()));
        let browser = [FORM, ("accept", "text/html,*/*;q=0.8")];
        assert_eq!(app.send("POST", "/startappl", &browser, "x=1").await.status(), 303);
        app.refuse(Refused::NothingPending);
        let response = app.send("POST", "/safe", &browser, "").await;
        assert_eq!(response.status(), 409);
        assert!(text(response).await.contains("no luggage waits for a verdict"));
        assert_eq!(app.get("/w").await.status(), 405, "nothing changes state on GET");
    }

    #[tokio::test]
    async fn a_page_of_another_origin_may_not_press_buttons() {
        let app = app(searching());
        let foreign = [FORM, ("origin", "http://elsewhere.example"), ("host", "127.0.0.1:8080")];
        assert_eq!(app.send("POST", "/console/danger", &foreign, "id=3").await.status(), 403);
        assert!(app.given.lock().unwrap().is_empty());
    }
}
