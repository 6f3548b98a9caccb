//! The table's cells once danger was given, and in fault. The search itself stands in `search`.

use super::shared::{
    ACKNOWLEDGE, ANOTHER_DANGER, BUTTON_OK, BUTTON_TOO_HIGH, CHOOSE, COOL, DANGER, DANGER_AT_HOME, DRIVE_IF_STOPPED,
    EXPLORE_AGAIN, HEAT, INTO_FAULT, LINK_LOST, LINK_UP, NOT_HERE, NOTHING, READING, RECORDED, RESET, RESTARTED, RESUME,
    RETAKE_ELSEWHERE, SAFE, SENSOR_BACK, SENSOR_READING, SENSOR_SILENT, STOP, STORE_FAILED, STORE_RESTORED,
};
use crate::mission::rule::Act::{Release, RetryBlocked};
use crate::mission::rule::Rule::{AsInterrupted, Go, Never, RefuseIf};
use crate::mission::rule::To::{Interrupted, Phase};
use crate::mission::rule::{Guard, Rule};
use crate::mission::{Input, PhaseName};

/// On the way home after danger.
pub(super) const fn returning_with_alarm(input: Input) -> &'static [Rule] {
    match input {
        Input::Start => RESUME,
        Input::Stop => STOP,
        Input::BackHome | Input::Retrieve | Input::Strategy => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
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
        Input::DangerRecorded => ANOTHER_DANGER,
        Input::CameHome => &[Go(Phase(PhaseName::BombLocated), &[])],
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

/// Home, and a bomb is in the hall.
pub(super) const fn bomb_located(input: Input) -> &'static [Rule] {
    match input {
        Input::Start | Input::BackHome | Input::Move | Input::Goto | Input::Strategy => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Stop => STOP,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Retrieve => &[RefuseIf(Guard::Held), Never(Guard::NoRetrievalRobot)],
        Input::Reset => RESET,
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

/// The bomb is being fetched.
pub(super) const fn retrieving(input: Input) -> &'static [Rule] {
    match input {
        Input::Start => RESUME,
        Input::Stop => STOP,
        Input::BackHome | Input::Retrieve | Input::Move | Input::Goto | Input::Strategy => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Reset => RESET,
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

/// The bomb is in the container.
pub(super) const fn bag_secured(input: Input) -> &'static [Rule] {
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

/// Something went wrong.
pub(super) const fn fault(input: Input) -> &'static [Rule] {
    match input {
        Input::Start => &[
            RefuseIf(Guard::Held),
            RefuseIf(Guard::FaultStands),
            RefuseIf(Guard::VerdictAwaited),
            Go(Interrupted, &[Release, RetryBlocked]),
        ],
        Input::Stop => STOP,
        Input::BackHome | Input::Retrieve | Input::Move | Input::Goto | Input::Strategy => NOT_HERE,
        Input::RetakePhoto => RETAKE_ELSEWHERE,
        Input::Safe => SAFE,
        Input::Danger => DANGER,
        Input::TemperatureOk => BUTTON_OK,
        Input::TemperatureTooHigh => BUTTON_TOO_HIGH,
        Input::Reading => READING,
        Input::SensorReading => SENSOR_READING,
        Input::Reset => RESET,
        Input::Acknowledge => ACKNOWLEDGE,
        Input::Done
        | Input::Blocked
        | Input::AtPiece
        | Input::CameHome
        | Input::AllExplored
        | Input::DriveEnded
        | Input::NoWayHome
        | Input::Unanswered
        | Input::RobotFailed => NOTHING,
        Input::PhotoTaken | Input::PhotoFailed | Input::LuggageRecorded | Input::SafeRecorded | Input::DangerRecorded => {
            &[AsInterrupted]
        }
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
