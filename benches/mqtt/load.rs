//! The load: one publisher and some subscribers in one thread. Every subscriber counts the messages by their numbers.
//! The publisher never waits, or limits the messages on the way to `window`.

use std::cell::{Cell, RefCell};
use std::net::SocketAddr;
use std::rc::Rc;
use std::time::{Duration, Instant};

use tokio::sync::Notify;
use tokio::task::LocalSet;
use tokio::time::timeout;

use crate::frame;
use crate::wire::Wire;

/// Payload size in bytes.
pub(crate) const LENGTH: usize = 100;

/// Topic of all messages.
const TOPIC: &str = "bench/load";

/// Maximum number of messages per write.
const BATCH: u64 = 128;

/// Maximum number of unacknowledged publications at QoS 1.
const UNACKNOWLEDGED: u64 = 100;

/// Time without a message after which the missing messages count as lost.
const SILENCE: Duration = Duration::from_secs(1);

/// Description of one turn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    pub(crate) qos: u8,
    pub(crate) subscribers: usize,
    /// Maximum number of messages and maximum time; the turn ends at the first of both.
    pub(crate) messages: u64,
    pub(crate) lasting: Duration,
    /// Maximum number of messages on the way to the slowest subscriber; `None` means no limit.
    pub(crate) window: Option<u64>,
}

/// Result of one turn.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    /// Time from the first message sent to the last message received.
    pub(crate) elapsed: Duration,
    /// Messages received by all subscribers together.
    pub(crate) came: u64,
    /// Messages not received.
    pub(crate) lost: u64,
    /// Messages received twice, or after one with a higher number.
    pub(crate) disordered: u64,
}

/// State that the publisher shares with the subscribers.
struct Course {
    /// For each subscriber, the number after the last received message.
    next: RefCell<Vec<u64>>,
    came: Cell<u64>,
    disordered: Cell<u64>,
    last: Cell<Option<Instant>>,
    sent: Cell<u64>,
    progress: Notify,
}

impl Course {
    fn of(subscribers: usize) -> Rc<Course> {
        Rc::new(Course {
            next: RefCell::new(vec![0; subscribers]),
            came: Cell::new(0),
            disordered: Cell::new(0),
            last: Cell::new(None),
            sent: Cell::new(0),
            progress: Notify::new(),
        })
    }

    /// Lowest number of a message that the slowest subscriber has not received yet.
    fn least(&self) -> u64 {
        self.next.borrow().iter().copied().min().unwrap_or(0)
    }

    /// Waits for the next message; false when none comes within `SILENCE`.
    async fn goes_on(&self) -> bool {
        timeout(SILENCE, self.progress.notified()).await.is_ok()
    }
}

pub(crate) fn run(server: SocketAddr, load: Load) -> std::io::Result<Outcome> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    LocalSet::new().block_on(&runtime, turn(server, load))
}

async fn turn(server: SocketAddr, load: Load) -> std::io::Result<Outcome> {
    let course = Course::of(load.subscribers);
    let mut listening = Vec::new();
    for number in 0..load.subscribers {
        let mut wire = Wire::connect(server, &format!("subscriber-{number}")).await?;
        wire.subscribe(TOPIC, load.qos).await?;
        listening.push(tokio::task::spawn_local(listen(wire, number, Rc::clone(&course))));
    }
    let wire = Wire::connect(server, "publisher").await?;
    let mut publisher = Publisher { wire, load, course: Rc::clone(&course), acknowledged: 0, given_up: 0, out: Vec::new() };
    let began = Instant::now();
    publisher.publish(began + load.lasting).await?;
    while course.least() < course.sent.get() && course.goes_on().await {}
    for subscriber in listening {
        if subscriber.is_finished() {
            return Err(std::io::Error::other("a subscriber was disconnected"));
        }
        subscriber.abort();
    }
    let (came, all) = (course.came.get(), course.sent.get() * load.subscribers as u64);
    let elapsed = course.last.get().unwrap_or(began) - began;
    Ok(Outcome { elapsed, came, lost: all - came, disordered: course.disordered.get() })
}

struct Publisher {
    wire: Wire,
    load: Load,
    course: Rc<Course>,
    /// Number of acknowledged publications.
    acknowledged: u64,
    /// Number before which missing messages are no longer waited for.
    given_up: u64,
    out: Vec<u8>,
}

impl Publisher {
    async fn publish(&mut self, until: Instant) -> std::io::Result<()> {
        while self.course.sent.get() < self.load.messages && Instant::now() < until {
            self.hear();
            if self.unacknowledged() >= UNACKNOWLEDGED {
                self.wire.read().await?;
            } else if self.under_way() * 4 > self.load.window.map_or(u64::MAX, |window| window * 3) {
                // Three quarters of the window are on the way. Waiting here avoids writing a few messages at a time.
                if !self.course.goes_on().await {
                    self.given_up = self.course.sent.get();
                }
            } else {
                self.send().await?;
                // The subscribers run on the same thread.
                tokio::task::yield_now().await;
            }
        }
        while self.unacknowledged() > 0 && timeout(SILENCE, self.wire.read()).await.is_ok() {
            self.hear();
        }
        Ok(())
    }

    /// Sends as many messages as the limits allow now.
    async fn send(&mut self) -> std::io::Result<()> {
        let sent = self.course.sent.get();
        let mut count = BATCH.min(self.load.messages - sent);
        if self.load.qos > 0 {
            count = count.min(UNACKNOWLEDGED - self.unacknowledged());
        }
        self.out.clear();
        for sequence in sent..sent + count {
            let id = (sequence % 65_000 + 1) as u16;
            frame::publish(&mut self.out, TOPIC, self.load.qos, id, sequence, LENGTH);
        }
        self.wire.write(&self.out).await?;
        self.course.sent.set(sent + count);
        Ok(())
    }

    /// Counts the acknowledgements received.
    fn hear(&mut self) {
        while let Some((first, _)) = self.wire.next() {
            self.acknowledged += u64::from(first >> 4 == frame::PUBACK);
        }
    }

    fn unacknowledged(&self) -> u64 {
        if self.load.qos > 0 { self.course.sent.get() - self.acknowledged } else { 0 }
    }

    fn under_way(&self) -> u64 {
        if self.load.window.is_none() {
            return 0;
        }
        self.course.sent.get() - self.course.least().max(self.given_up)
    }
}

/// Counts and acknowledges messages until the server closes the connection.
async fn listen(mut wire: Wire, number: usize, course: Rc<Course>) {
    let mut acknowledgements = Vec::new();
    let mut next = 0;
    while wire.read().await.is_ok() {
        let (mut came, mut disordered) = (0, 0);
        while let Some((first, body)) = wire.next() {
            if first >> 4 != frame::PUBLISH {
                continue;
            }
            let (id, sequence) = frame::published(first, body);
            if let Some(id) = id {
                frame::puback(&mut acknowledgements, id);
            }
            if sequence < next {
                disordered += 1;
            } else {
                came += 1;
                next = sequence + 1;
            }
        }
        course.disordered.set(course.disordered.get() + disordered);
        if came > 0 {
            course.came.set(course.came.get() + came);
            course.next.borrow_mut()[number] = next;
            course.last.set(Some(Instant::now()));
            course.progress.notify_one();
        }
        if wire.write(&acknowledgements).await.is_err() {
            break;
        }
        acknowledgements.clear();
    }
}
