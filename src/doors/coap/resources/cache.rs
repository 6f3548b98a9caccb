//! Caches representations until they change. So a repeated GET renders nothing again, and all observers of a resource
//! share one body. `shows` makes the contents.

use std::sync::{Arc, Mutex, PoisonError};

use hashlink::LinkedHashMap;

use super::etag::tag;
use super::shows;
use super::table::Show;
use coap_endpoint::{Answer, Format, Response};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Revision;

/// Maximum number of cached representations. This covers every resource in every format, and a few dozen pieces of
/// luggage. When the cache is full, the oldest representation is dropped.
const MOST: usize = 128;

#[derive(Default)]
pub(super) struct RepresentationCache(Mutex<LinkedHashMap<Key, (Revision, Copies)>>);

type Key = (Show, u64, Format);

#[derive(Clone, Debug)]
pub(super) struct Copies {
    /// The answer to a GET. It expires at once (Max-Age 0). With its tag a client can check cheaply whether it is
    /// still valid.
    pub(super) plain: Arc<Response>,
    /// The answer for observers. It is valid until the next notification.
    pub(super) watched: Arc<Response>,
}

impl Copies {
    fn new(response: Response) -> Copies {
        let plain = Response { max_age: Some(0), ..response.clone() };
        Copies { plain: Arc::new(plain), watched: Arc::new(response) }
    }

    pub(super) fn answer(self) -> Answer {
        Answer { response: self.plain, observed: vec![self.watched] }
    }
}

impl RepresentationCache {
    /// Returns the cached representation, or makes it anew if it has changed. `number` is the number in the path, or
    /// the number of an item for old clients.
    pub(super) fn copies(&self, show: Show, number: u64, format: Format, snapshot: &Snapshot) -> Copies {
        let (key, revision) = ((show, number, format), shows::revision(show, number, snapshot));
        let mut things = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, copies)) = things.get(&key).filter(|(made_at, _)| *made_at == revision) {
            return copies.clone();
        }
        let tag = tag(&[snapshot.run.as_bytes(), &number.to_be_bytes(), &revision.0.to_be_bytes(), &format.0.to_be_bytes()]);
        let body = shows::body(show, number, format, snapshot);
        let copies = Copies::new(Response { tag: Some(tag), ..Response::content(format, body) });
        things.insert(key, (revision, copies.clone()));
        if things.len() > MOST {
            things.pop_front();
        }
        copies
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::resources::ResourceKind;
    use crate::api::tests::fixture::{searching, touch};
    use hallsweep_core::world::resource::Resource;

    const TEMPERATURE: Show = Show::Resource(ResourceKind::Of(Resource::Temperature));

    #[test]
    fn what_has_not_changed_is_not_made_anew() {
        let (cache, mut state) = (RepresentationCache::default(), searching());
        let first = cache.copies(TEMPERATURE, 0, Format::JSON, &state);
        touch(&mut state, 21, &[Resource::Robot]);
        let again = cache.copies(TEMPERATURE, 0, Format::JSON, &state);
        assert!(Arc::ptr_eq(&first.plain, &again.plain) && Arc::ptr_eq(&first.watched, &again.watched));
        assert!(Arc::ptr_eq(&first.plain.body, &first.watched.body), "both share the body");
        touch(&mut state, 22, &[Resource::Temperature]);
        let newer = cache.copies(TEMPERATURE, 0, Format::JSON, &state);
        assert_ne!(newer.plain.tag, first.plain.tag);
    }

    #[test]
    fn a_tag_tells_runs_revisions_and_formats_apart() {
        let (cache, state) = (RepresentationCache::default(), searching());
        let tag_in =
            |format, state: &Snapshot| RepresentationCache::default().copies(TEMPERATURE, 0, format, state).plain.tag.unwrap();
        let json = cache.copies(TEMPERATURE, 0, Format::JSON, &state).plain.tag.unwrap();
        assert_eq!(tag_in(Format::JSON, &state), json, "and is the same for the same");
        assert_ne!(tag_in(Format::CBOR, &state), json);
        let other_run = Snapshot { run: Arc::from("t-2"), ..searching() };
        assert_ne!(tag_in(Format::JSON, &other_run), json);
    }

    /// Safety A5.
    #[test]
    fn no_number_of_things_that_are_asked_for_fills_the_memory() {
        let (cache, state) = (RepresentationCache::default(), searching());
        let last = 10 * u16::try_from(MOST).unwrap();
        let latest: Vec<Copies> =
            (0..=last).map(|format| cache.copies(Show::Resource(ResourceKind::Piece), 3, Format(format), &state)).collect();
        assert_eq!(cache.0.lock().unwrap().len(), MOST, "the others are kept when one gives way");
        let before = cache.copies(Show::Resource(ResourceKind::Piece), 3, Format(last - 1), &state);
        assert!(Arc::ptr_eq(&before.plain, &latest[usize::from(last) - 1].plain));
    }
}
