//! Tests what waits for one subscriber, what it loses, and how long publishers wait for it.

use super::*;
use crate::grant::Grant;
use crate::limits::STILL;
use crate::message::Draft;
use crate::subscription::Subscription;

const NOW: Duration = Duration::from_secs(100);

/// A delivery of this weight: its payload is made long enough.
fn delivery(weight: usize, stamp: u64) -> Delivery {
    let draft = |payload| Draft::plain("a", payload, Qos::One);
    let least = Message::new(draft(b""), stamp, &Arc::default()).cost();
    let message = Message::new(draft(&vec![0; weight - least]), stamp, &Arc::default());
    Delivery { message: Arc::new(message), qos: Qos::One, retain: false, ids: None }
}

fn owe(subscriber: &Subscriber, bytes: usize) {
    let (whole, rest) = (bytes / HEAVIEST, bytes % HEAVIEST);
    let weights = std::iter::repeat_n(HEAVIEST, whole - usize::from(rest > 0)).chain((rest > 0).then_some(HEAVIEST / 2));
    let last = (rest > 0).then_some(rest + HEAVIEST / 2);
    weights.chain(last).for_each(|weight| subscriber.put(delivery(weight, 0), || true));
}

/// Lets the client read until messages of at most this weight wait.
fn reads_down_to(subscriber: &Subscriber, most: usize) {
    while subscriber.lag.load(Ordering::Relaxed) > most {
        assert!(subscriber.next(true).is_some());
    }
}

/// Makes the subscriber lag behind, and lets a publisher wait for it for `PATIENCE`, up to the time `until`.
fn stall(subscriber: &Subscriber, until: Duration) {
    owe(subscriber, LAG + 1);
    assert!(subscriber.is_behind(until - PATIENCE));
    assert!(subscriber.forgive(until, STILL));
}

#[tokio::test]
async fn whoever_lags_is_waited_for_until_he_has_caught_up() {
    let lag = Arc::new(Subscriber::default());
    owe(&lag, LAG);
    assert!(!lag.is_behind(NOW));
    lag.put(delivery(200, 0), || true);
    assert!(lag.is_behind(NOW));
    let waiting = tokio::spawn({
        let lag = Arc::clone(&lag);
        async move { std::future::poll_fn(|cx| lag.poll_relieved(cx)).await }
    });
    tokio::task::yield_now().await;
    reads_down_to(&lag, RELIEF);
    waiting.await.expect("he has caught up");
}

/// A long message weighs less than its size, so its bytes are counted as well.
#[test]
fn whoever_has_a_few_long_messages_before_him_is_waited_for_too() {
    let subscriber = Subscriber::default();
    (0..2).for_each(|_| subscriber.put(delivery(LAG_BYTES / 2, 0), || true));
    assert!(!subscriber.is_behind(NOW));
    subscriber.put(delivery(200, 0), || true);
    assert!(subscriber.is_behind(NOW));
    let cx = Context::from_waker(Waker::noop());
    assert!(subscriber.next(true).is_some() && subscriber.poll_relieved(&cx).is_pending());
    assert!(subscriber.next(true).is_some() && subscriber.poll_relieved(&cx).is_ready());
}

#[tokio::test]
async fn whoever_waits_for_messages_is_told_of_those_that_can_go_out() {
    let subscriber = Arc::new(Subscriber::default());
    let waiting = tokio::spawn({
        let subscriber = Arc::clone(&subscriber);
        async move { std::future::poll_fn(|cx| subscriber.poll_come(false, cx)).await }
    });
    tokio::task::yield_now().await;
    subscriber.put(delivery(200, 0), || true);
    tokio::task::yield_now().await;
    assert!(!waiting.is_finished() && subscriber.next(false).is_none(), "this one wants to be acknowledged");
    std::future::poll_fn(|cx| subscriber.poll_come(true, cx)).await;
    assert!(subscriber.next(true).is_some());
    subscriber.put(Delivery { qos: Qos::Zero, ..delivery(200, 0) }, || true);
    waiting.await.expect("this one does not");
}

#[test]
fn whoever_does_not_read_is_not_waited_for_longer_and_longer() {
    let lag = Subscriber::default();
    stall(&lag, NOW);
    assert!(!lag.is_behind(NOW + FORGIVEN - Duration::from_millis(1)));
    stall(&lag, NOW + FORGIVEN + PATIENCE);
    let again = NOW + FORGIVEN + PATIENCE;
    assert!(!lag.is_behind(again + FORGIVEN) && lag.is_behind(again + 2 * FORGIVEN));
}

/// One publisher's wait is over, but other publishers still wait for a subscriber that reads.
#[test]
fn whoever_has_caught_up_in_between_is_not_forgiven() {
    let lag = Subscriber::default();
    owe(&lag, LAG + 1);
    assert!(lag.is_behind(NOW));
    reads_down_to(&lag, 0);
    owe(&lag, LAG + 1);
    assert!(lag.is_behind(NOW + PATIENCE / 2) && !lag.forgive(NOW + PATIENCE, STILL));
    assert!(lag.is_behind(NOW + PATIENCE), "it reads, and is waited for");
    assert!(lag.forgive(NOW + PATIENCE + PATIENCE / 2, STILL));
    assert!(!lag.is_behind(NOW + 2 * PATIENCE), "now it does not");
}

/// An urgent message after a flood is not delayed for long by a subscriber that does not read. A healthy subscriber
/// is not mistaken for such a subscriber.
#[test]
fn whoever_does_not_read_is_waited_for_only_a_moment() {
    let behind = || {
        let lag = Subscriber::default();
        owe(&lag, LAG + 1);
        assert!(lag.is_behind(NOW));
        lag
    };
    let almost = NOW + STILL - Duration::from_millis(1);
    let slow = behind();
    assert!(!slow.forgive(NOW + STILL, STILL), "others may have much to do");
    let full = behind();
    full.note_still(true, false, almost);
    assert!(!full.forgive(almost, STILL) && full.forgive(NOW + STILL, STILL), "a trickle out of a full room is no reading");
    let silent = behind();
    silent.note_still(false, true, NOW);
    silent.note_still(false, true, almost);
    assert!(!silent.forgive(almost, STILL) && silent.forgive(NOW + STILL, STILL));
    let answering = behind();
    answering.note_still(false, true, NOW);
    answering.note_still(false, false, almost);
    answering.note_still(false, true, almost);
    assert!(!answering.forgive(NOW + STILL, STILL), "it has acknowledged some in between");
}

#[test]
fn whoever_reads_again_is_waited_for_again_unless_he_makes_a_habit_of_it() {
    let lag = Subscriber::default();
    stall(&lag, NOW);
    reads_down_to(&lag, 0);
    owe(&lag, LAG + 1);
    assert!(lag.is_behind(NOW + PATIENCE), "he has caught up");
    stall(&lag, NOW + 2 * PATIENCE);
    reads_down_to(&lag, 0);
    owe(&lag, LAG + 1);
    assert!(!lag.is_behind(NOW + 3 * PATIENCE), "the second time in a while");
    assert!(lag.is_behind(NOW + 3 * FORGIVEN));
    stall(&lag, NOW + 2 * MENDED);
    reads_down_to(&lag, 0);
    owe(&lag, LAG + 1);
    assert!(lag.is_behind(NOW + 2 * MENDED + PATIENCE), "a good while later");
}

#[test]
fn of_more_than_there_is_room_for_the_oldest_are_lost_and_that_is_known() {
    let subscriber = Subscriber::default();
    owe(&subscriber, QUEUE);
    assert_eq!(subscriber.take_missed(), None, "nothing is lost");
    for stamp in 7..1000 {
        subscriber.put(delivery(HEAVIEST, stamp), || true);
    }
    let waiting: Vec<u64> = std::iter::from_fn(|| Some(subscriber.next(true)?.message.stamp)).collect();
    let kept = QUEUE / HEAVIEST;
    assert_eq!(waiting, (1000 - kept as u64..1000).collect::<Vec<_>>());
    assert_eq!((subscriber.take_missed(), subscriber.take_missed()), (Some(0), None), "from when on it may not know it");
    assert_eq!((subscriber.lag.load(Ordering::Relaxed), subscriber.bytes()), (0, 0));
}

/// A long message weighs less than its size, so the bytes in the queue are limited too. A single message may be
/// longer than the limit. No short message is dropped because of a long one.
#[test]
fn there_is_an_end_to_the_bytes_of_what_waits() {
    let subscriber = Subscriber::default();
    subscriber.put(delivery(200, 77), || true);
    (0..9).for_each(|stamp| subscriber.put(delivery(QUEUE_BYTES / 4, stamp), || true));
    assert_eq!((subscriber.bytes(), subscriber.take_missed()), (3 * QUEUE_BYTES / 4 + 200, Some(0)));
    subscriber.put(delivery(2 * QUEUE_BYTES, 9), || true);
    assert_eq!(subscriber.bytes(), 2 * QUEUE_BYTES + 200);
    assert_eq!(subscriber.next(true).map(|first| first.message.stamp), Some(77));
}

/// No publisher waits for a subscriber that is away, however many messages wait for it.
#[test]
fn whoever_is_away_is_not_waited_for_and_whoever_is_gone_gets_nothing() {
    let readers = Arc::default();
    let mut subscription = Subscription::new(&readers);
    subscription.hold("a", Grant::at(Qos::One));
    let subscriber = Arc::clone(subscription.subscriber());
    owe(&subscriber, QUEUE);
    assert!(subscriber.is_behind(NOW));
    subscription.subscriber().go_away(true);
    assert!(!subscriber.is_behind(NOW) && readers.of("a", None).each.len() == 1);
    subscription.subscriber().come_back();
    assert!(subscriber.is_behind(NOW));
    drop(subscription);
    subscriber.put(delivery(200, 0), || true);
    assert!(!subscriber.is_behind(NOW) && subscriber.is_empty() && readers.of("a", None).is_empty());
}
