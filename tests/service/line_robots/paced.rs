//! A robot of the line protocol on a local port whose photos arrive as slowly as over a serial line, for tests of
//! what happens during a photo. Its body is minimal. It reports the events at its port with their times.

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

/// Size of a photo, in bytes.
pub(crate) const PHOTO: usize = 100_000;

/// Claimed duration of each action, from which deadlines follow. It is so long that no deadline expires.
const TIMES: Duration = Duration::from_secs(60);

/// Time for which the robot reads before it writes again.
const TICK: Duration = Duration::from_millis(1);

/// Event at the robot's port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Seen {
    /// The robot began a step forward.
    Moves,
    /// The robot was told to halt.
    Halt,
    PhotoBegins,
    PhotoOver,
}

/// A robot that serves one connection.
pub(crate) struct PacedRobot {
    /// Address of the robot, such as `127.0.0.1:40123`.
    pub(crate) place: String,
    pub(crate) seen: Receiver<(Seen, Instant)>,
    bytes_a_second: Arc<AtomicU64>,
}

impl PacedRobot {
    /// Starts a robot with this photo speed. With `meets_luggage` a piece of luggage is in front of the robot from
    /// the start; without it a step lasts until a halt.
    pub(crate) fn listening(bytes_a_second: u64, meets_luggage: bool) -> PacedRobot {
        let listener = TcpListener::bind("127.0.0.1:0").expect("this machine has a free port");
        let place = listener.local_addr().expect("it is bound").to_string();
        let bytes_a_second = Arc::new(AtomicU64::new(bytes_a_second));
        let (say, seen) = channel();
        let pace = Arc::clone(&bytes_a_second);
        std::thread::spawn(move || {
            let Ok((stream, _)) = listener.accept() else { return };
            // Ends with the connection.
            let _ = Life::new(stream, meets_luggage, pace, say).live();
        });
        PacedRobot { place, seen, bytes_a_second }
    }

    /// Changes the photo speed from now on.
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
    /// Step that lasts until a halt.
    open: Option<OrderId>,
    /// Photo in transmission, and the number of bytes already written.
    photo: Option<(Arc<[u8]>, usize)>,
    /// Time of the last write of photo bytes.
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
            // A test that has dropped its receiver needs no further events.
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

    /// Writes lines at once, and photos at the requested speed.
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

    /// Writes the photo bytes that are due since the last write. Returns whether no photo is left to write.
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
