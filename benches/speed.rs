//! Speed of hallsweep, printed beside a bound or a rival measured in the same run. `cargo bench` runs it; this file
//! contains no tests.
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

#[path = "common/ask.rs"]
mod ask;
#[path = "common/goals.rs"]
#[expect(dead_code, reason = "no rival, and no goal that was missed before")]
mod goals;
#[path = "common/program.rs"]
mod program;

use std::hint::black_box;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use hallsweep::runtime::figures::{Figures, HandedPages, Latency};
use hallsweep_core::command::Strategy;
use hallsweep_core::effect::{Action, Order, Page, Stamp};
use hallsweep_core::engine::Engine;
use hallsweep_core::settings::Settings;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{Cell, Epoch, Heading, Now, OrderId, Pose, Seq, WallTime};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_sim::headless::{Verdicts, explore};
use hallsweep_sim::{Camera, Hall, Sim, SimSettings};
use program::Program;

/// Pages counted in a run.
const PAGES: u64 = 10_000;

fn main() -> ExitCode {
    mission();
    photo();
    start_to_order();
    reading_figures();
    counting();
    idle();
    goals::exit()
}

/// Records the goal that a figure is at most `most`.
fn within(what: &str, figure: Duration, most: Duration) {
    goals::met(&format!("{what}: {figure:.2?} (at most {most:?})"), figure <= most);
}

/// Minimum and median time of some runs.
fn timed(runs: usize, mut work: impl FnMut()) -> (Duration, Duration) {
    let mut times: Vec<Duration> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed()
        })
        .collect();
    times.sort();
    (times[0], times[runs / 2])
}

fn ratio(figure: Duration, bound: Duration) -> f64 {
    figure.as_secs_f64() / bound.as_secs_f64().max(1e-9)
}

fn airport() -> Arc<Hall> {
    Arc::new(Hall::named_or_file("airport").expect("the hall comes with the program"))
}

/// A whole mission through core and simulator without photos, beside the least work of a planner: one look at every
/// cell per move.
fn mission() {
    let hall = airport();
    let run =
        || explore(&hall, SimSettings::new(1, Camera::Stub), Settings::default(), Strategy::Snail, Verdicts::AllSafe, |_| {});
    let moves = run().moves.total();
    let cells = hall.reachable().len() as u64;
    let (_, mission) = timed(50, || drop(black_box(run())));
    let (_, bound) = timed(50, || {
        for n in 0..moves * cells {
            black_box(n);
        }
    });
    println!("airport mission, {moves} moves: {mission:.2?}; {:.1} × one look at every cell a move", ratio(mission, bound));
    within("an airport mission", mission, Duration::from_millis(20));
}

fn now(since_start: Duration) -> Now {
    Now { since_start, ..Now::default() }
}

/// One photo, beside filling and copying the same number of pixels.
fn photo() {
    let mut sim = Sim::new(airport(), SimSettings::new(1, Camera::Rendered));
    let stamp = Stamp { pose: Pose::START, wall: Default::default() };
    let order = Order { id: OrderId(1), action: Action::Photograph(stamp), epoch: Epoch(0), deadline: Duration::from_secs(10) };
    sim.handle_order(order, now(Duration::ZERO));
    let (_, exposure) = sim.take_exposure().expect("a photo order exposes");
    let bytes = exposure.develop().bytes.len();
    let (_, photo) = timed(30, || drop(black_box(exposure.develop())));
    let (_, bound) = timed(30, || drop(black_box(vec![7u8; 640 * 480 * 3].iter().map(|byte| byte ^ 1).collect::<Vec<u8>>())));
    println!("photo, {} kB: {photo:.2?}; {:.1} × filling its pixels", bytes / 1000, ratio(photo, bound));
    within("a photo", photo, Duration::from_millis(25));
}

/// A program at real-time speed.
fn program() -> Program {
    Program::serve(&["--speed", "1"])
}

/// Sends one request on a separate connection.
fn ask(program: &Program, method: &str, path: &str) -> String {
    ask::ask(&program.address, method, path, "").expect("the program answers")
}

/// CPU time used by a program, in clock ticks.
fn cpu_ticks(program: &Program) -> u64 {
    let stat = std::fs::read_to_string(program.proc("stat")).unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    [11, 12].into_iter().filter_map(|n| fields.get(n)?.parse::<u64>().ok()).sum()
}

/// START over HTTP until its answer. The order reaches the robot's port before the answer is sent, so this time is an
/// upper bound.
fn start_to_order() {
    let program = program();
    let (_, healthz) = timed(50, || drop(black_box(ask(&program, "GET", "/healthz"))));
    let (_, start) = timed(50, || {
        let answer = ask(&program, "POST", "/api/v1/commands/start");
        assert!(answer.contains("\"accepted\":true"), "{answer}");
        ask(&program, "POST", "/api/v1/commands/stop");
    });
    println!("START and STOP over HTTP: {start:.2?}; {:.1} × two bare requests", ratio(start, healthz * 2));
    within("START and STOP together, which is more than START alone", start, Duration::from_millis(5));
}

/// Cost of reading all metrics, beside the state as JSON, during a mission.
fn reading_figures() {
    let program = program();
    ask(&program, "POST", "/api/v1/commands/start");
    let (_, state) = timed(200, || drop(black_box(ask(&program, "GET", "/api/v1/state"))));
    let (_, figures) = timed(200, || {
        let answer = ask(&program, "GET", "/metrics");
        assert!(answer.ends_with("# EOF\n"), "{answer}");
    });
    println!("all figures over HTTP: {figures:.2?}; {:.2} × the state as JSON", ratio(figures, state));
    goals::at_most("reading all figures beside the state as JSON", ratio(figures, state), 3.0);
}

/// Cost of the metrics in the main loop: counting a page of a step when it is sent and when it is stored, beside a
/// mission's step in the core and the simulator; also one observation of a histogram.
fn counting() {
    let hall = airport();
    let run =
        || explore(&hall, SimSettings::new(1, Camera::Stub), Settings::default(), Strategy::Snail, Verdicts::AllSafe, |_| {});
    let moves = run().moves.total();
    let (_, mission) = timed(50, || drop(black_box(run())));
    let step = mission / u32::try_from(moves).expect("an airport has fewer");
    let figures = Figures::default();
    let idle = Engine::new(Settings::default(), Strategy::Snail, "bench".into()).snapshot();
    let mut handed = HandedPages::new(figures, &idle);
    let pages: Vec<Page> = (0..PAGES).map(page_of_a_step).collect();
    let (_, counted) = timed(50, || {
        for page in &pages {
            handed.hand(page, Duration::ZERO);
            handed.keep(page.last(), Duration::from_millis(1));
        }
    });
    let latency = Latency::default();
    let (_, observed) = timed(50, || (0..PAGES).for_each(|n| latency.observe(black_box(Duration::from_micros(n)))));
    let [page, observation] = [counted, observed].map(|all| all / u32::try_from(PAGES).expect("they are few"));
    println!(
        "counting a page of a step: {page:.2?}, an observation in it: {observation:.2?}; {:.4} × a step of {step:.2?}",
        ratio(page, step)
    );
    goals::at_most("counting beside a step of core and simulator", ratio(page, step), 0.05);
}

/// Page of a step: the visited cell, and the robot's pose.
fn page_of_a_step(n: u64) -> Page {
    let cell = Cell::new(i32::try_from(n % 500).unwrap_or(0), 0);
    let facts = [Fact::Mark(cell, Mark::Visited), Fact::Pose(Pose { cell, heading: Heading::East })];
    Page {
        first: Seq(2 * n + 1),
        entries: facts.into_iter().map(|fact| Entry { wall: WallTime::default(), fact }).collect(),
        kept_back: None,
    }
}

/// CPU of a program without requests, in percent of one core over five seconds.
fn idle() {
    let program = program();
    ask(&program, "GET", "/healthz");
    let before = cpu_ticks(&program);
    std::thread::sleep(Duration::from_secs(5));
    let used = cpu_ticks(&program) - before;
    println!("idle: {used} ticks of 10 ms in 5 s ({:.1} % of a core)", f64::from(u32::try_from(used).unwrap_or(u32::MAX)) / 5.0);
}
