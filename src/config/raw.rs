//! The settings as they are written, before they are checked: the sections and keys of `config/default.toml`.

use serde::Deserialize;

#[derive(Deserialize)]
pub(super) struct Raw {
    pub(super) hall: Hall,
    pub(super) http: Http,
    pub(super) coap: Coap,
    pub(super) mqtt: Mqtt,
    pub(super) old_clients: OldClients,
    pub(super) store: Store,
    pub(super) robot: Robot,
    pub(super) mission: Mission,
    pub(super) temperature: Temperature,
    pub(super) log: Log,
}

#[derive(Debug, Deserialize)]
pub(super) struct Hall {
    pub(super) file: String,
}

#[derive(Debug, Deserialize)]
pub(super) struct Http {
    pub(super) bind: String,
    pub(super) require_token: bool,
    pub(super) hosts: Hosts,
    pub(super) tls_certificate: String,
    pub(super) tls_key: String,
}

/// Names, or a single one.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Hosts {
    Several(Vec<String>),
    Single(String),
}

#[derive(Debug, Deserialize)]
pub(super) struct Coap {
    pub(super) bind: String,
    pub(super) open_to_others: bool,
}

#[derive(Deserialize)]
pub(super) struct Mqtt {
    pub(super) bind: String,
    pub(super) require_password: bool,
    pub(super) broker: String,
    pub(super) name: String,
    pub(super) password: String,
    pub(super) certificates: String,
    pub(super) prefix: String,
    pub(super) id: String,
    pub(super) old_prefix: String,
    pub(super) home_assistant: bool,
}

#[derive(Debug, Deserialize)]
pub(super) struct OldClients {
    pub(super) manual_driving: bool,
}

#[derive(Debug, Deserialize)]
pub(super) struct Store {
    pub(super) folder: String,
}

#[derive(Debug, Deserialize)]
pub(super) struct Robot {
    pub(super) speed: Speed,
    pub(super) seed: u64,
    pub(super) unknown_rate: f64,
    pub(super) photo_failure_rate: f64,
    pub(super) sonar_noise_cm: f64,
}

/// A factor, or a word.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Speed {
    Factor(f64),
    Word(String),
}

#[derive(Debug, Deserialize)]
pub(super) struct Mission {
    pub(super) strategy: String,
    pub(super) inspect_everything: bool,
    pub(super) wall_lines: bool,
}

#[derive(Debug, Deserialize)]
pub(super) struct Temperature {
    pub(super) threshold_celsius: f64,
    pub(super) hysteresis_celsius: f64,
    pub(super) sensor: String,
    pub(super) sensor_silence_s: f64,
}

#[derive(Debug, Deserialize)]
pub(super) struct Log {
    pub(super) filter: String,
}
