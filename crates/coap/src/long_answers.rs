//! Answers to commands that do not fit into one message. They are stored for a while so that a client can read the
//! further blocks without having the command carried out again. Answers to reads need no storage: the application is
//! asked again.

use std::sync::Arc;
use std::time::Duration;

use hashlink::LinkedHashMap;

use super::block::{Block, BodyKey};
use super::exchange::is_over;
use super::limits::ASSEMBLIES;
use super::response::Response;

/// Answers whose last block may not have been read yet.
#[derive(Debug, Default)]
pub(super) struct LongAnswers(LinkedHashMap<BodyKey, Answered>);

#[derive(Debug)]
struct Answered {
    since: Duration,
    answer: Arc<Response>,
    /// Where the first unread block begins, in bytes.
    next: usize,
    /// The value of `Exchanges::undone` when the request arrived.
    undone: u64,
}

impl LongAnswers {
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// Stores the answer to a request, in place of an earlier answer under the same key. `block` is the block that is
    /// sent now.
    pub(super) fn keep(&mut self, key: BodyKey, answer: Arc<Response>, block: Block, undone: u64, now: Duration) {
        self.0.remove(&key);
        self.0.insert(key, Answered { since: now, answer, next: end(block), undone });
        while self.0.len() > ASSEMBLIES || self.0.front().is_some_and(|(_, kept)| is_over(kept.since, now)) {
            self.0.pop_front();
        }
    }

    /// Whether the request continues a stored answer, by asking for the block after the last one that was sent.
    /// Returns false if `undone` has changed since the stored answer's request, because the urgent request may have
    /// to act again.
    pub(super) fn is_next(&self, key: &BodyKey, block: Block, undone: u64, now: Duration) -> bool {
        let kept = self.0.get(key).filter(|kept| kept.undone == undone && !is_over(kept.since, now));
        kept.is_some_and(|kept| kept.next == end(block) - block.size() && kept.next < kept.answer.body.len())
    }

    /// Returns the stored answer, or `None` if it is not stored any more. `block` is the block that is sent now.
    pub(super) fn read(&mut self, key: &BodyKey, block: Block, now: Duration) -> Option<Arc<Response>> {
        let kept = self.0.get_mut(key).filter(|kept| !is_over(kept.since, now))?;
        kept.next = end(block);
        Some(Arc::clone(&kept.answer))
    }
}

/// Returns where the next block begins, in bytes. The product cannot overflow: a number has 20 bits and a size 11.
fn end(block: Block) -> usize {
    (block.number as usize + 1) * block.size()
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
        Arc::new(Response::refusal(Code::CHANGED, words))
    }

    #[test]
    fn the_latest_answer_is_kept_for_its_lifetime() {
        let mut answers = LongAnswers::default();
        answers.keep(key(1), answer("old"), Block::FIRST, 0, Duration::ZERO);
        answers.keep(key(1), answer("new"), Block::FIRST, 0, Duration::from_secs(1));
        assert_eq!(answers.read(&key(1), Block::FIRST, EXCHANGE_LIFETIME), Some(answer("new")));
        assert_eq!(answers.read(&key(1), Block::FIRST, EXCHANGE_LIFETIME * 2), None);
        assert_eq!(answers.read(&key(2), Block::FIRST, Duration::ZERO), None);
    }

    #[test]
    fn only_the_block_behind_the_last_one_goes_on_reading() {
        let mut answers = LongAnswers::default();
        let block = |number| Block { number, more: false, exponent: 0 };
        let is_next = |answers: &LongAnswers, number| answers.is_next(&key(1), block(number), 0, Duration::ZERO);
        assert!(!is_next(&answers, 1));
        answers.keep(key(1), answer(&"x".repeat(40)), block(0), 0, Duration::ZERO);
        assert!(is_next(&answers, 1) && !is_next(&answers, 0) && !is_next(&answers, 2));
        assert!(answers.read(&key(1), block(1), Duration::ZERO).is_some());
        assert!(!is_next(&answers, 1) && is_next(&answers, 2));
        assert!(!answers.is_next(&key(1), block(2), 1, Duration::ZERO), "what was done was undone");
        assert!(!answers.is_next(&key(1), block(2), 0, EXCHANGE_LIFETIME * 2));
        assert!(answers.read(&key(1), block(2), Duration::ZERO).is_some());
        assert!(!is_next(&answers, 3), "there is no more");
    }

    #[test]
    fn no_more_answers_are_kept_than_there_is_room_for() {
        let mut answers = LongAnswers::default();
        (0..500).for_each(|port| answers.keep(key(port), answer("x"), Block::FIRST, 0, Duration::ZERO));
        assert_eq!(answers.count(), ASSEMBLIES);
        answers.keep(key(500), answer("x"), Block::FIRST, 0, EXCHANGE_LIFETIME * 2);
        assert_eq!(answers.count(), 1, "the old ones are let go");
    }
}
