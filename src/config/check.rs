//! Turns written settings into usable settings, or reports the wrong setting. It does not open the hall file, so a
//! fault of this file is found later.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use serde::Deserialize;
use tracing_subscriber::EnvFilter;

use super::bind::Bind;
use super::error::SettingsError;
use super::key::{KEYS, ROBOT, SettingKind};
use super::layers::{AllGiven, Layers};
use super::reading::{NumberOrWord, bind, count, number, one_of, read};
use super::robot_address::RobotKind;
use super::without_effect::without_effect;
use super::{Exercise, HallSettings, HttpSettings, OldClients, PairMishaps, Settings, TlsFiles, folder};
use super::{halls, mqtt, robots};
use hallsweep_core::command::{Strategy, TemperatureReport};
use hallsweep_core::hall::HallId;
use hallsweep_core::not_fetched::Fetcher;
use hallsweep_core::search::Objective;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::settings::{AfterDanger, HotRule, Rules, SafeBy, Settings as CoreSettings};
use hallsweep_core::units::Celsius;

/// Maximum number of required temperature sensors. The core remembers 64 sources of temperatures, and the
/// operator and the robots can be such sources too.
const SENSORS: usize = 60;

#[derive(Deserialize)]
#[serde(untagged)]
enum Texts {
    Several(Vec<String>),
    Single(String),
}

pub(super) fn checked(all: &AllGiven) -> Result<Settings, SettingsError> {
    let layers = &all.of_the_program();
    check_types(layers)?;
    let store = store(layers)?;
    let (hall, further_halls) = halls::halls(all, layers, store.as_ref())?;
    let mqtt = mqtt::mqtt(layers)?;
    if further_halls.iter().any(|hall| hall.name.name() == mqtt.id) {
        let problem = "a further hall has this name, and a name stands for one hall at Home Assistant";
        return Err(layers.wrong_with_advice("mqtt.id", problem, "give the hall another name, or set another mqtt.id"));
    }
    Ok(Settings {
        hall,
        further_halls,
        http: http(layers)?,
        coap: coap(layers)?,
        mqtt,
        old_clients: OldClients { manual_driving: read(layers, "old_clients.manual_driving")? },
        store,
        log: log(layers)?,
    })
}

/// The settings of a hall whose data is stored in `folder`.
pub(super) fn hall(layers: &Layers, name: HallId, folder: Option<PathBuf>) -> Result<HallSettings, SettingsError> {
    Ok(HallSettings {
        name,
        group: halls::group(layers)?,
        file: hall_file(layers)?,
        start: hall_start(layers)?,
        exercise: exercise(layers)?,
        origin: layers.origin("hall.file"),
        is_chosen: layers.is_chosen("hall.file"),
        evacuation_m: number(layers, "console.evacuation_m")?,
        folder,
        keep_days: count(layers, "store.keep_days")?,
        robot: robots::robot(layers, ROBOT)?,
        further_robots: robots::further(layers)?,
        pair: PairMishaps { slips: count(layers, "pair.slips")?, unrecognised: count(layers, "pair.unrecognised")? },
        strategy: strategy(layers)?,
        core: core(layers)?,
        sensors: sensors(layers)?,
        sensor_silence: number(layers, "temperature.sensor_silence_s").map(Duration::from_secs_f64)?,
        without_effect: without_effect(layers)?,
    })
}

/// Checks that every value has the type of its setting; reports the first wrong setting, in the order of the names.
fn check_types(layers: &Layers) -> Result<(), SettingsError> {
    let mut keys = KEYS;
    keys.sort_by_key(|key| key.name);
    keys.iter().try_for_each(|key| match key.kind {
        SettingKind::Text => read::<String>(layers, key.name).map(drop),
        SettingKind::YesNo => read::<bool>(layers, key.name).map(drop),
        SettingKind::Texts => read::<Texts>(layers, key.name).map(drop),
        SettingKind::Number { .. } => read::<f64>(layers, key.name).map(drop),
        SettingKind::NumberOrWord { .. } => read::<NumberOrWord>(layers, key.name).map(drop),
        SettingKind::Whole => read::<u64>(layers, key.name).map(drop),
    })
}

fn hall_file(layers: &Layers) -> Result<String, SettingsError> {
    let file: String = read(layers, "hall.file")?;
    if file.trim().is_empty() { Err(layers.wrong("hall.file", "it names no hall")) } else { Ok(file) }
}

fn hall_start(layers: &Layers) -> Result<Option<(u32, u32)>, SettingsError> {
    let written: String = read(layers, "hall.start")?;
    let number = |text: &str| text.trim().parse::<u32>().ok();
    let start = written.split_once(',').and_then(|(column, row)| Some((number(column)?, number(row)?)));
    if start.is_none() && !written.is_empty() {
        Err(layers.wrong("hall.start", "it is not a column and a row"))
    } else {
        Ok(start)
    }
}

/// The exercise, if there is one. Its test pieces are simulated, so the searching robot must be simulated too.
fn exercise(layers: &Layers) -> Result<Option<Exercise>, SettingsError> {
    let pieces = count(layers, "hall.exercise")?;
    let kind = robots::kind(layers, "robot.kind")?;
    if pieces > 0 && kind != RobotKind::Sim {
        let problem = format!("an exercise is simulated, but the searching robot is of the kind {}", kind.name());
        return Err(layers.wrong_with_advice("hall.exercise", problem, "write 0, or search with the robot sim"));
    }
    let seed = layers.is_chosen("robot.seed").then(|| read(layers, "robot.seed")).transpose()?;
    Ok((pieces > 0).then_some(Exercise { pieces, seed }))
}

fn http(layers: &Layers) -> Result<HttpSettings, SettingsError> {
    let bind = bind(layers, "http.bind")?;
    let hosts = match read(layers, "http.hosts")? {
        Texts::Several(names) => names,
        Texts::Single(name) => vec![name],
    };
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'-' | b'_');
    if let Some(wrong) = hosts.iter().find(|name| name.is_empty() || !name.bytes().all(is_letter)) {
        return Err(layers.wrong("http.hosts", format!("{wrong:?} is not the name of a host")));
    }
    let asks_for_keys = read(layers, "http.require_token")? || !bind.at.is_local();
    Ok(HttpSettings { bind, asks_for_keys, hosts, tls: tls(layers)? })
}

/// The address of the CoAP door. CoAP has no keys: beyond loopback, everybody who reaches the address can read
/// everything. So such an address is accepted only with `coap.open_to_others`.
fn coap(layers: &Layers) -> Result<Option<Bind>, SettingsError> {
    if read::<String>(layers, "coap.bind")? == "none" {
        return Ok(None);
    }
    let bind = bind(layers, "coap.bind")?;
    if read(layers, "coap.open_to_others")? || bind.at.is_local() {
        return Ok(Some(bind));
    }
    let problem = "everybody who reaches this address could read everything there, unencrypted and without a key";
    let advice = "write a loopback address, such as localhost:5683, or none to turn CoAP off; or set coap.open_to_others = true \
                  to allow this";
    Err(layers.wrong_with_advice("coap.bind", problem, advice))
}

fn tls(layers: &Layers) -> Result<Option<TlsFiles>, SettingsError> {
    let (certificate, key): (String, String) = (read(layers, "http.tls_certificate")?, read(layers, "http.tls_key")?);
    match (certificate.as_str(), key.as_str()) {
        ("", "") => Ok(None),
        (_, "") => Err(layers.wrong("http.tls_key", "http.tls_certificate is set, and needs its key")),
        ("", _) => Err(layers.wrong("http.tls_certificate", "http.tls_key is set, and needs its certificate")),
        (certificate, key) => Ok(Some(TlsFiles { certificate: certificate.into(), key: key.into() })),
    }
}

fn store(layers: &Layers) -> Result<Option<PathBuf>, SettingsError> {
    match read::<String>(layers, "store.folder")?.as_str() {
        "none" => Ok(None),
        "" => {
            let usual = folder::usual(|name| std::env::var_os(name));
            let unknown = || layers.wrong("store.folder", "the home folder of this user is unknown");
            usual.map(Some).ok_or_else(unknown)
        }
        named => Ok(Some(named.into())),
    }
}

fn strategy(layers: &Layers) -> Result<Strategy, SettingsError> {
    one_of(layers, "mission.strategy", &Strategy::ALL, Strategy::name, "there is no such strategy")
}

fn core(layers: &Layers) -> Result<CoreSettings, SettingsError> {
    let threshold = Celsius::new(read(layers, "temperature.threshold_celsius")?)
        .ok_or_else(|| layers.wrong("temperature.threshold_celsius", "it is out of range"))?;
    Ok(CoreSettings {
        rules: rules(layers)?,
        threshold,
        hysteresis: number(layers, "temperature.hysteresis_celsius")?,
        inspect_everything: read(layers, "mission.inspect_everything")?,
        fetcher: fetcher(layers)?,
        objective: one_of(layers, "mission.goal", &Objective::ALL, Objective::name, "there is no such goal")?,
        sonar_cells: robots::sonar_cells(layers, "robot")?,
        costs: costs(layers)?,
        wall_lines: read(layers, "mission.wall_lines")?,
    })
}

fn rules(layers: &Layers) -> Result<Rules, SettingsError> {
    let key = "mission.after_danger";
    let mut after_danger = one_of(layers, key, &AfterDanger::ALL, AfterDanger::name, "there is no such rule")?;
    if exercise(layers)?.is_some() {
        if layers.is_chosen(key) && after_danger == AfterDanger::Return {
            let problem = "in an exercise the search goes on after a danger, so that every piece is judged";
            return Err(layers.wrong_with_advice(key, problem, "write go_on, or leave this setting out"));
        }
        if number(layers, "mission.keep_out_m")? > 0.0 {
            let problem = "in an exercise every piece is judged, also beside one that was judged dangerous";
            return Err(layers.wrong_with_advice("mission.keep_out_m", problem, "write 0"));
        }
        if read(layers, "mission.inspect_everything")? {
            let problem = "in an exercise the camera must recognise the pieces";
            return Err(layers.wrong_with_advice("mission.inspect_everything", problem, "write false"));
        }
        after_danger = AfterDanger::GoOn;
    }
    Ok(Rules {
        after_danger,
        keep_out_m: number(layers, "mission.keep_out_m")?,
        safe_by: safe_by(layers)?,
        hot: one_of(layers, "mission.hot", &HotRule::ALL, HotRule::name, "there is no such rule")?,
        unsure_views: u8::try_from(count(layers, "mission.unsure_views")?).unwrap_or(Rules::MOST_VIEWS),
    })
}

/// How many judges a *safe* needs. Two are possible only where the answer of the first can be kept back: at somebody
/// else's broker, and with rumqttd as the router, everybody who subscribes can read every command.
fn safe_by(layers: &Layers) -> Result<SafeBy, SettingsError> {
    let key = "mission.safe_by";
    let safe_by = if count(layers, key)? == 2 { SafeBy::Two } else { SafeBy::One };
    let is_set = |name: &str, usual: &str| read::<String>(layers, name).map(|value| value != usual);
    if safe_by == SafeBy::Two && (is_set("mqtt.broker", "")? || is_set("mqtt.router", "own")?) {
        let problem = "everybody at that MQTT broker could read the answer of the first judge";
        return Err(layers.wrong_with_advice(key, problem, "write 1; or use hallsweep's own broker with its own router"));
    }
    Ok(safe_by)
}

/// Which robot fetches luggage. The simulated pair is in the simulator's hall, so the pair cannot fetch if the
/// searching robot is not simulated.
fn fetcher(layers: &Layers) -> Result<Fetcher, SettingsError> {
    let key = "mission.retrieval";
    let fetcher = one_of(layers, key, &Fetcher::ALL, Fetcher::name, "there is no such fetcher")?;
    let kind = robots::kind(layers, "robot.kind")?;
    if fetcher != Fetcher::Pair || kind == RobotKind::Sim {
        return Ok(fetcher);
    }
    if !layers.is_chosen(key) {
        return Ok(Fetcher::None);
    }
    let problem = format!("the pair is simulated, but the searching robot is of the kind {}", kind.name());
    Err(layers.wrong_with_advice(
        key,
        problem,
        "write none, or discovery if that robot has a gripper; or search with the robot sim",
    ))
}

/// The costs of moves; `None` if a move costs the time that the robot takes for it.
fn costs(layers: &Layers) -> Result<Option<Costs>, SettingsError> {
    let written: String = read(layers, "mission.costs")?;
    if written == "robot" {
        return Ok(None);
    }
    let costs = Costs::read(&written);
    costs.map(Some).ok_or_else(|| {
        layers.wrong("mission.costs", "it is not three numbers, the first above 0, the others at most 25 times the first")
    })
}

fn sensors(layers: &Layers) -> Result<Vec<Arc<str>>, SettingsError> {
    let names: String = read(layers, "temperature.sensor")?;
    let mut sensors = Vec::new();
    for name in names.split(',').map(str::trim).filter(|_| !names.trim().is_empty()) {
        let sensor = TemperatureReport::sensor_name(name)
            .ok_or_else(|| layers.wrong("temperature.sensor", format!("{name:?} is not a sensor name")))?;
        if sensors.contains(&sensor) {
            return Err(layers.wrong("temperature.sensor", format!("{name:?} is named twice")));
        }
        sensors.push(sensor);
    }
    if sensors.len() > SENSORS {
        return Err(layers.wrong("temperature.sensor", format!("there are {} names", sensors.len())));
    }
    Ok(sensors)
}

fn log(layers: &Layers) -> Result<String, SettingsError> {
    let filter: String = read(layers, "log.filter")?;
    match EnvFilter::builder().parse(&filter) {
        Ok(_) => Ok(filter),
        Err(error) => Err(layers.wrong("log.filter", error.to_string())),
    }
}

#[cfg(test)]
#[path = "check_tests.rs"]
mod tests;
