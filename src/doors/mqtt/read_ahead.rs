//! A queue for a client's input that waits to be handled. The hearing thread puts input into it after searching the
//! input for a STOP. The connection's service takes it out. Each of the two has its own end of the queue. The size is
//! limited for each connection, and for all connections together.

use std::collections::VecDeque;
use std::future::poll_fn;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};

use bytes::BytesMut;
use tokio::sync::Notify;

use super::limits::{ALWAYS_AHEAD, CONNECTION_BYTES, MESSAGES_PART, READ_AHEAD, UNREAD_PART};
use mqtt_gate::{Epoch, Mark};

/// Maximum number of bytes read at once.
pub(super) const READ: usize = 64 * 1024;

/// Minimum size of a newly allocated piece in bytes, so that several small inputs share one piece.
const PIECE: usize = 4 * 1024;

/// Number of bytes counted for each remembered position of a STOP.
const STOP_COST: usize = size_of::<Mark>();

/// Number of bytes waiting in the queues of all connections. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub(super) struct Pool(Arc<AtomicUsize>);

impl Pool {
    pub(super) fn bytes(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }
}

/// The hearing thread's end of the queue.
#[derive(Debug)]
pub(super) struct Feeder(Arc<ReadAhead>);

/// The end of the queue from which the connection's service takes input.
#[derive(Debug)]
pub(super) struct Taker(Arc<ReadAhead>);

#[derive(Debug)]
struct ReadAhead {
    state: Mutex<State>,
    /// Wakes the feeder when there is room, or when the input is no longer wanted.
    room: Notify,
    pool: Pool,
}

#[derive(Debug, Default)]
struct State {
    /// Pieces of at most `READ` bytes with little unused capacity. The memory of a piece is freed when the piece is
    /// taken.
    pieces: VecDeque<BytesMut>,
    bytes: usize,
    /// Positions of packets that have halted the robot already. Also positions at which the epoch differs from that
    /// of the bytes before.
    marks: Vec<Mark>,
    /// Number of bytes put in so far. `epoch` is the epoch of the last of them.
    total: u64,
    epoch: Option<Epoch>,
    /// Number of the client's bytes that wait outside this queue. They reduce the room in it.
    held: usize,
    /// Whether the feeder waits for room. It is woken only then, because waking its thread for each packet would
    /// delay every message.
    wants_room: bool,
    taker: Option<Waker>,
    has_ended: bool,
    left: Option<Left>,
}

/// What the hearing thread still does when the input is no longer wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Left {
    /// The hearing thread searches the bytes that were received already, and then ends.
    HearsRest,
    /// The hearing thread reads until the client closes the connection, for `hearing::FAREWELL` at most.
    HearsOn,
    /// The hearing thread stops reading. The client's key is no longer valid, so even its STOP does not count.
    Deaf,
}

pub(super) fn read_ahead(pool: &Pool) -> (Feeder, Taker) {
    let shared = ReadAhead { state: Mutex::default(), room: Notify::new(), pool: pool.clone() };
    let shared = Arc::new(shared);
    (Feeder(Arc::clone(&shared)), Taker(shared))
}

impl Feeder {
    /// Waits until there is room; returns the number of bytes that fit, at most `READ`.
    ///
    /// # Errors
    /// The input is no longer wanted.
    pub(super) async fn room(&self) -> Result<usize, Left> {
        loop {
            {
                let mut state = self.0.state();
                if let Some(left) = state.left {
                    return Err(left);
                }
                let room = self.0.room_in(&state);
                if room > 0 {
                    return Ok(room.min(READ));
                }
                state.wants_room = true;
            }
            self.0.room.notified().await;
        }
    }

    /// Waits until the input is no longer wanted.
    pub(super) async fn left(&self) -> Left {
        loop {
            if let Some(left) = self.0.state().left {
                return left;
            }
            self.0.room.notified().await;
        }
    }

    /// Puts in bytes that arrived in the epoch `came`. `halted` lists the packets that have halted the robot: the
    /// position of each packet, and the epoch that its halt began.
    pub(super) fn put(&self, bytes: &[u8], came: Epoch, halted: &[(u64, Epoch)]) {
        let mut state = self.0.state();
        if state.left.is_some() {
            return;
        }
        match state.pieces.back_mut() {
            Some(piece) if piece.capacity() - piece.len() >= bytes.len() => piece.extend_from_slice(bytes),
            Some(_) => {
                let mut piece = BytesMut::with_capacity(bytes.len().max(PIECE));
                piece.extend_from_slice(bytes);
                state.pieces.push_back(piece);
            }
            None => state.pieces.push_back(BytesMut::from(bytes)),
        }
        state.bytes += bytes.len();
        let begins = state.total;
        // The beginning of this STOP may have come with earlier bytes. Then the bytes after the STOP belong to the
        // epoch that it began.
        let is_cut = halted.first().is_some_and(|(stop, _)| *stop < begins);
        if state.epoch != Some(came) && !is_cut {
            state.marks.push(Mark { begins, epoch: came, heard_ahead: false });
        }
        state.marks.extend(halted.iter().map(|(begins, epoch)| Mark { begins: *begins, epoch: *epoch, heard_ahead: true }));
        state.epoch = Some(halted.last().map_or(came, |(_, epoch)| *epoch));
        state.total += bytes.len() as u64;
        // Counted before the lock is released. So the bytes cannot be taken, and subtracted, before they are added.
        self.0.pool.0.fetch_add(bytes.len(), Ordering::Relaxed);
        wake(state);
    }
}

impl Drop for Feeder {
    fn drop(&mut self) {
        let mut state = self.0.state();
        state.has_ended = true;
        wake(state);
    }
}

/// Releases the lock and then wakes the taker, so that the taker need not wait for the lock.
fn wake(mut state: MutexGuard<'_, State>) {
    let taker = state.taker.take();
    drop(state);
    if let Some(taker) = taker {
        taker.wake();
    }
}

impl Taker {
    /// Appends the next piece to `into`, and passes all marks to `marked`. Returns false when there is no piece.
    pub(super) fn take(&self, into: &mut BytesMut, marked: impl FnMut(Mark)) -> bool {
        let mut state = self.0.state();
        state.marks.drain(..).for_each(marked);
        let Some(piece) = state.pieces.pop_front() else { return false };
        state.bytes -= piece.len();
        self.0.pool.0.fetch_sub(piece.len(), Ordering::Relaxed);
        drop(state);
        if into.is_empty() {
            *into = piece;
        } else {
            if into.len() < READ {
                // Few bytes are left in `into`, but its buffer may be large. Copying them frees that buffer.
                let mut rest = BytesMut::with_capacity(into.len() + piece.len());
                rest.extend_from_slice(into);
                *into = rest;
            }
            into.extend_from_slice(&piece);
        }
        true
    }

    /// Ready with false when bytes can be taken, ready with true at the end of the input.
    pub(super) fn poll_come(&self, cx: &Context<'_>) -> Poll<bool> {
        self.poll(cx, |state| (!state.pieces.is_empty()).then_some(false).or(state.has_ended.then_some(true)))
    }

    pub(super) fn poll_full(&self, cx: &Context<'_>) -> Poll<()> {
        self.poll(cx, |state| (self.0.room_in(state) == 0).then_some(()))
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.state().bytes
    }

    /// Reports how many bytes of this client wait outside this queue, and whether the client reads its output. These
    /// bytes reduce the room here. If the client does not read, `UNREAD_PART` is reserved in addition.
    pub(super) fn hold(&self, held: usize, reads: bool) {
        let mut state = self.0.state();
        state.held = if reads { held } else { held + UNREAD_PART };
        if state.wants_room && self.0.room_in(&state) > 0 {
            state.wants_room = false;
            drop(state);
            self.0.room.notify_one();
        }
    }

    pub(super) fn leave(&self, left: Left) {
        let mut state = self.0.state();
        self.0.pool.0.fetch_sub(state.bytes, Ordering::Relaxed);
        (state.pieces, state.bytes) = (VecDeque::new(), 0);
        state.left.get_or_insert(left);
        state.taker = None;
        drop(state);
        self.0.room.notify_one();
    }

    pub(super) async fn ended(&self) {
        poll_fn(|cx| self.poll(cx, |state| state.has_ended.then_some(()))).await;
    }

    fn poll<T>(&self, cx: &Context<'_>, is_so: impl Fn(&State) -> Option<T>) -> Poll<T> {
        let mut state = self.0.state();
        if let Some(so) = is_so(&state) {
            return Poll::Ready(so);
        }
        if !state.taker.as_ref().is_some_and(|taker| taker.will_wake(cx.waker())) {
            state.taker = Some(cx.waker().clone());
        }
        Poll::Pending
    }
}

impl Drop for Taker {
    fn drop(&mut self) {
        self.leave(Left::HearsRest);
    }
}

impl ReadAhead {
    fn room_in(&self, state: &State) -> usize {
        let is_lent_out = self.pool.bytes() >= READ_AHEAD;
        let own = CONNECTION_BYTES.saturating_sub(MESSAGES_PART + state.held);
        let most = if is_lent_out { ALWAYS_AHEAD } else { own.max(ALWAYS_AHEAD) };
        most.saturating_sub(state.bytes + STOP_COST * state.marks.len())
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::pin::{Pin, pin};
    use std::sync::atomic::AtomicBool;
    use std::task::Wake;

    use super::*;

    fn taken(taker: &Taker) -> (Vec<u8>, Vec<u64>) {
        let (mut bytes, mut halted) = (BytesMut::new(), Vec::new());
        while taker.take(&mut bytes, |mark| halted.extend(mark.heard_ahead.then_some(mark.begins))) {}
        (bytes.to_vec(), halted)
    }

    /// Puts in as many bytes as there is room for; returns their number.
    async fn fill(feeder: &Feeder) -> usize {
        let mut put = 0;
        loop {
            let room = tokio::select! {
                biased;
                room = feeder.room() => room.expect("somebody takes it"),
                () = std::future::ready(()) => return put,
            };
            feeder.put(&vec![7; room], Epoch(0), &[]);
            put += room;
        }
    }

    #[tokio::test]
    async fn what_is_put_is_taken_in_order_and_then_comes_the_end() {
        let (feeder, taker) = read_ahead(&Pool::default());
        feeder.put(b"ab", Epoch(0), &[(0, Epoch(1))]);
        feeder.put(b"c", Epoch(0), &[]);
        assert!(!poll_fn(|cx| taker.poll_come(cx)).await);
        assert_eq!(taken(&taker), (b"abc".to_vec(), vec![0]));
        feeder.put(b"d", Epoch(1), &[(3, Epoch(2))]);
        drop(feeder);
        assert!(!poll_fn(|cx| taker.poll_come(cx)).await, "what came before the end is taken before it");
        assert_eq!(taken(&taker), (b"d".to_vec(), vec![3]));
        assert!(poll_fn(|cx| taker.poll_come(cx)).await);
    }

    /// Safety S4: the epoch may change between the two halves of a STOP, because other clients press STOP too.
    #[test]
    fn a_stop_in_two_pieces_is_marked_before_what_follows_it() {
        let (feeder, taker) = read_ahead(&Pool::default());
        feeder.put(b"first half", Epoch(1), &[]);
        feeder.put(b"second half and a START", Epoch(2), &[(3, Epoch(3))]);
        feeder.put(b"more", Epoch(4), &[]);
        let (mut bytes, mut marks) = (BytesMut::new(), Vec::new());
        while taker.take(&mut bytes, |mark| marks.push((mark.begins, mark.epoch, mark.heard_ahead))) {}
        assert_eq!(marks, [(0, Epoch(1), false), (3, Epoch(3), true), (33, Epoch(4), false)]);
    }

    /// Safety A5.
    #[tokio::test]
    async fn what_waits_here_and_elsewhere_has_one_bound() {
        let pool = Pool::default();
        let (feeder, taker) = read_ahead(&pool);
        assert_eq!(fill(&feeder).await, CONNECTION_BYTES - MESSAGES_PART - STOP_COST, "the first mark says when they came");
        poll_fn(|cx| taker.poll_full(cx)).await;
        taken(&taker);
        taker.hold(CONNECTION_BYTES - MESSAGES_PART - 2 * READ, true);
        assert_eq!(fill(&feeder).await, 2 * READ);
        taken(&taker);
        taker.hold(2 * CONNECTION_BYTES, true);
        assert_eq!(fill(&feeder).await, ALWAYS_AHEAD, "something can always come");
        taken(&taker);
        taker.hold(0, false);
        assert_eq!(fill(&feeder).await, CONNECTION_BYTES - MESSAGES_PART - UNREAD_PART, "what it does not read costs elsewhere");
        taker.leave(Left::HearsRest);
        assert_eq!(pool.bytes(), 0);
        assert_eq!(feeder.room().await, Err(Left::HearsRest));
    }

    /// Safety A5, S9.
    #[tokio::test]
    async fn what_waits_of_all_has_a_bound_that_leaves_room_for_each() {
        let pool = Pool::default();
        let mut greedy = Vec::new();
        while pool.bytes() < READ_AHEAD {
            let (feeder, taker) = read_ahead(&pool);
            fill(&feeder).await;
            greedy.push((feeder, taker));
        }
        let (feeder, taker) = read_ahead(&pool);
        assert_eq!(fill(&feeder).await, ALWAYS_AHEAD);
        drop(greedy);
        taken(&taker);
        assert_eq!(fill(&feeder).await, CONNECTION_BYTES - MESSAGES_PART);
    }

    /// Safety A5: the unused memory is small, whatever the sizes of the inputs are.
    #[test]
    fn what_waits_has_little_room_for_nothing() {
        for step in [1, 30, 1_000, 5_000, 33_000] {
            let (feeder, taker) = read_ahead(&Pool::default());
            (0..600_000 / step).for_each(|_| feeder.put(&vec![7; step], Epoch(0), &[]));
            let state = taker.0.state();
            let rooms: usize = state.pieces.iter().map(BytesMut::capacity).sum();
            assert!(rooms <= state.bytes * 5 / 4 && state.pieces.len() <= 600_000 / PIECE + 5, "{rooms} for pieces of {step}");
        }
    }

    /// Safety A5: a STOP counts more than its bytes, because its position is remembered.
    #[tokio::test]
    async fn what_is_remembered_of_stops_counts() {
        let (feeder, _taker) = read_ahead(&Pool::default());
        feeder.put(&[7; 8], Epoch(0), &[(0, Epoch(0)); 999]);
        assert_eq!(fill(&feeder).await, CONNECTION_BYTES - MESSAGES_PART - 8 - 1000 * STOP_COST);
    }

    #[derive(Default)]
    struct Woken(AtomicBool);

    impl Wake for Woken {
        fn wake(self: Arc<Self>) {
            self.0.store(true, Ordering::Relaxed);
        }
    }

    #[tokio::test]
    async fn only_whoever_waits_for_room_is_woken() {
        let (feeder, taker) = read_ahead(&Pool::default());
        let woken = Arc::new(Woken::default());
        let waker = Waker::from(Arc::clone(&woken));
        let poll = |future: Pin<&mut dyn Future<Output = usize>>| future.poll(&mut Context::from_waker(&waker));
        {
            let mut left = pin!(async { feeder.left().await as usize });
            assert!(poll(left.as_mut()).is_pending());
            taker.hold(7, true);
            assert!(!woken.0.load(Ordering::Relaxed), "it has room");
        }
        fill(&feeder).await;
        let mut room = pin!(async { feeder.room().await.expect("somebody takes it") });
        assert!(poll(room.as_mut()).is_pending());
        taker.hold(7, true);
        assert!(!woken.0.load(Ordering::Relaxed), "there is no room");
        taken(&taker);
        taker.hold(0, true);
        assert!(woken.0.load(Ordering::Relaxed));
        assert_eq!(poll(room.as_mut()), Poll::Ready(READ));
    }

    #[tokio::test]
    async fn what_nobody_takes_any_more_is_not_kept() {
        let pool = Pool::default();
        let (feeder, taker) = read_ahead(&pool);
        taker.leave(Left::Deaf);
        drop(taker);
        feeder.put(b"abc", Epoch(0), &[(0, Epoch(1))]);
        assert_eq!((feeder.left().await, pool.bytes()), (Left::Deaf, 0));
    }
}
