//! Parses single settings, or reports what is wrong with a setting.

use figment::value::{Num, Value};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::bind::{Bind, BindAddress};
use super::error::SettingsError;
use super::key::{Key, SettingKind};
use super::layers::Layers;
use hallsweep_core::search::Sensing;

#[derive(Deserialize)]
#[serde(untagged)]
pub(super) enum NumberOrWord {
    Number(f64),
    Word(String),
}

pub(super) fn read<T: DeserializeOwned>(layers: &Layers, key: &str) -> Result<T, SettingsError> {
    layers.value(key).and_then(|value| value.deserialize().ok()).ok_or_else(|| wrong_type(layers, key))
}

fn wrong_type(layers: &Layers, key: &str) -> SettingsError {
    let is_whole = Key::named(key).is_some_and(|key| key.kind == SettingKind::Whole);
    let problem = match layers.value(key) {
        Some(Value::String(..) | Value::Char(..)) => "it is a text",
        Some(Value::Bool(..)) => "it is true or false",
        Some(Value::Num(_, Num::F32(_) | Num::F64(_))) if is_whole => "it is not a whole number",
        Some(Value::Num(..)) if is_whole => "it is out of range",
        Some(Value::Num(_, Num::I128(_) | Num::U128(_))) => "it is out of range",
        Some(Value::Num(..)) => "it is a number",
        Some(Value::Array(..)) => "it is a list",
        Some(Value::Dict(..)) => "it is a table",
        Some(Value::Empty(..)) | None => "it is missing",
    };
    layers.wrong(key, problem)
}

pub(super) fn bind(layers: &Layers, key: &str) -> Result<Bind, SettingsError> {
    let written: String = read(layers, key)?;
    let at = BindAddress::read(&written).ok_or_else(|| layers.wrong(key, "it is not an address with a port"))?;
    Ok(Bind { at, is_chosen: layers.is_chosen(key) })
}

pub(super) fn one_of<T: Copy>(
    layers: &Layers,
    key: &str,
    all: &[T],
    name: fn(T) -> &'static str,
    wrong: &str,
) -> Result<T, SettingsError> {
    let written: String = read(layers, key)?;
    all.iter().copied().find(|value| name(*value) == written).ok_or_else(|| layers.wrong(key, wrong))
}

pub(super) fn sensing(layers: &Layers) -> Result<Sensing, SettingsError> {
    one_of(layers, "mission.sensing", &Sensing::ALL, Sensing::name, "there is no such sensing")
}

pub(super) fn number(layers: &Layers, key: &str) -> Result<f64, SettingsError> {
    within(layers, key, read(layers, key)?)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is whole, and its setting bounds it")]
pub(super) fn count(layers: &Layers, key: &str) -> Result<u32, SettingsError> {
    let value = number(layers, key)?;
    if value.fract() == 0.0 { Ok(value as u32) } else { Err(layers.wrong(key, "it is not a whole number")) }
}

pub(super) fn within(layers: &Layers, key: &str, value: f64) -> Result<f64, SettingsError> {
    let problem = if value.is_nan() { "it is not a number" } else { "it is out of range" };
    let is_beyond = Key::named(key).is_some_and(|key| key.is_beyond(value));
    if is_beyond { Err(layers.wrong(key, problem)) } else { Ok(value) }
}
