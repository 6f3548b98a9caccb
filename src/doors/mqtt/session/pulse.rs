//! Asking the embedded broker whether it is well: a message goes out and must come back. That a port is open proves nothing. What
//! follows from a broker that is not well is decided in `health` and by whoever watches it.

use std::time::Duration;

use super::super::publication::Publication;
use super::super::topics::PULSE;
use super::times::Times;

#[derive(Debug)]
pub(super) struct Pulse {
    beat: Duration,
    echo: Duration,
    next: Duration,
    /// What has not come back yet, and until when it must.
    awaited: Option<(u64, Duration)>,
    /// What the next beat says: no two say the same, also those of connections that were lost.
    nonce: u64,
}

impl Pulse {
    /// The first beat is at once; beats count on from `nonce`.
    pub(super) fn new(times: &Times, nonce: u64, now: Duration) -> Pulse {
        Pulse { beat: times.beat, echo: times.echo, next: now, awaited: None, nonce }
    }

    /// The beat that is due.
    pub(super) fn poll_beat(&mut self, now: Duration) -> Option<Publication> {
        if self.awaited.is_some() || now < self.next {
            return None;
        }
        self.nonce = self.nonce.wrapping_add(1);
        self.awaited = Some((self.nonce, now + self.echo));
        self.next = now + self.beat;
        Some(Publication::passing(PULSE.to_owned(), format!("{:016x}", self.nonce)))
    }

    /// Whether this is the beat that was awaited.
    pub(super) fn handle_echo(&mut self, payload: &[u8]) -> bool {
        let is_awaited = self.awaited.is_some_and(|(nonce, _)| format!("{nonce:016x}").as_bytes() == payload);
        if is_awaited {
            self.awaited = None;
        }
        is_awaited
    }

    /// Whether a beat has not come back in time; the next one is due then, at once.
    pub(super) fn handle_timeout(&mut self, now: Duration) -> bool {
        let is_missed = self.awaited.is_some_and(|(_, until)| now >= until);
        if is_missed {
            self.awaited = None;
            self.next = now;
        }
        is_missed
    }

    pub(super) fn poll_timeout(&self) -> Duration {
        self.awaited.map_or(self.next, |(_, until)| until)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Duration = Duration::from_secs(100);

    fn pulse() -> (Pulse, Times) {
        let times = Times::default();
        (Pulse::new(&times, 41, START), times)
    }

    #[test]
    fn the_first_beat_is_at_once_and_the_next_when_its_time_has_come() {
        let (mut pulse, times) = pulse();
        let beat = pulse.poll_beat(START).expect("it is due");
        assert_eq!((beat.topic.as_str(), &beat.payload[..], beat.retain), (PULSE, &b"000000000000002a"[..], false));
        assert_eq!(pulse.poll_beat(START), None);
        assert!(pulse.handle_echo(&beat.payload));
        assert_eq!(pulse.poll_timeout(), START + times.beat);
        assert_eq!(pulse.poll_beat(START + times.beat - Duration::from_millis(1)), None);
        assert!(pulse.poll_beat(START + times.beat).is_some_and(|next| next.payload != beat.payload));
    }

    #[test]
    fn what_does_not_come_back_in_time_is_missed_once_and_the_next_beat_is_at_once() {
        let (mut pulse, times) = pulse();
        let beat = pulse.poll_beat(START).expect("it is due");
        let late = START + times.echo;
        assert!(!pulse.handle_timeout(late - Duration::from_millis(1)));
        assert!(pulse.handle_timeout(late));
        assert!(!pulse.handle_timeout(late));
        assert!(!pulse.handle_echo(&beat.payload), "it comes too late");
        assert!(pulse.poll_beat(late).is_some());
    }

    #[test]
    fn somebody_elses_words_are_no_echo() {
        let (mut pulse, _) = pulse();
        assert!(!pulse.handle_echo(b""), "nothing is awaited");
        let beat = pulse.poll_beat(START).expect("it is due");
        assert!(!pulse.handle_echo(b"000000000000002b") && !pulse.handle_echo(b"") && !pulse.handle_echo(&[0xff; 16]));
        assert!(pulse.handle_echo(&beat.payload));
        assert!(!pulse.handle_echo(&beat.payload), "once");
    }
}
