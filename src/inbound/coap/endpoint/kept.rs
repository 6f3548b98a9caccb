//! Answers to what was done that do not fit into one message. They are kept for a while for whoever reads them block by block,
//! because to read on must not do it again. What only looks needs none of this: the application is asked again.

use std::sync::Arc;
use std::time::Duration;

use hashlink::LinkedHashMap;

use super::block::BodyKey;
use super::exchange::is_over;
use super::limits::ASSEMBLIES;
use super::response::Response;

/// Answers of which the last block may not have been read yet.
#[derive(Debug, Default)]
pub(super) struct Kept(LinkedHashMap<BodyKey, (Duration, Arc<Response>)>);

impl Kept {
    /// How many there are.
    #[must_use]
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// Keeps the answer to a request, in the place of the one to an earlier request of the same peer for the same.
    pub(super) fn keep(&mut self, key: BodyKey, answer: Arc<Response>, now: Duration) {
        self.0.remove(&key);
        self.0.insert(key, (now, answer));
        while self.0.len() > ASSEMBLIES || self.0.front().is_some_and(|(_, (since, _))| is_over(*since, now)) {
            self.0.pop_front();
        }
    }

    /// The answer to be read on.
    #[must_use]
    pub(super) fn find(&self, key: &BodyKey, now: Duration) -> Option<Arc<Response>> {
        self.0.get(key).filter(|(since, _)| !is_over(*since, now)).map(|(_, answer)| Arc::clone(answer))
    }
}

#[cfg(test)]
mod tests {
    use super::super::code::{Code, Method};
    use super::super::limits::EXCHANGE_LIFETIME;
    use super::*;

    fn key(port: u16) -> BodyKey {
        let peer = std::net::SocketAddr::from(([127, 0, 0, 1], port));
        BodyKey { peer, method: Method::Post, path: Vec::new(), queries: Vec::new(), tags: Vec::new() }
    }

    fn answer(words: &str) -> Arc<Response> {
        Arc::new(Response::refusal(Code::CHANGED, words.to_owned()))
    }

    #[test]
    fn the_latest_answer_is_kept_for_its_lifetime() {
        let mut kept = Kept::default();
        kept.keep(key(1), answer("old"), Duration::ZERO);
        kept.keep(key(1), answer("new"), Duration::from_secs(1));
        assert_eq!(kept.find(&key(1), EXCHANGE_LIFETIME), Some(answer("new")));
        assert_eq!(kept.find(&key(1), EXCHANGE_LIFETIME * 2), None);
        assert_eq!(kept.find(&key(2), Duration::ZERO), None);
    }

    #[test]
    fn no_more_answers_are_kept_than_there_is_room_for() {
        let mut kept = Kept::default();
        (0..500).for_each(|port| kept.keep(key(port), answer("x"), Duration::ZERO));
        assert_eq!(kept.count(), ASSEMBLIES);
        kept.keep(key(500), answer("x"), EXCHANGE_LIFETIME * 2);
        assert_eq!(kept.count(), 1, "the old ones are let go");
    }
}
