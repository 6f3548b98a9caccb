//! What clients of the original system may not do, whatever door they come by. What they can say stands at each door.

use hallsweep_core::command::{Command, Refused};

/// An old console sends a stray `w` when it starts, which must not set an idle robot moving: moves by hand and driving to a cell
/// are for those who were let in by the setting `old_clients.manual_driving`.
///
/// # Errors
/// `NotAllowed` when the robot would be driven and `manual_driving` does not allow it.
pub fn may_drive(command: &Command, manual_driving: bool) -> Result<(), Refused> {
    if manual_driving || !matches!(command, Command::Move(_) | Command::Goto(_)) {
        return Ok(());
    }
    let words = "old clients may not drive the robot here: set old_clients.manual_driving to let them; h halts it always";
    Err(Refused::NotAllowed(words.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::command::Move;
    use hallsweep_core::units::Cell;

    #[test]
    fn only_driving_needs_leave() {
        for command in [Command::Move(Move::Forward), Command::Goto(Cell::HOME)] {
            assert!(may_drive(&command, true).is_ok());
            assert_eq!(may_drive(&command, false).unwrap_err().code(), "notAllowed");
        }
        assert!(may_drive(&Command::Start, false).is_ok() && may_drive(&Command::Stop, false).is_ok());
    }
}
