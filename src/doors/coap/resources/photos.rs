//! Reads photos from the archive, where blocking is allowed. The last photos are cached, because a client that
//! fetches a photo in small blocks requests it a thousand times. The tag of a photo stays the same after a restart.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::etag;
use super::problem::{Problem, words};
use crate::runtime::archive_reader::ArchiveReader;
use coap_endpoint::{Answer, ETag, Format, Request, Response};
use hallsweep_core::event::Photo;
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::{Luggage, NoPhoto};

/// Maximum size of all cached photos in bytes: some eighty photos of the simulated camera. The newest photo is cached
/// even if it is larger.
const MOST_BYTES: usize = 4 * 1024 * 1024;

/// The cached photos, in the order in which they were read, the newest last.
#[derive(Default)]
pub(super) struct Photos(Mutex<VecDeque<One>>);

struct One {
    id: LuggageId,
    /// Whether the photo's mission was over when the photo was read. After that the photo cannot be retaken.
    is_settled: bool,
    response: Arc<Response>,
}

impl Photos {
    /// Returns the cached photo of a piece. For a piece of the present mission, `present` is the current tag of its
    /// photo. For an older piece it is `None`.
    pub(super) fn kept(&self, id: LuggageId, present: Option<ETag>) -> Option<Arc<Response>> {
        let photos = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = |one: &&One| one.id == id && present.map_or(one.is_settled, |tag| one.response.tag == Some(tag));
        photos.iter().find(is_it).map(|one| Arc::clone(&one.response))
    }

    /// Caches a photo, and replaces an earlier one of the same piece. Beyond `MOST_BYTES` the oldest photos are
    /// dropped.
    pub(super) fn keep(&self, id: LuggageId, is_settled: bool, response: Response) -> Arc<Response> {
        let response = Arc::new(response);
        let mut photos = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        photos.retain(|one| one.id != id);
        photos.push_back(One { id, is_settled, response: Arc::clone(&response) });
        while photos.len() > 1 && photos.iter().map(|one| one.response.body.len()).sum::<usize>() > MOST_BYTES {
            photos.pop_front();
        }
        response
    }
}

pub(super) fn tag(piece: &Luggage) -> ETag {
    let take = piece.take().unwrap_or(0);
    etag::tag(&[&piece.id.0.to_be_bytes(), &take.to_be_bytes(), &piece.taken.unix_ms.to_be_bytes()])
}

pub(super) fn tag_of_photo(piece: &Luggage) -> Result<ETag, Problem> {
    piece.take()?;
    Ok(tag(piece))
}

/// Returns a photo with its own content format, or as plain bytes if the client asks for bytes. Some clients cannot
/// accept an unknown format, and many do not know any picture format.
pub(super) fn labelled(photo: Arc<Response>, request: &Request) -> Result<Answer, Problem> {
    let offers: Vec<Format> = photo.format.into_iter().chain([Format::BYTES]).collect();
    let wanted = request.negotiated(&offers).map_err(|response| Problem::not_acceptable(words(&response)))?;
    let is_so = photo.format == Some(wanted);
    let response = if is_so { photo } else { Arc::new(Response { format: Some(wanted), ..(*photo).clone() }) };
    Ok(Answer { response, observed: Vec::new() })
}

/// Reads a photo. If no tag is given, the piece's record is read first to compute the tag.
pub(super) async fn read(archive: &ArchiveReader, id: LuggageId, present: Option<ETag>) -> Result<Response, Problem> {
    let tag = match present {
        Some(tag) => tag,
        None => {
            let piece = archive.look_up(move |archive| archive.luggage(id)).await?;
            tag_of_photo(&piece.ok_or_else(|| Problem::no_luggage(id.0))?)?
        }
    };
    let photo = archive.look_up(move |archive| archive.photo(id)).await?;
    let Photo { bytes, media_type } = photo.ok_or(NoPhoto::NotKept(id))?;
    let format = if media_type == "image/png" { Format::PNG } else { Format::BYTES };
    Ok(Response { tag: Some(tag), max_age: Some(0), ..Response::content(format, bytes) })
}

#[cfg(test)]
mod tests {
    use super::super::testing::get;
    use super::*;
    use crate::api::tests::fixture::piece;
    use hallsweep_core::units::Cell;
    use hallsweep_core::world::luggage::PhotoState;

    fn photo(bytes: usize, tag: ETag) -> Response {
        Response { tag: Some(tag), ..Response::content(Format::PNG, vec![0; bytes]) }
    }

    #[test]
    fn a_tag_is_the_same_after_a_restart_and_another_after_a_retake() {
        let first = piece(3, Cell::new(3, 2), None);
        assert_eq!(tag(&first), tag(&piece(3, Cell::new(3, 2), None)));
        let again = Luggage { photo: PhotoState::Taken { bytes: 4, take: 2 }, ..(*first).clone() };
        assert_ne!(tag(&first), tag(&again));
        assert_eq!(
            tag(&first).bytes(),
            [90, 135, 182, 140, 229, 163, 60, 36],
            "written down, so that a release that changes it is noticed"
        );
    }

    #[test]
    fn a_photo_that_was_taken_again_is_read_again() {
        let (photos, id) = (Photos::default(), LuggageId(3));
        let (old, new) = (etag::tag(&[b"1"]), etag::tag(&[b"2"]));
        photos.keep(id, false, photo(4, old));
        assert!(photos.kept(id, Some(old)).is_some() && photos.kept(id, Some(new)).is_none());
        assert!(photos.kept(id, None).is_none(), "it may have been taken again before its mission was put away");
        photos.keep(id, true, photo(4, new));
        assert!(photos.kept(id, None).is_some());
    }

    #[test]
    fn a_photo_is_plain_bytes_for_whoever_wants_these() {
        let picture = Arc::new(photo(4, etag::tag(&[b"t"])));
        let wanted = |photo: &Arc<Response>, accept| {
            labelled(Arc::clone(photo), &Request { accept, ..get("/luggage/3/photo") }).map(|answer| answer.response)
        };
        let bytes = wanted(&picture, Some(Format::BYTES)).unwrap();
        assert_eq!((bytes.format, bytes.tag), (Some(Format::BYTES), picture.tag));
        assert!(Arc::ptr_eq(&bytes.body, &picture.body), "and nothing is copied");
        for as_it_is in [None, Some(Format::PNG)] {
            assert!(Arc::ptr_eq(&wanted(&picture, as_it_is).unwrap(), &picture));
        }
        let other = Arc::new(Response { format: Some(Format::BYTES), ..(*picture).clone() });
        assert_eq!(wanted(&other, None).unwrap().format, Some(Format::BYTES));
        let problem = wanted(&other, Some(Format::PNG)).unwrap_err();
        assert_eq!(problem.code(), "notAcceptable", "what is no PNG is not sent as one, nor as something else");
    }

    /// Safety A5.
    #[test]
    fn only_the_last_photos_are_kept_and_the_last_one_always() {
        let photos = Photos::default();
        for id in 0..20 {
            photos.keep(LuggageId(id), true, photo(MOST_BYTES / 4, etag::tag(&[b"t"])));
        }
        let ids: Vec<u64> = (0..20).filter(|id| photos.kept(LuggageId(*id), None).is_some()).collect();
        assert_eq!(ids, [16, 17, 18, 19]);
        photos.keep(LuggageId(99), true, photo(2 * MOST_BYTES, etag::tag(&[b"t"])));
        assert!(photos.kept(LuggageId(99), None).is_some() && photos.kept(LuggageId(19), None).is_none());
    }
}
