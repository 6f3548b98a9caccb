//! The files for deployment: compose.yaml is started, and the manifests are valid for Kubernetes.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::client::Client;
use crate::engine::{ContainerEngine, engine, left_out, text, until, unused};

const CLIENTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/clients");

fn of_project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn python(arguments: &[&str]) -> Command {
    let mut command = Command::new("python3");
    command.args(arguments).env("PYTHONPATH", format!("{CLIENTS}/python_modules"));
    command
}

/// Whether a Python package is installed as `.ci/run` installs it. A missing package is reported, or fails where it
/// is required.
fn is_here(package: &str) -> bool {
    let here = python(&["-c", &format!("import {package}")]).output().is_ok_and(|output| output.status.success());
    if !here {
        left_out(&format!("{package}, as docs/testing.md installs it"));
    }
    here
}

#[test]
fn what_kubernetes_is_told_is_what_it_knows_and_restricted() {
    let manifest = of_project("config/kubernetes.yaml");
    let told = std::fs::read_to_string(&manifest).expect("text");
    for restricted in [
        "runAsNonRoot: true",
        "type: RuntimeDefault",
        "allowPrivilegeEscalation: false",
        "readOnlyRootFilesystem: true",
        r#"drop: ["ALL"]"#,
        "replicas: 1",
        "type: Recreate",
    ] {
        assert!(told.contains(restricted), "{restricted}");
    }
    if !is_here("kubernetes_validate") {
        return;
    }
    let script = format!("{CLIENTS}/manifests.py");
    let good = python(&[&script]).arg(&manifest).output().expect("python is there");
    assert!(good.status.success() && text(&good.stdout).contains("Deployment hallsweep"), "{}", text(&good.stderr));
    let wrong = std::env::temp_dir().join(unused("wrong.yaml"));
    std::fs::write(&wrong, told.replace("fsGroup", "fsGruop")).expect("the folder is ours");
    let bad = python(&[&script]).arg(&wrong).output().expect("python is there");
    assert!(!bad.status.success() && text(&bad.stderr).contains("fsGruop"), "a mistake is found: {}", text(&bad.stderr));
    std::fs::remove_file(wrong).expect("the folder is ours");
}

/// Compose project, which is taken down with this value.
struct Composed<'a> {
    engine: &'a ContainerEngine,
    name: String,
    port: u16,
}

impl Composed<'_> {
    fn ask(&self, arguments: &[&str]) -> Output {
        let mut command = if self.engine.is_docker() {
            let mut docker = Command::new("docker");
            docker.arg("compose");
            docker
        } else {
            python(&["-m", "podman_compose"])
        };
        let file = of_project("compose.yaml");
        command.arg("-f").arg(file).args(["-p", &self.name]).args(arguments);
        command
            .env("HALLSWEEP_IMAGE", &self.engine.image)
            .env("HALLSWEEP_PORT", self.port.to_string())
            .env("TZ", "Asia/Kathmandu")
            .output()
            .expect("compose can be run")
    }
}

impl Drop for Composed<'_> {
    fn drop(&mut self) {
        self.ask(&["down", "--volumes"]);
    }
}

#[test]
fn compose_brings_it_up_hardened_and_keeps_its_volume() {
    let Some(engine) = engine() else { return };
    if !engine.is_docker() && !is_here("podman_compose") {
        return;
    }
    let port = std::net::TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).expect("a free port").port();
    let composed = Composed { engine: &engine, name: unused("compose"), port };
    let up = || {
        let up = composed.ask(&["up", "--detach", "--no-build"]);
        assert!(up.status.success(), "{}{}", text(&up.stdout), text(&up.stderr));
    };
    up();
    let token = || {
        until("there is a key", || {
            let shown = composed.ask(&["exec", "-T", "hallsweep", "hallsweep", "token"]);
            let shown = text(&shown.stdout);
            shown.lines().find_map(|line| Some(line.trim().strip_prefix("token ")?.trim().to_owned()))
        })
    };
    let first = token();
    let client = Client::at(([127, 0, 0, 1], port).into(), &first);
    assert_eq!(client.look("/healthz", Some("hallsweep:8080")).0, 200, "as Prometheus calls it");
    assert!(client.state()["mission"].is_object());
    let logs = composed.ask(&["logs", "hallsweep"]);
    let logs = text(&logs.stdout) + &text(&logs.stderr);
    assert!(logs.contains("http://localhost:8080/sign-in?token=") && logs.contains("+05:45"), "{logs}");
    let id = text(&composed.ask(&["ps", "--quiet"]).stdout);
    let inspected = engine.run(&["inspect", id.lines().next().expect("it runs")]);
    let inspected: serde_json::Value = serde_json::from_str(&inspected).expect("JSON");
    let host = &inspected[0]["HostConfig"];
    assert_eq!((&host["ReadonlyRootfs"], host["Memory"].as_u64()), (&true.into(), Some(256 << 20)), "{host}");
    assert!(host["SecurityOpt"].to_string().contains("no-new-privileges"), "{host}");
    assert!(host["CapDrop"].as_array().is_some_and(|dropped| !dropped.is_empty()), "{host}");
    let with = |more: &[&str]| text(&composed.ask(&[more, &["config"]].concat()).stdout);
    let mosquitto = of_project("config/compose/mosquitto.yaml");
    let with_mosquitto = with(&["-f", mosquitto.to_str().expect("text")]);
    assert!(with_mosquitto.contains("mqtt://mosquitto:1883") && with_mosquitto.contains("eclipse-mosquitto"), "{with_mosquitto}");
    let with_figures = with(&["--profile", "figures"]);
    assert!(with_figures.contains("prometheus.yml") && with_figures.contains("grafana"), "{with_figures}");
    assert!(composed.ask(&["down"]).status.success());
    up();
    assert_eq!(token(), first);
}
