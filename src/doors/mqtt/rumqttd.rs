//! rumqttd as the router of our own broker, if the settings choose it. It runs in this process without a port, and is
//! used through its links. rumqttd is fast, but checks no rights. So it gets only topics and filters, with a prefix
//! of ours, and the numbers of messages. The messages themselves stay here. If its thread panics or hangs, a new
//! rumqttd replaces it, and every message under way is delivered directly.
//!
//! ```text
//!   carry ─► transit: number, RoutedDelivery         orders ─► a thread that may be kept waiting ─► links ─► rumqttd
//!                 ▲ arrive                                                                              │
//!                 └──────────────── a task for each link ◄──────────────────────────────────────────────┘
//! ```

use std::collections::{BTreeSet, HashMap, HashSet, VecDeque};
use std::hash::{BuildHasher, RandomState};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak, mpsc};
use std::time::Duration;

use bytes::Bytes;
use rumqttd::local::{LinkBuilder, LinkRx, LinkTx};
use rumqttd::{Notification, RouterConfig};
use tokio::runtime::Handle;
use tokio::task::JoinSet;

use crate::doors::connection_limits::CONNECTIONS;
use crate::runtime::clock::Clock;
use mqtt_gate::{RoutedDelivery, Router, Subscriber};

/// Maximum number of clients with a link to rumqttd. Connected, remembered and leaving clients count.
const LINKS: usize = 2 * CONNECTIONS;

/// Maximum number of topics and filters passed to one rumqttd. rumqttd never forgets any of them, so a new rumqttd
/// replaces it when this number is exceeded.
const SHOWN: usize = 16 * 1024;

/// Maximum number of messages under way through rumqttd. Beyond this number the oldest message is delivered directly.
const TRANSIT: usize = 4096;

/// Interval at which the program checks for late messages.
const GLANCE: Duration = Duration::from_millis(25);

/// Age at which a message counts as late. rumqttd takes less than a millisecond on a machine that is not busy. People
/// may notice a pause of 200 ms.
const LATE: Duration = Duration::from_millis(150);

/// Number of segments per filter in which rumqttd stores messages.
const SEGMENTS: usize = 3;

/// Size of a segment in bytes. While publishers wait for a subscriber, fewer bytes than this are under way to that
/// subscriber.
const SEGMENT_BYTES: usize = 256 * 1024;

/// Number of messages that rumqttd passes to one link before it serves the other links.
const BATCH: u64 = 200;

/// Prefix of every topic and filter: rumqttd panics when a topic does not begin with an ASCII character.
const WORD: &str = "t/";

#[derive(Clone, Debug)]
pub struct RumqttdRouter(Arc<Mutex<State>>);

#[derive(Debug)]
struct State {
    engine: Engine,
    /// All subscriptions. They are passed on to the next engine when the engine is replaced.
    subscribers: HashMap<usize, RouterReader>,
    /// Messages under way, oldest first. The first one has the number `first`.
    transit: VecDeque<(RoutedDelivery, Duration)>,
    first: u64,
    /// Hashes of the topics and filters passed to the engine. The engine never forgets a topic or filter.
    shown: HashSet<u64>,
    hasher: RandomState,
    work: Handle,
    clock: Clock,
}

#[derive(Debug)]
struct RouterReader {
    subscriber: Arc<Subscriber>,
    filters: BTreeSet<String>,
}

/// One rumqttd with the queue of its orders. When this value is dropped, its tasks end at once, and its threads end
/// when they notice.
#[derive(Debug)]
struct Engine {
    orders: mpsc::SyncSender<Order>,
    number: u64,
}

enum Order {
    Subscribe(String, Arc<Subscriber>),
    Unsubscribe(String, Arc<Subscriber>),
    Publish(String, u64),
    #[cfg(test)]
    Panic,
    #[cfg(test)]
    Hang,
}

impl RumqttdRouter {
    pub fn start(work: Handle) -> RumqttdRouter {
        RumqttdRouter(Arc::new_cyclic(|state| {
            let engine = Engine::start(0, state, &work);
            work.spawn(look_after(Weak::clone(state)));
            Mutex::new(State {
                engine,
                subscribers: HashMap::new(),
                transit: VecDeque::new(),
                first: 0,
                shown: HashSet::new(),
                hasher: RandomState::new(),
                work: work.clone(),
                clock: Clock::default(),
            })
        }))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        lock(&self.0)
    }
}

impl Router for RumqttdRouter {
    fn subscribe(&self, filter: &str, subscriber: &Arc<Subscriber>) {
        let mut state = self.state();
        let key = Arc::as_ptr(subscriber).addr();
        let reading = state
            .subscribers
            .entry(key)
            .or_insert_with(|| RouterReader { subscriber: Arc::clone(subscriber), filters: BTreeSet::new() });
        reading.filters.insert(filter.to_owned());
        state.order(Order::Subscribe(filter.to_owned(), Arc::clone(subscriber)), &self.0);
    }

    fn unsubscribe(&self, filter: &str, subscriber: &Arc<Subscriber>) {
        let mut state = self.state();
        // rumqttd may no longer deliver messages under way to this subscriber, so they are delivered now.
        state.transit.iter_mut().for_each(|(delivery, _)| delivery.arrive(subscriber));
        let key = Arc::as_ptr(subscriber).addr();
        if let Some(reading) = state.subscribers.get_mut(&key) {
            reading.filters.remove(filter);
            if reading.filters.is_empty() {
                state.subscribers.remove(&key);
            }
        }
        state.order(Order::Unsubscribe(filter.to_owned(), Arc::clone(subscriber)), &self.0);
    }

    fn carry(&self, delivery: RoutedDelivery) {
        let mut state = self.state();
        let (number, now) = (state.first + state.transit.len() as u64, state.clock.since_start());
        let topic = delivery.topic().to_owned();
        state.transit.push_back((delivery, now));
        state.order(Order::Publish(topic, number), &self.0);
        // The number of messages under way is limited. rumqttd may lag behind, while the publisher does not wait for
        // subscribers that do not read. Beyond the limit the oldest message is delivered directly.
        if state.transit.len() > TRANSIT {
            state.pass_first();
        }
    }
}

impl State {
    fn order(&mut self, order: Order, itself: &Arc<Mutex<State>>) {
        let name = match &order {
            Order::Subscribe(name, _) | Order::Unsubscribe(name, _) | Order::Publish(name, _) => name.as_str(),
            #[cfg(test)]
            Order::Panic | Order::Hang => "",
        };
        self.shown.insert(self.hasher.hash_one(name));
        let is_worn_out = self.shown.len() > SHOWN;
        match self.engine.orders.try_send(order) {
            Ok(()) if !is_worn_out => {}
            // rumqttd has too much to do. This message and all earlier ones are delivered directly.
            Err(mpsc::TrySendError::Full(Order::Publish(..))) => self.pass_all(),
            Ok(()) | Err(_) => self.renew(itself),
        }
    }

    /// Replaces the engine. Everything under way is delivered directly, because the old engine may never deliver it.
    fn renew(&mut self, itself: &Arc<Mutex<State>>) {
        self.pass_all();
        self.shown.clear();
        let number = self.engine.number + 1;
        tracing::debug!(number, "a new rumqttd routes MQTT messages from now on");
        self.engine = Engine::start(number, &Arc::downgrade(itself), &self.work);
        for RouterReader { subscriber, filters } in self.subscribers.values() {
            for filter in filters {
                let _ = self.engine.orders.try_send(Order::Subscribe(filter.clone(), Arc::clone(subscriber)));
            }
        }
    }

    fn pass_all(&mut self) {
        while !self.transit.is_empty() {
            self.pass_first();
        }
    }

    /// Drops the oldest delivery. This passes the message to every subscriber that has not received it yet.
    fn pass_first(&mut self) {
        if self.transit.pop_front().is_some() {
            self.first += 1;
        }
    }

    fn arrive(&mut self, number: u64, subscriber: &Arc<Subscriber>) {
        let place = number.checked_sub(self.first).and_then(|place| usize::try_from(place).ok());
        if let Some((delivery, _)) = place.and_then(|place| self.transit.get_mut(place)) {
            delivery.arrive(subscriber);
        }
        while self.transit.front().is_some_and(|(delivery, _)| delivery.is_over()) {
            self.pass_first();
        }
    }
}

async fn look_after(state: Weak<Mutex<State>>) {
    loop {
        tokio::time::sleep(GLANCE).await;
        let Some(state) = state.upgrade() else { return };
        let mut locked = lock(&state);
        let now = locked.clock.since_start();
        if locked.transit.front().is_some_and(|(_, since)| now >= *since + LATE) {
            tracing::warn!("rumqttd delays MQTT messages: a new rumqttd replaces it");
            locked.renew(&state);
        }
    }
}

impl Engine {
    fn start(number: u64, state: &Weak<Mutex<State>>, work: &Handle) -> Engine {
        let (orders, ordered) = mpsc::sync_channel(TRANSIT + 2 * SHOWN);
        let carrier = Carrier { state: Weak::clone(state), work: work.clone(), ordered };
        let thread = std::thread::Builder::new().name("mqtt-rumqttd".to_owned());
        // Without this thread no order is carried out. The first late message then replaces the engine.
        if let Err(error) = thread.spawn(move || carrier.run(number)) {
            tracing::error!(%error, "rumqttd cannot be started");
        }
        Engine { orders, number }
    }
}

/// Passes orders to one rumqttd. It has a thread of its own, because some orders wait for rumqttd's answer.
struct Carrier {
    state: Weak<Mutex<State>>,
    work: Handle,
    ordered: mpsc::Receiver<Order>,
}

struct RouterLink {
    to: LinkTx,
    subscriber: Arc<Mutex<Arc<Subscriber>>>,
    filters: usize,
}

impl Carrier {
    fn run(self, number: u64) {
        let requests = rumqttd::Router::new(usize::try_from(number).unwrap_or(0), config()).spawn();
        // rumqttd has no function that ends its router's thread, and the thread would keep all its memory. A request
        // for an unknown connection makes the thread panic, which ends it.
        let end = || LinkTx::new(rumqttd::ConnectionId::MAX, requests.clone(), Arc::default()).shadow("").is_ok();
        let link = |name: String| LinkBuilder::new(&name, requests.clone()).build().ok().map(|(to, from, _)| (to, from));
        let Some((mut publisher, _unread)) = link("publisher".to_owned()) else { return };
        let (mut links, mut idle, mut made): (HashMap<usize, RouterLink>, Vec<RouterLink>, usize) =
            (HashMap::new(), Vec::new(), 0);
        let mut coming = JoinSet::new();
        for order in &self.ordered {
            let done = match order {
                #[cfg(test)]
                Order::Panic => end(),
                #[cfg(test)]
                Order::Hang => loop {
                    std::thread::park();
                },
                Order::Publish(topic, number) => {
                    publisher.publish(format!("{WORD}{topic}"), Bytes::copy_from_slice(&number.to_be_bytes())).is_ok()
                }
                Order::Subscribe(filter, subscriber) => {
                    let key = Arc::as_ptr(&subscriber).addr();
                    if let std::collections::hash_map::Entry::Vacant(place) = links.entry(key) {
                        let link = match idle.pop() {
                            Some(link) => Some(link),
                            None if made >= LINKS => None,
                            None => link(format!("link{made}")).map(|(to, from)| {
                                made += 1;
                                let whose = Arc::new(Mutex::new(Arc::clone(&subscriber)));
                                coming.spawn_on(come(from, Arc::clone(&whose), Weak::clone(&self.state)), &self.work);
                                RouterLink { to, subscriber: whose, filters: 0 }
                            }),
                        };
                        let Some(link) = link else { return };
                        *lock(&link.subscriber) = subscriber;
                        place.insert(link);
                    }
                    links.get_mut(&key).is_some_and(|link| {
                        link.filters += 1;
                        link.to.subscribe(format!("{WORD}{filter}")).is_ok()
                    })
                }
                Order::Unsubscribe(filter, subscriber) => {
                    let key = Arc::as_ptr(&subscriber).addr();
                    links.remove(&key).is_none_or(|mut link| {
                        link.filters = link.filters.saturating_sub(1);
                        let done = link.to.unsubscribe(format!("{WORD}{filter}")).is_ok();
                        if link.filters == 0 {
                            idle.push(link);
                        } else {
                            links.insert(key, link);
                        }
                        done
                    })
                }
            };
            if !done {
                return;
            }
        }
        end();
    }
}

async fn come(mut from: LinkRx, whose: Arc<Mutex<Arc<Subscriber>>>, state: Weak<Mutex<State>>) {
    while let Ok(notification) = from.next().await {
        match notification {
            Some(Notification::Forward(forward)) => {
                let Ok(number) = <[u8; 8]>::try_from(&forward.publish.payload[..]) else { continue };
                let Some(state) = state.upgrade() else { return };
                let subscriber = Arc::clone(&lock(&whose));
                lock(&state).arrive(u64::from_be_bytes(number), &subscriber);
            }
            Some(Notification::Unschedule) => {
                if from.wake().await.is_err() {
                    return;
                }
            }
            Some(_) | None => {}
        }
    }
}

fn config() -> RouterConfig {
    RouterConfig {
        max_connections: LINKS + 8,
        max_outgoing_packet_count: BATCH,
        max_segment_size: SEGMENT_BYTES,
        max_segment_count: SEGMENTS,
        ..RouterConfig::default()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use mqtt_gate::Announcement;

    use super::*;
    use crate::doors::mqtt::session::testing::topics;
    use crate::runtime::tests::within::within;
    use mqtt_gate::{Broker, OwnSubscription};

    fn broker() -> (Broker, RumqttdRouter) {
        let router = RumqttdRouter::start(Handle::current());
        (Broker::with_router(topics(), router.clone()), router)
    }

    fn order(router: &RumqttdRouter, order: Order) {
        router.state().order(order, &router.0);
    }

    async fn next(reader: &OwnSubscription) -> String {
        let message = within("a message", reader.next()).await;
        format!("{}={}", message.topic(), String::from_utf8_lossy(message.payload()))
    }

    #[tokio::test]
    async fn messages_come_to_those_who_read_them_once_and_in_order() {
        let (broker, _router) = broker();
        let readers = [broker.subscribe(&["a/#", "a/+"]), broker.subscribe(&["#"]), broker.subscribe(&["b", "ü/+"])];
        for n in 0..1000 {
            broker.publish(&Announcement::passing("a/b", n.to_string().as_bytes()));
        }
        broker.publish(&Announcement::passing("ü/b", b"last"));
        broker.publish(&Announcement::passing("b", b"last"));
        for n in 0..1000 {
            assert_eq!([next(&readers[0]).await, next(&readers[1]).await], [format!("a/b={n}"), format!("a/b={n}")]);
        }
        for reader in &readers[1..] {
            let both = BTreeSet::from([next(reader).await, next(reader).await]);
            assert_eq!(both, BTreeSet::from(["b=last".to_owned(), "ü/b=last".to_owned()]));
        }
    }

    #[tokio::test]
    async fn when_it_dies_or_hangs_everything_comes_and_another_takes_its_place() {
        for (deaths, last) in [(1, false), (2, true)] {
            let (broker, router) = broker();
            let reader = broker.subscribe(&["a/#"]);
            for death in 1..=deaths {
                broker.publish(&Announcement::passing("a/before", b"1"));
                assert_eq!(next(&reader).await, "a/before=1");
                order(&router, if last { Order::Hang } else { Order::Panic });
                for n in 0..100 {
                    broker.publish(&Announcement::passing("a/meanwhile", n.to_string().as_bytes()));
                }
                for n in 0..100 {
                    assert_eq!(next(&reader).await, format!("a/meanwhile={n}"));
                }
                within("another", async {
                    while router.state().engine.number < death {
                        tokio::task::yield_now().await;
                    }
                })
                .await;
            }
            let newcomer = broker.subscribe(&["a/+"]);
            broker.publish(&Announcement::passing("a/after", b"2"));
            assert_eq!([next(&reader).await, next(&newcomer).await], ["a/after=2", "a/after=2"]);
        }
    }

    /// rumqttd never forgets a topic, so it is replaced after too many topics.
    #[tokio::test]
    async fn one_that_was_shown_too_much_is_replaced_and_nobody_notices() {
        let (broker, router) = broker();
        let reader = broker.subscribe(&["a/#"]);
        for n in 0..SHOWN + 100 {
            broker.publish(&Announcement::passing(&format!("a/{n}"), b""));
            if n % 100 == 0 {
                for k in n.saturating_sub(99)..=n {
                    assert_eq!(next(&reader).await, format!("a/{k}="));
                }
            }
        }
        assert!(router.state().engine.number >= 1 && router.state().shown.len() < SHOWN);
    }

    /// A link is used again for the next subscriber. Messages for the previous subscriber do not reach the next one.
    #[tokio::test]
    async fn whoever_lets_go_gets_nothing_more_and_his_link_serves_the_next() {
        let (broker, _router) = broker();
        let stays = broker.subscribe(&["a"]);
        for n in 0..2 * LINKS {
            let reader = broker.subscribe(&["a", "b"]);
            broker.publish(&Announcement::passing("a", n.to_string().as_bytes()));
            assert_eq!([next(&reader).await, next(&stays).await], [format!("a={n}"), format!("a={n}")]);
        }
    }
}
