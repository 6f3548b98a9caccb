//! All inputs of a mission, by name. The transition table has rules for each of them. `InputContext` has the details
//! of an input, such as the piece or the cell.

use std::sync::Arc;

use crate::closing::{AreaClosing, Closing};
use crate::command::{
    Again, Command, CommandId, Hot, Issuer, LuggageRef, Move, Note, OPERATOR, Strategy, TemperatureReport, Verdict,
};
use crate::event::{Obstacle, Photo};
use crate::hand_over::HandOver;
use crate::hold::HoldReason;
use crate::phase::FaultCause;
use crate::units::{AlarmId, Cell, Celsius, Epoch, LuggageId, MissionId};

named! {
    ALL by in_words;
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub(crate) enum Input {
        Start = "START",
        Stop = "STOP",
        BackHome = "BACK HOME",
        GoOn = "GO ON",
        Safe = "safe",
        Danger = "danger",
        Unsure = "unsure",
        TemperatureOk = "temperature OK",
        TemperatureTooHigh = "temperature TOO HIGH",
        Reading = "temperature reading",
        SensorReading = "a sensor's reading",
        Retrieve = "RETRIEVE",
        Reset = "RESET",
        Close = "close",
        HandOver = "hand over",
        SearchAgain = "search again",
        OrderAreas = "order areas",
        CloseArea = "close area",
        Move = "move",
        Goto = "goto",
        RetakePhoto = "retake photo",
        Acknowledge = "acknowledge alarm",
        Strategy = "choose strategy",
        Done = "an order is done",
        Blocked = "a step met an obstacle",
        AtPiece = "the robot is back at a piece without a photo",
        PhotoTaken = "the photo is taken",
        PhotoFailed = "the photo failed",
        LuggageRecorded = "the luggage is on record",
        SafeRecorded = "the verdict safe is on record",
        DangerRecorded = "the verdict danger is on record",
        CameHome = "the robot is home",
        AllExplored = "nothing is left to explore",
        DriveEnded = "the drive by hand ended",
        Secured = "the bag is in the container",
        NotFetched = "the bag cannot be fetched",
        NoWayHome = "no known way leads home",
        Unanswered = "an order was not finished in time",
        RobotFailed = "the robot could not carry out an order",
        LinkLost = "the robot's link is lost",
        LinkUp = "the robot's link is up",
        Heat = "a reading rose above the threshold",
        Cool = "every reading is cool again",
        SensorSilent = "a sensor fell silent",
        SensorBack = "the silent sensor reports again",
        StoreFailed = "the store cannot write",
        StoreRestored = "the store can write again",
        Restarted = "the program was started again",
    }
}

impl Input {
    /// The inputs that are commands, in the order of mission §4.
    pub(crate) const COMMANDS: [Input; 23] = *Input::ALL.first_chunk().expect("they are listed first");

    /// The inputs that are events, in the order in which they occur in a mission.
    pub(crate) const EVENTS: [Input; 25] = *Input::ALL.last_chunk().expect("they are listed last");
}

/// The details of an input. The input decides which fields are set. The other fields stay empty.
#[derive(Clone, Debug, Default)]
pub(crate) struct InputContext {
    pub(crate) issuer: Option<Issuer>,
    /// For a stop, the epoch that the stop has raised. For any other command, the epoch in which it was sent.
    pub(crate) epoch: Option<Epoch>,
    /// The piece that the command names, or that a verdict without a number means.
    pub(crate) luggage: Option<LuggageId>,
    /// The mission that the sender means.
    pub(crate) mission: Option<MissionId>,
    /// Whether the command names no piece, so that it means the one that waits.
    pub(crate) is_bare: bool,
    /// The sender's id for the command.
    pub(crate) id: Option<CommandId>,
    pub(crate) verdict: Option<Verdict>,
    pub(crate) note: Option<Note>,
    pub(crate) hot: Hot,
    pub(crate) closing: Option<Closing>,
    pub(crate) hand_over: Option<HandOver>,
    pub(crate) step: Option<Move>,
    pub(crate) cell: Option<Cell>,
    pub(crate) again: Option<Again>,
    /// The areas that the command orders or closes.
    pub(crate) areas: Arc<[Arc<str>]>,
    pub(crate) area_closing: Option<AreaClosing>,
    pub(crate) obstacle: Option<Obstacle>,
    pub(crate) photo: Option<Photo>,
    pub(crate) alarm: Option<AlarmId>,
    pub(crate) strategy: Option<Strategy>,
    pub(crate) reading: Option<(Arc<str>, Celsius)>,
    pub(crate) fault: Option<FaultCause>,
    /// The reason of the hold that the input raises, if the reason is known.
    pub(crate) why: Option<HoldReason>,
    /// The reason why there is no photo, as text.
    pub(crate) words: Option<String>,
}

impl InputContext {
    /// Returns the input for a command, with its details. `pending` is the piece that a verdict without a number
    /// would mean.
    pub(crate) fn of(command: &Command, issuer: &Issuer, pending: Option<LuggageId>) -> (Input, InputContext) {
        let context = InputContext { issuer: Some(issuer.clone()), ..InputContext::default() };
        match command {
            Command::Start => (Input::Start, context),
            Command::Stop => (Input::Stop, context),
            Command::BackHome => (Input::BackHome, context),
            Command::GoOn => (Input::GoOn, context),
            Command::Retrieve(luggage) => (Input::Retrieve, InputContext { luggage: *luggage, ..context }),
            Command::Reset => (Input::Reset, context),
            Command::Close(closing) => (Input::Close, InputContext { closing: Some(closing.clone()), ..context }),
            Command::HandOver(hand_over) => {
                (Input::HandOver, InputContext { mission: hand_over.mission, hand_over: Some(hand_over.clone()), ..context })
            }
            Command::SearchAgain(again) => (Input::SearchAgain, InputContext { again: Some(again.clone()), ..context }),
            Command::OrderAreas(names) => (Input::OrderAreas, InputContext { areas: Arc::clone(names), ..context }),
            Command::CloseArea(closing) => {
                let (mission, areas) = (closing.mission, [Arc::clone(&closing.area)].into());
                (Input::CloseArea, InputContext { mission, areas, area_closing: Some(closing.clone()), ..context })
            }
            Command::Move(step) => (Input::Move, InputContext { step: Some(*step), ..context }),
            Command::Goto(cell) => (Input::Goto, InputContext { cell: Some(*cell), ..context }),
            Command::Verdict { luggage, verdict, note, hot } => {
                let (luggage, is_bare) = (luggage.or(pending), *luggage == LuggageRef::Pending);
                let input = match verdict {
                    Verdict::Safe => Input::Safe,
                    Verdict::Danger => Input::Danger,
                };
                (input, InputContext { luggage, is_bare, verdict: Some(*verdict), note: note.clone(), hot: *hot, ..context })
            }
            Command::Unsure { luggage, note, hot } => {
                let luggage = luggage.or(pending);
                (Input::Unsure, InputContext { luggage, note: note.clone(), hot: *hot, ..context })
            }
            Command::RetakePhoto(id) => (Input::RetakePhoto, InputContext { luggage: Some(*id), ..context }),
            Command::Acknowledge(id) => (Input::Acknowledge, InputContext { alarm: Some(*id), ..context }),
            Command::ChooseStrategy(strategy) => (Input::Strategy, InputContext { strategy: Some(*strategy), ..context }),
            Command::Temperature(TemperatureReport::Ok) => (Input::TemperatureOk, context),
            Command::Temperature(TemperatureReport::TooHigh) => (Input::TemperatureTooHigh, context),
            Command::Temperature(TemperatureReport::Reading(celsius)) => {
                (Input::Reading, InputContext { reading: Some((Arc::from(OPERATOR), *celsius)), ..context })
            }
            Command::Temperature(TemperatureReport::Sensor(sensor, celsius)) => {
                (Input::SensorReading, InputContext { reading: Some((Arc::clone(sensor), *celsius)), ..context })
            }
        }
    }
}
