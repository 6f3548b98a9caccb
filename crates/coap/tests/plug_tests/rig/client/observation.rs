//! What an observer knows: the newest state by the numbers of the notifications, and until when it is fresh.

use std::time::Duration;

/// Notifications this far apart in time are in the order in which they came (RFC 7641, section 3.4).
const CERTAIN: Duration = Duration::from_secs(128);

/// Max-Age where none is given, in seconds (RFC 7252, section 5.10.5).
const MAX_AGE_S: u32 = 60;

#[derive(Clone, Debug, Default)]
pub(crate) struct Observation {
    newest: Option<(u32, Duration)>,
    pub(crate) held: Option<Vec<u8>>,
    pub(crate) states: Vec<(Duration, Vec<u8>)>,
    /// When the state becomes stale, and the client registers again.
    pub(crate) fresh_until: Option<Duration>,
    pub(crate) is_over: bool,
}

impl Observation {
    /// Whether a notification with this number is newer than all before; if so, notes it (RFC 7641, section 3.4).
    pub(crate) fn takes(&mut self, number: u32, now: Duration) -> bool {
        let is_newer = self.newest.is_none_or(|(before, at)| is_newer((before, at), (number, now)));
        if is_newer {
            self.newest = Some((number, now));
        }
        is_newer
    }

    pub(crate) fn holds(&mut self, state: Vec<u8>, now: Duration) {
        self.states.push((now, state.clone()));
        self.held = Some(state);
    }

    /// Sets until when the state is fresh.
    pub(crate) fn believe(&mut self, max_age: Option<u32>, now: Duration) {
        self.fresh_until = Some(now + Duration::from_secs(max_age.unwrap_or(MAX_AGE_S).into()));
    }
}

fn is_newer((v1, t1): (u32, Duration), (v2, t2): (u32, Duration)) -> bool {
    (v1 < v2 && v2 - v1 < 1 << 23) || (v1 > v2 && v1 - v2 > 1 << 23) || t2 > t1 + CERTAIN
}

#[test]
fn a_notification_is_newer_by_its_number_across_the_wrap_or_by_time() {
    let at = Duration::from_secs;
    assert!(is_newer((1, at(0)), (2, at(0))) && !is_newer((2, at(0)), (1, at(0))) && !is_newer((2, at(0)), (2, at(0))));
    assert!(is_newer(((1 << 24) - 1, at(0)), (0, at(0))) && !is_newer((0, at(0)), ((1 << 24) - 1, at(0))));
    assert!(is_newer((2, at(0)), (1, at(129))));
}
