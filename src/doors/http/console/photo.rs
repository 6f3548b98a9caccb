//! The page of one photo, which is as large as the window allows. The page also has the STOP button, and the other
//! photos of the same piece. A browser that opens the address of a photo directly is redirected to this page.

use askama::Template;
use axum::response::Html;

use super::super::HttpDoor;
use super::super::language::Spoken;
use super::super::problem::Problem;
use super::super::query::Query;
use super::super::reading::Number;
use super::super::reads::{asked_take, record, taken};
use super::html;
use super::view::failure;
use crate::api::luggage::take_url;
use crate::api::time::Zone;
use crate::phrases::{Language, Phrase};
use hallsweep_core::units::{LuggageId, WallTime};
use hallsweep_core::world::luggage::Luggage;

/// Maximum number of photos of one piece shown side by side. They are the latest ones. An older photo can be
/// requested by its number.
const SHOWN: u32 = 12;

/// `GET luggage/{id}`: the page of the newest photo. With a query such as `?take=1`, the page of an earlier photo.
pub(in crate::doors::http) async fn page(
    door: HttpDoor,
    Spoken(language): Spoken,
    Number(id): Number,
    query: Query,
) -> Result<Html<String>, Problem> {
    let asked = asked_take(&query)?;
    let snapshot = door.hall.handle.snapshot();
    let luggage = record(&door, &snapshot, id).await?;
    let take = if luggage.has_photo() || asked.is_some() { Some(taken(&luggage, asked)?) } else { None };
    let pieces = snapshot.luggage.iter().map(|piece| piece.id).collect();
    Ok(html(&PhotoPage { language, luggage: &luggage, pieces, take, zone: Zone::of(door.process.clock.now().wall) }))
}

pub(super) struct Take {
    pub(super) take: u32,
    pub(super) url: String,
}

pub(super) fn takes(luggage: &Luggage) -> Vec<Take> {
    let newest = luggage.take().unwrap_or(0);
    let shown = newest.saturating_sub(SHOWN) + 1..=newest;
    shown.map(|take| Take { take, url: take_url(luggage.id, take) }).collect()
}

#[derive(Template)]
#[template(path = "photo.html")]
struct PhotoPage<'a> {
    language: Language,
    luggage: &'a Luggage,
    /// The pieces of the present mission.
    pieces: Vec<LuggageId>,
    /// Number of the shown photo, counted from 1. `None` when the piece has no photo.
    take: Option<u32>,
    zone: Zone,
}

impl PhotoPage<'_> {
    /// Returns the pieces before and after this one, each with the phrase of its link.
    fn beside(&self) -> Vec<(LuggageId, &'static str)> {
        let Some(place) = self.pieces.iter().position(|id| *id == self.luggage.id) else { return Vec::new() };
        let at = |place: Option<usize>, name| Some((*self.pieces.get(place?)?, name));
        [at(place.checked_sub(1), "photo-before"), at(place.checked_add(1), "photo-after")].into_iter().flatten().collect()
    }

    fn alt(&self, take: &u32) -> Phrase<'static> {
        let newest = self.luggage.take().unwrap_or(*take);
        let said = match (newest, *take) {
            (1, _) => self.language.say("photo-of"),
            (newest, take) if take == newest => self.language.say("photo-of-newest"),
            _ => self.language.say("photo-of-earlier"),
        };
        said.with("id", self.luggage.id).with("take", take).with("newest", newest)
    }

    fn found(&self) -> Phrase<'static> {
        let Luggage { cell, verdict, .. } = self.luggage;
        let said = match verdict {
            None => self.language.say("photo-found"),
            Some(decision) => {
                let decided = self.language.say("photo-decided").with("decided", self.time(decision.wall));
                decided.with("who", &decision.who)
            }
        };
        said.with("column", cell.x).with("row", cell.y).with("found", self.time(self.luggage.waits_since()))
    }

    fn time(&self, wall: WallTime) -> String {
        self.language.date(&self.zone.date_and_time(wall))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::super::testing::app;
    use super::*;
    use crate::api::tests::fixture::searching;
    use hallsweep_core::world::luggage::PhotoState;

    #[tokio::test]
    async fn who_reads_italian_reads_of_a_photo_in_italian() {
        let mut snapshot = searching();
        let photographed = |index: usize, photo| Arc::new(Luggage { photo, ..(*snapshot.luggage[index]).clone() });
        let pieces =
            [photographed(0, PhotoState::Failed("no light".into())), photographed(2, PhotoState::Taken { bytes: 1, take: 3 })];
        for piece in pieces {
            snapshot.luggage.insert(piece);
        }
        let app = app(snapshot);
        for (path, wanted) in [
            ("/luggage/1", ["Bagaglio #1", "Non c'è nessuna foto: no light.", "verdetto è stato dato il ", " da operator."]),
            (
                "/luggage/2",
                [
                    "<span class=\"verdict\">pericoloso</span>",
                    "alla colonna 1, riga 2",
                    "Foto del bagaglio #2",
                    "</svg>Operazioni</a>",
                ],
            ),
            ("/luggage/3", ["Foto 3 di 3 del bagaglio #3, la più recente", "Tutte le foto di", ">foto 2</a>", "la foto intera"]),
            (
                "/luggage/3?take=1",
                ["Foto 1 di 3 del bagaglio #3, precedente", "da decidere", "Gli orari sono in UTC", "Più piccola"],
            ),
        ] {
            let page = app.italian("GET", path, "", &[], &[]).await.replace("&#39;", "'");
            for wanted in wanted {
                assert!(page.contains(wanted), "{wanted} in {page}");
            }
        }
    }

    #[tokio::test]
    async fn where_a_piece_is_and_what_was_decided_of_it_is_one_sentence() {
        let app = app(searching());
        let page = app.page("/luggage/2").await;
        assert!(page.contains("> The bag was found at column 1, row 2 on ") && page.contains(" by operator. <span"), "{page}");
        assert!(!app.page("/luggage/3").await.contains("the verdict was given"));
        let beside = |id| format!("<a href=\"./luggage/{id}\">");
        assert!(page.contains(&beside(1)) && page.contains(&beside(3)), "it leads to the pieces before and after it: {page}");
    }

    #[tokio::test]
    async fn a_piece_was_found_when_its_first_photo_was_taken() {
        let at = |unix_ms| WallTime { unix_ms, offset_s: 0 };
        let mut snapshot = searching();
        let (first_taken, taken) = (at(1_000_000_000_000), at(1_100_000_000_000));
        let retaken = Luggage { first_taken, taken, ..(*snapshot.luggage[2]).clone() };
        snapshot.luggage.insert(Arc::new(retaken));
        let page = app(snapshot).page("/luggage/3").await;
        assert!(page.contains("on 9 Sep 2001") && !page.contains("2004"), "{page}");
    }
}
