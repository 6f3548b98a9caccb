//! A filter with which the system drops datagrams of a flood before they enter the socket's queue. Otherwise the
//! queue would stay full and a STOP could be lost (safety S1, S6). If datagrams of one kind flood the door, only a
//! random share of them passes. Every command that contains a word of a STOP passes. Only Linux supports the filter;
//! other systems drop nothing. What passes is judged by the endpoint alone.

use std::time::Duration;

/// Maximum strictness: one of 2^7 datagrams of a kind passes. Even then some thousand datagrams a second pass if this
/// machine sends to itself as fast as it can.
const FINEST: u32 = 7;

/// Time without overload after which twice as many datagrams pass.
const CALM: Duration = Duration::from_millis(50);

/// Number of bytes of a datagram that are searched for the words. In a STOP the word is near the beginning.
const SEARCHED: u32 = 160;

/// A kind is filtered only if at least 1 in `PART` received datagrams is of that kind. A rarer kind did not cause the
/// flood.
const PART: usize = 8;

/// Length of the header in bytes (RFC 7252, section 3). The search for words begins after it.
const HEADER: usize = 4;

/// Number of received datagrams of each kind. The kinds are reads, commands, signs (all other datagrams), and
/// commands that pass every filter.
pub(super) type KindCounts = [usize; 4];

pub(super) struct FloodFilter {
    /// Words of four bytes, where each byte has the bit 0x20 set (lower case). A STOP in its usual form contains one
    /// of them.
    words: &'static [[u8; 4]],
    /// Strictness for reads, commands and signs. With the value n, one of 2^n datagrams passes.
    fine: [u32; 3],
    /// Time of the last change or flood. The filter becomes less strict when `CALM` has passed since then.
    since: Duration,
}

impl FloodFilter {
    pub(super) fn new(words: &'static [[u8; 4]]) -> FloodFilter {
        FloodFilter { words, fine: [0; 3], since: Duration::ZERO }
    }

    /// Makes the filter stricter after an overload, for the most frequent kind in `heard` that is not at `FINEST`
    /// yet. Returns whether the filter has changed.
    pub(super) fn tighten(&mut self, heard: KindCounts, now: Duration) -> bool {
        let all: usize = heard.iter().sum();
        let floods: Vec<usize> = (0..self.fine.len()).filter(|kind| heard[*kind] > 0 && heard[*kind] * PART >= all).collect();
        if floods.is_empty() {
            return false;
        }
        self.since = now;
        let coarse = floods.into_iter().filter(|kind| self.fine[*kind] < FINEST);
        let Some(most) = coarse.max_by_key(|kind| heard[*kind]) else { return false };
        self.fine[most] += 1;
        true
    }

    pub(super) fn due(&self) -> Option<Duration> {
        (self.fine != [0; 3]).then(|| self.since + CALM)
    }

    /// Makes the filter less strict if `CALM` has passed. Returns whether the filter has changed.
    pub(super) fn loosen(&mut self, now: Duration) -> bool {
        if self.due().is_none_or(|due| now < due) {
            return false;
        }
        self.since = now;
        self.fine = self.fine.map(|fine| fine.saturating_sub(1));
        true
    }

    /// Returns the kind of a datagram as the filter sees it. It is an index of `KindCounts`.
    pub(super) fn kind(&self, bytes: &[u8]) -> usize {
        match bytes.get(1) {
            Some(1 | 5) => 0,
            None | Some(0 | 32..) => 2,
            Some(_) => {
                let searched: Vec<u8> = bytes.iter().take(SEARCHED as usize + 3).skip(HEADER).map(|byte| byte | 0x20).collect();
                let has_word = searched.windows(4).any(|four| self.words.iter().any(|word| word == four));
                if has_word { 3 } else { 1 }
            }
        }
    }

    #[cfg(target_os = "linux")]
    pub(super) fn fit(&self, socket: &socket2::SockRef<'_>) -> std::io::Result<()> {
        if self.fine == [0; 3] { socket.detach_filter() } else { socket.attach_filter(&program(self.words, self.fine)) }
    }

    #[cfg(not(target_os = "linux"))]
    pub(super) fn fit(&self, _: &socket2::SockRef<'_>) -> std::io::Result<()> {
        Ok(())
    }
}

/// Builds the filter as a program for the classic Berkeley packet filter. The program sees each datagram from its UDP
/// header on. A datagram that ends before the position that the program reads is dropped.
#[cfg(target_os = "linux")]
fn program(words: &[[u8; 4]], [reads, commands, signs]: [u32; 3]) -> Vec<socket2::SockFilter> {
    use socket2::SockFilter;

    const UDP: u32 = 8;
    const CHANCE: u32 = 0xFFFF_F000 + 56;
    let load = |at| SockFilter::new(0x20, 0, 0, at);
    let load_byte = |at| SockFilter::new(0x30, 0, 0, at);
    let is_equal = |to, then, other| SockFilter::new(0x15, then, other, to);
    let is_least = |to, then, other| SockFilter::new(0x35, then, other, to);
    let (take, lose) = (|| SockFilter::new(0x06, 0, 0, u32::MAX), || SockFilter::new(0x06, 0, 0, 0));
    // These four steps let a random share of the datagrams pass. For the other datagrams, the filter continues after
    // these steps.
    let one_in = |power: u32| [load(CHANCE), SockFilter::new(0x54, 0, 0, (1 << power) - 1), is_equal(0, 0, 1), take()];
    let mut steps = vec![load_byte(UDP + 1), is_equal(1, 3, 0), is_equal(5, 2, 0), is_equal(0, 6, 0), is_least(32, 5, 10)];
    steps.extend(one_in(reads));
    steps.push(lose());
    steps.extend(one_in(signs));
    steps.push(lose());
    steps.extend(one_in(commands));
    let count = u8::try_from(words.len()).unwrap_or(u8::MAX);
    for at in UDP + 4..UDP + SEARCHED {
        steps.extend([load(at), SockFilter::new(0x44, 0, 0, 0x2020_2020)]);
        for (n, word) in (1..).zip(words) {
            steps.push(is_equal(u32::from_be_bytes(*word), count - n, u8::from(n == count)));
        }
        steps.push(take());
    }
    steps.push(lose());
    steps
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use std::net::UdpSocket;

    use socket2::SockRef;

    use super::*;

    const WORDS: &[[u8; 4]] = &[*b"stop", *b"reso"];
    const MS: Duration = Duration::from_millis(1);
    const LAST: &[u8] = b"\x40\x02\x00\x01the last: stop";

    /// Sends the datagrams through a filter with this strictness. Returns those that pass.
    fn through(fine: [u32; 3], datagrams: &[Vec<u8>]) -> Vec<Vec<u8>> {
        let [to, from] = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
        for fine in [[30; 3], fine] {
            FloodFilter { fine, ..FloodFilter::new(WORDS) }.fit(&SockRef::from(&to)).unwrap();
        }
        to.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        let (mut came, mut buffer) = (Vec::new(), [0; 2048]);
        for (n, datagram) in datagrams.iter().enumerate() {
            from.send_to(datagram, to.local_addr().unwrap()).unwrap();
            if n % 50 < 49 && n + 1 < datagrams.len() {
                continue;
            }
            // `LAST` passes every filter, and arrives after the datagrams before it.
            from.send_to(LAST, to.local_addr().unwrap()).unwrap();
            loop {
                let length = to.recv(&mut buffer).expect("the last one comes");
                if &buffer[..length] == LAST {
                    break;
                }
                came.push(buffer[..length].to_vec());
            }
        }
        came
    }

    fn datagram(first: u8, code: u8, rest: &[u8]) -> Vec<u8> {
        [&[first, code, 0, 1][..], rest].concat()
    }

    /// Safety S1, S6.
    #[test]
    fn however_fine_it_is_what_has_a_word_of_a_stop_comes_through() {
        let stops = [
            datagram(0x40, 2, b"\xB8commands\x04Stop"),
            datagram(0x48, 2, b"tokentok\x3Bexample.org\x88commands\x04stop\xFF{}"),
            datagram(0x40, 3, b"\xBD\x00resourcemodel\xFFh"),
            datagram(0x4F, 31, b"\xFF\xFFstop"),
            datagram(0x40, 2, &[&[0x33; 140][..], b"stop", &[0x33; 700]].concat()),
        ];
        assert_eq!(through([30; 3], &stops), stops);
        assert!(stops.iter().all(|stop| FloodFilter::new(WORDS).kind(stop) == 3));
    }

    /// `kind` must return the same kind as the one by which the system filters the datagram.
    #[test]
    fn the_kind_of_a_datagram_is_that_which_the_system_takes_it_for() {
        let filter = FloodFilter::new(WORDS);
        let behind = |count: usize| datagram(0x40, 2, &[&vec![0x33; count][..], b"sTOp"].concat());
        let mut datagrams: Vec<Vec<u8>> = [155, 156].map(behind).into();
        datagrams.extend([&b"\x40\x02"[..], b"\x40\x02\x00\x01sto"].map(<[u8]>::to_vec));
        for code in 0..=255 {
            datagrams
                .extend([(0x40, &b"stop"[..]), (0x60, b"stop"), (0x40, b"act")].map(|(first, rest)| datagram(first, code, rest)));
        }
        for bytes in datagrams {
            let comes_with = |kind: usize| {
                let mut fine = [30; 3];
                fine.iter_mut().skip(kind).take(1).for_each(|fine| *fine = 0);
                through(fine, std::slice::from_ref(&bytes)).len() == 1
            };
            let kind = filter.kind(&bytes);
            assert_eq!(
                (0..4).map(comes_with).collect::<Vec<_>>(),
                (0..4).map(|with| kind == 3 || kind == with).collect::<Vec<_>>(),
                "{bytes:02x?}"
            );
        }
    }

    /// Safety A5: of a filtered kind only the configured share passes. Kinds that are not filtered pass completely.
    #[test]
    fn of_a_kind_of_which_too_much_comes_only_some_come_through() {
        let kinds = [(0x40, 1, "read"), (0x40, 2, "act"), (0x60, 0, "acknowledge")];
        for (n, (first, code, word)) in kinds.into_iter().enumerate() {
            let all: Vec<Vec<u8>> = (0..2000).map(|_| datagram(first, code, word.as_bytes())).collect();
            let mut fine = [30; 3];
            assert!(through(fine, &all).len() < 10, "{word}");
            fine[n] = 0;
            assert_eq!(through(fine, &all).len(), 2000, "{word}");
            fine[n] = 1;
            assert!((500..1500).contains(&through(fine, &all).len()), "{word}");
        }
        assert_eq!(through([0; 3], &[datagram(0x40, 1, b"")]).len(), 1);
    }

    /// Safety S9.
    #[test]
    fn it_becomes_finer_for_what_floods_and_lets_everything_through_again_after_a_while() {
        let mut filter = FloodFilter::new(&[]);
        assert_eq!(filter.due(), None);
        (1..=FINEST).for_each(|n| assert!(filter.tighten([100, 3, 2, 0], n * MS)));
        assert!(!filter.tighten([100, 3, 2, 0], 10 * MS), "it is as fine as can be");
        assert!(filter.tighten([3, 100, 2, 0], 10 * MS));
        assert_eq!(filter.fine, [FINEST, 1, 0]);
        assert!(!filter.loosen(59 * MS) && filter.loosen(60 * MS));
        assert_eq!(filter.fine, [FINEST - 1, 0, 0]);
        while let Some(due) = filter.due() {
            assert!(filter.loosen(due));
        }
        assert_eq!(filter.fine, [0; 3]);
    }

    /// Safety S9: if the flood passes every filter, a filter for other commands would not reduce it.
    #[test]
    fn what_comes_through_anyway_makes_it_no_finer_for_anything_else() {
        let mut filter = FloodFilter::new(WORDS);
        let mut heard = [0; 4];
        for put in vec![datagram(0x40, 3, b"\xBD\x00resourcemodel\xFFx"); 500] {
            heard[filter.kind(&put)] += 1;
        }
        for few in [datagram(0x40, 2, b"\xB8commands\x05start"), datagram(0x40, 1, b"\xB5state")] {
            heard[filter.kind(&few)] += 1;
        }
        assert_eq!(heard, [1, 1, 0, 500]);
        assert!(!filter.tighten(heard, MS) && filter.due().is_none());
        assert!(!filter.tighten([0, 0, 0, 500], MS));
        assert!(filter.tighten([200, 1, 0, 300], MS));
        assert_eq!(filter.fine, [1, 0, 0], "the reads that come with them are thinned out");
        assert!(!filter.tighten([1, 1, 0, 500], 2 * MS) && filter.loosen(51 * MS), "nor does it keep it fine");
    }

    /// Safety S9.
    #[test]
    fn when_one_kind_is_as_fine_as_can_be_the_next_is_thinned_out() {
        let mut filter = FloodFilter { fine: [0, FINEST, 0], ..FloodFilter::new(&[]) };
        for fine in 1..=FINEST {
            assert!(filter.tighten([40, 60, 2, 0], MS));
            assert_eq!(filter.fine, [fine, FINEST, 0]);
        }
        assert!(!filter.tighten([40, 60, 2, 0], MS), "of the signs come few");
    }
}
