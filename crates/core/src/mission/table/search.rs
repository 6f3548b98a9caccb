//! The table's cells for the search: from idle to explored, the ways home and driving by hand.
//! Danger and fault stand in `alarm`.

use super::shared::{
    ACKNOWLEDGE, ANOTHER_DANGER, BUTTON_OK, BUTTON_TOO_HIGH, CHOOSE, COOL, DANGER, DANGER_AT_HOME, DANGER_ON_THE_WAY, DRIVE,
    DRIVE_IF_STOPPED, EXPLORE_AGAIN, EXPLORE_ON, GO_HOME, HEAT, INTO_FAULT, LINK_LOST, LINK_UP, NOT_HERE, NOTHING, READING,
    RECORDED, RESET, RESTARTED, RESUME, RETAKE_ELSEWHERE, SAFE, SENSOR_BACK, SENSOR_READING, SENSOR_SILENT, STOP, STORE_FAILED,
    STORE_RESTORED,
};
use crate::mission::rule::Act::{Begin, FacePiece, LedOff, Raise, RecordPiece, RecordRetake, Release, Retake, Stop};
use crate::mission::rule::Rule::{AsInterrupted, Go, Never, RefuseIf, When};
use crate::mission::rule::To::{Interrupted, Phase, Stay};
use crate::mission::rule::{Case, Guard, Rule};
use crate::mission::{Hold, Input, PhaseName};

/// No mission.
pub(super) const fn idle(input: Input) -> &'static [Rule] {
    match input {
        Input::Start => &[RefuseIf(Guard::Held), Go(Phase(PhaseName::Exploring), &[Release, Begin])],
        Input::Stop => STOP,
        Input::BackHome | Input::Retrieve => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Reset => RESET,
        Input::Move | Input::Goto => DRIVE,
        Input::Acknowledge => ACKNOWLEDGE,
        Input::Strategy => CHOOSE,
        Input::Done
        | Input::Blocked
        | Input::AtPiece
        | Input::PhotoTaken
        | Input::PhotoFailed
        | Input::SafeRecorded
        | Input::CameHome
        | Input::AllExplored
        | Input::DriveEnded
        | Input::NoWayHome => NOTHING,
        Input::LuggageRecorded => RECORDED,
        Input::DangerRecorded => ANOTHER_DANGER,
        Input::Unanswered | Input::RobotFailed => INTO_FAULT,
        Input::LinkLost => LINK_LOST,
        Input::LinkUp => LINK_UP,
        Input::Heat => HEAT,
        Input::Cool => COOL,
        Input::SensorSilent => SENSOR_SILENT,
        Input::SensorBack => SENSOR_BACK,
        Input::StoreFailed => STORE_FAILED,
        Input::StoreRestored => STORE_RESTORED,
        Input::Restarted => RESTARTED,
    }
}

/// Searching.
pub(super) const fn exploring(input: Input) -> &'static [Rule] {
    match input {
        Input::Start => EXPLORE_ON,
        Input::Stop => STOP,
        Input::BackHome => GO_HOME,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Retrieve | Input::Strategy => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Reset => RESET,
        Input::Move | Input::Goto => DRIVE_IF_STOPPED,
        Input::Acknowledge => ACKNOWLEDGE,
        Input::Done | Input::PhotoTaken | Input::PhotoFailed | Input::SafeRecorded | Input::CameHome | Input::DriveEnded => {
            NOTHING
        }
        Input::Blocked => &[When(Case::ToBeInspected, Phase(PhaseName::Inspecting), &[]), Go(Stay, &[])],
        Input::AtPiece => &[Go(Phase(PhaseName::Inspecting), &[])],
        Input::LuggageRecorded => RECORDED,
        Input::DangerRecorded => DANGER_ON_THE_WAY,
        Input::AllExplored => &[Go(Phase(PhaseName::Explored), &[LedOff])],
        Input::NoWayHome | Input::Unanswered | Input::RobotFailed => INTO_FAULT,
        Input::LinkLost => LINK_LOST,
        Input::LinkUp => LINK_UP,
        Input::Heat => HEAT,
        Input::Cool => COOL,
        Input::SensorSilent => SENSOR_SILENT,
        Input::SensorBack => SENSOR_BACK,
        Input::StoreFailed => STORE_FAILED,
        Input::StoreRestored => STORE_RESTORED,
        Input::Restarted => RESTARTED,
    }
}

/// At a piece of luggage.
pub(super) const fn inspecting(input: Input) -> &'static [Rule] {
    match input {
        Input::Start => &[RefuseIf(Guard::Held), RefuseIf(Guard::OperatorAsked), Go(Stay, &[Release])],
        Input::Stop => STOP,
        Input::BackHome => GO_HOME,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Retrieve | Input::Move | Input::Goto | Input::Strategy => NOT_HERE,
        Input::Reset => RESET,
        Input::RetakePhoto => {
            &[RefuseIf(Guard::NotInspected), RefuseIf(Guard::PhotoUnderWay), RefuseIf(Guard::PhotoHeld), Go(Stay, &[Retake])]
        }
        Input::Acknowledge => ACKNOWLEDGE,
        Input::Done => &[When(Case::BackedUp, Stay, &[FacePiece]), Go(Stay, &[])],
        Input::Blocked | Input::AtPiece | Input::CameHome | Input::AllExplored | Input::DriveEnded | Input::NoWayHome => NOTHING,
        Input::PhotoTaken | Input::PhotoFailed => &[When(Case::FirstPhoto, Stay, &[RecordPiece]), Go(Stay, &[RecordRetake])],
        Input::LuggageRecorded => RECORDED,
        Input::SafeRecorded => &[When(Case::ThisPiece, Phase(PhaseName::Exploring), &[]), Go(Stay, &[])],
        Input::DangerRecorded => DANGER_ON_THE_WAY,
        Input::Unanswered | Input::RobotFailed => INTO_FAULT,
        Input::LinkLost => LINK_LOST,
        Input::LinkUp => LINK_UP,
        Input::Heat => HEAT,
        Input::Cool => COOL,
        Input::SensorSilent => SENSOR_SILENT,
        Input::SensorBack => SENSOR_BACK,
        Input::StoreFailed => STORE_FAILED,
        Input::StoreRestored => STORE_RESTORED,
        Input::Restarted => RESTARTED,
    }
}

/// Driven by hand: whatever holds the robot also ends the drive.
pub(super) const fn driving(input: Input) -> &'static [Rule] {
    match input {
        Input::Start | Input::BackHome | Input::Move | Input::Goto => &[Never(Guard::Driving)],
        Input::Stop => &[Go(Interrupted, &[Stop])],
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => &[
            When(Case::FromIdle, Interrupted, &[Raise(Hold::TooHigh)]),
            Go(Interrupted, &[Raise(Hold::Operator), Raise(Hold::TooHigh)]),
        ],
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Retrieve | Input::Strategy => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Reset => RESET,
        Input::Acknowledge => ACKNOWLEDGE,
        Input::Done | Input::Blocked | Input::AtPiece | Input::CameHome | Input::AllExplored | Input::NoWayHome => NOTHING,
        Input::PhotoTaken | Input::PhotoFailed | Input::LuggageRecorded | Input::SafeRecorded | Input::DangerRecorded => {
            &[AsInterrupted]
        }
        Input::DriveEnded => &[When(Case::FromIdle, Interrupted, &[]), Go(Interrupted, &[Raise(Hold::Operator)])],
        Input::Unanswered | Input::RobotFailed => INTO_FAULT,
        Input::LinkLost => &[
            When(Case::FromIdle, Interrupted, &[Raise(Hold::RobotLink)]),
            Go(Interrupted, &[Raise(Hold::Operator), Raise(Hold::RobotLink)]),
        ],
        Input::LinkUp => LINK_UP,
        Input::Heat => &[
            When(Case::FromIdle, Interrupted, &[Raise(Hold::Temperature)]),
            Go(Interrupted, &[Raise(Hold::Operator), Raise(Hold::Temperature)]),
        ],
        Input::Cool => COOL,
        Input::SensorSilent => &[
            When(Case::FromIdle, Interrupted, &[Raise(Hold::TemperatureStale)]),
            Go(Interrupted, &[Raise(Hold::Operator), Raise(Hold::TemperatureStale)]),
        ],
        Input::SensorBack => SENSOR_BACK,
        Input::StoreFailed => &[
            When(Case::FromIdle, Interrupted, &[Raise(Hold::Store)]),
            Go(Interrupted, &[Raise(Hold::Operator), Raise(Hold::Store)]),
        ],
        Input::StoreRestored => STORE_RESTORED,
        Input::Restarted => &[
            When(Case::FromIdle, Interrupted, &[Raise(Hold::Restart)]),
            Go(Interrupted, &[Raise(Hold::Operator), Raise(Hold::Restart)]),
        ],
    }
}

/// On the way home after BACK HOME.
pub(super) const fn returning_home(input: Input) -> &'static [Rule] {
    match input {
        Input::Start | Input::BackHome => RESUME,
        Input::Stop => STOP,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Retrieve | Input::Strategy => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Reset => RESET,
        Input::Move | Input::Goto => DRIVE_IF_STOPPED,
        Input::Acknowledge => ACKNOWLEDGE,
        Input::Done
        | Input::Blocked
        | Input::AtPiece
        | Input::PhotoTaken
        | Input::PhotoFailed
        | Input::SafeRecorded
        | Input::AllExplored
        | Input::DriveEnded => NOTHING,
        Input::LuggageRecorded => RECORDED,
        Input::DangerRecorded => DANGER_ON_THE_WAY,
        Input::CameHome => &[Go(Phase(PhaseName::AtHome), &[])],
        Input::NoWayHome | Input::Unanswered | Input::RobotFailed => INTO_FAULT,
        Input::LinkLost => LINK_LOST,
        Input::LinkUp => LINK_UP,
        Input::Heat => HEAT,
        Input::Cool => COOL,
        Input::SensorSilent => SENSOR_SILENT,
        Input::SensorBack => SENSOR_BACK,
        Input::StoreFailed => STORE_FAILED,
        Input::StoreRestored => STORE_RESTORED,
        Input::Restarted => RESTARTED,
    }
}

/// Home after BACK HOME, waiting for START.
pub(super) const fn at_home(input: Input) -> &'static [Rule] {
    match input {
        Input::Start => &[RefuseIf(Guard::Held), RefuseIf(Guard::VerdictAwaited), Go(Phase(PhaseName::Exploring), &[Release])],
        Input::Stop => STOP,
        Input::BackHome => RESUME,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Retrieve | Input::Strategy => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Reset => RESET,
        Input::Move | Input::Goto => DRIVE,
        Input::Acknowledge => ACKNOWLEDGE,
        Input::Done
        | Input::Blocked
        | Input::AtPiece
        | Input::PhotoTaken
        | Input::PhotoFailed
        | Input::SafeRecorded
        | Input::CameHome
        | Input::AllExplored
        | Input::DriveEnded
        | Input::NoWayHome => NOTHING,
        Input::LuggageRecorded => RECORDED,
        Input::DangerRecorded => DANGER_AT_HOME,
        Input::Unanswered | Input::RobotFailed => INTO_FAULT,
        Input::LinkLost => LINK_LOST,
        Input::LinkUp => LINK_UP,
        Input::Heat => HEAT,
        Input::Cool => COOL,
        Input::SensorSilent => SENSOR_SILENT,
        Input::SensorBack => SENSOR_BACK,
        Input::StoreFailed => STORE_FAILED,
        Input::StoreRestored => STORE_RESTORED,
        Input::Restarted => RESTARTED,
    }
}

/// The hall is searched and the robot is home.
pub(super) const fn explored(input: Input) -> &'static [Rule] {
    match input {
        Input::Start => EXPLORE_AGAIN,
        Input::Stop => STOP,
        Input::BackHome | Input::Retrieve | Input::Move | Input::Goto => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Reset => RESET,
        Input::Acknowledge => ACKNOWLEDGE,
        Input::Strategy => CHOOSE,
        Input::Done
        | Input::Blocked
        | Input::AtPiece
        | Input::PhotoTaken
        | Input::PhotoFailed
        | Input::SafeRecorded
        | Input::CameHome
        | Input::AllExplored
        | Input::DriveEnded
        | Input::NoWayHome => NOTHING,
        Input::LuggageRecorded => RECORDED,
        Input::DangerRecorded => DANGER_AT_HOME,
        Input::Unanswered | Input::RobotFailed => INTO_FAULT,
        Input::LinkLost => LINK_LOST,
        Input::LinkUp => LINK_UP,
        Input::Heat => HEAT,
        Input::Cool => COOL,
        Input::SensorSilent => SENSOR_SILENT,
        Input::SensorBack => SENSOR_BACK,
        Input::StoreFailed => STORE_FAILED,
        Input::StoreRestored => STORE_RESTORED,
        Input::Restarted => RESTARTED,
    }
}
