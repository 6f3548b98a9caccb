//! The words that a field with a fixed list may hold. Each list has a schema, made from the core's own list where
//! there is one. The fields themselves stay plain texts; the attribute `with` of a field names its list. The test
//! program Schemathesis finds a word that is missing here.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

use behaviour_trees::Status;
use hallsweep_core::snapshot::log;
use hallsweep_core::world::temperature;
use hallsweep_core::{command, hold, not_fetched, phase, robot, units};

/// Makes a schema for each list of words. The doc comment of a list becomes its description, which clients see.
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
    /// Phase of a mission.
    Phase = phase::PhaseName::ALL.map(phase::PhaseName::name);
    /// Reason why a robot must not move.
    Hold = hold::Hold::ALL.map(hold::Hold::name);
    /// Direction in which a robot faces.
    Heading = units::Heading::ALL.map(units::Heading::name);
    /// Present activity of a robot.
    RobotState = robot::RobotState::ALL.map(robot::RobotState::name);
    /// Part or ability of a robot.
    Part = robot::Part::ALL.map(robot::Part::name);
    /// State of the LED.
    Led = ["off", "blinking"];
    /// State of a gripper.
    Gripper = hallsweep_core::arm::Gripper::ALL.map(hallsweep_core::arm::Gripper::name);
    /// Search strategy: the rule that chooses the next cell.
    StrategyName = command::Strategy::ALL.map(command::Strategy::name);
    /// Verdict on a piece of luggage; `pending` until an operator decides.
    Verdict = ["pending", "safe", "danger"];
    /// Verdict that an operator can give on a piece of luggage.
    VerdictWord = [command::Verdict::Safe, command::Verdict::Danger].map(command::Verdict::name);
    /// Answer of an operator about a piece of luggage. After `unsure`, the piece is photographed from other sides.
    AnswerWord = ["safe", "danger", "unsure"];
    /// Answer to one of the three questions about a piece of luggage.
    HotAnswer = command::HotAnswer::ALL.map(command::HotAnswer::name);
    /// Whether a photo was taken or failed.
    PhotoState = ["taken", "failed"];
    /// Effect of the temperature: `tooHigh` and `stale` stop the robots.
    TemperatureStatus = temperature::TemperatureStatus::ALL.map(temperature::TemperatureStatus::name);
    /// Operator's judgement of the temperature, without a reading.
    TemperatureWord = ["ok", "tooHigh"];
    /// Move by hand: `w` forward, `s` backward, `a` or `l` left, `d` or `r` right, `z` and `x` small turns, `h` or
    /// `stop` STOP.
    Move = ["w", "s", "a", "l", "d", "r", "z", "x", "h", "stop"];
    /// Severity of a log line.
    Tone = log::Tone::ALL.map(log::Tone::name);
    /// Stage of a retrieval; `none` while no retrieval runs.
    RetrievalStage = ["none", "makingRoom", "fetching", "lettingGo", "goingOut", "comingHome"];
    /// Robots that fetch a dangerous piece: the pair SRM1 and SRM2, the robot that searches, or none.
    Fetcher = not_fetched::Fetcher::ALL.map(not_fetched::Fetcher::name);
    /// Status of a node of a behaviour tree.
    NodeStatus = Status::ALL.map(Status::word);
}
