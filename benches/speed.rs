//! How fast hallsweep is, printed beside a bound or a peer measured in the same run. `cargo bench` runs it; nothing here is a test.
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

use std::hint::black_box;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Command as Process, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use hallsweep::core::effect::{Action, Order, Stamp};
use hallsweep::core::explore::Strategy;
use hallsweep::core::settings::Settings;
use hallsweep::core::units::{Epoch, Now, OrderId, Pose};
use hallsweep::headless::{Verdicts, explore};
use hallsweep::outbound::robot::sim::{Camera, Hall, Sim, SimSettings};

fn main() {
    mission();
    photo();
    start_to_order();
    idle();
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
    println!(
        "airport mission, {moves} moves: {mission:.2?} (goal 20 ms); {:.1} × one look at every cell a move",
        ratio(mission, bound)
    );
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
    println!("photo, {} kB: {photo:.2?} (goal 25 ms); {:.1} × filling its pixels", bytes / 1000, ratio(photo, bound));
}

/// A running program on a port of its own.
struct Program {
    child: std::process::Child,
    address: String,
}

impl Program {
    fn start() -> Program {
        let mut child = Process::new(env!("CARGO_BIN_EXE_hallsweep"))
            .args(["serve", "--http", "127.0.0.1:0", "--speed", "1"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program was built for this benchmark");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("its output is piped")).read_line(&mut line).expect("it says where it is");
        let address = line.trim().rsplit("http://").next().unwrap_or_default().trim_end_matches('/').to_owned();
        Program { child, address }
    }

    /// One request on a connection of its own; the answer's body.
    fn ask(&self, method: &str, path: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).expect("the program listens");
        let request =
            format!("{method} {path} HTTP/1.1\r\nHost: {}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n", self.address);
        stream.write_all(request.as_bytes()).expect("it reads");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("it answers");
        answer
    }

    /// Clock ticks of CPU the program has used.
    fn cpu_ticks(&self) -> u64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap_or_default();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
        [11, 12].into_iter().filter_map(|n| fields.get(n)?.parse::<u64>().ok()).sum()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// START over HTTP until its answer: the order is at the robot's port before the answer is sent, so this bounds it from above.
fn start_to_order() {
    let program = Program::start();
    let (_, healthz) = timed(50, || drop(black_box(program.ask("GET", "/healthz"))));
    let (_, start) = timed(50, || {
        let answer = program.ask("POST", "/api/v1/commands/start");
        assert!(answer.contains("\"accepted\":true"), "{answer}");
        program.ask("POST", "/api/v1/commands/stop");
    });
    println!(
        "START and STOP over HTTP: {start:.2?} (goal for START alone 5 ms); {:.1} × two bare requests",
        ratio(start, healthz * 2)
    );
}

/// CPU of a program that nobody asks anything, in percent of one core over five seconds.
fn idle() {
    let program = Program::start();
    program.ask("GET", "/healthz");
    let before = program.cpu_ticks();
    std::thread::sleep(Duration::from_secs(5));
    let used = program.cpu_ticks() - before;
    println!("idle: {used} ticks of 10 ms in 5 s ({:.1} % of a core)", f64::from(u32::try_from(used).unwrap_or(u32::MAX)) / 5.0);
}
