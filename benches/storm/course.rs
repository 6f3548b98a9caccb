//! One running flood: the addresses of the doors, the tokens that it uses, its tally, and its end. `floods` lists the
//! floods.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{sleep, spawn};
use std::time::Duration;

/// Pause before a refused client tries again.
const AGAIN: Duration = Duration::from_millis(10);

/// Names of the keys: two operators and the viewer.
pub(crate) const OPERATOR: &str = "operator";
pub(crate) const SECOND: &str = "second";
pub(crate) const VIEWER: &str = "viewer";

/// Addresses of the doors of one program, and the tokens that they accept.
#[derive(Clone, Debug)]
pub(crate) struct Doors {
    pub(crate) http: SocketAddr,
    pub(crate) coap: SocketAddr,
    pub(crate) mqtt: SocketAddr,
    pub(crate) operator: String,
    pub(crate) second: String,
    pub(crate) viewer: String,
}

impl Doors {
    /// Placeholder without a real door or token.
    pub(crate) fn nowhere() -> Doors {
        let nowhere = SocketAddr::from(([127, 0, 0, 1], 9));
        let [operator, second, viewer] = ["-", "-", "-"].map(str::to_owned);
        Doors { http: nowhere, coap: nowhere, mqtt: nowhere, operator, second, viewer }
    }

    /// Converts to arguments of a command line.
    pub(crate) fn words(&self) -> [String; 6] {
        let Doors { http, coap, mqtt, operator, second, viewer } = self;
        [http.to_string(), coap.to_string(), mqtt.to_string(), operator.clone(), second.clone(), viewer.clone()]
    }

    /// Parses the arguments that `words` makes.
    pub(crate) fn read(words: &[String]) -> Doors {
        let [http, coap, mqtt, operator, second, viewer] = words else { panic!("three addresses and three tokens: {words:?}") };
        let address = |word: &String| word.parse().expect("an address with a port");
        let [operator, second, viewer] = [operator, second, viewer].map(String::clone);
        Doors { http: address(http), coap: address(coap), mqtt: address(mqtt), operator, second, viewer }
    }
}

pub(crate) struct Course {
    pub(crate) doors: Doors,
    done: AtomicU64,
    turned_away: AtomicU64,
    /// Number of parts that still prepare what the flood needs.
    preparing: AtomicU64,
    is_over: AtomicBool,
}

impl Course {
    pub(crate) fn new(doors: Doors) -> Arc<Course> {
        let (done, turned_away, preparing) = (AtomicU64::new(0), AtomicU64::new(0), AtomicU64::new(0));
        Arc::new(Course { doors, done, turned_away, preparing, is_over: AtomicBool::new(false) })
    }

    /// Starts `count` clients; each runs again when it ends or is refused, until the flood is over.
    pub(crate) fn clients(self: &Arc<Course>, count: usize, client: fn(&Course, usize) -> io::Result<()>) {
        for n in 0..count {
            let course = Arc::clone(self);
            spawn(move || {
                while course.goes_on() {
                    if client(&course, n).is_err() {
                        course.turned_away.fetch_add(1, Ordering::Relaxed);
                        sleep(AGAIN);
                    }
                }
            });
        }
    }

    /// Runs a preparation that must end before the flood counts as begun.
    pub(crate) fn prepare(self: &Arc<Course>, what: impl FnOnce(&Course) -> io::Result<()> + Send + 'static) {
        self.preparing.fetch_add(1, Ordering::SeqCst);
        let course = Arc::clone(self);
        spawn(move || {
            // A failed preparation shows in the flood's tally.
            if what(&course).is_err() {
                course.turned_away.fetch_add(1, Ordering::Relaxed);
            }
            course.preparing.fetch_sub(1, Ordering::SeqCst);
        });
    }

    /// Counts requests, packets, datagrams or connections.
    pub(crate) fn did(&self, more: usize) {
        self.done.fetch_add(more as u64, Ordering::Relaxed);
    }

    pub(crate) fn goes_on(&self) -> bool {
        !self.is_over.load(Ordering::SeqCst)
    }

    pub(crate) fn is_prepared(&self) -> bool {
        self.preparing.load(Ordering::SeqCst) == 0
    }

    /// Ends the flood; its clients leave within a second.
    pub(crate) fn end(&self) {
        self.is_over.store(true, Ordering::SeqCst);
    }

    /// Number of actions done, and number of refusals.
    pub(crate) fn tally(&self) -> (u64, u64) {
        (self.done.load(Ordering::Relaxed), self.turned_away.load(Ordering::Relaxed))
    }
}
