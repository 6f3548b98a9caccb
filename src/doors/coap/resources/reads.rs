//! Answers reads: returns the representation at once, or after reading the archive. Also returns the representations
//! for observers. `cache` and `photos` cache the representations.

use std::sync::Arc;

use super::super::application::Reply;
use super::problem::{Problem, words};
use super::table::{PathRow, Representations, Show};
use super::{Resources, discovery, photos, shows};
use crate::api::resources::ResourceKind;
use coap_endpoint::{Answer, ETag, Format, Request, Response};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::LuggageId;

impl Resources {
    /// Answers a GET. Whether the thing exists is checked before the format.
    pub(super) fn show(&self, shown: &Representations, number: u64, request: &Request) -> Result<Reply, Problem> {
        let snapshot = self.handle.snapshot();
        if shown.show == Show::Resource(ResourceKind::Photo) {
            return self.photo(&snapshot, number, request);
        }
        if is_past(shown.show, number, &snapshot) {
            return Ok(self.past_piece(number, &shown.formats, request));
        }
        let format = negotiated(&shown.formats, request)?;
        Ok(Reply::Now(self.at_hand(shown.show, number, format, &snapshot, request)))
    }

    fn at_hand(&self, show: Show, number: u64, format: Format, snapshot: &Arc<Snapshot>, request: &Request) -> Answer {
        match show {
            Show::Links if !request.queries.is_empty() => Answer::once(discovery::filtered(snapshot, &request.queries)),
            Show::Links => {
                let whole = self.cache.copies(show, number, format, snapshot).plain;
                Answer { response: whole, observed: Vec::new() }
            }
            Show::OldItems => self.old.answer(snapshot, &self.cache),
            Show::Resource(_) => self.cache.copies(show, number, format, snapshot).answer(),
        }
    }

    pub(super) fn seen(&self, request: &Request) -> Result<Vec<Arc<Response>>, Problem> {
        let found = self.table.find(&request.path).ok_or_else(|| Problem::nothing_at(request))?;
        let shown = found.row.shows.as_ref().filter(|shown| shown.is_observable);
        let shown = shown.ok_or_else(|| Problem::not_answered(request, found.row))?;
        let snapshot = self.handle.snapshot();
        if is_past(shown.show, found.number, &snapshot) {
            return Err(Problem::not_found(format!(
                "luggage #{} belongs to a past mission and does not change: read it without observing it",
                found.number
            )));
        }
        let format = negotiated(&shown.formats, request)?;
        Ok(self.at_hand(shown.show, found.number, format, &snapshot, request).observed)
    }

    pub(super) fn tags(&self, row: &PathRow, number: u64) -> Vec<ETag> {
        let Some(Representations { show, formats, .. }) = &row.shows else { return Vec::new() };
        let snapshot = self.handle.snapshot();
        match show {
            Show::Links => Vec::new(),
            Show::OldItems => self.old.answer(&snapshot, &self.cache).observed.iter().filter_map(|item| item.tag).collect(),
            Show::Resource(ResourceKind::Photo) => {
                snapshot.luggage(LuggageId(number)).map(|piece| photos::tag(piece)).into_iter().collect()
            }
            Show::Resource(_) if is_past(*show, number, &snapshot) => Vec::new(),
            Show::Resource(_) => {
                let copies = |format: &Format| self.cache.copies(*show, number, *format, &snapshot).watched.tag;
                formats.iter().filter_map(copies).collect()
            }
        }
    }

    /// Answers with a piece of a past mission. Such a piece cannot be observed, because it does not change any more.
    fn past_piece(&self, number: u64, formats: &[Format], request: &Request) -> Reply {
        let (archive, formats, request) = (self.archive.clone(), formats.to_vec(), request.clone());
        let found = async move |request: &Request| {
            let read = archive.look_up(move |archive| archive.luggage(LuggageId(number))).await?;
            let piece = read.ok_or_else(|| Problem::no_luggage(number))?;
            let format = negotiated(&formats, request)?;
            Ok(Response::content(format, shows::past_piece(&piece, format)))
        };
        Reply::Later(Box::pin(async move {
            Answer::once(found(&request).await.unwrap_or_else(|problem: Problem| problem.response(&request)))
        }))
    }

    fn photo(&self, snapshot: &Snapshot, number: u64, request: &Request) -> Result<Reply, Problem> {
        let id = LuggageId(number);
        let present = snapshot.luggage(id).map(|piece| photos::tag_of_photo(piece)).transpose()?;
        if let Some(kept) = self.photos.kept(id, present) {
            return photos::labelled(kept, request).map(Reply::Now);
        }
        let (archive, photos, request) = (self.archive.clone(), Arc::clone(&self.photos), request.clone());
        Ok(Reply::Later(Box::pin(async move {
            let read = photos::read(&archive, id, present).await;
            let kept = read.map(|response| photos.keep(id, present.is_none(), response));
            kept.and_then(|photo| photos::labelled(photo, &request))
                .unwrap_or_else(|problem| Answer::once(problem.response(&request)))
        })))
    }
}

fn is_past(show: Show, number: u64, snapshot: &Snapshot) -> bool {
    show == Show::Resource(ResourceKind::Piece) && snapshot.luggage(LuggageId(number)).is_none()
}

fn negotiated(offers: &[Format], request: &Request) -> Result<Format, Problem> {
    request.negotiated(offers).map_err(|response| Problem::not_acceptable(words(&response)))
}
