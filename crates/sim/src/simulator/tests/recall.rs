//! Tests of a simulated robot that continues after its program has died, at any time and any number of times. The
//! tests of storing its memory are beside `state_file`.

use super::*;

const ROWS: [&str; 4] = ["#.....#", ".a.S..b", "...##..", "c......"];

fn settings(seed: u64) -> SimSettings {
    SimSettings { sonar_noise_cm: 0.0, ..SimSettings::new(seed, Camera::Stub) }
}

impl Run {
    /// The same robot in the next run of the program, which knows only this memory. The second value is its first
    /// report.
    fn after_death(&self, memory: SimMemory) -> (Run, Whereabouts) {
        let sim = Sim::remembering(Arc::clone(&self.sim.hall), self.sim.settings, memory);
        let mut run = Run { sim, now: Duration::ZERO, orders: 0 };
        match run.events().as_slice() {
            [RobotEvent::Stands(whereabouts), RobotEvent::LinkUp(_)] => (run, *whereabouts),
            other => panic!("expected where it stands and then the link, got {other:?}"),
        }
    }

    /// Begins an action, lets some of its time pass, halts sometimes, and then dies. The next run knows only the last
    /// stored memory.
    fn die_during(&mut self, action: Action, choices: &mut RandomStream) -> Run {
        self.order(action);
        let mut kept = self.sim.poll_memory();
        let lasts = self.sim.poll_timeout().map_or(Duration::ZERO, |end| end - self.now);
        self.now += lasts.mul_f64(choices.fraction());
        self.sim.handle_timeout(self.now());
        if choices.happens(0.3) {
            self.halt();
        }
        kept = self.sim.poll_memory().or(kept);
        self.after_death(kept.unwrap_or_else(|| self.sim.memory())).0
    }

    fn recentre(&mut self) {
        assert!(is_done(&self.perform(Action::Recentre)));
        assert_eq!(self.body(), BodyPose::centred(self.sim.pose, 0.5));
    }
}

/// Tests safety R2 (docs/safety.md).
#[test]
fn however_often_its_program_dies_it_stays_on_the_floor_and_comes_to_the_same_cells() {
    let mut interrupted = 0;
    for seed in 0..40 {
        let mut choices = RandomStream::new(seed, "deaths");
        let mut steady = Run::with(&ROWS, settings(seed));
        let mut run = Run::with(&ROWS, settings(seed));
        for _ in 0..100 {
            let step = any_move(choices.below(5));
            while choices.happens(0.4) {
                let action = if run.sim.is_off_centre() { Action::Recentre } else { step };
                run = run.die_during(action, &mut choices);
                interrupted += u32::from(run.sim.is_off_centre());
                run.check_floor(seed);
                assert_eq!(run.sim.pose, steady.sim.pose, "seed {seed}: no order was completed");
            }
            run.recentre();
            for robot in [&mut run, &mut steady] {
                robot.perform(step);
                robot.recentre();
            }
            assert_eq!((run.sim.pose, run.body()), (steady.sim.pose, steady.body()), "seed {seed}");
        }
    }
    assert!(interrupted > 1000, "only {interrupted} deaths left it astray");
}

#[test]
fn a_completed_step_is_remembered_and_told_before_the_link_is_up() {
    let mut run = Run::new(&OPEN);
    run.perform(Action::Move(Move::Forward));
    run.perform(Action::Move(Move::TurnLeft));
    let (later, whereabouts) = run.after_death(run.sim.memory());
    let pose = Pose { cell: Cell::new(0, 1), heading: Heading::East };
    assert_eq!(whereabouts, Whereabouts { pose, off_centre: false });
    assert_eq!(later.body(), BodyPose::centred(pose, 0.5));
}

#[test]
fn a_halted_robot_stands_where_it_was_halted() {
    let mut run = Run::new(&OPEN);
    run.order(Action::Move(Move::Forward));
    run.pass_ms(100);
    run.halt();
    let (later, whereabouts) = run.after_death(run.sim.memory());
    assert_eq!(whereabouts, Whereabouts { pose: Pose::START, off_centre: true });
    assert!((later.body().y_m - run.body().y_m).abs() < 1e-6 && later.body().y_m > 0.1);
}

#[test]
fn a_robot_that_has_met_an_obstacle_still_stands_against_it() {
    let mut run = Run::new(&["S", "a", "."]);
    run.perform(Action::Move(Move::Forward));
    let (mut later, whereabouts) = run.after_death(run.sim.memory());
    assert!(whereabouts.off_centre && (later.body().y_m - 0.1).abs() < 1e-6);
    assert!(failure(&later.perform(Action::Move(Move::Backward))).contains("recentre first"));
    later.recentre();
}

#[test]
fn there_is_something_to_keep_once_after_each_change() {
    let mut run = Run::new(&OPEN);
    let changes = |run: &mut Run| std::iter::from_fn(|| run.sim.poll_memory()).count();
    assert_eq!(changes(&mut run), 1, "the beginning");
    run.pass_ms(1000);
    assert_eq!(changes(&mut run), 0, "time alone is no change");
    run.order(Action::Move(Move::Forward));
    assert_eq!(changes(&mut run), 1);
    run.pass_ms(100);
    assert_eq!(changes(&mut run), 0);
    run.halt();
    assert_eq!(changes(&mut run), 1);
    run.perform(Action::Recentre);
    assert_eq!(changes(&mut run), 1);
}

#[test]
fn the_temperature_goes_on_where_it_was() {
    let text = "width = 2\nheight = 2\n[[temperature]]\nat_s = 0\ncelsius = 20\n[[temperature]]\nat_s = 100\ncelsius = 30\n";
    let hall = Arc::new(Hall::parse("t.toml", text).unwrap());
    let mut run = Run { sim: Sim::new(hall, settings(1)), now: Duration::ZERO, orders: 0 };
    let degrees = |events: Vec<RobotEvent>| -> Vec<f64> {
        let reading = |event| if let RobotEvent::Temperature(reading) = event { Some(reading.degrees()) } else { None };
        events.into_iter().filter_map(reading).collect()
    };
    assert_eq!(degrees(run.pass_ms(40_500)).last(), Some(&24.0));
    let memory = run.sim.poll_memory().expect("a temperature was told");
    let (mut later, _) = run.after_death(memory);
    assert_eq!(degrees(later.pass_ms(0)), [24.0], "the first reading at once");
    assert_eq!(degrees(later.pass_ms(10_000)).last(), Some(&25.0));
    let (mut last, _) = later.after_death(later.sim.memory());
    assert_eq!(degrees(last.pass_ms(60_000)).last(), Some(&30.0));
    assert_eq!(last.sim.poll_timeout(), None, "the curve has ended");
}

#[test]
fn the_noise_of_the_sensors_begins_anew_with_each_restart() {
    let noisy = SimSettings { sonar_noise_cm: 5.0, ..settings(1) };
    let readings = |sim: Sim| {
        let mut run = Run { sim, now: Duration::ZERO, orders: 0 };
        run.events();
        (0..20)
            .flat_map(|_| run.perform(Action::Recentre))
            .filter(|event| matches!(event, RobotEvent::Sonar(_)))
            .collect::<Vec<_>>()
    };
    let hall = Arc::new(Hall::from_rows("test", &["S...", "....", "....", "...."]).unwrap());
    let first = Sim::new(Arc::clone(&hall), noisy);
    let second = Sim::remembering(Arc::clone(&hall), noisy, first.memory());
    let third = Sim::remembering(hall, noisy, second.memory());
    let readings = [first, second, third].map(readings);
    assert!(readings[0] != readings[1] && readings[1] != readings[2] && readings[0] != readings[2]);
}

#[test]
fn one_that_left_the_hall_is_outside_in_the_next_run_and_one_halted_on_the_way_goes_back_where_it_came_from() {
    let mut run = Run::with(&OPEN, settings(1));
    assert!(is_done(&run.perform(Action::Leave)));
    for halted in [false, true] {
        if halted {
            run.order(Action::Enter);
            run.pass_ms(100);
            run.halt();
        }
        let sim = Sim::remembering(Arc::clone(&run.sim.hall), run.sim.settings, run.sim.memory());
        let mut later = Run { sim, now: Duration::ZERO, orders: 0 };
        let first = later.events();
        assert_eq!(first.first(), Some(&RobotEvent::StandsOutside(1, Heading::South, halted)), "{first:?}");
        assert!(is_done(&later.perform(Action::Recentre)) && is_done(&later.perform(Action::Enter)));
        assert_eq!(later.body(), BodyPose::centred(Pose::START, 0.5));
    }
}
