//! Core, driver and a double of the virtual robot in one plain loop, in simulated time.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::command::{Accepted, Command, Door, Issuer, Request, Strategy};
use hallsweep_core::effect::Effect;
use hallsweep_core::engine::Engine;
use hallsweep_core::event::{Event, Photo, RobotEvent};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::RobotId;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Now, Ticket, WallTime};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_drivers::{Dialect, Driver, Output, Room, VirtualRobot};

use super::server::{Client, Server, Version};

pub(crate) const HERE: &str = "127.0.0.1";

/// Duration of connecting.
const CALL: Duration = Duration::from_millis(2);

pub(crate) const STEP: Duration = Duration::from_millis(333);

pub(crate) struct Rig {
    pub(crate) engine: Engine,
    pub(crate) driver: VirtualRobot,
    pub(crate) server: Server,
    pub(crate) now: Duration,
    client: Option<Client>,
    call: Option<Duration>,
    /// What the driver stored last.
    pub(crate) memory: String,
    answers: BTreeMap<Ticket, Result<Accepted, Refused>>,
    pub(crate) drawn: Vec<String>,
    pub(crate) reports: Vec<RobotEvent>,
    dialect: Dialect,
    /// What the scene file tells, where there is one.
    room: Option<Room>,
}

impl Rig {
    pub(crate) fn new(server: Server, strategy: Strategy) -> Rig {
        let dialect = if server.version == Version::First { Dialect::Semicolons } else { Dialect::Messages };
        Rig {
            engine: Engine::new(Settings::default(), strategy, Arc::from("virtual")),
            driver: VirtualRobot::new(dialect, STEP),
            server,
            now: Duration::ZERO,
            client: None,
            call: Some(Duration::ZERO),
            memory: String::new(),
            answers: BTreeMap::new(),
            drawn: Vec::new(),
            reports: Vec::new(),
            dialect,
            room: None,
        }
    }

    pub(crate) fn with_scene(server: Server, strategy: Strategy) -> Rig {
        let room = server.page.as_ref().expect("a page").scene.told();
        let mut rig = Rig::new(server, strategy);
        rig.driver = VirtualRobot::new(rig.dialect, STEP).in_room(room.clone());
        rig.room = Some(room);
        rig
    }

    /// The program is killed, and another one begins with what was stored.
    pub(crate) fn kill_driver(&mut self) {
        let driver = VirtualRobot::remembering(self.dialect, STEP, &self.memory).expect("what was written can be read");
        self.driver = match &self.room {
            Some(room) => driver.in_room(room.clone()),
            None => driver,
        };
        self.cut();
    }

    pub(crate) fn now(&self) -> Now {
        let unix_ms = 1_767_254_400_000 + i64::try_from(self.now.as_millis()).expect("a run is short");
        Now { since_start: self.now, wall: WallTime { unix_ms, offset_s: 0 } }
    }

    pub(crate) fn give(&mut self, command: Command) -> Result<Accepted, Refused> {
        let ticket = self.engine.handle_command(Request::new(command, Issuer::operator(Door::LOCAL)), self.now());
        self.settle();
        let ticket = ticket?;
        // A stop waits for the robot to stand.
        for _ in 0..200 {
            if let Some(answer) = self.answers.remove(&ticket) {
                return answer;
            }
            self.wait(Duration::from_millis(5));
        }
        panic!("a command was not answered")
    }

    pub(crate) fn stop(&mut self) {
        self.halt();
        self.give(Command::Stop).expect("STOP is always taken");
    }

    /// A STOP halts ahead of the command.
    pub(crate) fn halt(&mut self) {
        let raised = self.state().mission.epoch.next();
        self.engine.handle_halt(raised, self.now());
        self.settle();
    }

    pub(crate) fn wait(&mut self, time: Duration) {
        let end = self.now + time;
        while let Some(next) = self.next().filter(|next| *next <= end) {
            self.pass_to(next);
        }
        self.pass_to(end);
    }

    /// Lets time pass until `reached`, for this many seconds at most, and returns whether it was.
    pub(crate) fn until(&mut self, seconds: u64, mut reached: impl FnMut(&Snapshot) -> bool) -> bool {
        let end = self.now + Duration::from_secs(seconds);
        while self.now < end {
            if reached(&self.state()) {
                return true;
            }
            let next = self.next().unwrap_or(end).max(self.now + Duration::from_micros(1));
            self.pass_to(next.min(end));
        }
        reached(&self.state())
    }

    /// Answers every piece with safe until the phase is reached.
    pub(crate) fn explore(&mut self, seconds: u64) -> PhaseName {
        let end = self.now + Duration::from_secs(seconds);
        while self.now < end {
            let left = (end - self.now).as_secs() + 1;
            self.until(left, |state| {
                matches!(state.mission.phase, PhaseName::Explored | PhaseName::Fault) || state.pending().is_some()
            });
            let Some(pending) = self.state().pending().map(|luggage| luggage.id) else { break };
            let verdict = hallsweep_core::command::Verdict::Safe;
            let luggage = hallsweep_core::command::LuggageRef::Id(pending);
            self.give(Command::Verdict { luggage, verdict, note: None, hot: Default::default() })
                .expect("a pending piece can be judged");
            // Where something holds the robot, a verdict sets nothing moving.
            let _ = self.give(Command::Start);
        }
        self.state().mission.phase
    }

    pub(crate) fn state(&mut self) -> Arc<Snapshot> {
        self.engine.snapshot()
    }

    /// The latest trouble, with the places of robot and core, for messages of failed tests.
    pub(crate) fn trouble(&mut self) -> String {
        let is_trouble = |report: &&RobotEvent| matches!(report, RobotEvent::Failed(..) | RobotEvent::LinkLost(_));
        let said = self.reports.iter().rev().find(is_trouble).cloned();
        let page = self.server.page.as_ref().map(|page| (page.cell(), page.angle));
        let pose = self.state().robot.pose;
        format!("{said:?}; at {:?} the core has {pose:?}, the page {page:?}", self.now)
    }

    pub(crate) fn cells(&mut self, mark: Mark) -> Vec<(i32, i32)> {
        let state = self.state();
        let mut cells: Vec<(i32, i32)> =
            state.map.known().filter(|(_, is)| *is == mark).map(|(cell, _)| (cell.x, cell.y)).collect();
        cells.sort_unstable();
        cells
    }

    /// Checks that the robot stands in the core's cell, well in the middle.
    pub(crate) fn assert_agrees(&mut self) {
        let state = self.state();
        let (cell, off) = self.server.page.as_ref().expect("a page").cell();
        let pose = state.robot.pose;
        assert_eq!(((pose.cell.x, pose.cell.y), state.robot.off_centre), (cell, false), "at {:?}", self.now);
        assert!(off < 0.4, "{off} of a cell from the centre of {cell:?}, {:?}", self.driver);
    }

    /// Whether an alarm was sent to the server at this time or after it, or so shortly before that it serves a STOP of
    /// this time.
    pub(crate) fn has_alarm_since(&self, since: Duration) -> bool {
        let serves = |(at, said): &(Duration, String)| *at + Duration::from_millis(100) >= since && said.contains("alarm");
        self.server.heard.iter().any(serves)
    }

    pub(crate) fn is_awaiting(&mut self) -> bool {
        self.state().robot.state.name() != "stopped" && self.call.is_none()
    }

    /// Cuts the connection without a message.
    pub(crate) fn cut(&mut self) {
        if let Some(client) = self.client.take() {
            self.server.end(HERE, client);
            self.driver.handle_lost("the cable was pulled", self.now());
            self.call = Some(self.now + Duration::from_millis(500));
            self.settle();
        }
    }

    fn next(&self) -> Option<Duration> {
        [self.driver.poll_timeout(), self.engine.poll_timeout(), self.server.next(), self.call].into_iter().flatten().min()
    }

    pub(crate) fn pass_to(&mut self, now: Duration) {
        self.now = self.now.max(now);
        self.server.pass_to(self.now);
        if self.server.is_dead {
            self.cut();
        }
        self.settle();
        if self.call.is_some_and(|at| at <= self.now) {
            self.call = None;
            match self.server.connect(HERE) {
                Some(client) => {
                    self.client = Some(client);
                    self.driver.handle_connected(self.now());
                }
                None => {
                    self.call = Some(self.now + Duration::from_millis(500));
                    self.driver.handle_lost("nobody listens there", self.now());
                }
            }
            self.settle();
        }
        self.driver.handle_timeout(self.now());
        self.engine.handle_timeout(self.now());
        self.settle();
    }

    fn settle(&mut self) {
        loop {
            let mut quiet = true;
            if let Some(memory) = self.driver.poll_memory() {
                self.memory = memory;
            }
            while let Some(output) = self.driver.poll_output() {
                quiet = false;
                self.perform(output);
            }
            for (client, bytes) in std::mem::take(&mut self.server.sent) {
                quiet = false;
                if self.client == Some(client) {
                    self.driver.handle_received(&bytes, self.now());
                }
            }
            while let Some(report) = self.driver.poll_event() {
                quiet = false;
                self.reports.push(report.clone());
                self.engine.handle_event(Event::Robot(RobotId::discovery(), report), self.now());
            }
            while let Some(effect) = self.engine.poll_effect() {
                quiet = false;
                self.carry_out(effect);
            }
            if quiet {
                return;
            }
        }
    }

    fn perform(&mut self, output: Output) {
        match output {
            Output::Send(bytes) => {
                if self.client.is_some() {
                    self.server.receive(&bytes);
                    self.driver.handle_sent(self.now());
                }
            }
            Output::Reconnect => {
                if let Some(client) = self.client.take() {
                    self.server.end(HERE, client);
                    self.driver.handle_closed(!self.server.is_stalled, self.now());
                }
                self.call = Some(self.now + CALL);
            }
            Output::GiveUp(_) => self.cut(),
            Output::Draw(order, subject) => {
                self.drawn.push(subject.name.unwrap_or_default());
                let photo = Photo { bytes: Arc::from([1_u8]), media_type: "image/png" };
                self.driver.handle_drawing(order, photo, self.now());
            }
        }
    }

    fn carry_out(&mut self, effect: Effect) {
        match effect {
            Effect::Order(_, order) => self.driver.handle_order(order, self.now()),
            Effect::Halt(_) => self.driver.handle_halt(self.now()),
            Effect::Led(_, blinks) => self.driver.handle_led(blinks, self.now()),
            Effect::Record(page) => self.engine.handle_event(Event::Recorded(page.last()), self.now()),
            Effect::Answer(ticket, answer) => {
                self.answers.insert(ticket, answer);
            }
        }
    }
}
