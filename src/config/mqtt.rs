//! The settings of the MQTT door: our own broker or an external one, and the names of the topics.

use std::fmt;
use std::path::PathBuf;

use super::bind::Bind;
use super::error::SettingsError;
use super::host::host_and_port;
use super::layers::Layers;
use super::reading::{bind, read};

const PLAIN: u16 = 1883;

const ENCRYPTED: u16 = 8883;

/// Further halls have their topics under `PREFIX/halls`, in place of an id.
const HALLS: &str = "halls";

/// Maximum length of a prefix. A longer prefix would leave too little space for the rest of a topic.
const LONGEST: usize = 64;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MqttSettings {
    /// The broker; `None` for no MQTT door.
    pub broker: Option<Broker>,
    /// Prefix of all JSON topics, such as `hallsweep`.
    pub prefix: String,
    /// Name of this robot in topics, such as `discovery`.
    pub id: String,
    /// Prefix of the original system's topics, such as `unibo/qak`.
    pub old_prefix: String,
    pub home_assistant: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Broker {
    Own {
        bind: Bind,
        /// Whether name and password are required. They are always required beyond loopback; on loopback the setting
        /// decides.
        asks_for_keys: bool,
        router: MqttRouter,
    },
    Other(OtherBroker),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MqttRouter {
    Own,
    Rumqttd,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OtherBroker {
    pub host: String,
    pub port: u16,
    pub is_five: bool,
    pub is_encrypted: bool,
    pub login: Option<Login>,
    /// A PEM file of trusted certificates; `None` for the certificates that the system trusts.
    pub certificates: Option<PathBuf>,
}

#[derive(Clone, PartialEq, Eq)]
pub struct Login {
    pub name: String,
    pub password: String,
}

impl fmt::Display for OtherBroker {
    /// The address of the broker, such as `mqtt://broker.example:1883`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scheme = if self.is_encrypted { "mqtts" } else { "mqtt" };
        let host = if self.host.contains(':') { format!("[{}]", self.host) } else { self.host.clone() };
        write!(f, "{scheme}://{host}:{}", self.port)
    }
}

impl fmt::Debug for Login {
    /// Leaves out the password, which must not be logged.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Login({:?})", self.name)
    }
}

pub(super) fn mqtt(layers: &Layers) -> Result<MqttSettings, SettingsError> {
    let broker = match read::<String>(layers, "mqtt.broker")?.as_str() {
        "" => own(layers)?,
        url => Some(Broker::Other(other(layers, url)?)),
    };
    let prefix = name(layers, "mqtt.prefix", true)?;
    Ok(MqttSettings {
        broker,
        id: id(layers)?,
        old_prefix: old_prefix(layers, &prefix)?,
        prefix,
        home_assistant: read(layers, "mqtt.home_assistant")?,
    })
}

fn own(layers: &Layers) -> Result<Option<Broker>, SettingsError> {
    for key in ["mqtt.name", "mqtt.password", "mqtt.certificates"] {
        if !read::<String>(layers, key)?.is_empty() {
            return Err(layers.wrong_unseen(key, "it is only for another broker, and mqtt.broker is empty"));
        }
    }
    if is_five(layers)? {
        return Err(layers.wrong("mqtt.version", "it is only for another broker; at hallsweep's own broker each client chooses"));
    }
    if read::<String>(layers, "mqtt.bind")? == "none" {
        return Ok(None);
    }
    let bind = bind(layers, "mqtt.bind")?;
    let asks_for_keys = read(layers, "mqtt.require_password")? || !bind.at.is_local();
    let router = match read::<String>(layers, "mqtt.router")?.as_str() {
        "own" => MqttRouter::Own,
        "rumqttd" => MqttRouter::Rumqttd,
        _ => return Err(layers.wrong("mqtt.router", "there is no such router")),
    };
    Ok(Some(Broker::Own { bind, asks_for_keys, router }))
}

fn is_five(layers: &Layers) -> Result<bool, SettingsError> {
    match read::<String>(layers, "mqtt.version")?.as_str() {
        "3.1.1" => Ok(false),
        "5" => Ok(true),
        _ => Err(layers.wrong("mqtt.version", "there is no such version")),
    }
}

fn other(layers: &Layers, url: &str) -> Result<OtherBroker, SettingsError> {
    let wrong = |problem: &str| layers.wrong("mqtt.broker", problem);
    let (is_encrypted, rest) = match url.split_once("://") {
        Some(("mqtt", rest)) => (false, rest),
        Some(("mqtts", rest)) => (true, rest),
        Some(_) | None => return Err(wrong("it does not begin with mqtt:// or mqtts://")),
    };
    let rest = rest.strip_suffix('/').unwrap_or(rest);
    if rest.contains('@') {
        return Err(layers.wrong_unseen("mqtt.broker", "the user name and the password belong in mqtt.name and mqtt.password"));
    }
    let (host, port) = host_and_port(rest).ok_or_else(|| wrong("its host is missing, or its port is not valid"))?;
    let port = port.unwrap_or(if is_encrypted { ENCRYPTED } else { PLAIN });
    let certificates = Some(read::<String>(layers, "mqtt.certificates")?).filter(|path| !path.is_empty()).map(PathBuf::from);
    if certificates.is_some() && !is_encrypted {
        return Err(layers.wrong("mqtt.certificates", "mqtt.broker does not use TLS"));
    }
    Ok(OtherBroker { host, port, is_five: is_five(layers)?, is_encrypted, login: login(layers)?, certificates })
}

fn login(layers: &Layers) -> Result<Option<Login>, SettingsError> {
    let (name, password): (String, String) = (read(layers, "mqtt.name")?, read(layers, "mqtt.password")?);
    match (name.is_empty(), password.is_empty()) {
        (true, true) => Ok(None),
        (true, false) => Err(layers.wrong("mqtt.name", "mqtt.password is set, and needs a name")),
        (false, _) => Ok(Some(Login { name, password })),
    }
}

/// Reads a name that can begin topics and be part of Home Assistant's names. It is one word; with `slashes` it may be
/// several words separated by slashes.
fn name(layers: &Layers, key: &str, slashes: bool) -> Result<String, SettingsError> {
    let written: String = read(layers, key)?;
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    let mut words = written.split('/');
    let are_plain = words.all(|word| !word.is_empty() && word.bytes().all(is_plain));
    if written.len() > LONGEST || !are_plain || (!slashes && written.contains('/')) {
        return Err(layers.wrong(key, "it is not a valid part of a topic"));
    }
    Ok(written)
}

/// Reads the id of the default hall. It must not be the level below which further halls have their topics.
fn id(layers: &Layers) -> Result<String, SettingsError> {
    let id = name(layers, "mqtt.id", false)?;
    if id == HALLS {
        return Err(layers.wrong("mqtt.id", "these topics would be mixed with the topics of further halls"));
    }
    Ok(id)
}

/// Reads the prefix of the old topics. Neither prefix may be below the other, since old and new topics would be
/// mixed.
fn old_prefix(layers: &Layers, prefix: &str) -> Result<String, SettingsError> {
    let old = name(layers, "mqtt.old_prefix", true)?;
    let (ours, theirs) = (format!("{prefix}/"), format!("{old}/"));
    if ours.starts_with(&theirs) || theirs.starts_with(&ours) {
        return Err(layers.wrong("mqtt.old_prefix", "these topics would be mixed with the topics of mqtt.prefix"));
    }
    Ok(old)
}
