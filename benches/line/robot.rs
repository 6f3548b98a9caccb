//! A robot on the line protocol that moves nothing, and tells what it sees on its wire. Its photos have 100 kB and take a tenth of a second.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use hallsweep_core::command::Move;
use hallsweep_core::effect::Action;
use hallsweep_core::event::{Capabilities, Obstacle, Parts, Photo, RobotEvent};
use hallsweep_core::units::{Now, OrderId};
use hallsweep_drivers::line::{Asked, LineReader, LineRobot, RobotName, ToRobot};

const MOVE: Duration = Duration::from_millis(200);
const PHOTO: usize = 100_000;

/// So much of a photo is sent before it listens again, for a millisecond or as long as the system makes of it.
const PIECE: usize = 4000;

/// What is waited for at most.
const PATIENCE: Duration = Duration::from_secs(20);

/// What was seen on the wire.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Seen {
    Motion,
    PhotoBegins,
    PhotoEnds,
    /// A halt came, at this time.
    Halt(Instant),
}

pub(crate) struct Robot {
    /// Where it listens.
    pub(crate) place: String,
    seen: Receiver<Seen>,
    meets: Arc<AtomicBool>,
}

impl Robot {
    pub(crate) fn listen() -> Robot {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port is free");
        let place = listener.local_addr().expect("it listens").to_string();
        let (say, seen) = channel();
        let meets = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&meets);
        std::thread::spawn(move || {
            let (stream, _) = listener.accept().expect("the program connects");
            Body::new(stream, say, flag).live();
        });
        Robot { place, seen, meets }
    }

    /// From now on every step forward meets something that it cannot name.
    pub(crate) fn meet_something(&self) {
        self.meets.store(true, Ordering::Relaxed);
    }

    /// Waits for something of this sort, and returns it. A halt must be later than the one that is given.
    pub(crate) fn until(&self, sort: Seen) -> Seen {
        loop {
            let seen = self.seen.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("the robot never saw {sort:?}"));
            let is_it = match (seen, sort) {
                (Seen::Halt(at), Seen::Halt(asked)) => at >= asked,
                (seen, sort) => std::mem::discriminant(&seen) == std::mem::discriminant(&sort),
            };
            if is_it {
                return seen;
            }
        }
    }
}

struct Body {
    stream: TcpStream,
    seen: Sender<Seen>,
    meets: Arc<AtomicBool>,
    robot: LineRobot,
    lines: LineReader,
    began: Instant,
    under_way: Option<(OrderId, Action, Instant)>,
    /// What is still to be sent, in pieces.
    pieces: VecDeque<Vec<u8>>,
}

impl Body {
    fn new(stream: TcpStream, seen: Sender<Seen>, meets: Arc<AtomicBool>) -> Body {
        stream.set_nodelay(true).expect("it is a socket");
        stream.set_read_timeout(Some(Duration::from_millis(1))).expect("it is a socket");
        let mut robot = LineRobot::new(RobotName::new("bench").expect("it is a name"));
        let photo = Duration::from_millis(500);
        let can = Capabilities { step: MOVE, turn: MOVE, photo, arm: MOVE, nudges: false, parts: Parts::ROUND_ROBOT };
        robot.handle_event(RobotEvent::LinkUp(can));
        let (lines, began, pieces) = (LineReader::default(), Instant::now(), VecDeque::new());
        Body { stream, seen, meets, robot, lines, began, under_way: None, pieces }
    }

    /// Until the program is gone.
    fn live(mut self) {
        let mut bytes = [0; 4096];
        loop {
            match self.stream.read(&mut bytes) {
                Ok(0) => return,
                Ok(count) => self.hear(&bytes[..count]),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(_) => return,
            }
            self.end_what_is_over();
            self.obey();
            if self.speak().is_err() {
                return;
            }
        }
    }

    fn hear(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if let Some(ToRobot::Halt(_)) = self.lines.take(*byte).and_then(|text| ToRobot::parse(&text)) {
                self.tell(Seen::Halt(Instant::now()));
            }
        }
        self.robot.handle_received(bytes, self.now());
    }

    fn end_what_is_over(&mut self) {
        let Some((id, action, _)) = self.under_way.take_if(|(_, _, ends)| *ends <= Instant::now()) else { return };
        let meets = self.meets.load(Ordering::Relaxed) && action == Action::Move(Move::Forward);
        self.robot.handle_event(match action {
            Action::Photograph(_) => RobotEvent::Photo(id, photo()),
            _ if meets => RobotEvent::Blocked(id, Obstacle::Unknown),
            Action::Move(_) | Action::Recentre | Action::Enter | Action::Leave | Action::Arm(_) => RobotEvent::Done(id),
        });
    }

    fn obey(&mut self) {
        self.robot.handle_timeout(self.now());
        while let Some(asked) = self.robot.poll_asked() {
            match asked {
                Asked::Order(order) if order.action.is_motion() => {
                    self.under_way = Some((order.id, order.action, Instant::now() + MOVE));
                    self.tell(Seen::Motion);
                }
                Asked::Order(order) => self.under_way = Some((order.id, order.action, Instant::now())),
                Asked::Halt => {
                    if let Some((id, ..)) = self.under_way.take() {
                        self.robot.handle_event(RobotEvent::Halted(id, true));
                    }
                }
                Asked::Led(_) => {}
            }
        }
    }

    /// One piece of a photo, or all lines that wait.
    fn speak(&mut self) -> std::io::Result<()> {
        while let Some(bytes) = self.robot.poll_output() {
            if bytes.len() >= PHOTO {
                self.tell(Seen::PhotoBegins);
            }
            self.pieces.extend(bytes.chunks(PIECE).map(<[u8]>::to_vec));
        }
        while let Some(piece) = self.pieces.pop_front() {
            self.stream.write_all(&piece)?;
            if piece.len() == PIECE {
                if self.pieces.front().is_none_or(|next| next.len() < PIECE) {
                    self.tell(Seen::PhotoEnds);
                }
                break;
            }
        }
        Ok(())
    }

    fn tell(&self, seen: Seen) {
        // Whoever no longer listens has seen enough.
        let _ = self.seen.send(seen);
    }

    fn now(&self) -> Now {
        Now { since_start: self.began.elapsed(), ..Now::default() }
    }
}

fn photo() -> Photo {
    let mut bytes = b"\xff\xd8\xff".to_vec();
    bytes.resize(PHOTO, 7);
    Photo { bytes: bytes.into(), media_type: "image/jpeg" }
}
