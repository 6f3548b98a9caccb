//! Everything that can reach a mission, by name: the columns of the table.
//! What an input carries (which piece, which cell) stands beside it, in `InputContext`.

use std::sync::Arc;

use super::FaultCause;
use crate::command::{Command, Issuer, LuggageRef, Move, TemperatureReport, Verdict};
use crate::event::{Obstacle, Photo};
use crate::search::Strategy;
use crate::units::{AlarmId, Cell, Celsius, Epoch, LuggageId};
use crate::world::temperature::OPERATOR;

/// The commands and events of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "each is explained by `Input::in_words`, which the documentation prints")]
pub enum Input {
    Start,
    Stop,
    BackHome,
    Safe,
    Danger,
    TemperatureOk,
    TemperatureTooHigh,
    Reading,
    SensorReading,
    Retrieve,
    Reset,
    Move,
    Goto,
    RetakePhoto,
    Acknowledge,
    Strategy,
    Done,
    Blocked,
    AtPiece,
    PhotoTaken,
    PhotoFailed,
    LuggageRecorded,
    SafeRecorded,
    DangerRecorded,
    CameHome,
    AllExplored,
    DriveEnded,
    NoWayHome,
    Unanswered,
    RobotFailed,
    LinkLost,
    LinkUp,
    Heat,
    Cool,
    SensorSilent,
    SensorBack,
    StoreFailed,
    StoreRestored,
    Restarted,
}

impl Input {
    /// The commands, in the order of mission §4.
    pub const COMMANDS: [Input; 16] = [
        Input::Start,
        Input::Stop,
        Input::BackHome,
        Input::Safe,
        Input::Danger,
        Input::TemperatureOk,
        Input::TemperatureTooHigh,
        Input::Reading,
        Input::SensorReading,
        Input::Retrieve,
        Input::Reset,
        Input::Move,
        Input::Goto,
        Input::RetakePhoto,
        Input::Acknowledge,
        Input::Strategy,
    ];

    /// The events, in the order of a mission's life.
    pub const EVENTS: [Input; 23] = [
        Input::Done,
        Input::Blocked,
        Input::AtPiece,
        Input::PhotoTaken,
        Input::PhotoFailed,
        Input::LuggageRecorded,
        Input::SafeRecorded,
        Input::DangerRecorded,
        Input::CameHome,
        Input::AllExplored,
        Input::DriveEnded,
        Input::NoWayHome,
        Input::Unanswered,
        Input::RobotFailed,
        Input::LinkLost,
        Input::LinkUp,
        Input::Heat,
        Input::Cool,
        Input::SensorSilent,
        Input::SensorBack,
        Input::StoreFailed,
        Input::StoreRestored,
        Input::Restarted,
    ];

    /// What it is, for the documentation and the log.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Input::Start => "START",
            Input::Stop => "STOP",
            Input::BackHome => "BACK HOME",
            Input::Safe => "safe",
            Input::Danger => "danger",
            Input::TemperatureOk => "temperature OK",
            Input::TemperatureTooHigh => "temperature TOO HIGH",
            Input::Reading => "temperature reading",
            Input::SensorReading => "a sensor's reading",
            Input::Retrieve => "RETRIEVE",
            Input::Reset => "RESET",
            Input::Move => "move",
            Input::Goto => "goto",
            Input::RetakePhoto => "retake photo",
            Input::Acknowledge => "acknowledge alarm",
            Input::Strategy => "choose strategy",
            Input::Done => "an order is done",
            Input::Blocked => "a step met an obstacle",
            Input::AtPiece => "back at a piece without a photo",
            Input::PhotoTaken => "the photo is taken",
            Input::PhotoFailed => "the photo failed",
            Input::LuggageRecorded => "the luggage is on record",
            Input::SafeRecorded => "safe is on record",
            Input::DangerRecorded => "danger is on record",
            Input::CameHome => "the robot is home",
            Input::AllExplored => "nothing is left to explore",
            Input::DriveEnded => "the drive by hand ended",
            Input::NoWayHome => "no known way leads home",
            Input::Unanswered => "an order was not finished in time",
            Input::RobotFailed => "the robot could not do it",
            Input::LinkLost => "the robot's link is lost",
            Input::LinkUp => "the robot's link is up",
            Input::Heat => "a reading rose above the threshold",
            Input::Cool => "every reading permits again",
            Input::SensorSilent => "a sensor fell silent",
            Input::SensorBack => "the sensor reads again",
            Input::StoreFailed => "the store cannot write",
            Input::StoreRestored => "the store writes again",
            Input::Restarted => "the program was started again",
        }
    }
}

/// What an input is about. Which fields matter depends on the input; the rest stays empty.
#[derive(Clone, Debug, Default)]
pub struct InputContext {
    /// Who gave the command.
    pub issuer: Option<Issuer>,
    /// The epoch that a stop has raised; of another command, the one in which it was given.
    pub epoch: Option<Epoch>,
    /// The piece named, or found to be meant by a bare word.
    pub luggage: Option<LuggageId>,
    /// What is said of it.
    pub verdict: Option<Verdict>,
    /// The move by hand.
    pub step: Option<Move>,
    /// The cell of a goto, or of an obstacle.
    pub cell: Option<Cell>,
    /// What the obstacle was taken for.
    pub obstacle: Option<Obstacle>,
    /// The photo.
    pub photo: Option<Photo>,
    /// The alarm.
    pub alarm: Option<AlarmId>,
    /// The strategy.
    pub strategy: Option<Strategy>,
    /// The source of a reading, and the reading.
    pub reading: Option<(Arc<str>, Celsius)>,
    /// Why the mission is in fault.
    pub fault: Option<FaultCause>,
    /// What somebody else said about it, in words.
    pub words: Option<String>,
}

impl InputContext {
    /// The input a command is, and what it is about. `pending` is the piece a bare word would mean.
    #[must_use]
    pub fn of(command: &Command, issuer: &Issuer, pending: Option<LuggageId>) -> (Input, InputContext) {
        let mut context = InputContext { issuer: Some(issuer.clone()), ..InputContext::default() };
        let input = match command {
            Command::Start => Input::Start,
            Command::Stop => Input::Stop,
            Command::BackHome => Input::BackHome,
            Command::Retrieve => Input::Retrieve,
            Command::Reset => Input::Reset,
            Command::Move(step) => {
                context.step = Some(*step);
                Input::Move
            }
            Command::Goto(cell) => {
                context.cell = Some(*cell);
                Input::Goto
            }
            Command::Verdict { luggage, verdict } => {
                context.luggage = match luggage {
                    LuggageRef::Id(id) => Some(*id),
                    LuggageRef::Pending => pending,
                };
                context.verdict = Some(*verdict);
                match verdict {
                    Verdict::Safe => Input::Safe,
                    Verdict::Danger => Input::Danger,
                }
            }
            Command::RetakePhoto(id) => {
                context.luggage = Some(*id);
                Input::RetakePhoto
            }
            Command::Acknowledge(id) => {
                context.alarm = Some(*id);
                Input::Acknowledge
            }
            Command::ChooseStrategy(strategy) => {
                context.strategy = Some(*strategy);
                Input::Strategy
            }
            Command::Temperature(TemperatureReport::Ok) => Input::TemperatureOk,
            Command::Temperature(TemperatureReport::TooHigh) => Input::TemperatureTooHigh,
            Command::Temperature(TemperatureReport::Reading(celsius)) => {
                context.reading = Some((Arc::from(OPERATOR), *celsius));
                Input::Reading
            }
            Command::Temperature(TemperatureReport::Sensor(sensor, celsius)) => {
                context.reading = Some((Arc::clone(sensor), *celsius));
                Input::SensorReading
            }
        };
        (input, context)
    }
}
