//! The named areas of the hall: their list in the order of the search, their outlines on the picture, and the page that
//! closes one.

use askama::Template;

use super::drawing::{CELL, larger, middle, write};
use super::timeline::escaped;
use super::view::View;
use crate::phrases::Language;
use hallsweep_core::closing::OpenInArea;
use hallsweep_core::command::Note;
use hallsweep_core::snapshot::searched::Searched;
use hallsweep_core::snapshot::{AreaView, Snapshot};
use hallsweep_core::units::{Bounds, Cell, MissionId};
use hallsweep_core::world::areas::Area;

#[derive(Template)]
#[template(path = "console/closing_area.html")]
pub(super) struct CloseArea {
    language: Language,
    mission: MissionId,
    area: String,
    /// What is open in the area, and how far it was searched; `None` if it cannot be closed.
    found: Option<(OpenInArea, [String; 7])>,
    /// Why the area could not be closed; empty before.
    why: String,
    name: String,
    note: String,
}

impl CloseArea {
    pub(super) fn new(
        language: Language,
        snapshot: &Snapshot,
        area: String,
        why: String,
        [name, note]: [String; 2],
    ) -> CloseArea {
        let found = open_in(snapshot, &area).map(|(area, open)| {
            let searched = Searched::of(area, &snapshot.map, &snapshot.coverage, snapshot.venue.sensor);
            (open, language.coverage_row(&area.name, Some(area.probability), &searched))
        });
        CloseArea { language, mission: snapshot.mission.id, area, found, why, name, note }
    }
}

fn open_in<'s>(snapshot: &'s Snapshot, name: &str) -> Option<(&'s Area, OpenInArea)> {
    let mission = &snapshot.mission;
    let can_be_closed = |view: &&AreaView| *view.area.name == *name && view.closed.is_none() && mission.is_under_way();
    let AreaView { area, .. } = mission.areas.iter().find(can_be_closed)?;
    Some((area, area.open(&snapshot.map, &mission.again, &snapshot.luggage)))
}

/// Whether more is open in the area than the page has shown when it was made. Less is open all the time while the robot
/// searches, and needs no second look.
pub(super) fn has_more_open(snapshot: &Snapshot, area: &str, shown: &str) -> bool {
    let shown = shown.split_once(',').and_then(|(cells, pending)| Some((cells.parse().ok()?, pending.parse().ok()?)));
    let is_shown = |open: OpenInArea| shown.is_some_and(|(cells, pending)| open.cells <= cells && open.pending <= pending);
    open_in(snapshot, area).is_some_and(|(_, open)| !is_shown(open))
}

/// Draws the outlines of the areas with their names. The line of a polygon goes through the middles of its corners.
pub(super) fn outlines(v: &View<'_>) -> String {
    let mut group = String::from("<g id=\"hall-areas\">");
    let size = larger(&v.snapshot.map);
    for AreaView { area, order, closed } in v.snapshot.mission.areas.iter() {
        let class = if closed.is_some() { "area closed" } else { "area" };
        let ((x, y), d) = if let [one, other] = *area.corners {
            let Bounds { least, most } = Bounds::of(one).including(other);
            let (width, height) = ((most.x - least.x + 1) * CELL - 2, (most.y - least.y + 1) * CELL - 2);
            let corner = (least.x * CELL, least.y * CELL);
            (corner, format!("M{} {}h{width}v{height}h-{width}z", least.x * CELL + 1, least.y * CELL + 1))
        } else {
            let points: Vec<String> =
                area.corners.iter().map(|corner| middle(*corner)).map(|(x, y)| format!("{x} {y}")).collect();
            let first = area.corners.iter().min_by_key(|corner| (corner.y, corner.x)).copied();
            (middle(first.unwrap_or(Cell::HOME)), format!("M{}z", points.join("L")))
        };
        let place = order.map(|place| format!("{place}. ")).unwrap_or_default();
        let closed = closed.as_ref().map(|_| format!(" ({})", v.say("area-closed"))).unwrap_or_default();
        let name = escaped(&area.name);
        let at = format_args!("transform=\"translate({x} {y}) scale({size})\" x=\"2\" y=\"6\"");
        write(
            &mut group,
            format_args!("<path class=\"{class}\" d=\"{d}\"/><text class=\"area-name\" {at}>{place}{name}{closed}</text>"),
        );
    }
    group.push_str("</g>");
    group
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::super::testing::{app, leads, text};
    use super::*;
    use crate::api::tests::fixture::{TEN, searching};
    use hallsweep_core::closing::{AreaClosing, Closed};
    use hallsweep_core::command::{Again, Command};
    use hallsweep_core::refused::Refused;

    /// Two rectangles and a triangle. A person wants the second area first, and has closed the third.
    fn with_areas() -> Snapshot {
        let mut snapshot = searching();
        let view = |name: &str, probability: f64, corners: &[(i32, i32)], order: Option<usize>| {
            let corners = corners.iter().map(|(x, y)| Cell::new(*x, *y)).collect();
            AreaView { area: Area { name: name.into(), probability, corners }, order, closed: None }
        };
        let mut closed = view("bar & <b>", 0.125, &[(0, 4), (2, 4), (2, 6)], None);
        let (name, note) = (Note::new("Rossi <i>").unwrap(), Note::new("dogs were there"));
        closed.closed =
            Some(Closed { who: "operator".into(), name, note, open: OpenInArea { cells: 12, pending: 1 }, wall: TEN });
        let areas = [view("hall", 0.1, &[(0, 0), (1, 2)], None), view("gate 2", 0.05, &[(90, 3), (60, 0)], Some(1)), closed];
        snapshot.mission.areas = Arc::new(areas);
        snapshot
    }

    /// The forms of the rows by the names of their buttons.
    fn buttons(page: &str, name: &str) -> Vec<String> {
        page.split(&format!("name=\"{name}\" value=\"")).skip(1).map(|rest| rest.split('"').next().unwrap().to_owned()).collect()
    }

    #[tokio::test]
    async fn the_list_has_the_areas_in_the_order_of_the_search() {
        let page = app(with_areas()).page("/").await;
        let names = ["gate 2", "bar &#38; &#60;b&#62;", "hall"];
        assert_eq!([buttons(&page, "earlier"), buttons(&page, "later"), buttons(&page, "area")], [names; 3], "{page}");
        assert!(page.contains("name=\"areas\" value=\"gate 2\nbar &#38; &#60;b&#62;\nhall\""), "{page}");
        let words = [
            "12.5 %",
            "closed by Rossi &#60;i&#62; at",
            "cells not searched: 12, pieces without a verdict: 1",
            "dogs were there",
        ];
        assert!(words.iter().all(|words| page.contains(words)), "{page}");
        let links: Vec<&str> =
            page.split("confirm/closeArea?area=").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert_eq!(links, ["gate%202", "hall"], "a closed area is not closed again");
        let mut none = with_areas();
        none.mission.areas = Arc::default();
        assert!(!app(none).page("/").await.contains("orderAreas"), "a hall without areas has no list");
        app(with_areas())
            .italian(
                "GET",
                "/",
                "",
                &[],
                &[
                    "gate 2",
                    "bar &#38; &#60;b&#62;",
                    "hall",
                    "Rossi",
                    "dogs were there",
                    "airport",
                    "LED",
                    "OK",
                    "Robot",
                    "robot",
                    "Sonar",
                    "sonar",
                    "rev",
                    "hallsweep ·",
                    "42 cm",
                    ": luggage #2 is dangerous.",
                    "exploration began",
                    "luggage #2 is dangerous",
                    "luggage #3 found at (3, 2)",
                ],
            )
            .await;
    }

    #[tokio::test]
    async fn the_picture_has_their_outlines_and_names_before_anything_is_known_there() {
        let page = app(with_areas()).page("/").await;
        let (_, drawn) = page.split_once("<g id=\"hall-areas\">").expect("there are areas");
        let drawn = drawn.split_once("</g>").unwrap().0;
        let paths: Vec<&str> = drawn.split("<path ").skip(1).map(|rest| rest.split("/>").next().unwrap()).collect();
        assert_eq!(
            paths,
            [
                "class=\"area\" d=\"M1 1h18v28h-18z\"",
                "class=\"area\" d=\"M601 1h308v38h-308z\"",
                "class=\"area closed\" d=\"M5 45L25 45L25 65z\"",
            ]
        );
        assert!(drawn.contains(">1. gate 2</text>") && drawn.contains(">bar &#38; &#60;b&#62; (closed)</text>"), "{drawn}");
        let (_, view_box) = page.split_once("viewBox=\"").expect("there is a picture");
        let numbers: Vec<i32> = view_box.split('"').next().unwrap().split(' ').map(|number| number.parse().unwrap()).collect();
        assert!(numbers[0] + numbers[2] >= 910, "the far area is in the picture: {numbers:?}");
    }

    #[tokio::test]
    async fn the_buttons_of_a_row_order_and_search_again() {
        let app = app(with_areas());
        let areas = "epoch=1&areas=gate+2%0D%0Abar+%26+%3Cb%3E%0D%0Ahall";
        for (button, expect) in [
            ("earlier=hall", ["gate 2", "hall", "bar & <b>"]),
            ("later=gate+2", ["bar & <b>", "gate 2", "hall"]),
            ("later=hall", ["gate 2", "bar & <b>", "hall"]),
            ("earlier=gate+2", ["gate 2", "bar & <b>", "hall"]),
        ] {
            assert_eq!(app.form("/console/orderAreas", &format!("{areas}&{button}")).await.status(), 303, "{button}");
            assert_eq!(app.last().command, Command::OrderAreas(expect.map(Into::into).into()), "{button}");
        }
        app.form("/console/orderAreas", "areas=").await;
        assert_eq!(app.last().command, Command::OrderAreas([].into()), "the order is left to the search");
        assert_eq!(app.form("/console/searchAgain", &format!("{areas}&area=hall")).await.status(), 303);
        assert_eq!(app.last().command, Command::SearchAgain(Again::Area("hall".into())));
        app.refuse(Refused::UnknownArea("hall".into()));
        let refused = app.form("/console/orderAreas", areas).await;
        assert_eq!(refused.status(), 404);
        let page = text(refused).await;
        assert!(page.contains("id=\"why-areas\" role=\"alert\">the hall has no area"), "{page}");
        for wrong in ["", "areas=a%0D%0Aa", "areas=a%07", "areas=a&areas=b"] {
            assert_eq!(app.form("/console/orderAreas", wrong).await.status(), 422, "{wrong}");
        }
    }

    /// A refusal stands on the page of the form, with what was typed.
    #[tokio::test]
    async fn an_area_is_closed_on_a_page_that_says_what_is_open() {
        let snapshot = with_areas();
        let open = snapshot.mission.areas[0].area.open(&snapshot.map, &snapshot.mission.again, &snapshot.luggage);
        let app = app(snapshot);
        let page = app.page("/console/confirm/closeArea?area=hall").await;
        let said = format!("<b>cells not searched: {}, pieces without a verdict: {}</b>", open.cells, open.pending);
        assert!(page.contains(&said) && page.contains("name=\"area\" value=\"hall\""), "{said} {page}");
        assert!(app.given.lock().unwrap().is_empty(), "looking changes nothing");
        let seen = format!("{},{}", open.cells, open.pending);
        assert!(page.contains(&format!("name=\"open\" value=\"{seen}\"")), "{page}");
        assert!(page.contains("<dt>Driven</dt><dd>") && page.contains("<dt>Probability of the area</dt><dd>10 %</dd>"), "{page}");
        for fewer in ["0,0", "123,0", "124", ""] {
            let asked = app.form("/console/closeArea", &format!("mission=1&area=gate+2&open={fewer}&name=Anna+%3Cb%3E")).await;
            assert_eq!(asked.status(), 409, "{fewer}");
            let page = text(asked).await;
            assert!(page.contains("role=\"alert\">more is open") && page.contains("value=\"Anna &#60;b&#62;\""), "{page}");
            assert!(page.contains("<b>cells not searched: 124") && app.given.lock().unwrap().is_empty(), "{fewer}: {page}");
        }
        let typed = &format!("mission=1&area=hall&open={seen}&name=Anna+%3Cb%3E&note=with%0Adogs");
        let closed = app.form("/console/closeArea", typed).await;
        assert_eq!((closed.status().as_u16(), &*leads(&closed, "/console/closeArea")), (303, "/?tab=drive#more"));
        let (name, note) = (Note::new("Anna <b>").unwrap(), Note::new("with dogs"));
        let closing = AreaClosing { area: "hall".into(), name, note, mission: Some(MissionId(1)) };
        assert_eq!(app.last().command, Command::CloseArea(closing));
        app.refuse(Refused::StoreDown);
        let refused = app.form("/console/closeArea", typed).await;
        assert_eq!(refused.status(), 503);
        let page = text(refused).await;
        assert!(page.contains("role=\"alert\">the record cannot") && page.contains("value=\"Anna &#60;b&#62;\""), "{page}");
        for nothing in ["?area=bar+%26+%3Cb%3E", "?area=nowhere", "", "?area=%FF"] {
            let page = app.page(&format!("/console/confirm/closeArea{nothing}")).await;
            assert!(
                page.contains("This area cannot be closed now") && !page.contains("./console/closeArea"),
                "{nothing}: {page}"
            );
        }
        app.italian("GET", "/console/confirm/closeArea?area=hall", "", &[], &["hall", "hallsweep ·"]).await;
    }
}
