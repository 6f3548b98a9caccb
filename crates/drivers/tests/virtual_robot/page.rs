//! A double of the page in which the virtual robot stands: its room, its frames, its timers. The robot moves a fixed
//! way each frame, not each second, so a frame that is left out is a piece of way that is missing.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::time::Duration;

use hallsweep_drivers::{self as drivers, Extent, Room};

/// Half the side of the square as which the robot acts, in units: boxes grow by it.
const PADDING: f64 = 2.0;

#[derive(Clone, Debug)]
pub(crate) struct Thing {
    pub(crate) name: String,
    pub(crate) x: (f64, f64),
    pub(crate) z: (f64, f64),
}

/// A room as its scene file describes it, in units; x to the right, z down the page.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) floor: (f64, f64),
    pub(crate) player: (f64, f64),
    /// Units per frame.
    pub(crate) speed: f64,
    pub(crate) things: Vec<Thing>,
}

impl Scene {
    /// A room with four walls and nothing in it; the robot is in its north-western corner.
    pub(crate) fn empty(width: f64, height: f64) -> Scene {
        let mut scene = Scene { floor: (width, height), player: (0.0, 0.0), speed: 0.2, things: Vec::new() };
        scene.put("wallUp", (0.5, 0.99), (1.0, 0.01));
        scene.put("wallDown", (0.5, 0.01), (1.0, 0.01));
        scene.put("wallLeft", (0.01, 0.5), (0.01, 1.0));
        scene.put("wallRight", (0.99, 0.5), (0.01, 1.0));
        scene.player = (-width / 2.0 + 3.0, -height / 2.0 + 3.2);
        scene
    }

    /// Adds a box as the scene file has it: centre and size in fractions of the floor, y growing up the page.
    pub(crate) fn put(&mut self, name: &str, centre: (f64, f64), size: (f64, f64)) {
        let (width, height) = self.floor;
        let (x, z) = ((centre.0 - 0.5) * width, -(centre.1 - 0.5) * height);
        let (half_x, half_z) = (size.0 * width / 2.0 + PADDING, size.1 * height / 2.0 + PADDING);
        let thing = Thing { name: name.to_owned(), x: (x - half_x, x + half_x), z: (z - half_z, z + half_z) };
        self.things.push(thing);
    }

    /// Adds a box that covers the middle of the cell in this column and row, as the robot counts them.
    pub(crate) fn put_in_cell(&mut self, name: &str, column: i32, row: i32) {
        let (width, height) = self.floor;
        let (x, z) = (self.player.0 + 4.0 * f64::from(column), self.player.1 + 4.0 * f64::from(row));
        self.put(name, (x / width + 0.5, -z / height + 0.5), (1.0 / width, 1.0 / height));
    }

    pub(crate) fn told(&self) -> Room {
        let (px, pz) = self.player;
        let extent = |x: (f64, f64), z: (f64, f64)| Extent {
            x: ((x.0 - px) / 4.0, (x.1 - px) / 4.0),
            y: ((z.0 - pz) / 4.0, (z.1 - pz) / 4.0),
        };
        let things =
            self.things.iter().map(|thing| drivers::Thing { name: thing.name.clone(), extent: extent(thing.x, thing.z) });
        let (half_x, half_z) = (self.floor.0 / 2.0, self.floor.1 / 2.0);
        Room { floor: extent((-half_x, half_x), (-half_z, half_z)), things: things.collect(), moving: Vec::new() }
    }

    /// Distance of this point within something, or beyond the border, in units; negative where it is clear.
    pub(crate) fn depth(&self, (x, z): (f64, f64)) -> f64 {
        let within = |at: f64, (least, most): (f64, f64)| (at - least).min(most - at);
        let border = (x.abs() - self.floor.0 / 2.0).max(z.abs() - self.floor.1 / 2.0);
        self.things.iter().map(|thing| within(x, thing.x).min(within(z, thing.z))).fold(border, f64::max)
    }

    fn collision(&self, (x, z): (f64, f64)) -> Option<&str> {
        if x.abs() > self.floor.0 / 2.0 || z.abs() > self.floor.1 / 2.0 {
            return Some("floor-border");
        }
        let within = |place: f64, (least, most): (f64, f64)| place >= least && place <= most;
        self.things.iter().find(|thing| within(x, thing.x) && within(z, thing.z)).map(|thing| thing.name.as_str())
    }
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Command {
    Forward(i64),
    Backward(i64),
    Left(u64),
    Right(u64),
    Alarm,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Told {
    Collision(String),
    /// A turn or a timed translation has come to its end, whether the robot was stopped before or not.
    EndOfMove(&'static str),
    /// An alarm has stopped it, whatever it did.
    Halted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    Frame,
    ForwardTimer(u64),
    BackwardTimer(u64),
}

/// The time to the next frame.
pub(crate) type Frames = Box<dyn FnMut() -> Duration + Send>;

pub(crate) struct Page {
    pub(crate) scene: Scene,
    pub(crate) at: (f64, f64),
    /// Quarter turns to the left since the robot faced down the page, while it does not rotate.
    pub(crate) angle: f64,
    rotation: Option<(f64, f64, Duration, Duration)>,
    forward: bool,
    backward: bool,
    timers: [u64; 2],
    frames: Frames,
    due: BTreeMap<(Duration, u64), Event>,
    count: u64,
    now: Duration,
    pub(crate) told: Vec<(Duration, Told)>,
    /// Whether an alarm stops a rotation, as in later versions of the page.
    pub(crate) turns_halt: bool,
    rotating: &'static str,
}

impl Page {
    /// Moves the robot to the right by this much, or to the left, where nothing stands.
    pub(crate) fn push(&mut self, units: f64) {
        let (x, z) = match self.angle.rem_euclid(4.0) as u8 {
            0 => (self.at.0 - units, self.at.1),
            1 => (self.at.0, self.at.1 + units),
            2 => (self.at.0 + units, self.at.1),
            _ => (self.at.0, self.at.1 - units),
        };
        if self.scene.collision((x, z)).is_none() {
            self.at = (x, z);
        }
    }

    pub(crate) fn open(scene: Scene, frames: Frames, now: Duration) -> Page {
        let mut page = Page {
            at: scene.player,
            scene,
            angle: 0.0,
            rotation: None,
            forward: false,
            backward: false,
            timers: [0; 2],
            frames,
            due: BTreeMap::new(),
            count: 0,
            now,
            told: Vec::new(),
            turns_halt: false,
            rotating: "",
        };
        page.plan(now, Event::Frame);
        page
    }

    /// Sixty frames a second.
    pub(crate) fn steady() -> Frames {
        Box::new(|| Duration::from_micros(16_667))
    }

    pub(crate) fn next(&self) -> Option<Duration> {
        self.due.keys().next().map(|(at, _)| *at)
    }

    pub(crate) fn pass_to(&mut self, now: Duration) {
        while let Some(entry) = self.due.first_entry().filter(|entry| entry.key().0 <= now) {
            let ((at, _), event) = entry.remove_entry();
            self.now = at;
            match event {
                Event::Frame => self.frame(),
                Event::ForwardTimer(timer) if timer == self.timers[0] => self.timer_ends(true),
                Event::BackwardTimer(timer) if timer == self.timers[1] => self.timer_ends(false),
                Event::ForwardTimer(_) | Event::BackwardTimer(_) => {}
            }
        }
        self.now = now;
    }

    pub(crate) fn command(&mut self, command: &Command, now: Duration) {
        self.pass_to(now);
        match *command {
            Command::Forward(ms) => {
                (self.forward, self.timers[0]) = (true, self.timers[0] + 1);
                self.time(ms, Event::ForwardTimer(self.timers[0]));
            }
            Command::Backward(ms) => {
                (self.backward, self.timers[1]) = (true, self.timers[1] + 1);
                self.time(ms, Event::BackwardTimer(self.timers[1]));
            }
            Command::Left(ms) => self.rotate(1.0, ms, "turnLeft"),
            Command::Right(ms) => self.rotate(-1.0, ms, "turnRight"),
            Command::Alarm => {
                self.stop();
                if self.turns_halt && self.rotation.is_some() {
                    self.angle = self.angle_now();
                    self.rotation = None;
                }
                self.told.push((self.now, Told::Halted));
            }
        }
    }

    /// Sets the rate of the frames from here on.
    pub(crate) fn draw(&mut self, frames: Frames) {
        self.frames = frames;
    }

    /// The cell of the robot's own count in which its centre is, and its greatest distance from that cell's centre on
    /// an axis, in cells.
    pub(crate) fn cell(&self) -> ((i32, i32), f64) {
        let along = |at: f64, from: f64| (at - from) / 4.0;
        let (x, y) = (along(self.at.0, self.scene.player.0), along(self.at.1, self.scene.player.1));
        #[expect(clippy::cast_possible_truncation, reason = "a room has some hundred cells")]
        let cell = (x.round() as i32, y.round() as i32);
        (cell, (x - x.round()).abs().max((y - y.round()).abs()))
    }

    pub(crate) fn is_moving(&self) -> bool {
        self.forward || self.backward || self.rotation.is_some()
    }

    fn plan(&mut self, at: Duration, event: Event) {
        self.count += 1;
        self.due.insert((at, self.count), event);
    }

    fn time(&mut self, ms: i64, event: Event) {
        if let Ok(ms) = u64::try_from(ms) {
            self.plan(self.now + Duration::from_millis(ms), event);
        }
    }

    fn timer_ends(&mut self, forward: bool) {
        let name = if forward { "moveForward" } else { "moveBackward" };
        *(if forward { &mut self.forward } else { &mut self.backward }) = false;
        self.told.push((self.now, Told::EndOfMove(name)));
    }

    fn rotate(&mut self, quarters: f64, ms: u64, name: &'static str) {
        if self.rotation.is_none() {
            let ends = self.now + Duration::from_millis(ms.saturating_sub(50));
            self.rotation = Some((self.angle, self.angle + quarters, self.now, ends));
            self.rotating = name;
        }
    }

    fn angle_now(&self) -> f64 {
        let Some((from, to, began, ends)) = self.rotation else { return self.angle };
        let part = (self.now - began).as_secs_f64() / (ends - began).as_secs_f64().max(1e-9);
        let eased = if part < 0.5 { 2.0 * part * part } else { 1.0 - 2.0 * (1.0 - part).powi(2) };
        from + (to - from) * eased.clamp(0.0, 1.0)
    }

    fn stop(&mut self) {
        (self.forward, self.backward) = (false, false);
    }

    fn frame(&mut self) {
        let wait = (self.frames)();
        self.plan(self.now + wait, Event::Frame);
        if let Some((_, to, _, ends)) = self.rotation.filter(|(.., ends)| *ends <= self.now) {
            self.angle = to;
            self.rotation = None;
            self.told.push((self.now.max(ends), Told::EndOfMove(self.rotating)));
        }
        if !self.forward && !self.backward {
            // In the real page something that moves may touch it while it stands; nothing does here.
            return;
        }
        let sign = if self.backward { -1.0 } else { 1.0 };
        let angle = self.angle_now() * FRAC_PI_2;
        let way = self.scene.speed * sign;
        let to = (way.mul_add(angle.sin(), self.at.0), way.mul_add(angle.cos(), self.at.1));
        match self.scene.collision(to) {
            Some(name) => {
                self.told.push((self.now, Told::Collision(name.to_owned())));
                self.stop();
            }
            None => self.at = to,
        }
    }
}
