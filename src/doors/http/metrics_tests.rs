//! Tests of `/metrics`: its contents agree with the documentation page, the dashboard, and the tables of commands and
//! doors.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::*;
use crate::api::commands::COMMANDS;
use crate::api::door;
use crate::api::tests::documented;
use crate::api::tests::fixture::searching;
use crate::doors::http::testing::{app, text};
use crate::runtime::figures::{self, OTHER};
use hallsweep_core::command::Command;
use hallsweep_core::units::Cell;
use hallsweep_core::world::areas::Area;
use hallsweep_core::world::coverage::SensorModel;

#[derive(Debug, Default)]
struct Family {
    kind: String,
    unit: String,
    help: String,
    /// Names of the samples of this family, such as `hallsweep_steps_total`.
    samples: BTreeSet<String>,
    /// The values of each label, in order.
    labels: BTreeMap<String, Vec<String>>,
}

fn shown() -> String {
    let mut snapshot = searching();
    snapshot.venue.sensor.model = Some(SensorModel::SimCamera);
    written(&Figures::default(), &snapshot).unwrap()
}

/// Splits a line of metrics into its name, its labels and its value. The line must not be a comment.
fn sample(line: &str) -> (String, Vec<(String, String)>, f64) {
    let (series, value) = line.rsplit_once(' ').unwrap();
    let (name, labels) = series.split_once('{').unwrap_or((series, ""));
    let pair = |pair: &str| pair.split_once('=').map(|(label, value)| (label.to_owned(), value.trim_matches('"').to_owned()));
    (name.to_owned(), labels.trim_end_matches('}').split(',').filter_map(pair).collect(), value.parse().unwrap())
}

fn families(text: &str) -> Vec<(String, Family)> {
    let mut families: Vec<(String, Family)> = Vec::new();
    for line in text.lines().filter(|line| *line != "# EOF") {
        if let Some(help) = line.strip_prefix("# HELP ") {
            let (name, help) = help.split_once(' ').unwrap();
            families.push((name.to_owned(), Family { help: help.to_owned(), ..Family::default() }));
            continue;
        }
        let (family, about) = families.last_mut().unwrap();
        if let Some(kind) = line.strip_prefix("# TYPE ") {
            about.kind = kind.strip_prefix(&format!("{family} ")).unwrap().to_owned();
        } else if let Some(unit) = line.strip_prefix("# UNIT ") {
            about.unit = unit.strip_prefix(&format!("{family} ")).unwrap().to_owned();
        } else {
            let (name, labels, _) = sample(line);
            about.samples.insert(name);
            for (label, value) in labels {
                let values = about.labels.entry(label).or_default();
                if !values.contains(&value) {
                    values.push(value);
                }
            }
        }
    }
    families
}

fn value(text: &str, series: &str) -> Option<f64> {
    text.lines().find_map(|line| line.strip_prefix(series)?.strip_prefix(' ')?.parse().ok())
}

#[tokio::test]
async fn it_is_the_text_of_open_metrics_to_its_end_for_whoever_prefers_that() {
    // The header that Prometheus 3 sends.
    let wish = "application/openmetrics-text;version=1.0.0;escaping=allow-utf-8;q=0.5,application/openmetrics-text;version=0.0.1;q=0.4,\
                text/plain;version=1.0.0;escaping=allow-utf-8;q=0.3,text/plain;version=0.0.4;q=0.2,*/*;q=0.1";
    let response = app(searching()).send("GET", "/metrics", &[("accept", wish)], "").await;
    assert_eq!((response.status().as_u16(), response.headers()["vary"].as_bytes()), (200, &b"accept"[..]));
    assert_eq!(response.headers()["content-type"], "application/openmetrics-text; version=1.0.0; charset=utf-8");
    let text = text(response).await;
    assert!(text.ends_with("\n# EOF\n"), "{text}");
    assert_eq!(text.matches("# EOF").count(), 1);
}

#[tokio::test]
async fn it_is_the_text_of_prometheus_for_everybody_else() {
    for wish in ["*/*", "text/plain", "text/plain;version=0.0.4, application/openmetrics-text;q=0.5", "image/png"] {
        let response = app(searching()).send("GET", "/metrics", &[("accept", wish)], "").await;
        assert_eq!(response.headers()["content-type"], "text/plain; version=0.0.4; charset=utf-8", "{wish}");
        let text = text(response).await;
        for line in [
            "# HELP hallsweep_steps_total Moves of",
            "# TYPE hallsweep_steps_total counter\n",
            "# TYPE hallsweep_build_info gauge\n",
        ] {
            assert!(text.contains(line), "{line} in {text}");
        }
        assert!(!text.contains("# EOF") && !text.contains("# UNIT"), "{text}");
    }
}

/// Checks the names by https://prometheus.io/docs/practices/naming.
#[test]
fn every_family_has_a_name_by_the_conventions_a_unit_and_a_meaning() {
    for (name, Family { kind, unit, help, samples, .. }) in families(&shown()) {
        assert!(name.starts_with("hallsweep_") && help.len() > 10 && !samples.is_empty(), "{name}: {help}");
        assert!(unit.is_empty() || name.ends_with(&format!("_{unit}")), "{name}: {unit}");
        let suffixes: &[&str] = match kind.as_str() {
            "counter" => &["_total"],
            "gauge" => &[""],
            "histogram" => &["_bucket", "_count", "_sum"],
            "info" => &["_info"],
            other => panic!("{name} is a {other}"),
        };
        assert_eq!(samples, suffixes.iter().map(|suffix| format!("{name}{suffix}")).collect(), "{name}");
        assert_eq!(kind == "histogram", unit == "seconds" && !name.contains("start_time"), "{name}");
    }
}

#[test]
fn what_stands_is_of_the_snapshot() {
    let mut snapshot = searching();
    snapshot.mission.holds = vec![Hold::Operator, Hold::AwaitingStart];
    let unreached = |snapshot: &mut Snapshot| {
        let mut robots = snapshot.robots.to_vec();
        robots[0].holds = vec![Hold::RobotLink];
        snapshot.robots = robots.into();
    };
    let at = |snapshot: &Snapshot, series: &str| value(&written(&Figures::default(), snapshot).unwrap(), series);
    assert_eq!(at(&snapshot, "hallsweep_mission_number"), Some(1.0));
    for phase in PhaseName::ALL {
        let expect = f64::from(u8::from(phase == PhaseName::Inspecting));
        assert_eq!(at(&snapshot, &format!("hallsweep_phase{{phase=\"{}\"}}", phase.name())), Some(expect));
    }
    for hold in Hold::ALL {
        let expect = f64::from(u8::from(snapshot.mission.holds.contains(&hold)));
        assert_eq!(at(&snapshot, &format!("hallsweep_hold{{hold=\"{}\"}}", hold.name())), Some(expect));
    }
    assert_eq!(at(&snapshot, "hallsweep_temperature_celsius"), Some(21.4));
    assert_eq!(at(&snapshot, "hallsweep_temperature_threshold_celsius"), Some(25.0));
    snapshot.temperature.celsius = None;
    assert_eq!(at(&snapshot, "hallsweep_temperature_celsius"), None);
    let reached = "hallsweep_robot_reached{robot=\"discovery\"}";
    assert_eq!(at(&snapshot, reached), Some(1.0));
    unreached(&mut snapshot);
    assert_eq!(at(&snapshot, reached), Some(0.0));
}

#[test]
fn commands_and_doors_have_the_names_that_they_have_everywhere() {
    // The answer unsure is sent as a verdict, and is counted apart.
    let names = COMMANDS.iter().flat_map(|row| if row.name == "verdict" { vec!["verdict", "unsure"] } else { vec![row.name] });
    assert_eq!(names.collect::<Vec<_>>(), Command::CODES);
    assert_eq!(figures::DOORS, [door::HTTP, door::MQTT, door::COAP].map(|door| door.0));
    let families: BTreeMap<_, _> = families(&shown()).into_iter().collect();
    assert_eq!(families["hallsweep_commands"].labels["command"], [&Command::CODES[..], &[OTHER]].concat());
}

#[test]
fn the_documentation_shows_the_figures_as_they_are() {
    let mut table = String::from("| name | type | labels | what it says |\n|---|---|---|---|\n");
    for (name, Family { kind, help, labels, .. }) in families(&shown()) {
        let suffix = match kind.as_str() {
            "counter" => "_total",
            "info" => "_info",
            _ => "",
        };
        // Of labels whose values differ between machines, only the name is documented. The same applies to the bounds
        // of buckets.
        let open = ["area", "le", "robot", "version"];
        let values = |values: &[String]| values.iter().map(|value| format!("`{value}`")).collect::<Vec<_>>().join(" ");
        let said = |(label, known): (&String, &Vec<String>)| {
            if open.contains(&label.as_str()) { format!("`{label}`") } else { format!("`{label}`: {}", values(known)) }
        };
        let labels: Vec<String> = labels.iter().filter(|(label, _)| *label != "le").map(said).collect();
        writeln!(table, "| `{name}{suffix}` | {kind} | {} | {help} |", labels.join("; ")).unwrap();
    }
    documented::shows("metrics.md", "the table of figures", &table);
}

fn named(query: &str) -> impl Iterator<Item = &str> {
    let is_of_name = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    query.split(move |letter| !is_of_name(letter)).filter(|word| word.starts_with("hallsweep_"))
}

fn queries(of: &serde_json::Value) -> Vec<String> {
    match of {
        serde_json::Value::Object(fields) => {
            let own =
                ["expr", "query", "definition"].into_iter().filter_map(|field| Some(fields.get(field)?.as_str()?.to_owned()));
            own.chain(fields.values().flat_map(queries)).collect()
        }
        serde_json::Value::Array(all) => all.iter().flat_map(queries).collect(),
        serde_json::Value::Null | serde_json::Value::Bool(_) | serde_json::Value::Number(_) | serde_json::Value::String(_) => {
            Vec::new()
        }
    }
}

#[test]
fn the_dashboard_asks_for_what_is_there_and_for_all_of_it() {
    let dashboard: serde_json::Value = serde_json::from_str(include_str!("../../../config/grafana/hallsweep.json")).unwrap();
    let queries = queries(&dashboard);
    let asked: BTreeSet<&str> = queries.iter().flat_map(|query| named(query)).collect();
    let families = families(&shown());
    let shown: BTreeSet<&str> = families.iter().flat_map(|(_, family)| &family.samples).map(String::as_str).collect();
    assert_eq!(asked.difference(&shown).collect::<Vec<_>>(), Vec::<&&str>::new(), "nobody shows them");
    let left_out = |(_, family): &&(String, Family)| !family.samples.iter().any(|sample| asked.contains(sample.as_str()));
    let left_out: Vec<&str> = families.iter().filter(left_out).map(|(name, _)| name.as_str()).collect();
    assert_eq!(left_out, Vec::<&str>::new(), "the dashboard shows nothing of them");
}

#[test]
fn every_panel_of_the_dashboard_has_a_title_a_place_and_the_data_source_that_is_chosen() {
    let dashboard: serde_json::Value = serde_json::from_str(include_str!("../../../config/grafana/hallsweep.json")).unwrap();
    let panels = dashboard["panels"].as_array().unwrap();
    let mut ids = BTreeSet::new();
    for panel in panels.iter().filter(|panel| panel["type"] != "row") {
        assert!(ids.insert(panel["id"].as_u64().unwrap()), "{panel}");
        assert!(panel["title"].as_str().is_some_and(|title| !title.is_empty()), "{panel}");
        assert_eq!(panel["datasource"]["uid"], "${datasource}", "{panel}");
        let [x, w] = ["x", "w"].map(|side| panel["gridPos"][side].as_u64().unwrap());
        assert!(w > 0 && x + w <= 24, "{panel}");
        assert!(!panel["targets"].as_array().unwrap().is_empty(), "{panel}");
    }
}

#[test]
fn the_name_of_an_area_is_written_as_prometheus_reads_it() {
    let mut snapshot = searching();
    let corners = [Cell::HOME, Cell::new(1, 1)].into();
    snapshot.venue.areas = [Area { name: r#"a"b\c"#.into(), probability: 0.5, corners }].into();
    let text = written(&Figures::default(), &snapshot).unwrap();
    assert!(text.contains(r#"hallsweep_coverage_cells{area="a\"b\\c",searched="driven"} "#), "{text}");
}
