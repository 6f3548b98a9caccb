//! The goals of a benchmark as they turned out, and the exit code that tells of them. Figures and ratios are made elsewhere.

use std::process::ExitCode;
use std::sync::atomic::{AtomicU32, Ordering};

/// The exit codes of a benchmark: a goal was missed; hallsweep, or a part of the benchmark, was not there to be measured.
const MISSED: u8 = 1;
const NOT_RUN: u8 = 2;

static MISSES: AtomicU32 = AtomicU32::new(0);
static ABSENCES: AtomicU32 = AtomicU32::new(0);

/// A goal that has been met before: missed, it fails.
pub(crate) fn met(what: &str, is_met: bool) {
    MISSES.fetch_add(u32::from(!is_met), Ordering::Relaxed);
    println!("  goal {what}: {}", if is_met { "met" } else { "MISSED" });
}

/// A ratio that is to be at most so much.
pub(crate) fn at_most(what: &str, ratio: f64, goal: f64) {
    met(&format!("{what}: {ratio:.2} (at most {goal})"), ratio <= goal);
}

/// A goal that was missed before as well: it fails only when the figure is worse than it ever was, by more than a tenth.
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

/// A goal that nobody can be held against in this run, because the rival is not to be had: said, and no fault of ours.
pub(crate) fn not_judged(what: &str) {
    println!("  goal {what}: not judged, there is nobody to compare with");
}

/// Who is left out of the figures, and why: a rival may be, hallsweep may not.
pub(crate) fn left_out(who: &str, is_ours: bool, why: &str) {
    ABSENCES.fetch_add(u32::from(is_ours), Ordering::Relaxed);
    println!("  {who} is left out: {why}");
}

/// What the benchmark ends with.
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
