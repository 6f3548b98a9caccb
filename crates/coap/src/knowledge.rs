//! Tracks which version of each thing an observer knows, and which thing to send to it next. Things take turns, so a
//! thing that changes all the time does not hide the others. A version that may have been lost is sent again even
//! while other things change. Messages and pacing are not handled here.

use std::sync::Arc;
use std::time::Duration;

use super::limits::SETTLED;
use super::response::Response;

/// One of the things that a subject shows. All things of a subject share one version counter, which never decreases.
/// So a thing that disappears and returns is not mistaken for the earlier one.
#[derive(Debug)]
pub(super) struct Thing {
    pub(super) response: Arc<Response>,
    /// The number of the change that led to the thing's present state.
    pub(super) version: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lack {
    /// The observer was not sent the newest version of the thing at this index.
    News(usize),
    /// The newest version of the thing at this index was sent some time ago, but the observer may not have received
    /// it.
    Unsure(usize),
}

#[derive(Debug)]
pub(super) struct Knowledge {
    things: Vec<KnownThing>,
    /// Index of the thing whose turn is next. The first thing follows the last.
    next: usize,
    latest: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct KnownThing {
    told: u64,
    at: Duration,
    /// The newest version that the observer has certainly received.
    sure: u64,
}

impl Thing {
    pub(super) fn differs_from(&self, response: &Arc<Response>) -> bool {
        let old = &*self.response;
        !Arc::ptr_eq(&self.response, response)
            && (old.code != response.code || old.format != response.format || old.body != response.body)
    }
}

impl Knowledge {
    /// The knowledge of an observer that was just sent one thing, `shown`, and none of the others. Unless `is_sure`
    /// is set, that message may be lost, so the thing will be sent again.
    pub(super) fn of(things: &[Thing], shown: &Response, is_sure: bool, now: Duration) -> Knowledge {
        let is_shown = |thing: &Thing| things.len() == 1 || thing.response.body == shown.body;
        let told = |thing: &Thing| KnownThing { told: thing.version, at: now, sure: if is_sure { thing.version } else { 0 } };
        let known = |thing: &Thing| if is_shown(thing) { told(thing) } else { KnownThing::default() };
        let latest = things.iter().position(is_shown).unwrap_or(0);
        Knowledge { things: things.iter().map(known).collect(), next: 0, latest }
    }

    /// The thing to send to the observer now: one that has changed, or one that the observer may have missed.
    pub(super) fn lack(&self, things: &[Thing], now: Duration) -> Option<Lack> {
        let from_here = self.lack_within(things, self.next..things.len(), now);
        from_here.or_else(|| self.lack_within(things, 0..self.next.min(things.len()), now))
    }

    pub(super) const fn latest(&self) -> usize {
        self.latest
    }

    /// When to send the next thing to the observer: at least `pace` after `sent`, the time of the last message to it.
    pub(super) fn due(&self, things: &[Thing], sent: Duration, pace: Duration) -> Option<Duration> {
        let due = |(place, thing): (usize, &Thing)| match self.known(place) {
            known if known.told < thing.version => Some(sent + pace),
            known if known.sure < thing.version => Some((known.at + SETTLED).max(sent + pace)),
            _ => None,
        };
        things.iter().enumerate().filter_map(due).min()
    }

    pub(super) fn told(&mut self, things: &[Thing], place: usize, version: u64, now: Duration) {
        let known = self.known_mut(place);
        (known.told, known.at) = (known.told.max(version), now);
        let has_news = (0..things.len()).any(|place| self.is_news(things, place));
        self.next = if has_news { place + 1 } else { 0 };
        self.latest = place;
    }

    pub(super) fn acknowledged(&mut self, place: usize, version: u64) {
        let known = self.known_mut(place);
        known.sure = known.sure.max(version);
    }

    fn lack_within(&self, things: &[Thing], mut places: std::ops::Range<usize>, now: Duration) -> Option<Lack> {
        let news = places.clone().find(|place| self.is_news(things, *place)).map(Lack::News);
        let is_unsure = |place: &usize| {
            let known = self.known(*place);
            known.sure < things[*place].version && known.at + SETTLED <= now
        };
        news.or_else(|| places.find(is_unsure).map(Lack::Unsure))
    }

    fn is_news(&self, things: &[Thing], place: usize) -> bool {
        self.known(place).told < things[place].version
    }

    fn known(&self, place: usize) -> KnownThing {
        self.things.get(place).copied().unwrap_or_default()
    }

    fn known_mut(&mut self, place: usize) -> &mut KnownThing {
        if self.things.len() <= place {
            self.things.resize(place + 1, KnownThing::default());
        }
        &mut self.things[place]
    }
}

#[cfg(test)]
mod tests {
    use super::super::code::Code;
    use super::*;

    const LATER: Duration = Duration::from_secs(60);

    fn things(versions: &[u64]) -> Vec<Thing> {
        let response = Arc::new(Response::new(Code::CONTENT));
        versions.iter().map(|version| Thing { response: Arc::clone(&response), version: *version }).collect()
    }

    fn known(versions: &[u64], now: Duration) -> Knowledge {
        Knowledge::of(&things(versions), &Response::new(Code::CONTENT), true, now)
    }

    /// The indices of the things in the order in which they are sent while nothing changes.
    fn order(knowledge: &mut Knowledge, things: &[Thing]) -> Vec<usize> {
        let mut order = Vec::new();
        while let Some(Lack::News(place)) = knowledge.lack(things, Duration::ZERO) {
            knowledge.told(things, place, things[place].version, Duration::ZERO);
            order.push(place);
        }
        order
    }

    #[test]
    fn what_changed_together_is_told_in_order_and_from_the_first_again() {
        let mut knowledge = known(&[1, 1, 1], Duration::ZERO);
        assert_eq!(order(&mut knowledge, &things(&[1, 2, 1])), [1]);
        assert_eq!(order(&mut knowledge, &things(&[2, 3, 2])), [0, 1, 2]);
        assert_eq!(knowledge.lack(&things(&[2, 3, 2]), Duration::ZERO), None, "too early to repeat it");
    }

    #[test]
    fn whoever_was_shown_one_thing_is_told_the_others() {
        let thing = |words: &str| Thing { response: Arc::new(Response::refusal(Code::CONTENT, words)), version: 1 };
        let things = [thing("robot"), thing("map"), thing("lamp")];
        let mut knowledge = Knowledge::of(&things, &things[1].response, true, Duration::ZERO);
        assert_eq!(order(&mut knowledge, &things), [0, 2]);
    }

    #[test]
    fn what_changes_all_the_time_hides_nothing() {
        let mut knowledge = known(&[1, 1, 1], Duration::ZERO);
        let mut told = Vec::new();
        for version in 2..8 {
            let now = things(&[version, version, 2]);
            let Some(Lack::News(place)) = knowledge.lack(&now, Duration::ZERO) else { panic!("there is news") };
            knowledge.told(&now, place, now[place].version, Duration::ZERO);
            told.push(place);
        }
        assert_eq!(told, [0, 1, 2, 0, 1, 0], "after a whole round from the first again");
    }

    #[test]
    fn what_may_be_lost_is_told_again_though_there_is_other_news() {
        let mut knowledge = known(&[1, 1], Duration::ZERO);
        knowledge.told(&things(&[1, 2]), 1, 2, Duration::ZERO);
        let now = things(&[2, 2]);
        assert_eq!(knowledge.lack(&now, LATER), Some(Lack::News(0)));
        knowledge.told(&things(&[3, 2]), 0, 2, LATER);
        assert_eq!(knowledge.lack(&things(&[3, 2]), LATER), Some(Lack::Unsure(1)));
        knowledge.acknowledged(1, 2);
        assert_eq!(knowledge.lack(&things(&[3, 2]), LATER), Some(Lack::News(0)));
    }

    #[test]
    fn news_is_due_after_the_pace_and_a_repetition_when_it_has_settled() {
        let at = Duration::from_secs(100);
        let pace = Duration::from_millis(20);
        let mut knowledge = known(&[1], at);
        assert_eq!(knowledge.due(&things(&[1]), at, pace), None);
        assert_eq!(knowledge.due(&things(&[2]), at, pace), Some(at + pace));
        knowledge.told(&things(&[2]), 0, 2, at);
        assert_eq!(knowledge.due(&things(&[2]), at, pace), Some(at + SETTLED));
        assert_eq!(knowledge.lack(&things(&[2]), at + SETTLED), Some(Lack::Unsure(0)));
    }
}
