//! The settings of the program, complete and checked before anything starts: defaults ← file ← environment ← flags.
//! What a setting does is decided where it is used; here it is only read, and refused when it is wrong.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::command::Strategy;
use hallsweep_core::event::RobotId;
use hallsweep_core::settings::Settings as CoreSettings;

mod bind;
mod check;
mod environment;
mod error;
mod folder;
mod host;
mod key;
mod layers;
mod mqtt;
mod reading;
mod robot_address;
mod robots;
mod without_effect;

pub use bind::{Bind, BindAddress, from_here};
pub use environment::{Flag, Sources};
pub use error::SettingsError;
pub use key::{KEYS, Key, SettingKind};
pub use layers::DEFAULTS;
pub use mqtt::{Broker, Login, MqttRouter, MqttSettings, OtherBroker};
pub use robot_address::{RobotAddress, RobotKind};
pub use robots::MOST_ROBOTS;

/// Everything that can be set, with every value known to be usable.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The name of a built-in hall, or the path of a hall file.
    pub hall: String,
    /// The column and row in which the robot starts, counted from 0 in the north-west corner; `None`: where the hall says.
    pub hall_start: Option<(u32, u32)>,
    /// Where the hall's name comes from, as `flag --hall`, for whoever finds that it cannot be read.
    pub hall_origin: String,
    pub http: HttpSettings,
    /// Where the CoAP resources are, over UDP; `None`: there is no such door.
    pub coap: Option<Bind>,
    pub mqtt: MqttSettings,
    pub old_clients: OldClients,
    /// How far away from a bomb people must be, in metres.
    pub evacuation_m: f64,
    /// Where everything is kept that outlives the program; `None`: nothing is kept.
    pub store: Option<PathBuf>,
    /// How many days a mission stays in the journal after it was put away; 0 is for ever.
    pub keep_days: u32,
    /// The robot that searches.
    pub robot: RobotSettings,
    /// The robots beside it, by their names; none by default.
    pub further_robots: Vec<(RobotId, RobotSettings)>,
    pub pair: PairMishaps,
    pub strategy: Strategy,
    pub core: CoreSettings,
    /// The temperature sensors that must be heard, each once; none by default.
    pub sensors: Vec<Arc<str>>,
    /// How long the silence of a sensor is borne.
    pub sensor_silence: Duration,
    /// Which log lines are written, in the notation of `tracing_subscriber::EnvFilter`.
    pub log: String,
    /// What somebody has set that does nothing, because the robot is not simulated: by the names by which it was given.
    pub without_effect: Vec<String>,
}

/// Where the console and the API are, and for whom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HttpSettings {
    pub bind: Bind,
    /// Whether a key is asked for: always beyond loopback, and on loopback when it is wanted.
    pub asks_for_keys: bool,
    /// Names under which they are reached, beside the machine's own for itself.
    pub hosts: Vec<String>,
    pub tls: Option<TlsFiles>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OldClients {
    /// Whether they may drive the robot by hand; halt it they may always.
    pub manual_driving: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TlsFiles {
    /// In PEM: the certificate, and those that lead to a known one.
    pub certificate: PathBuf,
    pub key: PathBuf,
}

/// What a robot is, where it is reached, and how it behaves when it is a simulated one.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSettings {
    pub kind: RobotKind,
    pub address: RobotAddress,
    /// How fast a serial line is, in bits a second.
    pub baud: u32,
    /// How long it takes for a cell, where it does not say so itself.
    pub step: Duration,
    /// The scene file of the virtual robot's page, by which its driver knows how far things are.
    pub scene: Option<PathBuf>,
    pub speed: Speed,
    pub seed: u64,
    /// How often the camera cannot tell what an obstacle is, `0.0..=1.0`.
    pub unknown_rate: f64,
    /// How often a photo fails, `0.0..=1.0`.
    pub photo_failure_rate: f64,
    /// The standard deviation of the front sonar, in centimetres.
    pub sonar_noise_cm: f64,
    /// How many cells ahead its sonar tells whether they are free; 0 where the search does not go by sonar.
    pub sonar_cells: u8,
}

/// What goes wrong with the simulated pair, for practice: how many times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PairMishaps {
    pub slips: u32,
    pub unrecognised: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// So many times as fast as the wall clock, within `SLOWEST..=FASTEST`.
    Times(f64),
    Max,
}

impl Speed {
    /// Slower than this a person would think that the robot hangs.
    pub const SLOWEST: f64 = 0.1;
    /// Faster than this a factor means nothing: timers are good to about a millisecond. `max` is for those in a hurry.
    pub const FASTEST: f64 = 1000.0;
}

pub fn load(sources: &Sources) -> Result<Settings, SettingsError> {
    let layers = layers::Layers::gather(sources)?;
    check::checked(&layers)
}

/// Where settings come from in a real start: an optional file, the environment of this process, and flags.
pub fn sources(file: Option<PathBuf>, flags: Vec<Flag>) -> Sources {
    let environment = std::env::vars_os().filter_map(|(name, value)| {
        let name = name.into_string().ok()?;
        name.starts_with(environment::OURS).then(|| (name, value.to_string_lossy().into_owned()))
    });
    Sources { file, environment: environment.collect(), flags }
}
