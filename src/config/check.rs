//! Turns written settings into usable ones, or says which is wrong. Whether a hall file can be opened shows when it is opened.

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use figment::value::{Num, Value};
use tracing_subscriber::EnvFilter;

use super::bind::{At, Bind};
use super::error::SettingsError;
use super::layers::Layers;
use super::mqtt;
use super::raw::{self, Raw};
use super::{HttpSettings, OldClients, RobotSettings, Settings, Speed, TlsFiles, folder};
use hallsweep_core::command::TemperatureReport;
use hallsweep_core::explore::Strategy;
use hallsweep_core::settings::Settings as CoreSettings;
use hallsweep_core::units::Celsius;

/// Rates are probabilities.
const RATE: RangeInclusive<f64> = 0.0..=1.0;

/// A sonar that errs by more than a metre is no sonar.
const SONAR_NOISE_CM: RangeInclusive<f64> = 0.0..=100.0;

/// A wider gap than this would keep a hall hot that is as cold as winter.
const HYSTERESIS: RangeInclusive<f64> = 0.0..=50.0;

/// A sensor that reports more seldom than once an hour does not say how hot it is now.
const SENSOR_SILENCE_S: RangeInclusive<f64> = 1.0..=3600.0;

/// As many sensors as the thermometer listens to, beside the operator and the robot.
const SENSORS: usize = 60;

/// Checks every setting.
pub(super) fn checked(layers: &Layers) -> Result<Settings, SettingsError> {
    let raw: Raw = layers.figment().extract().map_err(|error| wrong_type(layers, &error))?;
    Ok(Settings {
        hall: hall(layers, &raw.hall)?,
        hall_origin: layers.origin("hall.file"),
        http: http(layers, &raw.http)?,
        coap: coap(layers, &raw.coap)?,
        mqtt: mqtt::mqtt(layers, &raw.mqtt)?,
        old_clients: OldClients { manual_driving: raw.old_clients.manual_driving },
        store: store(layers, &raw.store)?,
        robot: robot(layers, &raw.robot)?,
        strategy: strategy(layers, &raw.mission)?,
        core: core(layers, &raw)?,
        sensors: sensors(layers, &raw.temperature)?,
        sensor_silence: sensor_silence(layers, &raw.temperature)?,
        log: log(layers, &raw.log)?,
    })
}

/// What to say of a value that is not of the type of its setting: what it is instead. The advice says what is wanted.
fn wrong_type(layers: &Layers, error: &figment::Error) -> SettingsError {
    let key = error.path.join(".");
    let problem = match layers.figment().find_value(&key) {
        Ok(Value::String(..) | Value::Char(..)) => "it is a text",
        Ok(Value::Bool(..)) => "it is a yes or no",
        // The seed is the only whole number among the settings.
        Ok(Value::Num(_, Num::F32(_) | Num::F64(_))) if key == "robot.seed" => "it is not a whole number",
        Ok(Value::Num(..)) if key == "robot.seed" => "it is out of range",
        Ok(Value::Num(_, Num::I128(_) | Num::U128(_))) => "it is out of range",
        Ok(Value::Num(..)) => "it is a number",
        Ok(Value::Array(..)) => "it is a list",
        Ok(Value::Dict(..)) => "it is a table",
        Ok(Value::Empty(..)) | Err(_) => "it is missing",
    };
    layers.wrong(&key, problem)
}

fn hall(layers: &Layers, raw: &raw::Hall) -> Result<String, SettingsError> {
    if raw.file.trim().is_empty() {
        return Err(layers.wrong("hall.file", "it names no hall"));
    }
    Ok(raw.file.clone())
}

fn http(layers: &Layers, raw: &raw::Http) -> Result<HttpSettings, SettingsError> {
    let bind = bind(layers, "http.bind", &raw.bind)?;
    let hosts = match &raw.hosts {
        raw::Hosts::Several(names) => names.clone(),
        raw::Hosts::Single(name) => vec![name.clone()],
    };
    if let Some(wrong) = hosts.iter().find(|name| !is_host(name)) {
        return Err(layers.wrong("http.hosts", format!("{wrong:?} is not the name of a host")));
    }
    let asks_for_keys = raw.require_token || !bind.at.is_local();
    Ok(HttpSettings { bind, asks_for_keys, hosts, tls: tls(layers, raw)? })
}

/// Where a door listens.
pub(super) fn bind(layers: &Layers, key: &str, written: &str) -> Result<Bind, SettingsError> {
    let at = At::read(written).ok_or_else(|| layers.wrong(key, "it is not an address with a port"))?;
    Ok(Bind { at, is_chosen: layers.is_chosen(key) })
}

/// There are no keys for CoAP: beyond loopback it shows everything to whoever reaches it, and that must be meant.
fn coap(layers: &Layers, raw: &raw::Coap) -> Result<Option<Bind>, SettingsError> {
    if raw.bind == "none" {
        return Ok(None);
    }
    let bind = bind(layers, "coap.bind", &raw.bind)?;
    if raw.open_to_others || bind.at.is_local() {
        return Ok(Some(bind));
    }
    let problem = "everybody who reaches this address could read everything there, unencrypted and without a key";
    let advice = "write an address of this machine alone, as localhost:5683, or none for no such door; or set \
                  coap.open_to_others = true if that is meant";
    Err(layers.wrong_with_advice("coap.bind", problem, advice))
}

/// A name as it stands in a link, before the port.
fn is_host(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'-' | b'_'))
}

fn tls(layers: &Layers, raw: &raw::Http) -> Result<Option<TlsFiles>, SettingsError> {
    match (raw.tls_certificate.as_str(), raw.tls_key.as_str()) {
        ("", "") => Ok(None),
        (_, "") => Err(layers.wrong("http.tls_key", "http.tls_certificate is set, and is of no use without its key")),
        ("", _) => Err(layers.wrong("http.tls_certificate", "http.tls_key is set, and is of no use without its certificate")),
        (certificate, key) => Ok(Some(TlsFiles { certificate: certificate.into(), key: key.into() })),
    }
}

fn store(layers: &Layers, raw: &raw::Store) -> Result<Option<PathBuf>, SettingsError> {
    match raw.folder.as_str() {
        "none" => Ok(None),
        "" => {
            let usual = folder::usual(|name| std::env::var_os(name));
            let unknown = || layers.wrong("store.folder", "this user has no home, where it would be");
            usual.map(Some).ok_or_else(unknown)
        }
        named => Ok(Some(named.into())),
    }
}

fn robot(layers: &Layers, raw: &raw::Robot) -> Result<RobotSettings, SettingsError> {
    Ok(RobotSettings {
        speed: speed(layers, &raw.speed)?,
        seed: raw.seed,
        unknown_rate: within(layers, "robot.unknown_rate", raw.unknown_rate, &RATE)?,
        photo_failure_rate: within(layers, "robot.photo_failure_rate", raw.photo_failure_rate, &RATE)?,
        sonar_noise_cm: within(layers, "robot.sonar_noise_cm", raw.sonar_noise_cm, &SONAR_NOISE_CM)?,
    })
}

fn speed(layers: &Layers, raw: &raw::Speed) -> Result<Speed, SettingsError> {
    match raw {
        raw::Speed::Factor(factor) => {
            within(layers, "robot.speed", *factor, &(Speed::SLOWEST..=Speed::FASTEST)).map(Speed::Times)
        }
        raw::Speed::Word(word) if word == "max" => Ok(Speed::Max),
        raw::Speed::Word(_) => Err(layers.wrong("robot.speed", "this word is no speed")),
    }
}

fn strategy(layers: &Layers, raw: &raw::Mission) -> Result<Strategy, SettingsError> {
    Strategy::named(&raw.strategy).ok_or_else(|| layers.wrong("mission.strategy", "there is no such strategy"))
}

fn core(layers: &Layers, raw: &Raw) -> Result<CoreSettings, SettingsError> {
    let threshold = Celsius::new(raw.temperature.threshold_celsius)
        .ok_or_else(|| layers.wrong("temperature.threshold_celsius", "no hall has this temperature"))?;
    let hysteresis = within(layers, "temperature.hysteresis_celsius", raw.temperature.hysteresis_celsius, &HYSTERESIS)?;
    let (inspect_everything, wall_lines) = (raw.mission.inspect_everything, raw.mission.wall_lines);
    Ok(CoreSettings { threshold, hysteresis, inspect_everything, wall_lines })
}

fn sensors(layers: &Layers, raw: &raw::Temperature) -> Result<Vec<Arc<str>>, SettingsError> {
    let mut sensors = Vec::new();
    for name in raw.sensor.split(',').map(str::trim).filter(|_| !raw.sensor.trim().is_empty()) {
        let sensor = TemperatureReport::sensor_name(name)
            .ok_or_else(|| layers.wrong("temperature.sensor", format!("{name:?} is no sensor's name")))?;
        if sensors.contains(&sensor) {
            return Err(layers.wrong("temperature.sensor", format!("{name:?} is there twice")));
        }
        sensors.push(sensor);
    }
    if sensors.len() > SENSORS {
        return Err(layers.wrong("temperature.sensor", format!("there are {} names", sensors.len())));
    }
    Ok(sensors)
}

fn sensor_silence(layers: &Layers, raw: &raw::Temperature) -> Result<Duration, SettingsError> {
    let seconds = within(layers, "temperature.sensor_silence_s", raw.sensor_silence_s, &SENSOR_SILENCE_S)?;
    Ok(Duration::from_secs_f64(seconds))
}

fn log(layers: &Layers, raw: &raw::Log) -> Result<String, SettingsError> {
    match EnvFilter::builder().parse(&raw.filter) {
        Ok(_) => Ok(raw.filter.clone()),
        Err(error) => Err(layers.wrong("log.filter", error.to_string())),
    }
}

fn within(layers: &Layers, key: &str, value: f64, range: &RangeInclusive<f64>) -> Result<f64, SettingsError> {
    let problem = if value.is_nan() { "it stands for no number" } else { "it is out of range" };
    if range.contains(&value) { Ok(value) } else { Err(layers.wrong(key, problem)) }
}

#[cfg(test)]
#[path = "check_tests.rs"]
mod tests;
