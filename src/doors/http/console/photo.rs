//! The page of one photo: as large as the window lets it, with STOP beside it. Whoever opens a photo by itself comes here.

use askama::Template;
use axum::extract::State;
use axum::response::Html;

use super::super::HttpDoor;
use super::super::problem::Problem;
use super::super::reading::Number;
use super::super::reads::record;
use super::html;
use super::view::{failure, place};
use crate::api::luggage::photo_url;
use crate::api::time::Zone;
use hallsweep_core::units::WallTime;
use hallsweep_core::world::luggage::Luggage;

/// `GET luggage/{id}`
pub(in crate::doors::http) async fn page(State(door): State<HttpDoor>, Number(id): Number) -> Result<Html<String>, Problem> {
    let luggage = record(&door, &door.handle.snapshot(), id).await?;
    Ok(html(&PhotoPage { luggage: &luggage, photo: photo_url(&luggage), zone: Zone::of(door.clock.now().wall) }))
}

#[derive(Template)]
#[template(path = "photo.html")]
struct PhotoPage<'a> {
    luggage: &'a Luggage,
    photo: Option<String>,
    zone: Zone,
}

impl PhotoPage<'_> {
    fn time(&self, wall: &WallTime) -> String {
        self.zone.date_and_time(*wall)
    }

    fn at(&self) -> String {
        place(self.luggage.cell)
    }

    fn failure(&self) -> &str {
        failure(self.luggage)
    }
}
