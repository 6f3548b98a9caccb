//! Missions at full speed for a chosen time, in the real program with the real store and with operators who use every
//! command. The benchmark reports whether memory or descriptors grow. `cargo bench --bench soak -- --minutes 60`;
//! without `--minutes` the run is short.
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

#[path = "common/ask.rs"]
mod ask;
#[path = "soak/operator.rs"]
mod operator;
#[path = "common/program.rs"]
mod program;
#[path = "soak/readers.rs"]
mod readers;
#[path = "soak/usage.rs"]
mod usage;

use std::process::ExitCode;
use std::time::{Duration, Instant};

use operator::Operator;
use program::Program;
use readers::Readers;
use usage::Usage;

/// Duration of a run without `--minutes`.
const SHORT: Duration = Duration::from_secs(20);

/// Interval between printed lines; a shorter run prints ten lines.
const LINE: Duration = Duration::from_secs(10);

/// Fraction of the run for warming up (one fifth): caches fill and threads start. The two halves are counted from
/// there.
const WARM: u32 = 5;

/// Time for the program to notice that readers have disconnected.
const REST: Duration = Duration::from_secs(2);

/// Maximum growth of descriptors in the second half, measured at rest.
const DESCRIPTORS: u64 = 0;

fn main() -> ExitCode {
    let lasts = match minutes() {
        Ok(lasts) => lasts,
        Err(words) => {
            eprintln!("{words}");
            return ExitCode::from(2);
        }
    };
    let program = Program::serve(&["--speed", "max", "--hall", "airport"]);
    let mut soak = Soak {
        operator: Operator::new(&program.address),
        readers: Readers::start(&program.address),
        program,
        since: Instant::now(),
    };
    println!("{}", usage::HEADING);
    let warm = soak.until(lasts / WARM, lasts);
    let middle = soak.until(lasts / WARM + (lasts - lasts / WARM) / 2, lasts);
    let end = soak.until(lasts, lasts);
    verdict(&warm, &middle, &end)
}

/// Duration of the run from the command line.
fn minutes() -> Result<Duration, String> {
    let mut words = std::env::args().skip_while(|word| word != "--minutes").skip(1);
    if !std::env::args().any(|word| word == "--minutes") {
        return Ok(SHORT);
    }
    let said = words.next().unwrap_or_default();
    let minutes = said.parse::<u32>().ok().filter(|minutes| (1..=100_000).contains(minutes));
    let minutes = minutes.ok_or_else(|| format!("--minutes {said:?}: write a whole number from 1, as --minutes 60"))?;
    Ok(Duration::from_secs(60) * minutes)
}

struct Soak {
    program: Program,
    operator: Operator,
    readers: Readers,
    since: Instant,
}

impl Soak {
    /// Runs missions until `end`, then measures without readers, after the program has had time to release their
    /// resources.
    fn until(&mut self, end: Duration, lasts: Duration) -> Usage {
        let every = LINE.min(lasts / 10);
        let mut next = self.since.elapsed() + every;
        while self.since.elapsed() < end {
            self.operator.act();
            if self.since.elapsed() >= next {
                next += every;
                self.line("");
            }
        }
        self.readers.rest(true);
        std::thread::sleep(REST);
        let usage = self.line("at rest");
        self.readers.rest(false);
        usage
    }

    fn line(&self, note: &str) -> Usage {
        let usage = Usage::of(&self.program);
        println!("{}", usage.line(self.since.elapsed(), self.operator.missions(), self.operator.revision(), note));
        usage
    }
}

/// Growth from the warm program to the middle of the run, and from the middle to the end.
fn verdict(warm: &Usage, middle: &Usage, end: &Usage) -> ExitCode {
    let growth = |from: u64, to: u64| i64::try_from(to).unwrap_or(i64::MAX) - i64::try_from(from).unwrap_or(i64::MAX);
    let say = |what, unit, of: fn(&Usage) -> u64| {
        let (first, second) = (growth(of(warm), of(middle)), growth(of(middle), of(end)));
        #[expect(clippy::cast_precision_loss, reason = "kilobytes and descriptors are far below 2^52")]
        let ratio = if first == 0 { "none".to_owned() } else { format!("{:.2}", second as f64 / first as f64) };
        println!("{what}: {first:+} {unit} in the first half, {second:+} {unit} in the second (ratio {ratio})");
    };
    say("memory", "kB", |usage| usage.memory_kb);
    say("descriptors", "", |usage| usage.descriptors);
    say("threads", "", |usage| usage.threads);
    if end.descriptors > middle.descriptors + DESCRIPTORS {
        println!("descriptors grow: {} at rest in the middle, {} at the end", middle.descriptors, end.descriptors);
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
