//! The real doors on the real main loop, for the test of STOP and its benchmark. The robot executes every order and
//! reports each step that it began after the STOP had been answered. The robot meets nothing, because the search does
//! not matter here.
//!
//! ```text
//!   client ─ HTTP, CoAP, MQTT ─► door ─► loop ─► Wheels ─► Watched { began, late }
//!                                 └─ halt ─────────┘         ▲ standing: set by the client from the answer to STOP
//!                                                              until the next START
//! ```

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::sync::{oneshot, watch};

use hallsweep::access::Access;
use hallsweep::doors::coap::{self, Resources, Socket};
use hallsweep::doors::http::{self, Front, HallDoor, Halls};
use hallsweep::runtime::archive_reader::ArchiveReader;
use hallsweep::runtime::clock::Clock;
use hallsweep::runtime::halt::{Halter, Halts};
use hallsweep::runtime::link::{RobotSide, Stamped, link};
use hallsweep::runtime::store::Store;
use hallsweep::runtime::task::{Course, Task};
use hallsweep::storage::sqlite::MemoryStore;
use hallsweep_core::engine::Engine;
use hallsweep_core::event::{Capabilities, RobotEvent};
use hallsweep_core::hall::HallId;
use hallsweep_core::hold::Hold;
use hallsweep_core::robot::{Parts, RobotId};
use hallsweep_core::settings::Settings;
use hallsweep_core::units::Epoch;

#[path = "broker.rs"]
mod broker;

/// Duration of a step or a turn: short, so that many steps begin.
const STEP: Duration = Duration::from_millis(2);

/// Observations of the robot.
pub(crate) struct Watched {
    /// Number of steps begun.
    pub(crate) began: AtomicU64,
    /// Number of steps begun while the robot had to stand.
    pub(crate) late: AtomicU64,
    /// Set by the client when it has read the answer to its STOP, and cleared just before it sends START.
    pub(crate) standing: AtomicBool,
    /// Called with every halt that reaches the robot's port.
    on_halt: Box<dyn Fn(Halts) + Send + Sync>,
}

/// Running app, which ends when this value is dropped.
pub(crate) struct TestApp {
    pub(crate) address: SocketAddr,
    /// Address of the CoAP door.
    pub(crate) coap: SocketAddr,
    /// Address of the MQTT door.
    pub(crate) mqtt: SocketAddr,
    pub(crate) watched: Arc<Watched>,
    closing: watch::Sender<bool>,
    course: watch::Sender<Course>,
    _door: oneshot::Sender<()>,
}

impl TestApp {
    /// Opens the doors on free local ports. Must be called inside a runtime, whose threads run everything.
    pub(crate) async fn open(store: Box<dyn Store>, on_halt: impl Fn(Halts) + Send + Sync + 'static) -> TestApp {
        let (clock, halter) = (Clock::default(), Halter::new(Epoch(0)));
        let (link, side) = link(halter.watch());
        let engine = Engine::new(Settings::default(), Default::default(), "stops".into());
        let (handle, task) = Task::new(engine, [(RobotId::discovery(), link)], store, clock, halter);
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("this machine has a free port");
        let address = listener.local_addr().expect("a bound socket has an address");
        let (closing, closed) = watch::channel(false);
        let (end, ended) = oneshot::channel();
        let reader = ArchiveReader::new(MemoryStore::new().archive());
        let socket = std::net::UdpSocket::bind("127.0.0.1:0").expect("this machine has a free port");
        let coap = socket.local_addr().expect("a bound socket has an address");
        let socket = Socket::new(socket).expect("it can be waited for");
        let mqtt = broker::open(handle.clone(), closed.clone()).await;
        let (states, resources) = (handle.watch(), Resources::new(handle.clone(), reader.clone(), false));
        let mut until = closed;
        let coap_ended = async move { drop(until.wait_for(|closing| *closing).await) };
        let mut seen = handle.watch();
        let main = HallId::new("main").expect("a plain name");
        let halls = Halls::new(main, HallDoor::new(handle, reader, "bench"), Access::Open, None);
        let (began, late, standing) = (AtomicU64::new(0), AtomicU64::new(0), AtomicBool::new(true));
        let watched = Arc::new(Watched { began, late, standing, on_halt: Box::new(on_halt) });
        let (course, coursed) = watch::channel(Course::default());
        tokio::spawn(task.run(coursed));
        tokio::spawn(coap::serve(socket, [7; 32], resources, states, coap_ended));
        tokio::spawn(Wheels { side, watched: Arc::clone(&watched) }.run());
        tokio::spawn(http::serve(listener.into(), halls, Front::default(), async { drop(ended.await) }));
        // A START before the link is up is refused.
        let linked = seen.wait_for(|snapshot| !snapshot.mission.holds.contains(&Hold::RobotLink)).await;
        drop(linked.expect("the loop runs"));
        TestApp { address, coap, mqtt, watched, closing, course, _door: end }
    }
}

impl Drop for TestApp {
    fn drop(&mut self) {
        self.closing.send_replace(true);
        self.course.send_modify(|course| course.is_over = true);
    }
}

struct Wheels {
    side: RobotSide,
    watched: Arc<Watched>,
}

impl Wheels {
    async fn run(mut self) {
        let can =
            Capabilities { step: STEP, turn: STEP, photo: STEP, arm: Duration::ZERO, nudges: false, parts: Parts::ROUND_ROBOT };
        let mut report = RobotEvent::LinkUp(can);
        while self.side.reports.send(report).await.is_ok() {
            report = tokio::select! {
                biased;
                halts = self.side.halts.raised() => {
                    (self.watched.on_halt)(halts);
                    RobotEvent::Sonar(None)
                }
                order = self.side.orders.recv() => match order {
                    Some(order) => self.obey(order).await,
                    None => return,
                },
            };
        }
    }

    /// Begins an order if no halt forbids it. `standing` is read first: a STOP that is answered after this read has
    /// raised the halts before its answer, so a step that passes both checks violates the rule.
    async fn obey(&mut self, Stamped { order, halts }: Stamped) -> RobotEvent {
        let must_stand = self.watched.standing.load(Ordering::SeqCst);
        if halts < self.side.halts.now().count {
            return RobotEvent::Halted(order.id, false);
        }
        if order.action.is_motion() {
            self.watched.began.fetch_add(1, Ordering::SeqCst);
            self.watched.late.fetch_add(u64::from(must_stand), Ordering::SeqCst);
        }
        tokio::select! {
            biased;
            halts = self.side.halts.raised() => {
                (self.watched.on_halt)(halts);
                RobotEvent::Halted(order.id, true)
            }
            () = tokio::time::sleep(STEP) => RobotEvent::Done(order.id),
        }
    }
}
