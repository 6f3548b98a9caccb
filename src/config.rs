//! The settings of the program, complete and checked before anything starts. They come from the defaults, the file,
//! the environment and the flags; each of these overrides the ones before it. The code here only parses settings and
//! refuses wrong settings. Other modules apply the settings.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::command::Strategy;
use hallsweep_core::hall::HallId;
use hallsweep_core::robot::RobotId;
use hallsweep_core::settings::Settings as CoreSettings;
use hallsweep_core::speed::Speed;

mod bind;
mod check;
mod environment;
mod error;
mod file;
mod folder;
mod given;
mod halls;
mod host;
mod key;
mod layers;
mod mqtt;
mod quick_start;
mod reading;
mod robot_address;
mod robots;
mod without_effect;

pub use bind::{Bind, BindAddress, from_here};
pub use environment::{Flag, Sources};
pub use error::SettingsError;
pub use given::DEFAULTS;
pub use halls::MOST_HALLS;
pub use key::{KEYS, Key, SettingKind};

pub use mqtt::{Broker, Login, MqttRouter, MqttSettings, OtherBroker};
pub use robot_address::{RobotAddress, RobotKind};
pub use robots::MOST_ROBOTS;

/// The settings of the whole program.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The hall to which all addresses lead that name no hall.
    pub hall: HallSettings,
    /// The other halls; empty by default.
    pub further_halls: Vec<HallSettings>,
    pub http: HttpSettings,
    /// Address of the CoAP resources, over UDP; `None` for no CoAP door.
    pub coap: Option<Bind>,
    pub mqtt: MqttSettings,
    pub old_clients: OldClients,
    /// Folder for everything that is kept after the program ends; `None` to store nothing.
    pub store: Option<PathBuf>,
    /// Which log lines are written, in the notation of `tracing_subscriber::EnvFilter`.
    pub log: String,
}

/// The settings of one hall and its robots.
#[derive(Clone, Debug, PartialEq)]
pub struct HallSettings {
    pub name: HallId,
    /// The name that several halls share, for a STOP of all of them.
    pub group: Option<HallId>,
    /// Name of a built-in hall, or path of a hall file.
    pub file: String,
    /// Column and row of the robot's start, counted from 0 in the north-west corner; `None` for the start in the hall file.
    pub start: Option<(u32, u32)>,
    /// The exercise; `None` for a mission with ordinary pieces.
    pub exercise: Option<Exercise>,
    /// Where the name of the hall was set, such as `flag --hall`. The error names this place when the hall cannot be
    /// read.
    pub origin: String,
    /// Whether somebody has chosen a hall. Only then its areas apply to a real robot.
    pub is_chosen: bool,
    /// Distance in metres that people must keep from a bomb.
    pub evacuation_m: f64,
    /// Folder for the journal, the photos, and what is stored about the robots; `None` to store nothing.
    pub folder: Option<PathBuf>,
    /// Number of days for which a mission stays in the journal after it was put away; 0 means for ever.
    pub keep_days: u32,
    pub robot: RobotSettings,
    /// The other robots with their names; empty by default.
    pub further_robots: Vec<(RobotId, RobotSettings)>,
    pub pair: PairMishaps,
    pub strategy: Strategy,
    pub core: CoreSettings,
    /// The required temperature sensors, without duplicates; empty by default.
    pub sensors: Vec<Arc<str>>,
    pub sensor_silence: Duration,
    pub without_effect: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exercise {
    /// Number of test pieces.
    pub pieces: u32,
    /// The seed that says where they stand, if it is set.
    pub seed: Option<u64>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HttpSettings {
    pub bind: Bind,
    /// Whether a key is required. Keys are always required beyond loopback; on loopback the setting decides.
    pub asks_for_keys: bool,
    /// Host names of the console and the API, in addition to the machine's own names.
    pub hosts: Vec<String>,
    pub tls: Option<TlsFiles>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OldClients {
    /// Whether old clients may drive the robot by hand. They may always halt the robot.
    pub manual_driving: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TlsFiles {
    /// PEM file with the certificate, and the certificates that lead to a known authority.
    pub certificate: PathBuf,
    pub key: PathBuf,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RobotSettings {
    pub kind: RobotKind,
    pub address: RobotAddress,
    /// Speed of a serial line in bits per second.
    pub baud: u32,
    /// Time that the robot takes to cross a cell, unless the robot itself reports this time.
    pub step: Duration,
    /// The scene file of the virtual robot's page, which tells the driver the distances.
    pub scene: Option<PathBuf>,
    pub speed: Speed,
    pub seed: u64,
    /// Share of obstacles that the camera cannot recognise, `0.0..=1.0`.
    pub unknown_rate: f64,
    /// Whether the camera can miss luggage and take it for a wall.
    pub camera_misses: bool,
    /// Share of photos that fail, `0.0..=1.0`.
    pub photo_failure_rate: f64,
    /// Standard deviation of the front sonar, in centimetres.
    pub sonar_noise_cm: f64,
    /// Number of cells ahead that the sonar reports as free or occupied; 0 when the search does not use the sonar.
    pub sonar_cells: u8,
}

/// How many mishaps happen to the simulated pair, so that operators can practise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PairMishaps {
    pub slips: u32,
    pub unrecognised: u32,
}

pub fn load(sources: &Sources) -> Result<Settings, SettingsError> {
    check::checked(&layers::AllGiven::gather(sources)?)
}

/// Sources of the settings in a real start: an optional file, the environment of this process, and flags.
pub fn sources(file: Option<PathBuf>, flags: Vec<Flag>) -> Sources {
    let environment = std::env::vars_os().filter_map(|(name, value)| {
        let name = name.into_string().ok()?;
        name.starts_with(environment::OURS).then(|| (name, value.to_string_lossy().into_owned()))
    });
    Sources { file, environment: environment.collect(), flags }
}
