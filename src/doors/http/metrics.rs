//! `GET /metrics`: the figures of the program and the state of the mission. The header `Accept` selects the text
//! format of Prometheus or of OpenMetrics. The state comes from the snapshot that all doors use, so a reader does not
//! delay the loop.

use std::fmt;
use std::sync::atomic::AtomicU64;

use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::{Registry, Unit};

use super::HttpDoor;
use super::accept;
use super::problem::Problem;
use crate::runtime::figures::{Figures, Series, flag};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::snapshot::searched::{Searched, SearchedHall};

/// Media types of both formats. The default is the first one.
pub(super) const FORMATS: [&str; 2] = ["text/plain", "application/openmetrics-text"];

const PREFIX: &str = "hallsweep";

pub(super) async fn metrics(door: HttpDoor, headers: HeaderMap) -> Result<Response, Problem> {
    let text = written(door.hall.handle.figures(), &door.hall.handle.snapshot()).map_err(|_| Problem::internal())?;
    // A client that names neither format gets the older one, which all Prometheus clients can read.
    let (media_type, text) = match accept::preferred(&headers, &FORMATS) {
        Some("application/openmetrics-text") => ("application/openmetrics-text; version=1.0.0; charset=utf-8", text),
        _ => ("text/plain; version=0.0.4; charset=utf-8", in_text_format(&text)),
    };
    Ok(([(header::CONTENT_TYPE, media_type), (header::VARY, "accept")], text).into_response())
}

/// Converts OpenMetrics to the text format of Prometheus, version 0.0.4. In that format, the family of a counter has
/// the same name as its samples. An info metric is a gauge. The format has no units and no end mark.
fn in_text_format(open_metrics: &str) -> String {
    let mut text = String::with_capacity(open_metrics.len());
    let mut help = "";
    for line in open_metrics.lines() {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["#", "EOF"] | ["#", "UNIT", ..] => {}
            ["#", "HELP", name, ..] => help = line.split_once(name).map_or("", |(_, help)| help),
            ["#", "TYPE", name, kind] => {
                let (suffix, kind) = match kind {
                    "counter" => ("_total", kind),
                    "info" => ("_info", "gauge"),
                    _ => ("", kind),
                };
                text.push_str(&format!("# HELP {name}{suffix}{help}\n# TYPE {name}{suffix} {kind}\n"));
            }
            _ => text.extend([line, "\n"]),
        }
    }
    text
}

fn written(figures: &Figures, snapshot: &Snapshot) -> Result<String, fmt::Error> {
    let mut registry = Registry::with_prefix(PREFIX);
    figures.register(&mut registry);
    register_state(snapshot, &mut registry);
    let mut text = String::new();
    encode(&mut text, &registry)?;
    Ok(text)
}

fn register_state(snapshot: &Snapshot, to: &mut Registry) {
    let mission = &snapshot.mission;
    let number = Gauge::<u64, AtomicU64>::default();
    number.set(mission.id.0);
    to.register("mission_number", "Number of the current mission; 0 before the first mission", number);
    let phases = PhaseName::ALL.map(|phase| ([phase.name()], flag(phase == mission.phase)));
    to.register("phase", "1 for the current phase of the mission, 0 for every other phase", Series::of(["phase"], phases));
    let holds = Hold::ALL.map(|hold| ([hold.name()], flag(mission.holds.contains(&hold))));
    to.register("hold", "1 for every active reason why nothing moves, 0 for every other reason", Series::of(["hold"], holds));
    let robots = snapshot.robots.iter().map(|robot| ([robot.id.name()], flag(!robot.holds.contains(&Hold::RobotLink))));
    to.register("robot_reached", "1 for every robot that can be reached, 0 for every other robot", Series::of(["robot"], robots));
    register_coverage(&snapshot.searched(), to);
    let temperature = &snapshot.temperature;
    let latest = "Latest reading of all temperature sources; absent before the first reading and while all sources are silent";
    if let Some(reading) = temperature.celsius.filter(|_| temperature.silent_since.is_none()) {
        to.register_with_unit("temperature", latest, Unit::Celsius, gauge(reading.degrees()));
    }
    let threshold = "Temperature above which nothing moves";
    to.register_with_unit("temperature_threshold", threshold, Unit::Celsius, gauge(temperature.threshold.degrees()));
}

/// The whole hall has an empty label `area`, which no named area can have.
#[expect(clippy::cast_precision_loss, reason = "a hall has fewer cells than 2^53")]
fn register_coverage(all: &SearchedHall, to: &mut Registry) {
    // The library writes the values of labels as they are.
    let named = all.areas.iter().map(|(area, searched)| (area.name.replace('\\', r"\\").replace('"', "\\\""), searched));
    let named: Vec<(String, &Searched)> = named.chain([(String::new(), &all.hall)]).collect();
    let parts = || named.iter().map(|(area, searched)| (area.as_str(), *searched));
    let cells = parts().flat_map(|(area, searched)| searched.parts().map(|(how, cells)| ([area, how], gauge(cells as f64))));
    let words = "Number of cells of the hall and of each named area, by how they were searched";
    to.register("coverage_cells", words, Series::of(["area", "searched"], cells));
    let shares = parts().filter_map(|(area, searched)| Some(([area], gauge(searched.detection?))));
    let words = "Probability that a piece in the hall or in a named area was found; absent if it is unknown";
    to.register("coverage_detection", words, Series::of(["area"], shares));
}

fn gauge(value: f64) -> Gauge<f64, AtomicU64> {
    let gauge = Gauge::default();
    gauge.set(value);
    gauge
}

#[cfg(test)]
#[path = "metrics_tests.rs"]
mod tests;
