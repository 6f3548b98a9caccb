//! Tests of the simulated robot as a whole: its answers, their times, and the real place of its body. The parts have
//! their tests in their own files.

use super::super::settings::Camera;
use super::*;
use hallsweep_core::effect::Stamp;
use hallsweep_core::event::Whereabouts;
use hallsweep_core::units::{Cell, Epoch, Heading};

mod recall;

const OPEN: [&str; 5] = [".....", ".....", "..S..", ".....", "....."];

struct Run {
    sim: Sim,
    now: Duration,
    orders: u64,
}

impl Run {
    fn new(rows: &[&str]) -> Run {
        Run::with(rows, SimSettings { sonar_noise_cm: 0.0, ..SimSettings::new(1, Camera::Stub) })
    }

    fn with(rows: &[&str], settings: SimSettings) -> Run {
        let mut run =
            Run { sim: Sim::new(Arc::new(Hall::from_rows("test", rows).unwrap()), settings), now: Duration::ZERO, orders: 0 };
        let at_home = RobotEvent::Stands(Whereabouts { pose: Pose::START, off_centre: false });
        assert_eq!(run.events(), [at_home, RobotEvent::LinkUp(run.sim.capabilities())]);
        run
    }

    fn now(&self) -> Now {
        Now { since_start: self.now, ..Now::default() }
    }

    fn order(&mut self, action: Action) -> OrderId {
        self.order_within(action, Duration::from_secs(10))
    }

    fn order_within(&mut self, action: Action, deadline: Duration) -> OrderId {
        self.orders += 1;
        let id = OrderId(self.orders);
        self.sim.handle_order(Order { id, action, epoch: Epoch(0), deadline }, self.now());
        id
    }

    fn pass_ms(&mut self, ms: u64) -> Vec<RobotEvent> {
        self.now += Duration::from_millis(ms);
        self.sim.handle_timeout(self.now());
        self.events()
    }

    fn events(&mut self) -> Vec<RobotEvent> {
        std::iter::from_fn(|| self.sim.poll_event()).collect()
    }

    /// Gives an order and waits until it ends. Returns the reports of that time.
    fn perform(&mut self, action: Action) -> Vec<RobotEvent> {
        self.order(action);
        while self.sim.is_busy() {
            self.now = self.sim.poll_timeout().expect("an order under way ends by itself");
            self.sim.handle_timeout(self.now());
        }
        self.events()
    }

    fn halt(&mut self) -> Vec<RobotEvent> {
        self.sim.handle_halt(self.now());
        self.events()
    }

    fn body(&self) -> BodyPose {
        self.sim.pose_at(self.now())
    }

    fn check_floor(&self, seed: u64) {
        let body = self.body();
        let cell = Cell::new((body.x_m / 0.5).round() as i32, (body.y_m / 0.5).round() as i32);
        assert_eq!(self.sim.hall.truth(cell), super::super::Truth::Free, "seed {seed}: the body is in {cell}");
    }
}

fn is_done(events: &[RobotEvent]) -> bool {
    matches!(events.last(), Some(RobotEvent::Done(_)))
}

fn failure(events: &[RobotEvent]) -> &str {
    match events {
        [.., RobotEvent::Failed(_, words)] => words,
        other => panic!("expected a failure, got {other:?}"),
    }
}

#[test]
fn a_step_takes_330_ms_and_a_turn_500() {
    let mut run = Run::new(&OPEN);
    run.order(Action::Move(Move::Forward));
    assert_eq!(run.pass_ms(329), []);
    assert!((run.body().y_m - 0.5 * 329.0 / 330.0).abs() < 1e-9);
    assert!(is_done(&run.pass_ms(1)));
    assert_eq!(run.body(), BodyPose::centred(Pose { cell: Cell::new(0, 1), heading: Heading::South }, 0.5));
    run.order(Action::Move(Move::TurnLeft));
    assert_eq!(run.pass_ms(499), []);
    assert!(is_done(&run.pass_ms(1)));
    assert_eq!(run.body(), BodyPose::centred(Pose { cell: Cell::new(0, 1), heading: Heading::East }, 0.5));
}

#[test]
fn a_step_into_an_obstacle_makes_contact_and_stays_off_centre_until_recentred() {
    let mut run = Run::new(&["S", "a", "."]);
    let events = run.perform(Action::Move(Move::Forward));
    assert_eq!(
        events,
        [RobotEvent::Sonar(Some(0)), RobotEvent::Blocked(OrderId(1), Obstacle::Luggage(hallsweep_core::units::Piece(1)))]
    );
    assert!(run.sim.is_off_centre() && (run.body().y_m - 0.1).abs() < 1e-9);
    assert_eq!(run.now, Duration::from_millis(66), "a fifth of a step");
    assert!(failure(&run.perform(Action::Move(Move::Backward))).contains("recentre first"));
    let events = run.perform(Action::Recentre);
    assert_eq!(events, [RobotEvent::Sonar(Some(0)), RobotEvent::Sonar(Some(10)), RobotEvent::Done(OrderId(3))]);
    assert_eq!(run.body(), BodyPose::centred(Pose::START, 0.5));
}

#[test]
fn a_step_backward_meets_what_the_camera_does_not_see() {
    let mut run = Run::new(&["S", "."]);
    let events = run.perform(Action::Move(Move::Backward));
    assert!(matches!(events.as_slice(), [.., RobotEvent::Blocked(_, Obstacle::Unknown)]), "{events:?}");
    assert!(run.body().y_m < 0.0);
    assert!(is_done(&run.perform(Action::Recentre)));
}

#[test]
fn recentring_where_it_is_centred_is_done_at_once() {
    let mut run = Run::new(&OPEN);
    run.order(Action::Recentre);
    assert!(is_done(&run.events()));
}

#[test]
fn a_halt_stops_it_in_mid_step_and_recentring_takes_as_long_as_the_way() {
    let mut run = Run::new(&OPEN);
    run.order(Action::Move(Move::Forward));
    run.pass_ms(100);
    assert_eq!(run.halt(), [RobotEvent::Halted(OrderId(1), true)]);
    let stood = run.body();
    run.pass_ms(1000);
    assert_eq!(run.body(), stood, "halted is halted");
    let before = run.now;
    assert!(is_done(&run.perform(Action::Recentre)));
    assert!((run.now - before).abs_diff(Duration::from_millis(100)) < Duration::from_micros(1));
    assert_eq!(run.body(), BodyPose::centred(Pose::START, 0.5));
}

#[test]
fn a_halt_stops_it_between_two_headings_and_recentring_turns_back() {
    for turn in [Move::TurnLeft, Move::TurnRight] {
        let mut run = Run::new(&OPEN);
        run.order(Action::Move(turn));
        run.pass_ms(400);
        assert_eq!(run.halt(), [RobotEvent::Halted(OrderId(1), true)]);
        run.order(Action::Recentre);
        run.pass_ms(50);
        assert!(matches!(run.halt().as_slice(), [RobotEvent::Halted(OrderId(2), true)]), "recentring can be halted too");
        assert!(is_done(&run.perform(Action::Recentre)));
        assert_eq!(run.body(), BodyPose::centred(Pose::START, 0.5));
    }
}

#[test]
fn a_halt_before_it_has_moved_leaves_it_centred_and_one_without_an_order_says_nothing() {
    let mut run = Run::new(&OPEN);
    assert_eq!(run.halt(), []);
    run.order(Action::Move(Move::Forward));
    assert_eq!(run.halt(), [RobotEvent::Halted(OrderId(1), false)]);
}

#[test]
fn a_halt_does_not_cut_a_photo_short() {
    let mut run = Run::new(&["S", "a"]);
    run.order(photograph());
    run.pass_ms(100);
    assert_eq!(run.halt(), []);
    assert!(matches!(run.pass_ms(200).as_slice(), [RobotEvent::Photo(OrderId(1), _)]));
}

#[test]
fn an_order_while_another_is_under_way_fails_and_the_other_goes_on() {
    let mut run = Run::new(&OPEN);
    run.order(Action::Move(Move::Forward));
    run.pass_ms(100);
    run.order(Action::Move(Move::TurnLeft));
    assert_eq!(failure(&run.events()), "order 1 is still under way");
    assert!(is_done(&run.pass_ms(230)));
}

#[test]
fn small_corrective_turns_are_not_its_own() {
    let mut run = Run::new(&OPEN);
    assert!(failure(&run.perform(Action::Move(Move::NudgeLeft))).contains("no small corrective turns"));
    assert!(!run.sim.capabilities().nudges);
}

/// Tests safety S5 (docs/safety.md).
#[test]
fn past_its_deadline_it_halts_by_itself() {
    let mut run = Run::new(&OPEN);
    run.order_within(Action::Move(Move::Forward), Duration::from_millis(165));
    let events = run.pass_ms(1000);
    assert!(failure(&events).contains("halted by itself"));
    assert!((run.body().y_m - 0.25).abs() < 1e-9, "half way");
    assert!(is_done(&run.perform(Action::Recentre)));
}

#[test]
fn a_photo_developed_elsewhere_comes_back_as_the_answer() {
    let mut run = Run::new(&["S", "a"]);
    run.order(photograph());
    let (order, exposure) = run.sim.take_exposure().expect("a photo is under way");
    assert!(run.sim.take_exposure().is_none() && run.sim.is_developing());
    assert_eq!(run.pass_ms(400), [], "it waits for its photo");
    let photo = exposure.develop();
    run.sim.handle_photo(order, photo.clone(), run.now());
    assert_eq!(run.events(), [RobotEvent::Photo(order, photo)]);
}

#[test]
fn photos_fail_and_the_camera_errs_at_the_rates_that_are_set() {
    let settings = SimSettings { unknown_rate: 0.3, photo_failure_rate: 0.3, ..SimSettings::new(5, Camera::Stub) };
    let mut run = Run::with(&["S"], settings);
    let (mut unknown, mut failed) = (0, 0);
    for _ in 0..300 {
        let events = run.perform(Action::Move(Move::Forward));
        unknown += usize::from(matches!(events.last(), Some(RobotEvent::Blocked(_, Obstacle::Unknown))));
        run.perform(Action::Recentre);
        failed += usize::from(matches!(run.perform(photograph()).last(), Some(RobotEvent::PhotoFailed(..))));
    }
    assert!((60..=120).contains(&unknown) && (60..=120).contains(&failed), "{unknown} unknown, {failed} failed");
}

#[test]
fn the_temperature_is_told_when_it_changes_by_a_tenth() {
    let text = "width = 2\nheight = 2\n[[temperature]]\nat_s = 0\ncelsius = 20\n[[temperature]]\nat_s = 10\ncelsius = 21\n";
    let mut sim = Sim::new(Arc::new(Hall::parse("t.toml", text).unwrap()), SimSettings::new(1, Camera::Stub));
    let mut told = Vec::new();
    while let Some(at) = sim.poll_timeout() {
        sim.handle_timeout(Now { since_start: at, ..Now::default() });
        while let Some(event) = sim.poll_event() {
            if let RobotEvent::Temperature(reading) = event {
                told.push((at.as_secs(), (reading.degrees() * 10.0).round() / 10.0));
            }
        }
    }
    let expect: Vec<(u64, f64)> = (0..=10u32).map(|second| (u64::from(second), f64::from(200 + second) / 10.0)).collect();
    assert_eq!(told, expect);
}

/// Makes random moves, halts and waits. Checks that the body never leaves the floor, and returns all reports.
fn wander(seed: u64, stride_ms: u64) -> String {
    let rows = ["#.....#", ".a.S..b", "...##..", "c......"];
    let mut run = Run::with(&rows, SimSettings { unknown_rate: 0.1, ..SimSettings::new(seed, Camera::Stub) });
    let mut choices = RandomStream::new(seed, "wander");
    let mut log = String::new();
    for _ in 0..1500 {
        let action = if run.sim.is_off_centre() { Action::Recentre } else { any_move(choices.below(5)) };
        run.order(action);
        if choices.happens(0.1) {
            run.now += Duration::from_millis(choices.below(300));
            run.sim.handle_halt(run.now());
        }
        let until = run.now + Duration::from_millis(600);
        while run.now < until {
            run.now = until.min(run.now + Duration::from_millis(stride_ms));
            run.sim.handle_timeout(run.now());
            run.check_floor(seed);
        }
        let events = run.events();
        log += &format!("{:?} {events:?}\n", run.now);
    }
    log
}

fn any_move(choice: u64) -> Action {
    Action::Move(match choice {
        0 => Move::TurnLeft,
        1 => Move::TurnRight,
        2 => Move::Backward,
        _ => Move::Forward,
    })
}

fn photograph() -> Action {
    Action::Photograph(Stamp { pose: Pose::START, wall: hallsweep_core::units::WallTime::default() })
}

#[test]
fn it_never_leaves_the_floor_and_the_same_seed_reports_the_same_byte_for_byte() {
    for seed in 0..4 {
        assert_eq!(wander(seed, 600), wander(seed, 600));
        assert_ne!(wander(seed, 600), wander(seed + 100, 600));
    }
}

#[test]
fn how_often_time_is_let_pass_makes_no_difference() {
    assert_eq!(wander(7, 600), wander(7, 7));
}

#[test]
fn it_leaves_home_backwards_and_comes_in_again_and_can_be_halted_on_the_way() {
    let mut run = Run::new(&["S."]);
    assert!(is_done(&run.perform(Action::Leave)));
    assert_eq!(run.body(), BodyPose::centred(Pose { cell: Cell::new(0, -1), heading: Heading::South }, 0.5));
    assert!(failure(&run.perform(Action::Move(Move::Forward))).contains("before the entrance"));
    assert!(is_done(&run.perform(Action::Leave)));
    assert!(failure(&run.perform(Action::Leave)).contains("end of the way out"));
    let order = run.order(Action::Enter);
    run.pass_ms(100);
    assert_eq!(run.halt(), [RobotEvent::Halted(order, true)]);
    assert!(failure(&run.perform(Action::Enter)).contains("recentre"));
    assert!(is_done(&run.perform(Action::Recentre)));
    for _ in 0..2 {
        assert!(is_done(&run.perform(Action::Enter)));
    }
    assert_eq!(run.body(), BodyPose::centred(Pose::START, 0.5));
    assert!(failure(&run.perform(Action::Enter)).contains("in the hall"));
}

#[test]
fn the_way_out_begins_at_home_facing_south() {
    let mut run = Run::new(&["S.", ".."]);
    assert!(is_done(&run.perform(Action::Move(Move::TurnLeft))));
    assert!(failure(&run.perform(Action::Leave)).contains("facing south"));
    assert!(is_done(&run.perform(Action::Move(Move::TurnRight))) && is_done(&run.perform(Action::Move(Move::Forward))));
    assert!(failure(&run.perform(Action::Leave)).contains("facing south"));
}

#[test]
fn luggage_that_was_taken_away_is_not_met_any_more() {
    let mut run = Run::new(&["S", "a"]);
    assert!(matches!(run.perform(Action::Move(Move::Forward)).last(), Some(RobotEvent::Blocked(..))));
    run.perform(Action::Recentre);
    let empty = run.sim.hall.rearranged(&std::collections::BTreeMap::from([(hallsweep_core::units::Piece(1), None)]));
    run.sim.handle_hall(Arc::new(empty));
    assert!(is_done(&run.perform(Action::Move(Move::Forward))));
}
