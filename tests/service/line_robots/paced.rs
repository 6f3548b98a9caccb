//! A robot of the line protocol at a port of this machine whose photos come as slowly as over a serial line: for what must happen meanwhile.
//! Its body is as simple as can be. What is seen at its port it tells, and when that was.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Stamp};
use hallsweep_core::event::{Capabilities, Obstacle, Photo, RobotEvent};
use hallsweep_core::robot::Parts;
use hallsweep_core::units::{Now, OrderId, Piece, Pose, WallTime};
use hallsweep_drivers::line::{BodyRequest, LineReader, LineRobot, RobotName};

/// The bytes of its photos.
pub(crate) const PHOTO: usize = 100_000;

/// Deadlines follow from it: nothing here comes to one.
const TIMES: Duration = Duration::from_secs(60);

/// So long the wire is listened to before more is written.
const TICK: Duration = Duration::from_millis(1);

/// What was seen at the robot's port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Seen {
    /// It began a step forward.
    Moves,
    /// It was told to halt.
    Halt,
    PhotoBegins,
    PhotoOver,
}

/// One robot, for one connection.
pub(crate) struct PacedRobot {
    /// Where it listens, as `127.0.0.1:40123`.
    pub(crate) place: String,
    pub(crate) seen: Receiver<(Seen, Instant)>,
    bytes_a_second: Arc<AtomicU64>,
}

impl PacedRobot {
    /// One whose photos come with so many bytes a second. When it meets luggage it has that in front of it from the beginning; else a step
    /// lasts until a halt.
    pub(crate) fn listening(bytes_a_second: u64, meets_luggage: bool) -> PacedRobot {
        let listener = TcpListener::bind("127.0.0.1:0").expect("this machine has a free port");
        let place = listener.local_addr().expect("it is bound").to_string();
        let bytes_a_second = Arc::new(AtomicU64::new(bytes_a_second));
        let (say, seen) = channel();
        let pace = Arc::clone(&bytes_a_second);
        std::thread::spawn(move || {
            let Ok((stream, _)) = listener.accept() else { return };
            // It ends with the connection.
            let _ = Life::new(stream, meets_luggage, pace, say).live();
        });
        PacedRobot { place, seen, bytes_a_second }
    }

    /// Lets photos come with so many bytes a second from now on.
    pub(crate) fn pace(&self, bytes_a_second: u64) {
        self.bytes_a_second.store(bytes_a_second, Ordering::Relaxed);
    }
}

struct Life {
    robot: LineRobot,
    stream: TcpStream,
    lines: LineReader,
    begun: Instant,
    meets_luggage: bool,
    /// The step that lasts until a halt.
    open: Option<OrderId>,
    /// The photo on its way, and how much of it is written.
    photo: Option<(Arc<[u8]>, usize)>,
    /// When the wire last took some of it.
    written: Duration,
    bytes_a_second: Arc<AtomicU64>,
    say: Sender<(Seen, Instant)>,
}

impl Life {
    fn new(stream: TcpStream, meets_luggage: bool, bytes_a_second: Arc<AtomicU64>, say: Sender<(Seen, Instant)>) -> Life {
        Life {
            robot: LineRobot::new(RobotName::new("paced").expect("it is a name")),
            stream,
            lines: LineReader::default(),
            begun: now(),
            meets_luggage,
            open: None,
            photo: None,
            written: Duration::ZERO,
            bytes_a_second,
            say,
        }
    }

    fn live(mut self) -> std::io::Result<()> {
        self.stream.set_nodelay(true)?;
        self.stream.set_read_timeout(Some(TICK))?;
        let can = Capabilities { step: TIMES, turn: TIMES, photo: TIMES, arm: TIMES, nudges: false, parts: Parts::ROUND_ROBOT };
        self.robot.handle_event(RobotEvent::LinkUp(can));
        let mut bytes = [0; 1024];
        loop {
            match self.stream.read(&mut bytes) {
                Ok(0) => return Ok(()),
                Ok(count) => self.hear(&bytes[..count]),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(error) => return Err(error),
            }
            self.robot.handle_timeout(self.now());
            while let Some(asked) = self.robot.poll_asked() {
                self.obey(asked);
            }
            self.write()?;
        }
    }

    fn hear(&mut self, bytes: &[u8]) {
        let heard = now();
        let texts = bytes.iter().filter_map(|byte| self.lines.take(*byte));
        for _ in texts.filter(|text| text.starts_with("h ")) {
            // Whoever no longer looks has seen enough.
            let _ = self.say.send((Seen::Halt, heard));
        }
        self.robot.handle_received(bytes, self.now());
    }

    fn obey(&mut self, asked: BodyRequest) {
        let event = match asked {
            BodyRequest::Halt => self.open.take().map(|id| RobotEvent::Halted(id, true)),
            BodyRequest::Led(_) => None,
            BodyRequest::Order(order) => match order.action {
                Action::Move(Move::Forward) if self.meets_luggage => {
                    Some(RobotEvent::Blocked(order.id, Obstacle::Luggage(Piece(1))))
                }
                Action::Move(Move::Forward) => {
                    self.open = Some(order.id);
                    let _ = self.say.send((Seen::Moves, now()));
                    None
                }
                Action::Photograph(_) => Some(RobotEvent::Photo(order.id, photo())),
                Action::Move(_) | Action::Recentre | Action::Enter | Action::Leave | Action::Arm(_) => {
                    Some(RobotEvent::Done(order.id))
                }
            },
        };
        if let Some(event) = event {
            self.robot.handle_event(event);
        }
    }

    /// Lines are written at once, photos as slowly as was asked for.
    fn write(&mut self) -> std::io::Result<()> {
        while self.write_photo()? {
            let Some(next) = self.robot.poll_output() else { break };
            if next.len() == PHOTO {
                self.photo = Some((next, 0));
                self.written = self.begun.elapsed();
                let _ = self.say.send((Seen::PhotoBegins, now()));
            } else {
                self.stream.write_all(&next)?;
            }
        }
        Ok(())
    }

    /// Writes as much of the photo as the wire has taken since it was written to last; whether none is left.
    fn write_photo(&mut self) -> std::io::Result<bool> {
        let Some((bytes, done)) = &mut self.photo else { return Ok(true) };
        let since = self.begun.elapsed() - self.written;
        let taken = u128::from(self.bytes_a_second.load(Ordering::Relaxed)) * since.as_micros() / 1_000_000;
        if taken == 0 {
            return Ok(false);
        }
        let piece = &bytes[*done..bytes.len().min(*done + taken as usize)];
        self.stream.write_all(piece)?;
        *done += piece.len();
        self.written += since;
        if *done < bytes.len() {
            return Ok(false);
        }
        self.photo = None;
        let _ = self.say.send((Seen::PhotoOver, now()));
        Ok(true)
    }

    fn now(&self) -> Now {
        Now { since_start: self.begun.elapsed(), wall: WallTime::default() }
    }
}

fn photo() -> Photo {
    let stamp = Stamp { pose: Pose::START, wall: WallTime::default() };
    let mut bytes = hallsweep_sim::camera::plan(stamp, None).bytes.to_vec();
    bytes.resize(PHOTO, 0);
    Photo { bytes: bytes.into(), media_type: "image/png" }
}

#[expect(clippy::disallowed_methods, reason = "the robot lives by the real clock")]
fn now() -> Instant {
    Instant::now()
}
