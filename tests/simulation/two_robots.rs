//! Two simulated robots in one hall with one engine: each has its own orders, one STOP halts both, and a lost link
//! holds only its own robot.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::command::{Command, Door, Issuer, Move, Request, Strategy, TemperatureReport};
use hallsweep_core::effect::{Action, Effect};
use hallsweep_core::engine::{Barred, Engine, Recalled};
use hallsweep_core::event::{Event, RobotEvent};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::{Part, RobotId, RobotState};
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::robot::RobotShown;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{Cell, Celsius, Now, OrderId, Seq, WallTime};
use hallsweep_sim::{Camera, Hall, Sim, SimSettings};

const FORWARD: Action = Action::Move(Move::Forward);

fn porter() -> RobotId {
    RobotId::new("porter").expect("a name")
}

/// The robots, the engine, and a store that confirms at once, in simulated time.
struct Pair {
    engine: Engine,
    sims: BTreeMap<RobotId, Sim>,
    journal: Vec<Entry>,
    /// Orders (with their id) and halts (`None`) that left the engine.
    sent: Vec<(RobotId, Option<OrderId>)>,
    now: Now,
}

impl Pair {
    /// Robots `discovery`, which searches, and `porter`, both at home in an empty hall.
    fn new() -> Pair {
        Pair::with(Engine::new(Settings::default(), Strategy::Snail, "pair".into()))
    }

    fn with(mut engine: Engine) -> Pair {
        let now = Now { since_start: Duration::ZERO, wall: WallTime::default() };
        engine.add_robot(porter(), now);
        let hall = Arc::new(Hall::from_rows("pair", &["S....", ".....", ".....", "....."]).unwrap());
        let sim = |seed| Sim::new(Arc::clone(&hall), SimSettings::new(seed, Camera::Stub));
        let sims = BTreeMap::from([(RobotId::discovery(), sim(1)), (porter(), sim(2))]);
        let mut pair = Pair { engine, sims, journal: Vec::new(), sent: Vec::new(), now };
        pair.settle();
        pair
    }

    fn settle(&mut self) {
        loop {
            if let Some(effect) = self.engine.poll_effect() {
                self.perform(effect);
                continue;
            }
            let report = self.sims.iter_mut().find_map(|(id, sim)| Some((id.clone(), sim.poll_event()?)));
            let Some((id, report)) = report else { return };
            self.engine.handle_event(Event::Robot(id, report), self.now);
        }
    }

    fn perform(&mut self, effect: Effect) {
        match effect {
            Effect::Order(robot, order) => {
                self.sims.get_mut(&robot).unwrap().handle_order(order, self.now);
                self.sent.push((robot, Some(order.id)));
            }
            Effect::Halt(robot) => {
                self.sims.get_mut(&robot).unwrap().handle_halt(self.now);
                self.sent.push((robot, None));
            }
            Effect::Led(robot, blinks) => self.sims.get_mut(&robot).unwrap().handle_led(blinks),
            Effect::Record(page) => {
                let last = page.last();
                self.journal.extend(page.entries);
                self.engine.handle_event(Event::Recorded(last), self.now);
            }
            Effect::Answer(_, answer) => drop(answer.unwrap()),
        }
    }

    /// Advances the time by `ms` milliseconds.
    fn wait(&mut self, ms: u64) {
        for _ in 0..ms {
            self.now.since_start += Duration::from_millis(1);
            self.sims.values_mut().for_each(|sim| sim.handle_timeout(self.now));
            self.engine.handle_timeout(self.now);
            self.settle();
        }
    }

    fn give(&mut self, command: Command) {
        self.engine.handle_command(Request::new(command, Issuer::operator(Door::LOCAL)), self.now).unwrap();
        self.settle();
    }

    fn propose(&mut self, action: Action) -> Result<OrderId, Barred> {
        let proposed = self.engine.propose(&porter(), action, self.now);
        self.settle();
        proposed
    }

    fn happen(&mut self, robot: &RobotId, report: RobotEvent) {
        self.engine.handle_event(Event::Robot(robot.clone(), report), self.now);
        self.settle();
    }

    fn shown(&mut self, robot: &RobotId) -> RobotShown {
        self.engine.snapshot().robots.iter().find(|shown| shown.id == *robot).unwrap().clone()
    }

    fn halted(&self) -> BTreeSet<RobotId> {
        self.sent.iter().filter(|(_, order)| order.is_none()).map(|(robot, _)| robot.clone()).collect()
    }

    fn both_move(&mut self) {
        self.give(Command::Start);
        self.propose(FORWARD).unwrap();
        self.wait(50);
        let moving = |shown: RobotShown| shown.view.state == RobotState::MovingForward;
        assert!(moving(self.shown(&RobotId::discovery())) && moving(self.shown(&porter())));
        self.sent.clear();
    }
}

#[test]
fn each_robot_has_its_own_orders_and_its_own_place() {
    let mut pair = Pair::new();
    pair.give(Command::Start);
    for _ in 0..2 {
        pair.propose(FORWARD).unwrap();
        assert_eq!(pair.propose(FORWARD), Err(Barred::Busy), "one order is open at a time");
        pair.wait(400);
    }
    assert_eq!(pair.shown(&porter()).view.pose.cell, Cell::new(0, 2));
    let orders = |robot: &RobotId| pair.sent.iter().filter(|(to, order)| to == robot && order.is_some()).count();
    assert!(orders(&porter()) == 2 && orders(&RobotId::discovery()) >= 2, "{:?}", pair.sent);
    let state = pair.engine.snapshot();
    assert_eq!(state.robots[0].view, state.robot, "the first of them is the one that searches");
    assert_ne!(state.mission.phase, PhaseName::Fault);
}

#[test]
fn the_robot_that_searches_takes_orders_of_the_mission_alone_and_nobody_those_it_cannot() {
    let mut pair = Pair::new();
    let now = pair.now;
    assert_eq!(pair.engine.propose(&RobotId::discovery(), FORWARD, now), Err(Barred::Searching));
    assert_eq!(pair.engine.propose(&RobotId::new("nobody").unwrap(), FORWARD, now), Err(Barred::Unknown));
    assert!(pair.shown(&porter()).parts.is_some_and(|parts| parts.has(Part::Base) && !parts.has(Part::Gripper)));
    assert_eq!(pair.sent, []);
}

/// Safety S1: one STOP halts both robots.
#[test]
fn one_stop_halts_both_and_neither_moves_before_a_start() {
    let mut pair = Pair::new();
    pair.both_move();
    pair.give(Command::Stop);
    assert_eq!(pair.halted(), BTreeSet::from([RobotId::discovery(), porter()]));
    pair.wait(100);
    for robot in [RobotId::discovery(), porter()] {
        let shown = pair.shown(&robot);
        assert!(shown.view.state == RobotState::Stopped && shown.view.off_centre && !shown.view.halting, "{robot}");
        assert!(shown.holds.contains(&Hold::Operator), "{robot}");
    }
    assert_eq!(pair.propose(FORWARD), Err(Barred::Held));
    assert_eq!(pair.propose(Action::Recentre), Err(Barred::Held));
    pair.sent.clear();
    pair.wait(5000);
    assert_eq!(pair.sent, [], "nothing sets out by itself");
    pair.give(Command::Start);
    assert_eq!(pair.propose(FORWARD), Err(Barred::OffCentre), "first it goes back to the centre");
    pair.propose(Action::Recentre).unwrap();
    pair.wait(600);
    pair.propose(FORWARD).unwrap();
}

/// Safety S8: the answer also waits for the other robot.
#[test]
fn a_stop_is_answered_when_both_stand() {
    let mut pair = Pair::new();
    pair.both_move();
    let stop = Request::new(Command::Stop, Issuer::operator(Door::LOCAL));
    let ticket = pair.engine.handle_command(stop, pair.now).unwrap();
    let mut effects: Vec<Effect> = std::iter::from_fn(|| pair.engine.poll_effect()).collect();
    let answered = |effects: &[Effect]| effects.iter().any(|effect| matches!(effect, Effect::Answer(of, _) if *of == ticket));
    for robot in [RobotId::discovery(), porter()] {
        assert!(!answered(&effects), "{robot} has not said that it stands");
        let sim = pair.sims.get_mut(&robot).unwrap();
        sim.handle_halt(pair.now);
        while let Some(report) = sim.poll_event() {
            pair.engine.handle_event(Event::Robot(robot.clone(), report), pair.now);
        }
        effects.extend(std::iter::from_fn(|| pair.engine.poll_effect()));
    }
    assert!(answered(&effects));
}

/// Safety S3: heat holds both robots, and cooling moves neither.
#[test]
fn heat_halts_both_and_each_waits_for_start_afterwards() {
    let mut pair = Pair::new();
    pair.both_move();
    let reading = |degrees| Command::Temperature(TemperatureReport::Reading(Celsius::new(degrees).unwrap()));
    pair.give(reading(60.0));
    assert_eq!(pair.halted(), BTreeSet::from([RobotId::discovery(), porter()]));
    pair.wait(100);
    pair.give(reading(10.0));
    assert_eq!(pair.shown(&porter()).holds, [Hold::AwaitingStart]);
    assert_eq!(pair.propose(Action::Recentre), Err(Barred::Held));
    pair.give(Command::Start);
    pair.propose(Action::Recentre).unwrap();
}

#[test]
fn nothing_is_put_away_while_another_robot_moves() {
    let mut pair = Pair::new();
    pair.propose(FORWARD).unwrap();
    let reset = || Request::new(Command::Reset, Issuer::operator(Door::LOCAL));
    assert_eq!(pair.engine.handle_command(reset(), pair.now), Err(Refused::Moving));
    pair.wait(500);
    assert!(pair.engine.handle_command(reset(), pair.now).is_ok());
}

/// Safety S3: a robot's reading is never taken for that of another source, whatever the robot's name.
#[test]
fn a_robot_that_is_called_like_another_source_cools_nothing_but_itself() {
    let celsius = |degrees| Celsius::new(degrees).unwrap();
    for name in ["operator", "robot", "others", "roof"] {
        let mut pair = Pair::new();
        let robot = RobotId::new(name).unwrap();
        pair.engine.add_robot(robot.clone(), pair.now);
        pair.engine.watch_sensor("roof".into(), Duration::from_secs(3600), pair.now);
        pair.give(Command::Temperature(TemperatureReport::Reading(celsius(60.0))));
        pair.give(Command::Temperature(TemperatureReport::Sensor("roof".into(), celsius(60.0))));
        pair.happen(&RobotId::discovery(), RobotEvent::Temperature(celsius(60.0)));
        pair.happen(&robot, RobotEvent::Temperature(celsius(10.0)));
        assert_eq!(pair.engine.snapshot().temperature.hot.len(), 3, "{name}");
        pair.happen(&robot, RobotEvent::Temperature(celsius(60.0)));
        assert_eq!(pair.engine.snapshot().temperature.hot.len(), 4, "{name}");
    }
}

#[test]
fn a_lost_link_holds_the_robot_whose_link_it_is_and_no_other() {
    for lost in [RobotId::discovery(), porter()] {
        let mut pair = Pair::new();
        pair.both_move();
        let other = if lost == porter() { RobotId::discovery() } else { porter() };
        pair.happen(&lost, RobotEvent::LinkLost("it is out of reach".to_owned()));
        assert!(!pair.halted().contains(&other), "the other goes on");
        assert!(pair.shown(&lost).holds.contains(&Hold::RobotLink), "{lost}");
        assert!(!pair.shown(&other).holds.contains(&Hold::RobotLink), "{other}");
        assert!(pair.shown(&lost).view.off_centre && !pair.shown(&other).view.off_centre);
        pair.sent.clear();
        pair.wait(1000);
        if lost == porter() {
            assert_eq!(pair.propose(FORWARD), Err(Barred::Held));
            assert!(pair.sent.iter().any(|(robot, _)| *robot == other), "the search goes on");
        } else {
            pair.propose(FORWARD).unwrap();
        }
        assert!(!pair.sent.iter().any(|(robot, order)| *robot == lost && order.is_some()), "{:?}", pair.sent);
    }
}

/// A restored link does not start the robot.
#[test]
fn a_robot_that_is_reached_again_waits_for_start() {
    let mut pair = Pair::new();
    pair.both_move();
    let can = pair.sims[&porter()].capabilities();
    pair.happen(&porter(), RobotEvent::LinkLost("it is out of reach".to_owned()));
    pair.happen(&porter(), RobotEvent::LinkUp(can));
    assert_eq!(pair.shown(&porter()).holds, [Hold::AwaitingStart]);
    assert_eq!(pair.propose(Action::Recentre), Err(Barred::Held));
    pair.give(Command::Start);
    pair.propose(Action::Recentre).unwrap();
}

#[test]
fn an_order_that_is_not_answered_halts_the_robot_that_owes_it() {
    let mut pair = Pair::new();
    pair.both_move();
    // The robot no longer answers.
    pair.sims.remove(&porter());
    pair.sims.insert(porter(), Sim::new(Arc::new(Hall::from_rows("other", &["S"]).unwrap()), SimSettings::new(3, Camera::Stub)));
    while pair.sims.get_mut(&porter()).unwrap().poll_event().is_some() {}
    pair.wait(6000);
    assert_eq!(pair.halted(), BTreeSet::from([porter()]));
    assert!(pair.shown(&porter()).view.off_centre);
    assert_ne!(pair.engine.snapshot().mission.phase, PhaseName::Fault, "the search goes on");
}

/// Safety R1: the place of each robot is recorded; after a restart all robots are held.
#[test]
fn after_a_restart_each_robot_is_where_it_was_and_none_moves() {
    let mut pair = Pair::new();
    pair.give(Command::Start);
    pair.propose(FORWARD).unwrap();
    pair.wait(500);
    let told = |entry: &&Entry| matches!(&entry.fact, Fact::RobotPose(robot, _) if *robot == porter());
    assert_eq!(pair.journal.iter().filter(told).count(), 1);
    let mut state = PersistentState::first(Strategy::Snail);
    pair.journal.iter().for_each(|entry| state.apply(entry));
    let recalled = Recalled {
        state,
        written: Seq(pair.journal.len() as u64),
        commands: Vec::new(),
        kept_back: Vec::new(),
        latest: Vec::new(),
    };
    let mut engine = Engine::recall(Settings::default(), "again".into(), recalled, pair.now);
    engine.add_robot(porter(), pair.now);
    let shown = engine.snapshot().robots.iter().find(|shown| shown.id == porter()).unwrap().clone();
    assert_eq!(shown.view.pose.cell, Cell::new(0, 1));
    assert!(
        [Hold::Restart, Hold::RobotLink, Hold::AwaitingStart].iter().all(|hold| shown.holds.contains(hold)),
        "{:?}",
        shown.holds
    );
}
