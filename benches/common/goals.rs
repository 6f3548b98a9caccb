//! The goals of a benchmark, their results, and the exit code that reports them. Figures and ratios are computed
//! elsewhere.

use std::process::ExitCode;
use std::sync::atomic::{AtomicU32, Ordering};

/// Exit codes: a goal was missed; hallsweep or a part of the benchmark could not be measured.
const MISSED: u8 = 1;
const NOT_RUN: u8 = 2;

static MISSES: AtomicU32 = AtomicU32::new(0);
static ABSENCES: AtomicU32 = AtomicU32::new(0);

/// Records a goal that was met before, so that missing it fails the benchmark.
pub(crate) fn met(what: &str, is_met: bool) {
    MISSES.fetch_add(u32::from(!is_met), Ordering::Relaxed);
    println!("  goal {what}: {}", if is_met { "met" } else { "MISSED" });
}

/// Records the goal that a ratio is at most `goal`.
pub(crate) fn at_most(what: &str, ratio: f64, goal: f64) {
    met(&format!("{what}: {ratio:.2} (at most {goal})"), ratio <= goal);
}

/// Records a goal that was already missed before. It fails only when the ratio is more than a tenth above the earlier
/// one.
pub(crate) fn known(what: &str, ratio: f64, goal: f64, before: f64) {
    let bound = before * 1.1;
    let said = if ratio <= goal {
        "met, which it was not before".to_owned()
    } else if ratio <= bound {
        format!("missed as before (at most {before}); must not be over {bound:.2}")
    } else {
        MISSES.fetch_add(1, Ordering::Relaxed);
        format!("MISSED, and worse than before (at most {before})")
    };
    println!("  goal {what}: {ratio:.2} (at most {goal}): {said}");
}

/// Prints that a goal cannot be judged because the rival is missing, which is no failure.
pub(crate) fn not_judged(what: &str) {
    println!("  goal {what}: not judged, there is nobody to compare with");
}

/// Prints who is left out and why. A missing rival is no failure, a missing hallsweep is one.
pub(crate) fn left_out(who: &str, is_ours: bool, why: &str) {
    ABSENCES.fetch_add(u32::from(is_ours), Ordering::Relaxed);
    println!("  {who} is left out: {why}");
}

/// Prints a summary and returns the exit code.
pub(crate) fn exit() -> ExitCode {
    let (misses, absences) = (MISSES.load(Ordering::Relaxed), ABSENCES.load(Ordering::Relaxed));
    if absences > 0 {
        println!("{absences} of what was to be measured could not be, and {misses} goals were missed");
        return ExitCode::from(NOT_RUN);
    }
    if misses > 0 {
        println!("{misses} goals were missed");
        return ExitCode::from(MISSED);
    }
    ExitCode::SUCCESS
}
