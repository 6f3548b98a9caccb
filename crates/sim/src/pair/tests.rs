//! Tests of the pair: two robots lift a parcel, carry it and put it down, and many things interfere.

use super::*;
use hallsweep_core::arm::{ArmAction, Controllers, Gripper};
use hallsweep_core::command::Move;
use hallsweep_core::effect::Action;
use hallsweep_core::event::Obstacle;
use hallsweep_core::units::{Epoch, Heading, OrderId};

const FORWARD: Action = Action::Move(Move::Forward);
const BACKWARD: Action = Action::Move(Move::Backward);
const LONG: Duration = Duration::from_secs(20);

pub(super) struct Run {
    pub(super) pair: Pair,
    pub(super) now: Now,
    last: u64,
}

fn at(x: i32, y: i32) -> Place {
    Place::Cell(Cell::new(x, y))
}

fn stands(x: i32, y: i32) -> BasePose {
    BasePose { place: at(x, y), heading: Heading::East }
}

/// Settings for a long hall with the parcel at (3, 0). SRM1 stands to the east of the parcel, and SRM2 to the west.
fn settings() -> PairSettings {
    PairSettings::new(7, at(12, 0))
}

fn hall() -> Arc<Hall> {
    Arc::new(Hall::from_rows("test", &["S..a..............", ".................."]).unwrap())
}

impl Run {
    fn new(settings: PairSettings) -> Run {
        Run::of(Pair::new(hall(), settings, [stands(4, 0), stands(2, 0)]))
    }

    pub(super) fn of(mut pair: Pair) -> Run {
        while pair.poll_event().is_some() {}
        Run { pair, now: Now::default(), last: 0 }
    }

    fn order(&mut self, which: Which, action: Action) {
        self.order_within(which, action, LONG);
    }

    fn order_within(&mut self, which: Which, action: Action, deadline: Duration) {
        self.last += 1;
        let order = Order { id: OrderId(self.last), action, epoch: Epoch(0), deadline };
        self.pair.handle_order(which, order, self.now);
    }

    fn events(&mut self) -> Vec<(Which, RobotEvent)> {
        std::iter::from_fn(|| self.pair.poll_event()).collect()
    }

    fn wait(&mut self, ms: u64) -> Vec<(Which, RobotEvent)> {
        self.now.since_start += Duration::from_millis(ms);
        self.pair.handle_timeout(self.now);
        self.events()
    }

    /// Lets time pass until no order is open. Returns all reports.
    fn settle(&mut self) -> Vec<(Which, RobotEvent)> {
        let mut events = self.events();
        while Which::ALL.into_iter().any(|which| self.pair.is_busy(which)) {
            let next = self.pair.poll_timeout().expect("an order under way ends");
            self.now.since_start = next;
            self.pair.handle_timeout(self.now);
            events.extend(self.events());
        }
        events
    }

    fn both(&mut self, action: Action) -> Vec<(Which, RobotEvent)> {
        Which::ALL.into_iter().for_each(|which| self.order(which, action));
        self.settle()
    }

    fn arms(&mut self, action: ArmAction) -> Vec<(Which, RobotEvent)> {
        self.both(Action::Arm(action))
    }

    fn grip(&mut self, controllers: Controllers) {
        for action in [ArmAction::AlignEndEffector(at(3, 0)), ArmAction::CloseGripper] {
            assert_eq!(done(&self.arms(action)), 2, "{action:?}");
        }
        let started = [
            (controllers.force, ArmAction::HoldForce),
            (controllers.angle, ArmAction::HoldAngle),
            (controllers.distance, ArmAction::HoldDistance),
        ];
        for (_, action) in started.into_iter().filter(|(start, _)| *start) {
            assert_eq!(done(&self.arms(action)), 2, "{action:?}");
        }
    }

    fn lift(&mut self) {
        self.grip(ALL);
        assert_eq!(done(&self.arms(ArmAction::Lift)), 2);
    }

    /// Carries the parcel one step to the east. SRM1 leads.
    fn carry(&mut self) -> Vec<(Which, RobotEvent)> {
        self.both(FORWARD)
    }

    fn place(&self, which: Which) -> Place {
        self.pair.stands(which).0.place
    }
}

const ALL: Controllers = Controllers { force: true, angle: true, distance: true };

fn count(events: &[(Which, RobotEvent)], wanted: impl Fn(&RobotEvent) -> bool) -> usize {
    events.iter().filter(|(_, event)| wanted(event)).count()
}

fn done(events: &[(Which, RobotEvent)]) -> usize {
    count(events, |event| matches!(event, RobotEvent::Done(_)))
}

fn lost(events: &[(Which, RobotEvent)]) -> usize {
    count(events, |event| matches!(event, RobotEvent::ParcelLost(_)))
}

fn words(events: &[(Which, RobotEvent)]) -> &str {
    let failed = |(_, event): &'_ (Which, RobotEvent)| matches!(event, RobotEvent::Failed(..));
    match events.iter().rfind(|event| failed(event)) {
        Some((_, RobotEvent::Failed(_, words))) => words,
        other => panic!("{other:?} of {events:?}"),
    }
}

#[test]
fn the_two_carry_a_parcel_along_like_a_train_and_put_it_into_the_container() {
    let mut run = Run::new(settings());
    run.lift();
    for step in 1..=9 {
        assert_eq!(done(&run.carry()), 2, "step {step}");
        assert_eq!(run.pair.load().map(|parcel| parcel.place), Some(at(3 + step, 0)));
    }
    assert_eq!((run.place(Which::Srm1), run.place(Which::Srm2)), (at(13, 0), at(11, 0)));
    assert_eq!(done(&run.arms(ArmAction::Lower)), 2);
    assert_eq!(run.pair.taken_in(), [], "it is still in the grippers");
    assert_eq!(done(&run.arms(ArmAction::Release)), 2);
    assert_eq!((run.pair.taken_in(), run.pair.load()), (&[Piece(1)][..], None));
}

#[test]
fn a_step_with_a_parcel_begins_when_both_have_theirs() {
    let mut run = Run::new(settings());
    run.lift();
    run.order(Which::Srm1, FORWARD);
    assert_eq!((done(&run.wait(5000)), run.place(Which::Srm1)), (0, at(4, 0)));
    run.order(Which::Srm2, FORWARD);
    assert_eq!(done(&run.wait(999)), 0, "a step with a parcel takes a second");
    assert_eq!(done(&run.wait(1)), 2);
}

#[test]
fn a_robot_whose_partner_never_comes_gives_its_order_up_in_time() {
    let mut run = Run::new(settings());
    run.lift();
    run.order_within(Which::Srm1, FORWARD, Duration::from_secs(4));
    assert_eq!(words(&run.settle()), "the other robot did not do its part in time");
    assert_eq!(run.place(Which::Srm1), at(4, 0));
}

#[test]
fn the_two_are_not_torn_apart_by_orders_that_do_not_fit() {
    for (one, two) in [(FORWARD, BACKWARD), (BACKWARD, FORWARD), (FORWARD, Action::Arm(ArmAction::Lower))] {
        let mut run = Run::new(settings());
        run.lift();
        run.order(Which::Srm1, one);
        run.order(Which::Srm2, two);
        assert_eq!(words(&run.events()), "the two robots got different orders for one parcel");
        assert_eq!((run.place(Which::Srm1), run.place(Which::Srm2)), (at(4, 0), at(2, 0)));
    }
}

#[test]
fn the_train_goes_round_a_corner_and_back_whichever_base_leads() {
    let mut run = Run::new(settings());
    run.lift();
    run.order(Which::Srm1, Action::Move(Move::TurnRight));
    assert_eq!(done(&run.settle()), 1, "each turns by itself");
    assert_eq!(done(&run.carry()), 2);
    assert_eq!((run.place(Which::Srm1), run.pair.load().unwrap().place, run.place(Which::Srm2)), (at(4, 1), at(4, 0), at(3, 0)));
    assert_eq!(done(&run.both(BACKWARD)), 2);
    assert_eq!((run.place(Which::Srm1), run.pair.load().unwrap().place, run.place(Which::Srm2)), (at(4, 0), at(3, 0), at(2, 0)));
}

#[test]
fn without_any_one_of_the_controllers_the_parcel_falls_on_the_way() {
    for missing in
        [Controllers { force: false, ..ALL }, Controllers { angle: false, ..ALL }, Controllers { distance: false, ..ALL }]
    {
        let mut run = Run::new(settings());
        run.grip(missing);
        run.arms(ArmAction::Lift);
        let at_step = (1..=12).find(|_| lost(&run.carry()) == 2);
        assert!(at_step.is_some(), "{missing:?}");
        assert_eq!(run.pair.load(), None);
        let [(piece, lies)] = run.pair.lying()[..] else { panic!("it lies somewhere") };
        assert_eq!((piece, lies), (Piece(1), at(2 + at_step.unwrap(), 0)), "where the step began");
    }
}

#[test]
fn with_the_controllers_a_long_way_is_no_danger_and_the_figures_say_how_well_it_was_held() {
    let mut run = Run::new(settings());
    run.lift();
    for _ in 0..20 {
        (0..9).for_each(|_| assert_eq!(done(&run.carry()), 2));
        (0..9).for_each(|_| assert_eq!(done(&run.both(BACKWARD)), 2));
    }
    let held = run.pair.holding();
    assert!(held.force_n.worst() < FORCE_LIMIT_N / 2.0 && held.force_n.rms() < 1.0, "{held:?}");
    assert!(held.angle_rad.worst() < ANGLE_LIMIT / 4.0 && held.angle_rad.rms() < 0.02, "{held:?}");
    assert!(held.gap_m.worst() < GAP_LIMIT_M / 2.0 && held.gap_m.rms() < 0.01 && held.gap_m.rms() > 0.0, "{held:?}");
}

#[test]
fn a_halted_pair_keeps_its_parcel_and_recentres_together() {
    let mut run = Run::new(settings());
    run.lift();
    Which::ALL.into_iter().for_each(|which| run.order(which, FORWARD));
    run.wait(400);
    run.pair.handle_halt(Which::Srm2, run.now);
    let halted = run.events();
    assert_eq!(count(&halted, |event| matches!(event, RobotEvent::Halted(_, true))), 2, "both stop: {halted:?}");
    assert_eq!(lost(&run.wait(600_000)), 0, "ten minutes later");
    run.order(Which::Srm1, FORWARD);
    assert!(words(&run.events()).contains("recentre"));
    run.order(Which::Srm1, Action::Recentre);
    assert_eq!(done(&run.wait(2000)), 0, "not without the other");
    run.order(Which::Srm2, Action::Recentre);
    assert_eq!(done(&run.settle()), 2);
    assert_eq!(done(&run.carry()), 2);
    assert_eq!(run.pair.load().unwrap().place, at(4, 0));
}

#[test]
fn a_halt_while_lifting_leaves_the_parcel_where_it_hangs_and_lifting_goes_on_from_there() {
    let mut run = Run::new(settings());
    run.grip(ALL);
    Which::ALL.into_iter().for_each(|which| run.order(which, Action::Arm(ArmAction::Lift)));
    run.wait(700);
    run.pair.handle_halt(Which::Srm1, run.now);
    assert_eq!(count(&run.events(), |event| matches!(event, RobotEvent::Halted(_, false))), 2);
    let height = run.pair.load_m().unwrap().2;
    assert!((0.4..0.5).contains(&height), "{height}");
    assert!(words(&run.both(FORWARD)).contains("not lifted"));
    assert_eq!(done(&run.arms(ArmAction::Lift)), 2);
    assert!(run.pair.arm(Which::Srm1).lifted);
}

#[test]
fn a_wall_ahead_of_the_one_that_leads_stops_both() {
    let mut run = Run::new(settings());
    run.lift();
    assert!(
        run.pair.close_cell(Cell::new(5, 0)) && !run.pair.close_cell(Cell::new(4, 0)),
        "nobody closes a cell with a robot in it"
    );
    let events = run.carry();
    assert_eq!(count(&events, |event| matches!(event, RobotEvent::Blocked(_, Obstacle::Wall { .. }))), 1);
    assert_eq!(count(&events, |event| matches!(event, RobotEvent::Halted(_, true))), 1);
    assert_eq!(done(&run.both(Action::Recentre)), 2);
    assert_eq!(run.place(Which::Srm1), at(4, 0));
}

#[test]
fn a_robot_alone_runs_neither_into_the_other_nor_into_the_parcel() {
    let mut run = Run::of(Pair::new(hall(), settings(), [stands(1, 0), stands(2, 0)]));
    run.order(Which::Srm1, FORWARD);
    run.order(Which::Srm2, FORWARD);
    let events = run.settle();
    let met = |which| {
        events.iter().find_map(|(who, event)| {
            if let RobotEvent::Blocked(_, obstacle) = event { Some(*obstacle).filter(|_| *who == which) } else { None }
        })
    };
    assert_eq!((met(Which::Srm1), met(Which::Srm2)), (Some(Obstacle::Unknown), Some(Obstacle::Luggage(Piece(1)))));
}

#[test]
fn a_slip_that_is_asked_for_happens_once_while_lifting_or_in_the_middle_of_a_step() {
    for after_steps in [0, 2] {
        let slips = vec![Slip { parcel: 1, after_steps }];
        let mut run = Run::new(PairSettings { mishaps: Mishaps { slips, ..Mishaps::default() }, ..settings() });
        run.grip(ALL);
        let lifted = lost(&run.arms(ArmAction::Lift)) == 0;
        assert_eq!(lifted, after_steps > 0);
        if after_steps == 0 {
            run.lift();
        } else {
            assert_eq!((lost(&run.carry()), lost(&run.carry()), lost(&run.carry())), (0, 0, 2));
            assert_eq!(done(&run.both(Action::Recentre)), 2, "each by itself now");
            assert_eq!((run.place(Which::Srm1), run.place(Which::Srm2)), (at(6, 0), at(4, 0)));
            for action in [ArmAction::AlignEndEffector(at(5, 0)), ArmAction::CloseGripper, ArmAction::HoldForce] {
                assert_eq!(done(&run.arms(action)), 2, "{action:?}");
            }
            run.arms(ArmAction::HoldAngle);
            run.arms(ArmAction::HoldDistance);
            assert_eq!(done(&run.arms(ArmAction::Lift)), 2);
        }
        assert_eq!(done(&run.carry()) + done(&run.carry()) + done(&run.carry()), 6);
    }
}

#[test]
fn what_cannot_be_done_is_refused_in_words_and_nothing_moves() {
    let mut run = Run::new(settings());
    for (action, expect) in [
        (Action::Arm(ArmAction::CloseGripper), "align the gripper first"),
        (Action::Arm(ArmAction::Lift), "hold no parcel"),
        (Action::Arm(ArmAction::HoldForce), "hold no parcel"),
        (Action::Arm(ArmAction::AlignEndEffector(at(9, 0))), "out of its reach"),
        (Action::Arm(ArmAction::AlignEndEffector(at(4, 1))), "there is no parcel"),
        (Action::Enter, "no way out"),
        (Action::Leave, "no way out"),
        (Action::Move(Move::NudgeLeft), "corrective"),
    ] {
        run.order(Which::Srm1, action);
        assert!(words(&run.events()).contains(expect), "{action:?}");
    }
    run.lift();
    for (action, expect) in [(ArmAction::Release, "put it down first"), (ArmAction::AlignEndEffector(at(3, 0)), "let go first")] {
        run.order(Which::Srm1, Action::Arm(action));
        assert!(words(&run.events()).contains(expect), "{action:?}");
    }
}

#[test]
fn grippers_closed_round_nothing_in_common_hold_nothing() {
    let mut run = Run::new(settings());
    run.order(Which::Srm1, Action::Arm(ArmAction::AlignEndEffector(at(3, 0))));
    run.settle();
    run.order(Which::Srm1, Action::Arm(ArmAction::CloseGripper));
    run.settle();
    assert_eq!((run.pair.arm(Which::Srm1).gripper, run.pair.load()), (Gripper::Closed, None));
    run.order(Which::Srm1, Action::Arm(ArmAction::Lift));
    assert!(words(&run.events()).contains("hold no parcel"));
}

#[test]
fn the_camera_finds_the_parcel_unless_it_was_asked_not_to() {
    let unrecognised = vec![1];
    let mut run = Run::new(PairSettings { mishaps: Mishaps { unrecognised, ..Mishaps::default() }, ..settings() });
    let mut look = || {
        run.order(Which::Srm1, Action::Arm(ArmAction::FindParcel(at(5, 0))));
        match run.settle().pop() {
            Some((Which::Srm1, RobotEvent::Found(_, found))) => found,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(look(), None);
    assert_eq!(look(), Some(Parcel { piece: Piece(1), place: at(3, 0) }));
}

#[test]
fn the_train_leaves_the_hall_and_comes_in_again() {
    let hall = Arc::new(Hall::from_rows("test", &["Sa."]).unwrap());
    let settings = PairSettings { way_out: true, ..PairSettings::new(1, Place::ENTRANCE) };
    let mut run = Run::of(Pair::new(hall, settings, [stands(0, 0), stands(2, 0)]));
    for action in [ArmAction::AlignEndEffector(at(1, 0)), ArmAction::CloseGripper, ArmAction::HoldForce, ArmAction::HoldAngle] {
        assert_eq!(done(&run.arms(action)), 2, "{action:?}");
    }
    run.arms(ArmAction::HoldDistance);
    run.arms(ArmAction::Lift);
    for (place, two) in [(Place::Outside(1), 1), (Place::Outside(2), 0)] {
        run.order(Which::Srm1, Action::Leave);
        run.order(Which::Srm2, BACKWARD);
        assert_eq!(done(&run.settle()), 2, "{place:?}");
        assert_eq!((run.place(Which::Srm1), run.place(Which::Srm2)), (place, at(two, 0)));
    }
    run.order(Which::Srm1, Action::Leave);
    assert!(words(&run.events()).contains("the end of the way out"));
    assert_eq!(run.pair.load().unwrap().place, Place::ENTRANCE);
    run.arms(ArmAction::Lower);
    run.arms(ArmAction::Release);
    assert_eq!(run.pair.taken_in(), [Piece(1)]);
    run.order(Which::Srm1, Action::Enter);
    assert_eq!((done(&run.settle()), run.place(Which::Srm1)), (1, Place::Outside(1)));
}

#[test]
fn it_makes_no_difference_how_often_time_is_let_pass() {
    let end = |steps: u64| {
        let mut run = Run::new(settings());
        run.lift();
        Which::ALL.into_iter().for_each(|which| run.order(which, FORWARD));
        (0..steps).for_each(|_| drop(run.wait(900 / steps)));
        (run.pair.memory(), run.pair.holding().force_n)
    };
    assert_eq!(end(1), end(90));
}

#[test]
fn after_a_kill_at_any_moment_bodies_arms_parcel_and_controllers_stand_as_they_stood() {
    for ms in (0..9000).step_by(170) {
        let mut run = Run::new(settings());
        run.grip(ALL);
        Which::ALL.into_iter().for_each(|which| run.order(which, Action::Arm(ArmAction::Lift)));
        run.wait(ms.min(1500));
        if ms >= 1500 {
            Which::ALL.into_iter().for_each(|which| run.order(which, FORWARD));
            run.wait((ms - 1500) % 1000);
        }
        let kept = run.pair.memory();
        let later = Pair::remembering(hall(), settings(), kept.clone(), Now::default());
        let again = later.memory();
        assert_eq!((again.grip, again.lying, again.restarts), (kept.grip, kept.lying, 1), "{ms} ms");
        for (after, before) in again.robots.iter().zip(&kept.robots) {
            assert_eq!((after.stands, after.gripper, after.controllers), (before.stands, before.gripper, before.controllers));
        }
        let mut run = Run::of(later);
        assert_eq!(lost(&run.wait(60_000)), 0, "it is held");
        if run.pair.load_m().unwrap().2 < 1.0 {
            assert_eq!(done(&run.arms(ArmAction::Lift)), 2, "{ms} ms");
        }
        assert_eq!(done(&run.both(Action::Recentre)), 2, "{ms} ms");
        let before = run.pair.load().unwrap().place.cell().unwrap();
        assert_eq!(done(&run.carry()), 2, "{ms} ms");
        assert_eq!(run.pair.load().unwrap().place.cell(), Some(before.ahead(Heading::East)), "{ms} ms");
    }
}
