//! `/metrics` of the real program: the values agree with the API, Prometheus' own parsers accept the text, open
//! connections are counted, and no outside input creates a new series.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpStream, UdpSocket};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use crate::http_attacks::{connected, status};
use crate::kill::Folder;
use crate::program::{Deadline, PATIENCE, Program, hallsweep};
use crate::third_party::{folder, left_out, patiently, python, runs};

/// Interval between two checks of an awaited value.
const GLANCE: Duration = Duration::from_millis(5);

/// CoAP messages that start and end an observation of the robot.
const OBSERVE: &[u8] = b"\x41\x01\x00\x01T\x60\x55robot";
const FORGET: &[u8] = b"\x41\x01\x00\x02T\x61\x01\x55robot";

/// CONNECT of an MQTT client named `hall`.
const CONNECT: &[u8] = b"\x10\x10\x00\x04MQTT\x04\x02\x00\x3c\x00\x04hall";

fn text(program: &Program) -> String {
    in_format(program, "text/plain")
}

fn in_format(program: &Program, media_type: &str) -> String {
    let answer = program.read("/metrics", &[("Accept", media_type)]);
    assert_eq!(answer.status, 200, "{}", answer.text());
    assert!(answer.header("content-type").starts_with(media_type), "{media_type}");
    answer.text()
}

/// Value of each series, by a name such as `hallsweep_steps_total`.
fn figures(text: &str) -> BTreeMap<String, f64> {
    let series = text.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.rsplit_once(' '));
    series.map(|(series, value)| (series.to_owned(), value.parse().expect("a number"))).collect()
}

fn series(program: &Program) -> BTreeSet<String> {
    figures(&text(program)).into_keys().collect()
}

/// Waits until a series has this value.
fn until(program: &Program, series: &str, wanted: f64) {
    let deadline = Deadline::within(PATIENCE);
    loop {
        let is = figures(&text(program))[series];
        if is == wanted {
            return;
        }
        assert!(!deadline.has_passed(), "{series} is {is} and never came to be {wanted}");
        sleep(GLANCE);
    }
}

/// Searches the whole hall, calls every piece safe, with some refusals and two STOPs, and puts the mission away.
fn mission(program: &Program) {
    program.command("start").accepted();
    let is_asked = |state: &Value| state["luggage"].as_array().expect("a list").iter().any(|piece| piece["verdict"] == "pending");
    loop {
        let next = |state: &Value| is_asked(state) || state["mission"]["phase"] == "explored";
        if program.until("a verdict is asked for, or the end", next)["mission"]["phase"] == "explored" {
            break;
        }
        program.verdict(program.until_asked(), "safe").accepted();
    }
    program.command("retrieve").problem(409);
    program.verdict(999, "danger").problem(404);
    program.command("stop").accepted();
    program.command("stop").accepted();
    program.command("reset").accepted();
}

/// All recorded events of a mission.
fn events(program: &Program, mission: u64) -> Vec<Value> {
    let mut events = Vec::new();
    let mut next = Some(format!("/api/v1/missions/{mission}/events?limit=1000"));
    while let Some(path) = next {
        let page = program.read(&path, &[]).json();
        events.extend(page["events"].as_array().expect("a list").iter().cloned());
        next = page["next"].as_str().map(str::to_owned);
    }
    events
}

/// Number of times that the robot entered another cell.
fn steps(events: &[Value]) -> usize {
    let cells = events.iter().filter(|event| event["kind"] == "pose");
    let cells: Vec<(i64, i64)> =
        cells.map(|pose| ["x", "y"].map(|of| pose[of].as_i64().expect("a cell"))).map(Into::into).collect();
    cells.windows(2).filter(|pair| pair[0] != pair[1]).count() + usize::from(cells.first() != Some(&(0, 0)))
}

#[test]
fn the_figures_are_what_the_interface_says() {
    let program = Program::serve("airport", "max");
    mission(&program);
    let figures = figures(&text(&program));
    let at = |series: &str| figures[&format!("hallsweep_{series}")];
    let sum = |family: &str| {
        let of_it = figures.iter().filter(|(series, _)| series.starts_with(&format!("hallsweep_{family}{{")));
        of_it.map(|(_, value)| value).sum::<f64>()
    };
    let (state, record, events) = (program.json("state"), program.json("missions/1"), events(&program, 1));
    let many = |kind: &str, is_so: &dyn Fn(&Value) -> bool| {
        events.iter().filter(|event| event["kind"] == kind && is_so(event)).count() as f64
    };
    assert_eq!((at("missions_begun_total"), at("missions_ended_total{phase=\"explored\"}")), (1.0, 1.0));
    assert_eq!((&record["phase"], sum("missions_ended_total")), (&"explored".into(), 1.0));
    assert_eq!(at("phase{phase=\"idle\"}"), 1.0);
    assert_eq!((sum("phase"), &state["mission"]["phase"]), (1.0, &"idle".into()));
    assert_eq!(at("steps_total"), steps(&events) as f64);
    assert_eq!(Some(at("stops_total")), state["mission"]["epoch"].as_f64());
    assert_eq!((Some(at("luggage_total")), at("photos_total")), (record["pieces"].as_f64(), many("luggage", &|_| true)));
    assert_eq!(Some(at("verdicts_total{verdict=\"safe\"}")), record["pieces"].as_f64());
    assert!(at("luggage_total") > 1.0 && at("steps_total") > 100.0, "{figures:#?}");
    let is_accepted = |event: &Value| event["refused"].is_null();
    assert_eq!(sum("refusals_total"), many("command", &|event| !is_accepted(event)));
    assert_eq!((at("refusals_total{code=\"unknownLuggage\"}"), sum("refusals_total")), (1.0, 2.0));
    assert_eq!(sum("commands_total"), many("command", &|_| true));
    for (name, words) in [("start", "START"), ("stop", "STOP"), ("reset", "RESET")] {
        let counted = at(&format!("commands_total{{command=\"{name}\",outcome=\"accepted\"}}"));
        assert_eq!(counted, many("command", &|event| event["command"] == words && is_accepted(event)), "{name}");
    }
    assert_eq!((at("store_failing"), at("store_losses_total"), at("robot_reached{robot=\"discovery\"}")), (0.0, 0.0, 1.0));
    let last = events.last().expect("there is a last one")["seq"].as_f64();
    assert!(Some(at("journal_last_entry")) >= last, "{last:?}");
    assert_eq!(at("command_seconds_count"), sum("commands_total"), "each was answered");
    assert!(at("record_seconds_count") > at("steps_total") && at("stop_seconds_count") >= 1.0, "{figures:#?}");
}

/// Samples that Prometheus' own parser finds in OpenMetrics text.
fn parsed(text: &str) -> BTreeMap<String, f64> {
    let mut parser = patiently(python().arg(folder().join("openmetrics.py")));
    let mut parser = parser.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it was there just now");
    parser.stdin.take().expect("it is a pipe").write_all(text.as_bytes()).expect("it reads to the end");
    let output = parser.wait_with_output().expect("it ends");
    assert!(output.status.success(), "Prometheus' parser does not take\n{text}");
    let samples: Vec<(String, BTreeMap<String, String>, f64)> =
        serde_json::from_slice(&output.stdout).expect("a list of samples");
    let series = |(name, labels, value): (String, BTreeMap<String, String>, f64)| {
        let labels: Vec<String> = labels.into_iter().map(|(label, value)| format!("{label}=\"{value}\"")).collect();
        (if labels.is_empty() { name } else { format!("{name}{{{}}}", labels.join(",")) }, value)
    };
    samples.into_iter().map(series).collect()
}

#[test]
fn the_parsers_of_prometheus_read_every_figure() {
    let is_here = runs(python().args(["-c", "import prometheus_client"]));
    let missing =
        "prometheus-client (python3 -m pip install --target tests/clients/python_modules -r tests/clients/requirements.txt)";
    if !(is_here || left_out("HTTP", missing)) {
        return;
    }
    let program = Program::serve("airport", "max");
    for _ in 0..2 {
        let text = in_format(&program, "application/openmetrics-text");
        assert_eq!(parsed(&text), figures(&text));
        mission(&program);
    }
}

/// Both formats have the same series, and `promtool` accepts the Prometheus format, which is the answer to `*/*`.
#[test]
fn promtool_finds_no_fault_in_the_text_format() {
    let program = Program::serve("airport", "max");
    mission(&program);
    let open_metrics = figures(&in_format(&program, "application/openmetrics-text")).into_keys();
    assert!(open_metrics.eq(series(&program)));
    assert!(program.read("/metrics", &[("Accept", "*/*")]).text().contains("# TYPE hallsweep_steps_total counter\n"));
    if !(runs(Command::new("promtool").arg("--version")) || left_out("HTTP", "promtool (apt-get install prometheus)")) {
        return;
    }
    let mut promtool = patiently(Command::new("promtool").args(["check", "metrics"]));
    let mut promtool = promtool.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it is here");
    promtool.stdin.take().expect("it is a pipe").write_all(text(&program).as_bytes()).expect("it reads to the end");
    let output = promtool.wait_with_output().expect("it ends");
    let said = [output.stdout, output.stderr].concat();
    assert!(output.status.success() && said.is_empty(), "{}", String::from_utf8_lossy(&said));
}

#[test]
fn connections_are_counted_at_every_door_while_they_are_open() {
    let program = Program::serve("empty-8x8", "max");
    let [http, mqtt, coap] = ["http", "mqtt", "coap"].map(|door| format!("hallsweep_connections{{door=\"{door}\"}}"));
    // The client that reads `/metrics` has a connection too, which stays open between two reads.
    until(&program, &http, 1.0);
    let mut clients: Vec<TcpStream> =
        (0..3).map(|_| connected(&program, "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")).collect();
    assert!(clients.iter_mut().all(|client| status(client) == "200"));
    until(&program, &http, 4.0);
    clients.truncate(1);
    until(&program, &http, 2.0);

    let mut client = TcpStream::connect(program.mqtt()).expect("the door is open");
    client.write_all(CONNECT).expect("it is heard");
    client.read_exact(&mut [0; 4]).expect("it is greeted");
    until(&program, &mqtt, 1.0);
    drop(client);
    until(&program, &mqtt, 0.0);

    let observer = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    observer.connect(program.coap()).expect("the door is open");
    for (asks, observations) in [(OBSERVE, 1.0), (OBSERVE, 1.0), (FORGET, 0.0)] {
        observer.send(asks).expect("it is heard");
        until(&program, &coap, observations);
    }
}

#[test]
fn nothing_that_comes_from_outside_makes_a_series() {
    let program = Program::serve("empty-8x8", "max");
    let before = series(&program);
    for n in 0..50 {
        let odd = format!("odd{n}\"}}%0A");
        for request in [
            format!("BREW{n} /coffee HTTP/1.1\r\nHost: localhost\r\n\r\n"),
            format!("GET /{odd} HTTP/1.1\r\nHost: {odd}\r\nUser-Agent: {odd}\r\nAuthorization: Bearer {odd}\r\n\r\n"),
            format!(
                "POST /api/v1/commands/{odd} HTTP/1.1\r\nHost: localhost\r\nIdempotency-Key: {odd}\r\nContent-Length: 0\r\n\r\n"
            ),
        ] {
            assert_ne!(status(&mut connected(&program, &request)), "200");
        }
        let name = serde_json::json!({ "strategy": odd, "celsius": 20, "sensor": odd, "move": odd }).to_string();
        for path in ["/api/v1/strategy", "/api/v1/temperature"] {
            program.put(path, &name);
        }
        program.post("/api/v1/commands/move", &name);
        let mut client = TcpStream::connect(program.mqtt()).expect("the door is open");
        client
            .write_all(&[&b"\x10\x12\x00\x04MQTT\x04\x02\x00\x3c\x00\x06odd"[..], format!("{n:03}").as_bytes()].concat())
            .expect("it is heard");
        client.read_exact(&mut [0; 4]).expect("it is greeted");
        client.write_all(&[&b"\x30\x0a\x00\x06odd"[..], format!("{n:03}ab").as_bytes()].concat()).expect("it is heard");
        let stranger = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
        stranger
            .send_to(&[&b"\x40\x02\x00\x01\xb6odd"[..], format!("{n:03}").as_bytes()].concat(), program.coap())
            .expect("it is sent");
    }
    program.command("start").accepted();
    program.until_phase("explored");
    let other = figures(&text(&program))["hallsweep_commands_total{command=\"other\",outcome=\"refused\"}"];
    assert!(other > 0.0, "some of that was on record as what no command is");
    // The first temperature reading may arrive during the test.
    let new: Vec<String> =
        series(&program).difference(&before).filter(|series| *series != "hallsweep_temperature_celsius").cloned().collect();
    assert_eq!(new, Vec::<String>::new());
}

#[test]
fn counters_begin_at_nothing_in_each_run_although_the_journal_goes_on() {
    let folder = Folder::new("metrics");
    let serve = || {
        let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "max", "--data", folder.text()];
        Program::started(hallsweep(&arguments).env_remove("HALLSWEEP__STORE__FOLDER"))
    };
    let program = serve();
    program.command("start").accepted();
    program.until_phase("explored");
    program.command("stop").accepted();
    let at = |program: &Program, series: &str| figures(&text(program))[series];
    let kept = at(&program, "hallsweep_journal_last_entry");
    assert_eq!(["missions_begun", "stops"].map(|name| at(&program, &format!("hallsweep_{name}_total"))), [1.0, 1.0]);
    drop(program);
    let program = serve();
    assert_eq!(program.json("state")["mission"]["phase"], "explored");
    assert!(at(&program, "hallsweep_journal_last_entry") >= kept);
    for name in ["missions_begun", "stops", "steps"] {
        assert_eq!(at(&program, &format!("hallsweep_{name}_total")), 0.0, "{name}");
    }
}
