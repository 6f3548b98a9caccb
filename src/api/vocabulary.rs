//! The words that a field with a fixed list may hold: a schema for each list, made from the core's own list where there is one.
//! The values themselves stay plain texts; a field names its list by `with`. Schemathesis finds a word that is missing here.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

use behaviour_trees::Status;
use hallsweep_core::snapshot::log;
use hallsweep_core::world::temperature;
use hallsweep_core::{command, hold, not_fetched, phase, robot, units};

/// Makes a schema of each list of words. Its doc comment becomes the description, which clients see.
macro_rules! lists {
    ($($(#[doc = $doc:literal])* $name:ident = $words:expr;)*) => {$(
        $(#[doc = $doc])*
        pub struct $name;

        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({"type": "string", "enum": $words, "description": concat!($($doc),*).trim_ascii()})
            }
        }
    )*};
}

lists! {
    /// Where a mission stands.
    Phase = phase::PhaseName::ALL.map(phase::PhaseName::name);
    /// Why nothing moves.
    Hold = hold::Hold::ALL.map(hold::Hold::name);
    /// Which way a robot faces.
    Heading = units::Heading::ALL.map(units::Heading::name);
    /// What a robot does.
    RobotState = robot::RobotState::ALL.map(robot::RobotState::name);
    /// What a robot has.
    Part = robot::Part::ALL.map(robot::Part::name);
    /// What the LED does.
    Led = ["off", "blinking"];
    /// What a gripper does.
    Gripper = hallsweep_core::arm::Gripper::ALL.map(hallsweep_core::arm::Gripper::name);
    /// The order of a search.
    StrategyName = command::Strategy::ALL.map(command::Strategy::name);
    /// What was decided of a piece of luggage, if anything was.
    Verdict = ["pending", "safe", "danger"];
    /// What may be decided of a piece of luggage.
    VerdictWord = [command::Verdict::Safe, command::Verdict::Danger].map(command::Verdict::name);
    /// What became of a photo.
    PhotoState = ["taken", "failed"];
    /// What the temperature means.
    TemperatureStatus = temperature::TemperatureStatus::ALL.map(temperature::TemperatureStatus::name);
    /// What an operator may say of the temperature without a reading.
    TemperatureWord = ["ok", "tooHigh"];
    /// A move by hand: forward, backward, left (two words), right (two words), small turns, and STOP (two words).
    Move = ["w", "s", "a", "l", "d", "r", "z", "x", "h", "stop"];
    /// How loud a line of the log is.
    Tone = log::Tone::ALL.map(log::Tone::name);
    /// How far a retrieval has come.
    RetrievalStage = ["none", "makingRoom", "fetching", "lettingGo", "goingOut", "comingHome"];
    /// Who fetches.
    Fetcher = not_fetched::Fetcher::ALL.map(not_fetched::Fetcher::name);
    /// What a node of a behaviour tree said.
    NodeStatus = Status::ALL.map(Status::word);
}
