//! The page of one photo: as large as the window lets it, with STOP beside it, and the other photos of the same piece. Whoever opens a
//! photo by itself comes here.

use askama::Template;
use axum::extract::State;
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
use crate::phrases::Language;
use hallsweep_core::units::WallTime;
use hallsweep_core::world::luggage::Luggage;

/// So many photos of one piece are shown beside each other: the latest. Whoever wants an older one names it.
const SHOWN: u32 = 12;

/// `GET luggage/{id}` and `GET luggage/{id}?take=1`
pub(in crate::doors::http) async fn page(
    State(door): State<HttpDoor>,
    Spoken(language): Spoken,
    Number(id): Number,
    query: Query,
) -> Result<Html<String>, Problem> {
    let asked = asked_take(&query)?;
    let luggage = record(&door, &door.handle.snapshot(), id).await?;
    let take = if luggage.has_photo() || asked.is_some() { Some(taken(&luggage, asked)?) } else { None };
    Ok(html(&PhotoPage { language, luggage: &luggage, take, zone: Zone::of(door.clock.now().wall) }))
}

/// One photo of a piece.
pub(super) struct Take {
    pub(super) take: u32,
    pub(super) url: String,
}

/// The latest photos of a piece, the first of them first.
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
    /// Which of its photos is shown; `None` where there is none.
    take: Option<u32>,
    zone: Zone,
}

impl PhotoPage<'_> {
    fn url(&self, take: &u32) -> String {
        take_url(self.luggage.id, *take)
    }

    /// What is to be seen, for those who listen.
    fn alt(&self, take: &u32) -> String {
        let (id, newest) = (self.luggage.id, self.luggage.take().unwrap_or(*take));
        match (newest, *take) {
            (1, _) => format!("Photo of luggage #{id}"),
            (newest, take) if take == newest => format!("Photo {take} of {newest} of luggage #{id}, the newest"),
            (newest, take) => format!("Photo {take} of {newest} of luggage #{id}, an earlier one"),
        }
    }

    fn takes(&self) -> Vec<Take> {
        takes(self.luggage)
    }

    fn is_shown(&self, take: &Take) -> bool {
        self.take == Some(take.take)
    }

    fn time(&self, wall: &WallTime) -> String {
        self.zone.date_and_time(*wall)
    }

    fn at(&self) -> String {
        self.language.place(self.luggage.cell)
    }

    fn failure(&self) -> &str {
        failure(self.luggage)
    }
}
