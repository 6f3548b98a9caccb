//! Events and figures of a run in English, for the command line and for programs. Pages translate them.

use super::record::{Entry, Figures, News};
use hallsweep_sim::pair::Spread;

/// The value of `kind` in the JSON report. It is the same in every language.
pub const fn kind(news: News) -> &'static str {
    match news {
        News::Began(_) => "phase",
        News::Said(_) => "alarm",
        News::Acknowledged => "acknowledged",
        News::Started => "start",
        News::Lost => "lost",
        News::Stopped => "stop",
        News::Restarted => "restart",
    }
}

pub fn words(entry: &Entry) -> String {
    match entry.news {
        News::Began(phase) => format!("phase {}: {}", phase.number(), phase.in_words()),
        News::Said(saying) => format!("ALARM: {}", saying.in_words()),
        News::Acknowledged => "the operator has acknowledged the alarm".to_owned(),
        News::Started => "START is pressed".to_owned(),
        News::Lost => "the parcel slips out of the grippers".to_owned(),
        News::Stopped => "STOP: both robots are halted".to_owned(),
        News::Restarted => "the program was started again".to_owned(),
    }
}

pub fn rows(figures: &Figures) -> [(&'static str, String); 7] {
    let holding = &figures.holding;
    let error = |spread: &Spread, scale: f64, unit: &str| {
        format!("{:.2} {unit} (root mean square {:.2} {unit})", spread.worst() * scale, spread.rms() * scale)
    };
    [
        ("parcels", format!("{} of {} in the target area", figures.delivered, figures.parcels)),
        ("time", format!("{:.1} s, {} ticks", figures.took.as_secs_f64(), figures.ticks)),
        ("losses", figures.losses.to_string()),
        ("worst force error", error(&holding.force_n, 1.0, "N")),
        ("worst angle error", error(&holding.angle_rad, 1000.0, "mrad")),
        ("worst gap error", error(&holding.gap_m, 1000.0, "mm")),
        ("seed", figures.seed.to_string()),
    ]
}
