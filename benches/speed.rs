//! How fast hallsweep is, printed beside a bound or a peer measured in the same run. `cargo bench` runs it; nothing here is a test.
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

use hallsweep_core::effect::{Action, Order, Stamp};
use hallsweep_core::search::Strategy;
use hallsweep_core::settings::Settings;
use hallsweep_core::units::{Epoch, Now, OrderId, Pose};
use hallsweep_sim::headless::{Verdicts, explore};
use hallsweep_sim::{Camera, Hall, Sim, SimSettings};
use program::Program;

fn main() -> ExitCode {
    mission();
    photo();
    start_to_order();
    idle();
    goals::exit()
}

/// A figure that may be no longer than this.
fn within(what: &str, figure: Duration, most: Duration) {
    goals::met(&format!("{what}: {figure:.2?} (at most {most:?})"), figure <= most);
}

/// The least and the median of some runs.
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

/// A whole mission through core and simulator, photos aside, beside the planner's least work: one look at every cell a move.
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

/// One photo, beside filling and copying as many pixels.
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

/// A program at the speed of a person's watch.
fn program() -> Program {
    Program::serve(&["--speed", "1"])
}

/// One request on a connection of its own.
fn ask(program: &Program, method: &str, path: &str) -> String {
    ask::ask(&program.address, method, path, "").expect("the program answers")
}

/// Clock ticks of CPU a program has used.
fn cpu_ticks(program: &Program) -> u64 {
    let stat = std::fs::read_to_string(program.proc("stat")).unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    [11, 12].into_iter().filter_map(|n| fields.get(n)?.parse::<u64>().ok()).sum()
}

/// START over HTTP until its answer: the order is at the robot's port before the answer is sent, so this bounds it from above.
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

/// CPU of a program that nobody asks anything, in percent of one core over five seconds.
fn idle() {
    let program = program();
    ask(&program, "GET", "/healthz");
    let before = cpu_ticks(&program);
    std::thread::sleep(Duration::from_secs(5));
    let used = cpu_ticks(&program) - before;
    println!("idle: {used} ticks of 10 ms in 5 s ({:.1} % of a core)", f64::from(u32::try_from(used).unwrap_or(u32::MAX)) / 5.0);
}
